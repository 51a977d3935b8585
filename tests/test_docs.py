"""The documentation agrees with the program."""

import json
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import get_args
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest
import yaml

from tests.simulate import simulate
from thetascope import library
from thetascope.assembly import check_plant
from thetascope.engine.compiler import cache
from thetascope.engine.language.builtins import FUNCTIONS
from thetascope.settings import PREFIX, Settings
from thetascope_schemas import Experiment, Plant, ResolvedExperiment
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.measures import Measure
from tools.document_observers import FILE, counted, page
from tools.list_licences import bundled, pinned

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "CHANGELOG.md")] + sorted(
    (ROOT / "docs").glob("*.md")
)
LINK = re.compile(r"\]\((?!https?:)([^)#]*)(?:#([^)]*))?\)")


def blocks(path: Path, language: str) -> list[str]:
    """Return the fenced blocks of a language."""
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(), flags=re.DOTALL)


def anchors(path: Path) -> set[str]:
    """Return the anchors of a page, in the form of code hosts."""
    text = path.read_text()
    heads = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    spelt = {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}
    return spelt | set(re.findall(r'<a id="([^"]+)"', text))


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_are_valid(path: Path):
    """Every link to a file of the project, and to a heading in it, has a target."""
    for file, anchor in LINK.findall(path.read_text()):
        target = (path.parent / file).resolve() if file else path
        assert target.exists(), f"{path.name}: {file}"
        assert not anchor or anchor in anchors(target), f"{path.name}: {file}#{anchor}"


def test_the_page_on_observers_is_current():
    """docs/observers.md is up to date; `make docs` writes it."""
    current = FILE.read_text(encoding="utf-8") == page()  # apart, so that a failure does not print the page
    assert current, "run make docs"


def test_the_example_of_a_truth_runs():
    """The experiment in docs/truth.md is accepted, and its simulated plant has the additional state."""
    data = yaml.safe_load(blocks(ROOT / "docs" / "truth.md", "yaml")[0])
    spec = library.resolve(Experiment.model_validate(data | {"horizon": 60, "observers": []}))
    assert np.isfinite(simulate(spec).column("x.pump")).all()


def test_the_example_of_a_plant_is_valid():
    """The YAML in docs/plant-format.md is accepted, and the observers that the page offers can be built for it."""
    plant = Plant.model_validate(yaml.safe_load(blocks(ROOT / "docs" / "plant-format.md", "yaml")[0]))
    report = check_plant(plant)
    assert plant.id == "leaky-tank"
    assert "adaptive-kalman" in str(report)


def test_the_loop_of_the_example_runs():
    """The controller in docs/plant-format.md closes the loop of the example: a biased sensor moves the true level."""
    text = blocks(ROOT / "docs" / "plant-format.md", "yaml")
    controllers = next(block for block in text if block.startswith("references:"))
    plant = Plant.model_validate(yaml.safe_load(text[0]) | yaml.safe_load(controllers))
    bias = [{"channel": "offset", "shape": "step", "onset": 200, "size": 1.0}]
    data = {"plant": plant, "horizon": 500, "step": 0.1, "faults": bias, "diagnosis": {"enabled": False}}
    run = simulate(ResolvedExperiment.model_validate(data))
    assert run.column("y.y")[-1] == pytest.approx(20, abs=0.01)
    assert run.column("x.h")[-1] == pytest.approx(19, abs=0.01)


def test_the_example_of_a_lesson_is_valid():
    """The lesson in docs/learn.md is accepted, and the page names every kind of measure."""
    text = (ROOT / "docs" / "learn.md").read_text()
    lesson = CourseLesson.model_validate(yaml.safe_load(blocks(ROOT / "docs" / "learn.md", "yaml")[0]))
    assert lesson.steps[0].measures.keys() == {"gap"}
    kinds = {measure.model_fields["kind"].default for measure in get_args(get_args(Measure)[0])}
    assert {kind for kind in kinds if f"| `{kind}` |" not in text} == set() and len(kinds) > 5


def test_every_function_of_the_language_is_described():
    """docs/plant-format.md names all functions, each in code."""
    text = re.sub(r"```.*?```", "", (ROOT / "docs" / "plant-format.md").read_text(), flags=re.DOTALL)
    coded = " ".join(re.findall(r"`([^`]+)`", text))
    assert {name for name in FUNCTIONS if not re.search(rf"\b{name}\b", coded)} == set()


def test_every_setting_is_described():
    """docs/api.md names each environment variable of the service."""
    text = (ROOT / "docs" / "api.md").read_text()
    assert {name for name in Settings.__dataclass_fields__ if f"`{PREFIX}{name.upper()}`" not in text} == set()


