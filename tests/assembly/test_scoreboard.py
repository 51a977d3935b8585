"""The scoreboard counts what an independent loop over single runs counts, and shows what fails."""

import csv
import json
from pathlib import Path
from statistics import median

import pytest
from scipy.stats import binom

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.benchmark.score_table import cells, records
from thetascope.assembly.benchmark.scores import DETECTOR, PROBLEMS, scoreboard
from thetascope.cli.bench_command import bench_command
from thetascope.cli.main import parser
from thetascope.cli.words import Words
from thetascope.diagnosis.evaluation.rates import clopper_pearson
from thetascope_schemas import ResolvedExperiment

SMALL = ("friction-motor", "two-heaters")
RULES = (DETECTOR, "joint-ekf", "sandwich-nonsmooth", "parity")


@pytest.fixture(scope="module")
def table() -> dict[tuple[str, str], dict]:
    """Return two problems with one seed, by problem and rule."""
    return {(row["problem"], row["rule"]): row for row in records(scoreboard(SMALL, 1, RULES))}


def alarms(problem: str, rule: str, faulty: bool) -> list[dict]:
    """Return the alarms of one run of the experiment, by the way that every run takes."""
    spec = library.resolve(library.experiment(problem)).model_dump(mode="json") | {"figures": [], "record": None}
    options = next(o["options"] for o in spec["observers"] if o["kind"] == "joint-ekf")
    first = spec["observers"][0]["initial"]
    own = {"label": rule, "kind": rule, "options": options, "initial": first}
    spec |= {"observers": [] if rule == DETECTOR else [own]} | ({} if faulty else {"faults": []})
    diagnosis = prepare(ResolvedExperiment.model_validate(spec)).run().diagnosis
    assert diagnosis is not None
    return (diagnosis["detector"] if rule == DETECTOR else diagnosis["observers"][0])["alarms"]


@pytest.mark.parametrize("rule", RULES[:2])
@pytest.mark.parametrize("problem", SMALL)
def test_counts_are_those_of_single_runs(table, problem: str, rule: str):
    """Faults found, false alarms, delay, size and coverage, by a loop that shares no counting with the program."""
    raised = alarms(problem, rule, True)
    delays, errors, held = [], [], []
    for fault in library.experiment(problem).faults:
        naming = [a for a in raised if a["t"] >= fault.onset and fault.channel in [a["channel"], *a["alternatives"]]]
        delays += [naming[0]["t"] - fault.onset] if naming else []
        present = [a for a in raised if fault.onset <= a["t"] < (fault.end or 1e9) and a["channel"] == fault.channel]
        errors += [abs(present[-1]["size"] - fault.size) / fault.size] if present else []
        held += [present[-1]["size_from"] <= fault.size <= present[-1]["size_to"]] if present else []
    row = table[problem, rule]
    assert (row["found"], row["found_of"]) == (len(delays), len(library.experiment(problem).faults))
    assert row["false"] == bool(alarms(problem, rule, False))
    assert row["delay_s"] == pytest.approx(median(delays)) and row["size_error"] == pytest.approx(median(errors))
    assert (row["size_held"], row["size_held_of"]) == (sum(held), len(held))


def test_failures_are_rows_with_a_reason(table):
    """An observer that cannot be built, and one without tests, have no counts, and a note."""
    for problem in SMALL:
        unfit, untested = table[problem, "sandwich-nonsmooth"], table[problem, "parity"]
        assert unfit["found"] is None and unfit["false_low"] is None and "not a sandwich system" in unfit["note"]
        assert untested["found"] is None and untested["note"].startswith("no tests")


def test_the_command_writes_the_table(tmp_path: Path, capsys):
    """CSV, JSON and Markdown hold the same rows; the problems are those of the docs."""
    say, names = Words("en"), ("table.csv", "table.json", "table.md")
    files = [text for name in names for text in ("--out", str(tmp_path / name))]
    options = ("bench", "friction-motor", "--seeds", "1", "--observer", "detector", "--quiet", *files)
    assert bench_command(parser(say).parse_args(options), say) == 0
    rows = json.loads((tmp_path / "table.json").read_text())
    written = list(csv.DictReader((tmp_path / "table.csv").read_text().splitlines()))
    assert [row["found"] for row in rows] == [1] and written[0]["found"] == "1" and len(written) == 1
    assert "| friction-motor | detector | 1/1 (" in (tmp_path / "table.md").read_text()
    assert "1/1 (" in capsys.readouterr().out
    text = (Path(__file__).parents[2] / "docs" / "scoreboard.md").read_text()
    assert all(f"| {problem} | detector |" in text for problem in PROBLEMS)


def test_workers_change_no_count():
    """Two processes give the cells of one, in the same order, but for the cost."""
    jobs = (("friction-motor",), 1, (DETECTOR, "sandwich-nonsmooth"))
    assert cells(scoreboard(*jobs, workers=2), "en") == cells(scoreboard(*jobs), "en")


@pytest.mark.parametrize(("count", "of"), [(0, 50), (3, 10), (10, 10)])
def test_the_interval_of_a_rate_is_exact(count: int, of: int):
    """At each end the count or a more extreme one has the probability of a tail."""
    low, high = clopper_pearson(count, of)
    assert low == 0 if count == 0 else binom.sf(count - 1, of, low) == pytest.approx(0.025)
    assert high == 1 if count == of else binom.cdf(count, of, high) == pytest.approx(0.025)
    assert clopper_pearson(0, 0) == (0, 1)
