"""The plant in the report: equations, parameters, fault channels; then the faults of the run and the noise."""

from collections.abc import Iterator

from markupsafe import Markup

from thetascope.report.words import ReportContext, expression, mark, number, symbol, unit
from thetascope_schemas.experiment.commands import SetTruth
from thetascope_schemas.experiment.controllers import Controller
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.measurement import Truth
from thetascope_schemas.experiment.plant import Plant

_GIVEN = {"channel", "output", "shape", "onset", "end"}  # fields of a fault that have columns of their own


def plant_section(report: ReportContext) -> Markup:
    """Return title, equations, parameters and fault channels."""
    plant, spec = report.run.plant, report.run.spec
    discrete = plant.time.kind == "discrete"
    return report.render(
        "plant.html",
        title=report.text(plant.title) or plant.id,
        description=report.text(plant.description),
        equations=list(_equations(report, plant)),
        discrete=report.say("report.discrete-time", period=plant.time.period) if discrete else "",
        quantities=_quantities(report, plant, spec),
        channels=report.table(
            [report.say(f"report.head.{name}") for name in ("fault", "meaning", "kind", "unit")],
            [
                [symbol(c.name), report.text(c.title or c.description), report.say(f"report.kind.{c.kind}"), c.unit]
                for c in plant.channels
            ],
            0,
        ),
    )


def timeline(report: ReportContext) -> Markup:
    """Return the faults in the order of their onset, the noise, and how the true plant differs from the model."""
    spec = report.run.spec
    rows = []
    for fault in sorted(spec.faults, key=lambda fault: fault.onset):
        details = [name for name in type(fault).model_fields if name not in _GIVEN]
        size_unit = unit(report.run.unit(fault.site.prefix, fault.site.name)) if "size" in details else ""
        texts = [_detail(report, name, getattr(fault, name)) for name in details]
        rows.append(
            [
                symbol(fault.site.name),
                report.say(f"report.shape.{fault.shape}"),
                report.joined(texts) + size_unit,
                number(fault.onset, 6),
                report.say("report.stays") if fault.end is None else number(fault.end, 6),
            ]
        )
    noise = [
        report.say("report.noise.level", output=symbol(name), std=number(n.std), hold=number(n.sample_time))
        for name, n in spec.noise.items()
    ]
    head = [report.say(f"report.head.{name}") for name in ("fault-on", "shape", "details", "from", "until")]
    return report.render(
        "timeline.html",
        faults=report.table(head, rows, 2),
        noise=report.joined(noise),
        truth=report.joined(list(_truth(report, spec.truth))),
        record=_recorded(report, spec.truth),
        changed=_changed_truth(report, spec),
    )


def _recorded(report: ReportContext, truth: Truth) -> Markup | str:
    """Return a sentence on the record that takes the place of the simulated plant, if there is one."""
    if truth.record is None:
        return ""
    return report.say("report.truth.record", name=truth.record.name or "–", id=mark("code", truth.record.id[:12]))


def _changed_truth(report: ReportContext, spec: Experiment) -> Markup | str:
    """Return a sentence on the truth at the end of the run, where it was changed during the run."""
    changes = [command for command in spec.commands if isinstance(command, SetTruth)]
    if not changes:
        return ""
    parts = list(_truth(report, changes[-1].truth)) or [report.say("report.truth-none")]
    return report.say("report.truth-changed", n=len(changes), t=number(changes[0].at, 6), parts=report.joined(parts))


def _truth(report: ReportContext, truth: Truth) -> Iterator[Markup]:
    """Yield the ways in which the simulated plant differs from the model."""
    if truth.deviation:
        yield report.say("report.truth.deviation", percent=number(100 * truth.deviation))
    for name, value in truth.parameters.items():
        yield Markup("{} = {}").format(symbol(name), number(value, 6))
    for name, std in truth.process_noise.items():
        yield report.say("report.truth.process-noise", state=symbol(name), std=number(std))
    for name, sensor in truth.outputs.items():
        if sensor.correlation is not None:
            yield report.say("report.truth.correlation", output=symbol(name), time=number(sensor.correlation))
        if sensor.period is not None:
            yield report.say("report.truth.period", output=symbol(name), time=number(sensor.period))
        if sensor.missing:
            yield report.say("report.truth.missing", output=symbol(name), percent=number(100 * sensor.missing))
        if sensor.jitter:
            yield report.say("report.truth.jitter", output=symbol(name), time=number(sensor.jitter))
        if sensor.adds is not None:
            yield report.say("report.truth.adds", name=symbol(name), added=expression(sensor.adds))
    own = {state.name for state in truth.states}
    for name, text in truth.dynamics.items():
        kind = "report.truth.state" if name in own else "report.truth.adds"
        yield report.say(kind, name=symbol(name), added=expression(text))


