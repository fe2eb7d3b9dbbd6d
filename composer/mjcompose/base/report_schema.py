"""The JSON Schema of the lines that `--output-format json` prints, made from the classes of diagnostics."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from mjcompose.base.diagnostic import CellName, Diagnostic, Note, Severity, Span

VERSION = 1
"""Rises if a key is removed or changes its meaning. New keys do not change it."""

_TYPES = {str: "string", int: "integer", bool: "boolean", type(None): "null"}
_STRINGS: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
_ABOUT = {
    "severity": "Only an error makes the command fail, with exit code 1.",
    "code": "`mjcompose explain CODE` prints its page. Later versions may have other codes.",
    "message": "One sentence, for people: do not parse it.",
    "span": "The place, or null if the diagnostic is about no file.",
    "notes": "Remarks, such as the names that exist.",
    "help": "What to write instead, for people.",
    "fix": "The exact change that `mjcompose fix` makes, or null.",
    "others": "More places with the same cause.",
    "cells": "The models of a matrix that it is about; empty for all.",
    "recipes": "The recipes that it is about, if the command got several.",
}


def text() -> str:
    """Return the schema as JSON text."""
    fix = _object({"replacement": {"type": "string"}, "span": {"$ref": "#/$defs/span"}})
    diagnostic = _object({
        "severity": {"enum": [each.value for each in Severity]},
        "code": {"type": "string", "examples": ["attach-place"]},
        "message": {"type": "string"},
        "span": _or_null({"$ref": "#/$defs/span"}),
        "notes": {"type": "array", "items": {"$ref": "#/$defs/note"}},
        "help": {"type": ["string", "null"]},
        "fix": _or_null({"$ref": "#/$defs/fix"}),
        "others": {"type": "array", "items": {"$ref": "#/$defs/note"}},
        "cells": {"type": "array", "items": {"$ref": "#/$defs/cell"}},
        "recipes": _STRINGS,
    })  # fmt: skip
    properties = diagnostic["properties"]
    assert list(properties) == list(_ABOUT), properties
    assert set(properties) == {each.name for each in fields(Diagnostic)} - {"subjects"}, "a key is not described"
    diagnostic["properties"] = {name: {"description": _ABOUT[name], **each} for name, each in properties.items()}
    note = _of(Note, span=_or_null({"$ref": "#/$defs/span"}))
    found = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:mjcompose:diagnostics:{VERSION}",
        "title": f"A line of `mjcompose COMMAND --output-format json`, version {VERSION}",
        "description": "A line with `severity` is a diagnostic. Any other line is a result of the command, such as the"
        " path of a model. Ignore keys that you do not know: later versions may add some.",
        "type": "object",
        "if": {"required": ["severity"]},
        "then": {"$ref": "#/$defs/diagnostic"},
        "else": {"$ref": "#/$defs/result"},
        "$defs": {
            "diagnostic": diagnostic, "span": _of(Span), "note": note, "fix": fix, "cell": _of(CellName),
            "result": {"anyOf": [
                {"title": "build", **_object({
                    "output": {"type": "string"}, "name": {"type": "string"}, "sha256": {"type": "string"},
                    "sizes": {"type": "object", "additionalProperties": {"type": "integer"}},
                })},
                {"title": "cells", **_object({
                    "recipe": {"type": "string"}, "cells": {"type": "integer"},
                    "failed": {"type": "array", "items": {"$ref": "#/$defs/cell"}},
                })},
                {"title": "check", **_object({"recipe": {"type": "string"}, "ok": {"type": "boolean"}})},
                {"title": "another command", "type": "object"},
            ]},
        },
    }  # fmt: skip
    return json.dumps(found, indent=2) + "\n"


def _object(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "required": list(properties), "properties": properties}


def _or_null(schema: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": [schema, {"type": "null"}]}


def _of(kind: type, **known: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a class whose fields are texts and numbers, except those that are known."""

    def schema(hint: Any) -> dict[str, Any]:
        names = [_TYPES[each] for each in get_args(hint) or (hint,)]
        return {"type": names[0] if len(names) == 1 else names}

    return _object({name: known.get(name) or schema(hint) for name, hint in get_type_hints(kind).items()})
