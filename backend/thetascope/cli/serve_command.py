"""`thetascope serve`: the service in one process, or in several with a router in front."""

import argparse
import os
import signal
import webbrowser
from threading import Thread

from thetascope.cli.access_commands import announce
from thetascope.cli.words import Words
from thetascope.process_settings import collect_as_usual
from thetascope.server.processes.supervisor import READY, serve_processes
from thetascope.server.started import Started
from thetascope.settings import load


def serve_command(options: argparse.Namespace, say: Words) -> int:
    """Serve until interrupted, and return the exit code."""
    collect_as_usual()
    settings = load(
        host=options.host,
        port=options.port,
        processes=options.processes,
        router=options.router,
        read_only=1 if options.read_only else None,
    )

    def ready(started: Started) -> None:
        announce(started, settings, say)
        if options.open:
            webbrowser.open(started.link)

    if settings.process is None and settings.processes != 1:
        return serve_processes(settings, say.language, ready)
    from thetascope.server.app import serve  # the supervisor needs no engine

    if settings.process is not None:
        Thread(target=_end_with_supervisor, daemon=True).start()
        serve(settings, lambda started: print(READY, flush=True))
        return 0
    serve(settings, ready)
    return 0


def _end_with_supervisor() -> None:
    """End as on SIGTERM when the pipe from the supervisor closes: it ended, or was killed."""
    while os.read(0, 1024):
        pass
    os.kill(os.getpid(), signal.SIGTERM)
