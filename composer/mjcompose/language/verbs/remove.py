"""Verb `remove`: remove elements."""

from __future__ import annotations

from typing import Any, Literal

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Schema, kind_of
from mjcompose.language.verbs.values import Selected, Verb

CASCADE: Literal["cascade"] = "cascade"


def _read(value: Any, selected: Selected) -> Literal[True, "cascade"] | None:
    if value is True:
        return True
    if value == CASCADE:
        return CASCADE
    help = "write `remove: true`, or `remove: cascade` to take along all that refers to it"
    message = f"`remove` is `true` or `cascade`, got {kind_of(value)}"
    selected.add(Fault("wrong-keyword", message, selected.at, help=help))
    return None


def _words(value: Literal[True, "cascade"]) -> str:
    return "remove" if value is True else "remove, with all that refers to it"


def _schema() -> Schema:
    return {"enum": [True, CASCADE]}


VERB = Verb(
    "remove",
    "take it out: `true` if nothing refers to it, `cascade` with all that does",
    _read,
    words=_words,
    changes=None,
    schema=_schema,
    alone=True,
)
