from __future__ import annotations

import json

from composer.diagnostics import Diagnostic, Note, Severity, Span, render_json
from composer.diagnostics.cell_name import CellName


def test_everything_is_there() -> None:
    line = render_json(
        Diagnostic(
            "bad-name",
            "zwei\nZeilen „ü“ \u2028",
            Span("a b.yaml", 3, 4, 3, 9),
            Severity.WARNING,
            (Note("n"), Note("m", Span("c", 1, 1))),
            "h",
            cells=(CellName("a-1-s0002", "a-1", 2), CellName("a-2")),
        )
    )
    assert line.splitlines() == [line]
    assert line.isascii()
    assert json.loads(line) == {
        "severity": "warning",
        "code": "bad-name",
        "message": "zwei\nZeilen „ü“ \u2028",
        "span": {"file": "a b.yaml", "line": 3, "column": 4, "end_line": 3, "end_column": 9},
        "notes": [
            {"message": "n", "span": None},
            {
                "message": "m",
                "span": {"file": "c", "line": 1, "column": 1, "end_line": None, "end_column": None},
            },
        ],
        "help": "h",
        "fix": None,
        "others": [],
        "cells": [
            {"name": "a-1-s0002", "cell": "a-1", "sample": 2},
            {"name": "a-2", "cell": None, "sample": None},
        ],
        "recipes": [],
    }


def test_keys_are_the_same_for_every_diagnostic() -> None:
    full = Diagnostic("bad-name", "a", Span("f", 1, 1), notes=(Note("n"),), help="h")
    assert json.loads(render_json(full)).keys() == json.loads(render_json(Diagnostic("bad-name", "a"))).keys()
