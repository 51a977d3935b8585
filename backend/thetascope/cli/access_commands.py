"""`thetascope key`, and the lines of `thetascope serve` about access."""

import socket
import sys
from datetime import datetime
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from thetascope.access.gate import FILE
from thetascope.access.key_file import KeyFile
from thetascope.cli.words import Words
from thetascope.settings import Settings, load

if TYPE_CHECKING:
    from thetascope.server.started import Started

_EVERYWHERE = ("", "0.0.0.0", "::")


def key_command(new: bool, say: Words) -> int:
    """Create the first access key, or a new one, and print it; otherwise print when the present one was made."""
    settings = load()
    file = KeyFile(settings.data / FILE, settings.key)
    if file.is_chosen and not new:
        print(say("cli.key.chosen"))
        return 0
    if new:
        key = file.renew()
        print(say("cli.key.new"))
        print(key)
        return 0
    keys, key = file.ensured()
    if key is None:
        when = datetime.fromtimestamp(keys.created).astimezone().strftime("%Y-%m-%d %H:%M")
        print(say("cli.key.exists", when=when))
    else:
        print(say("cli.key.created"))
        print(key)
    return 0


def announce(started: "Started", settings: Settings, say: Words) -> None:
    """Print the address of the service, and how others get in."""
    print(say("cli.serving", address=started.address), flush=True)
    if started.unguarded:
        print(say("cli.unguarded"), file=sys.stderr, flush=True)
    if started.key is not None:
        link = f"{_seen_from_others(started.address, settings.host)}?{urlencode({'key': started.key})}"
        print(say("cli.first-key", key=started.key, link=link), flush=True)
    elif started.asks:
        print(say("cli.asks-for-key"), flush=True)


def _seen_from_others(address: str, host: str) -> str:
    """Return the address of the page for other machines: one that listens everywhere has the address of the network."""
    if host not in _EVERYWHERE:
        return address
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing; it only chooses the address
            own = probe.getsockname()[0]
        except OSError:
            return address
    return address.replace("127.0.0.1", own, 1)
