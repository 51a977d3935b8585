"""`thetascope trial`: one experiment with many seeds, and how often each way of deciding is right."""

import argparse

from thetascope import assembly
from thetascope.assembly.analyses.seed_trial import Tally, Trial, trial
from thetascope.cli.run_command import experiment_of
from thetascope.cli.terminal import Progress, number, table
from thetascope.runs.specs.overrides import parse_assignment
from thetascope.runs.specs.resolve_spec import resolved, with_changes
from thetascope.settings import load

_HEAD = ("", "FALSE", "BEFORE", "FOUND", "WRONG", "DELAY")
_LEGEND = """\
FALSE: of {n} runs without faults, those with any alarm. BEFORE: of {n} runs with faults, those with an alarm before the first.
FOUND: faults named, of {all}{faults}. WRONG: alarms that name none of the faults there were. DELAY: median, in s."""


def trial_command(options: argparse.Namespace) -> int:
    """Run the trial and print its table."""
    changes = dict(parse_assignment(t) for t in options.changes)
    spec = resolved(with_changes(experiment_of(options.experiment, load()), changes))
    progress = Progress(quiet=options.quiet)
    try:
        found = trial(assembly.prepare(spec), options.seeds, options.lock, progress.show)
    finally:
        progress.close()
    print(text(found))
    return 0


def text(found: Trial) -> str:
    """The table and what its columns mean."""
    rows = [_row(t, found) for t in found.tallies]
    faults = "".join(f", {channel} at {onset:g} s" for channel, onset in found.faults)
    legend = _LEGEND.format(
        n=found.seeds, all=found.seeds * len(found.faults), faults=f" ({faults[2:]})" if faults else ""
    )
    return f"{table(_HEAD, rows)}\n{legend}"


def _row(tally: Tally, found: Trial) -> tuple[str, ...]:
    def share(count: int) -> str:
        return f"{count} ({100 * count / found.seeds:.3g} %)"

    delay = "–" if tally.delay is None else number(tally.delay)
    return (
        tally.name,
        share(tally.without),
        share(tally.before),
        str(sum(tally.found.values())),
        str(tally.wrong),
        delay,
    )
