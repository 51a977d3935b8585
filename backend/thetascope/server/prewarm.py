"""What the library's experiments need, made once beside the service: kernels and thresholds of one take seconds where none is kept.

    python -m thetascope.server.prewarm

It is a process of its own and of the lowest priority, so that it takes nothing from sessions, and ends with the service.
"""

import logging
import os
import signal
import subprocess
import sys
import time

from thetascope import library
from thetascope.engine.compiler import cache
from thetascope.runs.results.engine_version import engine_version

log = logging.getLogger(__name__)

_DONE = "warmed"
_LATER = 10.0  # s, for the first page, which is being opened


def begin() -> subprocess.Popen | None:
    """Start the process, unless everything is there already."""
    if cache.read(_DONE, _key()) is not None:
        return None
    try:
        return subprocess.Popen(
            [sys.executable, "-m", "thetascope.server.prewarm"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL
        )
    except OSError as error:
        log.warning("the library is not prepared ahead: %s", error)
        return None


def end(process: subprocess.Popen | None) -> None:
    """Stop the process, if there is one."""
    if process is not None and process.poll() is None:
        process.terminate()
        process.wait()


def _key() -> str:
    """The name under which it is noted that all is there: another once the numerics or the library have changed."""
    return f"{engine_version()}-{library.digest()[:16]}"


def main() -> None:
    """Open each experiment as a live session would be; stop where the service that began this has gone."""
    from thetascope.engine.errors import ThetascopeError
    from thetascope.live.session.session import Session  # SymPy comes with it, so the service starts without

    parent = os.getppid()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the service, which ends this
    if hasattr(os, "nice"):
        os.nice(19)
    time.sleep(_LATER)
    for spec in library.experiments().values():
        if os.getppid() != parent:
            return
        try:
            Session(spec).advance(1)
        except ThetascopeError as error:
            log.warning("%s is not prepared ahead: %s", spec.id, error)
    cache.write(_DONE, _key(), b"")


if __name__ == "__main__":
    main()
