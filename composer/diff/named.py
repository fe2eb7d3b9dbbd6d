"""Name the elements of a compiled model in a diff."""

from __future__ import annotations

from composer.compiled.kinds import HOLDERS, NameTable
from composer.compiled.links import links

_TARGETS = 3


def named(roster: NameTable, kind: str, index: int) -> str:
    """Return an element's name; for an unnamed element that is not on a body, also what it refers to."""
    name = roster.describe(kind, index)
    if not name.startswith("#") or kind in HOLDERS:
        return name
    targets = [each for each in links(roster.model, kind, index) if each.index >= 0][:_TARGETS]
    described = ", ".join(f"`{roster.describe(each.kind, each.index)}`" for each in targets)
    return f"{name} ({described})" if described else name
