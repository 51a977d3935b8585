"""Controllers: they read the measured outputs and set points, and set inputs of the plant."""

from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator

from thetascope_schemas.experiment.base import (
    MAX_PORTS,
    MAX_STATES,
    UNBOUNDED,
    Bounds,
    ExpressionText,
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
from thetascope_schemas.texts.refusal import refuse


class SetPoint(Strict):
    """One reference r: a set point of the controllers, which experiments and viewers set like an input."""

    model_config = example(name="r", unit="m", default=1, bounds=[0, 3], description="set point of the level")

    name: Name = Field(description="Name in the controllers' expressions.")
    unit: Unit = ""
    default: Number = Field(default=0.0, description="Value if an experiment sets no signal, in the reference's unit.")
    bounds: Bounds = Field(default=UNBOUNDED, description="Plausible range, in the reference's unit.")
    description: Prose = ""


class ControllerState(Strict):
    """One state variable of a controller."""

    model_config = example(name="e", unit="m s", initial=0, description="integral of the control error")

    name: Name = Field(description="Name in the controller's expressions.")
    unit: Unit = ""
    initial: Number = Field(default=0.0, description="Value at t = 0, in the state's unit.")
    description: Prose = ""


class ControllerDefinition(Strict):
    """An intermediate quantity of a controller."""

    model_config = example(name="v", expression="Kp*(r - y) + Ki*e")

    name: Name = Field(description="Name in later expressions of the same controller.")
    expression: ExpressionText


class ControllerOutput(Strict):
    """The law by which a controller sets one input of the plant."""

    model_config = example(input="q", expression="v", saturation=[0, 2])

    input: Reference = Field(description="The input of the plant that is set.")
    expression: ExpressionText = Field(description="Value of the input before saturation.")
    saturation: Annotated[tuple[Limit, Limit], AfterValidator(ordered)] = Field(
        default=UNBOUNDED, description="Range [low, high] to which it is limited: numbers, parameters, or null."
    )


class Controller(Strict):
    """A controller: states and expressions that read measured outputs, references and inputs, never true states.

    Without a period it works continuously (in a discrete plant: at every step). With a period it reads, computes and
    sets its inputs at the instants 0, period, 2·period, …, and holds them in between; `dynamics` are then the next
    values of its states.
    """

    model_config = example(
        name="level",
        title="PI control of the level",
        period=None,
        states=[{"name": "e", "unit": "m s"}],
        definitions=[{"name": "v", "expression": "Kp*(r - y) + Ki*e"}],
        dynamics={"e": "r - y + (q - v)/Kp"},
        outputs=[{"input": "q", "expression": "v", "saturation": [0, 2]}],
    )

    name: Reference = Field(description="Name of the controller; expressions do not contain it.")
    title: Title = ""
    period: Positive | None = Field(
        default=None, description="Sample period in s, a multiple of the step; null: continuous."
    )
    states: tuple[ControllerState, ...] = Field(default=(), max_length=MAX_STATES)
    definitions: tuple[ControllerDefinition, ...] = Field(
        default=(), max_length=200, description="Intermediate quantities, in order."
    )
    dynamics: dict[Reference, ExpressionText] = Field(
        default_factory=dict,
        max_length=MAX_STATES,
        description="Right-hand side by state: its derivative, or its next value with a period or in discrete time.",
    )
    outputs: tuple[ControllerOutput, ...] = Field(
        min_length=1, max_length=MAX_PORTS, description="The inputs of the plant that it sets."
    )
    description: Prose = ""

    @model_validator(mode="after")
    def _complete(self) -> "Controller":
        """Refuse states without an equation and equations without a state."""
        states = [s.name for s in self.states]
        check_known(self.dynamics, states, "dynamics", "controller.state.unknown")
        for state in states:
            if state not in self.dynamics:
                raise refuse("controller.state.no-equation", "dynamics", state, state=state)
        return self

    def declared(self) -> Iterator[tuple[str, str]]:
        """Yield the path and the value of every name that the controller declares."""
        yield "name", self.name
        for group in ("states", "definitions"):
            for index, item in enumerate(getattr(self, group)):
                yield f"{group}[{index}].name", item.name


def check_controllers(
    controllers: tuple[Controller, ...], inputs: tuple[str, ...], parameters: tuple[str, ...], period: float | None
) -> None:
    """Refuse controllers that set an unknown input, or one input twice, and limits and periods that do not fit.

    `period`: of a plant in discrete time, in s; else None.
    """
    taken: dict[str, str] = {}
    for i, controller in enumerate(controllers):
        for j, output in enumerate(controller.outputs):
            path, name = f"controllers[{i}].outputs[{j}]", output.input
            if name not in inputs:
                check_known([name], inputs, f"{path}.input", "plant.input.unknown")
            if name in taken:
                raise refuse("controller.input.repeated", f"{path}.input", name, name=name, by=taken[name])
            taken[name] = controller.name
            named = [limit for limit in output.saturation if isinstance(limit, str)]
            check_known(named, parameters, f"{path}.saturation", "plant.parameter.unknown")
        if period is not None and controller.period is not None:
            check_multiple(controller.period, period, f"controllers[{i}].period")


def check_multiple(interval: float, step: float, field: str) -> None:
    """Refuse an interval that is not a multiple of a step, both in s."""
    count = round(interval / step)
    if count < 1 or abs(interval / step - count) > 1e-6 * max(1, count):
        near = max(1, count) * step
        raise refuse("experiment.time.no-multiple", field, interval, time=interval, step=step, near=near)


def set_reference(references: Sequence[str]) -> dict[str, Any]:
    """Return the remedy, as {code, args}, for a signal that is given to an input that a controller sets."""
    if not references:
        return {"code": "controller.reference.none", "args": {}}
    return {"code": "controller.reference.set", "args": {"references": list(references)}}
