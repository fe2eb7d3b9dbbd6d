"""The edits and draws of a whole recipe, in two rounds. Those about keys come last, when the keys are laid out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import TYPE_CHECKING

from lxml import etree
from lxml.etree import _Element as Node

from composer.compose.edit import edit, is_of_keys
from composer.compose.edit_cost import EditCost
from composer.compose.editing import Editing
from composer.compose.elements import ElementBuilder
from composer.compose.randomize import draw_values
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping as Located
from composer.document.node import texts
from composer.link.key_layouts import keys_of
from composer.link.keyframes import lay_out_replaced
from composer.link.linking import Linking
from composer.plan.drawn import Drawn, ElementDraws
from composer.plan.foreseen import EditOutcome, Place
from composer.plan.plan import Plan
from composer.plan.steps.edit_elements import EditElements

if TYPE_CHECKING:
    from composer.compose.workshop import Workshop

# Errors that do not depend on what is missing: a name, an attribute or a selector that is wrong in any model.
_CERTAIN = ("selector", "unknown-name", "unknown-attribute")
_UNNAMING = {"remove", "rename"}  # after which an element does not have its name any more
_SECTIONS_WITHOUT_NAMES = ("edit", "randomize", "check", "keyframe")


@dataclass(frozen=True, slots=True)
class ModelEdits:
    """The edits and draws of a recipe on its model. Draws are appended to `drawn` and `tabled`."""

    plan: Plan
    linking: Linking
    making: ElementBuilder
    parts: Mapping[Node, str]
    cost: EditCost
    outcomes: dict[Place, EditOutcome]
    workshop: Workshop
    drawn: list[Drawn] = field(default_factory=list)
    tabled: list[ElementDraws] = field(default_factory=list)

    def of_elements(self) -> None:
        """Carry out all edits and draws, except for those about keys."""
        self._edit(of_keys=False)
        self._draw(of_keys=False)

    def in_doubt(self) -> bool:
        """Carry out edits on a model that lacks what has errors elsewhere, to find more errors.

        Only edits that select one name are carried out, and only errors that do not depend on what is missing are
        reported. Return whether the elements have the names to which keys refer.
        """
        making, own = self.making, self.making.sink
        making.sink = self.linking.sink = aside = own.fork()
        aside.suppress_about(_declared(self.plan.document))
        try:
            return self._edit_by_name(aside)
        finally:
            making.sink = self.linking.sink = own
            for each in aside.errors:
                if each.code in _CERTAIN:
                    own.add(each)

    def _edit_by_name(self, sink: Sink) -> bool:
        editing = self._editing()
        for step in self.plan.edits:
            before, selector = sink.error_count, step.edit.select
            is_certain = selector.is_one_name and not sink.suppresses(selector.pattern)
            if is_certain and not is_of_keys(step):
                self._carry_out(step, editing)
            if "rename" in step.edit.verbs and (not is_certain or sink.error_count > before):
                return False
        return True

    def of_keys(self) -> None:
        """Carry out edits and draws about keys. The edits do not change the keys that the recipe itself writes."""
        if any(is_of_keys(step) for step in self.plan.edits):
            places = self._taken_out()
            self._edit(of_keys=True)
            self._put_back(places)
        self._draw(of_keys=True)

    def _edit(self, of_keys: bool) -> None:
        editing = self._editing()
        replaced = lay_out_replaced(self.linking) if of_keys else []
        for step in self.plan.edits:
            if is_of_keys(step) == of_keys:
                # Any other change to a key that the recipe replaces would be lost.
                stand_ins = replaced if _UNNAMING & step.edit.verbs.keys() else []
                replaced = self._edited_beside(step, editing, stand_ins) if stand_ins else replaced
                if not stand_ins:
                    self._carry_out(step, editing)
                self.linking.watch(self.linking.units, step)

    def _carry_out(self, step: EditElements, editing: Editing) -> None:
        outcome = edit(step, editing, self.workshop)
        if outcome is not None:
            self.outcomes[self.plan.place_of(step.edit.at)] = outcome

    def _draw(self, of_keys: bool) -> None:
        """Write draws into the model after all edits."""
        editing = self._editing()
        for step in self.plan.draws:
            if is_of_keys(step) == of_keys:
                values, rows = draw_values(step, editing)
                self.drawn.extend(values)
                self.tabled.extend(rows)
                self.linking.watch(self.linking.units, step)

    def _editing(self) -> Editing:
        plan = self.plan
        return Editing(
            self.linking,
            self.making,
            plan.scope,
            parts=self.parts,
            cost=self.cost,
            motors=plan.motors,
        )

    def _edited_beside(self, step: EditElements, editing: Editing, keys: list[Node]) -> list[Node]:
        """Carry out an edit on a model that also has the keys which are replaced later.

        Return those of them that are still to be replaced: an edit may have removed or renamed some.
        """
        names = [str(key.get("name")) for key in keys]
        self.linking.base.section("keyframe").extend(keys)
        for key in keys:
            editing.note(key)
        self._carry_out(step, editing)
        left = [
            key
            for key, name in zip(keys, names, strict=True)
            if key.getparent() is not None and key.get("name") == name
        ]
        for key in left:
            editing.forget(key)
            _section(key).remove(key)
        return left

    def _taken_out(self) -> list[tuple[Node, Node]]:
        """Take the recipe's own keys out of the model. Return each with the comment that marks its place."""
        names = {key.name for key in self.linking.keys.written}
        places: list[tuple[Node, Node]] = []
        for key in keys_of(self.linking.base):
            if key.get("name") in names:
                place = etree.Comment("")
                _section(key).replace(key, place)
                places.append((key, place))
        return places

    def _put_back(self, places: list[tuple[Node, Node]]) -> None:
        base = self.linking.base
        others = {key.get("name"): key for key in keys_of(base)}
        for key, place in places:
            section = place.getparent()
            if section is None or section.getparent() is not base.root:
                base.section("keyframe").append(key)
            else:
                section.replace(place, key)
            if (other := others.get(key.get("name"))) is not None:
                self.making.sink.error(
                    "name-clash",
                    f"a key cannot be called `{key.get('name')}`: the recipe writes a key of that name",
                    base.origins.span(other, base.file, "name"),
                    notes=(Note("the other one", base.origins.span(key, base.file)),),
                    help="choose another name",
                    subjects=(str(key.get("name")),),
                )


def _section(key: Node) -> Node:
    section = key.getparent()
    assert section is not None
    return section


def _declared(document: Located) -> Iterator[str]:
    """Yield every text that may be the name of something that does not exist because of another error."""
    for section, (_, value) in document.entries.items():
        if section not in _SECTIONS_WITHOUT_NAMES:
            yield from texts(value)
