"""A block of consecutive runs: the unit that a worker computes, a pure function of the study and of its place."""

import io
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import groupby

import polars as pl

from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import inspector
from thetascope.assembly.build.prepare import Prepared, prepare_seed
from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.plain_columns import plain_batch, plain_run
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.model.result import Result
from thetascope.engine.simulation.batch import in_lanes, shape
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.runs.specs.refusals import InvalidSpec, from_engine
from thetascope.studies.design import is_number, values_at
from thetascope.studies.measured_row import Cell, measured
from thetascope.studies.plan import Place, at_place, experiment_of_point, place_of
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment
from thetascope_schemas.service.study.study import Study

LANES_FROM = 4
"""Seeds at a point from which the substeps of all its runs are those that its first run needs, so that they share
lanes. With fewer, each run chooses its own."""
_BYTES = 64 << 20
"""Most bytes of the states that are computed together in lanes."""
_SHORT = 0.05
"""Seconds of a run that takes so short that several are tried."""
_TEXTS = ("id", "error")
_WHOLE = ("run", "point", "seed", "substeps")


@dataclass(frozen=True)
class _Run:
    """A run that is ready: its place, its experiment and the engine's, all of which the row needs."""

    place: Place
    spec: ResolvedExperiment
    prepared: Prepared

    @property
    def engine(self) -> Engine:
        """Return the engine's experiment; its rows are those that the run records, because nothing examines it."""
        e = self.prepared.stages[0].experiment
        return replace(e, every=e.record or e.every, record=None)

    @property
    def lanes(self) -> bool:
        """Return whether the run can share lanes with others of its shape."""
        e = self.engine
        fixed = e.substeps is not None or e.plant.time == DISCRETE
        return len(self.prepared.stages) == 1 and fixed and in_lanes(e)


def compute(document: bytes, first: int, last: int) -> bytes:
    """Return the rows of runs [first, last) as a Parquet file; `document` is a complete study in JSON.

    The same arguments give the same bytes on one version of the program, whoever computes them.
    """
    study = _study(document)
    frame = table(study, rows(study, range(first, last)))
    buffer = io.BytesIO()
    frame.write_parquet(buffer, compression="zstd", statistics=False)
    return buffer.getvalue()


def seconds_of_run(document: bytes, most: int) -> float:
    """Return the processor time in s of one run of a study, by its first one; if that is short, by up to `most`."""
    compute(document, 0, 1)  # compiles
    for count in (1, most):
        begun = time.process_time()
        compute(document, 0, count)
        seconds = (time.process_time() - begun) / count
        if seconds > _SHORT:
            break
    return seconds


@lru_cache(maxsize=4)
def _study(document: bytes) -> Study:
    study = Study.model_validate_json(document)
    base = study.experiment
    assert isinstance(base, Experiment), "a complete study holds its experiment"
    spec = ResolvedExperiment.model_validate(dict(base))
    return study.model_copy(update={"experiment": spec})


def table(study: Study, cells: Sequence[dict[str, Cell]]) -> pl.DataFrame:
    """Return rows as a frame: fixed columns, factors and measures, the measures sorted by name."""
    factors = {factor.column: is_number(factor) for factor in study.vary}
    known = ("run", "id", "point", "seed", "faulty", "substeps", *factors, "error")
    measures = sorted({name for row in cells for name in row} - set(known))
    types: dict[str, pl.DataType | type[pl.DataType]] = {}
    for name in (*known, *measures):
        if name in _WHOLE:
            types[name] = pl.Int64
        elif name == "faulty":
            types[name] = pl.Boolean
        elif name in _TEXTS or name.startswith("name.") or factors.get(name) is False:
            types[name] = pl.String
        else:
            types[name] = pl.Float64
    data = {name: [row.get(name) for row in cells] for name in types}
    return pl.DataFrame(data, schema=types, strict=False)


