"""Parse YAML 1.2 text to a located tree."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import yaml

from composer.diagnostics import Diagnostic, Sink, Span
from composer.document.build import Builder
from composer.document.decode import decode, position
from composer.document.fault import explain
from composer.document.mask import Mask
from composer.document.node import Node

_PURE: Any = yaml.SafeLoader
_FAST: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

# JSON writes characters outside of the basic plane as two escapes, which only the pure-Python reader accepts.
_SURROGATE_ESCAPE = re.compile(r"\\u[dD][89a-fA-F]")
_TOO_LARGE_ESCAPE = re.compile(r"\\U(?!000|0010)[0-9a-fA-F]{8}")
_MAX_READINGS = 50
_MAX_CHARACTERS_READ = 4_000_000


def load(text: str | bytes, file: str, sink: Sink, *, empty: str | None = None) -> Node | None:
    """Return the tree of a YAML file; `file` is its path for the user, `empty` the help for an empty file. No I/O.

    All faults that can be found in one run go to `sink`. After a fault that leaves the meaning of the rest clear (a
    duplicate key, a tag, missing quotes) there is still a tree, so that later stages can find more faults;
    otherwise return None. Never raises on bad input.
    """
    source = decode(text, file, sink)
    if source is None:
        return None
    mask = Mask(source)
    reader = reader_of(source)
    faults: list[Diagnostic] = []
    readings = max(1, min(_MAX_READINGS, _MAX_CHARACTERS_READ // max(len(source), 1)))
    for _ in range(readings):
        found = Sink()
        builder = Builder(source, file, found, restore=_restorer(mask, reader is _PURE), empty=empty)
        try:
            root = builder.build(yaml.parse(mask.text, Loader=reader))
        except yaml.MarkedYAMLError as error:
            fault = explain(error, source, file, outer=builder.in_flow)
            faults.append(fault.diagnostic)
            if fault.hide is not None and mask.hide(*fault.hide):
                continue
            root = None
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            faults.append(_unreadable(error, source, file))
            root = None
        break
    else:
        root = None
    for diagnostic in [*faults, *found.diagnostics]:
        sink.add(diagnostic)
    return root


def reader_of(text: str) -> Any:
    """Return the YAML reader that accepts this text: the fast one if possible."""
    return _PURE if _SURROGATE_ESCAPE.search(text) else _FAST


def _restorer(mask: Mask, pure: bool) -> Callable[[str], str] | None:
    """Return the function that restores a scalar's original text: it undoes the masking and joins surrogates."""
    if pure:
        return lambda value: _join_surrogates(mask.restore(value))
    return mask.restore if mask.active else None


def _join_surrogates(value: str) -> str:
    return value.encode("utf-16-le", "surrogatepass").decode("utf-16-le")


def _unreadable(error: Exception, text: str, file: str) -> Diagnostic:
    """Return a diagnostic for the few faults that a reader reports without a place."""
    escape = _TOO_LARGE_ESCAPE.search(text)
    if escape is None:
        return Diagnostic("yaml-syntax", f"this is not YAML: {error}", Span(file, 1, 1))
    line, column = position(text, escape.start())
    span = Span(file, line, column, end_line=line, end_column=column + len(escape.group()))
    return Diagnostic("yaml-syntax", f"`{escape.group()}` is not a character", span)
