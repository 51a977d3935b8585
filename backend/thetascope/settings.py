"""Settings of the service and the command line, read from environment variables.

Every field of :class:`Settings` is set by the variable ``THETASCOPE_<FIELD>`` in capitals
(``THETASCOPE_PORT=9000``).
Sizes are bytes and take the suffixes k, M and G (powers of 1024); times are seconds.
"""

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from thetascope.messages import Message

PREFIX = "THETASCOPE_"
_UNITS = {"k": 1024, "m": 1024**2, "g": 1024**3}


class SettingsError(ValueError):
    """A variable whose text is not a value of its setting."""

    def __init__(self, problem: Message) -> None:
        super().__init__(problem)
        self.problem = problem

    def text(self, language: str = "en") -> str:
        """Return the reason in a language."""
        return self.problem.text(language)

    def __str__(self) -> str:
        return self.text()


@dataclass(frozen=True)
class Settings:
    """The settings; the defaults suit one person on one machine."""

    #: Folder of the store (runs.sqlite). Default: the user's data folder of the operating system.
    data: Path
    #: The store, if it is elsewhere: the path of a file, or the URL of a PostgreSQL database. And whether to change
    #: nothing in it (1).
    database: str = ""
    read_only: int = 0
    #: Address and port on which `thetascope serve` listens.
    host: str = "127.0.0.1"
    port: int = 8000
    #: Processes among which live sessions are spread, and what leads requests to them: Caddy, started with them, or
    #: none (a router of your own; process k then listens on port + k).
    processes: int = 1
    router: Literal["caddy", "none"] = "caddy"
    #: Of one of several processes: its number, and the folder of their sockets ("": they listen on ports). `serve` sets
    #: both for the processes that it starts.
    process: int | None = None
    sockets: str = ""
    #: Address under which a container's port is published, where it is not `host`: it decides who needs the access key.
    published: str = ""
    #: Further names of this service, separated by commas; loopback names and addresses as numbers are always accepted.
    hosts: str = ""
    #: Origins of pages of other sites that may use this service, separated by commas, as `https://lab.example.org`.
    origins: str = ""
    #: File of the learning platforms from which classes are launched (LTI 1.3); "": there are none.
    lti: str = ""
    #: Access key; "": a random one, created when it is needed. `open`: whether nobody is asked for it (1).
    key: str = field(default="", repr=False)
    open: int = 0
    #: Runs of one client computed at the same time, each in a process. For short ones and for long ones, one more is
    #: kept for other clients.
    workers: int = min(4, os.cpu_count() or 1)
    #: Whether worker processes are started, and the library's experiments prepared, before they are needed (0: not).
    prepare: int = 1
    #: Runs that may wait, and other computations of one client; one more is refused with 503.
    queue: int = 64
    #: Limits of one computation in a worker process (checking a plant, compiling, opening a session): time from the
    #: request on and processor time, and memory, which holds for runs, too. It is ended when it reaches one of them.
    job_seconds: float = 20.0
    job_cpu: float = 20.0
    job_memory: int = 1024**3
    #: Limits of one client: its runs that wait or run, its live sessions, its open websockets, and the processor time
    #: in s of its computations within a minute (0: none). By default they hold for clients that need the access key; a
    #: value that is set holds for everybody.
    client_runs: int | None = None
    client_sessions: int | None = None
    client_sockets: int | None = None
    client_cpu: float | None = None
    #: Address of the scheduler of a Dask cluster that computes studies (tcp://host:8786); "": this machine does.
    scheduler: str = ""
    #: Where the service keeps studies, if not beside the store: a folder, or an address that fsspec knows; and the most
    #: runs of one.
    studies: str = ""
    study_runs: int = 100_000
    #: How long POST /api/runs waits for the result before it answers 202, and the most a client may ask for.
    wait: float = 2.0
    max_wait: float = 60.0
    #: Largest body of a request and largest plant or experiment file.
    max_body: int = 2 * 1024**2
    #: Largest record that is diagnosed, and the room for uploaded ones in the store, packed; one client that needs the
    #: access key may have a quarter of it.
    max_record: int = 64 * 1024**2
    record_limit: int = 2 * 1024**3
    #: Room for saved plants in the store, with all their versions; one client that needs the access key may have a
    #: quarter of it.
    plant_limit: int = 1024**3
    #: Largest run: integration steps (horizon / step), numbers recorded (bytes of the result).
    max_steps: int = 20_000_000
    max_result: int = 256 * 1024**2
    #: A run that takes longer than this is stopped.
    max_seconds: float = 600.0
    #: Results kept in memory, and in the store; beyond it the least recently used unpinned ones are dropped.
    memory: int = 256 * 1024**2
    store_limit: int = 2 * 1024**3
    #: Live sessions open at the same time, and viewers of one of them.
    sessions: int = 400
    viewers: int = 200
    #: Rows after which a session ends. Samples that it keeps, in bytes; older rows are dropped.
    session_rows: int = 10_000_000
    past: int = 32 * 1024**2
    #: How long a session without viewers is kept.
    idle: float = 600.0
    #: Largest message of a viewer, and how many it may send in a second (more are read more slowly).
    max_message: int = 256 * 1024
    message_rate: float = 60.0
    #: Connections open at the same time; the system's limit on open files may allow fewer.
    connections: int = 2000
    #: Log lines on standard error: text, or json (one object per line); whether each request gets one (1), too.
    log: Literal["text", "json"] = "text"
    log_requests: int = 0
    #: How far a slow viewer may lag, in bytes of samples; beyond it, samples are skipped.
    backlog: int = 8 * 1024**2

    @property
    def store(self) -> str:
        """Path or URL of the store."""
        return self.database or str(self.data / "runs.sqlite")

    @property
    def owns_store(self) -> bool:
        """Return whether this is the process, perhaps the first of several, that owns the store and computes runs."""
        return not self.process


