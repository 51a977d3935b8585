"""Compile the kernels and find the thresholds of the library's experiments in advance, in a process beside the service.

    python -m thetascope.server.prewarm

One experiment takes seconds the first time. The process has the lowest priority, so that it does not slow sessions
down. Its standard input is a pipe from the service: whenever the service ends, the pipe closes and the process exits.
"""

import logging
import os
import signal
import subprocess
import sys
import time
from threading import Thread

from thetascope import library
from thetascope.engine.compiler import cache
from thetascope.runs.results.engine_version import engine_version

log = logging.getLogger(__name__)

_DONE = "warmed"
_LATER = 10.0  # s; leaves time to open the first page


def begin() -> subprocess.Popen[bytes] | None:
    """Start the process and return it; None if everything is in the cache already."""
    if cache.read(_DONE, _key()) is not None:
        return None
    try:
        return subprocess.Popen(
            [sys.executable, "-m", "thetascope.server.prewarm"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
        )
    except OSError as error:
        log.warning("the library is not compiled in advance: %s", error)
        return None


def end(process: subprocess.Popen[bytes] | None) -> None:
    """Stop the process, if any, and wait for it."""
    if process is None:
        return
    if process.poll() is None:
        process.terminate()
        process.wait()
    if process.stdin is not None:
        process.stdin.close()


def _key() -> str:
    """Return the cache key that marks the work as done. It changes with the numerics and with the library."""
    return f"{engine_version()}-{library.digest()[:16]}"


def main() -> None:
    """Open each experiment of the library as a live session would; exit when the service ends."""
    Thread(target=_exit_with_service, daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the service, which ends this process
    prepare()


def _exit_with_service() -> None:
    """Wait until the service's end of the pipe closes, then exit immediately: caches are written atomically."""
    while os.read(0, 1024):  # not sys.stdin: its lock, held at the end of the process, would abort the interpreter
        pass
    os._exit(0)


def prepare() -> None:
    """Advance a session of every experiment by one row, compile the mysteries, and record that all are done."""
    from thetascope.challenge.mystery import compile_setup
    from thetascope.engine.errors import ThetascopeError
    from thetascope.live.session.session import Session  # imports SymPy, so the service starts without it

    if hasattr(os, "nice"):
        os.nice(19)
    time.sleep(_LATER)
    for spec in library.experiments().values():
        try:
            Session(library.resolve(spec)).advance(1)
        except ThetascopeError as error:
            log.warning("%s is not compiled in advance: %s", spec.id, error)
    for setup in library.mysteries().values():
        compile_setup(setup)
    cache.write(_DONE, _key(), b"")


if __name__ == "__main__":
    main()
