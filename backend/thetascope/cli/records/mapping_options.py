"""The options of `inspect` and `diagnose` that change how columns are mapped."""

import argparse

from thetascope.cli.words import Words


def add_mapping_options(parser: argparse.ArgumentParser, say: Words) -> None:
    """Add the options that change how columns are mapped."""
    more = {"action": "append", "default": []}
    parser.add_argument("--map", metavar="NAME=COLUMN", help=say("cli.help.map"), **more)
    parser.add_argument("--unit", metavar="NAME=UNIT", help=say("cli.help.unit"), **more)
    parser.add_argument("--time", metavar="COLUMN", help=say("cli.help.time"))
    parser.add_argument("--time-unit", metavar="UNIT", help=say("cli.help.time-unit"))
    parser.add_argument("--period", type=float, metavar="S", help=say("cli.help.period"))
