"""Messages of a session as JSON, their sentences in the viewer's language."""

import json
from typing import Any

from pydantic import BaseModel

from thetascope.messages import Message, words
from thetascope.messages.catalogue import DEFAULT
from thetascope_schemas.service.field_error import sentences
from thetascope_schemas.texts.local_text import ALL

_TEXT = {"code", "args", "text"}
_REFUSAL = {"code", "args", "problem", "remedy"}


def encode(message: BaseModel, language: str) -> str:
    """Return a message as JSON text: its sentences and its prose, such as titles, in a language.

    Models are built with English sentences. With ALL, these stay English and prose is a map from language to text.
    """
    if language == DEFAULT:
        return message.model_dump_json()
    context = {"language": language}
    if language == ALL:
        return message.model_dump_json(context=context)
    data = localized(message.model_dump(mode="json", context=context), language)
    return json.dumps(data, ensure_ascii=False, separators=(",", ":"))


def localized(data: Any, language: str) -> Any:
    """Return plain data in which every sentence that has a code is in a language."""
    if isinstance(data, list):
        return [localized(item, language) for item in data]
    if not isinstance(data, dict):
        return data
    if data.get("code"):
        if data.keys() == _TEXT:
            return data | {"text": Message.from_data(data).text(language)}
        if data.keys() >= _REFUSAL:
            problem, remedy = sentences(data["code"], data["args"], words(language))
            return data | {"problem": problem, "remedy": remedy}
    return {name: localized(value, language) for name, value in data.items()}
