"""The catalogues over HTTP."""

import json
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest


def test_a_catalogue_comes_with_its_plural_rule_and_an_etag(address):
    """A language's templates are one document; the same tag is answered without a body."""
    with urlopen(f"{address}/api/messages/zh-CN") as answer:
        data, tag = json.load(answer), answer.headers["etag"]
    assert data["language"] == "zh" and data["plural"] == ["other"]
    assert data["messages"]["common.states"] == ["{n} 个状态"]
    with urlopen(f"{address}/api/messages/en") as answer:
        assert answer.headers["etag"] != tag
        english = json.load(answer)
    assert english["plural"] == ["one", "other"] and english["messages"]["join.or"] == "{head} or {last}"
    with pytest.raises(HTTPError) as caught:
        urlopen(Request(f"{address}/api/messages/zh", headers={"If-None-Match": tag}))
    assert caught.value.code == 304
