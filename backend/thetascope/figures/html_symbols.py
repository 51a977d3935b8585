"""Typeset names as mathematics in HTML, for Plotly's text and for the report: theta1 → θ₁.

All text that a user may have typed passes through `escape`: the output contains only the tags written here (<i>, <sub>,
<sup>).
"""

import html
import re

GREEK = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "epsilon": "ε",
    "zeta": "ζ",
    "eta": "η",
    "theta": "θ",
    "iota": "ι",
    "kappa": "κ",
    "lambda": "λ",
    "mu": "μ",
    "nu": "ν",
    "xi": "ξ",
    "pi": "π",
    "rho": "ρ",
    "sigma": "σ",
    "tau": "τ",
    "upsilon": "υ",
    "phi": "φ",
    "chi": "χ",
    "psi": "ψ",
    "omega": "ω",
    "Gamma": "Γ",
    "Delta": "Δ",
    "Theta": "Θ",
    "Lambda": "Λ",
    "Xi": "Ξ",
    "Pi": "Π",
    "Sigma": "Σ",
    "Upsilon": "Υ",
    "Phi": "Φ",
    "Psi": "Ψ",
    "Omega": "Ω",
}
HAT, TILDE = "\u0302", "\u0303"
_INDEXED = re.compile(r"([^\W\d_]|" + "|".join(sorted(GREEK, key=len, reverse=True)) + r")_?(\d+[a-z]?)\Z")
_UNDERSCORED = re.compile(r"([^\W\d_]|" + "|".join(GREEK) + r")_([^\W_]+)\Z")
_TOKEN = re.compile(
    r"(?P<name>[^\W\d]\w*)"
    r"|(?P<power>\s*(?:\*\*|\^)\s*(?P<exponent>\d+(?:\.\d+)?|[^\W\d]\w*(?!\s*\()))"
    r"|(?P<times>\s*\*\s*)"
    r"|(?P<number>\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?)|(?P<other>.)",
    re.DOTALL,
)
_UPRIGHT = {
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "ln",
    "sqrt",
    "sign",
    "sgn",
    "abs",
    "Abs",
    "min",
    "max",
    "Min",
    "Max",
    "floor",
    "clip",
    "deadzone",
    "play",
    "satplay",
    "boucwen",
    "where",
    "if",
    "else",
    "and",
    "or",
}


def escape(text: object) -> str:
    """Return text from outside, escaped for HTML and for Plotly's pseudo-HTML."""
    return html.escape(str(text), quote=True)


def symbol(name: str, accent: str = "") -> str:
    """Return the name of a quantity as an italic symbol; `accent` (HAT or TILDE) is placed over its letter.

    theta1 → θ with subscript 1, h_max → h with subscript max, x21 → x with subscript 21; a word such as `level` stays
    one and gain_loss becomes two.
    """
    match = _INDEXED.match(name) or _UNDERSCORED.match(name)
    base, index = match.groups() if match else (name, "")
    letter = GREEK.get(base, base)
    if len(letter) > 1 and accent:  # an accent belongs over the first letter of a word
        letter = letter[0] + accent + letter[1:]
        accent = ""
    subscript = f"<sub>{escape(index)}</sub>" if index else ""
    return f"<i>{escape(letter.replace('_', ' '))}{accent}</i>{subscript}"


_SYMBOL = re.compile(
    r"(?<![\w.&;])(?:([A-Za-zα-ωΑ-Ω][\u0302\u0303\u0307]?)(\d{1,2})|(" + "|".join(GREEK) + r")_?(\d{0,2}))(?![\w.;])"
)


def mathematical(html_text: str) -> str:
    """Return escaped text of an axis or a trace, with x̂1, θ3 and theta3 in it set as symbols."""
    return _SYMBOL.sub(lambda m: symbol(m[3] + m[4]) if m[3] else f"<i>{m[1]}</i><sub>{m[2]}</sub>", html_text)


def expression(text: str) -> str:
    """Return an expression of a plant as one line of readable HTML: products set close, powers raised, sums spaced."""
    tokens = [match for match in _TOKEN.finditer(text) if match[0].strip()]
    out: list[str] = []
    for place, token in enumerate(tokens):
        before = tokens[place - 1][0] if place else "("
        if token["name"]:
            out.append(escape(token["name"]) if token["name"] in _UPRIGHT else symbol(token["name"]))
        elif token["power"]:
            exponent = token["exponent"]
            out.append(f"<sup>{symbol(exponent) if exponent[0].isalpha() else escape(exponent)}</sup>")
        elif token["times"]:
            after = tokens[place + 1][0] if place + 1 < len(tokens) else ""
            out.append("\u2009" if _close(before) and _close(after) and not after[:1].isdigit() else "\u2009·\u2009")
        elif token[0] in "+-<>=":
            sign = {"-": "−"}.get(token[0], escape(token[0]))
            out.append(sign if before in "(,*/" else f" {sign} ")
        else:
            out.append(", " if token[0] == "," else escape(token[0]))
    return "".join(out)


def _close(token: str) -> bool:
    """Return whether a factor needs no dot beside another: a number, a bracket, or a name of one letter."""
    return (
        token in "()" or token[:1].isdigit() or len(GREEK.get(token, token)) == 1 or _INDEXED.match(token) is not None
    )


def wrap(text: str, width: int = 14, lines: int = 3) -> str:
    """Return escaped text broken at spaces into at most `lines` lines of about `width` characters, joined by <br>."""
    rows: list[str] = []
    for word in str(text).split():
        if rows and len(rows[-1]) + 1 + len(word) <= width:
            rows[-1] += " " + word
        else:
            rows.append(word if len(word) <= width + 3 else word[:width] + "…")
    if len(rows) > lines:
        rows = [*rows[: lines - 1], rows[lines - 1].rstrip(",;") + " …"]
    return "<br>".join(escape(row) for row in rows)
