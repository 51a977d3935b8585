"""The live page in Chinese: checks and refusals, not only the page's own words."""

import re

import pytest

from tests.browser.live_helpers import opened, until
from thetascope import library
from thetascope.assembly import prepare

ENGLISH = re.compile("[a-z]{4,} [a-z]{2,}")  # two words in a row: not a symbol, not a name


@pytest.mark.parametrize(
    "experiment", ["zhao-2012-observers", "shen-hu-2015", "zhou-tan-2012", "reduced-order-mimo", "dts200"]
)
def test_checks_are_translated(experiment):
    """Names and findings of every observer's checks are Chinese, with the same numbers."""
    spec = library.experiment(experiment)
    short = spec.model_copy(update={"horizon": round(300 * spec.record_interval, 9)})
    checks = [
        check for observer in prepare(library.resolve(short)).run(None, None).observers for check in observer.checks
    ]
    messages = [message for check in checks for message in (check.name, check.text)]
    chinese, texts = [message.text("zh") for message in messages], [str(message) for message in messages]
    assert len(checks) >= 4 and [words for words in chinese if ENGLISH.search(words)] == []
    number = re.compile(r"\d\.\d+")
    assert [sorted(number.findall(words)) for words in chinese] == [sorted(number.findall(text)) for text in texts]


def test_the_list_of_checks_is_chinese(tab):
    """The checks of a live session and the equations are Chinese."""
    live = opened(tab, "/?experiment=zhao-2012&t=12")
    live.evaluate("thetascope.act.language('zh')")
    until(live, "document.querySelector('#panel-inject h2')?.textContent === '注入故障'")
    until(live, "thetascope.state.checks.adaptive?.length")
    live.click(".lights")
    lines = live.locator(".checks li").evaluate_all(
        "(all) => all.map((one) => [one.querySelector('b'), one.querySelector('.soft')].map((part) => "
        "part.textContent))"
    )
    assert len(lines) >= 5 and [text for line in lines for text in line if ENGLISH.search(text)] == []
    live.evaluate("document.activeElement.blur()")
    live.keyboard.press("e")
    live.wait_for_selector("dialog .where math")
    assert [
        text for text in live.locator("dialog .where li, dialog h3").all_inner_texts() if ENGLISH.search(text)
    ] == []


def test_refusals_are_translated(tab):
    """A label that is taken and an unsuitable kind are refused in Chinese, with the remedy."""
    live = opened(tab, "/?experiment=dc-motor&t=2")
    live.evaluate("thetascope.act.language('zh')")
    until(live, "document.querySelector('#panel-observers h2')?.textContent === '观测器'")
    live.click("#panel-observers .heading .link")
    live.fill(".add-form input[type=text]", "adaptive")
    live.click(".add-form button[type=submit]")
    assert (
        until(live, "document.querySelector('.add-form .refused').textContent")
        == "已有标签为 adaptive 的观测器。 解决办法：请换一个标签。"
    )
    until(live, "document.querySelector('.add-form option[value=zhao-adaptive]').disabled")
    why = live.get_attribute(".add-form option[value=zhao-adaptive]", "title")
    assert "2 个输出" in why and not ENGLISH.search(why)
    live.evaluate(
        "thetascope.send({type: 'set-noise', output: 'y_speed', std: -1, sample_time: "
        "0.01}).catch(thetascope.act.refused)"
    )
    assert "不小于 0" in until(live, "document.querySelector('#notice').textContent")
