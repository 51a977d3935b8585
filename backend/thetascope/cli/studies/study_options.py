"""The options of `thetascope study`."""

import argparse
from collections.abc import Callable
from pathlib import Path

from thetascope.cli.words import Words

TABLES = (".csv", ".parquet", ".tex")
"""Endings of the files that hold the table."""


def add_study_options(
    parser: argparse.ArgumentParser, say: Words, count: Callable[[str], int], output: Callable[[str], Path]
) -> None:
    """Add the file and the options; `count` and `output` check numbers and files."""
    parser.add_argument("file", metavar="FILE|FOLDER", help=say("cli.help.study-file"))
    parser.add_argument("--folder", metavar="PLACE", help=say("cli.help.study-folder"))
    parser.add_argument("--workers", type=count, metavar="N", help=say("cli.help.study-workers"))
    parser.add_argument("--threads", action="store_true", help=say("cli.help.study-threads"))
    parser.add_argument("--scheduler", metavar="ADDRESS", help=say("cli.help.study-scheduler"))
    measure = say("cli.help.study-measure")
    parser.add_argument("--measure", action="append", default=[], metavar="COLUMN", help=measure)
    files = say("cli.help.out", formats=" ".join(TABLES))
    parser.add_argument("--out", action="append", default=[], type=output, metavar="FILE", help=files)
    parser.add_argument("--quiet", action="store_true", help=say("cli.help.no-progress"))
