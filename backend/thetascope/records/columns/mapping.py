"""Guess which column holds which quantity of a plant, and apply what the user has chosen."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.columns.names import KINDS, is_set_point, plain, split_unit, words_of
from thetascope.records.columns.times import TimeChoice, changed, guess_time, is_index
from thetascope.records.columns.units import conversion
from thetascope.records.table import Column, Table
from thetascope_schemas.experiment.measurement import ColumnMapping, QuantityMapping
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.texts.names import normalised

_LEAST = 30.0  # score of a column below which it is not taken by its name
_NAME, _PREFIXED, _WORD, _SOME, _UNIT_FITS = 100.0, 95.0, 70.0, 30.0, 12.0
_NEVER = -1e3
_PREFIXES = {"input": ("u.", "input."), "signal": ("signal.", "phi."), "output": ("y.", "output.")}


@dataclass(frozen=True)
class Quantity:
    """An input, signal or output of a plant: what is known of it before any record."""

    name: str
    role: Literal["input", "signal", "output"]
    unit: str
    description: str
    texts: tuple[str, ...]
    bounds: tuple[float | None, float | None]
    usual: float | None
    state: str = ""
    controlled: bool = False


@dataclass(frozen=True)
class Taken:
    """A quantity and the column that it is read from: its value is factor · cell + offset.

    `written`: whether the unit is the file's or the user's; `foreign`: a written one of another kind, not converted.
    """

    quantity: Quantity
    column: str | None
    unit: str
    factor: float
    offset: float
    certain: bool
    reason: Message
    written: bool = False
    foreign: str = ""


@dataclass(frozen=True)
class Mapping:
    """The times and the quantities of a plant, each with its column."""

    time: TimeChoice
    taken: tuple[Taken, ...]


def mapping_of(table: Table, quantities: Sequence[Quantity], asked: ColumnMapping) -> Mapping:
    """Return the complete mapping: the user's choices, and guesses for the rest. Raises SpecError for wrong choices."""
    time = _time(table, asked)
    names = {q.name for q in quantities}
    for name in asked.quantities:
        if name not in names:
            raise SpecError(f"mapping.quantities.{name}", name, Message("record.mapping.quantity", names=sorted(names)))
    chosen = {
        name: choice for name, choice in asked.quantities.items() if choice.column is not None or _is_none(choice)
    }
    for name, choice in chosen.items():
        if choice.column is not None and table.named_as(choice.column) is None:
            raise _unknown(f"mapping.quantities.{name}.column", choice.column, table)
    taken = {choice.column for choice in chosen.values()} | {time.column}
    open_ = [q for q in quantities if q.name not in chosen]
    spellings = {spelling for q in open_ for spelling in _spellings(q)}
    free = [c for c in table.columns if c.name not in taken and _may_be_read(c, table, spellings)]
    guesses = _guesses(open_, free, table.named)
    result = []
    for quantity in quantities:
        choice = asked.quantities.get(quantity.name)
        if quantity.name in chosen and choice is not None:
            column = table.named_as(choice.column) if choice.column is not None else None
            guess = (column, Message("record.reason.chosen"), True)
        else:
            guess = guesses.get(quantity.name, (None, Message("record.reason.no-column"), False))
        result.append(_taken(quantity, *guess, choice))
    return Mapping(time, tuple(result))


def _is_none(choice: QuantityMapping) -> bool:
    """Return whether a choice says that the record has no such column: it says nothing else."""
    return choice.column is None and choice.unit is None and choice.factor is None and choice.offset is None


def _time(table: Table, asked: ColumnMapping) -> TimeChoice:
    guess = guess_time(table)
    if asked.time is None:
        return guess
    try:
        return changed(guess, asked.time, table)
    except KeyError as error:
        raise _unknown("mapping.time.column", str(error.args[0]), table) from None


def _unknown(field: str, column: str, table: Table) -> SpecError:
    names = [c.name for c in table.columns][:40]
    return SpecError(field, column, Message("record.mapping.column", names=names))


def _may_be_read(column: Column, table: Table, spellings: set[str]) -> bool:
    """Return whether a column may be a quantity's: it has numbers that do not count rows, or the quantity's name."""
    if plain(split_unit(column.name)[0]) in spellings:
        return True
    if column.kind != "number":
        return False
    unnamed = plain(column.name) in ("index", "row", "no", "nr", "id", "sample", "record", "unnamed0", "indexlevel0")
    return not (is_index(column.values) and (unnamed or column.name.startswith("col")) and table.named)


