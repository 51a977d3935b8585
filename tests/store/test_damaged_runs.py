"""The service on a store of either kind: runs that were damaged on the disk between two starts."""

from collections.abc import Callable, Iterator
from contextlib import closing

import pytest

from tests.api.conftest import service, until
from tests.runs.samples import spec, spec_data
from tests.runs.test_manager import completed, numbers
from thetascope.api.http.services import Services
from thetascope.client import Client, ServiceError
from thetascope.runs.jobs.job import Job
from thetascope.runs.jobs.manager import RunManager
from thetascope.runs.specs.refusals import NotReady, Unknown
from thetascope.settings import Settings, load
from thetascope.store import Damaged, Database


@pytest.fixture
def settings(place: str, tmp_path) -> Settings:
    return load({}, data=tmp_path, database=place, workers=1)


@pytest.fixture
def start(settings: Settings) -> Iterator[Callable[[], RunManager]]:
    """Start a manager on the store; the one before is stopped first."""
    running: list[Services] = []

    def start_one() -> RunManager:
        if running:
            running.pop().close()
        running.append(Services.start(settings))
        return running[0].runs

    yield start_one
    for services in running:
        services.close()


def change(place: str, statement: str) -> None:
    with closing(Database(place)) as database, database.writing() as connection:
        connection.exec_driver_sql(statement)


@pytest.mark.parametrize("place", ["sqlite"], indirect=True)
def test_damaged_runs_are_errors_with_their_ids_and_are_computed_again(place, start):
    """A result, a summary and an experiment, one after the other; the numbers are the same bits afterwards."""
    runs = start()
    id = completed(runs, spec()).id
    data = numbers(runs, id).copy().tobytes()

    runs = start()
    change(place, "UPDATE results SET head = replace(head, '0', '1')")
    with pytest.raises(Damaged, match=rf"result of run {id} is damaged"):
        runs.finished(id)
    assert numbers(runs, id).tobytes() == data

    runs = start()
    change(place, "UPDATE runs SET summary = replace(summary, '1', '2')")
    assert runs.get(id).status == "failed" and runs.get(id).problem.code == "store.run-damaged"
    assert runs.get(id).spec == spec() and runs.get(id).summary is None
    with pytest.raises(NotReady, match=f"outcome of run {id} is damaged"):
        runs.finished(id)
    again = runs.submit(spec())
    assert isinstance(again, Job) and again.done.result(60).status == "done"
    assert numbers(runs, id).tobytes() == data

    runs = start()
    change(place, "UPDATE runs SET spec = replace(spec, '1', '2')")
    with pytest.raises(Damaged, match=f"experiment of run {id} is damaged"):
        runs.get(id)
    assert completed(runs, spec()).id == id

    runs = start()
    change(place, "UPDATE runs SET spec = replace(spec, '1', '2')")
    runs.remove(id)
    with pytest.raises(Unknown):
        runs.get(id)


def test_the_interface_lists_damaged_runs_and_names_them_in_problems(postgresql, tmp_path):
    """`damaged` in the list beside the others, and problem documents for the run and its data; on PostgreSQL."""
    with service(tmp_path / "absent", database=postgresql, wait=60, memory=1) as address, Client(address) as client:
        hit, other, last = (client.post("/api/runs?wait=60", spec_data(seed=i))["id"] for i in (1, 2, 3))
        assert client.get("/api/health/ready")["status"] == "ready"
        until(lambda: client.health()["runs"]["results"] == 3)  # and only the last one is in memory
        change(postgresql, f"UPDATE runs SET spec = replace(spec, '1', '2') WHERE id = '{hit}'")
        change(postgresql, f"UPDATE results SET head = replace(head, '1', '2') WHERE id = '{other}'")
        listed = {run["id"]: run["status"] for run in client.get("/api/runs")["runs"]}
        assert listed == {hit: "damaged", other: "done", last: "done"}
        for path, name in ((hit, hit), (f"{other}/data", other)):
            with pytest.raises(ServiceError, match=f"run {name} is damaged") as error:
                client.get(f"/api/runs/{path}")
            assert error.value.status == 500
        assert len(client.data(other)["t"]) == 1001
        assert client.request("DELETE", f"/api/runs/{hit}")[0] == 204
        assert {run["id"] for run in client.get("/api/runs")["runs"]} == {other, last}
        assert client.post("/api/runs?wait=60", spec_data(seed=1))["status"] == "done"
        assert len(client.data(hit)["t"]) == 1001
