"""Verb `rename`: give elements new names, also in every reference."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema, kind_of
from mjcompose.language.select import check_template
from mjcompose.language.verbs.values import Changed, Selected, Verb


def _read(value: Any, selected: Selected) -> str | None:
    if isinstance(value, str) and value:
        check_template(value, selected.at, selected.checker.faults)
        return value
    help = 'write `rename: "${name}_left"`, with `${name}`, `${parent}` or `${index}` where there are several'
    message = f"`rename` expects the new name, got {kind_of(value) if value != '' else 'empty text'}"
    selected.add(Fault("wrong-type", message, selected.at, help=help))
    return None


def _words(value: str) -> str:
    return f"rename to {value}"


def _changes(tag: str | None, value: str) -> Changed:
    return ()  # a name is not a value in the compiled model


def _schema() -> Schema:
    return {"type": "string", "minLength": 1}


VERB = Verb(
    "rename",
    "the new name, which every reference follows",
    _read,
    words=_words,
    changes=_changes,
    schema=_schema,
)
