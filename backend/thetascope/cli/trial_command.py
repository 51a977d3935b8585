"""`thetascope trial`: run one experiment with many seeds and count how often each decision rule is right."""

import argparse

from thetascope import assembly
from thetascope.assembly.analyses.seed_trial import Coverage, Tally, Trial, trial
from thetascope.cli.run_command import experiment_of
from thetascope.cli.terminal import Progress, number, table
from thetascope.cli.words import Words
from thetascope.runs.specs.overrides import parse_assignment
from thetascope.runs.specs.resolve_spec import resolved, with_changes
from thetascope.settings import load

_HEAD = ("way", "false", "before", "found", "wrong", "delay", "size-held", "onset-held")


def trial_command(options: argparse.Namespace, say: Words) -> int:
    """Run the trial and print its table."""
    changes = dict(parse_assignment(t) for t in options.changes)
    spec = resolved(with_changes(experiment_of(options.experiment, load()), changes))
    progress = Progress(say, quiet=options.quiet)
    try:
        result = trial(assembly.prepare(spec), options.seeds, options.lock, progress.show)
    finally:
        progress.close()
    print(text(result, say))
    return 0


def text(result: Trial, say: Words) -> str:
    """Return the table and the meaning of its columns."""
    rows = [_row(t, result, say) for t in result.tallies]
    faults = [say("cli.trial.fault", channel=fault.channel, onset=fault.onset) for fault in result.faults]
    legend = say("cli.trial.legend", runs=result.seeds, all=result.seeds * len(result.faults), faults=faults)
    return f"{table(say.head(_HEAD), rows)}\n{legend}"


def _row(tally: Tally, result: Trial, say: Words) -> tuple[str, ...]:
    def share(count: int) -> str:
        return f"{count} ({100 * count / result.seeds:.3g} %)"

    delay = "–" if tally.delay is None else number(tally.delay)
    return (
        say.text(tally.name),
        share(tally.without),
        share(tally.before),
        str(sum(tally.found.values())),
        str(tally.wrong),
        delay,
        _held(tally.size),
        _held(tally.onset),
    )


def _held(coverage: Coverage) -> str:
    """Return how many intervals held the truth, of how many."""
    return f"{coverage.held}/{coverage.reported}" if coverage.reported else "–"
