"""The command line: `thetascope serve | run | trial | diagnose | list | check`.

Exit codes: 0 done, 1 refused or failed (the message says why), 2 wrong use of the command, 130 interrupted.
Modules are imported by the commands that need them, so that `--help` and mistakes answer at once.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from thetascope import __version__

FORMATS = (".csv", ".json", ".mat", ".html")
COMPARISONS = (".csv", ".json")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code."""
    options = parser().parse_args(arguments)
    try:
        return options.command(options)
    except KeyboardInterrupt:
        return _fail("interrupted", 130)
    except BrokenPipeError:  # `thetascope list | head`
        sys.stderr.close()
        return 0
    except _expected() as error:
        return _fail(str(error), 1)


def parser() -> argparse.ArgumentParser:
    """What the command line understands."""
    top = argparse.ArgumentParser(prog="thetascope", description="Adaptive observers finding faults.")
    top.add_argument("--version", action="version", version=f"%(prog)s {__version__}", help="print the version")
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")

    serve = commands.add_parser("serve", help="serve the page and the REST interface")
    serve.add_argument("--host", help="address to listen on (default 127.0.0.1)")
    serve.add_argument("--port", type=int, help="port to listen on (default 8000; 0 takes a free one)")
    serve.add_argument("--open", action="store_true", help="open the page in the browser")
    serve.set_defaults(command=_serve)

    run = commands.add_parser("run", help="run an experiment", description=_RUN)
    run.add_argument("experiment", metavar="EXPERIMENT|FILE", help="library id, or a YAML or JSON file")
    changes = "change a value: observers.adaptive.gains.rho=8, noise.y.std=0, faults.0.size=0.03"
    run.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", dest="changes", help=changes)
    outputs = f"write the result; the ending tells the format: {' '.join(FORMATS)}"
    run.add_argument("--out", action="append", default=[], type=_output, metavar="FILE", help=outputs)
    run.add_argument(
        "--comparison",
        action="append",
        default=[],
        type=_comparison,
        metavar="FILE",
        help="write the comparison of the observers: .csv or .json",
    )
    run.add_argument("--quiet", action="store_true", help="print nothing but errors")
    run.add_argument("--no-store", action="store_true", help="neither look the run up in the store nor keep it there")
    run.set_defaults(command=_run)

    _judging(commands, changes)

    listing = commands.add_parser("list", help="list the library's experiments and plants")
    listing.set_defaults(command=_list)

    check = commands.add_parser("check", help="check a plant file")
    check.add_argument("plant", metavar="PLANTFILE", type=Path, help="a YAML or JSON file")
    check.set_defaults(command=_check)
    return top


_TRIAL = "How often are alarms false, faults found and named, and how soon? One experiment with many seeds."
_DIAGNOSE = (
    "Which faults does a record show, since when, how large, and how sure is that? The noise is found in the record."
)


def _judging(commands, changes: str) -> None:
    """The commands about the diagnosis."""
    trial = commands.add_parser(
        "trial", help="run an experiment with many seeds and judge the diagnosis", description=_TRIAL
    )
    trial.add_argument("experiment", metavar="EXPERIMENT|FILE", help="library id, or a YAML or JSON file")
    trial.add_argument(
        "--seeds", type=_count, default=100, metavar="N", help="runs with the faults, and as many without (100)"
    )
    trial.add_argument("--lock", type=float, metavar="S", help="also judge a 3σ band that is fixed at this time")
    trial.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", dest="changes", help=changes)
    trial.add_argument("--quiet", action="store_true", help="show no progress")
    trial.set_defaults(command=_trial)

    diagnose = commands.add_parser("diagnose", help="look for faults in recorded data", description=_DIAGNOSE)
    diagnose.add_argument("plant", metavar="PLANT|PLANTFILE", help="id of a library plant, or a YAML or JSON file")
    diagnose.add_argument("data", metavar="DATA.csv", type=Path, help="columns t, inputs, known signals and outputs")
    diagnose.add_argument(
        "--learn", type=float, default=0.0, metavar="S", help="the first S seconds are known to be sound"
    )
    diagnose.add_argument("--false-alarms", type=float, metavar="RATE", help="an hour that are put up with (0.01)")
    diagnose.add_argument(
        "--doubt", type=float, metavar="SHARE", help="how far the plant's equations may be off (0.01)"
    )
    diagnose.add_argument("--json", type=Path, metavar="FILE", help="write the findings as JSON")
    diagnose.set_defaults(command=_diagnose)


_RUN = "Run an experiment and print how its observers did. The same spec gives the same numbers, bit for bit."


def _output(text: str, formats: Sequence[str] = FORMATS) -> Path:
    path = Path(text)
    if path.suffix.lower() not in formats:
        raise argparse.ArgumentTypeError(f"{text!r} ends in none of {' '.join(formats)}")
    if not path.absolute().parent.is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder {str(path.absolute().parent)!r}")
    return path


def _count(text: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= 100_000:
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number from 1 to 100000")
    return int(text)


def _comparison(text: str) -> Path:
    return _output(text, COMPARISONS)


def _trial(options: argparse.Namespace) -> int:
    from thetascope.cli.trial_command import trial_command

    return trial_command(options)


def _diagnose(options: argparse.Namespace) -> int:
    from thetascope.cli.diagnose_command import diagnose_command

    return diagnose_command(options)


def _serve(options: argparse.Namespace) -> int:
    from thetascope.server.app import serve
    from thetascope.settings import load

    def ready(address: str) -> None:
        print(f"Thetascope is at {address} (Ctrl-C stops it)", flush=True)
        if options.open:
            import webbrowser

            webbrowser.open(address)

    serve(load(host=options.host, port=options.port), ready)
    return 0


def _run(options: argparse.Namespace) -> int:
    from thetascope.cli.run_command import run_command

    return run_command(options)


def _list(options: argparse.Namespace) -> int:
    from thetascope import library
    from thetascope.cli.terminal import table

    experiments = [[item.id, item.plant_id, item.title] for item in library.experiments().values()]
    plants = [[item.id, item.time.kind, item.title] for item in library.plants().values()]
    print(table(["EXPERIMENT", "PLANT", "TITLE"], experiments))
    print()
    print(table(["PLANT", "TIME", "TITLE"], plants))
    return 0


def _check(options: argparse.Namespace) -> int:
    from thetascope.cli.check_command import check_command

    return check_command(options.plant)


def _expected() -> tuple[type[Exception], ...]:
    """The errors whose message is all a user needs; others are faults of the program and keep their traceback."""
    from thetascope.engine.errors import ThetascopeError
    from thetascope.runs.specs.refusals import InvalidSpec, Refusal
    from thetascope.runs.specs.spec_files import DocumentError, DocumentRefused
    from thetascope.settings import SettingsError
    from thetascope.store import StoreError

    return ThetascopeError, DocumentError, DocumentRefused, InvalidSpec, Refusal, SettingsError, StoreError, OSError


def _fail(message: str, code: int) -> int:
    print(f"thetascope: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
