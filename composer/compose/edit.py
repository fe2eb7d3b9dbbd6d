"""Step: carry out an entry of `edit` on a model."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from composer.compose.class_angles import check_class_angles
from composer.compose.convert import convert
from composer.compose.edit_cost import of_values
from composer.compose.edit_values import POLYNOMIALS, Unusable, Values
from composer.compose.editing import Editing, is_angular
from composer.compose.elements import settle_joints, update
from composer.compose.inertia import inertia
from composer.compose.mass import Masses
from composer.compose.motor import motor
from composer.compose.move import move
from composer.compose.reference_check import refer_to_top_class
from composer.compose.remove import remove, what_it_is
from composer.compose.rename import rename
from composer.compose.select import counted
from composer.compose.unset import missed, report_missed, unset
from composer.compose.zeros import only_zeros, report_only_zeros
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
from composer.link.subtree import Left
from composer.plan.foreseen import EditOutcome
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.reading.door import Door
from composer.reading.refused import Refused
from composer.recipe.angles import bare_angle
from composer.recipe.element import Element
from composer.recipe.fault import Fault, Path
from composer.recipe.rows import check_rows
from composer.recipe.select import unknown_attribute
from composer.recipe.subscript import attribute_and_index
from composer.recipe.value import read_value
from composer.recipe.verbs.remove import CASCADE
from composer.recipe.verbs.table import VERBS
from composer.recipe.verbs.values import MASS
from composer.tree.attributes import assign, changing, replace
from composer.tree.classes import MAIN, ORIENTATIONS
from composer.tree.effective import levels
from composer.tree.files import written_path
from composer.tree.kinds import kind_of, section_of
from composer.tree.names import own_references
from composer.tree.references import resolves, unresolved
from composer.tree.selector import paths_of

if TYPE_CHECKING:
    from composer.compose.workshop import Record


def edit(step: EditElements, editing: Editing) -> EditOutcome | None:
    """Apply an entry to every element that it selects. Report at most one error per entry.

    Return what was changed, or None after an error.
    """
    entry = step.edit
    found = counted(
        editing, entry.select, (*entry.at, "select"), entry.expect, entry.optional, (*entry.at, "expect"),
        of_values(entry.verbs),
    )  # fmt: skip
    if not found:
        is_right = entry.expect == 0 or entry.optional
        return EditOutcome({}) if is_right and not editing.cost.ended else None
    selected = Counter(what_it_is(node, section_of(node)) for node in found)
    work = _Entry(editing, found, Masses(editing, found))
    try:
        for name, value in entry.verbs.items():
            _CARRY_OUT[name](work, value, (*entry.at, name))
        work.check()
    except Unusable:
        return None
    return EditOutcome(selected, tuple(work.gone), tuple(each.about for each in work.records))


def is_of_keys(step: EditElements | DrawValues) -> bool:
    """Return whether a step is about keys, and therefore waits until they are laid out."""
    select = step.edit.select if isinstance(step, EditElements) else step.field.select
    return select is not None and "keyframe/key" in paths_of(select.tag)


@dataclass(slots=True)
class _Entry:
    """An entry that is carried out on the selected elements. `checks` run when all values are written."""

    editing: Editing
    found: list[Node]
    masses: Masses
    checks: list[Callable[[], None]] = field(default_factory=list)
    gone: list[Left] = field(default_factory=list)
    records: list[Record] = field(default_factory=list)

    def check(self) -> None:
        while self.checks:
            self.checks.pop(0)()


def _unset(work: _Entry, value: Any, at: Path) -> None:
    if not isinstance(value, Mapping):
        lacked = {node: missed(work.editing, node) for node in work.found}
        work.checks.append(lambda: report_missed(work.editing, lacked, value, at))
    unset(work.editing, work.found, value, at)


def _assigning(verb: str) -> Callable[[_Entry, Any, Path], None]:
    def assign(work: _Entry, value: Any, at: Path) -> None:
        for index, node in enumerate(work.found):
            Change(work.editing, verb, work.masses).carry_out(node, index, value, at)

    return assign


def _scale(work: _Entry, value: Any, at: Path) -> None:
    zeros = only_zeros(work.editing, work.found, value)
    _assigning("scale")(work, value, at)
    for key in zeros:
        written = f'"{key}"' if "[" in key else key
        help = f"write the value itself, `set: {{{written}: …}}`, or what is added to it, by `offset`"
        report_only_zeros(work.editing, work.found, key, (*at, key), help)


def _convert(work: _Entry, value: Any, at: Path) -> None:
    convert(work.editing, work.found, value, at)


def _inertia(work: _Entry, value: Any, at: Path) -> None:
    inertia(work.editing, work.masses, work.found, value, at)


def _motor(work: _Entry, value: Any, at: Path) -> None:
    def put(node: Node, index: int, values: Mapping[str, Any]) -> None:
        Change(work.editing, "set", work.masses).carry_out(node, index, values, at)

    motor(work.editing, work.found, value, at, put)


def _move(work: _Entry, value: Any, at: Path) -> None:
    pose = {name: each for name, each in value.items() if name != "to"}
    for index, node in enumerate(work.found):
        move(work.editing, node, index, value, at)
        if pose:
            Change(work.editing, "set", work.masses).carry_out(node, index, pose, at)


def _collision(work: _Entry, value: Any, at: Path) -> None:
    from composer.compose.collision import collide  # few recipes need it

    work.check()
    work.records += collide(work.editing, work.found, value, at)


def _simplify(work: _Entry, value: Any, at: Path) -> None:
    from composer.compose.simplify import simplify  # few recipes need it

    work.check()
    work.records += simplify(work.editing, work.found, value, at)


def _rename(work: _Entry, value: Any, at: Path) -> None:
    work.check()  # messages name the elements as they are written
    rename(work.editing, work.found, value, at)


def _remove(work: _Entry, value: Any, at: Path) -> None:
    work.gone += remove(work.editing, work.found, cascade=value == CASCADE, at=at)


_CARRY_OUT: Mapping[str, Callable[[_Entry, Any, Path], None]] = {
    "unset": _unset,
    "set": _assigning("set"),
    "scale": _scale,
    "offset": _assigning("offset"),
    "inertia": _inertia,
    "simplify": _simplify,
    "collision": _collision,
    "convert": _convert,
    "motor": _motor,
    "move": _move,
    "rename": _rename,
    "remove": _remove,
}
check_rows("the verbs of `edit` that composer/compose/edit.py carries out", _CARRY_OUT, VERBS)


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
