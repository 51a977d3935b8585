"""The router in front of several processes: Caddy, with a configuration that says where each session lives.

No Python library passes websockets on at the rate of hundreds of live sessions; Caddy is one program without
dependencies, and the one that the profile `public` of docker-compose.yml uses.
"""

import shutil
from pathlib import Path

from thetascope.api.processes.from_router import CLIENT, PREFIX, PROTOCOL, REPLACED
from thetascope.api.processes.others import socket_of
from thetascope.live.scheduling.session_ids import prefix
from thetascope.messages import Message
from thetascope.messages.explained import Explained
from thetascope.settings import SettingsError

_CADDYFILE = """{{
	admin off
	auto_https off
	grace_period 1s
	log {{
		level ERROR
		output stderr
	}}
	servers {{
		timeouts {{
			read_header 15s
			idle 2m
		}}
	}}
}}

(process) {{
	flush_interval -1
	lb_policy least_conn
	# a process that ended is started again: meanwhile its requests wait
	lb_try_duration 10s
	lb_try_interval 100ms
{headers}
	transport http {{
		versions 1.1
		dial_timeout 2s
		# shorter than the time after which a process closes an idle connection
		keepalive 3s
	}}
}}

http://:{port} {{
	bind {host}
	header -Server
{routes}
	# the store, runs, studies, classes, the page
	reverse_proxy {first} {{
		import process
	}}
}}
"""

_ROUTE = """	@{name} {{
{conditions}
	}}
	reverse_proxy @{name} {sockets} {{
		import process
	}}
"""


class RouterAbsent(Explained, SettingsError):
    """Several processes are wanted, and nothing that leads requests to them is installed."""


def caddy() -> str:
    """Return the program. Raises RouterAbsent."""
    found = shutil.which("caddy")
    if found is None:
        raise RouterAbsent(Message("serve.no-caddy"))
    return found


def command(program: str, configuration: Path) -> list[str]:
    """Return the command that runs the router until its standard input closes, as when its supervisor is killed."""
    watched = (
        '(read -r _ <&3; kill $$) >/dev/null 2>&1 & exec "$0" run --config "$1" --adapter caddyfile 3<&- </dev/null'
    )
    return ["/bin/sh", "-c", f"exec 3<&0; {watched}", program, str(configuration)]


def caddyfile(host: str, port: int, folder: str, processes: int) -> str:
    """Return the router's configuration.

    A session's requests and websocket go to its process, by the beginning of its id; a new session to the process with
    the fewest connections, most of which are websockets of sessions. To save a session is to begin a run, which the
    first process does, like everything else.
    """
    sockets = [f"unix/{socket_of(folder, process)}" for process in range(processes)]
    routes = [
        _route("new", ["method POST", "path /api/sessions"], " ".join(sockets)),
        *(_route(f"sessions{k}", _of_session(k), sockets[k]) for k in range(1, processes)),
        *(_route(f"operation{k}", _of_operation(k), sockets[k]) for k in range(1, processes)),
    ]
    headers = [
        *(f"\theader_up {PREFIX}{name} {{http.request.header.{name}}}" for name in REPLACED),
        f"\theader_up {PREFIX}{CLIENT} {{http.request.remote}}",
        f"\theader_up {PREFIX}{PROTOCOL} {{http.request.proto}}",
    ]
    return _CADDYFILE.format(
        headers="\n".join(headers), port=port, host=host.strip("[]"), routes="".join(routes), first=sockets[0]
    )


def _route(name: str, conditions: list[str], sockets: str) -> str:
    return _ROUTE.format(name=name, conditions="\n".join(f"\t\t{one}" for one in conditions), sockets=sockets)


def _of_session(process: int) -> list[str]:
    return [f"path /api/sessions/{prefix(process)}*", f"not path /api/sessions/{prefix(process)}*/save"]


def _of_operation(process: int) -> list[str]:
    return ["path /metrics /api/health /api/health/*", f"query process={process}"]
