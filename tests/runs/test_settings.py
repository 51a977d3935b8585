"""Settings from the environment."""

from pathlib import Path

import pytest

from thetascope.settings import SettingsError, load


def test_every_field_is_read_from_its_variable_and_overridden_by_arguments():
    """Sizes accept suffixes; an empty variable counts as unset."""
    found = load(
        {
            "THETASCOPE_DATA": "/srv/data",
            "THETASCOPE_PORT": "9000",
            "THETASCOPE_MAX_BODY": "64k",
            "THETASCOPE_STORE_LIMIT": "3G",
            "THETASCOPE_WAIT": "0.5",
            "THETASCOPE_HOST": "",
        },
        port=9001,
    )
    assert found.store == "/srv/data/runs.sqlite"
    assert (found.port, found.max_body, found.store_limit, found.wait) == (9001, 65536, 3 * 1024**3, 0.5)
    assert found.host == "127.0.0.1"


@pytest.mark.parametrize(
    ("name", "value"),
    [("PORT", "many"), ("PORT", "-1"), ("MAX_BODY", "2T"), ("MAX_BODY", "1.5M"), ("WAIT", "nan"), ("WAIT", "-1")],
)
def test_an_invalid_value_is_refused_with_the_variable_and_an_example(name, value):
    """Instead of a traceback at the start."""
    with pytest.raises(SettingsError, match=rf"THETASCOPE_{name} is '{value}'.*such as"):
        load({f"THETASCOPE_{name}": value})


def test_without_variables_the_store_is_in_the_users_data_folder(monkeypatch):
    """On Linux by the XDG convention."""
    monkeypatch.setattr("sys.platform", "linux")
    assert load({"XDG_DATA_HOME": "/home/me/data"}).data == Path("/home/me/data/thetascope")
    monkeypatch.setenv("HOME", "/home/me")
    assert load({}).data == Path("/home/me/.local/share/thetascope")
