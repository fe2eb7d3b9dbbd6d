"""Step: `drop` and `edit` of a base or a part, carried out on it alone, with its own names, before it is linked."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import replace
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.compose.drop import drop
from composer.compose.edit import edit, is_of_keys
from composer.compose.edit_cost import EditCost
from composer.compose.editing import Editing
from composer.compose.elements import ElementBuilder
from composer.compose.intervals import check_intervals
from composer.compose.subtree import PartRequest
from composer.context import Context
from composer.dataclass import dataclass
from composer.document.node import locate
from composer.link.key_layouts import layouts, remove_keys
from composer.link.key_meaning import KeyNotes
from composer.link.keyframes import keyframes
from composer.link.linking import Linking, Measure
from composer.link.multiplied import element_of
from composer.link.request import Request
from composer.link.subtree import Left
from composer.plan.foreseen import EditOutcome, Place
from composer.plan.plan import DropElements, Plan
from composer.plan.steps.edit_elements import EditElements
from composer.tree.key import Key, PartKeys
from composer.tree.unit import Unit
from composer.tree.watch import Watch

if TYPE_CHECKING:
    from composer.compose.workshop import Workshop


@dataclass(slots=True)
class PartEdits:
    """Edits a unit. Its keys are laid out anew, and edits of keys are carried out after that."""

    plan: Plan
    wanted: PartRequest
    unit: Unit
    context: Context
    measure: Measure | None
    watch: Watch
    cost: EditCost
    outcomes: dict[Place, EditOutcome]
    workshop: Workshop
    keys: KeyNotes

    def carry_out(self) -> tuple[Left, ...] | None:
        """Carry out the drops and edits. Return what was dropped, or None after a reported error."""
        before = self.context.sink.error_count
        if self.wanted.keyframes == "none":
            remove_keys(self.unit)
        linking = Linking(
            self.unit, [], self.context.sink, request=Request(self.plan.separator), measure=self.measure
        )
        # First of all: the numbers of the keys belong to joints and actuators as the source has them.
        layouts(linking)
        editing = self._editing(linking)
        gone = self._dropped(editing) if self.wanted.drop else []
        steps = [EditElements(each, locate(self.plan.document, each.at)) for each in self.wanted.edit]
        self._edited([step for step in steps if not is_of_keys(step)], editing)
        if self.context.sink.error_count == before:
            inner = _still_meant(self.unit.part_keys, linking.keys.void_keys)
            keyframes(linking)
            self.watch([self.unit], keyframes)
            self.unit.part_keys = inner
            self._edited([step for step in steps if is_of_keys(step)], self._editing(linking))
        self.keys.add(linking)
        self.unit.forget_classes()
        return tuple(gone) if self.context.sink.error_count == before else None

    def _editing(self, linking: Linking) -> Editing:
        plan, unit = self.plan, self.unit
        making = ElementBuilder.of(plan, unit, self.context, model_angle=unit.settings.angle)
        return Editing(
            linking,
            making,
            plan.scope,
            own=True,
            cost=self.cost,
            motors=plan.motors,
        )

    def _dropped(self, editing: Editing) -> list[Left]:
        at = (*self.wanted.at, "drop")
        gone = drop(self.wanted.drop, editing, at)
        self.watch([self.unit], DropElements(self.wanted.drop, locate(self.plan.document, at)))
        return gone

    def _edited(self, steps: list[EditElements], editing: Editing) -> None:
        for step in steps:
            outcome = edit(step, editing, self.workshop)
            if outcome is not None:
                self.outcomes[self.plan.place_of(step.edit.at)] = outcome
            self.watch([self.unit], step)
        check_intervals(editing.making)


def _still_meant(keys: Mapping[str, PartKeys], emptied: Set[Node]) -> dict[str, PartKeys]:
    """Return the keys of the parts of a nested recipe without the numbers that lost their meaning."""

    def kept(key: Key) -> Key:
        values = {
            vector: {holder: row for holder, row in columns.items() if element_of(holder) not in emptied}
            for vector, columns in key.values.items()
        }
        return replace(key, values=values)

    return {path: PartKeys(depth, tuple(map(kept, found))) for path, (depth, found) in keys.items()}
