"""New values for attributes: what `set`, `scale` and `offset` share."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Any

from lxml.etree import _Element as Node

from composer.compose.class_angles import check_class_angles
from composer.compose.edit_values import POLYNOMIALS, Unusable, Values
from composer.compose.editing import Editing, is_angular
from composer.compose.elements import settle_joints, update
from composer.compose.mass import Masses
from composer.compose.reference_check import refer_to_top_class
from composer.compose.verbs.entry import Entry
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.span import Span
from composer.expr.angle import Angle
from composer.grammar.attribute import Attribute
from composer.grammar.check import check_python
from composer.grammar.degrees import is_in_degrees
from composer.grammar.element import ElementType
from composer.grammar.format import to_text
from composer.link import numbers
from composer.link.files import add_file
from composer.link.layout import joint_type
from composer.reading.door import Door
from composer.reading.refused import Refused
from composer.recipe.angles import bare_angle
from composer.recipe.element import Element
from composer.recipe.fault import Fault, Path
from composer.recipe.select import unknown_attribute
from composer.recipe.subscript import attribute_and_index
from composer.recipe.value import read_value
from composer.recipe.verbs.values import MASS
from composer.tree.attributes import assign, changing, replace
from composer.tree.classes import MAIN, ORIENTATIONS
from composer.tree.effective import levels
from composer.tree.files import written_path
from composer.tree.kinds import kind_of, section_of
from composer.tree.names import own_references
from composer.tree.references import resolves, unresolved


def change_all(entry: Entry, verb: str, written: Mapping[str, Any], at: Path) -> None:
    """Give the attributes of every selected element new values, by one of the verbs `set`, `scale`, `offset`."""
    for index, node in enumerate(entry.found):
        Change(entry.editing, verb, entry.masses).carry_out(node, index, written, at)


class Change:
    """Gives the attributes of elements new values, by one of the verbs `set`, `scale`, `offset`."""

    def __init__(self, editing: Editing, verb: str, masses: Masses) -> None:
        self.editing, self.verb, self.masses = editing, verb, masses

    def carry_out(self, node: Node, index: int, written: Mapping[str, Any], at: Path) -> None:
        kind = kind_of(node)
        values = Values(self.editing, node, index, at)
        for key, item in written.items():
            path = (*at, key)
            if isinstance(item, dict):
                self._below(node, index, key, item, path)
                continue
            name, subscript = attribute_and_index(key)
            if kind.path == "body" and name == MASS:
                self._mass(values, item, path)
                continue
            attribute = kind.attributes.get(name)
            if attribute is None:
                self._fault(unknown_attribute(name, kind.tag, (kind,), path), node)
            assert attribute is not None
            if self.verb == "set" and subscript is None:
                if kind.path == "joint" and name == "type":
                    wanted = str(values.of(item, path, values.now(attribute)))
                    self._check_units(node, kind, wanted, written, path)
                self._set(values, attribute, item, path)
            else:
                self._reckon(values, attribute, subscript, item, path)

    def _below(self, node: Node, index: int, tag: str, written: Mapping[str, Any], at: Path) -> None:
        """Edit the child with this tag of a class or section, and create it if needed."""
        child_kind = kind_of(node).children.get(tag)
        if child_kind is None:
            self._fault(unknown_attribute(tag, str(node.tag), (kind_of(node),), at), node)
        child = next(node.iterchildren(tag, reversed=True), None)
        if child is None:
            child = node.makeelement(tag)
            # A class's own settings come before the classes nested in it.
            node.insert(len(node) - len(list(node.iterchildren("default"))), child)
            self.editing.making.origins.own(child, self.editing.span(at, key=True))
            self.editing.linking.base.forget_classes()
        self.carry_out(child, index, written, at)

    # -- the verbs ---------------------------------------------------------------------------------------------

    def _set(self, values: Values, attribute: Attribute, written: Any, at: Path) -> None:
        editing, node = self.editing, values.node
        given = values.of(written, at, values.now(attribute))
        faults: list[Fault] = []
        read = read_value(attribute, given, at, editing.called(node), faults)
        joint = joint_type(node, editing.classes) if attribute.angle == "joint" else None
        silent = editing.making.readings.at(at).angle is None
        if read is not None and silent and attribute.angle is not None:
            bare = bare_angle(attribute, read, joint, at, editing.called(node))
            faults += [bare] if bare is not None else []
        for fault in faults[:1]:
            self._fault(fault, node)
        assert read is not None
        if attribute.name in ("pos", *ORIENTATIONS):
            self._without_ends(node, attribute.name, at)
        element = Element(str(node.tag), {attribute.name: read}, at=at[:-1])
        making = editing.making
        making.made[node] = element
        with changing(editing, node):
            if attribute.name in ORIENTATIONS or attribute.name == "fromto":
                # MuJoCo 4.0 takes one orientation ("multiple orientation specifiers are not allowed"), so that the one
                # before has to go.
                replace(node, dict.fromkeys(ORIENTATIONS))
            update(node, element, kind_of(node), making)
            settle_joints(making, lambda each: joint_type(each, editing.classes))
        check_class_angles(editing.linking, making)
        _take_files(editing)
        if attribute.is_reference or attribute.refers_by is not None:
            _check_references(editing, node, attribute, at)

    def _check_units(
        self, joint: Node, kind: ElementType, wanted: str, written: Mapping[str, Any], at: Path
    ) -> None:
        """Report numbers of a joint that change between metres and angles, and must be written again."""
        editing = self.editing
        now = joint_type(joint, editing.classes)
        for attribute in kind.attributes.values():
            turns = is_angular(attribute, now)
            if turns == is_angular(attribute, wanted) or attribute.name in written:
                continue
            text = editing.effective(joint, attribute.name)
            if not text or not any(numbers.read(text)):
                continue
            was, would = ("an angle", "a length") if turns else ("a length", "an angle")
            message = (
                f"`{attribute.name}` of {editing.called(joint)} is {was}, and would be {would} for a {wanted}"
            )
            self._fault(
                Fault("bare-angle", message, at, help=f"write `{attribute.name}` beside `type`"), joint
            )

    def _without_ends(self, node: Node, name: str, at: Path) -> None:
        """Report an attribute that has no effect because `fromto` determines the element's pose."""
        # MuJoCo 4.0 passes over an `euler` beside `fromto` without a word, and refuses a `pos`.
        ends = self.editing.effective(node, "fromto")
        if ends and "nan" not in ends.lower():
            self._fault(
                Fault(
                    "wrong-type",
                    f"`{name}` of {self.editing.called(node)} has no effect: `fromto` says where it is",
                    at,
                    help="set `fromto` instead",
                ),
                node,
            )

    def _reckon(
        self, values: Values, attribute: Attribute, subscript: int | None, written: Any, at: Path
    ) -> None:
        """Compute numbers from the present ones: one of several, a multiple or a sum."""
        editing, node = self.editing, values.node
        text = editing.effective(node, attribute.name)
        if not attribute.is_number or not text or not text.split():
            self._no_number(values, attribute, at)
        assert text is not None
        have = numbers.read(text)
        if subscript is not None and subscript >= len(have):
            message = f"`{at[-1]}` of {editing.called(node)} does not exist: it has {len(have)} numbers"
            self._fault(Fault("wrong-length", message, at, key=True), node)
        now = values.now(attribute, subscript)
        given = values.of(written, at, now)
        if isinstance(given, list) and len(given) > len(have):
            message = (
                f"`{attribute.name}` of {editing.called(node)} has {len(have)} numbers, got {len(given)}"
            )
            self._fault(Fault("wrong-length", message, at), node)
        places = [subscript] if subscript is not None else list(range(len(have)))
        if self.verb == "offset" and attribute.name in POLYNOMIALS and not isinstance(given, list):
            places = places[:1]  # one number is the linear coefficient, as in MJCF
        items = given if isinstance(given, list) else [given] * len(places)
        angles = set(values.angles(attribute, len(have)))
        if angles and attribute.angle != "joint" and attribute.name == "euler":
            self._same_sequence(node, at)
        for place, item in zip(places, items, strict=False):
            number = self._number(item, attribute, place in angles, at, node)
            if self.verb == "scale":
                have[place] *= number
            elif self.verb == "offset":
                have[place] += number
            else:
                have[place] = number
        have = self._without_defaults(node, attribute, have)
        result: list[Any] = [
            int(each) if attribute.type == "int" and each == int(each) else each for each in have
        ]
        answer = check_python(attribute, result if attribute.max_length != 1 else result[0])
        if answer is not None:
            self._fault(
                Fault("out-of-range", f"`{attribute.name}` of {editing.called(node)} {answer}", at), node
            )
        if attribute.name in ("pos", *ORIENTATIONS):
            self._without_ends(node, attribute.name, at)
        if attribute.is_interval:
            editing.making.intervals[node, attribute.name] = editing.span(at)
        editing.write(node, {attribute.name: at})
        assign(editing, node, {attribute.name: to_text(attribute, result)})

    def _without_defaults(self, node: Node, attribute: Attribute, have: list[float]) -> list[float]:
        """Return the numbers without trailing MuJoCo defaults, since an older MuJoCo may accept fewer numbers."""
        steps = levels(node, kind_of(node), attribute, self.editing.classes)
        said = max((step.taken.stop for step in steps if step.kind != "mujoco"), default=0)
        default = attribute.default if isinstance(attribute.default, tuple) else ()
        least = max(said, attribute.min_length or 0, 1)
        while len(have) > least and len(have) <= len(default) and have[-1] == default[len(have) - 1]:
            have = have[:-1]
        return have

    def _number(self, item: Any, attribute: Attribute, is_angle: bool, at: Path, node: Node) -> float:
        """Return the written number. An angle is in the model's unit, unless it is a factor."""
        making = self.editing.making
        given = Angle.read(item) if isinstance(item, str) else item
        if isinstance(given, bool) or not isinstance(given, int | float | Angle):
            self._fault(Fault("wrong-type", f"`{at[-1]}` expects a number, got `{item}`", at), node)
        if self.verb == "scale":
            if isinstance(given, Angle):
                self._fault(Fault("wrong-type", "a factor has no unit", at), node)
            return float(given)  # type: ignore[arg-type]
        if is_angle:
            reading = making.readings.at(at)
            if not isinstance(given, Angle) and given != 0 and reading.angle is None:
                help = f"write `{given}deg` or `{given}rad`, or `angle: degree` at the top of the recipe"
                message = (
                    f"`{attribute.name}` of {self.editing.called(node)} is an angle and {given} has no unit"
                )
                self._fault(Fault("bare-angle", message, at, help=help), node)
            radians = numbers.joint_radians if attribute.angle == "joint" else numbers.orientation_radians
            return making.turned(given, reading, radians)
        unit = "deg" if is_in_degrees(str(node.tag), attribute.name) else "rad"
        return given.in_unit(unit) if isinstance(given, Angle) else float(given)  # type: ignore[arg-type]

    def _same_sequence(self, node: Node, at: Path) -> None:
        making = self.editing.making
        sequence = making.readings.at(at).eulerseq
        if sequence != making.model_eulerseq:
            sequences = f"the sequence `{making.model_eulerseq}`, the recipe in `{sequence}`"
            message = f"`euler` of {self.editing.called(node)} turns in {sequences}"
            self._fault(Fault("not-supported", message, at, help="set the whole orientation"), node)

    def _no_number(self, values: Values, attribute: Attribute, at: Path) -> None:
        editing, node = self.editing, values.node
        help = None
        if attribute.name == MASS:
            help = "its mass comes from its `density`: change that, or the whole mass of its body"
        message = f"{editing.called(node)} has no `{attribute.name}` that `{self.verb}` could start from"
        self._fault(Fault("wrong-type", message, at, key=True, help=help), node)

    def _mass(self, values: Values, written: Any, at: Path) -> None:
        node = values.node
        needed = self.verb != "scale" or (isinstance(written, str) and "value" in written)
        now = self.masses.of(node, at) if needed else None
        given = values.of(written, at, now)
        if isinstance(given, bool) or not isinstance(given, int | float):
            self._fault(Fault("wrong-type", f"`{MASS}` expects a number, got `{given}`", at), node)
        self.masses.change(node, self.verb, float(given), now, at)

    def _fault(self, fault: Fault, node: Node) -> None:
        """Report a fault of one element and stop the entry, since the other elements would have the same fault."""
        editing = self.editing
        notes = fault.all_notes()
        if fault.code != "bare-angle":
            notes.append(Note(f"{editing.called(node)} is written here", editing.span_of(node)))
        editing.sink.error(
            fault.code,
            fault.message,
            editing.span(fault.at, key=fault.key),
            notes=notes,
            help=fault.help,
            subjects=editing.subjects(node),
            fix=fault.fix,
        )
        raise Unusable


