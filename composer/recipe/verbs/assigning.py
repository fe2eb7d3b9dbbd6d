"""What `set`, `scale` and `offset` share: a mapping from attributes to values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from composer.grammar import GRAMMAR
from composer.recipe.reference import Schema, reference
from composer.recipe.subscript import attribute_and_index
from composer.recipe.verbs.verb import Changed, Selected, Verb, flat, read_mapping

_CLASSES = "default"


def assigning(name: str, sign: str, description: str, values: str) -> Verb:
    """Return a verb that gives attributes new values.

    `sign` is written between attribute and value in words. `values` is the kind of definition of the values in the
    JSON Schema.
    """

    def words(value: Mapping[str, Any]) -> str:
        return f"{name} {', '.join(f'{attribute} {sign} {each}' for attribute, each in flat(value))}"

    def of_tag(tag: str) -> Schema:
        return reference(f"{values}:{tag}")

    return Verb(
        name,
        description,
        _reader(name),
        words=words,
        changes=_changes,
        schema=lambda: {"type": "object", "minProperties": 1},
        schema_of_tag=of_tag,
        schema_of_classes=_of_classes,
    )


def _reader(name: str) -> Callable[[Any, Selected], dict[str, Any]]:
    def read(value: Any, selected: Selected) -> dict[str, Any]:
        given = read_mapping(name, value, "{ATTRIBUTE: VALUE}", selected=selected)
        if given is None:
            return {}
        selected.checker.attributes(name, given, selected.selector, at=selected.at)
        return dict(given)

    return read


def _changes(tag: str | None, value: Mapping[str, Any]) -> Changed:
    for name, each in value.items():
        if isinstance(each, Mapping):  # of a class or of a section
            yield from ((name, attribute_and_index(inner)[0]) for inner in each)
        else:
            yield tag, attribute_and_index(name)[0]


def _of_classes() -> Schema:
    rows = [tag for tag in GRAMMAR.section(_CLASSES).children if tag != _CLASSES]
    return {"propertyNames": {"enum": rows}, "additionalProperties": {"type": "object"}}
