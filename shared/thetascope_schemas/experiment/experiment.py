"""An experiment: a plant, its inputs and faults, the measurement, and the observers that run."""

import math
from collections.abc import Iterator, Sequence
from typing import Annotated

from pydantic import BeforeValidator, Discriminator, Field, PrivateAttr, Tag, model_validator

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
    check_known,
    digest,
    encoded,
    example,
)
from thetascope_schemas.experiment.commands import AddObserver, OfTruth, SetTruth, TimedCommands
from thetascope_schemas.experiment.controllers import check_multiple, set_reference
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.figures import Figure, Notes
from thetascope_schemas.experiment.measurement import ContinuousMeasurement, Noise, SampledMeasurement, Truth
from thetascope_schemas.experiment.observers import ObserverConfig
from thetascope_schemas.experiment.plant import Plant, check_within
from thetascope_schemas.experiment.signals import ConstantSignal, Signal
from thetascope_schemas.texts.refusal import refuse, suggestion

ROWS = 10_000
"""Most rows at which a run is examined if an experiment does not set `evaluate`."""


def _plant_kind(value: object) -> str:
    return "library" if isinstance(value, str) else "inline"


def names_a_file(plant: str) -> bool:
    """Return whether the text under `plant` is the path of a file, not an id."""
    return "/" in plant or "\\" in plant or plant.lower().endswith((".yaml", ".yml", ".json"))


def _no_file(plant: object) -> object:
    """Return the id of a plant; refuse a path, which the service never opens."""
    if isinstance(plant, str) and names_a_file(plant):
        raise refuse("experiment.plant.file", value=plant[:80])
    return plant


PlantName = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}(@[0-9]{1,9})?$")]
"""Id of a library plant, or of one that the sender has saved; `id@7` is its version 7."""
PlantChoice = Annotated[
    Annotated[PlantName, BeforeValidator(_no_file), Tag("library")] | Annotated[Plant, Tag("inline")],
    Discriminator(_plant_kind),
]