def _guesses(
    quantities: Sequence[Quantity], columns: Sequence[Column], named: bool
) -> dict[str, tuple[Column, Message, bool]]:
    """Return for each quantity the column that fits best, with the reason and whether it is certain."""
    from scipy.optimize import linear_sum_assignment

    if not quantities or not columns:
        return {}
    scores = np.array([[_score(q, c) if named else 0.0 for c in columns] for q in quantities])
    rows, places = linear_sum_assignment(-np.maximum(scores, 0.0))
    result: dict[str, tuple[Column, Message, bool]] = {}
    for row, place in zip(rows, places, strict=True):
        score = scores[row, place]
        if score < _LEAST:
            continue
        quantity, column = quantities[row], columns[place]
        others = max(np.delete(scores[row], place).max(initial=0.0), np.delete(scores[:, place], row).max(initial=0.0))
        same = plain(split_unit(column.name)[0]) in _spellings(quantity)
        code = "same-name" if same else "similar-name"
        result[quantity.name] = (column, Message(f"record.reason.{code}"), same or bool(score > others + 5))
    _fill(quantities, columns, scores, result, named)
    return result


def _fill(
    quantities: Sequence[Quantity],
    columns: Sequence[Column],
    scores: np.ndarray,
    result: dict[str, tuple[Column, Message, bool]],
    named: bool,
) -> None:
    """Add quantities that no name gives: by their unit, the only column that is left, or the order of columns."""
    used = {column.name for column, _, _ in result.values()}
    places = {c.name: k for k, c in enumerate(columns)}

    def possible(quantity: Quantity, column: Column) -> bool:
        row = quantities.index(quantity)
        return column.name not in used and not is_set_point(column.name) and scores[row, places[column.name]] > _NEVER

    def take(pairs: Sequence[tuple[Quantity, Column]], code: str, certain: bool) -> None:
        for quantity, column in pairs:
            result[quantity.name] = (column, Message(f"record.reason.{code}"), certain)
            used.add(column.name)

    for role in ("output", "input", "signal"):
        for quantity in [q for q in quantities if q.role == role and q.name not in result]:
            alike = [q for q in quantities if q.name not in result and conversion(q.unit, quantity.unit)]
            fitting = [c for c in columns if possible(quantity, c) and _unit_fits(quantity, c)]
            if quantity.name not in result and len(alike) == len(fitting):
                pairs = list(zip(alike, fitting, strict=True))
                take(pairs, "unit", len(pairs) == 1 or all(_number(q.name) == _number(c.name) != "" for q, c in pairs))
    open_ = [q for q in quantities if q.name not in result]
    free = [c for c in columns if all(possible(q, c) for q in open_) and _moves(c)]
    free = [c for c in free if not named or any(_may_mean(q, c) for q in open_)]
    if len(open_) == len(free) and open_:
        take(list(zip(open_, free, strict=True)), "only-one" if len(open_) == 1 else "order", False)


def _number(name: str) -> str:
    """Return the last number in a name."""
    digits = [word for word in sorted(words_of(split_unit(name)[0])) if word.isdigit()]
    return digits[-1] if digits else ""


def _may_mean(quantity: Quantity, column: Column) -> bool:
    """Return whether a name says nothing of another kind of quantity, such as a temperature for a flow."""
    kinds = words_of(split_unit(column.name)[0]) & KINDS
    return not kinds or any(kinds & words_of(text) for text in quantity.texts)


def _moves(column: Column) -> bool:
    if column.kind != "number":
        return False
    values = column.values[~np.isnan(column.values)]
    return len(values) > 0 and float(values.min()) < float(values.max())


def _spellings(quantity: Quantity) -> set[str]:
    own = {plain(quantity.name), *(plain(prefix + quantity.name) for prefix in _PREFIXES[quantity.role])}
    return own | ({plain(quantity.state)} if quantity.state else set())


