"""Names as MathML symbols: theta1 → θ with index 1, h_max → h with index max; a word stays a word."""

import re
from html import escape

GREEK = dict(
    pair.split(":")
    for pair in [
        "alpha:α",
        "beta:β",
        "gamma:γ",
        "delta:δ",
        "epsilon:ε",
        "zeta:ζ",
        "eta:η",
        "theta:θ",
        "iota:ι",
        "kappa:κ",
        "lambda:λ",
        "mu:μ",
        "nu:ν",
        "xi:ξ",
        "pi:π",
        "rho:ρ",
        "sigma:σ",
        "tau:τ",
        "upsilon:υ",
        "phi:φ",
        "chi:χ",
        "psi:ψ",
        "omega:ω",
        "Gamma:Γ",
        "Delta:Δ",
        "Theta:Θ",
        "Lambda:Λ",
        "Xi:Ξ",
        "Pi:Π",
        "Sigma:Σ",
        "Upsilon:Υ",
        "Phi:Φ",
        "Psi:Ψ",
        "Omega:Ω",
    ]
)
HAT, DOT, TILDE, BAR = "ˆ", "˙", "˜", "¯"
_INDEXED = re.compile(r"([^\W\d_]|" + "|".join(sorted(GREEK, key=len, reverse=True)) + r")_?(\d+[a-z]?|_[^\W_]+)\Z")
_UNDERSCORED = re.compile(r"([^\W\d_]+)_([^\W_]+)\Z")


def parts(name: str) -> tuple[str, str]:
    """Return the letter (or word) and the index of a name; the index may be empty."""
    match = _INDEXED.match(name) or _UNDERSCORED.match(name)
    base, index = match.groups() if match and (len(match[1]) == 1 or match[1] in GREEK) else (name, "")
    return GREEK.get(base, base.replace("_", " ")), index.lstrip("_")


def identifier(letter: str) -> str:
    """Return the MathML of a letter (MathML sets it in italics) or of a word."""
    return f"<mi>{escape(letter)}</mi>" if len(letter) == 1 else f'<mi class="word">{escape(letter)}</mi>'


def accented(inner: str, accent: str) -> str:
    """Return a letter with a hat, dot, tilde or bar over it."""
    return f'<mover accent="true">{inner}<mo stretchy="false">{accent}</mo></mover>'


def symbol(name: str, accent: str = "") -> str:
    """Return the MathML of a quantity from its name, with an accent over the letter if one is given."""
    letter, index = parts(name)
    base = identifier(letter)
    base = accented(base, accent) if accent else base
    if not index:
        return base
    return f"<msub>{base}{f'<mn>{index}</mn>' if index.isdigit() else f'<mi>{escape(index)}</mi>'}</msub>"


def is_word(name: str) -> bool:
    """Return whether a name is shown as a word, which needs space beside it."""
    return len(parts(name)[0]) > 1
