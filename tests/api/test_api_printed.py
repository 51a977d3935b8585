"""/api/runs/{id}/figures/{name}/print: figures for a paper."""

from xml.etree import ElementTree

import pytest

from thetascope.client import ServiceError


@pytest.mark.parametrize(
    ("format", "begins"), [("pdf", b"%PDF-1."), ("png", b"\x89PNG"), ("tex", b"% Faults and their estimates")]
)
def test_a_figure_is_a_file_of_the_format(client, run, format, begins):
    """The answer is a download with the run's name."""
    path = f"{run['links']['figures']}/faults/print?format={format}&width=8.5&panels=1&size=7"
    _, headers, content = client.request("GET", path)
    assert content.startswith(begins)
    assert headers["content-disposition"].endswith(f'-faults-{run["id"][:8]}.{format}"')


def test_options_in_the_query_and_in_the_body_give_the_same_figure(client, run):
    """Curves, panels and styles are lists in both; a style that is chosen is drawn."""
    path = f"{run['links']['figures']}/faults/print"
    options = {"format": "svg", "width": 12, "curves": ["true", "adaptive"], "panels": [3, 1], "styles": ["true=dots"]}
    query = "format=svg&width=12&curves=true&curves=adaptive&panels=3&panels=1&styles=true%3Ddots"
    content = client.request("GET", f"{path}?{query}")[2]
    described = client.post(path, options | {"format": "json"})
    assert ElementTree.fromstring(content).attrib["width"].startswith("340.157")
    assert [(c["key"], c["style"]) for c in described["curves"]] == [("adaptive", "line"), ("true", "dots")]
    assert [panel["drawn"] for panel in described["panels"]] == [True, False, True]
    assert described["apart"] and described["thinnest"] == 0.5 and run["id"][:12] in described["caption"]
    assert f"figure {run['id'][:16]} faults --width 12" in described["command"]


@pytest.mark.parametrize(
    ("query", "field", "remedy"),
    [
        ("width=50", "width", "at most 21"),
        ("widht=8", "widht", "width"),
        ("curves=adaptiv", "curves[0]", "adaptive"),
        ("panels=9", "panels[0]", "1 to 3"),
        ("start=5&end=4", "end", "after the start"),
        ("start=1000", "start", "between 0 s and 5 s"),
    ],
)
def test_a_wrong_option_is_refused_by_field(client, run, query, field, remedy):
    """The refusal names the field and the remedy."""
    with pytest.raises(ServiceError) as refused:
        client.get(f"{run['links']['figures']}/faults/print?format=json&{query}")
    (error,) = refused.value.problem["errors"]
    assert (refused.value.status, error["field"]) == (422, field) and remedy in error["remedy"]
