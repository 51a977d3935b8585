"""Write docs/errata.md from the papers of the library: `python -m tools.document_papers`. A test compares them."""

import sys
from pathlib import Path

from thetascope import library
from thetascope_schemas.service.learning.paper import Paper

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / "docs" / "errata.md"
HEAD = """# Errata of the four papers

Written by `make docs` from `backend/thetascope/library/papers`; change those files, not this page.

Each of the four papers has misprints, or omits numbers without which its example cannot be run. This page lists the
reading used here, the reason, and the experiment that shows it where there is one. The page `/learn/papers/` has the
same with the equations, the figures, and a button that runs the evidence. The report of a run lists the errata of its
paper.
"""


def page() -> str:
    """Return the text of docs/errata.md."""
    return "\n".join([HEAD, *(_section(paper) for paper in library.papers().values())])


def _section(paper: Paper) -> str:
    runs = [name for name in library.experiments() if name == paper.id or name.startswith(f"{paper.id}-")]
    cited = paper.citation
    lines = [
        f"## {cited.title.en}",
        "",
        f"{cited.authors.en}: {cited.journal.en}. Experiments: {', '.join(f'`{name}`' for name in runs)}.",
        "",
        paper.reading.en,
        "",
        "| Printed | Used here | Reason |",
        "|---|---|---|",
    ]
    for one in paper.errata:
        shown = f" (`{one.evidence.experiment}`)" if one.evidence else ""
        cells = [text.replace("|", "\\|") for text in (one.printed.en, one.used.en, one.reason.en + shown)]
        lines.append(f"| {' | '.join(cells)} |")
    for title, sentences in (("What holds", paper.holds), ("What does not", paper.fails)):
        lines += ["", f"**{title}**", "", *(f"- {sentence.en}" for sentence in sentences)]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    FILE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{FILE.relative_to(ROOT)}\n")
