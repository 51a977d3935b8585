"""`thetascope check`: print the equations of a plant file, or its errors and their places."""

import time
from collections.abc import Sequence
from pathlib import Path

from thetascope import assembly
from thetascope.cli.terminal import table
from thetascope.cli.words import Words
from thetascope.engine.errors import ExpressionError, SpecError
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, validated
from thetascope.runs.specs.spec_files import Document, DocumentRefused, read
from thetascope.settings import load
from thetascope_schemas.experiment.plant import Plant


def check_command(path: Path, say: Words) -> int:
    """Check a plant file and print the report. Raises DocumentError or DocumentRefused."""
    document = read(path, load().max_body)
    start = time.perf_counter()
    try:
        plant = validated(Plant, document.data)
        report = assembly.check_plant(plant, say.language)
    except InvalidSpec as error:
        raise document.refused(error.errors) from None
    except SpecError as error:
        raise _located(document, error) from None
    title = say.text(plant.title) or say("cli.check.untitled")
    print(say("cli.check.head", id=plant.id, title=title, seconds=time.perf_counter() - start) + "\n")
    print(report_text(plant, report, say))
    return 0


def report_text(plant: Plant, report: dict, say: Words) -> str:
    """Return the report of a plant as text: kind and size, Φ and Ψ, observability, the observers that can be built."""
    sizes = [say(f"common.{name}", n=count) for name, count in report["sizes"].items()]
    parts = [say("cli.check.size", time=say(f"cli.time.{report['time']}"), sizes=sizes)]
    if report["channels"]:
        parts.append(table(["Φ", *report["channels"]], _labelled(plant.names("states"), report["Phi"])))
        parts.append(table(["Ψ", *report["channels"]], _labelled(plant.names("outputs"), report["Psi"])))
    observability = report["observability"]
    parts.append(
        say(
            "cli.check.observability",
            rank=observability["rank"],
            size=observability["size"],
            text=observability["text"],
        )
    )
    parts.append(say("cli.check.possible"))
    parts += [f"  {entry['kind']}" for entry in report["observers"] if entry["possible"]]
    parts.append(say("cli.check.impossible"))
    parts += [f"  {entry['kind']}: {entry['why']}" for entry in report["observers"] if not entry["possible"]]
    return "\n".join(parts)


def _labelled(names: Sequence[str], matrix: list[list[str]]) -> list[list[str]]:
    return [[name, *row] for name, row in zip(names, matrix, strict=True)]


def _located(document: Document, error: SpecError) -> DocumentRefused:
    field = from_engine(error).errors[0]
    if isinstance(error, ExpressionError):
        return document.refused_text(field, error.start, error.text)
    return document.refused([field])
