"""The options of `thetascope bench`."""

import argparse
from collections.abc import Callable
from pathlib import Path

from thetascope.cli.words import Words

TABLES = (".csv", ".json", ".md")
"""Endings of the files that hold the table."""


def add_bench_options(
    parser: argparse.ArgumentParser, say: Words, count: Callable[[str], int], output: Callable[[str], Path]
) -> None:
    """Add the problems and options; `count` and `output` check numbers and files."""
    parser.add_argument("problems", metavar="EXPERIMENT|FOLDER", nargs="*", help=say("cli.help.bench-problems"))
    parser.add_argument("--seeds", type=count, default=10, metavar="N", help=say("cli.help.bench-seeds"))
    rules = say("cli.help.bench-observer")
    parser.add_argument("--observer", action="append", default=[], metavar="KIND|detector", help=rules)
    parser.add_argument("--workers", type=count, default=1, metavar="N", help=say("cli.help.bench-workers"))
    files = say("cli.help.out", formats=" ".join(TABLES))
    parser.add_argument("--out", action="append", default=[], type=output, metavar="FILE", help=files)
    parser.add_argument("--quiet", action="store_true", help=say("cli.help.no-progress"))
