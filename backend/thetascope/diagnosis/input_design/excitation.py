"""What the input of a window tells about the faults, and in words what it does not.

J (p × p) is the information of a window about all faults of the plant: J⁻¹ is the covariance of their estimate. In units
of typical faults, T J T with T = diag(typical), its eigenvalues say how far combinations of faults stand out from the
noise, squared: the windowed Gramian of Zhao, Li & Li 2012, (36), weighted by the noise. An accuracy of a tenth of a
typical fault asks for 100.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MENTIONED = 0.1  # of a unit vector: smaller components are left out
_BLIND = 0.3  # standard deviations by which a typical fault stands out: less is not seen at all
_UNSEEN = 1.0
_JOINED = 0.1  # correlation in the space of what is not seen, from which channels belong together
_EPS = 1e-14


@dataclass(frozen=True)
class Excitation:
    """``level``: smallest eigenvalue in (typical fault/its standard deviation)², None where nothing was seen yet.

    ``deviations``: standard deviation of each fault, the others unknown, in its own unit, ∞ where there is none;
    ``identifiable``: whether that is at most what was asked; ``direction``: the combination that is seen least, a unit
    vector in typical faults; ``groups``: channels that are not told apart, or not seen.
    """

    level: float | None
    needed: float
    deviations: dict[str, float]
    identifiable: dict[str, bool]
    direction: dict[str, float]
    groups: tuple[tuple[str, ...], ...]
    text: str


def excitation(J: np.ndarray, names: Sequence[str], typical: Sequence[float], accuracy: float) -> Excitation:
    """From J over a window. ``accuracy``: standard deviation asked for, as a share of a typical fault."""
    J, T, needed = np.asarray(J, dtype=float), np.asarray(typical, dtype=float), 1.0 / accuracy**2
    if not len(names) or not np.isfinite(J).all():
        none = dict.fromkeys(names, np.inf)
        text = "the plant has no fault channels" if not len(names) else "nothing is known of this window"
        return Excitation(None, needed, none, dict.fromkeys(names, False), {}, (), text)
    N = J * np.outer(T, T)
    values, vectors = np.linalg.eigh((N + N.T) / 2)
    values = np.where(values <= _EPS * max(float(values[-1]), 1e-300), 0.0, values)
    spread = _spread(values, vectors)
    level = float(values[0])
    weak = values < needed * (1 - 1e-9)
    unsure = [[i for i in g if spread[i] > accuracy] for g in _groups(vectors[:, weak])]
    groups = [g for g in unsure if g]
    texts = [_words(g, N, values[weak], vectors[:, weak], names, T, needed) for g in groups]
    return Excitation(
        level,
        needed,
        {n: float(s * t) for n, s, t in zip(names, spread, T, strict=True)},
        {n: bool(s <= accuracy * (1 + 1e-9)) for n, s in zip(names, spread, strict=True)},
        _direction(values, vectors, names),
        tuple(tuple(names[i] for i in g) for g in groups),
        _sentence(texts, level, len(names)),
    )


def band(J: np.ndarray, prior: Sequence[float]) -> np.ndarray:
    """What a window can tell at all: √ of the diagonal of (J + diag(1/prior²))⁻¹. J may be a stack (…, p, p).

    ``prior`` (p): standard deviation of a fault of which nothing has been seen, usually its typical size.
    """
    T = np.asarray(prior, dtype=float)
    N = np.asarray(J, dtype=float) * np.outer(T, T) + np.eye(len(T))
    return np.sqrt(np.maximum(np.einsum("...ii->...i", np.linalg.inv(N)), 0.0)) * T


def _spread(values: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """√ of the diagonal of the inverse, ∞ for what lies in the null space."""
    lost = values == 0.0
    blind = (vectors[:, lost] ** 2).sum(axis=1) > 1e-8
    variance = (vectors[:, ~lost] ** 2 / values[~lost]).sum(axis=1)
    return np.where(blind, np.inf, np.sqrt(variance))


def _direction(values: np.ndarray, vectors: np.ndarray, names: Sequence[str]) -> dict[str, float]:
    """The combination that is seen least. Of several that are not seen at all: that of the first channel among them."""
    least = vectors[:, values <= values[0]]
    P = least @ least.T
    vector = P[:, int(np.argmax(np.diag(P) > MENTIONED**2 / len(P)))]
    vector = vector / np.linalg.norm(vector)
    return {n: float(v) for n, v in zip(names, vector, strict=True) if abs(v) >= MENTIONED}


def _groups(weak: np.ndarray) -> list[list[int]]:
    """Channels that the weakly seen combinations join; the same however a basis of these is chosen."""
    P = weak @ weak.T
    size = np.sqrt(np.maximum(np.diag(P), 0.0))
    left, groups = [i for i in range(len(P)) if size[i] >= MENTIONED], []
    while left:
        group, reached = [], [left[0]]
        while reached:
            i = reached.pop()
            left.remove(i)
            group.append(i)
            near = [j for j in left if abs(P[i, j]) >= _JOINED * size[i] * size[j]]
            reached += [j for j in near if j not in reached]
        groups.append(sorted(group))
    return sorted(groups)


# ---- words -------------------------------------------------------------------------------------------------------------------

Text = tuple[str, str]  # what it is about, and what is said of it, with {} for it


def _words(
    group: list[int],
    N: np.ndarray,
    values: np.ndarray,
    weak: np.ndarray,
    names: Sequence[str],
    T: np.ndarray,
    needed: float,
) -> Text:
    """One group: the channel or channels, and what the window does not tell of them."""
    them, asked = _listed([names[i] for i in group]), f"{needed**0.5:.3g} times are asked for"
    part = weak[group]
    share = (part**2).sum(axis=0)
    hidden = max(1, round(float(share.sum())))
    least = float(np.sqrt(values[share > 0.5 * share.max()].min()))
    if len(group) == 1:
        seen = float(np.sqrt(max(N[group[0], group[0]], 0.0)))
        if seen < _BLIND:
            return them, "{} is not excited at all: its fault would not show in any output now"
        if seen < _UNSEEN or seen < needed**0.5:
            return (
                them,
                f"{{}} shows too little now: a typical fault stands out {_times(seen)} times above the noise, " + asked,
            )
        return them, f"{{}} is told from the others too little now: it stands out {_times(least)} times, {asked}"
    how = "cannot be told apart with this input" if least < _UNSEEN else "can hardly be told apart with this input"
    if hidden >= len(group):
        return them, f"{{}} show too little now: the least {_times(least)} times above the noise, {asked}"
    if least >= _UNSEEN:
        return them, f"{{}} {how}: what tells them apart stands out {_times(least)} times above the noise, {asked}"
    if len(group) - hidden == 1:
        return them, f"{{}} {how}: only their combination {_combination(group, part, names, T)} shows"
    return them, f"{{}} {how}: only {len(group) - hidden} combinations of them show"


def _times(value: float) -> str:
    """Rounded down, so that what is too little never reads as enough."""
    digits = 10.0 ** (1 - int(np.floor(np.log10(value)))) if value > 0 else 1.0
    return f"{np.floor(value * digits) / digits:.2g}"


def _combination(group: list[int], part: np.ndarray, names: Sequence[str], T: np.ndarray) -> str:
    """What is seen of a group: the direction that the weak ones leave, in the faults' own units, the first counted once."""
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


def _sentence(texts: list[Text], level: float, channels: int) -> str:
    if not texts and channels == 1:
        return f"the fault can be seen: a typical one stands out {level**0.5:.3g} times above the noise"
    if not texts:  # the least visible one may stand out less than is asked of each fault by itself
        return f"all faults can be told apart: the least visible combination stands out {level**0.5:.3g} times above the noise"
    blind = [them for them, words in texts if "not excited at all" in words]
    said = [words.replace("{}", them) for them, words in texts if "not excited at all" not in words]
    if len(blind) > 1:
        said.append(f"{_listed(blind)} are not excited at all: their faults would not show in any output now")
    elif blind:
        said.append(f"{blind[0]} is not excited at all: its fault would not show in any output now")
    return "; ".join(said)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
