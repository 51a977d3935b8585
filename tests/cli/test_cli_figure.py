"""`thetascope figure`: a figure for a paper, and the command that draws it again."""

import json
import shlex


def test_the_command_of_a_figure_draws_the_same_file(call, tmp_path):
    """An experiment with a change, then its printed command, then the id of the stored run: the same bytes."""
    change = ("--set", "horizon=2")
    outputs = ("--out", "a.json", "--out", "a.svg")
    code, shown, _ = call("figure", "shen-hu-2015", "faults", *change, "--width", "17.5", "--start", "1", *outputs)
    caption, command = shown.splitlines()
    first = (tmp_path / "a.svg").read_bytes()
    (tmp_path / "a.svg").unlink()
    assert code == 0 and call(*shlex.split(command)[1:], "--quiet")[0] == 0
    assert (tmp_path / "a.svg").read_bytes() == first
    described = json.loads((tmp_path / "a.json").read_text())
    assert described["caption"] == caption and described["width"] == 17.5
    run = caption.rpartition(" ")[2][:12]
    code, shown, _ = call("figure", run, "faults", "--width", "17.5", "--start", "1", "--out", "b.pdf")
    assert code == 0 and shown.startswith(caption) and (tmp_path / "b.pdf").read_bytes().startswith(b"%PDF")


def test_runs_are_overlaid_by_the_command_of_their_comparison(call, tmp_path):
    """Two stored runs by their ids: the printed command draws the same file; differences leave the first run out."""
    runs, short = [], ("--set", "horizon=1", "--out", "a.svg")
    for seed in ("1", "2"):
        _, shown, _ = call("figure", "shen-hu-2015", "faults", *short, "--set", f"seed={seed}")
        runs.append(shown.splitlines()[0].rpartition(" ")[2][:12])
    code, shown, _ = call("figure", ",".join(runs), "overlaid", "--panel", "1", "--out", "both.svg")
    caption, command = shown.splitlines()
    drawn = (tmp_path / "both.svg").read_bytes()
    assert code == 0 and all(run in caption for run in runs)
    assert call(*shlex.split(command)[1:], "--quiet")[0] == 0 and (tmp_path / "both.svg").read_bytes() == drawn
    assert call("figure", ",".join(runs), "less-the-first", "--out", "less.json", "--quiet")[0] == 0
    assert len(json.loads((tmp_path / "less.json").read_text())["curves"]) == 1
    code, _, told = call("figure", runs[0], "overlaid", "--out", "both.svg")
    assert code == 1 and "ids" in told


def test_a_wrong_option_is_refused_with_its_name(call):
    """Nothing is computed for it."""
    code, _, told = call("figure", "shen-hu-2015", "faults", "--width", "80", "--out", "a.pdf")
    assert code == 1 and "width: " in told and "at most 21" in told