def _equations(report: ReportContext, plant: Plant) -> Iterator[tuple[Markup, Markup, Markup | str]]:
    """Yield left side, right side and note: the states, the definitions, the outputs.
    Faults are marked where they enter."""
    prime = mark("next") if plant.time.kind == "discrete" else "′"
    for state in plant.states:
        right = expression(plant.dynamics[state.name]) + _faults(plant, state.name, ("actuator", "process"))
        yield symbol(state.name) + prime, right, ""
    for item in plant.definitions:
        yield symbol(item.name), expression(item.expression), _domain(report, item.domain)
    for output in plant.outputs:
        right = expression(output.expression) + _faults(plant, output.name, ("sensor",))
        yield symbol(output.name), right, output.unit
    for controller in plant.controllers:
        yield from _laws(report, plant, controller)


def _laws(report: ReportContext, plant: Plant, controller: Controller) -> Iterator[tuple[Markup, Markup, Markup | str]]:
    """Yield the lines of a controller: its definitions, the inputs that it sets with their limits, its states."""
    stepwise = controller.period is not None or plant.time.kind == "discrete"
    note = report.text(controller.title) or controller.name
    for item in controller.definitions:
        yield symbol(item.name), expression(item.expression), note
        note = ""
    for item in controller.outputs:
        yield (
            symbol(item.input),
            expression(item.expression),
            note or _domain(report, item.saturation, "report.saturation"),
        )
        note = ""
    for state in controller.states:
        yield symbol(state.name) + (mark("next") if stepwise else "′"), expression(controller.dynamics[state.name]), ""


def _domain(
    report: ReportContext, domain: tuple[float | str | None, float | str | None], code: str = "report.domain"
) -> Markup | str:
    if domain == (None, None):
        return ""
    low, high = (
        open_side if limit is None else symbol(limit) if isinstance(limit, str) else number(limit)
        for limit, open_side in zip(domain, ("−∞", "∞"), strict=True)
    )
    return report.say(code, low=low, high=high)


def _faults(plant: Plant, equation: str, kinds: tuple[str, ...]) -> Markup:
    text = Markup()
    for channel in plant.channels:
        if channel.kind in kinds and equation in channel.enters:
            coefficient = channel.enters[equation].strip()
            simple = coefficient.replace("_", "").isalnum()
            factor = "" if coefficient == "1" else expression(coefficient if simple else f"({coefficient})") + "\u2009"
            text += mark("fault_term", factor, symbol(channel.name))
    return text


def _quantities(report: ReportContext, plant: Plant, spec: Experiment) -> list[tuple[Markup, Markup]]:
    """Return the parameters in effect and the initial state, each as a name and the values."""
    parameters = [
        Markup("{} = {}{}").format(symbol(p.name), number(spec.parameters.get(p.name, p.value), 6), unit(p.unit))
        for p in plant.parameters
    ]
    initial = [
        Markup("{}(0) = {}{}").format(symbol(s.name), number(spec.initial.get(s.name, s.initial), 6), unit(s.unit))
        for s in (*plant.states, *(state for controller in plant.controllers for state in controller.states))
    ]
    groups = ((report.say("report.parameters"), parameters), (report.say("report.start"), initial))
    return [(name, report.joined(items)) for name, items in groups if items]


def _detail(report: ReportContext, name: str, value: object) -> Markup:
    """Return one more field of a fault, with its value."""
    if isinstance(value, tuple | list):
        shown: Markup | str = report.say("report.points", n=len(value))
    elif isinstance(value, bool) or not isinstance(value, int | float):
        shown = str(value)
    else:
        shown = number(value, 6)
    return report.say("report.detail", name=report.say(f"report.field.{name.replace('_', '-')}"), value=shown)
