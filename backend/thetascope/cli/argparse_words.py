"""The sentences of argparse itself, which it passes through gettext, in the language of the command line."""

import argparse
from gettext import gettext

from thetascope.messages import Message

ENTRIES = {
    "%(prog)s: error: %(message)s\n": "cli.argparse.error",
    "ambiguous option: %(option)s could match %(matches)s": "cli.argparse.ambiguous",
    "argument %(argument_name)s: %(message)s": "cli.argparse.argument",
    "expected one argument": "cli.argparse.one-value",
    "ignored explicit argument %r": "cli.argparse.no-value",
    "invalid %(type)s value: %(value)r": "cli.argparse.value",
    "invalid choice: %(value)r (choose from %(choices)s)": "cli.argparse.choice",
    "options": "cli.argparse.options",
    "positional arguments": "cli.argparse.positionals",
    "show this help message and exit": "cli.argparse.help",
    "the following arguments are required: %s": "cli.argparse.required",
    "unrecognized arguments: %s": "cli.argparse.unrecognized",
    "usage: ": "cli.argparse.usage",
}
"""Code of the entry for each text of argparse that a command line can meet. Entries keep its % places."""

_HOOK = "_"  # argparse has imported gettext under this name


def translate_argparse(language: str) -> None:
    """Let argparse write its sentences in a language, in parsers that are made from now on, too."""

    def translated(text: str) -> str:
        code = ENTRIES.get(text)
        if code is None:
            return gettext(text)
        ending = "\n" if text.endswith("\n") else ""  # an entry is one line
        return Message(code).text(language) + ending

    setattr(argparse, _HOOK, translated)
