"""A run as a Jupyter notebook that computes it again and compares the numbers."""

import hashlib
import json
import pprint
from typing import Any

from thetascope.engine.model.result import Result
from thetascope_schemas.experiment.experiment import Experiment

_IMPORTS = """import hashlib

import matplotlib.pyplot as plt

import thetascope"""
_RUN = """result = thetascope.run(spec)
frame = result.frame()  # polars; result.frame("pandas") for pandas, result.column(name) for NumPy
frame"""
_PLOT = """t = result.column("t")
faults = [name for name in result.names if name.startswith("theta.")]
shown = faults or [name for name in result.names if name.startswith("y.")]
figure, axes = plt.subplots(len(shown), 1, sharex=True, squeeze=False, figsize=(7, 2 * len(shown)))
for axis, name in zip(axes[:, 0], shown):
    axis.plot(t, result.column(name), "k--", label="true" if faults else "measured")
    for observer in (report.label for report in result.observers):
        if f"{observer}.{name}" in result.names:
            axis.plot(t, result.column(f"{observer}.{name}"), linewidth=1, label=observer)
    axis.set_ylabel(name)
axes[0, 0].legend()
axes[-1, 0].set_xlabel("t in s");"""
_COMPARE = """same = hashlib.sha256(result.data.tobytes()).hexdigest() == "{digest}"
print("The same numbers as the run, bit for bit:", same)"""


def notebook_bytes(result: Result, spec: Experiment, id: str) -> bytes:
    """Return the notebook (nbformat 4.5) of a run: its experiment, the run again, its faults, and the comparison.

    spec: the experiment as posted, with a plant of the library by its id. The digest is that of the run's numbers.
    """
    data = pprint.pformat(spec.model_dump(mode="json", exclude_unset=True), width=110, sort_dicts=False)
    title = f"# {spec.id}\n\nRun `{id}` of Thetascope. The cells compute it again."
    digest = hashlib.sha256(result.data.tobytes()).hexdigest()
    sources = (_IMPORTS, f"spec = {data}", _RUN, _PLOT, _COMPARE.format(digest=digest))
    cells = [_cell("markdown", title, "title"), *(_code(text, place) for place, text in enumerate(sources))]
    notebook = {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "cells": cells,
    }
    return json.dumps(notebook, indent=1, ensure_ascii=False).encode()


def _cell(kind: str, text: str, id: str) -> dict[str, Any]:
    return {"cell_type": kind, "id": id, "metadata": {}, "source": text.splitlines(keepends=True)}


def _code(text: str, place: int) -> dict[str, Any]:
    return _cell("code", text, f"code-{place}") | {"execution_count": None, "outputs": []}
