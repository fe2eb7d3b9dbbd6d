"""Verb `unset`: remove attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.language.form import Schema, kind_of
from mjcompose.language.verbs.values import Changed, Selected, Verb, attributes_of
from mjcompose.model.grammar import ElementType

_CLASSES = "default"


def _read(value: Any, selected: Selected) -> tuple[str, ...] | dict[str, tuple[str, ...]]:
    """Return the attributes, or for classes a mapping from tags to attributes."""
    if not isinstance(value, dict) or selected.tag != _CLASSES:
        return _list(value, selected.kinds, selected.tag, at=selected.at, selected=selected)
    found: dict[str, tuple[str, ...]] = {}
    for name, items in value.items():
        below = tuple(kind.children[name] for kind in selected.kinds if name in kind.children)
        if not below:
            unknown = selected.checker.unknown(name, selected.tag, selected.kinds, (*selected.at, name))
            selected.add(unknown)
        found[name] = _list(items, below, name, at=(*selected.at, name), selected=selected)
    return found


def _list(
    value: Any, kinds: tuple[ElementType, ...], tag: str, at: Path, selected: Selected
) -> tuple[str, ...]:
    if not isinstance(value, list) or not value or not all(isinstance(item, str) for item in value):
        help = f"write `unset: [{value}]`" if isinstance(value, str) else "write `unset: [ATTRIBUTE]`"
        if tag == _CLASSES:
            help = "write `unset: {geom: [ATTRIBUTE]}`"
        got = "an empty list" if value == [] else kind_of(value)
        message = f"`unset` expects a list of attributes, got {got}"
        selected.add(Fault("wrong-type", message, at, help=help))
        return ()
    for index, name in enumerate(value):
        fitting = [kind.attributes[name] for kind in kinds if name in kind.attributes]
        if name == "name":
            message, help = "`unset` cannot take a name away", "write `rename: …` for another name"
            selected.add(Fault("unknown-key", message, (*at, index), help=help))
        elif kinds and not fitting:
            fault = selected.checker.unknown(name, tag, kinds, (*at, index))
            selected.add(
                Fault(fault.code, fault.message, fault.at, notes=fault.notes, help=fault.help, fix=fault.fix)
            )
        elif fitting and all(attribute.required for attribute in fitting):
            message = f"`{name}` of `{tag}` is required"
            help = "write another value with `set`"
            selected.add(Fault("missing-key", message, (*at, index), help=help))
    return tuple(value)


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"unset {', '.join(f'{tag}.{name}' for tag, names in value.items() for name in names)}"
    return f"unset {', '.join(value)}"


def _changes(tag: str | None, value: Any) -> Changed:
    if isinstance(value, Mapping):
        return [(inner, name) for inner, names in value.items() for name in names]
    return [(tag, name) for name in value]


def _schema() -> Schema:
    attributes: Schema = {"type": "array", "items": {"type": "string", "minLength": 1}, "minItems": 1}
    return {"anyOf": [attributes, {"type": "object", "additionalProperties": attributes}]}


def _schema_of_tag(tag: str) -> Schema:
    return {"type": "array", "items": {"enum": list(attributes_of(tag))}, "minItems": 1}


VERB = Verb(
    "unset",
    "attributes that are no longer written",
    _read,
    words=_words,
    changes=_changes,
    schema=_schema,
    schema_of_tag=_schema_of_tag,
)
