"""A preview of a plant: inputs and outputs, healthy and with each fault; how long it takes to tell faults apart.

The outputs are simulated without noise, once without faults and once with each fault of typical size from `onset` on.
A fault is found when the sum of the squared changes of the outputs, in standard deviations of the noise, over all
samples since its onset reaches 36: six standard deviations for the best linear test. It is
distinguished from another fault when the same holds for the part of these changes that no size of the other fault
explains. Both are lower bounds: an observer needs longer, since it does not know the onset.
"""

from dataclasses import dataclass

import numpy as np

from thetascope.assembly.build.prepare import prepare
from thetascope.assembly.workshop.trial_experiment import size_of_fault
from thetascope.engine.model.result import Result
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.faults import StepFault

ENOUGH = 36.0  # six standard deviations, squared
ONSET = 0.5  # of the horizon
_POINTS = 240
_MOST_CHANNELS = 12


@dataclass(frozen=True)
class Preview:
    """The simulations of a plant.

    Args:
        t: times in s (k,).
        onset: time in s of the fault, the same for all channels.
        inputs, outputs: names and values (k,), without faults.
        faulty: outputs with the fault of each channel, by channel and output; not finite values end the lists.
        sizes: the size of the fault of each channel.
        seconds: for channels i and j, seconds until fault i is distinguished from j, on the diagonal until it is found;
            None: not within the experiment.
    """

    t: list[float]
    onset: float
    inputs: dict[str, list[float]]
    outputs: dict[str, list[float]]
    faulty: dict[str, dict[str, list[float]]]
    sizes: dict[str, float]
    seconds: list[list[float | None]]


def preview(spec: ResolvedExperiment) -> Preview:
    """Simulate an experiment without observers and noise, healthy and with each fault. Raises SpecError."""
    plant = spec.plant
    onset = spec.step * round(ONSET * spec.horizon / spec.step)
    names = [output.name for output in plant.outputs]
    healthy = _run(spec, ())
    runs, sizes = {}, {}
    for index, channel in enumerate(plant.channels[:_MOST_CHANNELS]):
        sizes[channel.name] = size_of_fault(plant, index)
        runs[channel.name] = _run(spec, (StepFault(channel=channel.name, onset=onset, size=sizes[channel.name]),))
    t = healthy.column("t")
    shown = np.unique(np.linspace(0, len(t) - 1, min(_POINTS, len(t))).round().astype(int))
    commanded = [f"u.{item.name}" for item in plant.inputs]
    changes = [_changes(healthy, run, names, spec) for run in runs.values()]
    after = int(np.searchsorted(t, onset - 1e-9 * spec.horizon))
    return Preview(
        t=t[shown].tolist(),
        onset=onset,
        inputs={name[2:]: _part(healthy, name, shown) for name in commanded if name in healthy.names},
        outputs={name: _part(healthy, f"y.{name}", shown) for name in names},
        faulty={c: {name: _part(run, f"y.{name}", shown) for name in names} for c, run in runs.items()},
        sizes=sizes,
        seconds=separation([change[after:] for change in changes], t[after:] - t[after]) if changes else [],
    )


def separation(changes: list[np.ndarray], t: np.ndarray) -> list[list[float | None]]:
    """Return the time until each fault is distinguished from each other one, on the diagonal from no fault.

    Args:
        changes: of the outputs by each fault, in standard deviations of the noise, arrays (k, m).
        t: times in s since the onset (k,).
    """
    rows = min(len(change) for change in changes)
    products = [
        [np.cumsum((a[:rows] * b[:rows]).sum(axis=1)) for b in changes] for a in changes
    ]  # inner products up to each sample
    table: list[list[float | None]] = []
    for i, row in enumerate(products):
        line: list[float | None] = []
        for j, shared in enumerate(row):
            left = row[i]
            if i != j:
                other = products[j][j]
                left = left - np.divide(shared**2, other, out=np.zeros_like(other), where=other > 0)
            enough = np.flatnonzero(left >= ENOUGH)
            line.append(float(f"{t[enough[0]]:.6g}") if len(enough) else None)
        table.append(line)
    return table


def _run(spec: ResolvedExperiment, faults: tuple[StepFault, ...]) -> Result:
    quiet = {
        "faults": faults,
        "observers": (),
        "figures": (),
        "commands": (),
        "noise": {},
        "diagnosis": DiagnosisSettings(enabled=False),
    }
    return prepare(ResolvedExperiment.model_validate(dict(spec) | quiet)).run()


def _changes(healthy: Result, faulty: Result, names: list[str], spec: ResolvedExperiment) -> np.ndarray:
    """Return the changes of the outputs by a fault in standard deviations of the noise, up to where they are finite."""
    rows = min(len(healthy.column("t")), len(faulty.column("t")))
    noise = [n.std if (n := spec.noise.get(name)) is not None and n.std > 0 else 1.0 for name in names]
    columns = [
        (faulty.column(f"y.{name}")[:rows] - healthy.column(f"y.{name}")[:rows]) / std
        for name, std in zip(names, noise, strict=True)
    ]
    change = np.stack(columns, axis=1)
    finite = np.isfinite(change).all(axis=1)
    return np.clip(change[: rows if np.all(finite) else int(np.argmin(finite))], -1e6, 1e6)


def _part(result: Result, name: str, rows: np.ndarray) -> list[float]:
    """Return the values of a column at rows, up to the first one that is not finite."""
    column = result.column(name)
    values = column[rows[rows < len(column)]]
    finite = np.isfinite(values)
    return values[: len(values) if finite.all() else int(np.argmin(finite))].tolist()
