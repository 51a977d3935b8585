"""Whether the service is alive and ready, and what it holds."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, example

_RUNS = {"active": 1, "runs": 12, "results": 10, "bytes": 48_000_000, "limit": 2_147_483_648}
_WORK = {"running": 1, "waiting": 0}
_CHECK = {"name": "store", "ok": True, "detail": "can be written"}


class RunUsage(Strict):
    """Runs and the space of their results."""

    model_config = example(**_RUNS)

    active: int = Field(description="Runs that wait or are computed.")
    runs: int = Field(description="Runs in the store.")
    results: int = Field(description="Results in the store.")
    bytes: int = Field(description="Bytes of these results.")
    limit: int = Field(description="Bytes that results may take.")


class WorkUsage(Strict):
    """Computations in worker processes."""

    model_config = example(**_WORK)

    running: int
    waiting: int


class Health(Strict):
    """The versions and the usage of the service."""

    model_config = example(
        status="ok", version="0.1.0", schema_version=1, engine="b079398157ae2a57", runs=_RUNS, workers=_WORK
    )

    status: Literal["ok"]
    version: str = Field(description="Version of the program.")
    schema_version: int = Field(description="Version of the schemas.")
    engine: str = Field(description="Version of the numbers: results of other versions are computed again.")
    runs: RunUsage
    workers: WorkUsage


class Alive(Strict):
    """The service answers."""

    model_config = example(status="alive")

    status: Literal["alive"]


class ReadyCheck(Strict):
    """One condition for accepting work."""

    model_config = example(**_CHECK)

    name: Literal["store", "disk", "queue"]
    ok: bool
    detail: str = Field(description="Its present value, or why it does not hold.")


class Ready(Strict):
    """Whether the service accepts work; status 503 if it does not."""

    model_config = example(status="ready", checks=[_CHECK], free=72_000_000_000)

    status: Literal["ready", "not ready"]
    checks: tuple[ReadyCheck, ...]
    free: Number = Field(description="Free bytes of the folder of the store.")
