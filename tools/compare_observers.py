"""Compare all observers with their default gains on faults of several kinds: `python -m tools.compare_observers`.

Prints the table of docs/which-observer.md: for each case and observer the root mean square error of the faults over the
second half of the run, in typical faults, and whether an assumption failed. An observer that leaves out one of the
case's faults has its whole size as the error of that fault.
"""

import sys
from dataclasses import dataclass

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds, observer
from thetascope_schemas import ResolvedExperiment

MOTOR = {"y_current": {"std": 0.05, "sample_time": 0.005}, "y_speed": {"std": 0.5, "sample_time": 0.005}}
STEP = {"shape": "step", "onset": 4.0}
PRBS = {"kind": "prbs", "low": 6, "high": 18, "hold": 0.3, "seed": 3}


@dataclass(frozen=True)
class Case:
    """A heading, the library experiment that it changes, the changes, and the channels to estimate."""

    heading: str
    experiment: str
    changes: dict
    channels: str


CASES = (
    Case(
        "at rest",
        "dc-motor",
        {
            "inputs": {"voltage": {"kind": "constant", "value": 12}},
            "faults": [STEP | {"channel": "load_torque", "size": 0.05}, STEP | {"channel": "gain_loss", "size": 0.1}],
            "horizon": 12,
        },
        "gain_loss,load_torque",
    ),
    Case(
        "moving fault",
        "dc-motor",
        {
            "inputs": {"voltage": {"kind": "constant", "value": 12}},
            "faults": [
                {"channel": "load_torque", "shape": "sine", "onset": 1, "size": 0.05, "frequency": 1.0},
            ],
            "horizon": 12,
        },
        "gain_loss,load_torque",
    ),
    Case(
        "four faults",
        "dc-motor",
        {
            "inputs": {"voltage": PRBS},
            "faults": [
                STEP | {"channel": "gain_loss", "size": 0.1},
                STEP | {"channel": "load_torque", "size": 0.05},
                STEP | {"channel": "current_bias", "size": 0.5},
                STEP | {"channel": "friction_increase", "size": 0.0002},
            ],
            "horizon": 20,
        },
        "gain_loss,load_torque,friction_increase,current_bias",
    ),
    Case(
        "hidden states",
        "quadruple-tank",
        {"faults": [{"channel": "pump1", "shape": "step", "onset": 500, "size": 0.1}], "horizon": 2000},
        "pump1,pump2",
    ),
    Case("both directions", "friction-motor", {}, "friction"),
    Case("one output", "zhao-2012", {}, "theta1,theta2,theta3"),
)


def main() -> int:
    """Print the table as Markdown."""
    print("| Observer |", " | ".join(case.heading for case in CASES), "|")
    print("|---" * (len(CASES) + 1) + "|")
    for kind in kinds():
        if observer(kind).estimates_theta:
            print(f"| `{kind}` |", " | ".join(figure(case, kind) for case in CASES), "|", flush=True)
    return 0


def figure(case: Case, kind: str) -> str:
    """Return the error of an observer in a case; – where it cannot be built."""
    spec = library.resolve(library.experiment(case.experiment)).model_dump(mode="json")
    spec |= {"figures": [], "commands": [], "diagnosis": {"enabled": False}, "record": None, **case.changes}
    for options in ({"channels": case.channels}, {}):  # those that it can tell apart, where all are too many
        spec["observers"] = [{"label": "o", "kind": kind, "options": options}]
        try:
            resolved = ResolvedExperiment.model_validate(spec)
            result = run(prepare(resolved).stages)
        except SpecError:
            continue
        report = result.observers[0]
        if report.diverged is not None:
            return "diverged"
        failed = any(check.verdict == "fails" for check in report.checks)
        typical = {channel.name: channel.typical for channel in resolved.plant.channels}
        return f"{error(result, case.channels.split(','), typical):.3f}{'*' if failed else ''}"
    return "–"


def error(result: Result, channels: list[str], typical: dict[str, float]) -> float:
    """Return the root mean square error over the second half of the run, in typical faults."""
    squares = []
    for channel in channels:
        wrong = -result.column(f"theta.{channel}")
        if f"o.theta.{channel}" in result.names:
            wrong = wrong + result.column(f"o.theta.{channel}")
        squares.append(np.square(wrong[len(wrong) // 2 :] / typical[channel]).mean())
    return float(np.sqrt(np.mean(squares)))


if __name__ == "__main__":
    sys.exit(main())
