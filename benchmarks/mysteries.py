"""Statistics of mysteries: how they are spread, what answers earn, and an independent check of what can be told.

    python -m benchmarks.mysteries 200 --fits 20

draws the mysteries of the seeds 0, 1, …, and grades a perfect answer, the detector's and three ways to guess. For
`--fits` of them, runs of the whole experiment with the two hardest rivals are fitted by another search, with SciPy,
and compared with what the service says could be told.
"""

import argparse
from collections import Counter, defaultdict

import numpy as np
from scipy.optimize import minimize_scalar

from thetascope.assembly import prepare
from thetascope.challenge import Challenge, challenge, detector_answer, experiment_of, grade
from thetascope.challenge.experiments import setup_plant, sizes_of
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, HiddenFault

OFFSETS = (-12, -3, 0, 3)  # rows from the true onset at which a rival begins


def perfect(found: Challenge) -> ChallengeAnswer:
    """Return the answer that earns all points."""
    truth = found.truth
    if truth.fault is None:
        return ChallengeAnswer(verdict="none", at=truth.end)
    left, at, fault = truth.alike(truth.end), truth.told_from(), truth.fault
    if len(left) > 1:
        return ChallengeAnswer(verdict="cannot-be-told", alike=tuple(sorted(left)), at=at)
    return ChallengeAnswer(verdict="channel", channel=fault.channel, onset=fault.onset, size=fault.size, at=at)


def guesses(found: Challenge, random: np.random.Generator) -> dict[str, ChallengeAnswer]:
    """Return answers of people who do not look at the record."""
    setup, end = found.drawn.setup, found.truth.end
    suspect = setup.suspects[int(random.integers(len(setup.suspects)))]
    low, high = sizes_of(setup_plant(setup.id), suspect)
    size, at = float(random.uniform(low, high)), float(random.uniform(0.2, 1.0) * end)
    return {
        "any suspect": ChallengeAnswer(verdict="channel", channel=suspect.channel, size=size, at=at),
        "nothing is wrong": ChallengeAnswer(verdict="none", at=at),
        "none can be told": ChallengeAnswer(
            verdict="cannot-be-told", alike=tuple(s.channel for s in setup.suspects), at=at
        ),
    }


def hardest(found: Challenge, count: int = 2) -> list[tuple[str, bool]]:
    """Return the rivals that fitted longest, and whether they fit until the end."""
    rivals = [rival for rival in found.truth.rivals if rival.channel]
    rivals.sort(key=lambda rival: np.inf if rival.until is None else rival.until)
    return [(rival.channel, rival.until is None) for rival in rivals[-count:]]


def separation(found: Challenge, channel: str) -> float:
    """Return how many deviations separate a rival from the truth at the end, by a search over runs without noise."""
    drawn = found.drawn
    setup, fault = drawn.setup, drawn.fault
    assert fault is not None, "there is a fault"
    target = outputs(found, fault)
    suspect = next(s for s in setup.suspects if s.channel == channel)
    ends = [end for end in sizes_of(setup_plant(setup.id), suspect) if end]
    best = np.inf
    for duration in (None, setup.ramp):
        for offset in OFFSETS:
            onset = round(fault.onset + offset * setup.record, 9)
            for end in ends if 0 <= onset < setup.horizon else ():

                def distance(size: float, onset: float = onset, duration: float | None = duration) -> float:
                    shape = "ramp" if duration else "step"
                    rival = HiddenFault(channel=channel, shape=shape, onset=onset, size=size, duration=duration)
                    return float(np.sqrt(((outputs(found, rival) - target) ** 2).sum()))

                fit = minimize_scalar(distance, bounds=sorted((0.0, end)), method="bounded", options={"maxiter": 12})
                best = min(best, float(fit.fun))
    return best


def outputs(found: Challenge, fault: HiddenFault) -> np.ndarray:
    """Return the readings without noise in deviations of the noise, from a run of the whole experiment."""
    setup = found.drawn.setup
    spec = experiment_of(setup, found.drawn.program, fault, 0).model_copy(update={"noise": {}})
    result = prepare(spec).run()
    return np.stack([result.column(f"y.{y.name}") / setup.noise[y.name].std for y in spec.plant.outputs], axis=1)


def main() -> int:
    """Print the statistics."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="?", default=200)
    parser.add_argument("--fits", type=int, default=20)
    asked = parser.parse_args()
    random = np.random.default_rng(1)
    scores, kinds, onsets, sizes = defaultdict(list), Counter(), [], []
    by_kind = defaultdict(list)
    fitted, agreed = 0, 0
    for seed in range(asked.seeds):
        found = challenge(f"mystery:{seed}")
        fault, truth = found.truth.fault, found.truth
        kind = "nothing" if fault is None else "alike" if len(truth.alike(truth.end)) > 1 else "told"
        kinds[kind] += 1
        answers = {"perfect": perfect(found), "detector": detector_answer(found.drawn), **guesses(found, random)}
        for who, answer in answers.items():
            scores[who].append(grade(answer, truth).total)
        by_kind[kind].append(scores["detector"][-1])
        if fault is None:
            continue
        kinds[f"{found.drawn.setup.id} {fault.channel}"] += 1
        kinds[fault.shape] += 1
        onsets.append(fault.onset / truth.end)
        suspect = next(s for s in found.drawn.setup.suspects if s.channel == fault.channel)
        sizes.append(np.log(abs(fault.size) / suspect.low) / np.log(suspect.high / suspect.low))
        if asked.fits and seed % max(1, asked.seeds // asked.fits) == 0:
            for channel, alike in hardest(found):
                fitted, agreed = fitted + 1, agreed + ((separation(found, channel) < 5.0) == alike)
    print("drawn:", dict(kinds))
    for name, values in (("onset, share of the record", onsets), ("size, from smallest to largest", sizes)):
        print(name, np.round(np.quantile(values, [0, 0.25, 0.5, 0.75, 1]), 2))
    for who, values in scores.items():
        quartiles = np.quantile(values, [0.25, 0.5, 0.75])
        print(f"{who}: mean {np.mean(values):.1f}, quartiles {quartiles}, least {min(values)}")
    print("detector by kind:", {kind: round(float(np.mean(values)), 1) for kind, values in by_kind.items()})
    print(f"independent fits that agree: {agreed} of {fitted}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
