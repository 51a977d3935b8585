"""An experiment: a plant, what is done to it, what is measured, and which observers watch."""

import hashlib
import json
import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import Discriminator, Field, Tag, model_validator

from thetascope_schemas.experiment.base import (
    MAX_FAULTS,
    MAX_OBSERVERS,
    MAX_STEPS,
    SCHEMA_VERSION,
    Identifier,
    Number,
    Positive,
    Prose,
    Reference,
    Seed,
    Strict,
    Title,
    canonical,
    example,
)
from thetascope_schemas.experiment.commands import MAX_COMMANDS, AddObserver, TimedCommand
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.figures import Figure
from thetascope_schemas.experiment.measurement import ContinuousMeasurement, Noise, SampledMeasurement
from thetascope_schemas.experiment.observers import ObserverConfig
from thetascope_schemas.experiment.plant import Plant, check_known, check_within
from thetascope_schemas.experiment.signals import ConstantSignal, Signal
from thetascope_schemas.texts.refusal import refuse, suggestion

ROWS = 10_000
"""Recorded rows when an experiment does not give the spacing."""


def _plant_kind(value: object) -> str:
    return "library" if isinstance(value, str) else "inline"


PlantChoice = Annotated[
    Annotated[Identifier, Tag("library")] | Annotated[Plant, Tag("inline")], Discriminator(_plant_kind)
]


