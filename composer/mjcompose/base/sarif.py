"""Diagnostics as SARIF 2.1.0, which GitHub, GitLab and editors read."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any
from urllib.parse import quote

from mjcompose.base.codes import CODES, address
from mjcompose.base.diagnostic import Diagnostic, Fix, Span
from mjcompose.base.report import printable, remarks
from mjcompose.base.version import __version__


def render_sarif(diagnostics: Sequence[Diagnostic]) -> str:
    """Return the whole document. Each fix must have exact text: see `mjcompose.tools.fix.exact`.

    >>> json.loads(render_sarif([Diagnostic("bad-name", "no")]))["runs"][0]["results"][0]
    {'ruleId': 'bad-name', 'ruleIndex': 0, 'level': 'error', 'message': {'text': 'no'}, 'locations': []}
    """
    codes = list(dict.fromkeys(each.code for each in diagnostics))
    rules: list[dict[str, Any]] = [{"id": code, "shortDescription": {"text": CODES[code]}} for code in codes]
    for rule in rules:
        if (url := address(rule["id"])) is not None:
            rule["helpUri"] = url
    run = {
        "tool": {"driver": {"name": "mjcompose", "version": __version__, "rules": rules}},
        "columnKind": "unicodeCodePoints",
        "results": [_result(each, codes.index(each.code)) for each in diagnostics],
    }
    schema = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
    return json.dumps({"$schema": schema, "version": "2.1.0", "runs": [run]}, indent=2)


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
    fix, span = diagnostic.fix, diagnostic.span
    if fix is not None and fix.replaces is None and (fix.span or span) is not None:
        result["fixes"] = [_fix(fix, fix.span or span)]
    return result


def _fix(fix: Fix, span: Span | None) -> dict[str, Any]:
    assert span is not None
    replacement = {"deletedRegion": _region(span), "insertedContent": {"text": fix.replacement}}
    return {"artifactChanges": [{"artifactLocation": {"uri": _uri(span.file)}, "replacements": [replacement]}]}


def _location(span: Span) -> dict[str, Any]:
    return {"physicalLocation": {"artifactLocation": {"uri": _uri(span.file)}, "region": _region(span)}}


def _region(span: Span) -> dict[str, int]:
    ends = {"endLine": span.end_line, "endColumn": span.end_column}
    return {
        "startLine": span.line, "startColumn": span.column,
        **{name: value for name, value in ends.items() if value is not None},
    }  # fmt: skip


def _uri(file: str) -> str:
    path = quote(file.replace(os.sep, "/"), errors="surrogateescape")
    return f"file://{path}" if path.startswith("/") else path
