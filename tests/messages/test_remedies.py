"""Every refusal has a remedy: the entry `code.remedy` of its problem in every language, or one that the call gives.

The refusals are found in the syntax trees. COMPUTED lists the codes where a call does not write its code.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.messages.test_catalogues import pattern_of
from thetascope.messages.catalogue import catalogue, languages

ROOT = Path(__file__).parents[2]

REFUSALS = {
    name: 1
    for name in ("SpecError", "ExpressionError", "Refusal", "Unknown", "Busy", "NotReady", "OverLimit", "NotOwner")
}
REFUSALS |= {"refuse": 1, "invalid": 1, "problem": 1, "failed": 0, "refusal": 0, "BodyProblem": 0}
REFUSALS |= {"DocumentError": 3, "StoreError": 0, "KeyFileError": 0}
"""Exceptions and functions that take a problem, and how many arguments after it the remedy is; 0: they take none."""

COMPUTED = {
    "gain_values": ("observer.gain.not-positive", "observer.gain.outside-bounds", "observer.gain.too-small"),
    "Database._explained": ("store.locked", "store.read-only", "store.disk-full", "store.damaged"),
    "Experiment._check_times": ("experiment.interval.too-short",),
    "RequireKey._refusal": ("access.no-key", "access.wrong-key", "access.ended"),
    "RunManager.finished": ("run.cancelled", "run.failed"),
    "SavedTexts.get": ("workshop.version-unknown", "lesson.version-unknown", "workshop.unknown", "lesson.unknown"),
    "SavedTexts.remove": ("workshop.not-owner", "lesson.not-owner"),
    "_Reader.read": ("expression.syntax",),
    "with_command": ("experiment.interval.too-short",),
}
"""Codes of the refusals in these functions, which other functions compute."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@cache
def refusals() -> tuple[tuple[str, str, ast.Call, Function | None], ...]:
    """Return each call of one of REFUSALS: file, function around it by name and as a tree."""
    calls = []
    for path in [path for folder in ("backend", "shared") for path in sorted((ROOT / folder).rglob("*.py"))]:
        text = path.read_text("utf-8")
        if "Message(" in text or "refuse(" in text:
            calls += [(str(path.relative_to(ROOT)), *call) for call in calls_in(ast.parse(text))]
    return tuple(calls)


def calls_in(tree: ast.AST, name: str = "", function: Function | None = None) -> Iterator[tuple]:
    """Yield the refusals below a node with the innermost function around each."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Function | ast.ClassDef):
            inner = node if isinstance(node, Function) else None
            yield from calls_in(node, f"{name}.{node.name}".lstrip("."), inner)
            continue
        if isinstance(node, ast.Call) and called(node) in REFUSALS:
            yield name, node, function
        yield from calls_in(node, name, function)


def called(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")


def problem_of(call: ast.Call, function: Function | None) -> tuple[set[str], bool]:
    """Return the patterns of a refusal's codes, and whether the call itself gives the remedy."""
    keyword = next((k.value for k in call.keywords if k.arg == "remedy"), None)
    if isinstance(call.func, ast.Name) and call.func.id == "refuse":  # the schemas' function takes the code
        return texts_in(call.args[0], call, function), keyword is not None and is_message(keyword, call, function)
    for place, argument in enumerate(call.args):
        if codes := codes_in(argument, call, function):
            offset = REFUSALS[called(call)]
            given = call.args[place + offset] if offset and place + offset < len(call.args) else keyword
            return codes, given is not None and is_message(given, call, function)
    return set(), False


def codes_in(node: ast.expr, call: ast.Call, function: Function | None) -> set[str]:
    """Return the patterns of the codes of the messages that an expression can be; empty if it is not a message."""
    if isinstance(node, ast.IfExp):
        return codes_in(node.body, call, function) | codes_in(node.orelse, call, function)
    if isinstance(node, ast.Call) and called(node) in ("Message", "Wording"):
        return texts_in(node.args[0], call, function)
    if isinstance(node, ast.Name):
        return {code for value in values_of(node.id, call, function) for code in codes_in(value, call, function)}
    return set()


