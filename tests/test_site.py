"""The documentation as a site: it is built without a warning, and its pages fetch nothing from elsewhere."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the built site."""
    folder = tmp_path_factory.mktemp("site")
    done = build(ROOT, folder)
    assert done.returncode == 0, done.stderr
    return folder


def build(root: Path, folder: Path) -> subprocess.CompletedProcess:
    """Build the site of a checkout."""
    command = [sys.executable, "-m", "tools.site", str(folder)]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=300, check=False)


def test_every_page_of_the_documentation_is_in_the_site(site: Path):
    """Each Markdown file of docs/ has its page, and each page is reached from the navigation."""
    pages = {path.relative_to(ROOT / "docs").with_suffix(".html") for path in (ROOT / "docs").rglob("*.md")}
    assert pages and {str(page) for page in pages if not (site / page).exists()} == set()
    start = (site / "index.html").read_text(encoding="utf-8")
    linked = {href.partition("#")[0] for href in re.findall(r'href="([^"]+)"', start)}
    assert {str(page) for page in pages} - linked == {"index.html"} - linked


def test_the_pages_fetch_nothing_from_elsewhere(site: Path):
    """No script, style sheet, font or image has an address of another host."""
    fetched = re.compile(
        r"""<(?:script|img|iframe)[^>]*\ssrc="?(\w+:)?//|<link[^>]*rel="?(?:stylesheet|preconnect)[^>]*//"""
    )
    pages = list(site.rglob("*.html"))
    assert len(pages) > 20
    assert [page.name for page in pages if fetched.search(page.read_text(encoding="utf-8"))] == []


def test_the_reference_holds_the_schemas_and_commands_of_the_program(site: Path):
    """Fields with their limits and descriptions, and the help of each command."""
    schemas = (site / "reference" / "schemas.html").read_text(encoding="utf-8")
    assert all(f'id="{name}"' in schemas for name in ("plant", "channel", "experiment", "rampfault", "noise"))
    assert "false_alarms" in schemas
    commands = (site / "reference" / "commands.html").read_text(encoding="utf-8")
    assert all(f"thetascope {name}" in commands for name in ("serve", "run", "diagnose", "fit", "backup"))


def test_a_broken_link_stops_the_build(tmp_path: Path):
    """A page that leads nowhere is found when the site is built, not by a reader."""
    for name in ("docs", "tools", "ARCHITECTURE.md", "CHANGELOG.md", "SECURITY.md"):
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tmp_path / name)
    page = tmp_path / "docs" / "learn.md"
    page.write_text(page.read_text(encoding="utf-8") + "\n[nowhere](#nowhere-at-all)\n", encoding="utf-8")
    done = build(tmp_path, tmp_path / "out")
    assert done.returncode != 0 and "nowhere-at-all" in done.stderr
