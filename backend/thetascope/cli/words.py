"""The language of the command line: `--language`, else that of the environment, else English."""

import os
from collections.abc import Mapping, Sequence
from typing import Any

from thetascope.messages import Message, text_of
from thetascope.messages.catalogue import negotiate

_VARIABLES = ("LC_ALL", "LC_MESSAGES", "LANG")


class Words:
    """The sentences of the command line in one language; called with a code and arguments."""

    def __init__(self, language: str = "en") -> None:
        self.language = language

    def __call__(self, code: str, /, **args: Any) -> str:
        """Return the sentence of a code."""
        return Message(code, **args).text(self.language)

    def text(self, value: Any) -> str:
        """Return a message, prose in several languages or plain text in this language."""
        return text_of(value, self.language)

    def head(self, names: Sequence[str]) -> list[str]:
        """Return the column headings of a table."""
        return [self(f"cli.head.{name}") for name in names]


def chosen_language(arguments: Sequence[str], environ: Mapping[str, str] = os.environ) -> str:
    """Return the language before the arguments are parsed, so that help and usage errors use it, too."""
    for place, argument in enumerate(arguments):
        if argument == "--":
            break
        if argument == "--language" and place + 1 < len(arguments):
            return negotiate([arguments[place + 1]])
        if argument.startswith("--language="):
            return negotiate([argument.partition("=")[2]])
    return negotiate([next((environ[name] for name in _VARIABLES if environ.get(name)), "")])
