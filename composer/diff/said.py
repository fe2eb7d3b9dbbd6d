"""What the keyframes of files say of one joint, actuator or body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from composer.diagnostics.span import Span
from composer.diff.elements import Elements
from composer.explain.query import name_of
from composer.explain.rows import VECTORS

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
    found = [each for each in traced.key_rows(key, vector) if name_of(each[0]) == entry]
    if found:
        said_by = [row for _, row in found if row.origin not in ("reference", "zero", "unknown")]
        text = " ".join(row.written or row.value for row in said_by)
        return Said(found[0][0], text or None, said_by[0].reason.span if said_by else None)
    return Said(None, key.get(vector), traced.written_at(key, vector))
