"""Excitation: how well the input of a window separates the faults, and which of them it does not show, in a sentence.

J (p, p) is the information of a window about all faults of the plant: J⁻¹ is the covariance of their estimate. In units
of typical faults, T J T with T = diag(typical), its eigenvalues are the squared signal-to-noise ratios of combinations
of faults: the windowed Gramian of Zhao, Li & Li 2012, (36), weighted by the noise. A standard deviation of a tenth of a
typical fault requires 100.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.sentences import joined
from thetascope.messages import Message

MENTIONED = 0.1  # of a unit vector: smaller components are left out
_BLIND = 0.3  # signal-to-noise ratio of a typical fault below which it is not excited at all
_UNSEEN = 1.0  # signal-to-noise ratio below which a combination is not seen
_JOINED = 0.1  # correlation within the invisible directions from which on channels belong to one group
_EPS = 1e-14


@dataclass(frozen=True)
class Excitation:
    """The excitation of the faults in one window.

    Attributes:
        level: smallest eigenvalue, in (typical fault / its standard deviation)²; None without data.
        needed: the level that the required accuracy needs.
        deviations: standard deviation of each fault, the others being unknown, in its own unit; ∞ if it is not seen.
        identifiable: whether that is at most the required one.
        direction: the combination that is seen least, a unit vector in typical faults; small components are left out.
        groups: channels that are not separated from each other, or not seen.
        text: the same in a sentence.
    """

    level: float | None
    needed: float
    deviations: dict[str, float]
    identifiable: dict[str, bool]
    direction: dict[str, float]
    groups: tuple[tuple[str, ...], ...]
    text: Message


def excitation(
    J: np.ndarray, names: Sequence[str], typical: Sequence[float] | np.ndarray, accuracy: float
) -> Excitation:
    """Return the excitation of a window.

    Args:
        J: (p, p), the window's information.
        names: (p,), the channels.
        typical: (p,), typical sizes of faults.
        accuracy: required standard deviation, as a share of a typical fault.
    """
    J, T, needed = np.asarray(J, dtype=float), np.asarray(typical, dtype=float), 1.0 / accuracy**2
    if not len(names) or not np.isfinite(J).all():
        unlimited = dict.fromkeys(names, np.inf)
        text = Message("diagnosis.excitation.unknown" if len(names) else "diagnosis.none.no-channels")
        return Excitation(None, needed, unlimited, dict.fromkeys(names, False), {}, (), text)
    N = J * np.outer(T, T)
    values, vectors = np.linalg.eigh((N + N.T) / 2)
    values = np.where(values <= _EPS * max(float(values[-1]), 1e-300), 0.0, values)
    spread = _spread(values, vectors)
    level = float(values[0])
    weak = values < needed * (1 - 1e-9)
    unsure = [[i for i in g if spread[i] > accuracy] for g in _groups(vectors[:, weak])]
    groups = [g for g in unsure if g]
    texts = [_group_text(g, N, values[weak], vectors[:, weak], names, T, needed) for g in groups]
    return Excitation(
        level,
        needed,
        {n: float(s * t) for n, s, t in zip(names, spread, T, strict=True)},
        {n: bool(s <= accuracy * (1 + 1e-9)) for n, s in zip(names, spread, strict=True)},
        _direction(values, vectors, names),
        tuple(tuple(names[i] for i in g) for g in groups),
        _text(texts, level, len(names)),
    )


def band(J: np.ndarray, prior: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return the standard deviation (…, p) that a window can reach: √ of the diagonal of (J + diag(1/prior²))⁻¹, J
    being (…, p, p).

    `prior` (p,): standard deviation of a fault before any data, usually its typical size.
    """
    T = np.asarray(prior, dtype=float)
    N = np.asarray(J, dtype=float) * np.outer(T, T) + np.eye(len(T))
    return np.sqrt(np.maximum(np.einsum("...ii->...i", np.linalg.inv(N)), 0.0)) * T


