"""The process of `thetascope serve --processes N`: it starts N processes and the router, and starts again what ends.

Process 0 owns the store and computes runs; all have live sessions. Each is `thetascope serve` with its number in the
environment, says a line when it answers, and ends when its standard input closes.
"""

import asyncio
import contextlib
import json
import logging
import os
import shutil
import signal
import socket
import sys
import tempfile
import time
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from pathlib import Path

from thetascope.access.gate import Gate
from thetascope.api.operation import log_format
from thetascope.live.scheduling.session_ids import MOST
from thetascope.messages import Message
from thetascope.server.processes import router
from thetascope.server.started import Started, started_at
from thetascope.settings import PREFIX, Settings, SettingsError

log = logging.getLogger(__name__)

READY = "ready"
"""The line that a process writes when it answers."""
_END = 4.3
"""Seconds that processes have to end before they are killed; a process waits 3 s for its connections."""
_SOONEST, _LATEST = 0.2, 5.0
"""Seconds before something that ended is started again: more each time, until it has lived for a while …"""
_LIVED = 10.0
"""… that is, for this long."""
_LISTENS = 15.0
"""Seconds in which the router has to listen."""


def serve_processes(settings: Settings, language: str, ready: Callable[[Started], None]) -> int:
    """Serve in several processes until interrupted; return the exit code.

    `ready` is called as soon as all of them answer. Raises SettingsError or OSError before anything is started.
    """
    if not 1 <= settings.processes <= MOST:
        raise SettingsError(Message("serve.processes", n=settings.processes, most=MOST))
    if not hasattr(socket, "AF_UNIX"):
        raise router.RouterAbsent(Message("serve.one-process"))
    program = router.caddy() if settings.router == "caddy" else None
    log_format.install(settings)
    folder = tempfile.mkdtemp(prefix="thetascope-")  # for its owner alone
    try:
        return asyncio.run(_Supervisor(settings, language, ready, program, Path(folder)).run())
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@dataclass
class _Part:
    """A process, or the router: how to start it, and the process that was started last."""

    name: str
    command: list[str]
    environment: dict[str, str]
    says_ready: bool
    process: Process | None = None
    began: float = 0.0


