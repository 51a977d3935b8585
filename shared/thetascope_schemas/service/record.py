"""A record: measurements of a real plant, to be diagnosed."""

from math import sin
from typing import Annotated

from pydantic import Field

from thetascope_schemas.experiment.base import MAX_OBSERVERS, Strict, example
from thetascope_schemas.experiment.experiment import PlantChoice
from thetascope_schemas.experiment.measurement import ColumnMapping, RecordSettings
from thetascope_schemas.experiment.observers import ObserverConfig

MOST_ROWS = 200_000
Column = Annotated[list[float], Field(max_length=MOST_ROWS)]


def _example() -> dict[str, list[float]]:
    """Return two seconds of a motor at rest, as its sensors see it: 201 rows."""
    rows = range(201)
    noise = [round(0.003 * sin(1e3 * sin(12.9898 * k + c)), 5) for c in (0.0, 1.0) for k in rows]
    t = [round(0.01 * k, 2) for k in rows]
    return {"t": t, "torque": [0.0] * 201, "y_speed": noise[:201], "y_acceleration": noise[201:]}


class RecordRunRequest(Strict):
    """Observers that are to run on a stored record, with its plant, mapping and diagnosis."""

    model_config = example(
        plant="dts200",
        mapping={"time": None, "quantities": {}},
        settings={"false_alarms": 0.01},
        observers=[{"label": "ekf", "kind": "joint-ekf"}],
    )

    plant: PlantChoice = Field(description="Id of a library plant, or a complete plant.")
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guessed mapping.")
    settings: RecordSettings = Field(default_factory=RecordSettings, description="Settings of the diagnosis.")
    observers: tuple[ObserverConfig, ...] = Field(
        default=(ObserverConfig(label="ekf", kind="joint-ekf"),),
        max_length=MAX_OBSERVERS,
        description="The observers; by default a joint extended Kalman filter.",
    )


class Record(Strict):
    """Samples of times, inputs, signals and outputs of the plant: columns, or CSV with a header."""

    model_config = example(plant="friction-motor", columns=_example())

    plant: PlantChoice = Field(description="Id of a library plant, or a complete plant.")
    columns: dict[str, Column] | None = Field(
        default=None, max_length=200, description="Columns by name, all of the same length; or give `csv`."
    )
    csv: str | None = Field(default=None, description="Text of a CSV file; or give `columns`.")
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guessed mapping.")
    settings: RecordSettings = Field(default_factory=RecordSettings, description="Settings of the diagnosis.")
