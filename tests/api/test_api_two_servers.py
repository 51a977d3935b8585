"""Two servers on one store: the second one refuses, or joins for reading only, and the first one's runs go on."""

import os
import subprocess
import sys

import pytest

from tests.api.conftest import ROOT, service, until
from tests.store.samples import made_record
from thetascope.client import Client, ServiceError
from thetascope.store import Database, RunStore

#: Computes for long, and does not fit a test.
LONG = {"experiment": "zhao-2012", "set": {"horizon": 9000, "record": 1, "evaluate": 0.1}}


def test_a_second_server_refuses_or_reads_and_fails_no_run_of_the_first(tmp_path):
    """A run stays under way through all of it; the second server can neither cancel nor remove it."""
    with service(tmp_path) as first, Client(first) as client:
        long = client.post("/api/runs?wait=0", LONG)["id"]
        call = [sys.executable, "-m", "thetascope.cli.main", "serve", "--port", "0"]
        environment = os.environ | {"THETASCOPE_DATA": str(tmp_path)}
        refused = subprocess.run(
            call, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120, check=False
        )
        assert refused.returncode == 1 and refused.stderr.count("\n") == 1
        assert "belongs to a running server (process " in refused.stderr and "--read-only" in refused.stderr
        with service(tmp_path, read_only=1) as second, Client(second) as reader:
            until(lambda: [run["id"] for run in reader.get("/api/runs")["runs"]] == [long])
            beside = Database(tmp_path / "runs.sqlite")  # as `thetascope run` opens it
            RunStore(beside, 10**9).put(made_record("beside", created=0.0))
            assert [run["id"] for run in reader.get("/api/runs")["runs"]] == [long, "beside"]
            beside.close()
            assert reader.get("/api/health/ready")["status"] == "ready"
            for method, path in (("DELETE", long), ("POST", f"{long}/cancel")):
                with pytest.raises(ServiceError, match="another server") as refusal:
                    reader.request(method, f"/api/runs/{path}")
                assert refusal.value.status == 403
        assert client.get(f"/api/runs/{long}/progress")["status"] in ("queued", "running")
        client.cancel(long)