def test_the_counts_of_the_readme_are_correct():
    """Numbers of observers and plants, and the experiments by name."""
    text = (ROOT / "README.md").read_text()
    assert counted(text) == text, "run make docs"
    assert counted("one observers") in text.lower() and counted("one plants") in text.lower()
    for line in text.splitlines():
        if line.startswith("| `"):
            first, *more = re.findall(r"`([^`]+)`", line.split("|")[1])
            assert {first, *(first + suffix for suffix in more)} <= set(library.experiments())


def own(folder: Path) -> dict[str, str]:
    """Return an environment without files of the user; kernels are those that the tests compile."""
    given = {"THETASCOPE_DATA": str(folder / "data"), "THETASCOPE_CACHE": str(cache.folder())}
    return given | {"PATH": "/usr/bin:/bin", "HOME": str(folder), "LANG": "C.UTF-8"}


PROGRAM = Path(sys.executable).parent / "thetascope"


def test_the_commands_of_the_readme_work(tmp_path: Path):
    """Each `thetascope` line of the tour runs and writes the files it names; the table is that of the first."""
    printed = []
    (tmp_path / "backend").symlink_to(ROOT / "backend")
    for line in blocks(ROOT / "README.md", "sh")[0].splitlines():
        command = [str(PROGRAM), *shlex.split(line)[1:]]
        answer = subprocess.run(command, cwd=tmp_path, env=own(tmp_path), capture_output=True, text=True, check=False)
        assert answer.returncode == 0, f"{line}\n{answer.stdout}{answer.stderr}"
        printed.append(answer.stdout)
    assert (tmp_path / "zhao.csv").stat().st_size > 1e5
    assert "<html" in (tmp_path / "zhao.html").read_text()[:200]
    for block in blocks(ROOT / "README.md", "text"):
        assert block in printed[1]


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """Start a separate server on a free port."""
    command = [PROGRAM, "serve", "--port", "0"]
    with subprocess.Popen(command, cwd=ROOT, env=own(tmp_path), stdout=subprocess.PIPE, text=True) as server:
        try:
            yield re.search(r"http://[^/]+", server.stdout.readline())[0]
        finally:
            server.terminate()


def answered(request: Request) -> str:
    """Return the answer to a request; a run that a busy machine has not finished yet is asked for again."""
    for _ in range(300):
        try:
            with urlopen(request) as answer:
                return answer.read().decode()
        except HTTPError as error:
            if error.code != 409:
                raise
            time.sleep(0.2)
    raise AssertionError(f"{request.full_url} was not ready within a minute")


def test_the_requests_of_the_readme_work(address: str):
    """Each `curl` line of the tour gets its answer."""
    run, got = "RUN", []
    for line in blocks(ROOT / "README.md", "sh")[1].replace("http://127.0.0.1:8000", address).splitlines():
        words = shlex.split(line)
        given = dict(pairwise(words))
        url = next(word for word in words if word.startswith("http")).replace("RUN", run)
        body = given["-d"].encode() if "-d" in given else None
        headers = dict([given["-H"].split(": ")]) if "-H" in given else {}
        got.append(answered(Request(url, body, headers)))
        run = json.loads(got[0])["id"]
    assert json.loads(got[0])["spec"]["seed"] == 3
    assert got[1].startswith("t,theta.theta1,theta.theta2,theta.theta3,adaptive.theta.theta1,")
    assert "<html" in got[2][:200]


def test_the_python_of_the_readme_works(address: str):
    """The run in this process and the client print the estimates in the comments."""
    code = blocks(ROOT / "README.md", "python")[0]
    promised = [float(value) for value in re.findall(r"print.*# ([\d.]+)", code)]
    assert len(promised) == 2
    code = code.replace("http://127.0.0.1:8000", address)
    answer = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert [float(line) for line in answer.stdout.split()] == pytest.approx(promised, abs=1e-6)


def test_every_dependency_is_listed_with_its_licence():
    """docs/dependencies.md has the pinned packages, each with a licence; `python -m tools.list_licences` writes it."""
    rows = re.findall(r"^\| (\S+) \| (\S+) \| (.+) \|$", (ROOT / "docs" / "dependencies.md").read_text(), re.MULTILINE)
    listed = {name: version for name, version, _ in rows if name not in ("package",)}
    packaged = {name: version for name, (version, _) in bundled().items()}
    assert listed == pinned() | packaged and "not stated" not in {licence for *_, licence in rows}
