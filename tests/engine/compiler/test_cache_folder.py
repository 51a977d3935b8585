"""Who may write in the cache: machine code is loaded from it, so only this user of this installation."""

import hashlib
import os
import pwd
import shutil
import stat
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import llvmlite.binding as llvm
import numpy as np
import pytest
import sympy

from thetascope.cli.main import main
from thetascope.engine.compiler import cache, cache_folder, jit
from thetascope.engine.compiler.system import Program, System
from thetascope.engine.errors import FolderRefused

RULES = pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")
ROOT = pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root can give files away")
MODES = (0o700, 0o755, 0o750, 0o711)
OPEN = (0o777, 0o757, 0o702, 0o1777)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the cache folder of this test; it does not exist yet."""
    place = tmp_path / "parent" / "cache"
    monkeypatch.setattr(cache, "folder", lambda: place)
    return place


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def decay() -> Program:
    x = sympy.Symbol("x", real=True)
    return System("decay", "continuous", (x,), (), (), (-x,)).lower()


@RULES
def test_a_new_folder_and_its_key_are_for_this_user_alone(folder):
    """Mode 0700, the key 0600, whatever the umask."""
    before = os.umask(0)
    try:
        cache.write("kernel", "a", b"body")
    finally:
        os.umask(before)
    assert (mode(folder), mode(folder / "kernel"), mode(folder / "key")) == (0o700, 0o700, 0o600)
    assert cache.read("kernel", "a") == b"body"


@RULES
@pytest.mark.parametrize("given", MODES)
def test_a_folder_that_others_could_read_is_closed(tmp_path, given):
    """An earlier version created it with the umask."""
    tmp_path.chmod(given)
    cache_folder.protect(tmp_path)
    assert mode(tmp_path) == 0o700


@RULES
@pytest.mark.parametrize("given", OPEN)
def test_a_folder_in_which_others_can_write_is_refused(tmp_path, given):
    """Not repaired: somebody may have left files in it."""
    place = tmp_path / "cache"
    place.mkdir()
    place.chmod(given)
    with pytest.raises(FolderRefused, match=r"others can write in .*cache.*chmod go-w"):
        cache_folder.protect(place)


@RULES
@pytest.mark.parametrize(("given", "refused"), [(0o777, True), (0o1777, False), (0o755, False)])
def test_a_folder_that_others_could_replace_is_refused(tmp_path, given, refused):
    """A parent folder in which others can write, unless it is sticky as /tmp is."""
    tmp_path.chmod(given)
    place = tmp_path / "above" / "cache"
    if refused:
        with pytest.raises(FolderRefused, match="others can write"):
            cache_folder.protect(place)
        assert not place.exists()
    else:
        cache_folder.protect(place)
        assert mode(place) == 0o700


@ROOT
@pytest.mark.parametrize("part", ["folder", "parent", "link"])
def test_a_folder_of_somebody_else_is_refused(tmp_path, part):
    """So are one in a folder of somebody else, and one that a link of somebody else names."""
    parent, other = tmp_path / "parent", pwd.getpwnam("nobody").pw_uid
    place = parent / "cache"
    place.mkdir(parents=True)
    if part == "link":
        link = tmp_path / "link"
        link.symlink_to(place)
        os.lchown(link, other, -1)
        place = link
    else:
        os.chown({"folder": place, "parent": parent}[part], other, -1)
    with pytest.raises(FolderRefused, match="belongs to another user"):
        cache_folder.protect(place)


@RULES
@pytest.mark.parametrize("command", [["serve", "--port", "0"], ["run", "zhao-2012", "--set", "horizon=1.013"]])
def test_the_command_line_refuses_an_open_folder_with_the_remedy(tmp_path, monkeypatch, capsys, command):
    """In one line, before anything is computed or served."""
    tmp_path.chmod(0o777)
    monkeypatch.setattr(cache, "folder", lambda: cache_folder.protect(tmp_path))
    monkeypatch.setenv("THETASCOPE_DATA", str(tmp_path / "data"))
    assert main(command) == 1
    error = capsys.readouterr().err
    assert "chmod go-w" in error and error.count("\n") == 1


def _planted(folder: Path, kind: str) -> None:
    """Replace every kernel by code of somebody else, in the form that an attacker can give it."""
    llvm.initialize_native_target()
    for file in (folder / "kernel").iterdir():
        whole = file.read_bytes()
        evil = whole[32:-1] + bytes([whole[-1] ^ 1])
        if kind == "hash":
            file.write_bytes(hashlib.sha256(evil).digest() + evil)
        elif kind == "old seal":
            file.write_bytes(whole[:32] + evil)
        elif kind == "no seal":
            file.write_bytes(evil)


@pytest.mark.parametrize("kind", ["hash", "old seal", "no seal"])
def test_planted_code_is_never_loaded(folder, kind, monkeypatch):
    """It is compiled again, and the file is replaced."""
    jit.Kernel(decay(), jit.Layout())
    (file,) = (folder / "kernel").iterdir()
    right = file.read_bytes()
    _planted(folder, kind)
    loaded = []
    load = llvm.ObjectFileRef.from_data
    monkeypatch.setattr(jit.llvm.ObjectFileRef, "from_data", lambda code: loaded.append(code) or load(code))
    jit.Kernel(decay(), jit.Layout())
    assert loaded == [right[32:]] and file.read_bytes() == right


def test_code_of_another_installation_or_key_is_not_loaded(folder, tmp_path):
    """A file fits one installation, one kind and one key only."""
    cache.write("kernel", "a", b"body")
    assert cache.read("kernel", "a") == b"body"
    for kind, name in (("kernel", "b"), ("program", "a")):
        (folder / kind).mkdir(exist_ok=True)
        shutil.copy(folder / "kernel" / "a", folder / kind / name)
        assert cache.read(kind, name) is None
    (folder / "key").write_bytes(bytes(32))
    assert cache.read("kernel", "a") is None


@RULES
@pytest.mark.parametrize("damage", ["readable", "short", "empty", "folder"])
def test_a_key_that_cannot_be_trusted_is_replaced(folder, damage):
    """Files with the old one are absent from then on."""
    cache.write("kernel", "a", b"body")
    key = folder / "key"
    if damage == "readable":
        key.chmod(0o644)
    elif damage == "folder":
        key.unlink()
        key.symlink_to(folder / "kernel" / "a")
    else:
        key.write_bytes(b"" if damage == "empty" else b"short")
    assert cache.read("kernel", "a") is None
    cache.write("kernel", "a", b"again")
    assert cache.read("kernel", "a") == b"again" and mode(key) == 0o600


def first_key(place: str) -> bytes:
    return cache_folder.key(Path(place))


def test_processes_that_start_together_agree_on_one_key(tmp_path):
    """Each of twelve rounds begins without a key."""
    with ProcessPoolExecutor(4) as pool:
        for i in range(12):
            place = tmp_path / str(i)
            place.mkdir()
            keys = set(pool.map(first_key, [str(place)] * 4))
            assert keys == {(place / "key").read_bytes()}


def test_processes_agree_on_one_key_after_the_folder_was_deleted(folder):
    """The cache may be deleted at any time; workers and the service exchange kernels through it afterwards, too."""
    cache.write("kernel", "a", b"body")
    shutil.rmtree(folder)
    assert cache.read("kernel", "a") is None
    cache.write("kernel", "a", b"again")
    with ProcessPoolExecutor(1) as pool:
        assert pool.submit(first_key, str(folder)).result() == cache_folder.key(folder)
    assert cache.read("kernel", "a") == b"again"


def test_a_cache_that_cannot_be_written_is_no_error(folder, monkeypatch):
    """Everything is computed, and nothing is stored."""

    def full(*arguments: object, **options: object) -> None:
        raise OSError(28, "no space left on device")

    monkeypatch.setattr(cache_folder.tempfile, "mkstemp", full)
    cache.write("kernel", "a", b"body")
    assert cache.read("kernel", "a") is None
    state = np.array([1.0])
    assert jit.Kernel(decay(), jit.Layout()) is not None and state[0] == 1.0