def _spread(values: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return √ of the diagonal of the inverse (p,), ∞ for channels with a component in the null space."""
    lost = values == 0.0
    blind = (vectors[:, lost] ** 2).sum(axis=1) > 1e-8
    variance = (vectors[:, ~lost] ** 2 / values[~lost]).sum(axis=1)
    return np.where(blind, np.inf, np.sqrt(variance))


def _direction(values: np.ndarray, vectors: np.ndarray, names: Sequence[str]) -> dict[str, float]:
    """Return the combination that is seen least; of several that are not seen at all, that of the first channel in
    them."""
    least = vectors[:, values <= values[0]]
    P = least @ least.T
    vector = P[:, int(np.argmax(np.diag(P) > MENTIONED**2 / len(P)))]
    vector = vector / np.linalg.norm(vector)
    return {n: float(v) for n, v in zip(names, vector, strict=True) if abs(v) >= MENTIONED}


def _groups(weak: np.ndarray) -> list[list[int]]:
    """Return the groups of channels that weakly seen combinations (p, combinations) join, whatever the basis of their
    space."""
    P = weak @ weak.T
    size = np.sqrt(np.maximum(np.diag(P), 0.0))
    rest, groups = [i for i in range(len(P)) if size[i] >= MENTIONED], []
    while rest:
        group, reached = [], [rest[0]]
        while reached:
            i = reached.pop()
            rest.remove(i)
            group.append(i)
            near = [j for j in rest if abs(P[i, j]) >= _JOINED * size[i] * size[j]]
            reached += [j for j in near if j not in reached]
        groups.append(sorted(group))
    return sorted(groups)


# ---- sentences -------------------------------------------------------------------------------------------------------


def _group_text(
    group: list[int],
    N: np.ndarray,
    values: np.ndarray,
    weak: np.ndarray,
    names: Sequence[str],
    T: np.ndarray,
    needed: float,
) -> Message:
    """Return the sentence about one group of channels that a window does not show."""
    part = weak[group]
    share = (part**2).sum(axis=0)
    hidden = max(1, round(float(share.sum())))
    least = float(np.sqrt(values[share > 0.5 * share.max()].min()))
    channels, required = [names[i] for i in group], needed**0.5
    if len(group) == 1:
        ratio = float(np.sqrt(max(N[group[0], group[0]], 0.0)))
        if ratio < _BLIND:
            return Message("diagnosis.excitation.blind", channels=channels, n=1)
        weak_alone = ratio < _UNSEEN or ratio < required
        code = "diagnosis.excitation.weak" if weak_alone else "diagnosis.excitation.confused"
        return Message(code, channel=channels[0], times=_floored(ratio if weak_alone else least), required=required)
    if hidden >= len(group):
        return Message("diagnosis.excitation.weak-group", channels=channels, times=_floored(least), required=required)
    if least >= _UNSEEN:
        return Message(
            "diagnosis.excitation.hardly-separable", channels=channels, times=_floored(least), required=required
        )
    if len(group) - hidden == 1:
        combination = _combination(group, part, names, T)
        return Message("diagnosis.excitation.one-combination", channels=channels, combination=combination)
    return Message("diagnosis.excitation.combinations", channels=channels, n=len(group) - hidden)


def _floored(value: float) -> float:
    """Return a value rounded down to two digits, so that a ratio that is too small never reads as large enough."""
    digits = 10.0 ** (1 - int(np.floor(np.log10(value)))) if value > 0 else 1.0
    return float(np.floor(value * digits) / digits)


def _combination(group: list[int], part: np.ndarray, names: Sequence[str], T: np.ndarray) -> str:
    """Return the one combination of a group that is seen, in the faults' own units, the first with factor one."""
    rest = np.eye(len(group)) - part @ part.T
    w = np.linalg.eigh(rest)[1][:, -1]  # a unit vector in typical faults
    shown = [i for i, v in enumerate(w) if abs(v) >= MENTIONED]
    factors = w[shown] / T[group][shown]
    text = ""
    for i, value in zip(shown, factors / factors[0], strict=True):
        size = f"{abs(value):.2g}"
        sign = "" if not text else " − " if value < 0 else " + "
        text += sign + (f"{size} " if size != "1" else "") + names[group[i]]
    return text


def _text(texts: list[Message], level: float, channels: int) -> Message:
    """Return the excitation in a sentence; channels that are not excited at all come last, together."""
    if not texts:  # the least visible combination may stand out less than is required of each fault by itself
        code = "diagnosis.excitation.visible" if channels == 1 else "diagnosis.excitation.separable"
        return Message(code, times=level**0.5)
    blind = [text.args["channels"][0] for text in texts if text.code == "diagnosis.excitation.blind"]
    others = [text for text in texts if text.code != "diagnosis.excitation.blind"]
    if blind:
        others.append(Message("diagnosis.excitation.blind", channels=blind, n=len(blind)))
    return joined(others)
