"""`thetascope bench`: all observers and the detector on the benchmark problems, in one table."""

import argparse
import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thetascope.assembly.benchmark.score_table import HEAD, cells, records
from thetascope.assembly.benchmark.scores import PROBLEMS, scoreboard
from thetascope.cli.records.record_benchmark import FILE, RECORD_HEAD, record_cells, score_records, scored
from thetascope.cli.terminal import Progress, table
from thetascope.cli.words import Words


def bench_command(options: argparse.Namespace, say: Words) -> int:
    """Compute the table, print it and write it to the files wanted; of a folder, that of its records."""
    folders = [Path(one) for one in options.problems if (Path(one) / FILE).is_file()]
    if folders:
        return _records_command(folders, options, say)
    progress = Progress(say, quiet=options.quiet)
    try:
        problems = options.problems or PROBLEMS
        scores = scoreboard(problems, options.seeds, options.observer, options.workers, progress.show)
    finally:
        progress.close()
    head, lines = say.head(HEAD), cells(scores, say.language)
    print(table(head, lines))
    print(say("cli.bench.legend", runs=options.seeds))
    for path in options.out:
        text = _written(records(scores, say.language), head, lines, path)
        path.write_text(text, encoding="utf-8", newline="")
    return 0


def _records_command(folders: Sequence[Path], options: argparse.Namespace, say: Words) -> int:
    progress = Progress(say, quiet=options.quiet)
    try:
        scores = [score for folder in folders for score in scored(folder, progress.show)]
    finally:
        progress.close()
    head, lines = say.head(RECORD_HEAD), record_cells(scores, say.language)
    print(table(head, lines))
    print(say("cli.bench.records-legend"))
    for path in options.out:
        text = _written(score_records(scores, say.language), head, lines, path)
        path.write_text(text, encoding="utf-8", newline="")
    return 0


def _written(rows: Sequence[dict[str, Any]], head: Sequence[str], lines: Sequence[Sequence[str]], path: Path) -> str:
    """Return the table in the format of a file's ending."""
    if path.suffix.lower() == ".json":
        return json.dumps(rows, indent=1, ensure_ascii=False) + "\n"
    if path.suffix.lower() == ".csv":
        text = io.StringIO()
        writer = csv.DictWriter(text, rows[0])
        writer.writeheader()
        writer.writerows(rows)
        return text.getvalue()
    whole = [head, ["---"] * len(head), *lines]
    return "".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |\n" for line in whole)
