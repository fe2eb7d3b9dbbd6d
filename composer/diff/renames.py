"""Detect renames: a whole prefix, or single elements that are otherwise equal."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping

from composer.compiled.kinds import HOLDERS, KINDS, NameTable, holder
from composer.compiled.signature import values

Names = Mapping[str, Mapping[str, str]]
"""A's names mapped to B's, by kind; unchanged names are not listed."""

_ALIKE = 0.6
"""The share of names that two prefixes must have in common to count as one part."""

_SINGLE = ("body", "joint", "geom", "site", "camera", "light", "material", "mesh", "texture", "tendon", "actuator",
           "sensor")  # fmt: skip


def renames(a: NameTable, b: NameTable) -> dict[str, dict[str, str]]:
    """Return the names that changed. Only clear cases count: an element that also changed is another element."""
    lost = {kind: [name for name in a.ids[kind] if name not in b.ids[kind]] for kind in KINDS}
    new = {kind: [name for name in b.ids[kind] if name not in a.ids[kind]] for kind in KINDS}
    found: dict[str, dict[str, str]] = defaultdict(dict)
    for before, after in _prefixes(lost, new, a, b=b):
        for kind in KINDS:
            for name in lost[kind]:
                called = after + name.removeprefix(before)
                if name.startswith(before) and called in b.ids[kind]:
                    found[kind][name] = called
    for kind in _SINGLE:
        taken = set(found[kind].values())
        left = [name for name in lost[kind] if name not in found[kind]]
        free = [name for name in new[kind] if name not in taken]
        found[kind].update(_alike(kind, left, free, a=a, b=b, bodies=found["body"]))
    return {kind: names for kind, names in found.items() if names}


def _prefixes(
    lost: Mapping[str, list[str]], new: Mapping[str, list[str]], a: NameTable, b: NameTable
) -> list[tuple[str, str]]:
    """Return pairs of prefixes, one that only A has and one that only B has, with similar names behind them."""
    gone, come = _behind(lost, b), _behind(new, a)
    pairs = []
    for before, mine in gone.items():
        best = max(come, key=lambda after: _share(mine, come[after]), default=None)
        if best is not None and _share(mine, come[best]) >= _ALIKE:
            pairs.append((before, best))
            del come[best]
    return pairs


def _behind(names: Mapping[str, list[str]], other: NameTable) -> dict[str, set[tuple[str, str]]]:
    """Return the names behind each outermost prefix that the other model lacks."""
    known = {name.partition("/")[0] for by_name in other.ids.values() for name in by_name if "/" in name}
    found: dict[str, set[tuple[str, str]]] = defaultdict(set)
    for kind, by_name in names.items():
        for name in by_name:
            first, separator, rest = name.partition("/")
            if separator and first not in known:
                found[f"{first}/"].add((kind, rest))
    return found


def _share(mine: set[tuple[str, str]], theirs: set[tuple[str, str]]) -> float:
    return len(mine & theirs) / len(mine | theirs)


def _alike(
    kind: str, lost: list[str], new: list[str], a: NameTable, b: NameTable, bodies: Mapping[str, str]
) -> dict[str, str]:
    """Return elements without a double that have equal numbers and are on the same body."""
    if not lost or not new:
        return {}
    mine, theirs = _by_look(kind, lost, a, renamed=bodies), _by_look(kind, new, b, renamed={})
    return {
        names[0]: theirs[look][0]
        for look, names in mine.items()
        if len(names) == 1 and len(theirs.get(look, ())) == 1
    }


def _by_look(
    kind: str, names: list[str], roster: NameTable, renamed: Mapping[str, str]
) -> dict[Hashable, list[str]]:
    found: dict[Hashable, list[str]] = defaultdict(list)
    for name in names:
        index = roster.ids[kind][name]
        owner = roster.names["body"][holder(roster.model, kind, index)] if kind in HOLDERS else ""
        found[(values(roster.model, kind, index), renamed.get(owner, owner))].append(name)
    return found
