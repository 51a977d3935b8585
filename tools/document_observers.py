"""Write docs/observers.md from the observers' own files: `python -m tools.document_observers`.

Equations and remarks are the modules' docstrings, gains and options what the observers declare, and the assumptions
those that a short run of each reports. A test compares the file with what this would write.
"""

import inspect
import sys
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.model.result import Check
from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.declaration import Gain, Observer, Option
from thetascope_schemas import Experiment

FILE = Path(__file__).resolve().parents[1] / "docs" / "observers.md"

#: A library experiment on whose plant each kind can be built; it is run for a moment.
SHOWN_ON = {
    "high-gain": "zhao-2012",
    "zhao-adaptive": "zhao-2012",
    "nonsmooth-adaptive": "shen-hu-2015",
    "linear-adaptive": "shen-hu-2015",
    "reduced-order": "reduced-order-mimo",
    "full-order": "reduced-order-mimo",
    "sandwich-nonsmooth": "zhou-tan-2012",
    "sandwich-conventional": "zhou-tan-2012",
    "adaptive-kalman": "zhao-2012",
    "adaptive-kalman-discrete": "zhao-2012",
    "joint-ekf": "zhao-2012",
    "joint-ukf": "zhao-2012",
}

HEAD = """# Observers

Written by `make docs` from the observers' files in `backend/thetascope/engine/observers/`; change those, not this page.

Notation: x̂, θ̂, ŷ are estimates; Φ and Ψ are the columns by which faults θ enter the state and the output equations;
A and C are the Jacobians of the state and the output equations at the estimate; n states, m outputs, p fault channels.
An observer sees t, the inputs u, the known signals φ and the measured y, nothing else. Inside an observer the
plant's model is saturated to the plant's physical domain; estimates are not.

In an experiment: `observers: [{label: mine, kind: adaptive-kalman, gains: {lambda: 2}, initial: {x1: 0}}]`.
`options.channels` lists the fault channels to estimate (default: all). A gain per state, output or fault takes a list.
A default "from the plant" depends on the plant, the declared noise or the sampling; `GET /api/catalogue` has all of this
as JSON.
"""


def main() -> int:
    """Write the page."""
    FILE.write_text(page(), encoding="utf-8")
    print(FILE)
    return 0


def page() -> str:
    """The whole page as Markdown."""
    found = [observer(kind) for kind in kinds()]
    index = "\n".join(f"| [`{o.id}`](#{o.id}) | {o.summary} | {o.source} |" for o in found)
    table = f"| Kind | What it is for | Source |\n|---|---|---|\n{index}\n"
    return "\n".join([HEAD, table, *(section(o) for o in found)])


def section(kind: Observer) -> str:
    """One observer."""
    module = import_module(kind.write.__module__)
    times = {"continuous": "in continuous time", "discrete": "at the sample period", "plant": "in the plant's own time"}
    estimates = "the state and the faults" if kind.estimates_theta else "the state"
    file = "backend/" + module.__name__.replace(".", "/") + ".py"
    parts = [
        f'## <a id="{kind.id}"></a>{kind.title}\n',
        f"`{kind.id}`, in [{Path(file).name}](../{file}); runs {times[kind.time]}, estimates {estimates}.\n",
        f"{module.__doc__.strip()}\n",
        f"What runs, as it is written there:\n\n```python\n{inspect.getsource(kind.write).strip()}\n```\n",
        table("Gain | Meaning | Default | Bounds | Unit", map(gain, kind.gains)),
        table("Option | Meaning | Default | Values", map(option, kind.options)),
        "Checked on every run:\n",
        "\n".join(f"- {check.name} ({check.source})" for check in checks(kind.id)) + "\n",
    ]
    return "\n".join(part for part in parts if part)


def table(head: str, rows: Iterable[str]) -> str:
    """A Markdown table, or nothing where there are no rows."""
    rows = list(rows)
    return "\n".join([f"| {head} |", "|---" * (head.count("|") + 1) + "|", *rows]) + "\n" if rows else ""


def gain(g: Gain) -> str:
    """A row of the table of gains."""
    symbol = f" ({g.symbol})" if g.symbol else ""
    default = "from the plant" if callable(g.default) else f"{g.default:g}"
    return f"| `{g.name}`{symbol} | {cell(g.meaning)}{size(g)} | {default} | {g.low:g} … {g.high:g} | {g.unit} |"


def size(g: Gain) -> str:
    """How many numbers it takes, in words."""
    each = {"n": "state", "m": "output", "p": "fault channel", "n-m": "state that is not measured"}
    if g.size is None:
        return ""
    return f"; one per {each[g.size]}" if g.size in each else "; a list"


def option(o: Option) -> str:
    """A row of the table of options."""
    default = "from the plant" if callable(o.default) else f"`{o.default}`"
    values = f"{o.low} … {o.high}" if o.kind == "integer" else ", ".join(f"`{c}`" for c in o.choices)
    return f"| `{o.name}` | {cell(o.meaning)} | {default} | {values} |"


def cell(text: str) -> str:
    """Text that may stand in a table."""
    return text.replace("|", "\\|")


def checks(kind: str) -> tuple[Check, ...]:
    """The assumptions that this kind reports."""
    spec = library.experiment(SHOWN_ON[kind]).model_dump(mode="json")
    moment = 50 * spec["step"]
    spec |= {"horizon": moment, "record": spec["step"], "faults": [], "figures": []}
    used = next((o for o in spec["observers"] if o["kind"] == kind), {"label": "one", "kind": kind})
    if observer(kind).time == "discrete":
        spec["measurement"] = {"mode": "sampled", "period": 10 * spec["step"]}
    spec["observers"] = [used]
    return prepare(library.resolve(Experiment.model_validate(spec))).run().observers[0].checks


if __name__ == "__main__":
    sys.exit(main())
