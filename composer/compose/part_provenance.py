"""The changes that the edits of a recipe intentionally make to its sources."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from composer.compiled.affected_arrays import arrays_of
from composer.plan.part_record import PartRecord
from composer.recipe.edit import Edit
from composer.recipe.verbs.table import VERBS
from composer.tree.selector import Selector

_HEAD = re.compile(r"[^*?{\[]*")


def with_edits(member: PartRecord, edits: Iterable[Edit]) -> PartRecord:
    """Return the record with the arrays that edits change in the part, or with the reason why it is not compared."""
    changed, reduced = set(member.changed), member.reduced
    for edit in edits:
        if any(VERBS[name].changes is None for name in edit.verbs):
            reduced = reduced or "the recipe takes away, moves or converts elements"
        changed |= {array for tag, name in _changed(edit) for array in arrays_of(name, tag)}
    return replace(member, changed=tuple(sorted(changed)), reduced=reduced)


def reaches(selector: Selector, prefix: str, prefixes: Collection[str]) -> bool:
    """Return whether a selector can match elements of the part with that prefix, judged by the start of names."""
    if selector.pattern.startswith("/"):
        return True
    found = _HEAD.match(selector.pattern)
    head = found[0] if found is not None else ""
    if head != selector.pattern and prefix.startswith(head):
        return True
    return prefix == max((each for each in prefixes if head.startswith(each)), key=len, default=prefix)


def _changed(edit: Edit) -> Iterator[tuple[str | None, str]]:
    """Yield the attributes that an edit changes, each with the tag if it is known."""
    tag = None if "/" in edit.select.tag else edit.select.tag
    for name, value in edit.verbs.items():
        if (changes := VERBS[name].changes) is not None:
            yield from changes(tag, value)
