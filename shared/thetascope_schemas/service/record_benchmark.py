"""A benchmark of recorded data: files that a user has, the faults that they are known to hold, and published scores."""

from typing import Annotated

from pydantic import Field

from thetascope_schemas.experiment.base import NonNegative, Number, Positive, Reference, Strict, Title, example
from thetascope_schemas.experiment.faults import Site
from thetascope_schemas.experiment.measurement import COLUMN_MAPPING, ColumnMapping, RecordSettings

_FAULT = {"channel": "bias1", "onset": 300.0, "end": None, "size": 3.0}
_SCORE = {"method": "PCA, T²", "found": True, "delay": 48.0, "source": "Table 3 of its paper"}
_RECORD = {
    "file": "run-7.csv",
    "sha256": "0" * 64,
    "plant": "two-heaters.yaml",
    "mapping": COLUMN_MAPPING,
    "faults": [_FAULT],
    "published": [_SCORE],
}
Line = Annotated[str, Field(max_length=500)]


class RecordedFault(Strict):
    """A fault that a record is known to hold."""

    model_config = example(**_FAULT)

    channel: Reference = Field(description="Fault channel of the plant.")
    onset: NonNegative = Field(description="Time in s after the first row at which it begins.")
    end: Positive | None = Field(
        default=None, description="Time in s after the first row at which it ends; null: never."
    )
    size: Number | None = Field(default=None, description="Its size at its end; null: not known.")

    @property
    def site(self) -> Site:
        """Return the place where it acts."""
        return Site("channel", self.channel)

    @property
    def shape(self) -> str:
        """Return its shape, which is not known."""
        return "table"


class PublishedScore(Strict):
    """What a publication reports for a record; nothing is computed from it."""

    model_config = example(**_SCORE)

    method: Line = Field(description="The method.")
    found: bool | None = Field(default=None, description="Whether it found the fault; null: not reported.")
    delay: NonNegative | None = Field(default=None, description="Delay in s; null: not reported.")
    source: Line = Field(description="Where it is published.")


class BenchmarkRecord(Strict):
    """One file of a benchmark."""

    model_config = example(**_RECORD)

    file: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="Name of the file in the folder.")
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] = Field(description="SHA-256 of the file.")
    plant: Annotated[str, Field(min_length=1, max_length=200)] = Field(
        description="Id of a library plant, or name of a plant file in the folder."
    )
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guessed mapping.")
    settings: RecordSettings = Field(default_factory=RecordSettings, description="Settings of the diagnosis.")
    faults: tuple[RecordedFault, ...] = Field(default=(), max_length=40, description="Known faults; none: healthy.")
    published: tuple[PublishedScore, ...] = Field(default=(), max_length=40, description="Scores of other methods.")


class RecordBenchmark(Strict):
    """The file `benchmark.yaml` of a folder with records."""

    model_config = example(title="Two heaters", source="where the files were downloaded", records=[_RECORD])

    title: Title = Field(description="Title of the benchmark.")
    source: Line = Field(default="", description="Where the files come from, and under what licence.")
    records: tuple[BenchmarkRecord, ...] = Field(min_length=1, max_length=1000)
