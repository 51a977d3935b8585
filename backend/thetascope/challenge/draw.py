"""Draw a challenge from a key: a plant, an input, and a fault in one of its suspects, or none."""

import hashlib
from dataclasses import dataclass

import numpy as np

from thetascope import library
from thetascope.challenge.experiments import setup_plant
from thetascope.challenge.told import deviations_at_end
from thetascope_schemas.service.learning.challenge import HiddenFault
from thetascope_schemas.service.learning.mystery import MysterySetup

_NOTHING = 1 / 8  # share of challenges without a fault
_GRADUAL = 1 / 4  # share of faults that are ramps
_BEGIN = (0.2, 0.6)  # share of the record at which faults begin
_SEEN = 10.0  # standard deviations of the noise by which a fault is seen at the end, at least
_TRIES = 20


@dataclass(frozen=True)
class Drawn:
    """A challenge: a set-up, the place of one of its inputs, the hidden fault, and the seed of its noise."""

    setup: MysterySetup
    program: int
    fault: HiddenFault | None
    seed: int


def draw(key: str, setup: str | None = None) -> Drawn:
    """Return the challenge of a key; the same key draws the same. `setup`: the set-up, if it is not drawn, too.

    A key that must not be guessed has to be secret: whoever runs this program and knows the key knows the truth.
    """
    digest = hashlib.sha256(f"thetascope challenge {key}".encode()).digest()
    random = np.random.default_rng(list(digest))
    setups = list(library.mysteries().values())
    drawn = setups[int(random.integers(len(setups)))]
    if setup is not None:
        drawn = library.mysteries()[setup]
    program = int(random.integers(len(drawn.inputs)))
    seed = int(random.integers(2**31))
    if random.random() < _NOTHING:
        return Drawn(drawn, program, None, seed)
    for _ in range(_TRIES):
        fault = _fault(drawn, random)
        if deviations_at_end(drawn.id, program, fault) >= _SEEN:
            return Drawn(drawn, program, fault, seed)
    return Drawn(drawn, program, None, seed)


def _fault(setup: MysterySetup, random: np.random.Generator) -> HiddenFault:
    suspect = setup.suspects[int(random.integers(len(setup.suspects)))]
    low, high = next(c.bounds for c in setup_plant(setup.id).channels if c.name == suspect.channel)
    size = float(np.exp(random.uniform(np.log(suspect.low), np.log(suspect.high))))
    if low is None or (low < 0 and (high is None or high > 0) and random.random() < 0.5):
        size = -size
    gradual = bool(random.random() < _GRADUAL)
    rows = setup.horizon / setup.record
    onset = round(random.uniform(_BEGIN[0] * rows, _BEGIN[1] * rows)) * setup.record
    return HiddenFault(
        channel=suspect.channel,
        shape="ramp" if gradual else "step",
        onset=round(onset, 9),
        size=float(f"{size:.3g}"),
        duration=setup.ramp if gradual else None,
    )
