"""Read the text by which runs are sought: words, phrases and conditions."""

import re

from thetascope.store.notebook.listing import Condition
from thetascope_schemas.texts.names import normalised

_CONDITION = re.compile(r"([^\W\d][\w.]*)\s*(>=|<=|≥|≤|>|<|=)\s*([-+−]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?!\w)")
_PHRASE = re.compile(r'"([^"]*)"|(\S+)')
_SIGNS = {"≥": ">=", "≤": "<="}
_NAMES = {"false_alarms": "alarms", "rmse": "rmse", "delay": "delay"}
_LETTERS = "α β γ δ ε ζ η θ ι κ λ μ ν ξ ρ σ τ φ χ ψ ω"
_SPELT = "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi rho sigma tau phi chi psi omega"
_GREEK: dict[str, str] = dict(zip(_LETTERS.split(), _SPELT.split(), strict=True))


def parse_search(text: str) -> tuple[tuple[str, ...], tuple[Condition, ...]]:
    """Return the words (a phrase in quotes is one) and the conditions, such as `lambda > 2`, of a text.

    λ is lambda, and a name with dots is its last part.
    """
    conditions = tuple(
        Condition(_name(name), _SIGNS.get(sign) or sign, float(value.replace("−", "-")))
        for name, sign, value in _CONDITION.findall(text)
    )
    rest = _CONDITION.sub(" ", text)
    words = (phrase or word for phrase, word in _PHRASE.findall(rest))
    return tuple(word.strip(",;，；") for word in words if word.strip(",;，； ")), conditions


def _name(name: str) -> str:
    last = str(normalised(name.rsplit(".", 1)[-1]))
    return _NAMES.get(last.lower(), _GREEK.get(last[:1], last[:1]) + last[1:])