def load(environ: Mapping[str, str] | None = None, **overrides: object) -> Settings:
    """Return the settings of the environment; `overrides` that are not None win. Raises :class:`SettingsError`."""
    environ = os.environ if environ is None else environ
    values: dict[str, Any] = {"data": default_data(environ)}
    for setting in fields(Settings):
        text = environ.get(PREFIX + setting.name.upper(), "").strip()
        if text:
            values[setting.name] = _parse(PREFIX + setting.name.upper(), text, setting.type)
    values.update({name: value for name, value in overrides.items() if value is not None})
    return Settings(**values)


def default_data(environ: Mapping[str, str]) -> Path:
    """Return the user's data folder, by the convention of the operating system."""
    home = Path.home()
    if sys.platform == "win32":
        return Path(environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "thetascope"
    if sys.platform == "darwin":
        return home / "Library" / "Application Support" / "thetascope"
    return Path(environ.get("XDG_DATA_HOME") or home / ".local" / "share") / "thetascope"


def _parse(name: str, text: str, kind: object) -> Any:
    if get_origin(kind) is Literal:
        if text not in get_args(kind):
            raise SettingsError(Message("settings.no-choice", name=name, value=text, choices=list(get_args(kind))))
        return text
    try:
        if kind is Path:
            return Path(text).expanduser()
        if kind in (int, int | None):
            return _integer(text)
        if kind in (float, float | None):
            value = float(text)
            if not 0 <= value < float("inf"):
                raise ValueError
            return value
        return text
    except ValueError:
        code = "settings.no-whole-number" if kind in (int, int | None) else "settings.no-seconds"
        raise SettingsError(Message(code, name=name, value=text)) from None


def _integer(text: str) -> int:
    unit = _UNITS.get(text[-1].lower(), 1)
    number = int(text[:-1] if unit > 1 else text) * unit
    if number < 0:
        raise ValueError
    return number
