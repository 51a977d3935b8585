"""A message before it has words: a code, and the arguments that its sentence needs."""

from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from typing import Any, Union

Argument = Union[str, int, float, bool, None, "Message", Sequence["Argument"]]
"""What an argument may be: a plain value, another message, or a list of these."""

_PLAIN = (str, int, float, bool, type(None))


class Message:
    """A sentence as a code and its arguments. It is immutable, compares by value, and its `str()` is English.

    Args:
        code: the key in the catalogues, for example `observer.label.taken`.
        args: the arguments by name. NumPy numbers become Python's; a list is joined as the template says.
    """

    __slots__ = ("args", "code")

    code: str
    args: Mapping[str, Any]

    def __init__(self, code: str, /, **args: Any) -> None:
        object.__setattr__(self, "code", code)
        object.__setattr__(self, "args", {name: _plain(value) for name, value in args.items()})

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a Message does not change: {name}")

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self.code, dict(self.args))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Message) and (self.code, self.args) == (other.code, other.args)

    def __hash__(self) -> int:
        return hash((self.code, tuple(self.args)))

    def __repr__(self) -> str:
        return f"Message({self.code!r}{''.join(f', {name}={value!r}' for name, value in self.args.items())})"

    def __str__(self) -> str:
        return self.text()

    def text(self, language: str = "en") -> str:
        """Return the sentence in a language; in English where the catalogue has no such language."""
        from thetascope.messages.catalogue import catalogue

        return catalogue(language).render(self)

    def as_data(self) -> dict[str, Any]:
        """Return {code, args} as plain data, nested messages likewise: what goes over the wire and into the store."""
        return {"code": self.code, "args": {name: _data(value) for name, value in self.args.items()}}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> "Message":
        """Return the message of :meth:`as_data`."""
        return cls(data["code"], **{name: _undata(value) for name, value in data["args"].items()})


def text_of(value: Any, language: str = "en") -> str:
    """Return what people read in a language.

    Args:
        value: a message, anything with its `code` and `args` (the wire's form, plain data), or a text. A text that has
            `texts`, a map from language to text, is one in several languages; any other is given back as it is. None is
            no text.
    """
    if value is None:
        return ""
    if isinstance(value, Message):
        return value.text(language)
    if isinstance(value, str):
        return getattr(value, "texts", {}).get(language, str(value))
    data = value if isinstance(value, Mapping) else {"code": value.code, "args": value.args}
    if not data["code"]:  # a sentence from before there were codes
        return str(value["text"] if isinstance(value, Mapping) else value.text)
    return Message.from_data(data).text(language)


def words(language: str = "en") -> Callable[[str, Mapping[str, Any]], str]:
    """Return the function that renders a code and its arguments (plain data,
    as of :meth:`Message.as_data`) in a language."""

    def render(code: str, args: Mapping[str, Any]) -> str:
        return Message.from_data({"code": code, "args": args}).text(language)

    return render


def _restore(code: str, args: dict[str, Any]) -> Message:
    return Message(code, **args)


def _plain(value: Any) -> Any:
    """Return a value as plain data. Raises TypeError for a value that no template can show."""
    if isinstance(value, Message):
        return value
    if type(value) in _PLAIN:
        return value
    item = getattr(value, "item", None)  # numbers and texts of NumPy have it
    if isinstance(value, str | int | float):
        return str(value) if item is None else item()
    if item is not None and getattr(value, "ndim", 1) == 0:
        return item()
    if isinstance(value, Sequence) or hasattr(value, "tolist"):
        return tuple(_plain(item) for item in value)
    raise TypeError(f"a message cannot hold {type(value).__name__}")


def _data(value: Any) -> Any:
    if isinstance(value, Message):
        return value.as_data()
    if isinstance(value, float) and not isfinite(value):
        return str(value)  # JSON has no such numbers
    return [_data(item) for item in value] if isinstance(value, tuple) else value


def _undata(value: Any) -> Any:
    if isinstance(value, Mapping) and "code" in value:
        return Message.from_data(value)
    return tuple(_undata(item) for item in value) if isinstance(value, list | tuple) else value
