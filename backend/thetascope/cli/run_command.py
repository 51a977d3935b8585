"""`thetascope run`: run a spec in this process, with the limits and the store of the service."""

import argparse
import logging
import shlex
import sys
import time
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path

from thetascope import assembly
from thetascope.access.principal import MACHINE
from thetascope.cli.terminal import Progress, number, table
from thetascope.cli.words import Words
from thetascope.engine.errors import Cancelled, SpecError
from thetascope.engine.model.result import Result
from thetascope.export import comparison_csv, csv_chunks, json_bytes, matlab_bytes, parquet_bytes, select
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished, Job
from thetascope.runs.jobs.store_rows import record_of
from thetascope.runs.jobs.worker import allow, completed
from thetascope.runs.results.comparison_rows import compared
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.results.summary import summarise
from thetascope.runs.run_report import report_html
from thetascope.runs.specs.overrides import parse_assignment
from thetascope.runs.specs.plant_files import read_experiment
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, invalid
from thetascope.runs.specs.resolve_spec import library_experiment, plant_of, resolved, with_changes
from thetascope.runs.specs.run_requests import parse_request
from thetascope.settings import Settings, load
from thetascope.store import Damaged, Database, RunStore, StoreError
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment
from thetascope_schemas.service.comparison import Comparison, ComparisonRow

log = logging.getLogger(__name__)

_STATES = 3  # most states in the table of several observers
_JUDGED = ("found", "delay", "missed", "false", "wrong")
_ESTIMATES = ("observer", "fault", "true", "estimate", "mean-error", "std", "settled")


def run_command(options: argparse.Namespace, say: Words) -> int:
    """Run an experiment, write the requested files, print the observers' results."""
    settings = load()
    spec = experiment_of(options.experiment, settings)
    spec = with_changes(spec, dict(parse_assignment(text) for text in options.changes))
    store = None if options.no_store else open_store(settings, say)
    finished = result_of(spec, settings, store, Progress(say, quiet=options.quiet), say)
    for path in options.out:
        write(finished, path, command_line(options, path), say.language)
    for path in options.comparison:
        write_comparison(finished, path)
    if not options.quiet:
        print(outcome(finished, say))
    return 0


def experiment_of(target: str, settings: Settings) -> Experiment:
    """Return the experiment of a library id or a file. Raises Unknown, DocumentError or DocumentRefused."""
    path = Path(target)
    if not path.suffix and not path.exists():
        return library_experiment(target)
    document = read_experiment(path, settings.max_body)
    try:
        return parse_request(document.data)
    except InvalidSpec as error:
        raise document.refused(error.errors) from None


def result_of(spec: Experiment, settings: Settings, store: RunStore | None, progress: Progress, say: Words) -> Finished:
    """Return the run of a spec, from the store or computed (and then stored)."""
    complete = resolved(spec)
    job = Job(complete.spec_hash(), spec)
    result = store and _stored(store, job.id)
    if store is not None and result is not None:
        with suppress(StoreError):
            store.own(job.id, {MACHINE})
        return completed(job, result, summarise(result, complete))
    result = compute(job, complete, settings, progress)
    finished = completed(job, result, summarise(result, complete))
    if store is not None:
        _keep(store, finished, say)
    return finished


def _stored(store: RunStore, id: str) -> Result | None:
    """Return the stored result of a run, None also if it is damaged."""
    try:
        return store.get_result(id, engine_version())
    except Damaged as error:
        log.error("%s", error)
        return None


def compute(job: Job, spec: ResolvedExperiment, settings: Settings, progress: Progress) -> Result:
    """Prepare and run in a thread, so that the main thread can draw the progress and handle Ctrl-C."""

    def work() -> Result:
        prepared = assembly.prepare(spec)
        allow(spec, prepared.cost, settings.max_steps, settings.max_result)
        job.begin()
        until = time.monotonic() + settings.max_seconds
        return assembly.carry_out(prepared, job.report, lambda: job.cancelled or time.monotonic() > until)

    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(work)
        try:
            while not wait([future], timeout=0.05).done:
                progress.show(job.progress)
        except KeyboardInterrupt:
            job.cancel()
            raise
        finally:
            progress.close()
        try:
            return future.result()
        except SpecError as error:
            raise from_engine(error) from None
        except Cancelled:
            why = Message("run.too-slow", seconds=settings.max_seconds, share=job.progress)
            raise invalid("horizon", spec.horizon, why) from None


def open_store(settings: Settings, say: Words) -> RunStore | None:
    """Return the store, or None with a warning, since a run does not need it."""
    try:
        return RunStore(Database(settings.store), settings.store_limit)
    except StoreError as error:
        print(f"thetascope: {say('cli.run.not-kept', reason=error.text(say.language))}", file=sys.stderr)
        return None


def _keep(store: RunStore, finished: Finished, say: Words) -> None:
    try:
        store.put(record_of(finished.snapshot))
        store.own(finished.snapshot.id, {MACHINE})
        store.put_result(finished.snapshot.id, engine_version(), finished.result)
    except StoreError as error:
        print(f"thetascope: {say('cli.run.not-kept', reason=error.text(say.language))}", file=sys.stderr)


