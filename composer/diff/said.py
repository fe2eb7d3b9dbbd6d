"""What the keyframes of files say of one joint, actuator or body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from composer.diagnostics.span import Span
from composer.diff.elements import Elements
from composer.explain.query import name_of
from composer.explain.rows import VECTORS, rows

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


class Said(NamedTuple):
    """What a key of a file says of one joint, actuator or body, which `holder` is."""

    holder: Node | None
    text: str | None
    span: Span | None


def said(elements: Elements, key: Node | None, vector: str, entry: str) -> Said:
    """What the key says; `text` is None for what no key of a file says, and for what is no vector of numbers."""
    traced = elements.traced
    if key is None or vector not in VECTORS:
        return Said(None, None, None)
    for row in rows(traced.model, key, vector, traced.watch):
        if name_of(row.holder) == entry:
            if row.key is None:
                return Said(row.holder, None, None)
            text = row.key.attributes.get(vector)
            return Said(row.holder, text, row.key.span(traced.model.origins, vector))
    return Said(None, key.get(vector), traced.written_at(key, vector))
