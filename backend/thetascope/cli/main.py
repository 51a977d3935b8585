"""The command line: `thetascope serve | key | run | figure | trial | study | bench | diagnose | fit | hysteresis |
inspect | list | check`, and `backup | restore | verify` for the store of runs.

Exit codes: 0 done, 1 refused or failed (with the reason), 2 wrong usage, 130 interrupted. Commands import their modules
when they run, so that `--help` and usage errors are answered quickly.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from thetascope import __version__
from thetascope.cli.argparse_words import translate_argparse
from thetascope.cli.bench_options import TABLES, add_bench_options
from thetascope.cli.records.mapping_options import add_mapping_options
from thetascope.cli.studies.study_options import TABLES as STUDY_TABLES
from thetascope.cli.studies.study_options import add_study_options
from thetascope.cli.words import Words, chosen_language
from thetascope.messages import Message
from thetascope.process_settings import collect_rarely, use_one_thread

Value = TypeVar("Value")

FORMATS = (".csv", ".json", ".mat", ".parquet", ".html")
COMPARISONS = (".csv", ".json")
FIGURES = (".pdf", ".svg", ".png", ".tex", ".json")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code."""
    use_one_thread()
    collect_rarely()
    arguments = sys.argv[1:] if arguments is None else arguments
    say = Words(chosen_language(arguments))
    translate_argparse(say.language)
    options = parser(say).parse_args(arguments)
    try:
        return options.command(options, say)
    except KeyboardInterrupt:
        return _fail(say("cli.interrupted"), 130)
    except BrokenPipeError:  # `thetascope list | head`
        sys.stderr.close()
        return 0
    except _expected() as error:
        return _fail(_reason(error, say), 1)


def parser(say: Words) -> argparse.ArgumentParser:
    """Return the parser of the command line, with help in the language of `say`."""
    top = argparse.ArgumentParser(prog="thetascope", description=say("cli.description"))
    top.add_argument("--version", action="version", version=f"%(prog)s {__version__}", help=say("cli.help.version"))
    top.add_argument("--language", metavar="LANGUAGE", help=say("cli.help.language"))
    commands = top.add_subparsers(title=say("cli.commands"), required=True, metavar="COMMAND")

    serve = commands.add_parser("serve", help=say("cli.serve"))
    serve.add_argument("--host", help=say("cli.help.host"))
    serve.add_argument("--port", type=int, help=say("cli.help.port"))
    serve.add_argument("--read-only", action="store_true", help=say("cli.help.read-only"))
    serve.add_argument("--processes", type=int, metavar="N", help=say("cli.help.processes"))
    serve.add_argument("--router", choices=("caddy", "none"), help=say("cli.help.router"))
    serve.add_argument("--open", action="store_true", help=say("cli.help.open"))
    serve.set_defaults(command=_serve)

    key = commands.add_parser("key", help=say("cli.key"), description=say("cli.key.description"))
    key.add_argument("--new", action="store_true", help=say("cli.help.new-key"))
    key.set_defaults(command=_key)

    run = commands.add_parser("run", help=say("cli.run"), description=say("cli.run.description"))
    run.add_argument("experiment", metavar="EXPERIMENT|FILE", help=say("cli.help.experiment"))
    run.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", dest="changes", help=say("cli.help.set")
    )
    output, comparison = _checked(_output, say), _checked(_comparison, say)
    outputs = say("cli.help.out", formats=" ".join(FORMATS))
    run.add_argument("--out", action="append", default=[], type=output, metavar="FILE", help=outputs)
    help_comparison = say("cli.help.comparison")
    run.add_argument("--comparison", action="append", default=[], type=comparison, metavar="FILE", help=help_comparison)
    run.add_argument("--quiet", action="store_true", help=say("cli.help.quiet"))
    run.add_argument("--no-store", action="store_true", help=say("cli.help.no-store"))
    run.set_defaults(command=_run)

    _drawing(commands, say)
    _judging(commands, say)
    study = commands.add_parser("study", help=say("cli.study"), description=say("cli.study.description"))
    add_study_options(study, say, _checked(_count, say), _checked(lambda text: _output(text, STUDY_TABLES), say))
    study.set_defaults(command=_study)
    _storing(commands, say)

    commands.add_parser("list", help=say("cli.list")).set_defaults(command=_list)

    check = commands.add_parser("check", help=say("cli.check"))
    check.add_argument("plant", metavar="PLANTFILE", type=Path, help=say("cli.help.plant-file"))
    check.set_defaults(command=_check)
    return top


