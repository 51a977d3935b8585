"""Errors that say what to do."""

from thetascope.messages.message import Message


class Explained(Exception):
    """An error with a remedy.

    Args:
        problem: why; its remedy is the message whose code is the problem's plus `.remedy`, with its arguments.
    """

    def __init__(self, problem: Message) -> None:
        super().__init__(problem)
        self.problem = problem

    def text(self, language: str = "en") -> str:
        """Return `problem; remedy` in a language."""
        remedy = Message(f"{self.problem.code}.remedy", **self.problem.args)
        return Message("refusal.sentence", problem=self.problem, remedy=remedy).text(language)

    def __str__(self) -> str:
        return self.text()