class Experiment(Strict):
    """Everything that determines a run. The same spec gives the same numbers, bit for bit."""

    model_config = example(
        id="bias-step",
        title="A sensor bias",
        description="",
        source="",
        errata=[],
        plant="zhao-contois",
        parameters={"a4": 0.1},
        initial={"x1": 0.09, "x2": 0.01},
        inputs={"u": {"kind": "steps", "times": [10, 20], "values": [0.08, 0.02, 0.08]}},
        signals={},
        faults=[{"channel": "theta3", "shape": "step", "onset": 20, "size": 0.02}],
        noise={"y": {"std": 0.001, "sample_time": 0.01}},
        seed=1,
        horizon=100,
        step=0.001,
        record=0.05,
        evaluate=0.01,
        measurement={"mode": "continuous"},
        observers=[{"label": "adaptive", "kind": "zhao-adaptive"}],
        diagnosis={"false_alarms": 0.01},
        figures=[],
        notes=[{"id": "overshoot", "t": 45.3, "text": "The EKF overshoots here."}],
    )
    prose = Strict.prose | {"id", "errata", "figures", "notes"}

    id: Identifier = "experiment"
    title: Title = ""
    description: Prose = ""
    source: Prose = Field(default="", description="Source of the experiment, such as a paper and its figure.")
    errata: tuple[Prose, ...] = Field(default=(), max_length=50, description="Errors in the printed source.")
    plant: PlantChoice = Field(
        description="Id of a library plant or of one that the sender has saved, or a complete plant."
    )
    parameters: dict[Reference, Number] = Field(
        default_factory=dict, description="Parameters that differ from the plant's values."
    )
    initial: dict[Reference, Number] = Field(
        default_factory=dict, description="Initial states that differ from the plant's values."
    )
    inputs: dict[Reference, Signal] = Field(
        default_factory=dict,
        description="Inputs u(t) and references r(t) that differ from the plant's defaults, by name.",
    )
    signals: dict[Reference, Signal] = Field(
        default_factory=dict, description="Known signals φ(t) that differ from the plant's defaults, by name."
    )
    faults: tuple[Fault, ...] = Field(default=(), max_length=MAX_FAULTS)
    noise: dict[Reference, Noise] = Field(
        default_factory=dict, description="Measurement noise of each output, by name."
    )
    seed: Seed = Field(default=0, description="Seed of all random numbers.")
    horizon: Positive = Field(description="End of the run in s.")
    step: Positive = Field(default=0.001, description="Integration step in s; the period of a discrete plant.")
    record: Positive | None = Field(
        default=None, description="Spacing of the result's rows in s, a multiple of the step; null: as `evaluate`."
    )
    evaluate: Positive | None = Field(
        default=None,
        description="Spacing in s of the rows at which checks, bands, excitation and the detector examine the run, a "
        "multiple of the step; null: 1, 2 or 5·10^k steps, so that there are at most 10 000 rows. A live session shows "
        "these rows.",
    )
    substeps: Annotated[int, Field(ge=1, le=64)] | None = Field(
        default=None, description="Substeps of each integration step; null: as many as its accuracy needs."
    )
    measurement: ContinuousMeasurement | SampledMeasurement = Field(
        default_factory=ContinuousMeasurement, discriminator="mode"
    )
    truth: Truth = Field(
        default_factory=Truth, description="Where the simulated plant differs from the model that observers know."
    )
    observers: tuple[ObserverConfig, ...] = Field(default=(), max_length=MAX_OBSERVERS)
    commands: TimedCommands = Field(
        default=(), description="Changes during the run other than faults, in order of time."
    )
    diagnosis: DiagnosisSettings = Field(default_factory=DiagnosisSettings, description="Settings of the diagnosis.")
    figures: tuple[Figure, ...] = Field(default=(), max_length=24)
    notes: Notes = Field(default=(), description="Notes and bookmarks on the time of the run.")

    @property
    def record_every(self) -> int:
        """Return the number of steps between two rows of the result."""
        return round(self.record / self.step) if self.record is not None else self.evaluate_every

    @property
    def record_interval(self) -> float:
        """Return the time in s between two rows of the result: `record`, or that between the examined rows."""
        return self.record if self.record is not None else self.evaluate_interval

    @property
    def evaluate_every(self) -> int:
        """Return the number of steps between two rows at which the run is examined."""
        if self.evaluate is not None:
            return round(self.evaluate / self.step)
        least = self.horizon / self.step / ROWS * (1 - 1e-9)
        return next(k for j in range(19) for k in (10**j, 2 * 10**j, 5 * 10**j) if k >= least)

    @property
    def evaluate_interval(self) -> float:
        """Return the time in s between two rows at which the run is examined; `record` does not change it."""
        return self.evaluate if self.evaluate is not None else self.evaluate_every * self.step

    @property
    def plant_id(self) -> str:
        """Return the id of the plant."""
        return self.plant.id if isinstance(self.plant, Plant) else self.plant

    def with_plant(self, plant: Plant) -> "ResolvedExperiment":
        """Return this experiment with a complete plant, all names checked against it.

        Raises:
            pydantic.ValidationError: if the experiment does not fit the plant.
        """
        plant = plant if self.truth.record is None else plant.without_controllers
        return ResolvedExperiment.model_validate(
            {name: getattr(self, name) for name in type(self).model_fields} | {"plant": plant}
        )

    def canonical(self) -> bytes:
        """Return a unique representation of everything that determines the numbers of a run: JSON, UTF-8, sorted keys.

        Defaults are filled in, those of an inline plant too. 1 and 1.0, 0.0 and -0.0, and different runs of blanks in
        text are the same. Omitted, because no number depends on them, are id, title, description, source, errata,
        figures and notes, and an inline plant's id, prose and units. The id of a library plant is kept: `with_plant`
        before hashing makes its equations count instead.
        """
        return encoded({"schema": SCHEMA_VERSION, "experiment": self._content()})

    def spec_hash(self) -> str:
        """Return the first 32 hexadecimal digits of the SHA-256 of `canonical()`, the id of the run."""
        return digest(self.canonical())

    def spec_hashes(self, seeds: Sequence[int]) -> list[str]:
        """Return `spec_hash()` of this experiment with each of these seeds."""
        whole = {"schema": SCHEMA_VERSION, "experiment": (content := self._content())}
        return [digest(encoded(whole | {"experiment": content | {"seed": seed}})) for seed in seeds]

    def _content(self) -> dict[str, object]:
        """Return what `canonical` encodes, without the schema's version."""
        filled: dict[str, object] = {n: getattr(self, n) for n in type(self).model_fields if n not in self.prose}
        filled |= {"record": self.record_interval, "evaluate": self.evaluate_interval}
        if self.truth == Truth():  # as before the field existed
            del filled["truth"]
        if isinstance(self.plant, Plant):
            plant = self.plant
            filled["parameters"] = {item.name: item.value for item in plant.parameters} | self.parameters
            starting = (*plant.states, *(s for c in plant.controllers for s in c.states))
            filled["initial"] = {item.name: item.initial for item in starting} | self.initial
            commanded = (*plant.inputs, *plant.references)
            filled["inputs"] = {item.name: ConstantSignal(value=item.default) for item in commanded} | self.inputs
            filled["signals"] = {item.name: item.default for item in plant.signals} | self.signals
        return {name: canonical(value) for name, value in filled.items()}

    @model_validator(mode="after")
    def _consistent(self) -> "Experiment":
        """Check all fields against each other, and against the plant if it is complete."""
        self._check_times()
        self._check_labels()
        self._check_commands()
        if isinstance(self.plant, Plant):
            self._check_plant(self.plant)
            for index, figure in enumerate(self.figures):
                self._check_columns(self.plant, f"figures[{index}]", figure)
        return self

    def observer_configs(self) -> dict[str, ObserverConfig]:
        """Return all observers by label: those that run from the start, then those that commands add.

        If a label is removed and added again, its configuration is the last one, as in the result.
        """
        added = [command.observer for command in self.commands if isinstance(command, AddObserver)]
        return {config.label: config for config in (*self.observers, *added)}

    def _check_times(self) -> None:
        """Refuse a step beyond the horizon, intervals too short for it, and an invalid spacing of rows."""
        if self.step > self.horizon:
            raise refuse("experiment.step.beyond-horizon", "step", self.step, step=self.step, horizon=self.horizon)
        for path, item in self._timed():
            if (problem := self.too_often(item)) is not None:
                field, interval, code, args = problem
                raise refuse(code, f"{path}.{field}".lstrip("."), interval, **args)
        for field in ("record", "evaluate"):
            if (interval := getattr(self, field)) is not None:
                self._check_rows(field, interval)

    def too_often(self, item: object) -> tuple[str, float, str, dict[str, float]] | None:
        """Return the first interval of a signal, fault, noise or command that is too short for the horizon.

        Returns:
            its field, its value in s, and the code of the problem with its arguments; None if all are long enough.
        """
        for field in ("step", "period", "hold", "sample_time"):
            interval = getattr(item, field, None)
            if interval is not None and (count := self.horizon / interval) > MAX_STEPS:
                args = {"horizon": self.horizon, "interval": interval, "count": count, "limit": float(MAX_STEPS)}
                return field, interval, "experiment.interval.too-short", args | {"least": self.horizon / MAX_STEPS}
        return None

    def _check_rows(self, field: str, interval: float) -> None:
        """Refuse a spacing of rows beyond the horizon or that is not a multiple of the step."""
        steps = interval / self.step
        if interval > self.horizon:
            raise refuse(f"experiment.{field}.beyond-horizon", field, interval, horizon=self.horizon)
        if round(steps) < 1 or not math.isclose(steps, round(steps), rel_tol=1e-9):
            near = max(1, round(steps)) * self.step
            raise refuse("experiment.time.no-multiple", field, interval, time=interval, step=self.step, near=near)

    def _timed(self) -> Iterator[tuple[str, object]]:
        """Yield all parts that have an interval, with their paths, starting with the experiment itself."""
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
        """Refuse repeated labels of observers and names of figures."""
        for field, names in (
            ("observers[{}].label", [item.label for item in self.observers]),
            ("figures[{}].name", [item.name for item in self.figures]),
            ("notes[{}].id", [item.id for item in self.notes]),
        ):
            for index, name in enumerate(names):
                if name in names[:index]:
                    raise refuse("experiment.name.repeated", field.format(index), name, name=name)

    def _check_commands(self) -> None:
        """Refuse times of commands that are not multiples of the step or not in order."""
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
        """Refuse names that the plant does not declare, and a step that is not the period of a discrete plant."""
        check_known(self.parameters, plant.names("parameters"), "parameters", "plant.parameter.unknown")
        for item in plant.parameters:
            if item.name in self.parameters:
                value, field = self.parameters[item.name], f"parameters.{item.name}"
                check_within(value, item.bounds, field, item.name)
        starting = [*plant.names("states"), *(s.name for c in plant.controllers for s in c.states)]
        check_known(self.initial, starting, "initial", "plant.state.unknown")
        for name in plant.controlled:
            if name in self.inputs:
                remedy = set_reference(plant.names("references"))
                raise refuse("controller.input.set", f"inputs.{name}", name, name=name, remedy=remedy)
        check_known(self.inputs, [item.name for item in plant.commanded], "inputs", "plant.input.unknown")
        for index, controller in enumerate(plant.controllers):
            if controller.period is not None:
                check_multiple(controller.period, self.step, f"plant.controllers[{index}].period")
        check_known(self.signals, plant.names("signals"), "signals", "plant.signal.unknown")
        if self.truth.record is not None:
            changes = [c for c in self.commands if isinstance(c, OfTruth)]
            self.truth.record.check(vars(self) | {"commands": changes})
        check_known(self.noise, plant.names("outputs"), "noise", "plant.output.unknown")
        self.truth.check(plant, self.noise, self.measurement, self.step)
        for index, command in enumerate(self.commands):
            if isinstance(command, SetTruth):
                path = f"commands[{index}].truth"
                command.truth.check(plant, self.noise, self.measurement, self.step, path)
                if command.truth.states != self.truth.states:
                    raise refuse("command.truth.states", f"{path}.states", [s.name for s in command.truth.states])
        for index, (kind, name) in enumerate(fault.site for fault in self.faults):
            known = plant.names(f"{kind}s")
            if name not in known:
                field = f"faults[{index}].{kind}"
                raise refuse(f"plant.{kind}.unknown", field, name, name=name, remedy=suggestion(name, known))
        if plant.time.kind == "discrete" and not math.isclose(self.step, plant.time.period, rel_tol=1e-9):
            period = plant.time.period
            raise refuse("experiment.step.not-period", "step", self.step, period=period, step=self.step)

    def _check_columns(self, plant: Plant, path: str, figure: Figure) -> None:
        """Refuse a figure with a column that no result has. Of an observer's columns only the label can be checked."""
        groups = {"u": "inputs", "signal": "signals", "r": "references", "x": "states"}
        groups |= {"theta": "channels", "y": "outputs"}
        own = ["t"] + [f"{prefix}.{name}" for prefix, group in groups.items() for name in plant.names(group)]
        own += [f"c.{state.name}" for controller in plant.controllers for state in controller.states]
        own += [f"x.{state.name}" for state in self.truth.states]
        labels = list(self.observer_configs())
        for field, column in figure.columns():
            label, _, rest = column.partition(".")
            if column in own or (label in labels and rest):
                continue
            hint = suggestion(column, own + [f"{name}.…" for name in labels])
            raise refuse("figure.column.unknown", f"{path}.{field}", column, name=column, remedy=hint)


class ResolvedExperiment(Experiment):
    """An experiment with its complete plant. Its JSON and hash equal those of the same data as an `Experiment`."""

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

    # A narrower type is sound because instances are frozen, which pyright cannot see in pydantic's configuration.
    plant: Plant = Field(description="The complete plant.")  # pyright: ignore[reportIncompatibleVariableOverride]

    _readings: object | None = PrivateAttr(None)

    @property
    def readings(self) -> object | None:
        """Return the rows of the record of `truth.record`; None until they are given by `with_readings`."""
        return self._readings

    def with_readings(self, readings: object) -> "ResolvedExperiment":
        """Return this experiment with the rows of its record, an object that equals itself only."""
        (resolved := self.model_copy())._readings = readings
        return resolved
