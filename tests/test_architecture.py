"""The rules of ARCHITECTURE.md that a machine can check."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]
CODE = sorted(path for folder in ("backend", "shared", "tools") for path in (ROOT / folder).rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))
PAGE = sorted(path for path in (ROOT / "frontend").rglob("*") if path.suffix in (".js", ".css", ".html"))

# "about" 300 and 40 in ARCHITECTURE.md, with a little room
LINES_OF_A_FILE = 400
LINES_OF_A_FUNCTION = 60
MODULES_OF_A_FOLDER = 12


@cache
def parsed(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text())


@pytest.fixture(scope="module")
def imports() -> grimp.ImportGraph:
    """Return the graph of imports, external packages included."""
    return grimp.build_graph("thetascope", "thetascope_schemas", include_external_packages=True, cache_dir=None)


def imported_from_elsewhere(imports: grimp.ImportGraph, package: str) -> set[str]:
    """Return the external top-level packages that the package's modules import."""
    modules = {m for m in imports.modules if m == package or m.startswith(f"{package}.")}
    found = {i for m in modules for i in imports.find_modules_directly_imported_by(m)}
    return {i.split(".")[0] for i in found} - {"thetascope", "thetascope_schemas"} - set(sys.stdlib_module_names)


def run_tool(name: str, *arguments: str) -> subprocess.CompletedProcess:
    """Run a command of this environment in the project's folder."""
    program = Path(sys.executable).parent / name
    return subprocess.run([program, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)


def test_imports_go_one_way():
    """The contracts in pyproject.toml hold: packages import downwards, observers see only t, u and y."""
    answer = run_tool("lint-imports", "--no-logo", "--no-cache")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "0 broken" in answer.stdout


def test_observers_import_only_the_mathematics(imports: grimp.ImportGraph):
    """No import of an observer's file, however indirect, contains simulations, faults, noise or kernels."""
    observers = {m for m in imports.modules if m.startswith("thetascope.engine.observers")}
    below = {m for o in observers for m in imports.find_upstream_modules(o)} - observers
    mathematics = {
        "errors",
        "language",
        "model",
        "compiler.graph",
        "compiler.autodiff",
        "compiler.composite",
        "compiler.instructions",
        "compiler.instructions.numpy_operations",
        "compiler.lowering",
        "compiler.system",
    }
    ours = {
        m.removeprefix("thetascope.engine.") for m in below if m.split(".")[0] in ("thetascope", "thetascope_schemas")
    }
    packages = {"compiler", "thetascope.engine", "thetascope"}  # their __init__ are docstrings
    words = {m for m in ours if m.startswith("thetascope.messages")}
    assert {
        m for m in ours - packages - words if m not in mathematics and m.split(".")[0] not in ("language", "model")
    } == set()


@pytest.mark.parametrize(
    ("package", "allowed"),
    [
        ("thetascope_schemas", {"pydantic", "pydantic_core"}),
        ("thetascope.engine", {"numpy", "scipy", "sympy", "llvmlite", "clarabel"}),
        ("thetascope.diagnosis", {"numpy", "scipy"}),
        ("thetascope.messages", {"babel"}),
        ("thetascope.client", {"numpy"}),
        ("thetascope.settings", set()),
    ],
)
def test_external_packages_of_each_package(imports: grimp.ImportGraph, package: str, allowed: set[str]):
    """A package imports only the external packages that it is allowed."""
    assert imported_from_elsewhere(imports, package) <= allowed


def test_every_external_package_is_declared(imports: grimp.ImportGraph):
    """Imported packages are in pyproject.toml, so that a new machine gets them, with the extras where they belong."""
    declared = (ROOT / "pyproject.toml").read_text().split("dependencies = [")[1].split("[project.scripts]")[0]
    spelt = {
        "yaml": "pyyaml",
        "prometheus_client": "prometheus-client",
        "pydantic_core": "pydantic",
        "starlette": "fastapi",
    }
    used = imported_from_elsewhere(imports, "thetascope") | imported_from_elsewhere(imports, "thetascope_schemas")
    assert {spelt.get(name, name) for name in used if spelt.get(name, name) not in declared} == set()


def test_every_folder_is_documented_and_small():
    """Each folder of modules has an __init__ with a docstring, and a limited number of modules."""
    for folder in {path.parent for path in CODE if path.parent.parent.name != ROOT.name}:
        assert ast.get_docstring(parsed(folder / "__init__.py")), folder
        assert len(list(folder.glob("*.py"))) - 1 <= MODULES_OF_A_FOLDER, folder


def test_files_are_short():
    """No file is longer than the limit."""
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in [*CODE, *TESTS, *PAGE]}
    assert {path: n for path, n in lengths.items() if n > LINES_OF_A_FILE} == {}


def test_functions_are_short():
    """No function is longer than a screen, its docstring not counted."""
    long = {}
    for path in [*CODE, *TESTS]:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                count = (
                    node.end_lineno - node.lineno + 1 - len((ast.get_docstring(node, clean=False) or "").splitlines())
                )
                if count > LINES_OF_A_FUNCTION:
                    long[f"{path.relative_to(ROOT)}: {node.name}"] = count
    assert long == {}


def test_text_is_never_evaluated():
    """No call in the program can turn a user's text into code."""
    by_name = {"eval", "exec", "compile", "__import__"}
    by_any_name = {"sympify", "parse_expr", "parse_latex", "lambdify", "literal_eval"}
    allowed = {  # there sympify makes SymPy's numbers of Python's; texts do not get that far
        ("backend/thetascope/engine/observers/support/matrices.py", "sympify"),
        ("backend/thetascope/engine/compiler/lowering.py", "sympify"),
    }
    found = set()
    for path in CODE:
        for call in (node for node in ast.walk(parsed(path)) if isinstance(node, ast.Call)):
            plain, dotted = getattr(call.func, "id", ""), getattr(call.func, "attr", "")
            if plain in by_name or plain in by_any_name or dotted in by_any_name:
                found.add((path.relative_to(ROOT).as_posix(), plain or dotted))
    assert found <= allowed


def test_modules_have_docstrings():
    """Every module of the program begins with one."""
    empty = [
        str(path.relative_to(ROOT)) for path in CODE if path.stat().st_size and not ast.get_docstring(parsed(path))
    ]
    assert empty == []
