"""A small client of the service, with one kept connection.

client = Client("http://127.0.0.1:8000")
run = client.run("zhao-2012", {"noise.y.std": 0})
columns = client.data(run["id"], ["t", "theta.*", "adaptive.theta.*"])   # name → NumPy array

A service on another machine asks for its access key: Client("https://lab.example.org", key="…").
"""

import base64
import json
from collections.abc import Mapping, Sequence
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from typing import Any, Self
from urllib.parse import parse_qs, quote, urlencode, urlsplit

import numpy as np

from thetascope.frames import frame_of
from thetascope.progress import Shown, progress_bar


class ServiceError(Exception):
    """The service refused or failed. `problem` is its problem document, `status` the HTTP status."""

    def __init__(self, status: int, problem: Mapping[str, Any]) -> None:
        super().__init__(f"{status} {problem.get('title', '')}: {problem.get('detail', '')}")
        self.status, self.problem = status, problem


class Client:
    """Speaks to one service; not to be shared between threads.

    Args:
        address: of the service. It may be the link that signs in, `…/?key=…`.
        timeout: for one answer, in s.
        key: the access key, which a service asks for that other machines can reach.
        name: a text of your own that others do not know. Runs that were started under it can be cancelled and removed
            under it only; those without a name, by everybody who has the key.
    """

    def __init__(
        self, address: str = "http://127.0.0.1:8000", timeout: float = 120.0, key: str = "", name: str = ""
    ) -> None:
        parts = urlsplit(address)
        key = key or parse_qs(parts.query).get("key", [""])[0]
        self._access = {"X-Access-Key": key} if key else {}
        self._access |= {"X-Client": name} if name else {}
        connection = HTTPSConnection if parts.scheme == "https" else HTTPConnection
        self._connection = connection(parts.hostname or "127.0.0.1", parts.port, timeout=timeout)
        self._base = parts.path.rstrip("/")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection; the next request opens another."""
        self._connection.close()

    def health(self) -> dict[str, Any]:
        """Whether the service works, its versions, and what its store holds."""
        return self.get("/api/health")

    def catalogue(self) -> dict[str, Any]:
        """Plants, experiments, observers with their gains, fault shapes, signals."""
        return self.get("/api/catalogue")

    def plant(self, id: str) -> dict[str, Any]:
        """A plant of the library."""
        return self.get(f"/api/plants/{quote(id, safe='')}")

    def check(self, plant: Mapping[str, Any]) -> dict[str, Any]:
        """The report on a plant. Raises :class:`ServiceError` naming the field at fault."""
        return self.post("/api/plants/check", plant)

    def experiment(self, id: str) -> dict[str, Any]:
        """An experiment of the library."""
        return self.get(f"/api/experiments/{quote(id, safe='')}")

    def run(
        self,
        experiment: str | Mapping[str, Any],
        changes: Mapping[str, Any] | None = None,
        wait: bool = True,
        progress: Shown = None,
    ) -> dict[str, Any]:
        """Run a library experiment (by id, with changes by path) or a whole spec, and wait for its end.

        With `wait=False` the answer may be a run that is queued or running; :meth:`wait` waits for it. `progress`: as
        there.
        """
        path = "/api/runs" if progress is False else "/api/runs?wait=0.5"
        if isinstance(experiment, str):
            run = self.post(path, {"experiment": experiment, "set": dict(changes or {})})
        elif changes:
            raise ValueError("changes by path are for library experiments; change the spec itself")
        else:
            run = self.post(path, experiment)
        return self.wait(run["id"], progress) if wait and run["status"] in ("queued", "running") else run

    def wait(self, id: str, progress: Shown = None) -> dict[str, Any]:
        """The run when it has ended. `progress`: whether to show a bar, or a function of the share done.

        None: in a terminal and in a notebook.
        """
        seconds = 30 if progress is False else 0.3
        with progress_bar(progress) as show:
            while (now := self.get(f"/api/runs/{id}/progress?wait={seconds}"))["status"] in ("queued", "running"):
                show(now["progress"])
        return self.get(f"/api/runs/{id}")

    def cancel(self, id: str) -> dict[str, Any]:
        """Ask a run to stop."""
        return self.post(f"/api/runs/{id}/cancel")

    def data(
        self, id: str, columns: Sequence[str] | None = None, start: float | None = None, end: float | None = None
    ) -> dict[str, np.ndarray]:
        """Columns of a run by name, float64, exactly as they were computed. `*` in a name stands for anything."""
        query: dict[str, object] = {"format": "json", "encoding": "bdata"}
        query |= {"columns": ",".join(columns)} if columns else {}
        query |= {name: value for name, value in (("from", start), ("to", end)) if value is not None}
        found = self.get(f"/api/runs/{id}/data?{urlencode(query)}")["columns"]
        return {name: np.frombuffer(base64.b64decode(item["bdata"]), "<f8") for name, item in found.items()}

    def frame(
        self,
        id: str,
        kind: str = "polars",
        columns: Sequence[str] | None = None,
        start: float | None = None,
        end: float | None = None,
    ) -> Any:
        """Columns of a run as a frame of polars or pandas."""
        return frame_of(self.data(id, columns, start, end), kind)

    def print_figure(self, id: str, name: str, **settings: object) -> bytes:
        """A figure of a run for a paper: format="pdf" (svg, png, tex), width=8.5 in cm, and the other options."""
        body = json.dumps({"format": "pdf", **settings}).encode()
        return self.request("POST", f"/api/runs/{id}/figures/{quote(name, safe='')}/print", body)[2]

    def figure(self, id: str, name: str, theme: str = "light") -> dict[str, Any]:
        """A figure of a run as Plotly's JSON."""
        return self.get(f"/api/runs/{id}/figures/{quote(name, safe='')}?theme={theme}")

    def report(self, id: str) -> str:
        """A run as one HTML file."""
        return self.request("GET", f"/api/runs/{id}/report")[2].decode()

    def get(self, path: str) -> Any:
        """The JSON at a path. Raises :class:`ServiceError`."""
        return json.loads(self.request("GET", path)[2])

    def post(self, path: str, data: object = None, headers: Mapping[str, str] | None = None) -> Any:
        """The JSON answer to a POST. Raises :class:`ServiceError`."""
        body = None if data is None else json.dumps(data).encode()
        return json.loads(self.request("POST", path, body, headers)[2])

    def request(
        self, method: str, path: str, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> tuple[int, Mapping[str, str], bytes]:
        """Status, headers and body of the answer. Raises :class:`ServiceError` from status 400 on."""
        kind = {} if body is None else {"Content-Type": "application/json"}
        headers = {**self._access, **kind, **(headers or {})}
        try:
            self._connection.request(method, self._base + path, body, headers)
            answer = self._connection.getresponse()
        except (HTTPException, ConnectionError):  # the server may have closed a connection that was idle
            self._connection.close()
            self._connection.request(method, self._base + path, body, headers)
            answer = self._connection.getresponse()
        content = answer.read()
        if answer.status >= 400:
            raise ServiceError(answer.status, _problem(content))
        return answer.status, dict(answer.headers), content


def _problem(content: bytes) -> dict[str, Any]:
    try:
        return json.loads(content)
    except ValueError:
        return {"title": "no problem document", "detail": content[:200].decode(errors="replace")}
