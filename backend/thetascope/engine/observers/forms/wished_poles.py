"""Gains from wished poles: the option ``poles``, a text such as ``-4, -3±2j``.

A chain of integrators of length r with output injection H has the characteristic polynomial s^r + H1 s^(r−1) + … + Hr:
H are the coefficients of the polynomial with the wished zeros (Remark 3 of the paper named in normal_form.py).
"""

import re
from collections.abc import Sequence

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Context, Option
from thetascope.messages import Message

POLES = Option("poles", Message("option.poles"), "poles", None)
_NUMBER = r"[-+\u2212]?\d+(?:\.\d*)?(?:e[-+]?\d+)?"
_POLE = re.compile(rf"({_NUMBER})(?:\s*(±|\+-|\+|-|\u2212)\s*(\d+(?:\.\d*)?(?:e[-+]?\d+)?)?\s*[ij])?", re.IGNORECASE)
_MOST = 1000  # characters


def wished_poles(text: str) -> list[complex]:
    """Return the poles that a text lists, separated by commas or semicolons; ``a±bj`` stands for both of a pair.

    Raises SpecError for a part that is no number, and for a pole that is not in the left half plane.
    """
    poles: list[complex] = []
    for part in filter(None, (p.strip() for p in re.split(r"[,;]", str(text)[:_MOST]))):
        found = _POLE.fullmatch(part)
        if found is None:
            raise SpecError("options.poles", part[:40], Message("observer.poles.unreadable", part=part[:40]))
        real = float(found[1].replace("\u2212", "-"))
        size = 0.0 if found[2] is None else float(found[3] or 1.0)
        if not np.isfinite([real, size]).all() or real >= 0:
            raise SpecError("options.poles", part[:40], Message("observer.poles.unstable", part=part[:40]))
        both = found[2] in ("±", "+-")
        sign = -1.0 if found[2] in ("-", "\u2212") else 1.0
        poles += [complex(real, sign * size)] + ([complex(real, -size)] if both else [])
    return poles


def injection(context: Context, blocks: Sequence[int]) -> list[float] | None:
    """Return the gains of chains of integrators for the poles of the option, block after block; None without it.

    Raises SpecError where there are too many or too few poles, and for a block whose poles are no conjugate pairs.
    """
    if not context.poles.strip():
        return None
    poles = wished_poles(context.poles)
    if len(poles) != sum(blocks):
        problem = Message("observer.poles.count", given=len(poles), needed=sum(blocks), blocks=list(blocks))
        raise SpecError("options.poles", context.poles, problem)
    gains: list[float] = []
    for size in blocks:
        own, poles = poles[:size], poles[size:]
        coefficients = np.poly(own)[1:] if own else np.zeros(0)
        if np.abs(np.imag(coefficients)).max(initial=0.0) > 1e-9 * np.abs(coefficients).max(initial=1.0):
            raise SpecError("options.poles", context.poles, Message("observer.poles.not-conjugate"))
        gains += [float(c) for c in np.real(coefficients)]
    return gains
