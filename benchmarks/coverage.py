"""Count how often the detector's 95 % intervals hold the truth: ``python -m benchmarks.coverage [SEEDS] [NAME …]``.

Ten plants, linear and nonlinear, two of them closed loops, with one lasting step each. Onsets lie between two rows in
half of them. `thetascope trial` counts the same for one experiment.
"""

import sys

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.seed_trial import trial
from thetascope_schemas import Experiment

SINE = {"kind": "sine", "amplitude": 1, "frequency": 0.3}
ACTUATOR, SENSOR = {"kind": "actuator", "enters": {"x": "1"}}, {"kind": "sensor", "enters": {"y": "1"}}
CASES: dict[str, tuple[dict[str, str], dict, float]] = {  # dynamics, channel, onset
    "linear": ({"x": "u - x"}, ACTUATOR, 15.0),
    "drag": ({"x": "u - x*abs(x)"}, ACTUATOR, 15.0),
    "cubic": ({"x": "u - x^3"}, ACTUATOR, 15.004),
    "root": ({"x": "u - x*abs(x)^0.5"}, ACTUATOR, 15.0),
    "sensor of a linear plant": ({"x": "u - x"}, SENSOR, 15.004),
    "sensor of a cubic plant": ({"x": "u - x^3"}, SENSOR, 15.0),
    "pendulum": ({"x": "u - 2*sin(z) - 0.5*x", "z": "x"}, ACTUATOR, 15.004),
    "van der Pol": ({"x": "(1 - z^2)*x - z + u", "z": "x"}, ACTUATOR, 15.0),
    "proportional loop": ({"x": "-x + 4*(u - x)"}, ACTUATOR, 15.004),
    "integral loop": ({"x": "-x + z", "z": "2*(u - x) - 0.2*z"}, ACTUATOR, 15.0),
}


def experiment(name: str) -> Experiment:
    """Return the experiment of one case."""
    dynamics, channel, onset = CASES[name]
    plant = {
        "id": "coverage",
        "states": [{"name": s, "domain": [-5, 5]} for s in dynamics],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "z" if name in ("pendulum", "van der Pol") else "x"}],
        "dynamics": dynamics,
        "channels": [{"name": "fault", "typical": 0.2, **channel}],
    }
    spec = {
        "id": "coverage",
        "plant": plant,
        "inputs": {"u": SINE},
        "horizon": 30,
        "step": 0.01,
        "noise": {"y": {"std": 0.01, "sample_time": 0.01}},
        "faults": [{"channel": "fault", "shape": "step", "onset": onset, "size": 0.2}],
        "observers": [],
    }
    return Experiment.model_validate(spec)


def main(arguments: list[str]) -> int:
    """Print a line for each case."""
    seeds = int(arguments[0]) if arguments else 100
    for name in arguments[1:] or CASES:
        result = trial(prepare(library.resolve(experiment(name))), seeds)
        (tally,) = result.tallies
        held = [f"{c.held}/{c.reported}" for c in (tally.size, tally.onset)]
        print(f"| {name} | {held[0]} | {held[1]} |", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
