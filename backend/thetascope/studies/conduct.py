"""Compute a study: the blocks that are missing, in any order, each kept as soon as it is there."""

import io
from collections.abc import Callable
from dataclasses import dataclass

import polars as pl

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Refusal
from thetascope.studies.engines import Engine, computed
from thetascope.studies.kept import Kept, document_of


@dataclass(frozen=True)
class Progress:
    """Runs whose rows are kept, of how many."""

    done: int
    runs: int


def conduct(
    kept: Kept,
    engine: Engine,
    progress: Callable[[Progress], None] = lambda _: None,
    cancelled: Callable[[], bool] = lambda: False,
) -> None:
    """Compute what is missing. Raises Refusal; what was kept stays, and the next call goes on from there."""
    study = kept.study
    missing = kept.check()
    done = kept.runs_done
    progress(Progress(done, study.runs))
    for one in computed(engine, document_of(study), iter(missing), kept.span, cancelled):
        if done == 0:
            _check_first(one.data)
        kept.add(one.block, one.data)
        first, last = kept.span(one.block)
        done += last - first
        progress(Progress(done, study.runs))


def _check_first(data: bytes) -> None:
    """Refuse a study whose first block has only runs that were refused: its spec is wrong, not single points."""
    errors = pl.read_parquet(io.BytesIO(data)).get_column("error")
    if errors.null_count() == 0:
        raise Refusal(Message("study.all-refused", reason=str(errors[0])))