class Experiment(Strict):
    """Everything that determines a run. The same spec gives the same numbers, bit for bit."""

    model_config = example(
        id="bias-step",
        title="A sensor bias",
        description="",
        source="",
        errata=[],
        plant="contois",
        parameters={"a4": 0.1},
        initial={"x1": 0.09, "x2": 0.01},
        inputs={"u": {"kind": "steps", "times": [10, 20], "values": [0.08, 0.02, 0.08]}},
        signals={},
        faults=[{"channel": "theta3", "shape": "step", "onset": 20, "size": 0.02}],
        noise={"y": {"std": 0.001, "sample_time": 0.01}},
        seed=1,
        horizon=100,
        step=0.001,
        record=0.01,
        measurement={"mode": "continuous"},
        observers=[{"label": "adaptive", "kind": "zhao-adaptive"}],
        diagnosis={"false_alarms": 0.01},
        figures=[],
    )
    prose = Strict.prose | {"id", "errata", "figures"}

    id: Identifier = "experiment"
    title: Title = ""
    description: Prose = ""
    source: Prose = Field(default="", description="Where the experiment comes from.")
    errata: tuple[Prose, ...] = Field(
        default=(), max_length=50, description="Where the printed source cannot be right."
    )
    plant: PlantChoice = Field(description="Id of a library plant, or a plant in full.")
    parameters: dict[Reference, Number] = Field(default_factory=dict, description="Parameters that differ.")
    initial: dict[Reference, Number] = Field(default_factory=dict, description="Initial states that differ.")
    inputs: dict[Reference, Signal] = Field(default_factory=dict, description="Input: its course u(t).")
    signals: dict[Reference, Signal] = Field(default_factory=dict, description="Known signal: its course φ(t).")
    faults: tuple[Fault, ...] = Field(default=(), max_length=MAX_FAULTS)
    noise: dict[Reference, Noise] = Field(default_factory=dict, description="Output: its measurement noise.")
    seed: Seed = Field(default=0, description="Seed of all random numbers.")
    horizon: Positive = Field(description="End of the run in s.")
    step: Positive = Field(default=0.001, description="Step of the integration in s; the period of a discrete plant.")
    record: Positive | None = Field(
        default=None, description="Spacing of recorded rows in s, a multiple of the step; null: about 10 000 rows."
    )
    substeps: Annotated[int, Field(ge=1, le=64)] | None = Field(
        default=None, description="Steps that are taken within each step; null: one, or as many as stiff gains need."
    )
    measurement: ContinuousMeasurement | SampledMeasurement = Field(
        default_factory=ContinuousMeasurement, discriminator="mode"
    )
    observers: tuple[ObserverConfig, ...] = Field(default=(), max_length=MAX_OBSERVERS)
    commands: tuple[TimedCommand, ...] = Field(
        default=(),
        max_length=MAX_COMMANDS,
        description="What is changed while it runs, in order of time; faults apart.",
    )
    diagnosis: DiagnosisSettings = Field(
        default_factory=DiagnosisSettings, description="What is asked of the diagnosis."
    )
    figures: tuple[Figure, ...] = Field(default=(), max_length=24)

    @property
    def record_every(self) -> int:
        """Steps between two recorded rows."""
        if self.record is not None:
            return round(self.record / self.step)
        return max(1, round(self.horizon / ROWS / self.step))

    @property
    def record_interval(self) -> float:
        """Time in s between two recorded rows: `record`, or max(step, horizon/10000) as a multiple of the step."""
        return self.record if self.record is not None else self.record_every * self.step

    @property
    def plant_id(self) -> str:
        """Id of the plant, given by its id or in full."""
        return self.plant.id if isinstance(self.plant, Plant) else self.plant

    def with_plant(self, plant: Plant) -> "ResolvedExperiment":
        """Return this experiment with `plant` in full, all names checked against it.

        Raises:
            pydantic.ValidationError: where the experiment does not fit the plant.
        """
        return ResolvedExperiment.model_validate(
            {name: getattr(self, name) for name in type(self).model_fields} | {"plant": plant}
        )

    def canonical(self) -> bytes:
        """The one spelling of what determines the numbers of a run, as JSON in UTF-8 with sorted keys.

        Defaults are filled in (with an inline plant, its parameters, initial states, inputs and signals too), 1 and
        1.0, 0.0 and -0.0, and runs of blanks in text are one. Left out, because no number depends on them: id, title,
        description, source, errata and figures of the experiment, and id, titles, descriptions, sources and units
        within an inline plant. The id of a library plant is kept as it is: put the plant in (`with_plant`) before
        hashing, so that the hash follows the plant's equations and not its name.
        """
        filled: dict[str, object] = {
            name: getattr(self, name) for name in type(self).model_fields if name not in self.prose
        }
        filled["record"] = self.record_interval
        if isinstance(self.plant, Plant):
            plant = self.plant
            filled["parameters"] = {item.name: item.value for item in plant.parameters} | self.parameters
            filled["initial"] = {item.name: item.initial for item in plant.states} | self.initial
            filled["inputs"] = {item.name: ConstantSignal(value=item.default) for item in plant.inputs} | self.inputs
            filled["signals"] = {item.name: item.default for item in plant.signals} | self.signals
        document = {"schema": SCHEMA_VERSION, "experiment": canonical(filled)}
        return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()

    def spec_hash(self) -> str:
        """First 32 hexadecimal digits of the SHA-256 of `canonical()`: the id of the run."""
        return hashlib.sha256(self.canonical()).hexdigest()[:32]

    @model_validator(mode="after")
    def _consistent(self) -> "Experiment":
        self._check_times()
        self._check_labels()
        self._check_commands()
        if isinstance(self.plant, Plant):
            self._check_plant(self.plant)
            for index, figure in enumerate(self.figures):
                self._check_columns(self.plant, f"figures[{index}]", figure)
        return self

    def observer_configs(self) -> dict[str, ObserverConfig]:
        """Return every observer that runs at some time, by label: those from the start, then those that commands add.

        Where a label is removed and added again, the configuration is the last one, as in the result.
        """
        added = [command.observer for command in self.commands if isinstance(command, AddObserver)]
        return {config.label: config for config in (*self.observers, *added)}

    def _check_times(self) -> None:
        if self.step > self.horizon:
            raise refuse("experiment.step.beyond-horizon", "step", self.step, step=self.step, horizon=self.horizon)
        for path, item in self._timed():
            if (found := self.too_often(item)) is not None:
                field, interval, code, args = found
                raise refuse(code, f"{path}.{field}".lstrip("."), interval, **args)
        if self.record is not None:
            self._check_record(self.record)

    def too_often(self, item: object) -> tuple[str, float, str, dict[str, float]] | None:
        """Return the first interval of a signal, fault, noise or command of which the horizon holds too many.

        Returns:
            its field, its value in s, and the code of the problem with its arguments; None where every interval is long
            enough.
        """
        for field in ("step", "period", "hold", "sample_time"):
            interval = getattr(item, field, None)
            if interval is not None and (count := self.horizon / interval) > MAX_STEPS:
                args = {"horizon": self.horizon, "interval": interval, "count": count, "limit": float(MAX_STEPS)}
                return field, interval, "experiment.interval.too-short", args | {"least": self.horizon / MAX_STEPS}
        return None

    def _check_record(self, record: float) -> None:
        steps = record / self.step
        if record > self.horizon:
            raise refuse("experiment.record.beyond-horizon", "record", record, horizon=self.horizon)
        if round(steps) < 1 or not math.isclose(steps, round(steps), rel_tol=1e-9):
            near = max(1, round(steps)) * self.step
            raise refuse("experiment.time.no-multiple", "record", record, time=record, step=self.step, near=near)

    def _timed(self) -> Iterator[tuple[str, object]]:
        """Everything that has an interval, with its path: the experiment itself, the measurement, signals, noise, faults, commands."""
        yield "", self
        yield "measurement", self.measurement
        groups = [("inputs", self.inputs), ("signals", self.signals), ("noise", self.noise)]
        if isinstance(self.plant, Plant):
            groups.append(("plant.signals", {item.name: item.default for item in self.plant.signals}))
        for group, named in groups:
            for name, item in named.items():
                yield f"{group}.{name}", item
        for group, listed in (("faults", self.faults), ("commands", self.commands)):
            for index, item in enumerate(listed):
                yield f"{group}[{index}]", item
                yield f"{group}[{index}].signal", getattr(item, "signal", None)

    def _check_labels(self) -> None:
        for field, names in (
            ("observers[{}].label", [item.label for item in self.observers]),
            ("figures[{}].name", [item.name for item in self.figures]),
        ):
            for index, name in enumerate(names):
                if name in names[:index]:
                    raise refuse("experiment.name.repeated", field.format(index), name, name=name)

    def _check_commands(self) -> None:
        before = 0.0
        for index, command in enumerate(self.commands):
            steps = command.at / self.step
            if not math.isclose(steps, round(steps), rel_tol=1e-9, abs_tol=1e-6):
                near = {"time": command.at, "step": self.step, "near": round(steps) * self.step}
                raise refuse("experiment.time.no-multiple", f"commands[{index}].at", command.at, **near)
            if command.at < before:
                raise refuse(
                    "command.at.not-ordered", f"commands[{index}].at", command.at, at=command.at, before=before
                )
            before = command.at

    def _check_plant(self, plant: Plant) -> None:
        """Every name that the experiment mentions is one of the plant's."""
        check_known(self.parameters, plant.names("parameters"), "parameters", "plant.parameter.unknown")
        for item in plant.parameters:
            if item.name in self.parameters:
                value, field = self.parameters[item.name], f"parameters.{item.name}"
                check_within(value, item.bounds, field, item.name)
        check_known(self.initial, plant.names("states"), "initial", "plant.state.unknown")
        check_known(self.inputs, plant.names("inputs"), "inputs", "plant.input.unknown")
        check_known(self.signals, plant.names("signals"), "signals", "plant.signal.unknown")
        check_known(self.noise, plant.names("outputs"), "noise", "plant.output.unknown")
        for index, fault in enumerate(self.faults):
            kind, name = fault.site
            known = plant.names(f"{kind}s")
            if name not in known:
                field = f"faults[{index}].{kind}"
                raise refuse(f"plant.{kind}.unknown", field, name, name=name, remedy=suggestion(name, known))
        if plant.time.kind == "discrete" and not math.isclose(self.step, plant.time.period, rel_tol=1e-9):
            period = plant.time.period
            raise refuse("experiment.step.not-period", "step", self.step, period=period, step=self.step)

    def _check_columns(self, plant: Plant, path: str, figure: Figure) -> None:
        """Figures draw columns that a result has; of an observer's columns only the label is known here."""
        groups = {"u": "inputs", "signal": "signals", "x": "states", "theta": "channels", "y": "outputs"}
        own = ["t"] + [f"{prefix}.{name}" for prefix, group in groups.items() for name in plant.names(group)]
        labels = list(self.observer_configs())
        for field, column in figure.columns():
            label, _, rest = column.partition(".")
            if column in own or (label in labels and rest):
                continue
            hint = suggestion(column, own + [f"{name}.…" for name in labels])
            raise refuse("figure.column.unknown", f"{path}.{field}", column, name=column, remedy=hint)


class ResolvedExperiment(Experiment):
    """An experiment that holds its plant in full. JSON and hash are those of the same data as an `Experiment`."""

    model_config = example(
        plant={
            "id": "lag",
            "states": [{"name": "x"}],
            "inputs": [{"name": "u", "default": 1}],
            "outputs": [{"name": "y", "expression": "x"}],
            "dynamics": {"x": "u - x"},
            "channels": [{"name": "theta", "kind": "actuator", "enters": {"x": "1"}}],
        },
        horizon=10,
    )

    # Narrower is sound, as instances are frozen; pyright cannot see that in pydantic's configuration.
    plant: Plant = Field(description="The plant in full.")  # pyright: ignore[reportIncompatibleVariableOverride]
