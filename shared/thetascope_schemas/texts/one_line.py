"""Texts of users that are shown in one line, such as names and notes."""


def one_line(text: str) -> str:
    """Return a text with single blanks in place of line breaks and of characters that cannot be shown."""
    return " ".join("".join(char if char.isprintable() else " " for char in text).split())
