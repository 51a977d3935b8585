"""Settings of the service and the command line, read from environment variables.

Every field of :class:`Settings` is set by the variable ``THETASCOPE_<FIELD>`` in capitals
(``THETASCOPE_PORT=9000``).
Sizes are bytes and take the suffixes k, M and G (powers of 1024); times are seconds.
"""

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

PREFIX = "THETASCOPE_"
_UNITS = {"k": 1024, "m": 1024**2, "g": 1024**3}


class SettingsError(ValueError):
    """A variable holds something that is no value of its setting."""


@dataclass(frozen=True)
class Settings:
    """What can be set; the defaults suit one person on one machine."""

    #: Folder of the store (runs.sqlite). Default: the user's data folder of the operating system.
    data: Path
    #: Address and port on which `thetascope serve` listens.
    host: str = "127.0.0.1"
    port: int = 8000
    #: Runs computed at the same time. Kernels leave Python's lock, so threads use several cores.
    workers: int = min(4, os.cpu_count() or 1)
    #: Whether the library's experiments are prepared in the background after the first start (0: not).
    prepare: int = 1
    #: Runs that may wait; one more is refused with 503.
    queue: int = 64
    #: How long POST /api/runs waits for the result before it answers 202, and the most a client may ask for.
    wait: float = 2.0
    max_wait: float = 60.0
    #: Largest body of a request and largest plant or experiment file.
    max_body: int = 2 * 1024**2
    #: Largest record that is to be diagnosed.
    max_record: int = 64 * 1024**2
    #: Largest run: integration steps (horizon / step), numbers recorded (bytes of the result).
    max_steps: int = 20_000_000
    max_result: int = 256 * 1024**2
    #: A run that takes longer than this is stopped.
    max_seconds: float = 600.0
    #: Results kept in memory, and in the store: beyond it the least recently used unpinned ones are let go.
    memory: int = 256 * 1024**2
    store_limit: int = 2 * 1024**3
    #: Live sessions open at the same time, and viewers of one of them.
    sessions: int = 400
    viewers: int = 200
    #: Rows that a session may reach: there it ends. Samples that it keeps, in bytes: older rows are let go.
    session_rows: int = 10_000_000
    past: int = 32 * 1024**2
    #: How long a session without viewers is kept.
    idle: float = 600.0
    #: Largest message of a viewer, and how many it may send in a second (more are read more slowly).
    max_message: int = 256 * 1024
    message_rate: float = 60.0
    #: How far a slow viewer may be behind, in bytes of samples; beyond it, it misses some.
    backlog: int = 8 * 1024**2

    @property
    def database(self) -> Path:
        """The store's file."""
        return self.data / "runs.sqlite"


def load(environ: Mapping[str, str] | None = None, **overrides: object) -> Settings:
    """Settings from the environment; `overrides` that are not None win. Raises :class:`SettingsError`."""
    environ = os.environ if environ is None else environ
    values: dict[str, object] = {"data": default_data(environ)}
    for field in fields(Settings):
        text = environ.get(PREFIX + field.name.upper(), "").strip()
        if text:
            values[field.name] = _parse(PREFIX + field.name.upper(), text, field.type)
    values.update({name: value for name, value in overrides.items() if value is not None})
    return Settings(**values)


def default_data(environ: Mapping[str, str]) -> Path:
    """The user's data folder, by the convention of the operating system."""
    home = Path.home()
    if sys.platform == "win32":
        return Path(environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "thetascope"
    if sys.platform == "darwin":
        return home / "Library" / "Application Support" / "thetascope"
    return Path(environ.get("XDG_DATA_HOME") or home / ".local" / "share") / "thetascope"


def _parse(name: str, text: str, kind: type) -> object:
    try:
        if kind is Path:
            return Path(text).expanduser()
        if kind is int:
            return _integer(text)
        if kind is float:
            value = float(text)
            if not 0 <= value < float("inf"):
                raise ValueError
            return value
        return text
    except ValueError:
        example = "a whole number such as 64, 512k, 256M or 2G" if kind is int else "a number of seconds such as 2.5"
        raise SettingsError(f"{name} is {text!r}. Set it to {example}, or unset it for the default.") from None


def _integer(text: str) -> int:
    unit = _UNITS.get(text[-1].lower(), 1)
    number = int(text[:-1] if unit > 1 else text) * unit
    if number < 0:
        raise ValueError
    return number
