"""Print a digest of every array that the product computes: ``python -m benchmarks.digests [FILE]``.

A refactoring must not change a number. Run this before and after, and compare the two outputs: every column of every
library experiment, a scripted live session that receives every command, and one diagnosed record. With FILE the digests
are compared with those in the file, and only differences are printed.
"""

import hashlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.record_diagnosis import diagnose_columns
from thetascope.live.session.session import Session
from thetascope_schemas import Experiment
from thetascope_schemas.service.session import (
    AddObserverNow,
    Clear,
    Inject,
    RemoveObserverNow,
    Reset,
    Seek,
    SetGainNow,
    SetNoiseNow,
    SetSignalNow,
)


def main(arguments: list[str]) -> int:
    """Print the digests, or compare them with a file's."""
    digests_by_name = {}
    for name, digest in digests():
        digests_by_name[name] = digest
        if not arguments:
            print(f"{digest}  {name}", flush=True)
    if not arguments:
        return 0
    lines = (line.split("  ", 1) for line in Path(arguments[0]).read_text(encoding="utf-8").splitlines())
    expected = {name: digest for digest, name in lines}
    different = [
        name for name in expected.keys() | digests_by_name.keys() if expected.get(name) != digests_by_name.get(name)
    ]
    for name in sorted(different):
        print(f"{name}: {expected.get(name, 'absent')} in the file, {digests_by_name.get(name, 'absent')} now")
    print(f"{len(digests_by_name)} digests, {len(different)} different")
    return 1 if different else 0


def digests() -> Iterator[tuple[str, str]]:
    """Yield (name, digest) of every array, in a fixed order."""
    for name in sorted(library.experiments()):
        yield from run_digests(name)
    yield from session_digests()
    yield from record_digests()


def run_digests(name: str) -> Iterator[tuple[str, str]]:
    """Yield the digests of one experiment's columns, and of the numbers of its diagnosis."""
    result = prepare(library.resolve(library.experiment(name))).run()
    for column, data in zip(result.names, result.data, strict=True):
        yield f"{name}/{column}", digest_of(data)
    yield f"{name}/diagnosis", numbers_digest(result.diagnosis)
    yield f"{name}/checks", numbers_digest([[c.value, c.threshold] for o in result.observers for c in o.checks])


def session_digests() -> Iterator[tuple[str, str]]:
    """Yield the digests of a session that receives every command, after each of them."""
    session = Session(library.resolve(library.experiment("zhao-2012")))
    fault = {"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02}
    ekf = {"label": "ekf", "kind": "joint-ekf"}
    script = (
        AddObserverNow(id=1, observer=ekf),
        Inject(id=2, fault=fault),
        SetGainNow(id=3, observer="adaptive", gain="rho", value=8),
        SetNoiseNow(id=4, output="y", std=0.002, sample_time=0.01),
        SetSignalNow(id=5, name="u", signal={"kind": "constant", "value": 0.05}),
        Clear(id=6, channel="theta3"),
        RemoveObserverNow(id=7, label="ekf"),
        Seek(id=8, t=4.0),
        Inject(id=9, fault=fault | {"channel": "theta1", "size": 0.01}),
        Reset(id=10),
    )
    for command in script:
        advanced = advance(session, session.row + 200)
        session.handle(command)
        yield f"session/{command.id}-{command.type}", digest_of(*advanced)
    yield "session/end", digest_of(*advance(session, 4000))
    yield "session/history", digest_of(session.rows(0, session.row))
    events = [(e.kind, e.subject, e.observer) for e in session.log]
    yield "session/events", hashlib.sha256(json.dumps(events).encode()).hexdigest()[:16]
    yield "session/log", numbers_digest([[e.row, e.t, e.value] for e in session.log])


def advance(session: Session, row: int) -> list[np.ndarray]:
    """Advance a session to a row; return the blocks of columns."""
    blocks = []
    while session.row < row and not session.ended:
        blocks.append(session.advance(row - session.row))
    return blocks


def record_digests() -> Iterator[tuple[str, str]]:
    """Yield the digest of one record's diagnosis."""
    spec = library.experiment("friction-motor")
    changes = {"observers": [], "figures": [], "diagnosis": {"enabled": False}, "seed": 5}
    run = prepare(library.resolve(Experiment.model_validate(spec.model_dump() | changes))).run()
    columns = {c: run.column(c) for c in run.names if c == "t" or c.startswith(("u.", "signal.", "y."))}
    plant = library.plant("friction-motor")
    diagnosis = diagnose_columns(plant, columns)
    yield "record/friction-motor", numbers_digest(diagnosis.model_dump())


def digest_of(*arrays: np.ndarray) -> str:
    """Return the first 16 hexadecimal digits of the SHA-256 of arrays' bytes and shapes."""
    hashed = hashlib.sha256()
    for array in arrays:
        hashed.update(str((array.shape, array.dtype.str)).encode())
        hashed.update(np.ascontiguousarray(array).tobytes())
    return hashed.hexdigest()[:16]


def numbers_digest(data: object) -> str:
    """Return the digest of all numbers in nested plain data, in the order of sorted keys.

    Texts and the arguments of messages (dictionaries with a code) do not count: words may change.
    """
    numbers: list[float] = []

    def walk(value: object) -> None:
        if isinstance(value, dict):
            for key in () if "code" in value else sorted(value):
                walk(value[key])
        elif isinstance(value, list | tuple):
            for item in value:
                walk(item)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            numbers.append(float(value))

    walk(data)
    return digest_of(np.array(numbers))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
