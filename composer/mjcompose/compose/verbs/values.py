"""The verbs `set`, `scale` and `offset`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from operator import add, mul
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.compose.checks import check_angles_of_targets, check_class_angles, refer_to_top_class
from mjcompose.compose.editing import Editing, take_files
from mjcompose.compose.elements import settle_joints, turned, update_node
from mjcompose.compose.values import POLYNOMIALS, EntryValues, Masses, UnusableValue, report_unusable
from mjcompose.language.assign import MASS
from mjcompose.language.select import unknown_attribute
from mjcompose.language.value import (
    RecipeElement,
    Value,
    attribute_and_index,
    bare_angle,
    is_angular,
    no_angle,
    read_value,
)
from mjcompose.link import numbers
from mjcompose.link.key_layout import joint_type
from mjcompose.link.subtree import DroppedElement
from mjcompose.text.expression import Angle
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, ORIENTATIONS, levels
from mjcompose.tree.edit import changing, replace, resolves, unresolved
from mjcompose.tree.grammar import Attribute, to_text
from mjcompose.tree.names import own_references
from mjcompose.tree.select import kind_of, section_of
from mjcompose.tree.values import check_python, is_in_degrees, may_be_angle

if TYPE_CHECKING:
    from mjcompose.compose.mesh_jobs import MeshResult, MeshWorkshop


class Entry(Struct, frozen=False):
    """The elements that an entry selects, `checks` that wait for all values, and the removed and created elements."""

    editing: Editing
    found: list[Node]
    masses: Masses
    workshop: MeshWorkshop
    checks: list[Callable[[], None]] = field(default_factory=list)
    gone: list[DroppedElement] = field(default_factory=list)
    records: list[MeshResult] = field(default_factory=list)

    def check(self) -> None:
        """Run the postponed checks. A verb that makes, renames or removes elements calls this first."""
        while self.checks:
            self.checks.pop(0)()


class Operation(Struct):
    """One of the verbs: `combine` takes the present number and the recipe's, which has no unit if it `is_factor`."""

    verb: str
    combine: Callable[[float, float], float]
    is_factor: bool = False


SET = Operation("set", lambda _, written: written)
SCALE = Operation("scale", mul, is_factor=True)
OFFSET = Operation("offset", add)

OPERATIONS = {each.verb: each for each in (SET, SCALE, OFFSET)}


def compute(
    values: EntryValues, operation: Operation, attribute: Attribute, subscript: int | None, written: Any, at: Path
) -> None:
    """Replace each number by the result of the operation; a subscript selects one number."""
    editing = values.editing
    node = values.node
    now = _present(values, operation, attribute, subscript=subscript, at=at)
    given = values.of(written, at, values.now(attribute, subscript))
    if isinstance(given, list) and len(given) > len(now):
        message = f"`{attribute.name}` of {editing.called(node)} has {len(now)} numbers, got {len(given)}"
        report_unusable(editing, node, Fault("wrong-length", message, at))
    places = [subscript] if subscript is not None else list(range(len(now)))
    if operation is OFFSET and attribute.name in POLYNOMIALS and not isinstance(given, list):
        places = places[:1]  # one number is the linear coefficient, as in MJCF
    items = given if isinstance(given, list) else [given] * len(places)
    angles = set(values.angles(attribute, len(now)))
    if angles and attribute.name == "euler":
        _check_sequence(values, at)
    for place, item in zip(places, items, strict=False):
        now[place] = operation.combine(
            now[place], _number(values, operation, item, attribute=attribute, is_angle=place in angles, at=at)
        )
    result: list[Any] = [
        int(each) if attribute.type == "int" and each == int(each) else each
        for each in _without_defaults(values, attribute, now)
    ]
    if (answer := check_python(attribute, result if attribute.max_length != 1 else result[0])) is not None:
        message = f"`{attribute.name}` of {editing.called(node)} {answer}"
        report_unusable(editing, node, Fault("out-of-range", message, at))
    check_without_ends(values, attribute, at)
    if attribute.is_interval:
        editing.making.intervals[node, attribute.name] = editing.span(at)
    editing.note_value(node, attribute.name, at)
    editing.write(node, {attribute.name: at})
    with editing.writing(node, attribute):
        replace(node, {attribute.name: to_text(attribute, result)})


