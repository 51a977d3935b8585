"""`thetascope study`: compute a study, or go on with it, and print its table."""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

import polars as pl

from thetascope.cli.studies.study_options import TABLES
from thetascope.cli.terminal import Progress, table
from thetascope.cli.words import Words
from thetascope.messages import Message
from thetascope.runs.specs.refusals import InvalidSpec, invalid, validated
from thetascope.runs.specs.spec_files import read
from thetascope.settings import Settings, load
from thetascope.studies.conduct import conduct
from thetascope.studies.engines import DaskEngine, Engine, LocalEngine
from thetascope.studies.kept import Kept
from thetascope.studies.plan import complete
from thetascope.studies.summary import measures
from thetascope.studies.tables import (
    cell_text,
    csv_bytes,
    latex,
    parquet_bytes,
    point_table,
    usual_measures,
    value_text,
)
from thetascope_schemas.service.study.study import Study

_LINES = 40
"""Most points that are printed; a file holds all."""


def study_command(options: argparse.Namespace, say: Words) -> int:
    """Compute what is missing, print the table and write it to the files wanted."""
    settings = load()
    kept = _kept(options, settings)
    progress = Progress(say, quiet=options.quiet)
    if kept.check():
        engine = _engine(options, settings)
        try:
            conduct(kept, engine, lambda now: progress.show(now.done / now.runs))
        except KeyboardInterrupt:
            engine.close()
            progress.close()
            print(say("cli.study.kept", done=kept.runs_done, runs=kept.study.runs))
            raise
        finally:
            engine.close()
            progress.close()
    whole = kept.table()
    chosen = _chosen(options.measure, whole, kept.study)
    print(_text(whole, kept.study, chosen, say))
    for path in options.out:
        path.write_bytes(_written(path, whole, kept.study, chosen))
    return 0


def _kept(options: argparse.Namespace, settings: Settings) -> Kept:
    """Return the study of a folder, or that of a file with its folder."""
    if "://" in options.file or Path(options.file).is_dir():
        return Kept.at(options.file)
    path = Path(options.file)
    document = read(path, settings.max_body)
    try:
        study = complete(validated(Study, document.data))
    except InvalidSpec as refused:
        raise document.refused(refused.errors) from None
    return Kept(study, options.folder or path.with_suffix(".study"))


def _engine(options: argparse.Namespace, settings: Settings) -> Engine:
    address = options.scheduler or settings.scheduler
    if address:
        return DaskEngine(address)
    return LocalEngine(options.workers or os.cpu_count() or 1, options.threads)


def _chosen(wanted: Sequence[str], whole: pl.DataFrame, study: Study) -> Sequence[str]:
    known = measures(whole, study)
    for name in wanted:
        if name not in known:
            raise invalid("--measure", name, Message("study.measure.unknown", name=name, names=known))
    return wanted or usual_measures(whole, study)


def _text(whole: pl.DataFrame, study: Study, chosen: Sequence[str], say: Words) -> str:
    rows = point_table(whole, study, chosen)
    head = (*rows.factors, say("cli.study.runs"), *rows.measures)
    lines = [(*map(value_text, row.values), str(row.runs), *map(cell_text, row.cells)) for row in rows.rows[:_LINES]]
    parts = [table(head, lines)]
    if len(rows.rows) > _LINES:
        parts.append(say("cli.study.more", n=len(rows.rows) - _LINES, formats=" ".join(TABLES)))
    refused = whole.get_column("error").drop_nulls()
    if len(refused):
        parts.append(say("cli.study.refused", n=len(refused), of=len(whole), reason=str(refused[0])))
    parts.append(say("cli.study.legend"))
    return "\n".join(parts)


def _written(path: Path, whole: pl.DataFrame, study: Study, chosen: Sequence[str]) -> bytes:
    match path.suffix.lower():
        case ".csv":
            return csv_bytes(whole)
        case ".parquet":
            return parquet_bytes(whole)
        case _:
            return latex(point_table(whole, study, chosen)).encode()
