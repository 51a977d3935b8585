"""Progress bars: in a terminal, in a notebook and in a function of the caller; none where nobody looks."""

import io
import sys
from types import ModuleType, SimpleNamespace

import pytest

import thetascope
from tests.runs.samples import spec_data
from thetascope import progress
from thetascope.client import Client
from thetascope.progress import progress_bar


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch):
    """A clock that moves by 0.3 s whenever it is read."""
    moments = iter(0.3 * k for k in range(10_000))
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(moments)))


@pytest.fixture
def notebook(monkeypatch):
    """The kernel of a notebook that keeps every state of its output."""
    shown: list[str] = []
    handle = SimpleNamespace(update=lambda html: shown.append(html))

    def display(html: str, display_id: bool):
        assert display_id
        shown.append(html)
        return handle

    module, area = ModuleType("IPython"), ModuleType("IPython.display")
    module.get_ipython = lambda: SimpleNamespace(kernel=object())
    area.HTML, area.display = str, display
    monkeypatch.setitem(sys.modules, "IPython", module)
    monkeypatch.setitem(sys.modules, "IPython.display", area)
    return shown


def drawn(stream: io.StringIO, shown=None) -> str:
    with progress_bar(shown, stream) as show:
        for share in (0.0, 0.25, 0.5, 1.0):
            show(share)
    return stream.getvalue()


def test_a_terminal_shows_the_share_and_the_time_left_and_is_clean_at_the_end(clock):
    """The bar appears once a run takes longer than 0.4 s, and leaves nothing behind."""
    text = drawn(Terminal())
    assert "\r████████░" in text and " 25%" in text and "100%" in text and text.endswith("\r\x1b[K")


def test_no_bar_where_nobody_looks(clock):
    """A log gets none unless asked for; a terminal none if it is switched off; a short run none at all."""
    assert drawn(io.StringIO()) == "" and drawn(Terminal(), False) == "" and "25%" in drawn(io.StringIO(), True)
    stream = Terminal()
    with progress_bar(None, stream) as show:
        show(0.9)
    assert stream.getvalue() == ""


def test_a_notebook_gets_one_element_that_is_replaced(clock, notebook):
    """HTML below the cell, which needs no widget; it is empty at the end, also after an error."""
    assert drawn(io.StringIO()) == ""
    assert '<progress max="1" value="0.250"' in notebook[0] and "25%" in notebook[0] and notebook[-1] == ""
    with pytest.raises(ZeroDivisionError), progress_bar() as show:
        show(0.2)
        show(0.3)
        _ = 1 / 0
    assert "30%" in notebook[-2] and notebook[-1] == ""


def test_a_run_reports_the_share_done_to_the_end():
    """A function of the caller gets growing shares that end with 1."""
    shares: list[float] = []
    thetascope.run(spec_data(horizon=40, evaluate=0.01), progress=shares.append)
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == 1


def test_the_client_reports_what_the_service_says(monkeypatch):
    """It asks until the run has ended."""
    answers = iter([{"status": "running", "progress": p} for p in (0.2, 0.7)] + [{"status": "done", "progress": 1.0}])
    client, asked, shares = Client(), [], []

    def get(path: str) -> dict:
        asked.append(path)
        return next(answers) if "progress" in path else {"id": "r", "status": "done"}

    monkeypatch.setattr(client, "get", get)
    assert client.wait("r", shares.append) == {"id": "r", "status": "done"}
    assert shares == [0.2, 0.7] and asked[-1] == "/api/runs/r"