def _present(
    values: EntryValues, operation: Operation, attribute: Attribute, subscript: int | None, at: Path
) -> list[float]:
    """Return the effective numbers of the attribute, in the model's units. Report missing numbers."""
    editing = values.editing
    node = values.node
    text = editing.effective(node, attribute.name)
    if not attribute.is_number or not text or not text.split():
        help = None
        if attribute.name == MASS:
            help = "its mass comes from its `density`: change that, or the whole mass of its body"
        message = f"{editing.called(node)} has no `{attribute.name}` that `{operation.verb}` could start from"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help=help))
    now = numbers.read(text)
    if subscript is not None and subscript >= len(now):
        message = f"`{at[-1]}` of {editing.called(node)} does not exist: it has {len(now)} numbers"
        report_unusable(editing, node, Fault("wrong-length", message, at, key=True))
    return now


def _without_defaults(values: EntryValues, attribute: Attribute, found: list[float]) -> list[float]:
    """Return the numbers without trailing MuJoCo defaults, since an older MuJoCo may accept fewer numbers."""
    node = values.node
    steps = levels(node, kind_of(node), attribute, classes=values.editing.classes)
    said = max((step.taken.stop for step in steps if step.kind != "mujoco"), default=0)
    default = attribute.default if isinstance(attribute.default, tuple) else ()
    least = max(said, attribute.min_length or 0, 1)
    while len(found) > least and len(found) <= len(default) and found[-1] == default[len(found) - 1]:
        found = found[:-1]
    return found


def _number(
    values: EntryValues, operation: Operation, item: Any, attribute: Attribute, is_angle: bool, at: Path
) -> float:
    """Return the written number. An angle is in the model's unit, unless it is a factor."""
    editing = values.editing
    node = values.node
    making = editing.making
    given = Angle.read(item) if isinstance(item, str) else item
    if isinstance(given, bool) or not isinstance(given, int | float | Angle):
        report_unusable(editing, node, Fault("wrong-type", f"`{at[-1]}` expects a number, got `{item}`", at))
    if operation.is_factor:
        if isinstance(given, Angle):
            report_unusable(editing, node, Fault("wrong-type", "a factor has no unit", at))
        return float(given)
    if is_angle:
        settings = making.angle_context.at(at)
        if not isinstance(given, Angle) and given != 0 and settings.angle is None:
            help = f"write `{given}deg` or `{given}rad`, or `angle: degree` at the top of the recipe"
            message = f"`{attribute.name}` of {editing.called(node)} is an angle and {given} has no unit"
            report_unusable(editing, node, Fault("bare-angle", message, at, help=help))
        radians = numbers.joint_radians if attribute.angle == "joint" else numbers.orientation_radians
        return turned(given, settings, making.model_angle, radians=radians)
    if isinstance(given, Angle) and not may_be_angle(str(node.tag), attribute):
        report_unusable(editing, node, no_angle(f"`{attribute.name}` of {editing.called(node)}", given, at))
    unit = "deg" if is_in_degrees(str(node.tag), attribute.name) else "rad"
    if isinstance(given, Angle) and unit == "rad":
        making.of_targets.append((node, attribute, given, editing.span(at)))
        check_angles_of_targets(editing.linking, making)
    return given.in_unit(unit) if isinstance(given, Angle) else float(given)


def _check_sequence(values: EntryValues, at: Path) -> None:
    editing = values.editing
    node = values.node
    making = editing.making
    if (sequence := making.angle_context.at(at).eulerseq) != making.model_eulerseq:
        sequences = f"the sequence `{making.model_eulerseq}`, the recipe in `{sequence}`"
        message = f"`euler` of {editing.called(node)} turns in {sequences}"
        report_unusable(editing, node, Fault("not-supported", message, at, help="set the whole orientation"))


