"""A PostgreSQL server of the tests' own, in a temporary folder, reached by a socket in it."""

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

_QUICK = ("fsync=off", "full_page_writes=off", "listen_addresses=", "max_connections=40", "shared_buffers=16MB")


@contextmanager
def cluster() -> Iterator[str]:
    """Start a server; yield its URL without a query but with a socket. Skip the test where PostgreSQL is lacking."""
    programs = _programs()
    if programs is None:
        pytest.skip("PostgreSQL is not installed (Debian's package postgresql)")
    user = _unprivileged()
    with tempfile.TemporaryDirectory(prefix="pg-", dir="/tmp") as name:
        folder = Path(name)
        rights = {}
        if user is not None:
            os.chown(folder, user.pw_uid, user.pw_gid)
            rights = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        environment = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "HOME": name}
        quiet = {"stdout": subprocess.DEVNULL, "env": environment, "cwd": folder, **rights}
        data = folder / "data"
        command = ["-D", data, "-U", "tester", "-A", "trust", "-E", "UTF8", "--no-sync", "--no-instructions"]
        subprocess.run([programs / "initdb", *command], check=True, **quiet)
        options = [part for setting in (*_QUICK, f"unix_socket_directories={folder}") for part in ("-c", setting)]
        with (folder / "log").open("w") as log:
            server = subprocess.Popen([programs / "postgres", "-D", data, *options], stderr=log, **quiet)
        try:
            _wait(folder / ".s.PGSQL.5432", server, folder / "log")
            yield f"postgresql://tester@/postgres?host={folder}"
        finally:
            server.send_signal(signal.SIGQUIT)
            server.wait(30)


def _programs() -> Path | None:
    """Return the folder of the server's programs."""
    found = shutil.which("postgres")
    candidates = [Path(found).resolve().parent] if found else []
    candidates += sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)
    return next((folder for folder in candidates if {"initdb", "postgres"} <= {p.name for p in folder.iterdir()}), None)


def _unprivileged() -> pwd.struct_passwd | None:
    """Return the user for the server, which refuses to run as root; None: the one of the tests."""
    if os.geteuid() != 0:
        return None
    known = {user.pw_name: user for user in pwd.getpwall()}
    return known.get("postgres") or known["nobody"]


def _wait(socket: Path, server: subprocess.Popen, log: Path) -> None:
    """Wait until the server accepts connections."""
    import psycopg

    deadline = time.monotonic() + 60
    while True:
        try:
            psycopg.connect(f"host={socket.parent} user=tester dbname=postgres").close()
            return
        except psycopg.OperationalError:
            assert server.poll() is None and time.monotonic() < deadline, log.read_text()
            time.sleep(0.02)
