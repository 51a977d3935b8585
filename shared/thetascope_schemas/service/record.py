"""What was recorded on a real plant, to be diagnosed."""

from typing import Annotated

from pydantic import Field

from thetascope_schemas.experiment.base import NonNegative, Strict, example
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.experiment import PlantChoice

MOST_ROWS = 200_000
Column = Annotated[list[float], Field(max_length=MOST_ROWS)]


class Record(Strict):
    """Samples at equal distances, as columns or as CSV text with a line of names: ``t``, inputs, signals and outputs of the plant."""

    model_config = example(plant="friction-motor", csv="t,torque,y_speed,y_acceleration\n0,0.5,0.01,0.05\n…", learn=2.0)

    plant: PlantChoice = Field(description="Id of a library plant, or a plant in full.")
    columns: dict[str, Column] | None = Field(
        default=None, max_length=200, description="Columns by name, all as long …"
    )
    csv: str | None = Field(default=None, description="… or the text of a CSV file.")
    learn: NonNegative = Field(
        default=0.0,
        description="Seconds at its beginning that are known to be sound: what they show belongs to the plant.",
    )
    diagnosis: DiagnosisSettings = Field(
        default_factory=DiagnosisSettings, description="What is asked of the diagnosis."
    )
