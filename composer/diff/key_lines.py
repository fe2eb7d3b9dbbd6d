"""Find where the numbers of a key are written that belong to one joint, actuator or body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from composer.diagnostics.span import Span
from composer.diff.elements import Elements
from composer.explain.query import name_of
from composer.explain.rows import VECTORS

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


class KeyLines(NamedTuple):
    """Where the numbers of a key for one joint, actuator or body are written; `holder` is that element."""

    holder: Node | None
    spans: tuple[Span, ...]


def key_lines(elements: Elements, key: Node | None, vector: str, entry: str) -> KeyLines:
    """Return where the numbers are written, the numbers themselves first; no place if nobody wrote them."""
    traced = elements.traced
    if key is None or vector not in VECTORS:
        return KeyLines(None, ())
    found = [each for each in traced.key_rows(key, vector) if name_of(each[0]) == entry]
    if not found:
        span = traced.written_at(key, vector)
        return KeyLines(None, () if span is None else (span,))
    rows = [row for _, row in found]
    reasons = [*(row.reason for row in rows), *(reason for row in rows for reason in row.on_the_way)]
    return KeyLines(found[0][0], tuple(dict.fromkeys(reason.span for reason in reasons if reason.span)))
