"""`thetascope key`, and the lines of `thetascope serve` about access."""

import pytest

from thetascope.access.gate import FILE, opens
from thetascope.access.key_file import KeyFile
from thetascope.cli.access_commands import announce
from thetascope.cli.words import Words
from thetascope.server.started import Started
from thetascope.settings import Settings


def test_the_key_is_shown_once_and_renewed_on_request(call, tmp_path):
    """The first call creates it, the second says since when there is one, `--new` makes another."""
    file = KeyFile(tmp_path / "data" / FILE)
    code, out, _ = call("key")
    key = out.split()[-1]
    assert code == 0 and opens(file.current(), key)
    code, out, _ = call("key")
    assert code == 0 and key not in out and "--new" in out and opens(file.current(), key)
    code, out, _ = call("key", "--new")
    new = out.split()[-1]
    assert code == 0 and opens(file.current(), new) and not opens(file.current(), key)


def test_a_chosen_key_is_changed_where_it_is_set(call, monkeypatch):
    """The command changes nothing, and refuses an unsuitable key with the reason."""
    monkeypatch.setenv("THETASCOPE_KEY", "a-key-of-my-own-choice")
    assert call("key")[0] == 0 and "THETASCOPE_KEY" in call("key")[1]
    code, out, error = call("key", "--new")
    assert (code, out) == (1, "")
    assert "THETASCOPE_KEY sets the access key" in error
    monkeypatch.setenv("THETASCOPE_KEY", "short")
    for command in (("key",), ("serve", "--host", "0.0.0.0", "--port", "0")):
        code, _, error = call(*command)
        assert code == 1 and "at least 16 characters" in error


@pytest.mark.parametrize(
    ("started", "shown", "hidden"),
    [
        (Started("http://127.0.0.1:8000/"), [], ["key", "Warning"]),
        (Started("http://127.0.0.1:8000/", "K", asks=True), ["once: K", ":8000/?key=K"], ["Warning"]),
        (Started("http://127.0.0.1:8000/", None, asks=True), ["asks for the access key", "--new"], ["?key="]),
        (Started("http://127.0.0.1:8000/", unguarded=True), ["Warning", "THETASCOPE_OPEN"], ["?key="]),
    ],
)
def test_serve_says_how_others_get_in(started, shown, hidden, capsys, tmp_path):
    """The key with a link at the first start, that it is needed at later ones, or a warning that it is not."""
    announce(started, Settings(data=tmp_path, host="0.0.0.0"), Words())
    printed = capsys.readouterr()
    text = printed.out + printed.err
    assert text.startswith("Thetascope is at http://127.0.0.1:8000/ ")
    assert all(words in text for words in shown) and not any(words in text for words in hidden)
