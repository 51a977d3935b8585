"""Programs and machine code on disk: loaded without SymPy or a compiler, never after the code has changed."""

import os
import stat
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import sympy

from tests.engine.plants import oscillator
from thetascope import library
from thetascope.engine.compiler import cache
from thetascope.engine.compiler import jit as kernels
from thetascope.engine.compiler.jit import Kernel, Layout, Segments
from thetascope.engine.compiler.system import Program, System
from thetascope.engine.programs import program_store
from thetascope.engine.programs.program_store import mathematics, plant_program

IMPORT = """
import importlib, pkgutil, sys, thetascope
made = ("sympy_functions", "to_sympy", "numerical_functions", "real_function")
for module in pkgutil.walk_packages(thetascope.__path__, "thetascope."):
    if module.name not in [f"thetascope.engine.language.{name}" for name in made]:
        importlib.import_module(module.name)
print("sympy" in sys.modules)
"""
RUN = """
import sys
from thetascope import library
from thetascope.assembly import prepare
spec = library.experiment("zhao-2012").model_copy(update={"horizon": 1.0})
result = prepare(library.resolve(spec)).run()
print("sympy" in sys.modules, result.data.tobytes().hex()[-64:])
"""


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """Use an empty cache folder and empty memory."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    monkeypatch.setattr(program_store, "_memory", program_store.OrderedDict())
    return tmp_path


@pytest.fixture
def plant() -> dict:
    return oscillator()


@pytest.fixture
def writings(monkeypatch) -> list[str]:
    """Record every System that is lowered, by name; the cache is meant to avoid lowering."""
    names, lower = [], System.lower

    def counted(self: System) -> Program:
        names.append(self.name)
        return lower(self)

    monkeypatch.setattr(System, "lower", counted)
    return names


def forget() -> None:
    program_store._memory.clear()


def in_new_process(code: str, folder: Path) -> list[str]:
    environment = os.environ | {"THETASCOPE_CACHE": str(folder)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_a_library_experiment_needs_sympy_once(tmp_path):
    """The first process derives the equations with SymPy; the second does not import it and gives the same numbers."""
    first, second = in_new_process(RUN, tmp_path), in_new_process(RUN, tmp_path)
    assert first[0] == "True" and second[0] == "False"
    assert first[1] == second[1]


def test_no_module_imports_sympy_before_it_is_needed(tmp_path):
    """Except modules made of it, which others import when they need them."""
    assert in_new_process(IMPORT, tmp_path) == ["False"]


def test_a_program_is_written_once(folder: Path, writings: list[str], plant: dict):
    """Later it comes from memory, and after a restart from the disk, equal in every bit."""
    written = plant_program(plant)
    assert plant_program(plant) is written
    forget()
    again = plant_program(plant)
    assert writings == ["oscillator"] and again is not written
    assert again.program.digest == written.program.digest and again.program.graph.nodes == written.program.graph.nodes


@pytest.mark.parametrize(
    "damage",
    [
        lambda whole: b"",
        lambda whole: whole[:-1],
        lambda whole: whole[:40],
        lambda whole: whole[:-1] + bytes([whole[-1] ^ 1]),
        lambda whole: b"\0" * len(whole),
    ],
    ids=["empty", "cut short", "head only", "one bit", "zeros"],
)
def test_a_damaged_file_is_written_again(folder: Path, writings: list[str], plant: dict, damage):
    """No error, and no wrong program."""
    written = plant_program(plant)
    (file,) = (folder / "program").iterdir()
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    forget()
    assert plant_program(plant).program.digest == written.program.digest
    assert len(writings) == 2 and file.read_bytes() == whole


def test_entries_of_other_code_are_not_found(folder: Path, writings: list[str], plant: dict, monkeypatch):
    """Entries written by another version of the engine are ignored."""
    plant_program(plant)
    forget()
    monkeypatch.setattr(cache, "package_digest", lambda: "another version")
    plant_program(plant)
    assert len(writings) == 2 and len(list((folder / "program").iterdir())) == 2


def test_the_digest_of_the_code_depends_on_every_file_of_the_engine(tmp_path, monkeypatch):
    """A changed, a renamed and an added module each change it."""

    def digest_of(files: dict[str, str]) -> str:
        for old in tmp_path.glob("*.py"):
            old.unlink()
        for name, text in files.items():
            (tmp_path / name).write_text(text)
        monkeypatch.setattr(cache, "__file__", str(tmp_path / "compiler" / "cache.py"))
        cache.package_digest.cache_clear()
        return cache.package_digest()

    try:
        digests = [
            digest_of(files) for files in ({"a.py": "1"}, {"a.py": "2"}, {"b.py": "1"}, {"a.py": "1", "b.py": ""})
        ]
        assert len(set(digests)) == 4 and digest_of({"a.py": "1"}) == digests[0]
    finally:
        cache.package_digest.cache_clear()


def test_prose_does_not_change_programs(plant: dict):
    """A plant with other titles has the same programs; one with another equation, parameter or start does not."""
    reworded = oscillator(title="Another title", description="x", source="y", id="other")
    reworded["states"] = [s | {"unit": "m", "description": "position"} for s in reworded["states"]]
    reworded["inputs"] = [u | {"bounds": [-1, 1], "default": 0.5} for u in reworded["inputs"]]
    assert mathematics(reworded) == mathematics(plant)
    for change in (
        {"dynamics": plant["dynamics"] | {"x1": "2*x2"}},
        {"parameters": [{"name": "k", "value": 5.0}]},
        {"channels": []},
    ):
        assert mathematics(oscillator(**change)) != mathematics(plant)


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs POSIX permissions")
def test_an_unwritable_folder_is_not_an_error(folder: Path, writings: list[str], plant: dict, monkeypatch):
    """With a file in its place, or a read-only folder, programs are made each time, and no file is left."""
    (folder / "program").write_text("in the way")
    assert plant_program(plant).program.states == ("x.x1", "x.x2")
    (folder / "program").unlink()
    (folder / "program").mkdir()
    (folder / "program").chmod(stat.S_IRUSR | stat.S_IXUSR)
    if os.geteuid() == 0:  # nothing is read-only to root
        monkeypatch.setattr(
            cache.tempfile, "mkstemp", lambda dir: (_ for _ in ()).throw(PermissionError(13, "read-only"))
        )
    forget()
    assert plant_program(plant).program.states == ("x.x1", "x.x2")
    assert len(writings) == 2 and not list((folder / "program").iterdir())


def test_a_full_disk_leaves_no_partial_file(folder: Path, monkeypatch):
    """A failed write leaves neither the file nor its temporary."""

    def full(source: str, target: Path) -> None:
        raise OSError(28, "no space left on device")

    monkeypatch.setattr(cache.os, "replace", full)
    cache.write("kernel", "key", b"body")
    assert cache.read("kernel", "key") is None and not list((folder / "kernel").iterdir())


def decay(rate: float) -> Program:
    x = sympy.Symbol("x", real=True)
    return System("decay", "continuous", (x,), (), (), (-sympy.Float(rate) * x,)).lower()


def one_second(program: Program) -> float:
    """Return the state after a second, from 1, by a new kernel (nothing remembered in memory)."""
    steps = Segments(np.array([100]), np.array([100]), np.zeros(1), np.zeros(1), np.array([0.01]))
    state, out = np.ones(1), np.empty((1, 1))
    Kernel(program, Layout())(steps, state, np.zeros(1), 100, out)
    return float(out[0, 0])


def test_machine_code_is_compiled_once(folder: Path, monkeypatch):
    """The second kernel of a program comes from the disk, without the compiler."""
    first = one_second(decay(1.5))
    assert len(list((folder / "kernel").iterdir())) == 1
    monkeypatch.setattr(kernels, "_object_code", lambda *_: pytest.fail("compiled again"))
    assert one_second(decay(1.5)) == first == pytest.approx(np.exp(-1.5), rel=1e-8)


def test_damaged_machine_code_is_compiled_again(folder: Path):
    """It is never loaded, because its checksum is checked first."""
    first = one_second(decay(2.5))
    (file,) = (folder / "kernel").iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[:200] + b"\xcc" * (len(whole) - 200))
    assert one_second(decay(2.5)) == first and file.read_bytes() == whole


def test_other_numbers_other_processors_and_other_layouts_have_other_code(folder: Path, monkeypatch):
    """The key depends on every bit of the program, the layout and the platform."""
    one_second(decay(1.5))
    assert one_second(decay(np.nextafter(1.5, 2))) != 0 and len(list((folder / "kernel").iterdir())) == 2
    monkeypatch.setattr(kernels, "platform_key", lambda: "another processor")
    one_second(decay(1.5))
    assert len(list((folder / "kernel").iterdir())) == 3
    Kernel(decay(1.5), Layout(lanes=4))
    assert len(list((folder / "kernel").iterdir())) == 4


def write_and_read(place: str, i: int) -> bool:
    cache.folder.cache_clear()
    os.environ["THETASCOPE_CACHE"] = place
    for _ in range(50):
        cache.write("kernel", "same", bytes([i]) * 100_000)
        found = cache.read("kernel", "same")
        if found is None or found != found[:1] * 100_000:
            return False
    return True


def test_concurrent_writers_leave_whole_files(tmp_path):
    """Four processes write and read one key repeatedly: each file is from one of them."""
    with ProcessPoolExecutor(4) as pool:
        assert all(pool.map(write_and_read, [str(tmp_path)] * 4, range(4)))
    assert [f.name for f in (tmp_path / "kernel").iterdir()] == ["same"]


def test_every_library_plant_survives_the_cache(folder: Path):
    """After writing and reading each plant's program is the same."""
    for plant in library.plants().values():
        data = plant.model_dump(mode="json")
        written = plant_program(data)
        forget()
        assert plant_program(data).program.digest == written.program.digest
