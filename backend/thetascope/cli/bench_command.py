"""`thetascope bench`: all observers and the detector on the benchmark problems, in one table."""

import argparse
import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

from thetascope.assembly.benchmark.score_table import HEAD, cells, records
from thetascope.assembly.benchmark.scores import PROBLEMS, Score, scoreboard
from thetascope.cli.terminal import Progress, table
from thetascope.cli.words import Words


def bench_command(options: argparse.Namespace, say: Words) -> int:
    """Compute the table, print it and write it to the files wanted."""
    progress = Progress(say, quiet=options.quiet)
    try:
        problems = options.problems or PROBLEMS
        scores = scoreboard(problems, options.seeds, options.observer, options.workers, progress.show)
    finally:
        progress.close()
    print(table(say.head(HEAD), cells(scores, say.language)))
    print(say("cli.bench.legend", runs=options.seeds))
    for path in options.out:
        path.write_text(_written(scores, path, say), encoding="utf-8", newline="")
    return 0


def _written(scores: Sequence[Score], path: Path, say: Words) -> str:
    """Return the table in the format of a file's ending."""
    rows = records(scores, say.language)
    if path.suffix.lower() == ".json":
        return json.dumps(rows, indent=1, ensure_ascii=False) + "\n"
    if path.suffix.lower() == ".csv":
        text = io.StringIO()
        writer = csv.DictWriter(text, rows[0])
        writer.writeheader()
        writer.writerows(rows)
        return text.getvalue()
    lines = [say.head(HEAD), ["---"] * len(HEAD), *cells(scores, say.language)]
    return "".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |\n" for line in lines)
