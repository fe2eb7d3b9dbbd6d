"""Steps: `drop` and `edit`, of parts and of the whole model."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Set as AbstractSet
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose import homes
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Path, Span
from mjcompose.base.extensions import ExtensionTable, check_rows
from mjcompose.base.sink import LaterName, Sink
from mjcompose.compose.checks import check_intervals
from mjcompose.compose.editing import Editing, ExpectedCount, count_values, select_counted
from mjcompose.compose.elements import ElementBuilder
from mjcompose.compose.load import PartSource
from mjcompose.compose.randomize import draw_values
from mjcompose.compose.values import Masses, UnusableValue
from mjcompose.compose.verbs.remove import listed_kind, remove
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.assign import flat
from mjcompose.language.edit import VERBS, Drop
from mjcompose.language.verbs.rename import Rename
from mjcompose.language.verbs.set import Set
from mjcompose.link.expansion import element_of
from mjcompose.link.keyframes import keyframes, lay_out_replaced
from mjcompose.link.linking import Linking, LinkRequest
from mjcompose.link.subtree import DroppedElement
from mjcompose.link.unit_keys import keys_of, layouts, remove_keys
from mjcompose.plan.plan import Drawn, DropElements, EditOutcome, ElementDraws, Plan
from mjcompose.plan.steps import DrawValues, EditElements
from mjcompose.text.node import is_template, locate, texts
from mjcompose.tree import journal
from mjcompose.tree.pattern import paths_of
from mjcompose.tree.select import section_of
from mjcompose.tree.unit import KeyValues, PartKeys, Unit

if TYPE_CHECKING:
    from mjcompose.compose.compose import Composer
    from mjcompose.compose.mesh_jobs import MeshWorkshop

EFFECTS: ExtensionTable[Callable[[Any, Entry, Path], None]] = ExtensionTable(
    "verbs", {}, "carry_out", modules=homes.VERBS
)
"""The effect of each verb on the selected elements. It gets the verb's form and its path.

