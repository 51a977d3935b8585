"""A simulated run, exported and read again as a record, for tests of runs on records."""

from collections.abc import Callable

import numpy as np

from thetascope import library
from thetascope.assembly import RecordBytes, carry_out, prepare, with_rows
from thetascope.diagnosis.recording import Recording
from thetascope.engine.model.result import Result
from thetascope.export import csv_chunks, select
from thetascope_schemas import Experiment, Plant

ID = "0" * 32


def inputs_of(plant: Plant, step: float, rows: int) -> dict[str, dict]:
    """Return steps of every input at rows, so that its values between rows are those of the row before."""
    times = [step * round(share * rows) for share in (0.3, 0.6)]
    return {
        u.name: {"kind": "steps", "times": times, "values": [v * (u.default or 1.0) for v in (1.0, 1.2, 0.9)]}
        for u in plant.inputs
    }


def simulated(plant: Plant, step: float, rows: int, kinds: list[str], **changes: object) -> Result:
    """Return a run of observers with one fault, measured at every base step."""
    channel = plant.channels[0]
    fault = {"channel": channel.name, "shape": "step", "onset": step * round(0.5 * rows), "size": channel.typical}
    spec = Experiment.model_validate(
        common(plant, step, rows, kinds)
        | {
            "inputs": inputs_of(plant, step, rows),
            "signals": {s.name: {"kind": "constant", "value": 0.5} for s in plant.signals},
            "faults": [fault],
            "measurement": {"mode": "sampled", "period": step},
            "diagnosis": {"enabled": False},
            "seed": 3,
        }
        | changes
    )
    return prepare(library.resolve(spec)).run()


def common(plant: Plant, step: float, rows: int, kinds: list[str]) -> dict:
    """Return the fields that a simulated and a recorded run share; substeps are given, because both choose them by
    errors that differ."""
    return {
        "plant": plant,
        "horizon": step * (rows - 1),
        "step": step,
        "record": step,
        "evaluate": step,
        "substeps": None if plant.time.kind == "discrete" else 8,
        "noise": {o.name: {"std": 0.01, "sample_time": step} for o in plant.outputs},
        "observers": [{"label": kind, "kind": kind} for kind in kinds],
    }


def exported(run: Result) -> bytes:
    """Return times, inputs, signals and outputs of a run as CSV."""
    names = [n for n in run.names if n == "t" or n.startswith(("u.", "signal.", "y."))]
    return b"".join(csv_chunks(select(run, names)))


def on_record(
    plant: Plant,
    data: bytes,
    step: float,
    rows: int,
    kinds: list[str],
    **changes: object,
) -> Result:
    """Return the run of observers on a record in a file, without its diagnosis unless `changes` ask for it."""
    fields = common(plant, step, rows, kinds) | {"diagnosis": {"enabled": False}, "truth": {"record": {"id": ID}}}
    spec = library.resolve(Experiment.model_validate(fields | changes))
    return carry_out(prepare(with_rows(spec.with_readings(RecordBytes("rig.csv", data)))))


def as_csv(recording: Recording, names: list[str]) -> bytes:
    """Return rows as CSV; missing cells are empty. ``names``: of inputs, then outputs."""
    lines = [",".join(["t", *names])]
    for t, u, y in zip(recording.t, recording.u, recording.y, strict=True):
        lines.append(",".join("" if np.isnan(v) else repr(float(v)) for v in (t, *u, *y)))
    return "\n".join(lines).encode()


def changed(data: bytes, change: Callable[[list[list[str]]], list[list[str]]]) -> bytes:
    """Return a CSV file with its rows of cells changed."""
    head, *lines = data.decode().strip().split("\n")
    rows = change([line.split(",") for line in lines])
    return "\n".join([head, *(",".join(row) for row in rows)]).encode()
