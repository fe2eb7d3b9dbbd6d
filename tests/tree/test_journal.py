"""The record of changes: what is appended, and which reason a change has."""

from __future__ import annotations

from lxml import etree
from mjcompose.base.diagnostic import Span
from mjcompose.tree import journal
from mjcompose.tree.journal import PARENT, Because, TreeChange, because, explained, recording

HERE = Span("recipe.yaml", 3, 1)


def _words(change: TreeChange) -> str | None:
    reason = None if change.why is None else change.why()
    return None if reason is None else reason.words


def test_a_reason_holds_for_the_changes_in_a_block_that_give_none() -> None:
    record: list[TreeChange] = []
    body = etree.Element("body")
    with recording(record):
        journal.write(body, "name", "before")
        with explained(because("of the block")):
            journal.write(body, "name", "arm")
            journal.write(body, "pos", "0 0 1", because("of its own"))
            journal.place(body, etree.Element("geom"))
        journal.drop(body, "pos")
    assert [(each.what, _words(each)) for each in record] == [
        ("name", None),
        ("name", "of the block"),
        ("pos", "of its own"),
        (PARENT, "of the block"),
        ("pos", None),
    ]


def test_the_inner_reason_counts() -> None:
    record: list[TreeChange] = []
    with recording(record), explained(because("outer")):
        with explained(because("inner")):
            journal.write(etree.Element("geom"), "name", "a")
        journal.write(etree.Element("geom"), "name", "b")
    assert list(map(_words, record)) == ["inner", "outer"]


def test_a_place_is_looked_up_when_somebody_asks() -> None:
    asked: list[str] = []

    def place() -> Span:
        asked.append("asked")
        return HERE

    why = because("written there", place)
    journal.write(etree.Element("geom"), "name", "pad", why)
    assert asked == []
    assert why() == Because("written there", HERE)