An effect raises `UnusableValue` after an error that it reported.
"""
check_rows("the effects of verbs in composer/mjcompose/homes.py", EFFECTS.own, VERBS.own)

_SETTINGS = ("option", "size", "visual", "statistic")


def drop_elements(entries: Iterable[Drop], editing: Editing, at: Path) -> list[DroppedElement]:
    """Remove the elements that the entries select, and return them in the order of the entries."""
    gone: list[DroppedElement] = []
    for entry in entries:
        path = (*at, entry.index)
        if entry.select is not None:
            found = select_counted(
                editing, entry.select, path, count=ExpectedCount(entry.expect, entry.optional, at=path)
            )
        else:
            found = _elements_of_section(editing, str(entry.section), path)
        if found:
            gone += remove(editing, found, cascade=True, at=path)
    for section in list(editing.root.iterchildren("*")):
        if section.tag != "worldbody" and not len(section) and not section.attrib:
            journal.remove(section)
    return gone


def _elements_of_section(editing: Editing, tag: str, path: Path) -> list[Node]:
    sections = list(editing.root.iterchildren(tag))
    found = sections if tag in _SETTINGS else [each for section in sections for each in section.iterchildren("*")]
    unit = editing.linking.base
    if any(each.path.startswith(f"{tag}/") for each in unit.adopted):
        unit.adopted = tuple(each for each in unit.adopted if not each.path.startswith(f"{tag}/"))
        return found
    if not found:
        message = f"`{editing.linking.base.label}` has nothing in `{tag}` that could be left out"
        editing.sink.error("selector", message, editing.span(path), help=f"remove `{tag}` from `drop`")
    return found


def edit_elements(step: EditElements, editing: Editing, workshop: MeshWorkshop) -> EditOutcome | None:
    """Apply an entry to every element that it selects. Return the outcome, or None after its first error."""
    entry = step.edit
    count = ExpectedCount(entry.expect, entry.optional, at=(*entry.at, "expect"))
    found = select_counted(editing, entry.select, (*entry.at, "select"), count=count, values=count_values(entry.verbs))
    if not found:
        return EditOutcome({}) if (entry.expect == 0 or entry.optional) and not editing.cost.ended else None
    selected = Counter(listed_kind(node, section_of(node)) for node in found)
    work = Entry(editing, found, Masses(editing, found), workshop=workshop)
    if entry.verbs.keys() != {_CONVERTING}:
        editing.actuator_models.clear()
    try:
        for name, verb in entry.verbs.items():
            EFFECTS[name](verb, work, (*entry.at, name))
        work.check()
    except UnusableValue:
        return None
    return EditOutcome(selected, tuple(work.gone), tuple(each.about for each in work.records))


def is_of_keys(step: EditElements | DrawValues) -> bool:
    """Return whether a step is about keys, and therefore waits until they are laid out."""
    select = step.edit.select if isinstance(step, EditElements) else step.field.select
    return select is not None and "keyframe/key" in paths_of(select.tag)


class PartEdits(Struct, frozen=False):
    """Edits a unit. Its keys are laid out again, and edits of keys are carried out after that."""

    plan: Plan
    source: PartSource
    unit: Unit
    composer: Composer

    def carry_out(self) -> tuple[DroppedElement, ...] | None:
        """Carry out the drops and edits. Return the dropped elements, or None after a reported error."""
        plan = self.plan
        source = self.source
        unit = self.unit
        composer = self.composer
        sink = composer.context.sink
        before = composer.context.sink.error_count
        if source.keyframes == "none":
            remove_keys(unit.root)
        linking = Linking(unit, [], sink, request=LinkRequest(plan.separator), measure=composer.measure)
        # This comes first: the numbers of the keys belong to joints and actuators as the source has them.
        layouts(linking)
        editing = self._editing(linking)
        gone: list[DroppedElement] = []
        if source.drops_elements:
            at = (*source.at, "drop")
            entries = tuple(each for each in source.drop if not each.leaves_keys)
            gone = drop_elements(entries, editing, at)
            composer.watch([unit], DropElements(entries, locate(plan.document, at)))
        steps = [EditElements(each, locate(plan.document, each.at)) for each in source.edit]
        self._edit([step for step in steps if not is_of_keys(step)], editing)
        if sink.error_count == before:
            inner = _without_void_numbers(unit.part_keys, linking.keys.void_keys)
            keyframes(linking)
            composer.watch([unit], keyframes)
            unit.part_keys = inner
            self._edit([step for step in steps if is_of_keys(step)], self._editing(linking))
        composer.keys.note_written(linking)
        unit.forget_classes()
        return tuple(gone) if sink.error_count == before else None

    def _editing(self, linking: Linking) -> Editing:
        plan = self.plan
        unit = self.unit
        composer = self.composer
        making = ElementBuilder.of(plan, unit, composer.context, model_angle=unit.settings.angle)
        return Editing(linking, making, plan.scope, own=True, cost=composer.cost, datasheets=plan.datasheets)

    def _edit(self, steps: list[EditElements], editing: Editing) -> None:
        with editing.sink.naming_later(later_names(steps)):
            for step in steps:
                _carry_out(step, editing, self.plan, composer=self.composer)
                self.composer.watch([self.unit], step)
        check_intervals(editing.making)


def later_names(steps: Iterable[EditElements]) -> Iterator[LaterName]:
    """Yield the names that the edits give elements when they are carried out."""
    for step in steps:
        for verb in step.edit.verbs.values():
            if isinstance(verb, Rename) and (names := verb.new_names()) is not None:
                yield LaterName(verb.name, names, step.span)


def _carry_out(step: EditElements, editing: Editing, plan: Plan, composer: Composer) -> None:
    if (outcome := edit_elements(step, editing, composer.mesh_workshop())) is not None:
        composer.edits[plan.place_of(step.edit.at)] = outcome
    editing.sink.has_named(step.span)


def _without_void_numbers(keys: Mapping[str, PartKeys], emptied: AbstractSet[Node]) -> dict[str, PartKeys]:
    """Return the keys of the parts of a nested recipe without the numbers that lost their meaning."""

    def kept(key: KeyValues) -> KeyValues:
        values: dict[str, Any] = {}
        for vector, columns in key.values.items():
            values[vector] = {holder: row for holder, row in columns.items() if element_of(holder) not in emptied}
        return replace(key, values=values)

    return {path: PartKeys(depth, tuple(map(kept, found))) for path, (depth, found) in keys.items()}


# Errors of a name, an attribute or a selector that is wrong in any model.
_CERTAIN = ("selector", "unknown-name", "unknown-attribute")
_CONVERTING = "convert"
_UNNAMING = {"remove", "rename"}  # an element loses its name
_SECTIONS_WITHOUT_NAMES = ("edit", "randomize", "check", "keyframe")


class ModelEdits(Struct):
    """The edits and draws of a recipe on its model; `drawn` and `tabled` are the draws."""

    plan: Plan
    linking: Linking
    making: ElementBuilder
    composer: Composer
    drawn: list[Drawn] = field(default_factory=list)
    tabled: list[ElementDraws] = field(default_factory=list)

    def in_doubt(self) -> bool:
        """Make the edits that select a single name, to find more errors. Return whether keys can refer to the names."""
        making = self.making
        own = self.making.sink
        making.sink = self.linking.sink = aside = own.fork()
        sections = [v for name, (_, v) in self.plan.document.entries.items() if name not in _SECTIONS_WITHOUT_NAMES]
        # Any text may be the name of an element that does not exist because of another error.
        aside.suppress_about(text for section in sections for text in texts(section))
        try:
            return self._edit_by_name(aside)
        finally:
            making.sink = self.linking.sink = own
            own.extend(each for each in aside.errors if each.code in _CERTAIN)

    def _edit_by_name(self, sink: Sink) -> bool:
        editing = self._editing()
        for step in self.plan.edits:
            before = sink.error_count
            selector = step.edit.select
            is_certain = selector.is_one_name and not sink.suppresses(selector.pattern)
            if is_certain and not is_of_keys(step):
                _carry_out(step, editing, self.plan, composer=self.composer)
            if "rename" in step.edit.verbs and (not is_certain or sink.error_count > before):
                return False
        return True

    def of_keys(self) -> None:
        """Carry out edits and draws about keys. The edits do not change the keys that the recipe itself writes."""
        if any(is_of_keys(step) for step in self.plan.edits):
            # A comment marks the place of each of the recipe's own keys.
            names = {key.name for key in self.linking.keys.written}
            own = [key for key in keys_of(self.linking.base) if key.get("name") in names]
            places: list[tuple[Node, Node]] = [(key, etree.Comment("")) for key in own]
            for key, place in places:
                journal.exchange(key, place)
            self.edit(of_keys=True)
            self._put_back(places)
        self.draw(of_keys=True)

    def edit(self, of_keys: bool = False) -> None:
        """Carry out the edits that are about keys, or all others."""
        if not of_keys:
            self._report_turns_without_effect()
        editing = self._editing()
        replaced = lay_out_replaced(self.linking) if of_keys else []
        for step in self.plan.edits:
            if is_of_keys(step) == of_keys:
                # Any other change to a key that the recipe replaces would be lost.
                stand_ins = replaced if _UNNAMING & step.edit.verbs.keys() else []
                replaced = self._edited_beside(step, editing, stand_ins) if stand_ins else replaced
                if not stand_ins:
                    _carry_out(step, editing, self.plan, composer=self.composer)
                self.linking.watch(self.linking.units, step)
        if self.plan.measured is not None and not of_keys:
            # few recipes have a file of measurements
            from mjcompose.language.measured import KINDS
            from mjcompose.plan.measured import check_names

            names = {kind: editing.known_names(kind) for kind in KINDS}
            check_names(self.plan.measured, names, self.making.sink)

    def _report_turns_without_effect(self) -> None:
        """Report turns of one `for` that set the same attribute of the same elements to different values."""
        sink = self.making.sink
        document = self.plan.document
        written: dict[tuple[Span, str, str], tuple[Any, Span]] = {}
        for step in self.plan.edits:
            verb = step.edit.verbs.get("set")
            if step.span.turn is None or not isinstance(verb, Set):
                continue
            selector = repr(replace(step.edit.select, at=()))
            for attribute, value in verb.written.items():
                if any(is_template(text) for _, text in flat({attribute: value})):
                    continue  # it may start from the value of the other turn
                span = locate(document, (*step.edit.at, "set", attribute))
                first, place = written.setdefault((step.span, selector, attribute), (value, span))
                if first != value:
                    message = f"two turns of one `for` set `{attribute}` of `{step.edit.select}`"
                    help = "leave one of them out, or select other elements"
                    sink.error(
                        "name-clash",
                        message,
                        span,
                        notes=[Note(f"the other one,{place.where}", place.source or place)],
                        help=help,
                    )

    def draw(self, of_keys: bool = False) -> None:
        """Write the draws that are about keys, or all others, into the model, after all edits."""
        editing = self._editing()
        for step in self.plan.draws:
            if is_of_keys(step) == of_keys:
                values, rows = draw_values(step, editing)
                self.drawn.extend(values)
                self.tabled.extend(rows)
                self.linking.watch(self.linking.units, step)

    def _editing(self) -> Editing:
        plan = self.plan
        composer = self.composer
        return Editing(
            self.linking, self.making, plan.scope, parts=composer.parts, cost=composer.cost, datasheets=plan.datasheets
        )

    def _edited_beside(self, step: EditElements, editing: Editing, keys: list[Node]) -> list[Node]:
        """Carry out an edit on a model with the keys that are replaced later. Return the keys that are left."""
        names = [str(key.get("name")) for key in keys]
        journal.place_all(self.linking.base.section("keyframe"), keys)
        for key in keys:
            editing.note(key)
        _carry_out(step, editing, self.plan, composer=self.composer)
        left = []
        for key, name in zip(keys, names, strict=True):
            if key.getparent() is not None and key.get("name") == name:
                editing.forget(key)
                journal.remove(key)
                left.append(key)
        return left

    def _put_back(self, places: list[tuple[Node, Node]]) -> None:
        base = self.linking.base
        others = {key.get("name"): key for key in keys_of(base)}
        for key, place in places:
            if (section := place.getparent()) is not None and section.getparent() is base.root:
                journal.exchange(place, key)
            else:
                journal.place(base.section("keyframe"), key)
            if (other := others.get(key.get("name"))) is not None:
                message = f"a key cannot be called `{key.get('name')}`: the recipe writes a key of that name"
                span = base.origins.span(other, base.file, "name")
                notes = (Note("the other one", base.origins.span(key, base.file)),)
                subjects = (str(key.get("name")),)
                help = "choose another name"
                self.making.sink.error("name-clash", message, span, notes=notes, help=help, subjects=subjects)
