"""What would explain a misfit: other units of time, inputs and outputs, exchanged columns. Each is tried in turn."""

from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.records import noise_fit
from thetascope.diagnosis.records.model import RecordModel, first_noise, first_readings, start_of
from thetascope.diagnosis.records.noise_fit import Start
from thetascope.engine.filtering.bundles import Rows
from thetascope.engine.filtering.record_filter import part_of

UNIT_GAIN = 50.0  # by which another unit must lower −2 log L,
UNIT_FIT = 0.3  # the fit of the simulation that it must reach; faults in the record lower it,
GOOD = 0.85  # fit of the simulation from which units are not doubted
UNIT_ERROR = 0.5  # and the share of the error of the simulation that may be left
_UNIT_ROWS = (1500, 400)  # on which units are tried
_TIMES = (60.0, 1 / 60.0, 1e3, 1e-3, 3600.0, 1 / 3600.0)
_FACTORS = (10.0, 0.1, 100.0, 0.01, 1000.0, 0.001)
_OFFSETS = (273.15, -273.15)  # kelvin for °C and the other way round
_FAHRENHEIT = 5 / 9


@dataclass(frozen=True)
class Suspect:
    """Something that would explain a misfit.

    Attributes:
        kind: time, output, offset, fahrenheit, input, swap-inputs or swap-outputs.
        name: of the output or input; empty for time, ``*`` for all of one unit, two names for a swap.
        factor: by which its unit or value would have to be multiplied; of an offset, the addend.
        gain: the fall of −2 log L.
        simulated: mean fit of the simulation with it.
    """

    kind: str
    name: str
    factor: float
    gain: float
    simulated: float


def suspected(model: RecordModel, data: Rows, start: Start) -> list[Suspect]:
    """Return units that would lower −2 log L, the largest gain first.

    They are tried on the first rows and on more of them: a fault in the record spoils the simulation, few rows may lack
    excitation.
    """
    suspects = []
    for rows in _UNIT_ROWS:
        if not suspects:
            suspects = _suspected(model, part_of(data, 0, min(len(data.t), rows)), start)
    return suspects


def _suspected(model: RecordModel, short: Rows, start: Start) -> list[Suspect]:
    now = simulated_fit(model, short, start)
    base = _loss(model, short, start) if now < GOOD else None
    if base is None:
        return []
    needed = max(UNIT_FIT, 1 - UNIT_ERROR * (1 - now))
    trials: list[tuple[str, str, float, Rows, float]] = []
    for factor in _TIMES:
        scaled = replace(short, t=short.t * factor, width=short.width * factor, steps=_steps(model, short, factor))
        trials.append(("time", "", factor, scaled, 0.0))
    for k, name in enumerate(model.names("outputs")):
        readings = int(np.isfinite(short.y[:, k]).sum())
        trials += [("output", name, f, _scaled(short, k, f, 0.0), 2 * readings * np.log(f)) for f in _FACTORS]
        trials += [("offset", name, a, _scaled(short, k, 1.0, a), 0.0) for a in _OFFSETS]
        celsius = _scaled(short, k, _FAHRENHEIT, -32 * _FAHRENHEIT)
        trials.append(("fahrenheit", name, _FAHRENHEIT, celsius, 2 * readings * np.log(_FAHRENHEIT)))
    trials += [*_all_outputs(model, short), *_inputs(model, short), *_swaps(model, short)]
    suspects = []
    for kind, name, factor, scaled, jacobian in trials:
        begin = _first(model, scaled)
        fit = simulated_fit(model, scaled, begin)
        if fit < needed:
            continue
        loss = _loss(model, scaled, begin)
        if loss is not None and base - (loss - jacobian) > UNIT_GAIN:
            suspects.append(Suspect(kind, name, factor, float(base - (loss - jacobian)), fit))
    return sorted(suspects, key=lambda s: -s.gain)