def _drawing(commands: Any, say: Words) -> None:
    """Add the command that writes a figure for print; its limits and names are those of `PrintSettings`."""
    figure = commands.add_parser("figure", help=say("cli.figure"), description=say("cli.figure.description"))
    figure.add_argument("experiment", metavar="RUN|EXPERIMENT|FILE", help=say("cli.help.figure-of"))
    figure.add_argument("name", metavar="NAME", help=say("cli.help.figure-name"))
    figure.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", dest="changes", help=say("cli.help.set")
    )
    output = _checked(lambda text: _output(text, FIGURES), say)
    outputs = say("cli.help.out", formats=" ".join(FIGURES))
    figure.add_argument("--out", action="append", required=True, type=output, metavar="FILE", help=outputs)
    for option, metavar, kind in (
        ("width", "CM", float),
        ("height", "CM", float),
        ("font", "times|sans|serif", str),
        ("size", "PT", float),
        ("colour", "grey|black|colour", str),
        ("legend", "inside|above|none", str),
        ("start", "S", float),
        ("end", "S", float),
    ):
        figure.add_argument(f"--{option}", metavar=metavar, type=kind, help=say(f"cli.help.figure.{option}"))
    figure.add_argument("--curve", action="append", metavar="CURVE", dest="curves", help=say("cli.help.figure.curve"))
    panels = say("cli.help.figure.panel")
    figure.add_argument("--panel", action="append", metavar="N", dest="panels", type=int, help=panels)
    styles = say("cli.help.figure.style")
    figure.add_argument("--style", action="append", metavar="CURVE=STYLE", dest="styles", help=styles)
    figure.add_argument("--observer", metavar="LABEL", help=say("cli.help.figure.observer"))
    figure.add_argument("--quiet", action="store_true", help=say("cli.help.quiet"))
    figure.add_argument("--no-store", action="store_true", help=say("cli.help.no-store"))
    figure.set_defaults(command=_figure)


def _storing(commands: Any, say: Words) -> None:
    """Add the commands that keep and check the store."""
    backup = commands.add_parser("backup", help=say("cli.backup"))
    backup.add_argument("file", metavar="FILE", type=Path, help=say("cli.help.backup-file"))
    backup.add_argument("--force", action="store_true", help=say("cli.help.force-backup"))
    backup.set_defaults(command=_backup)

    restore = commands.add_parser("restore", help=say("cli.restore"))
    restore.add_argument("file", metavar="FILE", type=Path, help=say("cli.help.backup-file"))
    restore.add_argument("--force", action="store_true", help=say("cli.help.force-restore"))
    restore.set_defaults(command=_restore)

    verify = commands.add_parser("verify", help=say("cli.verify"))
    verify.add_argument("file", metavar="FILE", type=Path, nargs="?", help=say("cli.help.verify-file"))
    verify.set_defaults(command=_verify)


