"""Step: carry out an entry of `edit` on a model."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from composer.compose.edit_cost import count_values
from composer.compose.edit_values import Unusable
from composer.compose.editing import Editing
from composer.compose.mass import Masses
from composer.compose.select import select_counted
from composer.compose.verbs.entry import Entry
from composer.compose.verbs.remove import listed_kind
from composer.compose.verbs.table import CARRY_OUT
from composer.plan.foreseen import EditOutcome
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.tree.kinds import section_of
from composer.tree.selector import paths_of

if TYPE_CHECKING:
    from composer.compose.workshop import Workshop


def edit(step: EditElements, editing: Editing, workshop: Workshop) -> EditOutcome | None:
    """Apply an entry to every element that it selects. Report at most one error per entry.

    Return what was changed, or None after an error.
    """
    entry = step.edit
    found = select_counted(
        editing,
        entry.select,
        (*entry.at, "select"),
        expect=entry.expect,
        optional=entry.optional,
        counted_at=(*entry.at, "expect"),
        values=count_values(entry.verbs),
    )
    if not found:
        is_right = entry.expect == 0 or entry.optional
        return EditOutcome({}) if is_right and not editing.cost.ended else None
    selected = Counter(listed_kind(node, section_of(node)) for node in found)
    work = Entry(editing, found, Masses(editing, found), workshop=workshop)
    try:
        for name, value in entry.verbs.items():
            CARRY_OUT[name](work, value, (*entry.at, name))
        work.check()
    except Unusable:
        return None
    return EditOutcome(selected, tuple(work.gone), tuple(each.about for each in work.records))


def is_of_keys(step: EditElements | DrawValues) -> bool:
    """Return whether a step is about keys, and therefore waits until they are laid out."""
    select = step.edit.select if isinstance(step, EditElements) else step.field.select
    return select is not None and "keyframe/key" in paths_of(select.tag)
