"""Write docs/observers.md, and the README's counts, from the registry: `python -m tools.document_observers`.

Equations and remarks come from the modules' docstrings, gains and options from the observers' declarations, and the
assumptions from a short run of each observer. Tests compare both files with the output of this module.
"""

import inspect
import re
import sys
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Check
from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.observers.support.declaration import Gain, Observer, Option
from thetascope_schemas import Experiment, Plant

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / "docs" / "observers.md"
README = ROOT / "README.md"

WORDS = [
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
    "twenty",
]

HEAD = """# Observers

Written by `make docs` from the observers' files in `backend/thetascope/engine/observers/`; change those, not this page.

Notation: x̂, θ̂, ŷ are estimates; Φ and Ψ are the columns by which faults θ enter the state and the output equations;
A and C are the Jacobians of the state and the output equations at the estimate; n states, m outputs, p fault channels.
An observer sees t, the inputs u, the known signals φ and the measured y, nothing else. Inside an observer the
plant's model is saturated to the plant's physical domain; estimates are not.

In an experiment: `observers: [{label: mine, kind: adaptive-kalman, gains: {lambda: 2}, initial: {x1: 0}}]`.
`options.channels` lists the fault channels to estimate (default: all, or those that the observer can tell apart). A
gain per state, output or fault takes a list. A default "from the plant" depends on the plant, the declared noise or the
sampling; `GET /api/catalogue` has all of this as JSON. [Which observer?](which-observer.md) helps to choose.
"""


def main() -> int:
    """Write docs/observers.md and the README's counts."""
    FILE.write_text(page(), encoding="utf-8")
    README.write_text(counted(README.read_text(encoding="utf-8")), encoding="utf-8")
    print(FILE, README, sep="\n")
    return 0


def counted(text: str) -> str:
    """Return a text with its numbers of observers and plants, written as words, updated."""
    for noun, count in (("observers", len(kinds())), ("plants", len(library.plants()))):
        word = WORDS[count] if count < len(WORDS) else str(count)

        def exact(match: re.Match[str], word: str = word) -> str:
            return (word.capitalize() if match[1][0].isupper() else word) + match[2]

        text = re.sub(rf"\b(\d+|{'|'.join(WORDS[1:])})( {noun}\b)", exact, text, flags=re.IGNORECASE)
    return text


def page() -> str:
    """Return the whole page as Markdown."""
    observers = [observer(kind) for kind in kinds()]
    index = "\n".join(f"| [`{o.id}`](#{o.id}) | {cell(str(o.summary))} | {o.source} |" for o in observers)
    table = f"| Kind | Purpose | Source |\n|---|---|---|\n{index}\n"
    return "\n".join([HEAD, table, *(section(o) for o in observers)])


def section(kind: Observer) -> str:
    """Return the section of one observer."""
    module = import_module(kind.write.__module__)
    times = {"continuous": "in continuous time", "discrete": "at the sample period", "plant": "in the plant's own time"}
    estimates = "the state and the faults" if kind.estimates_theta else "the state"
    estimates += ", gives residuals" if kind.residuals else ""
    file = "backend/" + module.__name__.replace(".", "/") + ".py"
    parts = [
        f'## <a id="{kind.id}"></a>{kind.title}\n',
        f"`{kind.id}`, in [{Path(file).name}](../{file}); runs {times[kind.time]}, estimates {estimates}.\n",
        f"Take it {kind.when}.\n",
        f"{module.__doc__.strip()}\n",
        f"What runs, as it is written there:\n\n```python\n{inspect.getsource(kind.write).strip()}\n```\n",
        table("Gain | Meaning | Default | Bounds | Unit", map(gain, kind.gains)),
        table("Option | Meaning | Default | Values", map(option, kind.options)),
        "Checked on every run:\n",
        "\n".join(f"- {check.name} ({check.source})" for check in checks(kind.id)) + "\n",
    ]
    return "\n".join(part for part in parts if part)


def table(head: str, rows: Iterable[str]) -> str:
    """Return a Markdown table, or nothing if there are no rows."""
    rows = list(rows)
    return "\n".join([f"| {head} |", "|---" * (head.count("|") + 1) + "|", *rows]) + "\n" if rows else ""


def gain(g: Gain) -> str:
    """Return a row of the table of gains."""
    symbol = f" ({g.symbol})" if g.symbol else ""
    default = "from the plant" if callable(g.default) else f"{g.default:g}"
    return f"| `{g.name}`{symbol} | {cell(str(g.meaning))}{size(g)} | {default} | {bounds(g)} | {g.unit.words} |"


def bounds(g: Gain) -> str:
    """Return the bounds of a gain."""
    if g.positive:
        return "> 0"
    if g.low is None:
        return "none"
    return f"≥ {g.low:g}" if g.high is None else f"{g.low:g} … {g.high:g}"


def size(g: Gain) -> str:
    """Return in words the number of values in a gain."""
    each = {"n": "state", "m": "output", "p": "fault channel", "n-m": "state that is not measured"}
    if g.size is None:
        return ""
    rows = each.get(str(g.size))
    if g.columns is not None:
        return f"; a matrix, one row per {rows} and one column per {each.get(str(g.columns))}"
    return f"; one per {rows}" if rows else "; a list"


def option(o: Option) -> str:
    """Return a row of the table of options."""
    default = "from the plant" if callable(o.default) else "none" if o.default is None else f"`{o.default}`"
    values = f"{o.low} … {o.high}" if o.kind == "integer" else ", ".join(f"`{c}`" for c in o.choices)
    return f"| `{o.name}` | {cell(str(o.meaning))} | {default} | {values} |"


def cell(text: str) -> str:
    """Return text escaped for a table cell."""
    return text.replace("|", "\\|")


def checks(kind: str) -> tuple[Check, ...]:
    """Return the assumptions that a kind reports, from a short run on the first experiment it can be built for.

    Experiments that use the kind come first, of these small plants, which compile fast. Raises the last SpecError if it
    can be built for no library experiment.
    """
    experiments = [library.experiment(name) for name in library.experiments()]
    experiments.sort(key=lambda e: (all(o.kind != kind for o in e.observers), *size_of(library.resolve(e).plant)))
    refusal: Exception | None = None
    for experiment in experiments:
        try:
            return prepare(library.resolve(moment_of(experiment, kind))).run().observers[0].checks
        except SpecError as error:
            refusal = error
    raise refusal or LookupError("the library has no experiments")


def size_of(plant: Plant) -> tuple[int, int]:
    """Return how many states and fault channels a plant has."""
    return len(plant.states), len(plant.channels)


def moment_of(experiment: Experiment, kind: str) -> Experiment:
    """Return the first fifty steps of an experiment, with one observer of a kind."""
    spec = experiment.model_dump(mode="json")
    spec |= {
        "horizon": 50 * spec["step"],
        "record": None,
        "evaluate": spec["step"],
        "faults": [],
        "figures": [],
        "commands": [],
    }
    if observer(kind).time == "discrete":
        spec["measurement"] = {"mode": "sampled", "period": 10 * spec["step"]}
    spec["observers"] = [next((o for o in spec["observers"] if o["kind"] == kind), {"label": "one", "kind": kind})]
    return Experiment.model_validate(spec)


if __name__ == "__main__":
    sys.exit(main())