def _judging(commands: Any, say: Words) -> None:
    """Add the commands that evaluate the diagnosis."""
    trial = commands.add_parser("trial", help=say("cli.trial"), description=say("cli.trial.description"))
    trial.add_argument("experiment", metavar="EXPERIMENT|FILE", help=say("cli.help.experiment"))
    trial.add_argument("--seeds", type=_checked(_count, say), default=100, metavar="N", help=say("cli.help.seeds"))
    trial.add_argument("--lock", type=float, metavar="S", help=say("cli.help.lock"))
    trial.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", dest="changes", help=say("cli.help.set")
    )
    trial.add_argument("--quiet", action="store_true", help=say("cli.help.no-progress"))
    trial.set_defaults(command=_trial)

    bench = commands.add_parser("bench", help=say("cli.bench"), description=say("cli.bench.description"))
    add_bench_options(bench, say, _checked(_count, say), _checked(lambda text: _output(text, TABLES), say))
    bench.set_defaults(command=_bench)

    diagnose = commands.add_parser("diagnose", help=say("cli.diagnose"), description=say("cli.diagnose.description"))
    diagnose.add_argument("plant", metavar="PLANT|PLANTFILE", help=say("cli.help.plant"))
    diagnose.add_argument("data", metavar="DATA", type=Path, help=say("cli.help.data"))
    diagnose.add_argument("--healthy", metavar="BEGIN..END", help=say("cli.help.healthy"))
    diagnose.add_argument("--false-alarms", type=float, metavar="RATE", help=say("cli.help.false-alarms"))
    diagnose.add_argument("--fit", metavar="auto|never|NAMES", help=say("cli.help.fit"))
    diagnose.add_argument("--json", type=Path, metavar="FILE", help=say("cli.help.json"))
    observer = say("cli.help.observer")
    diagnose.add_argument("--observer", action="append", default=[], metavar="KIND", help=observer)
    outputs = say("cli.help.out", formats=" ".join(FORMATS))
    checked = _checked(_output, say)
    diagnose.add_argument("--out", action="append", default=[], type=checked, metavar="FILE", help=outputs)
    add_mapping_options(diagnose, say)
    diagnose.set_defaults(command=_diagnose)

    fit = commands.add_parser("fit", help=say("cli.fit"), description=say("cli.fit.description"))
    fit.add_argument("plant", metavar="PLANT|PLANTFILE", help=say("cli.help.plant"))
    fit.add_argument("data", metavar="DATA", type=Path, help=say("cli.help.data"))
    fit.add_argument("--healthy", metavar="BEGIN..END", help=say("cli.help.healthy"))
    fit.add_argument("--parameters", metavar="NAMES", help=say("cli.help.parameters"))
    fit.add_argument("--out", type=Path, metavar="FILE", help=say("cli.help.plant-out"))
    add_mapping_options(fit, say)
    fit.set_defaults(command=_fit)

    hysteresis = commands.add_parser(
        "hysteresis", help=say("cli.hysteresis"), description=say("cli.hysteresis.description")
    )
    hysteresis.add_argument("data", metavar="DATA", type=Path, help=say("cli.help.data"))
    hysteresis.add_argument("--input", required=True, metavar="COLUMN", help=say("cli.help.hysteresis-input"))
    hysteresis.add_argument("--output", required=True, metavar="COLUMN", help=say("cli.help.hysteresis-output"))
    operators = _checked(_operators, say)
    hysteresis.add_argument(
        "--operators", type=operators, default=7, metavar="N", help=say("cli.help.hysteresis-operators")
    )
    hysteresis.add_argument("--thresholds", metavar="NUMBERS", help=say("cli.help.hysteresis-thresholds"))
    hysteresis.add_argument("--out", type=Path, metavar="FILE", help=say("cli.help.hysteresis-out"))
    hysteresis.set_defaults(command=_hysteresis)

    inspect = commands.add_parser("inspect", help=say("cli.inspect"), description=say("cli.inspect.description"))
    inspect.add_argument("plant", metavar="PLANT|PLANTFILE", help=say("cli.help.plant"))
    inspect.add_argument("data", metavar="DATA", type=Path, help=say("cli.help.data"))
    inspect.add_argument("--json", type=Path, metavar="FILE", help=say("cli.help.json-inspection"))
    add_mapping_options(inspect, say)
    inspect.set_defaults(command=_inspect)


