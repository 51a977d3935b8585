"""Whether the service is alive and ready, and what it holds."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict


class RunUsage(Strict):
    """Runs and the space of their results."""

    active: int = Field(description="Runs that wait or are computed.")
    runs: int = Field(description="Runs in the store.")
    results: int = Field(description="Results in the store.")
    bytes: int = Field(description="Bytes of these results.")
    limit: int = Field(description="Bytes that results may take.")


class WorkUsage(Strict):
    """Computations in worker processes."""

    running: int
    waiting: int


class Health(Strict):
    """The versions and the usage of the service."""

    status: Literal["ok"]
    version: str = Field(description="Version of the program.")
    schema_version: int = Field(description="Version of the schemas.")
    engine: str = Field(description="Version of the numbers: results of other versions are computed again.")
    runs: RunUsage
    workers: WorkUsage


class Alive(Strict):
    """The service answers."""

    status: Literal["alive"]


class ReadyCheck(Strict):
    """One condition for accepting work."""

    name: Literal["store", "disk", "queue"]
    ok: bool
    detail: str = Field(description="Its present value, or why it does not hold.")


class Ready(Strict):
    """Whether the service accepts work; status 503 if it does not."""

    status: Literal["ready", "not ready"]
    checks: tuple[ReadyCheck, ...]
    free: Number = Field(description="Free bytes of the folder of the store.")
