"""One version: of the package and of what is built and installed (tests/api and tests/cli ask the service and the
command)."""

import tomllib
from importlib import metadata
from pathlib import Path

from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

import thetascope

ROOT = Path(__file__).parents[1]


def test_pyproject_takes_the_version_from_the_package():
    """The version is written once, in thetascope/__init__.py; builds and what is installed have it from there."""
    assert "version" in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dynamic"]
    assert ProjectMetadata(str(ROOT), PluginManager()).version == thetascope.__version__
    assert metadata.version("thetascope") == thetascope.__version__