def _take_files(editing: Editing) -> None:
    """Resolve the files that edits name relative to the recipe."""
    making, linking = editing.making, editing.linking
    for node, attribute, name in making.files:
        folder, door, span = (
            making.folder_of(node, attribute), making.door_of(node, attribute), making.span_of(node, attribute),
        )  # fmt: skip
        linking.files = [
            use for use in linking.files if use.element is not node or use.attribute != attribute
        ]
        if editing.own:
            _take_own_file(editing, node, attribute, FilePath(os.path.realpath(folder / name)), door, span)
        else:
            add_file(linking, folder, node, attribute, name, door, span)
    making.files.clear()


def _take_own_file(
    editing: Editing, node: Node, attribute: str, file: FilePath, door: Door, span: Span
) -> None:
    """Add a file to the part. The part's own access rules do not apply, because the recipe names the file."""
    try:
        door.admit(file)
    except Refused as refused:
        refused.report(editing.sink, span)
        return
    unit = editing.linking.base
    node.set(attribute, file.as_posix())
    unit.contents = {**unit.contents, written_path(unit.settings, node, file.as_posix()): file}


def _check_references(editing: Editing, node: Node, attribute: Attribute, at: Path) -> None:
    """Report a reference to a name that does not exist."""
    if attribute.refers == "default" and node.get(attribute.name) == MAIN:
        with changing(editing, node):
            refer_to_top_class(editing.linking, node, attribute.name)
        return
    for name, namespace, value, typed_by in own_references(node, section_of(node)):
        if name == attribute.name and not resolves(editing, namespace, value):
            span, written = editing.span(at), f"{name}: {{}}"
            editing.sink.add(unresolved(editing, namespace, value, span, written=written, typed_by=typed_by))
            raise Unusable
