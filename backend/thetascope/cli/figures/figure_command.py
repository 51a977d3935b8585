"""`thetascope figure`: a figure of a run for print, from the store or computed in this process."""

import argparse
import re
from functools import partial
from pathlib import Path

from thetascope.access.principal import MACHINE
from thetascope.cli.run_command import experiment_of, open_store, result_of
from thetascope.cli.terminal import Progress
from thetascope.cli.words import Words
from thetascope.messages import Message
from thetascope.runs.notebook.comparison import parse_ids
from thetascope.runs.notebook.overlaid_runs import LESS, OVERLAID, names_of, prepare_overlaid
from thetascope.runs.printed_figure import drawn, prepare
from thetascope.runs.specs.overrides import parse_assignment
from thetascope.runs.specs.refusals import Unknown, validated
from thetascope.runs.specs.resolve_spec import with_changes
from thetascope.settings import Settings, load
from thetascope.store import NotebookStore, RunStore
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.figures.printed_figure import PrintSettings

_RUN = re.compile("[0-9a-f]{8,32}")


def figure_command(options: argparse.Namespace, say: Words) -> int:
    """Write a figure in every requested format, and print its caption."""
    settings = load()
    store = None if options.no_store else open_store(settings, say)
    fields = {name: getattr(options, name) for name in PrintSettings.model_fields if hasattr(options, name)}
    fields = {name: value for name, value in fields.items() if value is not None} | {"lang": options.language}
    pages = [(path, validated(PrintSettings, fields | {"format": path.suffix[1:].lower()})) for path in options.out]
    changes = dict(map(parse_assignment, options.changes))
    several = options.name in (OVERLAID, LESS)
    runs = [
        result_of(with_changes(spec, changes), settings, store, Progress(say, quiet=options.quiet), say)
        for spec in [
            _experiment(target, settings, store)
            for target in (parse_ids(options.experiment) if several else [options.experiment])
        ]
    ]
    caption = ""
    for path, chosen in pages:
        if several:
            names = names_of(runs, partial(_name, store))
            sheet, description, _ = prepare_overlaid(
                runs, names, chosen, options.observer, options.name == LESS, path.name
            )
        else:
            sheet, description, _ = prepare(
                runs[0], options.name, chosen, options.experiment, options.changes, path.name
            )
        text = description.model_dump_json(indent=1).encode() if chosen.format == "json" else None
        path.write_bytes(drawn(sheet, chosen.format, path.name) if text is None else text)
        caption = f"{description.caption}\n{description.command}"
    if not options.quiet:
        print(caption)
    return 0


def _name(store: RunStore | None, id: str) -> str:
    """Return the name that the machine's owner gave a run, or ""."""
    line = NotebookStore(store.database).line(MACHINE, id) if store is not None else None
    return line.name if line is not None else ""


def _experiment(target: str, settings: Settings, store: RunStore | None) -> Experiment:
    """Return the experiment of a run in the store (its id or the first eight characters), of the library, or a file."""
    if store is None or not _RUN.fullmatch(target) or Path(target).exists():
        return experiment_of(target, settings)
    ids = store.ids(target)
    record = store.get(ids[0]) if len(ids) == 1 else None
    if record is None:
        raise Unknown(Message("run.unknown", id=target), Message("suggest.near", names=ids) if ids else None)
    return Experiment.model_validate_json(record.spec)