def _checked(convert: Callable[[str], Value], say: Words) -> Callable[[str], Value]:
    """Return an argument type whose errors are in the language of `say`."""

    def converted(text: str) -> Value:
        try:
            return convert(text)
        except _Mistake as mistake:
            raise argparse.ArgumentTypeError(mistake.problem.text(say.language)) from None

    return converted


class _Mistake(Exception):
    """An invalid argument."""

    def __init__(self, problem: Message) -> None:
        super().__init__(problem)
        self.problem = problem


def _output(text: str, formats: Sequence[str] = FORMATS) -> Path:
    path = Path(text)
    if path.suffix.lower() not in formats:
        raise _Mistake(Message("cli.mistake.suffix", name=text, formats=formats))
    if not path.absolute().parent.is_dir():
        raise _Mistake(Message("cli.mistake.folder", folder=str(path.absolute().parent)))
    return path


def _count(text: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= 100_000:
        raise _Mistake(Message("cli.mistake.count", value=text, most=100_000))
    return int(text)


def _operators(text: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= 30:
        raise _Mistake(Message("cli.mistake.count", value=text, most=30))
    return int(text)


def _comparison(text: str) -> Path:
    return _output(text, COMPARISONS)


def _trial(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.trial_command import trial_command

    return trial_command(options, say)


def _hysteresis(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.records.hysteresis_command import hysteresis_command

    return hysteresis_command(options, say)


def _study(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.studies.study_command import study_command

    return study_command(options, say)


def _bench(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.bench_command import bench_command

    return bench_command(options, say)


def _fit(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.records.diagnose_command import fit_command

    return fit_command(options, say)


def _diagnose(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.records.diagnose_command import diagnose_command

    return diagnose_command(options, say)


def _inspect(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.records.inspect_command import inspect_command

    return inspect_command(options, say)


def _serve(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.serve_command import serve_command

    return serve_command(options, say)


def _key(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.access_commands import key_command

    return key_command(options.new, say)


def _run(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.run_command import run_command

    return run_command(options, say)


def _figure(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.figures.figure_command import figure_command

    return figure_command(options, say)


def _backup(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.store_commands import backup_command

    return backup_command(options.file, options.force, say)


def _restore(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.store_commands import restore_command

    return restore_command(options.file, options.force, say)


def _verify(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.store_commands import verify_command

    return verify_command(options.file, say)


def _list(options: argparse.Namespace, say: Words) -> int:
    from thetascope import library
    from thetascope.cli.terminal import table

    experiments = [[item.id, item.plant_id, say.text(item.title)] for item in library.experiments().values()]
    plants = [[item.id, say(f"cli.time.{item.time.kind}"), say.text(item.title)] for item in library.plants().values()]
    print(table(say.head(("experiment", "plant", "title")), experiments))
    print()
    print(table(say.head(("plant", "time", "title")), plants))
    return 0


def _check(options: argparse.Namespace, say: Words) -> int:
    from thetascope.cli.check_command import check_command

    return check_command(options.plant, say)


def _expected() -> tuple[type[Exception], ...]:
    """Return the errors whose message suffices for a user; others are program errors and keep their traceback."""
    from thetascope.engine.errors import ThetascopeError
    from thetascope.runs.specs.refusals import InvalidSpec, Refusal
    from thetascope.runs.specs.spec_files import DocumentError, DocumentRefused
    from thetascope.settings import SettingsError
    from thetascope.store import StoreError

    return ThetascopeError, DocumentError, DocumentRefused, InvalidSpec, Refusal, SettingsError, StoreError, OSError


def _reason(error: Exception, say: Words) -> str:
    """Return the reason why a command failed."""
    from thetascope.engine.errors import ExpressionError, SpecError
    from thetascope.runs.specs.refusals import from_engine

    if isinstance(error, SpecError):
        pointer = f"\n{error.pointer}" if isinstance(error, ExpressionError) else ""
        return from_engine(error).text(say.language) + pointer
    text = getattr(error, "text", None)
    return str(error) if text is None else text(say.language)


def _fail(message: str, code: int) -> int:
    print(f"thetascope: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