def _all_outputs(model: RecordModel, data: Rows) -> list[tuple[str, str, float, Rows, float]]:
    """Return trials in which all outputs of the same unit have another one."""
    units: dict[str, list[int]] = {}
    for k, output in enumerate(model.data["outputs"]):
        units.setdefault(output.get("unit", ""), []).append(k)
    trials = []
    for columns in units.values():
        if len(columns) < 2:
            continue
        readings = int(np.isfinite(data.y[:, columns]).sum())
        for factor in (*_FACTORS, _FAHRENHEIT):
            offset = -32 * _FAHRENHEIT if factor == _FAHRENHEIT else 0.0
            kind = "fahrenheit" if factor == _FAHRENHEIT else "output"
            trials.append((kind, "*", factor, _scaled(data, columns, factor, offset), 2 * readings * np.log(factor)))
        trials += [("offset", "*", a, _scaled(data, columns, 1.0, a), 0.0) for a in _OFFSETS]
    return trials


def _inputs(model: RecordModel, data: Rows) -> list[tuple[str, str, float, Rows, float]]:
    """Return trials in which inputs have another unit."""
    names = [*model.names("inputs"), *model.names("signals")]
    groups = [[i] for i in range(len(names))] + [list(range(len(names)))] * (len(names) > 1)
    trials = []
    for columns in groups:
        for factor in _FACTORS:
            u, between = data.u.copy(), data.between.copy()
            u[:, columns] *= factor
            between[:, columns] *= factor
            name = names[columns[0]] if len(columns) == 1 else "*"
            trials.append(("input", name, factor, replace(data, u=u, between=between), 0.0))
    return trials


def _swaps(model: RecordModel, data: Rows) -> list[tuple[str, str, float, Rows, float]]:
    """Return trials in which two inputs or two outputs of the same unit are exchanged."""
    trials = []
    for part, field_name in (("inputs", "u"), ("outputs", "y")):
        items = model.data[part]
        for i in range(len(items)):
            for j in range(i):
                if items[i].get("unit", "") == items[j].get("unit", ""):
                    swapped = {}
                    for name in ("u", "between") if field_name == "u" else ("y",):
                        swapped[name] = getattr(data, name).copy()
                        swapped[name][:, [i, j]] = swapped[name][:, [j, i]]
                    pair = f"{items[j]['name']}, {items[i]['name']}"
                    trials.append((f"swap-{part}", pair, 1.0, replace(data, **swapped), 0.0))
    return trials


def _scaled(data: Rows, columns: int | list[int], factor: float, offset: float) -> Rows:
    """Return the rows with other readings in some columns."""
    y = data.y.copy()
    y[:, columns] = y[:, columns] * factor + offset
    return replace(data, y=y)


def simulated_fit(model: RecordModel, data: Rows, start: Start) -> float:
    """Return the mean over the outputs of 1 − ‖y − simulated‖/‖y − mean‖, −∞ where the simulation fails."""
    _, simulated = model.filter.simulate(data, start.x)
    if not np.isfinite(simulated).all():
        return -np.inf
    fits = []
    for k in np.flatnonzero(np.isfinite(data.y).any(axis=0)):
        seen = np.isfinite(data.y[:, k])
        y = data.y[seen, k]
        spread = float(np.linalg.norm(y - y.mean()))
        fits.append(1.0 - float(np.linalg.norm(y - simulated[seen, k])) / (spread or 1.0))
    return float(np.mean(fits)) if fits else 1.0


def _steps(model: RecordModel, data: Rows, factor: float) -> np.ndarray:
    """Return integration steps for intervals that are longer by a factor."""
    if model.filter.plant.time == "discrete":
        return data.steps
    return np.sign(data.steps) * np.clip(np.ceil(np.abs(data.steps) * factor), 1, 256)


def _first(model: RecordModel, data: Rows) -> Start:
    """Return the start that fits other readings best."""
    initial = first_readings(model.initial, model.measured, data.y)
    model = replace(model, initial=initial)
    return start_of(model, data, first_noise(model, data))


def _loss(model: RecordModel, data: Rows, start: Start) -> float | None:
    """Return −2 log L with noise that is fitted to these rows, None where the filter fails."""
    none = np.zeros(model.filter.m)
    fitted = noise_fit.fit(model.filter, data, start, model.scales, model.measured, none, white=True)
    return fitted.loss if np.isfinite(fitted.loss) else None