def set_whole(values: EntryValues, attribute: Attribute, written: Any, at: Path) -> None:
    """Write the value onto the element, convert units and files, and check that references exist."""
    editing = values.editing
    node = values.node
    read = _read(values, attribute, written, at=at)
    check_without_ends(values, attribute, at)
    if written is not None:
        editing.note_value(node, attribute.name, at)
    element = RecipeElement(str(node.tag), {attribute.name: read}, at=at[:-1])
    making = editing.making
    making.made[node] = element
    with editing.writing(node, attribute):
        if attribute.name in ORIENTATIONS or attribute.name == "fromto":
            # MuJoCo 4.0 takes one orientation ("multiple orientation specifiers are not allowed"), so the earlier one
            # has to go.
            replace(node, dict.fromkeys(ORIENTATIONS))
        update_node(node, element, kind_of(node), making=making)
        settle_joints(making, lambda each: joint_type(each, editing.classes), in_edit=True)
    check_class_angles(editing.linking, making)
    check_angles_of_targets(editing.linking, making)
    take_files(editing)
    if attribute.is_reference or attribute.refers_by is not None:
        _check_references(values, attribute, at)


def _read(values: EntryValues, attribute: Attribute, written: Any, at: Path) -> Value:
    """Return the written value in the form that the attribute takes. Report its first fault."""
    editing = values.editing
    node = values.node
    given = values.of(written, at, values.now(attribute))
    faults: list[Fault] = []
    read = read_value(attribute, given, at, owner=editing.called(node), faults=faults, tag=str(node.tag))
    if read is not None and attribute.angle is not None and editing.making.angle_context.at(at).angle is None:
        joint = joint_type(node, editing.classes) if attribute.angle == "joint" else None
        bare = bare_angle(attribute, read, joint, at=at, owner=editing.called(node))
        faults += [bare] if bare is not None else []
    if faults:
        report_unusable(editing, node, faults[0])
    assert read is not None
    return read


def check_units(values: EntryValues, wanted: str, written: Mapping[str, Any], at: Path) -> None:
    """Report unwritten numbers of a joint that its new type, `wanted`, turns from lengths into angles or back."""
    editing = values.editing
    joint = values.node
    now = joint_type(joint, editing.classes)
    for attribute in kind_of(joint).attributes.values():
        turns = is_angular(attribute, now)
        if turns == is_angular(attribute, wanted) or attribute.name in written:
            continue
        text = editing.effective(joint, attribute.name)
        if not text or not any(numbers.read(text)):
            continue
        was, would = ("an angle", "a length") if turns else ("a length", "an angle")
        message = f"`{attribute.name}` of {editing.called(joint)} is {was}, and would be {would} for a {wanted}"
        report_unusable(
            editing, joint, Fault("bare-angle", message, at, help=f"write `{attribute.name}` next to `type`")
        )


def check_without_ends(values: EntryValues, attribute: Attribute, at: Path) -> None:
    """Report a part of the pose that has no effect because `fromto` determines the element's pose."""
    if attribute.name not in ("pos", *ORIENTATIONS):
        return
    editing = values.editing
    node = values.node
    # MuJoCo 4.0 silently ignores an `euler` next to `fromto`, and refuses a `pos`.
    ends = editing.effective(node, "fromto")
    if ends and "nan" not in ends.lower():
        message = f"`{attribute.name}` of {editing.called(node)} has no effect: `fromto` sets it"
        report_unusable(editing, node, Fault("wrong-type", message, at, help="set `fromto` instead"))


def _check_references(values: EntryValues, attribute: Attribute, at: Path) -> None:
    editing = values.editing
    node = values.node
    if attribute.refers == "default" and node.get(attribute.name) == MAIN:
        with changing(editing, node):
            refer_to_top_class(editing.linking, node, attribute.name)
        return
    for name, namespace, value, typed_by in own_references(node, section_of(node)):
        if name == attribute.name and not resolves(editing, namespace, value):
            span = editing.span(at)
            written = f"{name}: {{}}"
            editing.sink.add(unresolved(editing, namespace, value, span=span, written=written, typed_by=typed_by))
            raise UnusableValue


