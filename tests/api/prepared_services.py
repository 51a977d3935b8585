"""Services that start in a tenth of the time: copies of one process that has imported the program.

A copy runs `thetascope serve` with an environment and an output of its own, as a new process would. Copies share a fork
server, which imports SymPy and the engine once, unless a test looks at a service's own workers. Tests of the command
line, of the README and of the page start new processes.
"""

import atexit
import gc
import json
import os
import select
import signal
import socket
import subprocess
import sys
from functools import cache
from multiprocessing import forkserver
from pathlib import Path
from typing import IO

ROOT = Path(__file__).parents[2]
PRELOADED = ("thetascope.server.app", "thetascope.assembly", "thetascope.live.scheduling.hub", "uvicorn")


class Service:
    """A service that was started; a part of the interface of `subprocess.Popen`. Its fork server may be its own."""

    def __init__(
        self, arguments: list[str], environment: dict[str, str], stderr: IO[bytes] | None, own: bool = False
    ) -> None:
        output, written = os.pipe()
        status, code = os.pipe()
        given = json.dumps([arguments, environment, own]).encode()
        socket.send_fds(_original(), [given], [written, stderr.fileno() if stderr else 2, code])
        os.close(written)
        os.close(code)
        self.stdout = os.fdopen(output, encoding="utf-8")
        self._status = os.fdopen(status, encoding="ascii")
        self.pid = int(self._status.readline())
        self.returncode: int | None = None

    def terminate(self) -> None:
        """Ask the service to end."""
        if self.returncode is None:
            os.kill(self.pid, signal.SIGTERM)

    def wait(self, timeout: float) -> int:
        """Return the exit code, negative for a signal."""
        if self.returncode is None:
            if not select.select([self._status], [], [], timeout)[0]:
                raise TimeoutError(f"the service still runs after {timeout:g} s")
            self.returncode = int(self._status.readline())
            self._status.close()
        return self.returncode


@cache
def _original() -> socket.socket:
    """Start the process that is copied; return the socket on which it receives requests. It ends with this process."""
    own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    command = [sys.executable, "-m", "tests.api.prepared_services", str(other.fileno())]
    process = subprocess.Popen(command, cwd=ROOT, pass_fds=[other.fileno()], env=os.environ | {"PYTHONUNBUFFERED": "1"})
    other.close()

    def end() -> None:
        own.close()
        process.wait()

    atexit.register(end)
    return own


def main() -> int:
    """Copy this process for each request, until there are no more; return the exit code of the program in a copy."""
    for module in PRELOADED:
        __import__(module)
    from thetascope.api.http import services

    services.preload(services.PRELOADED)
    forkserver.ensure_running()
    gc.collect()
    gc.freeze()
    requests = socket.socket(fileno=int(sys.argv[1]))
    while True:
        message, files, _, _ = socket.recv_fds(requests, 2**20, 3)
        if not message:
            return 0
        if os.fork() == 0:
            if (service := os.fork()) == 0:
                requests.close()
                return _serve(*json.loads(message), *files)
            _report(service, files[2])
        for file in files:
            os.close(file)
        _forget_ended()


def _serve(arguments: list[str], environment: dict[str, str], own: bool, output: int, errors: int, code: int) -> int:
    from thetascope.cli.main import main as program

    os.dup2(output, 1)
    os.dup2(errors, 2)
    for file in (output, errors, code):
        os.close(file)
    os.environ.clear()
    os.environ.update(environment)
    if own:
        forkserver._forkserver.__init__()
    else:  # a copy is not the parent of the fork server, and cannot ask whether it runs
        forkserver._forkserver.ensure_running = lambda: None
    return program(arguments)


def _report(service: int, status: int) -> None:
    """Write the id of the service's process, and its exit code when it has ended; end this process."""
    os.write(status, f"{service}\n".encode())
    code = os.waitstatus_to_exitcode(os.waitpid(service, 0)[1])
    os.write(status, f"{code}\n".encode())
    os._exit(0)


def _forget_ended() -> None:
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass


if __name__ == "__main__":
    sys.exit(main())
