"""Build problem documents (RFC 9457) from messages, and translate them."""

from thetascope.messages import Message, words
from thetascope.messages.catalogue import DEFAULT, catalogue
from thetascope.runs.specs.refusals import InvalidSpec, sentence
from thetascope_schemas.service.field_error import sentences
from thetascope_schemas.service.run import Problem


def problem(
    status: int, code: Message, remedy: Message | None = None, language: str = "en", instance: str | None = None
) -> Problem:
    """Return the document of a problem; the remedy is by default the problem's own, `code.remedy`."""
    data = code.as_data()
    if remedy is not None and remedy != Message(f"{code.code}.remedy", **code.args):
        data["args"]["remedy"] = remedy.as_data()
    return in_language(Problem(title="", status=status, instance=instance, **data), language)


def refused(error: InvalidSpec, language: str = "en") -> Problem:
    """Return the document for a refused spec."""
    return in_language(Problem(title="", status=422, code="refusal.spec", errors=error.errors), language)


def in_language(document: Problem, language: str) -> Problem:
    """Return a problem document with its sentences in a language.

    The title is the entry `code.title` if it exists, else that of the status. The detail is `problem; remedy`, and for
    a refused spec the first error.
    """
    if not document.code:
        return document
    changes: dict[str, object] = {"title": _title(document).text(language)}
    if document.errors:
        first = sentence(document.errors[0], language)
        more = len(document.errors) - 1
        changes["detail"] = Message("refusal.more", first=first, n=more).text(language) if more else first
        changes["errors"] = tuple(error.rendered(words(language)) for error in document.errors)
    else:
        text, remedy = sentences(document.code, document.args, words(language))
        changes["detail"] = Message("refusal.sentence", problem=text, remedy=remedy).text(language)
    return document.model_copy(update=changes)


def _title(document: Problem) -> Message:
    own = f"{document.code}.title"
    return Message(own if own in catalogue(DEFAULT).templates else f"http.{document.status}")