def texts_in(node: ast.expr, call: ast.Call, function: Function | None) -> set[str]:
    """Return the patterns of the texts that an expression can be; empty if that is not known."""
    if isinstance(node, ast.IfExp):
        return texts_in(node.body, call, function) | texts_in(node.orelse, call, function)
    if isinstance(node, ast.Constant):
        return {re.escape(str(node.value))}
    if isinstance(node, ast.JoinedStr):
        return {pattern} if (pattern := pattern_of(node)) else set()
    if isinstance(node, ast.Name):
        return {text for value in values_of(node.id, call, function) for text in texts_in(value, call, function)}
    return set()


def is_message(node: ast.expr, call: ast.Call, function: Function | None) -> bool:
    """Whether an expression is a message and cannot be None: a call but of get(), a constant, an item of a table."""
    if isinstance(node, ast.IfExp):
        return is_message(node.body, call, function) and is_message(node.orelse, call, function)
    if isinstance(node, ast.Name):
        values = values_of(node.id, call, function)
        return node.id.isupper() or bool(values) and all(is_message(value, call, function) for value in values)
    return isinstance(node, ast.Subscript) or isinstance(node, ast.Call) and called(node) != "get"


@cache
def parents_in(function: Function) -> dict[ast.AST, ast.AST]:
    return {child: node for node in ast.walk(function) for child in ast.iter_child_nodes(node)}


def values_of(name: str, call: ast.Call, function: Function | None) -> list[ast.expr]:
    """Return the expressions that a name can have at a call: of the assignments before it, back to the last one that is
    executed in any case."""
    if function is None:
        return []
    parents = parents_in(function)
    around: list[ast.AST] = [call]
    while (parent := parents.get(around[-1])) is not None:
        around.append(parent)
    before = [
        node
        for node in parents
        if isinstance(node, ast.Assign)
        and node.lineno < call.lineno
        and any(isinstance(target, ast.Name) and target.id == name for target in node.targets)
    ]
    values = []
    for node in sorted(before, key=lambda node: -node.lineno):
        values.append(node.value)
        if parents[node] in around:
            break
    return values


def passed_on(call: ast.Call, function: Function | None) -> bool:
    """Whether a refusal only repeats a problem: a parameter of its function,
    or the problem or code of another error."""
    parameters = {a.arg for a in (*function.args.args, *function.args.kwonlyargs)} if function else set()
    return any(
        isinstance(argument, ast.Name)
        and argument.id in parameters & {"problem", "why", "code"}
        or isinstance(argument, ast.Attribute)
        and argument.attr in ("problem", "why")
        or ast.unparse(argument).startswith("Message.from_data")
        for argument in call.args
    )


@pytest.mark.parametrize("language", languages())
def test_every_refusal_has_a_remedy(language):
    """The problem of each call has an entry, and a remedy unless the call gives one."""
    words = catalogue(language).templates
    problems = [code for code in words if not code.endswith(".remedy")]
    missing = {}
    for file, _, call, function in refusals():
        patterns, given = problem_of(call, function)
        for pattern in patterns:
            codes = [code for code in problems if re.fullmatch(pattern, code)]
            lacking = codes and not given and [code for code in codes if f"{code}.remedy" not in words]
            if not codes or lacking:
                missing[f"{file}:{call.lineno}"] = lacking or pattern
    assert missing == {}
    assert len([call for *_, call, function in refusals() if problem_of(call, function)[0]]) > 100  # they are found


def test_every_computed_refusal_is_listed():
    """A call whose code is computed is in COMPUTED, with codes that have a remedy in every language."""
    computed = {
        name: f"{file}:{call.lineno}"
        for file, name, call, function in refusals()
        if not problem_of(call, function)[0] and not passed_on(call, function)
    }
    assert set(computed) == set(COMPUTED), computed
    remedies = {f"{code}.remedy" for codes in COMPUTED.values() for code in codes}
    assert {language: remedies - set(catalogue(language).templates) for language in languages()} == {
        language: set() for language in languages()
    }
