"""A paper of the library with its equations as MathML."""

from functools import lru_cache

from thetascope import library
from thetascope_schemas.service.learning.paper import PaperPage


@lru_cache(maxsize=16)
def paper_page(id: str) -> PaperPage:
    """Return a paper of the library and MathML of its equations. Raises KeyError for an id that the library lacks."""
    from latex2mathml.converter import convert  # takes a tenth of a second, and no run needs it

    paper = library.papers()[id]
    return PaperPage(paper=paper, equations=tuple(convert(one.tex, display="block") for one in paper.equations))
