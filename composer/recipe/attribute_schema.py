"""The JSON Schema of MJCF's attributes, from the grammar."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from composer.expr.angle import ANGLE_PATTERN
from composer.grammar.attribute import Attribute
from composer.grammar.number import INT_MAX, INT_MIN
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.shown import shown

TEMPLATE_PATTERN = r"\$\{"
_NUMBER_PATTERN = f"^{ANGLE_PATTERN}$|{TEMPLATE_PATTERN}"
_NUMBER_HINT = "expected a number, an angle such as 90deg or 1.57rad, or ${…}"
_ITEMS = {"real": "number", "int": "integer"}

# Schemas that many attributes share.
SHARED: dict[str, Schema] = {
    "number": {
        "type": ["number", "string"],
        "pattern": _NUMBER_PATTERN,
        "patternErrorMessage": _NUMBER_HINT,
    },
    "integer": {
        "type": ["integer", "string"],
        "minimum": INT_MIN,
        "maximum": INT_MAX,
        "pattern": TEMPLATE_PATTERN,
        "patternErrorMessage": "expected an integer, or ${…}",
    },
    "boolean": {
        "type": ["boolean", "string"],
        "pattern": TEMPLATE_PATTERN,
        "patternErrorMessage": "expected true, false, or ${…}",
    },
    "fragment": {
        "type": "string",
        "pattern": "<",
        "patternErrorMessage": "expected an element of MJCF: <geom …/>",
        "description": "a fragment of MJCF in place of the element",
    },
    "template": {"type": "string", "pattern": TEMPLATE_PATTERN},
}


def _shared(kind: str, lengths: str) -> Schema:
    """Return the schema of one of `SHARED`, or of a list of it.

    `3`, `1-2` and `1-` are the lengths in `number-3`, `number-1-2` and `number-1-`.
    """
    if not lengths:
        return dict(SHARED[kind])
    low, *rest = lengths.split("-")
    schema = _list(kind, int(low))
    high = int(low) if not rest else int(rest[0]) if rest[0] else None
    if high is not None:
        schema["maxItems"] = high
    return schema


for _kind in SHARED:
    definition(_kind)(partial(_shared, _kind))


def attribute_schema(attribute: Attribute) -> Schema:
    """Return the schema of an attribute's values in a recipe, with an explanation.

    The default is part of the explanation: editors would write every `default` into a new element.
    """
    schema = _values(attribute)
    remarks = ", ".join(_remarks(attribute))
    description = " ".join(filter(None, [attribute.doc, remarks and f"({remarks})"]))
    if description:
        schema["description"] = description
    return schema


def _remarks(attribute: Attribute) -> Iterator[str]:
    """Yield what the explanation of a value does not say."""
    if attribute.refers is not None:
        kind = {"default": "default class"}.get(attribute.refers, attribute.refers.removeprefix("attached:"))
        if kind not in attribute.doc or kind == attribute.doc:
            yield f"names of {kind}s" if attribute.type == "references" else f"name of a {kind}"
    elif attribute.refers_by is not None:
        yield f"of the kind that `{attribute.refers_by}` says"
    if attribute.type == "file":
        yield "file, relative to the recipe"
    if attribute.default is not None:
        yield f"default: {shown(attribute.default)}"
    yield from attribute.versions()


def _values(attribute: Attribute) -> Schema:
    kind = attribute.type
    if kind in _ITEMS:
        return _numbers(attribute, _ITEMS[kind])
    if kind == "bool":
        return reference("boolean")
    if kind == "keyword":
        return {"anyOf": [{"enum": _words(attribute)}, reference("template")]}
    if kind == "keywords":
        words: Schema = {"enum": _words(attribute)}
        several: Schema = {"type": "array", "items": words, "minItems": 1, "uniqueItems": True}
        return {"anyOf": [several, words, reference("template")]}
    if kind == "references":
        return {"type": ["array", "string"], "items": {"type": "string"}, "minItems": 1}
    if kind == "chars":
        low, high = attribute.min_length or 0, "" if attribute.max_length is None else attribute.max_length
        return {"type": "string", "pattern": f"^.{{{low},{high}}}$|{TEMPLATE_PATTERN}"}
    is_needed = attribute.required and attribute.name != "name"  # an empty name keeps an element unnamed
    return {"type": "string", "minLength": 1} if is_needed else {"type": "string"}


def _numbers(attribute: Attribute, item: str) -> Schema:
    low, high = attribute.min_length or 0, attribute.max_length
    if attribute.lengths is not None:
        return {"anyOf": [reference(f"{item}-{length}") for length in attribute.lengths]}
    if high == 1:
        return reference(item)
    if low == high:
        return reference(f"{item}-{low}")
    return reference(f"{item}-{low}-{'' if high is None else high}")


def _list(item: str, low: int) -> Schema:
    """Return the schema of a list of numbers. One number is a list of one, and `${…}` is any list."""
    # If `items` is at the top, editors write a new list with dashes, which is an error inside of `{ }`.
    schema: Schema = {"type": ["array", "string"], "allOf": [{"items": reference(item)}], "minItems": low}
    schema["defaultSnippets"] = [{"body": _snippet(low)}]
    single = SHARED[item]
    if low <= 1:
        return {**single, **schema, "type": ["array", *single["type"]]}
    hint = f"expected a list of {low} {item}s" if low else f"expected a list of {item}s"
    return {**schema, "pattern": TEMPLATE_PATTERN, "patternErrorMessage": hint}


def _snippet(count: int) -> str:
    """Return what editors insert for a new list: brackets with a place for each number."""
    return "[" + ", ".join(f"${place}" for place in range(1, max(count, 1) + 1)) + "]"


def _words(attribute: Attribute) -> list[Any]:
    """Return the keywords, including those that YAML does not read as text."""
    words: list[Any] = list(attribute.keywords)
    words += [word == "true" for word in attribute.keywords if word in ("true", "false")]
    return [*words, *(int(word) for word in attribute.keywords if word.isdigit())]