def rows(study: Study, runs: Sequence[int]) -> list[dict[str, Cell]]:
    """Return a row for each run, in order. A run that is refused has the reason in `error`."""
    answers: dict[int, dict[str, Cell]] = {}
    ready: list[_Run] = []
    detector = "detection" in study.measures
    for _, same in groupby(runs, lambda number: place_of(study, number).point):
        places = [place_of(study, number) for number in same]
        try:
            prepared = _of_point(study, places, detector)
        except InvalidSpec as refused:
            answers |= {place.run: _known(study, place) | {"error": refused.text()} for place in places}
            continue
        ready.extend(prepared)
        for one, id in zip(prepared, _ids(prepared), strict=True):
            fixed: dict[str, Cell] = {"id": id, "seed": one.spec.seed, "substeps": one.spec.substeps}
            answers[one.place.run] = _known(study, one.place) | fixed
    for one, result in _results(ready, detector):
        if isinstance(result, SpecError):
            answers[one.place.run] |= {"error": from_engine(result).text()}
            continue
        try:
            answers[one.place.run] |= measured(study, one.spec, one.engine, result)
        except KeyError as missing:
            answers[one.place.run] |= {"error": f"no column {missing.args[0]}"}
    return [answers[number] for number in runs]


def _known(study: Study, place: Place) -> dict[str, Cell]:
    fixed: dict[str, Cell] = {"run": place.run, "point": place.point, "faulty": place.faulty}
    return fixed | {value.column: value.shown for value in values_at(study, place.point)}


def _of_point(study: Study, places: Sequence[Place], detector: bool) -> list[_Run]:
    """Return runs of one point. Raises InvalidSpec. With and without faults, runs differ by their seeds only."""
    spec = _spec_of_point(study, places[0].point, detector)
    first: dict[bool, _Run] = {}
    found = []
    for place in places:
        one = _prepared(spec, place, first.get(place.faulty))
        first.setdefault(place.faulty, one)
        found.append(one)
    return found


def _ids(runs: Sequence[_Run]) -> list[str]:
    """Return the ids of runs of one point."""
    ids: dict[int, str] = {}
    for faulty in (True, False):
        some = [one for one in runs if one.place.faulty == faulty]
        if some:
            hashes = some[0].spec.spec_hashes([one.spec.seed for one in some])
            ids |= {one.place.run: id for one, id in zip(some, hashes, strict=True)}
    return [ids[one.place.run] for one in runs]


def _spec_of_point(study: Study, point: int, detector: bool) -> ResolvedExperiment:
    """Return the experiment of a point; if its runs can share lanes, with the substeps that its first run needs."""
    spec = experiment_of_point(study, point)
    if detector or study.seeds < LANES_FROM:
        return spec
    first = place_of(study, point * study.seeds * len(study.modes))
    one = _prepared(spec, first)
    e = one.engine
    if e.substeps is not None or e.plant.time == DISCRETE or len(one.prepared.stages) > 1 or not in_lanes(e):
        return spec
    accuracy = plain_run(e).accuracy
    if accuracy is None or accuracy.implicit:
        return spec
    return spec.model_copy(update={"substeps": accuracy.substeps})


def _prepared(spec: ResolvedExperiment, place: Place, like: _Run | None = None) -> _Run:
    """Return a run; `like` is one of the same point with or without faults, as this one is."""
    spec = at_place(spec, place)
    try:
        return _Run(place, spec, prepare(spec) if like is None else prepare_seed(like.prepared, spec))
    except SpecError as error:
        raise from_engine(error) from None


def _results(ready: Sequence[_Run], detector: bool) -> Iterator[tuple[_Run, Result | SpecError]]:
    """Yield the results of runs, those of one shape from lanes where nothing needs more than states."""
    groups: dict[object, list[_Run]] = {}
    for one in ready:
        shared = not detector and one.lanes
        groups.setdefault(shape(one.engine) if shared else one.place.run, []).append(one)
    for group in groups.values():
        for some in _of_memory(group):
            if len(some) > 1:
                yield from zip(some, plain_batch([one.engine for one in some]), strict=True)
            else:
                yield some[0], _alone(some[0], detector)


def _of_memory(group: Sequence[_Run]) -> Iterator[Sequence[_Run]]:
    """Yield parts of a group whose states fit into the memory for them."""
    e = group[0].engine
    states = sum(len(one.program.states) + len(e.plant.states) for one in e.estimators)
    most = max(1, _BYTES // (8 * max(1, states) * (e.steps // e.every + 1)))
    for begin in range(0, len(group), most):
        yield group[begin : begin + most]


def _alone(one: _Run, detector: bool) -> Result | SpecError:
    stages = one.prepared.stages
    try:
        if len(stages) == 1 and not detector:
            return plain_run(one.engine)
        return run(stages, inspect=inspector(one.spec) if detector else None, measure_cost=False)
    except SpecError as error:  # no allowed step suits the gains
        return error
