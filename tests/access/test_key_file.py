"""The file of the access key."""

import json
import os
import stat

import pytest

from thetascope.access.gate import opens
from thetascope.access.key_file import SHORTEST, KeyFile, KeyFileError
from thetascope.settings import SettingsError


def test_the_key_is_created_once_and_not_stored(tmp_path):
    """The first call returns it, later ones do not; the file has only a digest."""
    file = KeyFile(tmp_path / "data" / "access.json")
    assert file.current() is None
    keys, key = file.ensured()
    assert key is not None and opens(keys, key) and len(key) == 32
    assert key not in file.path.read_text() and file.ensured()[1] is None
    assert not any(opens(keys, wrong) for wrong in ("", key[:-1], key + "x", key.swapcase(), keys.digest.hex()))


@pytest.mark.skipif(os.name != "posix", reason="modes of files are POSIX's")
def test_only_its_owner_can_read_the_file(tmp_path, caplog):
    """It is made so whatever the umask is, and made so again, with a warning, if somebody opened it."""
    file = KeyFile(tmp_path / "access.json")
    before = os.umask(0)
    try:
        keys, _ = file.ensured()
    finally:
        os.umask(before)
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600
    os.chmod(file.path, 0o644)
    assert KeyFile(file.path).current() == keys
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600 and "read by others" in caplog.text


def test_a_new_key_replaces_the_old_one_in_running_services(tmp_path):
    """Another process changes the file; the service notices, and the installation's secret stays."""
    service, command = KeyFile(tmp_path / "access.json"), KeyFile(tmp_path / "access.json")
    old, first = service.ensured()
    second = command.renew()
    keys = service.current()
    assert keys.secret == old.secret and opens(keys, second) and not opens(keys, first)
    assert [path.name for path in tmp_path.iterdir()] == ["access.json"]


def test_a_chosen_key_is_never_written(tmp_path):
    """It opens instead of the stored one, and cannot be renewed by the command."""
    stored = KeyFile(tmp_path / "access.json").ensured()[1]
    file = KeyFile(tmp_path / "access.json", "a-key-of-my-own-choice")
    keys, created = file.ensured()
    assert created is None and opens(keys, "a-key-of-my-own-choice") and not opens(keys, stored)
    with pytest.raises(SettingsError, match="THETASCOPE_KEY"):
        file.renew()
    alone = KeyFile(tmp_path / "other.json", "a-key-of-my-own-choice")
    assert opens(alone.ensured()[0], "a-key-of-my-own-choice") and "key" not in json.loads(alone.path.read_text())
    assert KeyFile(alone.path).current().digest is None


@pytest.mark.parametrize(
    "key", ["short", "x" * (SHORTEST - 1), "with a space in it", "schlüssel-mit-umlaut", "a\nb" * 9]
)
def test_an_unsuitable_key_is_refused(tmp_path, key):
    """Short keys can be guessed, and others do not pass through a header."""
    with pytest.raises(SettingsError, match=f"{SHORTEST} characters"):
        KeyFile(tmp_path / "access.json", key)


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", "{}", '{"secret": "00", "created": 0}', '{"secret": 5, "created": 0}', "\x00" * 40]
    + [json.dumps({"secret": "00" * 32, "created": 0, "key": key}) for key in ("", "zz", "00", 7, None)],
)
def test_a_damaged_file_is_refused_with_the_remedy(tmp_path, content):
    """It never counts as a file without a key."""
    file = KeyFile(tmp_path / "access.json")
    file.path.write_text(content)
    file.path.chmod(0o600)
    for use in (file.current, file.ensured, file.renew):
        with pytest.raises(KeyFileError, match=r"access.json is damaged; remove it"):
            use()


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    """A file lies where the data folder should be."""
    (tmp_path / "data").write_text("")
    with pytest.raises(KeyFileError, match="access.json cannot be used"):
        KeyFile(tmp_path / "data" / "access.json").ensured()
