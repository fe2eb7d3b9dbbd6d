"""Diagnostics as SARIF 2.1.0, which GitHub, GitLab and editors read, and the JSON Schema of `--output-format json`."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import fields
from typing import Any, get_args, get_type_hints
from urllib.parse import quote

from mjcompose.base import __version__
from mjcompose.base.codes import CODES, address
from mjcompose.base.diagnostic import OWN_FIELDS, CellName, Diagnostic, Note, Severity, Span
from mjcompose.base.report import json_text, printable, remarks


def render_sarif(diagnostics: Sequence[Diagnostic]) -> str:
    """Return the whole document. Each fix must have exact text: see `mjcompose.tools.fix.exact`.

    >>> json.loads(render_sarif([Diagnostic("bad-name", "no")]))["runs"][0]["results"][0]
    {'ruleId': 'bad-name', 'ruleIndex': 0, 'level': 'error', 'message': {'text': 'no'}, 'locations': []}
    """
    codes = list(dict.fromkeys(diagnostic.code for diagnostic in diagnostics))
    rules: list[dict[str, Any]] = [{"id": code, "shortDescription": {"text": CODES[code]}} for code in codes]
    for rule in rules:
        url = address(rule["id"])
        if url is not None:
            rule["helpUri"] = url
    run = {
        "tool": {"driver": {"name": "mjcompose", "version": __version__, "rules": rules}},
        "columnKind": "unicodeCodePoints",
        "results": [_result(diagnostic, codes.index(diagnostic.code)) for diagnostic in diagnostics],
    }
    schema = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
    return json_text({"$schema": schema, "version": "2.1.0", "runs": [run]}, indent=2)


def _result(diagnostic: Diagnostic, index: int) -> dict[str, Any]:
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": index,
        "level": diagnostic.severity.value,
        "message": {"text": printable("\n".join([diagnostic.message, *remarks(diagnostic)]))},
        "locations": [] if diagnostic.span is None else [_location(diagnostic.span)],
    }
    notes = [note for note in (*diagnostic.notes, *diagnostic.others) if note.span is not None]
    if notes:
        result["relatedLocations"] = [
            {**_location(note.span), "message": {"text": printable(note.message)}} for note in notes if note.span
        ]
    fix = diagnostic.fix
    span = diagnostic.span
    if fix is not None and fix.replaces is None and (place := fix.span or span) is not None:
        change = {"deletedRegion": _region(place), "insertedContent": {"text": fix.replacement}}
        file = {"artifactLocation": {"uri": _uri(place.file)}, "replacements": [change]}
        result["fixes"] = [{"artifactChanges": [file]}]
    return result


def _location(span: Span) -> dict[str, Any]:
    return {"physicalLocation": {"artifactLocation": {"uri": _uri(span.file)}, "region": _region(span)}}


def _region(span: Span) -> dict[str, int]:
    ends = {"endLine": span.end_line, "endColumn": span.end_column}
    return {
        "startLine": span.line,
        "startColumn": span.column,
        **{name: value for name, value in ends.items() if value is not None},
    }


def _uri(file: str) -> str:
    path = quote(file.replace(os.sep, "/"), errors="surrogateescape")
    return f"file://{path}" if path.startswith("/") else path


VERSION = 1
"""Rises if a key is removed or changes its meaning. New keys do not change it."""

_TYPES = {str: "string", int: "integer", bool: "boolean", type(None): "null"}
_TEXT = {"type": "string"}


def _list(items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items}


def _ref(name: str) -> dict[str, Any]:
    return {"$ref": f"#/$defs/{name}"}


def _or_null(schema: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": [schema, {"type": "null"}]}


def _object(**properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "required": list(properties), "properties": properties}


def _of(kind: type, **known: dict[str, Any]) -> dict[str, Any]:
    def schema(hint: Any) -> dict[str, Any]:
        names = [_TYPES[each] for each in get_args(hint) or (hint,)]
        return {"type": names[0] if len(names) == 1 else names}

    hints = {name: hint for name, hint in get_type_hints(kind).items() if name not in OWN_FIELDS}
    return _object(**{name: known.get(name) or schema(hint) for name, hint in hints.items()})


_KEYS: dict[str, tuple[str, dict[str, Any]]] = {
    "severity": ("Only an error makes the command fail, with exit code 1.", {"enum": [*map(str, Severity)]}),
    "code": ("`mjcompose explain CODE` prints its page. Later versions may have other codes.", _TEXT),
    "message": ("One sentence, for people: do not parse it.", _TEXT),
    "span": ("The place, or null if the diagnostic is about no file.", _or_null(_ref("span"))),
    "notes": ("Remarks, such as the names that exist.", _list(_ref("note"))),
    "help": ("Instructions for people.", {"type": ["string", "null"]}),
    "fix": ("The exact change that `mjcompose fix` makes, or null.", _or_null(_ref("fix"))),
    "others": ("More places with the same cause.", _list(_ref("note"))),
    "cells": ("The models of a matrix that it is about; empty for all.", _list(_ref("cell"))),
    "recipes": ("The recipes that it is about, if the command got several.", _list(_TEXT)),
}
_RESULTS = {
    "build": _object(output=_TEXT, name=_TEXT, sha256=_TEXT, sizes={"type": "object"}),
    "cells": _object(recipe=_TEXT, cells={"type": "integer"}, failed=_list(_ref("cell"))),
    "check": _object(recipe=_TEXT, ok={"type": "boolean"}),
    "another command": {"type": "object"},
}


def schema_text() -> str:
    assert set(_KEYS) == {each.name for each in fields(Diagnostic)} - {"subjects"}, "a key is not described"
    found = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:mjcompose:diagnostics:{VERSION}",
        "title": f"A line of `mjcompose COMMAND --output-format json`, version {VERSION}",
        "description": "A line with `severity` is a diagnostic. Any other line is a result of the command, such as the"
        " path of a model. Ignore keys that you do not know: later versions may add some.",
        "type": "object",
        "if": {"required": ["severity"]},
        "then": _ref("diagnostic"),
        "else": _ref("result"),
        "$defs": {
            "diagnostic": _object(**{name: {"description": about, **each} for name, (about, each) in _KEYS.items()}),
            "span": _of(Span),
            "note": _of(Note, span=_or_null(_ref("span"))),
            "fix": _object(replacement=_TEXT, span=_ref("span")),
            "cell": _of(CellName),
            "result": {"anyOf": [{"title": title, **each} for title, each in _RESULTS.items()]},
        },
    }
    return json.dumps(found, indent=2) + "\n"
