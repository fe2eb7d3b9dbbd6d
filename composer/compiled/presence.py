"""Elements that a composition lacks, and foreign elements with a part's prefix."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from composer.compiled.correspondence import ABSENT, Correspondence
from composer.compiled.difference import EXTRA, MISSING, Difference
from composer.compiled.kinds import KINDS, ON_BODIES, Model, NameTable


def presence_differences(
    matching: Correspondence, others: Sequence[tuple[str, Model]] | None
) -> list[Difference]:
    """Return missing elements; with ``others``, extra ones as well. ``keyframes`` handles keys."""
    rosters = None if others is None else [(prefix, NameTable(model)) for prefix, model in others]
    found: list[Difference] = []
    for kind in KINDS:
        if kind == "key":
            continue
        found += _missing(matching, kind)
        if rosters is not None and matching.prefix:
            found += _extra(matching, kind, rosters)
    return found


def _missing(matching: Correspondence, kind: str) -> list[Difference]:
    """Return missing elements; an unnamed element on a missing body is not reported again."""
    roster, bodies = matching.alone, matching.ids["body"]
    owners = getattr(roster.model, ON_BODIES[kind]).tolist() if kind in ON_BODIES else None
    found: list[Difference] = []
    for index, target in enumerate(matching.ids[kind]):
        name = roster.names[kind][index]
        if target != ABSENT or (owners is not None and not name and bodies[owners[index]] == ABSENT):
            continue
        shown = matching.name(kind, name) if name else roster.describe(kind, index)
        found.append(Difference(kind, shown, MISSING, expected=True, actual=False))
    return found


def _extra(matching: Correspondence, kind: str, others: Iterable[tuple[str, NameTable]]) -> list[Difference]:
    prefix = matching.prefix
    theirs = {other + name for other, roster in others for name in roster.names[kind] if name}
    return [
        Difference(kind, name, EXTRA, expected=False, actual=True)
        for index, name in enumerate(matching.composed.names[kind])
        if name.startswith(prefix)
        and name != prefix
        and name not in theirs
        and index not in matching.taken[kind]
        and not (kind == "body" and index in matching.worlds)
    ]
