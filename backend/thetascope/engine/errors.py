"""Errors that a user's input can cause. Each names the field, the value and the remedy."""

from thetascope.messages import Message
from thetascope.messages.explained import Explained


class ThetascopeError(Exception):
    """Base of all errors that the program raises on purpose."""


class SpecError(ThetascopeError):
    """A plant, experiment or record that is refused.

    Args:
        field: path of the field, for example `dynamics.x1`.
        value: the value of that field.
        problem: what is wrong with the value.
        remedy: how to correct it; by default the message whose code is the problem's plus `.remedy`,
            with its arguments.
    """

    def __init__(self, field: str, value: object, problem: Message, remedy: Message | None = None) -> None:
        if not isinstance(problem, Message):
            raise TypeError("the problem of a SpecError is a Message, so that it can be rendered in every language")
        remedy = remedy or Message(f"{problem.code}.remedy", **problem.args)
        super().__init__(field, value, problem, remedy)  # the arguments, so that the error survives pickling
        self.field, self.value, self.problem, self.remedy = field, value, problem, remedy

    def __str__(self) -> str:
        got = "" if self.value is None else f" (got {_short(self.value)})"
        return f"{self.field}: {self.problem}{got}; {self.remedy}"


class ExpressionError(SpecError):
    """Text that is not an admissible expression. It points at the place.

    Args:
        field: path of the field.
        text: the whole text.
        start, end: the place as a half-open range of characters, counted from 0.
        problem, remedy: as in :class:`SpecError`; the column is added to `problem`.
    """

    def __init__(
        self, field: str, text: str, start: int, end: int, problem: Message, remedy: Message | None = None
    ) -> None:
        self.text, self.start, self.end = text, start, max(end, start + 1)
        self.reason = problem
        remedy = remedy or Message(f"{problem.code}.remedy", **problem.args)
        place = Message("expression.at", problem=problem, column=self.column)
        super().__init__(field, text[self.start : self.end][:60] or None, place, remedy)
        self.args = (field, text, start, end, problem, remedy)

    @property
    def column(self) -> int:
        """The place as people count: the first character is column 1."""
        return self.start + 1

    @property
    def pointer(self) -> str:
        """Two lines: the text around the place, and carets under it."""
        first = max(0, self.start - 40)
        last = min(len(self.text), first + 76)
        head, tail = "…" if first else "", "…" if last < len(self.text) else ""
        line = "".join(char if char.isprintable() else " " for char in self.text[first:last])
        carets = "^" * max(1, min(self.end, last) - self.start)
        return f"{head}{line}{tail}\n{' ' * (len(head) + self.start - first)}{carets}"

    def __str__(self) -> str:
        return f"{self.field}: {self.problem}; {self.remedy}\n" + "\n".join(
            "    " + line for line in self.pointer.split("\n")
        )


class FolderRefused(Explained, ThetascopeError):
    """A folder for files that are executed, in which somebody else could write; the message has a remedy."""


class Cancelled(ThetascopeError):
    """The run was cancelled."""


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:79] + "…"


class Unwatchable(Exception):
    """The detector cannot be used with an experiment; `reason` says why."""

    def __init__(self, reason: Message) -> None:
        super().__init__(reason)
        self.reason = reason