def write(finished: Finished, path: Path, command: str, language: str) -> None:
    """Write a result in the format given by the file's suffix."""
    suffix, whole = path.suffix.lower(), select(finished.result)
    if suffix == ".csv":
        with path.open("wb") as stream:
            stream.writelines(csv_chunks(whole))
    elif suffix == ".html":
        path.write_text(report_html(finished, command, language), encoding="utf-8")
    else:
        writers = {".mat": matlab_bytes, ".parquet": parquet_bytes}
        path.write_bytes(writers.get(suffix, json_bytes)(whole))


def write_comparison(finished: Finished, path: Path) -> None:
    """Write the comparison of the observers as CSV or JSON."""
    spec = finished.snapshot.spec
    comparison = compared(finished.result, spec)
    as_json = path.suffix.lower() == ".json"
    path.write_bytes(
        comparison.model_dump_json(indent=1).encode() if as_json else comparison_csv(comparison, plant_of(spec.plant))
    )


def command_line(options: argparse.Namespace, path: Path) -> str:
    """Return the command that writes one of the files again."""
    changes = [part for change in options.changes for part in ("--set", change)]
    return shlex.join(["thetascope", "run", options.experiment, *changes, "--out", path.name])


def outcome(finished: Finished, say: Words) -> str:
    """Return a run in a few lines: for every observer and fault the true value, the estimate and the settling."""
    from thetascope.diagnosis.evaluation.metrics import summary

    spec, result = finished.snapshot.spec, finished.result
    title, id = say.text(spec.title) or spec.id, finished.snapshot.id[:12]
    lines = [say("cli.run.head", title=title, horizon=spec.horizon, step=result.step, id=id)]
    if result.diverged:
        lines.append(
            say("report.diverged.plant", t=number(result.diverged.time), cause=say.text(result.diverged.cause))
        )
    measures = summary(result, spec.faults)
    rows = [row for label, found in measures.items() for row in _rows(label, found, say)]
    if rows:
        lines += ["", table(say.head(_ESTIMATES), rows), ""]
    lines += side_by_side(compared(result, spec), measures, say)
    if result.diagnosis is not None:
        lines += [say("cli.run.diagnosis", sentence=say.text(result.diagnosis["detector"]["sentence"])), ""]
    lines += [line for label, found in measures.items() for line in _sentences(label, found, say)]
    lines += [
        say("cli.run.fails", label=o.label, name=say.text(c.name), text=say.text(c.text))
        for o in result.observers
        for c in o.checks
        if c.verdict == "fails"
    ]
    accuracy = [result.accuracy_message] if result.accuracy_message is not None else []
    return "\n".join([*lines, *(say.text(note) for note in (*result.notes, *accuracy))]).rstrip()


def side_by_side(comparison: Comparison, measures: dict[str, dict], say: Words) -> list[str]:
    """Return a line for each observer that did not diverge, if there are several or if faults were tested for."""
    rows = [row for row in comparison.observers if not measures.get(row.label, {}).get("diverged")]
    if len(rows) < 2 and not any(row.faults for row in rows):
        return []
    rmse = {row.label: measures.get(row.label, {}).get("rmse", {}) for row in rows}  # the detector has no estimates
    states = list(dict.fromkeys(state for row in rows for state in rmse[row.label]))[:_STATES]
    judged = any(row.faults is not None for row in rows)
    rmse_heads = [say("cli.head.rmse", state=state) for state in states]
    head = [*say.head(("observer", *(_JUDGED if judged else ()))), *rmse_heads, say("cli.head.cost")]
    lines = [
        [
            row.label,
            *(_judged(row, say) if judged else ()),
            *(number(rmse[row.label].get(state), 3) for state in states),
            number(row.cost, 3),
        ]
        for row in rows
    ]
    legend = say("cli.run.cost")
    return [table(head, lines), f"{say('cli.run.legend')}\n{legend}" if judged else legend, ""]


def _judged(row: ComparisonRow, say: Words) -> list[str]:
    found = "–" if row.faults is None else say("report.of", n=row.found, all=len(row.faults) - (row.covered or 0))
    delay = "–" if row.delay is None else f"{row.delay:.2f} s"
    return [found, delay, *("–" if n is None else str(n) for n in (row.missed, row.false_alarms, row.isolation_errors))]


def _rows(label: str, measures: dict, say: Words) -> list[list[str]]:
    """Return the table lines of an observer. Mean error and standard deviation are over the last tenth of the run."""
    settled = {step["channel"]: step["time"] for step in measures["settling"]}
    rows = []
    for channel, end in {} if measures["diverged"] else measures["theta"].items():
        after = (
            "–"
            if channel not in settled
            else say("report.no")
            if settled[channel] is None
            else f"{settled[channel]:.2f} s"
        )
        values = (end["truth"], end["estimate"], end["mean_error"], end["std"])
        rows.append([label, channel, *map(number, values), after])
    return rows


def _sentences(label: str, measures: dict, say: Words) -> list[str]:
    """Return a sentence if the observer diverged, or if it estimates no fault."""
    if measures["diverged"]:
        cause, t = say.text(measures["diverged"]["cause"]), number(measures["diverged"]["time"])
        return [say("report.diverged", label=label, t=t, cause=cause)]
    if measures["theta"]:
        return []
    states = [f"{state} {number(value, 3)}" for state, value in measures["rmse_end"].items()]
    return [say("cli.run.states-only", label=label, states=states)]
