"""Prose in several languages: a text, or a map from language to text, `{en: DC motor, zh: 直流电机}`.

A :class:`LocalText` is a `str`, its English (or first) text, so code that only displays it can ignore languages. As
JSON it is the text in one language, by default that of the `str`; with the serialisation context `{"language": "zh"}`
the Chinese one, with `{"language": ALL}` the whole map.
"""

import re
from collections.abc import Mapping
from typing import Any, Self

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from thetascope_schemas.texts.refusal import refuse

DEFAULT = "en"
ALL = "*"
"""Language of a serialisation context that keeps all languages."""
_TAG = re.compile(r"[a-z]{2,3}(-[A-Za-z0-9]{2,8})*")
_MOST = 20  # languages of one text


class LocalText(str):
    """A text with its translations.

    Args:
        texts: text by language; not empty.
    """

    texts: Mapping[str, str]

    def __new__(cls, texts: Mapping[str, str]) -> Self:
        """Return the text in English if there is one, else in its first language."""
        text = super().__new__(cls, texts.get(DEFAULT) or next(iter(texts.values())))
        text.texts = dict(texts)
        return text

    def __reduce__(self) -> tuple[Any, ...]:
        return LocalText, (dict(self.texts),)

    def __deepcopy__(self, memo: object) -> "LocalText":
        return self


def in_language(text: str, language: str) -> str:
    """Return prose in a language; a text without that language is returned unchanged."""
    return text.texts.get(language, str(text)) if isinstance(text, LocalText) else text


class LocalProse:
    """Annotation of a `str` field that takes a text or a map of texts.

    Args:
        max_length: maximum number of characters in each language.
    """

    def __init__(self, max_length: int) -> None:
        self.max_length = max_length

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        one = core_schema.str_schema(max_length=self.max_length)
        several = core_schema.no_info_after_validator_function(
            _local, core_schema.dict_schema(core_schema.str_schema(), one, min_length=1, max_length=_MOST)
        )
        kept = core_schema.is_instance_schema(LocalText)
        return core_schema.tagged_union_schema(
            {"text": one, "map": several, "kept": kept},
            discriminator=_kind,
            serialization=core_schema.plain_serializer_function_ser_schema(
                _written, info_arg=True, return_schema=core_schema.any_schema(), when_used="json"
            ),
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        text: JsonSchemaValue = {"type": "string", "maxLength": self.max_length}
        if handler.mode == "serialization":
            return text
        texts = {"type": "object", "additionalProperties": text, "minProperties": 1, "maxProperties": _MOST}
        return {"anyOf": [text, texts]}


def _kind(value: object) -> str:
    return "kept" if isinstance(value, LocalText) else "map" if isinstance(value, Mapping) else "text"


def _local(texts: dict[str, str]) -> LocalText:
    """Return a map of texts as one text; refuse tags that are not language tags."""
    for tag in texts:
        if not _TAG.fullmatch(tag):
            raise refuse("schema.language.unknown", value=tag, tag=tag[:40])
    return LocalText(texts)


def _written(text: str, info: core_schema.SerializationInfo) -> object:
    """Return a text as JSON data in the language of the context."""
    language = (info.context or {}).get("language", DEFAULT) if isinstance(info.context, Mapping | None) else DEFAULT
    if not isinstance(text, LocalText):
        return text
    return dict(text.texts) if language == ALL else in_language(text, language)
