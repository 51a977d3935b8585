"""`thetascope check`: what a plant file says as mathematics, or what is wrong with it and where."""

import time
from collections.abc import Sequence
from pathlib import Path

from thetascope import assembly
from thetascope.cli.terminal import table
from thetascope.engine.errors import ExpressionError, SpecError
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, validated
from thetascope.runs.specs.spec_files import Document, DocumentRefused, read
from thetascope.settings import load
from thetascope_schemas.experiment.plant import Plant


def check_command(path: Path) -> int:
    """Check a plant file and print the report. Raises DocumentError or DocumentRefused."""
    document = read(path, load().max_body)
    start = time.perf_counter()
    try:
        plant = validated(Plant, document.data)
        report = assembly.check_plant(plant)
    except InvalidSpec as error:
        raise document.refused(error.errors) from None
    except SpecError as error:
        raise _located(document, error) from None
    print(f"{plant.id}: {plant.title or 'a plant'}, checked in {time.perf_counter() - start:.2f} s\n")
    print(report_text(plant, report))
    return 0


def report_text(plant: Plant, report: dict) -> str:
    """The report of a plant as text: kind and size, Φ and Ψ, what the outputs can tell, the observers that can be built."""
    sizes = ", ".join(f"{count} {name if count != 1 else name[:-1]}" for name, count in report["sizes"].items())
    parts = [f"{report['time']} time: {sizes}"]
    if report["channels"]:
        parts.append(table(["Φ", *report["channels"]], _labelled(plant.names("states"), report["Phi"])))
        parts.append(table(["Ψ", *report["channels"]], _labelled(plant.names("outputs"), report["Psi"])))
    seen = report["observability"]
    parts.append(f"observability: rank {seen['rank']} of {seen['size']} ({seen['text']})")
    parts.append("observers that can be built:")
    parts += [f"  {entry['kind']}" for entry in report["observers"] if entry["possible"]]
    parts.append("and those that cannot:")
    parts += [f"  {entry['kind']}: {entry['why']}" for entry in report["observers"] if not entry["possible"]]
    return "\n".join(parts)


def _labelled(names: Sequence[str], matrix: list[list[str]]) -> list[list[str]]:
    return [[name, *row] for name, row in zip(names, matrix, strict=True)]


def _located(document: Document, error: SpecError) -> DocumentRefused:
    field = from_engine(error).errors[0]
    if isinstance(error, ExpressionError):
        return document.refused_text(field, error.start, error.text)
    return document.refused([field])
