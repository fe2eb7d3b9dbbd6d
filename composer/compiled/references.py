"""References with another target in a composition than in the part alone."""

from __future__ import annotations

from collections.abc import Sequence

from composer.compiled.correspondence import Correspondence
from composer.compiled.difference import Difference, Value
from composer.compiled.kinds import KINDS, NameTable
from composer.compiled.links import UNORDERED, Link, links


def reference_differences(matching: Correspondence) -> list[Difference]:
    """Return changed references; one whose target is missing is not reported again."""
    found: list[Difference] = []
    for kind in KINDS:
        if kind != "key":
            for index, target in matching.pairs(kind):
                found += _of_one(matching, kind, index, target=target)
    return found


def _of_one(matching: Correspondence, kind: str, index: int, target: int) -> list[Difference]:
    mine = links(matching.alone.model, kind, index)
    theirs = links(matching.composed.model, kind, target)
    if kind in UNORDERED:
        theirs = _in_order_of(matching, mine, theirs)
    found: list[Difference] = []
    for a, b in zip(mine, theirs, strict=False):
        allowed = matching.targets(a)
        if a.kind != b.kind or (allowed and b.index not in allowed):
            name = matching.composed.describe(kind, target)
            found.append(
                Difference(
                    kind, name, a.field, expected=_expected(matching, a), actual=_shown(matching.composed, b)
                )
            )
    return found


def _in_order_of(matching: Correspondence, mine: Sequence[Link], theirs: Sequence[Link]) -> list[Link]:
    first, second = theirs
    return [second, first] if second.index in matching.targets(mine[0]) else [first, second]


def _expected(matching: Correspondence, link: Link) -> Value:
    name = matching.alone.names[link.kind][link.index] if link.index >= 0 else ""
    if not name or (link.kind == "body" and link.index == 0):
        return _shown(matching.alone, link)
    return matching.name(link.kind, name)


def _shown(roster: NameTable, link: Link) -> Value:
    return None if link.index < 0 else roster.describe(link.kind, link.index)
