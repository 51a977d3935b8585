"""The command line in the requested language."""

import json
import re

import pytest

from thetascope.cli.argparse_words import ENTRIES
from thetascope.cli.words import chosen_language
from thetascope.messages import Message

CHINESE = re.compile("[\u4e00-\u9fff]")


@pytest.mark.parametrize(
    ("arguments", "environ", "language"),
    [
        ([], {}, "en"),
        ([], {"LANG": "zh_CN.UTF-8"}, "zh"),
        ([], {"LANG": "zh_CN.UTF-8", "LC_ALL": "en_GB.UTF-8"}, "en"),
        ([], {"LC_ALL": "", "LANG": "zh"}, "zh"),
        ([], {"LANG": "C.UTF-8"}, "en"),
        (["--language", "zh", "list"], {"LANG": "en_US"}, "zh"),
        (["--language=zh-CN", "list"], {}, "zh"),
        (["--language", "fr", "list"], {"LANG": "zh"}, "en"),
        (["list", "--", "--language", "zh"], {}, "en"),
        (["--language"], {"LANG": "zh"}, "zh"),
    ],
)
def test_the_option_overrides_the_environment(arguments, environ, language):
    """--language, then LC_ALL, LC_MESSAGES and LANG, then English."""
    assert chosen_language(arguments, environ) == language


@pytest.mark.parametrize("command", ["", "serve", "run", "trial", "diagnose", "inspect", "list", "check"])
def test_help_is_chinese(call, command):
    """Usage, headings, and every option and description of every command."""
    code, shown, _ = call("--language", "zh", *([command] if command else []), "--help")
    assert code == 0 and shown.startswith("用法：thetascope")
    assert re.findall(r"\b[a-z]+ [a-z]+ [a-z]+\b", shown) == []
    helps = re.findall(r"^  +(?:-\S+(?:, \S+)?(?: [A-Z.]+\S*)?|[A-Z|.a-z]+) {2,}(\S.*)$", shown, re.MULTILINE)
    assert helps and [text for text in helps if not CHINESE.search(text)] == []


@pytest.mark.parametrize(
    ("arguments", "code", "problem"),
    [
        (["run", "dc-moto"], 1, "库中没有实验“dc-moto”"),
        (["run", "shen-hu-2015", "--set", "horizn=1"], 1, "没有字段“horizn”"),
        (["run", "shen-hu-2015", "--set", "horizon=-1"], 1, "请给大于 0 的值"),
        (["run", "nothing.yaml"], 1, "无法读取"),
        (["run", "shen-hu-2015", "--out", "a.txt"], 2, ".csv、.json、.mat、.parquet或.html"),
        (["diagnose", "dc-moto", "a.csv"], 1, "库中没有对象"),
        (["trial", "dc-motor", "--seeds", "none"], 2, "不是 1 至"),
        ([], 2, "错误：缺少以下参数：COMMAND"),
        (["run"], 2, "错误：缺少以下参数：EXPERIMENT|FILE"),
        (["run", "dc-motor", "--sett", "a=1"], 2, "错误：无法识别的参数：--sett a=1"),
        (["run", "dc-motor", "--set"], 2, "错误：参数 --set：缺少一个值"),
        (["serve", "--port", "many"], 2, "错误：参数 --port：'many' 不是有效的 int 值"),
        (["fly"], 2, "错误：参数 COMMAND：'fly' 不可选"),
    ],
)
def test_refusals_are_chinese(call, arguments, code, problem):
    """Wrong usage and refused specs, wherever they are detected."""
    found, _, error = call("--language", "zh", *arguments)
    assert found == code and problem in error


def test_argparse_is_english_in_english(call):
    """The entries repeat argparse's own sentences, so English is not changed."""
    code, _, error = call("--language", "en", "run")
    assert code == 2 and "usage: thetascope" in error
    assert "error: the following arguments are required: EXPERIMENT|FILE" in error
    assert {text.rstrip("\n"): Message(code).text("en") for text, code in ENTRIES.items()} == {
        text.rstrip("\n"): text.rstrip("\n") for text in ENTRIES
    }


def test_a_plant_file_is_checked_in_chinese(call, tmp_path):
    """The report is Chinese, and the plant's title is in the requested language."""
    plant = {
        "id": "lag",
        "title": {"en": "Lag", "zh": "惯性环节"},
        "states": [{"name": "x"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "-x"},
    }
    path = tmp_path / "lag.json"
    path.write_text(json.dumps(plant), encoding="utf-8")
    code, shown, _ = call("--language", "zh", "check", str(path))
    assert code == 0 and "惯性环节" in shown and "1 个状态" in shown and "可以构造的观测器" in shown
    code, shown, _ = call("check", str(path))
    assert code == 0 and "lag: Lag, checked" in shown and "1 state, 0 inputs, 1 output, 0 channels" in shown