def _score(quantity: Quantity, column: Column) -> float:
    """Return how well the name and the unit of a column fit a quantity."""
    bare, unit = split_unit(column.name)
    unit = unit or column.unit
    own = normalised(column.name)
    if own in (quantity.name, *(p + quantity.name for p in _PREFIXES[quantity.role])):
        return _NAME + 10
    fits = _unit_fits(quantity, column)
    if unit and quantity.unit and not fits and conversion(unit, unit) and conversion(quantity.unit, quantity.unit):
        if plain(bare) in _spellings(quantity) and quantity.unit:
            return _NAME
        return _NEVER
    extra = _UNIT_FITS if fits else 0.0
    if plain(bare) in _spellings(quantity):
        exact = bare in (quantity.name, *(p + quantity.name for p in _PREFIXES[quantity.role]))
        return (_NAME if exact else _PREFIXED) + extra
    words = words_of(bare)
    if is_set_point(bare):
        return _NEVER
    if plain(quantity.name) in {plain(word) for word in bare.replace("_", " ").split()}:
        return _WORD + extra
    best = max((_overlap(words, words_of(text)) for text in quantity.texts), default=0.0)
    return best + extra if best else 0.0


def _overlap(words: frozenset[str], others: frozenset[str]) -> float:
    """Return the score of common words; different numbers are different things."""
    numbers, own = {w for w in words if w.isdigit()}, {w for w in others if w.isdigit()}
    if numbers and own and numbers != own:
        return 0.0
    common = (words & others) - numbers
    if not common:
        return 0.0
    share = len(words & others) / max(1, min(len(words), len(others)))
    return _SOME + 25.0 * share + (8.0 if numbers and numbers == own else -4.0 if numbers != own else 0.0)


def _unit_fits(quantity: Quantity, column: Column) -> bool:
    unit = split_unit(column.name)[1] or column.unit
    return bool(unit) and bool(quantity.unit) and conversion(unit, quantity.unit) is not None


def _taken(
    quantity: Quantity, column: Column | None, reason: Message, certain: bool, choice: QuantityMapping | None
) -> Taken:
    """Return a quantity with its column and the conversion of its unit."""
    if column is None:
        return Taken(quantity, None, quantity.unit, 1.0, 0.0, False, reason)
    if choice is not None and (choice.factor is not None or choice.offset is not None):
        factor = 1.0 if choice.factor is None else choice.factor
        return Taken(quantity, column.name, "", factor, choice.offset or 0.0, True, reason, True)
    written = split_unit(column.name)[1] or column.unit
    asked = choice.unit if choice is not None else None
    if asked is not None:
        pair = conversion(asked, quantity.unit)
        if pair is None:
            field = f"mapping.quantities.{quantity.name}.unit"
            raise SpecError(field, asked, Message("record.mapping.unit", unit=asked, target=quantity.unit or "1"))
        return Taken(quantity, column.name, asked, *pair, True, reason, True)
    pair = conversion(written, quantity.unit) if written else None
    if pair is None:
        foreign = written if quantity.unit else ""
        certain = certain and not foreign
        return Taken(quantity, column.name, quantity.unit, 1.0, 0.0, certain, reason, bool(foreign), foreign)
    return Taken(quantity, column.name, written, *pair, certain, reason, True)


def quantities_of(plant: Plant) -> tuple[Quantity, ...]:
    """Return the inputs, known signals and outputs of a plant, in this order."""
    controlled = set(plant.controlled)
    states = {state.name: state for state in plant.states}
    result = []
    for u in plant.inputs:
        texts = (u.name, *_texts(u.description))
        about = (u.unit, str(u.description), texts, u.bounds, u.default or None)
        result.append(Quantity(u.name, "input", *about, controlled=u.name in controlled))
    for phi in plant.signals:
        texts = (phi.name, *_texts(phi.description))
        result.append(Quantity(phi.name, "signal", phi.unit, str(phi.description), texts, (None, None), None))
    for y in plant.outputs:
        state = states.get(y.expression.strip())
        texts = (y.name, *_texts(y.description), *(_texts(state.description) if state else ()))
        domain, name = (state.domain, state.name) if state else ((None, None), "")
        result.append(Quantity(y.name, "output", y.unit, str(y.description), texts, domain, None, name))
    return tuple(result)


def _texts(text: str) -> tuple[str, ...]:
    """Return a text in all its languages."""
    return (str(text), *getattr(text, "texts", {}).values())