class _Supervisor:
    def __init__(
        self, settings: Settings, language: str, ready: Callable[[Started], None], program: str | None, folder: Path
    ) -> None:
        self._settings, self._language, self._ready, self._folder = settings, language, ready, folder
        self._stop = asyncio.Event()
        self._parts = [self._process(number) for number in range(settings.processes)]
        self._program = program
        self._pipes: set[asyncio.Task[None]] = set()

    async def run(self) -> int:
        """Start everything, watch it until a signal comes, end everything."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self._stop.set)
        gate = Gate(self._settings)
        key = gate.file.ensured()[1] if gate.expects_others else None
        port = _free_port(self._settings.host, self._settings.port)
        stopped = asyncio.create_task(self._stop.wait())
        watching: list[asyncio.Task[None]] = []
        try:
            beginning = asyncio.create_task(self._begin(port))
            await asyncio.wait({beginning, stopped}, return_when=asyncio.FIRST_COMPLETED)
            if not beginning.done():
                beginning.cancel()
                return 0
            if (code := beginning.result()) != 0:
                return code
            watching = [asyncio.create_task(self._watched(part)) for part in self._parts]
            self._ready(started_at(self._settings, port, key, gate))
            await stopped
        finally:
            for task in (*watching, stopped):
                task.cancel()
            await self._end()
        return 0

    async def _begin(self, port: int) -> int:
        """Start the processes and the router; return 0, or the exit code of what did not start. It said why."""
        first, *others = self._parts
        if (code := await self._started(first)) != 0:  # it creates the store that the others read
            return code
        codes = await asyncio.gather(*(self._started(part) for part in others))
        if any(codes) or self._program is None:
            return max(codes, default=0)
        configuration = self._folder / "Caddyfile"
        settings = self._settings
        configuration.write_text(router.caddyfile(settings.host, port, str(self._folder), settings.processes))
        places = {name: str(self._folder) for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME")}
        part = _Part("router", router.command(self._program, configuration), os.environ | places, says_ready=False)
        self._parts.append(part)
        await self._started(part)
        return await self._listens(part, port)

    async def _listens(self, part: _Part, port: int) -> int:
        """Wait until the router listens; return 0, or its exit code."""
        host = "127.0.0.1" if self._settings.host in ("0.0.0.0", "") else self._settings.host.strip("[]")
        until = time.monotonic() + _LISTENS
        assert part.process is not None
        while time.monotonic() < until and part.process.returncode is None:
            with contextlib.suppress(OSError):
                _, writer = await asyncio.open_connection("::1" if host == "::" else host, port)
                writer.close()
                return 0
            await asyncio.sleep(0.02)
        return part.process.returncode or 1

    def _process(self, number: int) -> _Part:
        """Return how one of the processes is started."""
        settings = self._settings
        own = {
            "process": number,
            "processes": settings.processes,
            "host": settings.host,
            "port": settings.port,
            "read_only": 1 if number else settings.read_only,
            "sockets": str(self._folder) if settings.router == "caddy" else "",
            "router": settings.router,
        }
        variables = {PREFIX + name.upper(): str(value) for name, value in own.items()}
        command = [sys.executable, "-m", "thetascope.cli.main", "--language", self._language, "serve"]
        return _Part(f"process {number}", command, os.environ | variables, says_ready=True)

    async def _started(self, part: _Part) -> int:
        """Start a part, and wait until it is ready; return 0, or its exit code."""
        part.began = time.monotonic()
        part.process = process = await asyncio.create_subprocess_exec(
            *part.command,
            stdin=PIPE,
            stdout=PIPE if part.says_ready else DEVNULL,
            stderr=None if part.says_ready else PIPE,
            env=part.environment,
            start_new_session=True,  # Ctrl-C reaches the supervisor alone
        )
        if process.stderr is not None:
            self._read(_logged(process.stderr))
        if process.stdout is None:
            return 0
        line = await process.stdout.readline()
        if line.decode().strip() == READY:
            self._read(_emptied(process.stdout))
            return 0
        return await process.wait() or 1

    def _read(self, reading: Coroutine[None, None, None]) -> None:
        """Read a pipe until it ends."""
        self._pipes.add(task := asyncio.create_task(reading))
        task.add_done_callback(self._pipes.discard)

    async def _watched(self, part: _Part) -> None:
        """Start a part again whenever it ends."""
        wait = _SOONEST
        while part.process is not None:
            code = await part.process.wait()
            await _let_go(part.process)
            wait = _SOONEST if time.monotonic() - part.began > _LIVED else min(_LATEST, 2 * wait)
            fields = {"part": part.name, "code": code, "again_in": wait}
            log.error("The %s ended with code %s; it is started again", part.name, code, extra={"fields": fields})
            await asyncio.sleep(wait)
            await self._started(part)

    async def _end(self) -> None:
        """End everything: first the processes, whose last answers the router passes on, then the router."""
        until = time.monotonic() + _END
        running = [part for part in self._parts if part.process is not None and part.process.returncode is None]
        routers = [part for part in running if not part.says_ready]
        for group in ([part for part in running if part.says_ready], routers):
            await asyncio.gather(*(_ended(part.process, until) for part in group if part.process is not None))


async def _ended(process: Process, until: float) -> None:
    """Ask a process to end, and kill it at a time."""
    with contextlib.suppress(ProcessLookupError):
        process.terminate()
    try:
        await asyncio.wait_for(process.wait(), max(0.1, until - time.monotonic()))
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
    await _let_go(process)


async def _let_go(process: Process) -> None:
    """Close the pipe that keeps alive what a process has started."""
    if process.stdin is not None:
        process.stdin.close()
        with contextlib.suppress(OSError):
            await process.stdin.wait_closed()


async def _emptied(stream: asyncio.StreamReader) -> None:
    """Read what a process writes after it is ready, so that it never waits for somebody who reads."""
    while await stream.read(4096):
        pass


async def _logged(stream: asyncio.StreamReader) -> None:
    """Write the router's errors as log lines of the service."""
    while line := (await stream.readline()).decode(errors="replace").strip():
        try:
            said = json.loads(line)
        except ValueError:
            said = {"level": "error", "msg": line}
        if said.get("level") not in ("debug", "info", "warn"):
            about = {name: said[name] for name in ("msg", "error", "status") if name in said}
            log.error("The router: %s", said.get("msg"), extra={"fields": about})


def _free_port(host: str, port: int) -> int:
    """Return the port, or a free one for 0. Raises OSError if nobody can listen there now."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((host.strip("[]"), port))
        return probe.getsockname()[1]
