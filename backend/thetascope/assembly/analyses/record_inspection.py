"""Inspect a file beside a plant: reading, mapping and defects of `records`, with the plant's time constants."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from thetascope.assembly.build.signal_builder import nominal_state, plant_parameters, signals_of
from thetascope.diagnosis.recording import Recording
from thetascope.engine.compiler.graph import evaluate
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.errors import SpecError, ThetascopeError
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.programs.propagation import jacobians
from thetascope.messages import Message
from thetascope.records.columns.mapping import quantities_of
from thetascope.records.defects.plausibility import PlantFacts
from thetascope.records.document import About, inspection_of, preview_of
from thetascope.records.inspection import Inspected, inspect
from thetascope.records.readers.formats import read_table
from thetascope.records.table import MOST_BYTES, Table
from thetascope_schemas import Plant, ResolvedExperiment
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.service.record_inspection import RecordInspection, RecordPreview

_INTEGRATOR = 1e-3  # eigenvalues below this share of the largest belong to integrators


def inspect_file(
    name: str, data: bytes, plant: Plant | None, mapping: ColumnMapping | None = None, id: str = ""
) -> RecordInspection:
    """Return the inspection of a file; without a plant, of its columns only. Raises SpecError with row and column."""
    inspected = inspected_file(name, data, plant, mapping)
    return inspection_of(inspected, About(id, name[:200], len(data), "" if plant is None else plant.id))


def preview_file(
    name: str, data: bytes, plant: Plant | None, mapping: ColumnMapping | None, intervals: int, in_file_units: bool
) -> RecordPreview:
    """Return the curves of a file for drawing: the plant's quantities, without a plant all columns of numbers."""
    return preview_of(inspected_file(name, data, plant, mapping), intervals, in_file_units)


def inspected_file(name: str, data: bytes, plant: Plant | None, mapping: ColumnMapping | None = None) -> Inspected:
    """Return the table of a file, its mapping and its defects. Raises SpecError."""
    return inspected_table(read_table(name, data), plant, mapping)


def inspected_table(table: Table, plant: Plant | None, mapping: ColumnMapping | None = None) -> Inspected:
    """Return the mapping and the defects of a table. Raises SpecError."""
    if plant is None:
        return inspect(table, (), PlantFacts(), mapping or ColumnMapping())
    return inspect(table, quantities_of(plant), plant_facts(plant), mapping or ColumnMapping())


def recording_of(plant: Plant, path: Path, mapping: ColumnMapping | None = None) -> Recording:
    """Return the recording in a file. Raises SpecError where it cannot be diagnosed, OSError for no such file."""
    return recording_in(inspected_path(plant, path, mapping))


def recording_in(inspected: Inspected) -> Recording:
    """Return the recording that was found. Raises SpecError with the reason if it cannot be diagnosed."""
    if inspected.problem is not None:
        raise SpecError("record", None, inspected.problem)
    assert inspected.recording is not None, "without a problem there is a recording"
    return inspected.recording


def inspected_path(plant: Plant | None, path: Path, mapping: ColumnMapping | None = None) -> Inspected:
    """Return what is found in a file. Raises SpecError, or OSError for no such file."""
    if path.stat().st_size > MOST_BYTES:
        raise SpecError("file", path.name[-60:], Message("record.file.too-large", limit=MOST_BYTES // 1024**2))
    return inspected_file(path.name, path.read_bytes(), plant, mapping)


def plant_facts(plant: Plant) -> PlantFacts:
    """Return a plant's outputs at its initial state, its slowest time constant, and its default signals.

    A plant whose equations cannot be evaluated there has none of them.
    """
    plain = plant.without_controllers
    try:
        discrete = plain.time.kind == "discrete"
        step = plain.time.period if plain.time.kind == "discrete" else 1e-3
        spec = ResolvedExperiment(plant=plain, horizon=step, step=step)
        program = plant_program(plain.model_dump(mode="json")).program
        signals = signals_of(spec)
    except (ThetascopeError, ValueError):
        return PlantFacts()
    own = {s.name: partial(_held, signals[f"signal.{s.name}"]) for s in plain.signals}
    start = nominal_state(plain)
    values: dict[str, np.ndarray | float] = {"t": np.zeros(1)}
    values |= {n: signal(np.zeros(1), np.zeros(1)) for n, signal in signals.items()}
    values |= {s: start[[k]] for k, s in enumerate(program.states)} | plant_parameters(spec)
    try:
        with np.errstate(all="ignore"):
            outputs = evaluate(program.graph, list(program.outputs.values()), values)
            rate = _slowest(program, jacobians(program, values, 1)[0], step if discrete else None)
    except (KeyError, ValueError, ArithmeticError, np.linalg.LinAlgError):
        return PlantFacts(signals=own)
    pairs = zip(plain.names("outputs"), outputs, strict=True)
    finite = {name: float(np.ravel(value)[0]) for name, value in pairs if np.isfinite(np.ravel(value)[0])}
    return PlantFacts(finite, 1 / rate if rate else None, own)


def _held(signal: Callable, t: np.ndarray) -> np.ndarray:
    return signal(t, t)


def _slowest(program: Program, slope: np.ndarray, period: float | None) -> float:
    """Return the slowest rate in 1/s that is not an integrator's, 0 without one."""
    values = np.linalg.eigvals(slope).astype(complex)
    rates = np.abs(values) if program.time != DISCRETE or period is None else np.abs(np.log(values)) / period
    rates = rates[np.isfinite(rates) & (rates > 0)]
    rates = rates[rates > _INTEGRATOR * rates.max(initial=0.0)]
    return float(rates.min(initial=np.inf)) if len(rates) else 0.0