def change_all(entry: Entry, operation: Operation, written: Mapping[str, Any], at: Path) -> None:
    change = ValueChange(entry.editing, operation, entry.masses)
    for index, node in enumerate(entry.found):
        change.carry_out(node, index, written, at=at)


class ValueChange(Struct):
    editing: Editing
    operation: Operation
    masses: Masses

    def carry_out(self, node: Node, index: int, written: Mapping[str, Any], at: Path) -> None:
        """Write the values onto an element, which has the `index` among the selected elements."""
        kind = kind_of(node)
        values = EntryValues(self.editing, node, index, at=at)
        for key, item in written.items():
            path = (*at, key)
            if isinstance(item, dict):
                self._below(node, index, key, written=item, at=path)
                continue
            name, subscript = attribute_and_index(key)
            if kind.path == "body" and name == MASS:
                self._mass(values, item, path)
                continue
            if (attribute := kind.attributes.get(name)) is None:
                report_unusable(self.editing, node, unknown_attribute(name, kind.tag, (kind,), at=path))
            if self.operation is SET and subscript is None:
                if kind.path == "joint" and name == "type":
                    check_units(values, str(values.of(item, path, values.now(attribute))), written, at=path)
                set_whole(values, attribute, item, at=path)
            else:
                compute(values, self.operation, attribute, subscript=subscript, written=item, at=path)

    def _below(self, node: Node, index: int, tag: str, written: Mapping[str, Any], at: Path) -> None:
        """Edit the child with this tag of a class or section, and create it if needed."""
        editing = self.editing
        kind = kind_of(node)
        if tag not in kind.children:
            report_unusable(editing, node, unknown_attribute(tag, str(node.tag), (kind,), at=at))
        if (child := next(node.iterchildren(tag, reversed=True), None)) is None:
            child = node.makeelement(tag)
            # A class's own settings come before the classes nested in it.
            journal.place(node, child, len(node) - len(list(node.iterchildren("default"))))
            editing.making.origins.own(child, editing.span(at, key=True))
            editing.linking.base.forget_classes()
        self.carry_out(child, index, written, at=at)

    def _mass(self, values: EntryValues, written: Any, at: Path) -> None:
        """Change the mass of a body. Its present mass is measured only if something needs it."""
        node = values.node
        needed = not self.operation.is_factor or (isinstance(written, str) and "value" in written)
        now = self.masses.of(node, at) if needed else None
        given = values.of(written, at, now)
        if isinstance(given, bool) or not isinstance(given, int | float):
            report_unusable(self.editing, node, Fault("wrong-type", f"`{MASS}` expects a number, got `{given}`", at))
        self.masses.change(node, self.operation.verb, float(given), now=now, at=at)


def zero_attributes(editing: Editing, nodes: Sequence[Node], keys: Iterable[str]) -> list[str]:
    """Return the attributes, or single numbers of them (`friction[0]`), that are zero on every element."""
    return [key for key in keys if nodes and all(_is_zero(editing, node, key) for node in nodes)]


def report_only_zeros(editing: Editing, nodes: Sequence[Node], key: str, at: Path, help: str) -> None:
    """Warn about a factor for a value that is zero on every element."""
    whose = editing.called(nodes[0]) if len(nodes) == 1 else f"each of the {len(nodes)} selected elements"
    message = f"`{key}` of {whose} is 0, and a factor does not change it"
    notes = [Note(f"{editing.called(nodes[0])} is written here", editing.span_of(nodes[0]))]
    editing.sink.warning("scale-of-zero", message, editing.span(at), notes=notes, help=help)


def _is_zero(editing: Editing, node: Node, key: str) -> bool:
    name, subscript = attribute_and_index(key)
    if (attribute := kind_of(node).attributes.get(name)) is None or not attribute.is_number:
        return False
    values = numbers.read(editing.effective(node, name) or "")
    values = values if subscript is None else values[subscript : subscript + 1]
    return bool(values) and not any(values)
