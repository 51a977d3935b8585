"""A plant: equations as text, physical domains, and fault channels."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from thetascope_schemas.experiment.base import (
    MAX_ALGEBRAIC,
    MAX_CHANNELS,
    MAX_EVENTS,
    MAX_PORTS,
    MAX_STATES,
    MAX_TABLES,
    UNBOUNDED,
    Bounds,
    ExpressionText,
    Identifier,
    Limit,
    Name,
    Number,
    Positive,
    Prose,
    Reference,
    Strict,
    Title,
    Unit,
    check_known,
    example,
    ordered,
)
from thetascope_schemas.experiment.controllers import Controller, SetPoint, check_controllers
from thetascope_schemas.experiment.signals import ConstantSignal, Signal
from thetascope_schemas.experiment.tables import Table
from thetascope_schemas.texts.refusal import refuse


class ContinuousTime(Strict):
    """Continuous time: the dynamics are derivatives."""

    model_config = example(kind="continuous")

    kind: Literal["continuous"] = "continuous"


class DiscreteTime(Strict):
    """Discrete time: the dynamics are the values at the next sample."""

    model_config = example(kind="discrete", period=0.01)

    kind: Literal["discrete"] = "discrete"
    period: Positive = Field(description="Sample period in s.")


class State(Strict):
    """One state variable."""

    model_config = example(name="x1", unit="1/h", initial=0.09, domain=[0, None], description="growth")

    name: Name = Field(description="Name in the equations.")
    unit: Unit = ""
    initial: Number = Field(default=0.0, description="Value at t = 0, in the state's unit.")
    domain: Bounds = Field(
        default=UNBOUNDED, description="Physical range [low, high]; observers saturate their model to it."
    )
    scale: Positive | None = Field(
        default=None,
        description="Size of a typical change, in the state's unit; null: found in a simulation without faults.",
    )
    description: Prose = ""


class Input(Strict):
    """One known input u."""

    model_config = example(name="u", unit="1/h", default=0.08, bounds=[0, 1], description="dilution rate")

    name: Name = Field(description="Name in the equations.")
    unit: Unit = ""
    default: Number = Field(default=0.0, description="Value if an experiment sets no signal, in the input's unit.")
    bounds: Bounds = Field(default=UNBOUNDED, description="Plausible range, in the input's unit.")
    description: Prose = ""


class Output(Strict):
    """One measured output y."""

    model_config = example(name="y", unit="1/h", expression="x1", description="measured growth")

    name: Name = Field(description="Name of the output.")
    unit: Unit = ""
    expression: ExpressionText = Field(description="Right-hand side of the output equation, without faults.")
    scale: Positive | None = Field(
        default=None,
        description="Size of a typical change, in the output's unit; null: found in a simulation without faults.",
    )
    description: Prose = ""


class Parameter(Strict):
    """One constant of the plant, which an experiment may override."""

    model_config = example(name="a1", value=1, unit="1/h", bounds=[0, None], description="maximal growth rate")

    name: Name = Field(description="Name in the equations.")
    value: Number = Field(description="Nominal value, in the parameter's unit.")
    unit: Unit = ""
    bounds: Bounds = Field(default=UNBOUNDED, description="Permitted range, in the parameter's unit.")
    description: Prose = ""

    @model_validator(mode="after")
    def _within_bounds(self) -> "Parameter":
        check_within(self.value, self.bounds, "value", self.name)
        return self


class KnownSignal(Strict):
    """One known signal φ(t), which observers see."""

    model_config = example(
        name="phi1",
        unit="",
        description="excitation of channel 1",
        default={"kind": "pulse", "period": 0.5, "width": 0.25},
    )

    name: Name = Field(description="Name in the equations.")
    unit: Unit = ""
    description: Prose = ""
    default: Signal = Field(
        default_factory=lambda: ConstantSignal(value=0.0), description="The signal if an experiment sets none."
    )


class Definition(Strict):
    """An intermediate quantity. Observers saturate it to its domain; the plant does not."""

    model_config = example(name="w", expression="x2/x1", domain=[0, "a1"])

    name: Name = Field(description="Name in later definitions and in the equations.")
    expression: ExpressionText = Field(
        description="Expression in states, inputs, parameters, signals and earlier definitions."
    )
    domain: Annotated[tuple[Limit, Limit], AfterValidator(ordered)] = Field(
        default=UNBOUNDED, description="Physical range [low, high]: numbers, names of parameters, or null for no bound."
    )


class AlgebraicVariable(Strict):
    """A quantity without memory that an equation determines, solved at every instant."""

    model_config = example(name="i", unit="A", equation="v = R*i + V_T*log(1 + i/I_s)", guess="0.01", description="")

    name: Name = Field(description="Name in the equations.")
    unit: Unit = ""
    equation: ExpressionText = Field(
        description="Equation `left = right`, or an expression that is 0, in all quantities of the plant."
    )
    guess: ExpressionText = Field(
        default="0", description="First guess of the value, in states, inputs, parameters and definitions of these."
    )
    domain: Bounds = Field(
        default=UNBOUNDED, description="Physical range [low, high]; observers saturate their model to it."
    )
    description: Prose = ""


class StateEvent(Strict):
    """New values of states where a condition holds at the end of a step: a relay that switches, a ball that bounces."""

    model_config = example(when="h < 0 and v < 0", set={"h": 0, "v": "-e*v"})

    when: ExpressionText = Field(description="Condition, examined at the end of every step of the integration.")
    set: dict[Reference, ExpressionText] = Field(
        min_length=1, max_length=MAX_STATES, description="New value by state, from the values before."
    )


class Channel(Strict):
    """One fault θ and its equations: coefficient·θ is added to each equation in `enters`."""

    model_config = example(
        name="theta1",
        title="actuator fault",
        kind="actuator",
        enters={"x1": "phi1"},
        unit="",
        typical=0.01,
        bounds=[-0.1, 0.1],
        description="",
    )

    name: Name = Field(description="Name of the fault; the equations do not contain it.")
    title: Title = ""
    kind: Literal["actuator", "process", "sensor"] = Field(
        description="Actuator faults enter state equations, sensor faults output equations, process faults both."
    )
    enters: dict[Reference, ExpressionText] = Field(
        min_length=1,
        max_length=MAX_STATES,
        description="Coefficient of θ by state or output, in whose equation it enters.",
    )
    unit: Unit = ""
    typical: Positive = Field(default=1.0, description="Typical size of the fault, in its unit.")
    bounds: Bounds = Field(default=UNBOUNDED, description="Plausible range, in the channel's unit.")
    description: Prose = ""


_ENTERED = {
    "actuator": ("states",),
    "process": ("states", "outputs"),  # a change of the plant may be measured directly
    "sensor": ("outputs",),
}


class Plant(Strict):
    """A plant x' = f(x,u,φ,t) + Σ coefficient·θ, y = h(x,u,φ,t) + Σ coefficient·θ (x(k+1) in discrete time)."""

    model_config = example(
        id="first-order",
        title="First-order lag",
        description="x' = -a x + u, measured with a bias",
        source="",
        time={"kind": "continuous"},
        states=[{"name": "x", "unit": "m", "initial": 1}],
        inputs=[{"name": "u", "unit": "m/s"}],
        outputs=[{"name": "y", "unit": "m", "expression": "x"}],
        parameters=[{"name": "a", "value": 0.5, "unit": "1/s", "bounds": [0, None]}],
        signals=[],
        definitions=[],
        dynamics={"x": "-a*x + u"},
        channels=[
            {"name": "theta1", "kind": "actuator", "enters": {"x": "u"}, "typical": 0.2},
            {"name": "theta2", "kind": "sensor", "enters": {"y": 1}, "unit": "m", "typical": 0.1},
        ],
    )
    prose = Strict.prose | {"id"}
    optional = frozenset({"tables", "algebraic", "events", "references", "controllers"})

    id: Identifier = Field(description="Short name: lower-case letters, digits and hyphens.")
    title: Title = ""
    description: Prose = ""
    source: Prose = Field(default="", description="Source of the plant, such as a paper and its equations.")
    time: ContinuousTime | DiscreteTime = Field(
        default_factory=ContinuousTime, discriminator="kind", description="Continuous, or discrete with a period."
    )
    states: tuple[State, ...] = Field(min_length=1, max_length=MAX_STATES)
    inputs: tuple[Input, ...] = Field(default=(), max_length=MAX_PORTS)
    outputs: tuple[Output, ...] = Field(min_length=1, max_length=MAX_PORTS)
    parameters: tuple[Parameter, ...] = Field(default=(), max_length=200)
    signals: tuple[KnownSignal, ...] = Field(default=(), max_length=MAX_CHANNELS)
    tables: tuple[Table, ...] = Field(
        default=(), max_length=MAX_TABLES, description="Tables y(x), for interp(x, name) in expressions."
    )
    definitions: tuple[Definition, ...] = Field(
        default=(), max_length=200, description="Intermediate quantities, in order."
    )
    algebraic: tuple[AlgebraicVariable, ...] = Field(
        default=(), max_length=MAX_ALGEBRAIC, description="Quantities that equations determine at every instant."
    )
    dynamics: dict[Reference, ExpressionText] = Field(
        max_length=MAX_STATES,
        description="Right-hand side by state: its derivative, or its next value in discrete time.",
    )
    events: tuple[StateEvent, ...] = Field(
        default=(), max_length=MAX_EVENTS, description="Changes of states at conditions, in order (continuous time)."
    )
    channels: tuple[Channel, ...] = Field(default=(), max_length=MAX_CHANNELS, description="The faults that can occur.")
    references: tuple[SetPoint, ...] = Field(
        default=(), max_length=MAX_PORTS, description="Set points of the controllers."
    )
    controllers: tuple[Controller, ...] = Field(
        default=(), max_length=MAX_PORTS, description="Controllers that set inputs of the plant; empty: an open loop."
    )

    def names(self, *groups: str) -> tuple[str, ...]:
        """Return the names declared in the given groups (`"states"`, `"inputs"`, …), in order."""
        return tuple(item.name for group in groups for item in getattr(self, group))

    @property
    def controlled(self) -> tuple[str, ...]:
        """Return the inputs that controllers set, in the order of the plant's inputs."""
        taken = {output.input for controller in self.controllers for output in controller.outputs}
        return tuple(name for name in self.names("inputs") if name in taken)

    @property
    def without_controllers(self) -> "Plant":
        """Return the plant alone, as a record shows it: with the inputs as they were applied."""
        return self.model_copy(update={"controllers": (), "references": ()})

    @property
    def commanded(self) -> tuple[Input | SetPoint, ...]:
        """Return the inputs and references that an experiment sets: all but the inputs that controllers set."""
        taken = self.controlled
        return (*(u for u in self.inputs if u.name not in taken), *self.references)

    @model_validator(mode="after")
    def _consistent(self) -> "Plant":
        """Refuse repeated or unknown names, and states without an equation."""
        self._check_unique()
        check_known(self.dynamics, self.names("states"), "dynamics", "plant.state.unknown")
        for state in self.names("states"):
            if state not in self.dynamics:
                raise refuse("plant.state.no-equation", "dynamics", state, state=state)
        parameters = self.names("parameters")
        for index, definition in enumerate(self.definitions):
            named = [limit for limit in definition.domain if isinstance(limit, str)]
            check_known(named, parameters, f"definitions[{index}].domain", "plant.parameter.unknown")
        for index, event in enumerate(self.events):
            if self.time.kind == "discrete":
                raise refuse("plant.events.discrete", f"events[{index}]", event.when)
            check_known(event.set, self.names("states"), f"events[{index}].set", "plant.state.unknown")
        for index, channel in enumerate(self.channels):
            known = self.names(*_ENTERED[channel.kind])
            check_known(channel.enters, known, f"channels[{index}].enters", f"plant.channel.enters-{channel.kind}")
        period = self.time.period if self.time.kind == "discrete" else None
        check_controllers(self.controllers, self.names("inputs"), parameters, period)
        return self

    def _check_unique(self) -> None:
        """Refuse a repeated name, so that expressions, columns and messages are never ambiguous."""
        declared: dict[str, str] = {}
        for field, name in self.declared():
            if name in declared:
                raise refuse("plant.name.repeated", field, name, name=name, by=declared[name])
            declared[name] = field

    def declared(self) -> Iterator[tuple[str, str]]:
        """Yield the path and the value of every declared name."""
        quantities = ("states", "inputs", "outputs", "parameters", "signals", "tables", "algebraic", "definitions")
        for group in (*quantities, "channels", "references"):
            for index, item in enumerate(getattr(self, group)):
                yield f"{group}[{index}].name", item.name
        for index, controller in enumerate(self.controllers):
            for path, name in controller.declared():
                yield f"controllers[{index}].{path}", name


def check_within(value: float, bounds: tuple[float | None, float | None], field: str, name: str) -> None:
    """Refuse a parameter's value outside its bounds."""
    low, high = bounds
    if (low is not None and value < low) or (high is not None and value > high):
        limits = {"low": "−∞" if low is None else low, "high": "∞" if high is None else high}
        raise refuse("plant.parameter.outside-bounds", field, value, name=name, number=value, **limits)
