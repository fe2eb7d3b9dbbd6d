"""Steps: the recipe's own elements and sections become MJCF nodes."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import field
from functools import partial
from pathlib import Path
from typing import NamedTuple

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Note, Span
from mjcompose.base.rotation import quat_from_euler
from mjcompose.base.sink import Sink
from mjcompose.language.element import CONFIG
from mjcompose.language.value import RecipeElement, Single, Value, is_angular, no_angle
from mjcompose.link import numbers
from mjcompose.link.angles import in_sequence
from mjcompose.link.files import NamedFile
from mjcompose.link.linking import Linking
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import AngleContext, AngleSettings, AppendElement, SetDefault, SetSingleton
from mjcompose.sources.context import Context
from mjcompose.text.expression import Angle
from mjcompose.text.node import Mapping as Located, Scalar, find, locate
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN
from mjcompose.tree.edit import unresolved
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text
from mjcompose.tree.journal import because
from mjcompose.tree.unit import FileText, Origins, Unit, line_of
from mjcompose.tree.values import is_in_degrees


class WrittenReference(NamedTuple):
    """A name in a node that the recipe wrote. `typed_by` is the attribute with its kind, if any."""

    node: Node
    attribute: str
    namespace: str
    name: str
    typed_by: str


class ElementBuilder(Struct, frozen=False):
    """Turns a recipe's elements into nodes of one model, and records them.

    `angle_context` has the units of the recipe's bare angles, and `model_angle` is the unit of the model. Paths of
    files in messages are relative to `folder`. `door_of_text` returns the door that decides which files a recipe may
    name.

    `made` has the recipe's element for every node, and `fragments` has the line of each node that was written as text
    below a key. `pending` has angles of joints, which wait for their class, and `of_keys` has references to keys, which
    wait for the layout. `of_classes` has numbers in classes, with a flag for angles, and `intervals` has pairs of ends
    with places.
    """

    document: Located
    file: str
    sink: Sink
    angle_context: AngleContext
    model_angle: str
    model_eulerseq: str
    folder: Path
    base_file: str
    origins: Origins
    door_of_text: Callable[[Path], Door]
    made: dict[Node, RecipeElement] = field(default_factory=dict)
    fragments: dict[Node, int] = field(default_factory=dict)
    registered: list[tuple[Node, str]] = field(default_factory=list)
    pending: list[tuple[Node, RecipeElement, str]] = field(default_factory=list)
    of_keys: list[WrittenReference] = field(default_factory=list)
    of_classes: list[tuple[Node, RecipeElement, str, bool]] = field(default_factory=list)
    of_targets: list[tuple[Node, Attribute, Angle, Span]] = field(default_factory=list)
    files: list[tuple[Node, str, str]] = field(default_factory=list)
    intervals: dict[tuple[Node, str], Span] = field(default_factory=dict)

    @classmethod
    def of(cls, plan: Plan, unit: Unit, context: Context, *, model_angle: str) -> ElementBuilder:
        """Return the builder for a plan's recipe in a unit, whose messages then quote the recipe."""
        unit.origins.texts[plan.file] = FileText(plan.path)
        return cls(
            plan.document,
            plan.file,
            context.sink,
            angle_context=plan.angle_context,
            model_angle=model_angle,
            model_eulerseq=unit.settings.eulerseq,
            folder=context.folder,
            base_file=unit.file,
            origins=unit.origins,
            door_of_text=context.door_of_text,
        )

    def span(self, element: RecipeElement, attribute: str | None = None) -> Span:
        """Return where an element is written: its key, or the value of the attribute if it is written there."""
        # `_set_euler` writes an `euler` as a `quat`.
        is_turned = attribute == "quat" and "euler" in element.attributes
        if attribute is not None:
            names = (attribute, "euler") if is_turned else (attribute,)
            for name in names:
                path = (*element.at, name)
                if find(self.document, path) is not None:
                    return locate(self.document, path)
        is_value = element.tag == CONFIG and attribute == "value"  # `config: {KEY: VALUE}`
        return locate(self.document, element.at, key=not is_value)

    def angle_settings_of(self, element: RecipeElement, attribute: str) -> AngleSettings:
        """Return the angle settings for an attribute of an element, which may come from its fragment."""
        path = (*element.at, attribute)
        written = self.angle_context.others and find(self.document, path) is not None
        return self.angle_context.at(path if written else (*element.at, "xml"))

    def span_of(self, node: Node, attribute: str | None = None) -> Span:
        """Return where a node, or the value of its attribute, is written. In a fragment, it searches for the place."""
        return self._span_of(node, self.made[node], self.fragments.get(node), attribute=attribute)

    def _span_of(self, node: Node, element: RecipeElement, start: int | None, attribute: str | None) -> Span:
        if start is None:
            return self.span(element, attribute)
        written = {str(name): str(value) for name, value in node.items()}
        text = self.origins.text(self.file)
        names = [attribute, "euler"] if attribute == "quat" else [attribute] if attribute else []
        tag = str(node.tag)
        if text is None:
            return locate(self.document, (*element.at, "xml"))
        for line in (start, start - 1):  # below the key, or next to it
            place = next((at for name in names if (at := text.attribute(tag, line, written, name=name))), None)
            if place is None and attribute == "name" and text.element(tag, line, written) is not None:
                return locate(self.document, element.at, key=True)
            place = place or text.element(tag, line, written)
            if place is not None:
                return Span(self.file, place.line, place.column, end_line=place.line, end_column=place.end_column)
        return locate(self.document, (*element.at, "xml"))

    def refuse_angle(self, fault: Fault, span: Span) -> None:
        self.sink.error(fault.code, fault.message, span, help=fault.help)

    def named_file(self, node: Node, attribute: str, name: str) -> NamedFile:
        """Return the file that the recipe names by an attribute of a node, relative to the recipe."""
        span = self.span_of(node, attribute)
        folder = (self.folder / span.file).parent
        return NamedFile(node, attribute, name, folder=folder, door=self.door_of_text(folder), span=span)

    def written(self, node: Node) -> Collection[str]:
        if node in self.fragments:
            return [str(name) for name in node.keys()]  # noqa: SIM118 (an element is not a mapping)
        made = self.made.get(node)
        return made.attributes if made is not None else ()

    def place(self, node: Node) -> None:
        """Record where a new node and everything below it come from."""
        for inner in node.iter("*"):
            if inner in self.made:
                # An edit puts another element in `made`, but the node still comes from here.
                element = self.made[inner]
                start = self.fragments.get(inner)
                self.origins.own(inner, partial(self._span_of, inner, element, start))

    def register(self, node: Node, section: str) -> None:
        """Record a new node as `place` does, and register the names in it and below it for a later check."""
        self.place(node)
        self.registered.append((node, section))


def make_node(element: RecipeElement, kind: ElementType, making: ElementBuilder) -> Node:
    if element.xml is not None:  # an MJCF fragment, whose angles are in the recipe's unit
        # A recipe from elsewhere must not open files or addresses.
        parser = etree.XMLParser(remove_blank_text=True, resolve_entities=False, no_network=True)
        node = etree.fromstring(element.xml, parser)
        for name, value in element.attributes.items():
            journal.write(node, name, to_text(kind.attributes[name], value))
        scalar = find(making.document, (*element.at, "xml"))
        line = scalar.span.line if isinstance(scalar, Scalar) else 0
        _read_fragment(node, element, kind, making=making, line=line)
        return node
    node = etree.Element(element.tag)
    making.made[node] = element
    _set_attributes(node, element, kind, making=making)
    for child in element.children:
        if child.tag in kind.children:
            journal.place(node, make_node(child, kind.children[child.tag], making))
    return node


def _set_attributes(node: Node, element: RecipeElement, kind: ElementType, making: ElementBuilder) -> None:
    for name, value in element.attributes.items():
        if name in kind.attributes:
            _set_attribute(node, element, kind.attributes[name], value=value, making=making)


def update_node(node: Node, element: RecipeElement, kind: ElementType, making: ElementBuilder) -> None:
    """Overwrite the attributes of an existing node, and of its children, with a recipe element's attributes."""
    before = making.origins.owner(node, making.base_file)

    def place(attribute: str | None) -> Span:
        if attribute is None or attribute in element.attributes:
            return making.span(element, attribute)
        return making.origins.span_by(before, node, attribute)

    making.origins.update(node, place)
    _set_attributes(node, element, kind, making=making)
    for child in element.children:
        child_kind = kind.children[child.tag]
        if (existing := next(node.iterchildren(child.tag), None)) is None:
            made = make_node(child, child_kind, making)
            journal.place(node, made)
            making.place(made)
        else:
            update_node(existing, child, child_kind, making=making)


def _set_attribute(
    node: Node, element: RecipeElement, attribute: Attribute, value: object, making: ElementBuilder
) -> None:
    name = attribute.name
    if attribute.is_interval:
        making.intervals[node, name] = making.span(element, name)
    if attribute.angle == "orientation-euler" or attribute.angle == "replicate":
        _set_euler(node, element, name, value=value, making=making)
    elif attribute.angle == "orientation-axisangle" and isinstance(value, tuple):
        *axis, angle = value
        inner = turned(angle, making.angle_settings_of(element, name), making.model_angle)
        journal.write(node, name, numbers.text([*map(float, axis), inner]))
    elif attribute.angle == "joint":
        # The `range` of a hinge is an angle, the `range` of a slide a length: in degrees MuJoCo 4.0 compiles
        # `range="0 90"` to 0 1.5708 and to 0 90.
        making.pending.append((node, element, name))
    else:
        if attribute.type == "file":
            making.files.append((node, name, str(value)))
        # `fovy` and `cutoff` are in degrees whatever `<compiler angle="radian"/>` says.
        in_degrees = is_in_degrees(str(node.tag), name)
        if not in_degrees and (angle := first_angle(value)) is not None:
            making.of_targets.append((node, attribute, angle, making.span(element, name)))
        journal.write(node, name, to_text(attribute, _plain(value, "degree" if in_degrees else "radian")))


def _set_euler(node: Node, element: RecipeElement, name: str, value: object, making: ElementBuilder) -> None:
    assert isinstance(value, tuple)
    settings = making.angle_settings_of(element, name)
    angles = [turned(angle, settings, making.model_angle) for angle in value]
    # The schema has no `quat` for a `<replicate>`: only a turn about one axis can be written in another sequence.
    if settings.eulerseq == making.model_eulerseq:
        journal.write(node, name, numbers.text(angles))
    elif node.tag != "replicate":
        radians = [turned(angle, settings) for angle in value]
        journal.write(node, "quat", numbers.text(quat_from_euler(radians, settings.eulerseq)))
    elif (moved := in_sequence(angles, settings.eulerseq, making.model_eulerseq)) is not None:
        journal.write(node, name, numbers.text(moved))
    else:
        sequences = f"in the sequence `{settings.eulerseq}`, the model reads `{making.model_eulerseq}`"
        message = f"`{name}` of a `replicate` turns about several axes {sequences}"
        help = "give each axis a `replicate` of its own"
        making.sink.error("not-supported", message, making.span(element, name), help=help)


_IN_ANGLE = "written in the recipe, in the model's unit of angle"


def settle_joints(making: ElementBuilder, joint_type: Callable[[Node], str], *, in_edit: bool = False) -> None:
    """Write the ranges and references of joints after the classes, and so the joint types, are known.

    An edit gives its own reason for them.
    """
    unit = making.model_angle
    radians = numbers.joint_radians
    for node, element, name in making.pending:
        value = element.attributes[name]
        values = value if isinstance(value, tuple) else (value,)
        kind = joint_type(node)
        angular = is_angular(GRAMMAR.element("joint").attributes[name], kind)
        settings = making.angle_settings_of(element, name)
        as_length = numbers.text([float(_plain(v, "radian")) for v in values])  # type: ignore[arg-type]
        as_angle = numbers.text([turned(v, settings, unit, radians=radians) for v in values])
        why = None if in_edit else because(_IN_ANGLE, partial(making.span_of, node, name))
        journal.write(node, name, as_angle if angular else as_length, why)
        angles = [v for v in values if isinstance(v, Angle)]
        in_class = next(node.iterancestors("default"), None) is not None
        if in_class and (as_angle != as_length or angles):
            making.of_classes.append((node, element, name, angular))
        if angles and not angular:
            making.refuse_angle(no_angle(f"`{name}` of a {kind}", angles[0], ()), making.span_of(node, name))
        bare = [index for index, v in enumerate(values) if not isinstance(v, Angle) and v != 0]
        if angular and bare and settings.angle is None:
            number = values[bare[0]]
            path = (*element.at, name, bare[0])
            is_listed = find(making.document, path) is not None
            span = locate(making.document, path) if is_listed else making.span_of(node, name)
            message = f"`{name}` of a {kind} is an angle and {number} has no unit"
            help = f"write `{number}deg` or `{number}rad`, or `angle: degree` at the top of the recipe"
            making.sink.error("bare-angle", message, span, help=help)
    making.pending.clear()


def joint_attributes(element: RecipeElement, making: ElementBuilder) -> dict[str, str]:
    """Return the attributes of a joint between a place and a part. It has no class unless it names one."""
    kind = GRAMMAR.element("body").children["joint"]
    node = etree.Element("joint", {"class": MAIN})
    making.made[node] = element
    for name, value in element.attributes.items():
        if name != "name" and name in kind.attributes:
            _set_attribute(node, element, kind.attributes[name], value=value, making=making)
    settle_joints(making, lambda joint: str(joint.get("type") or "hinge"))
    return {str(name): str(value) for name, value in node.items()}


def turned(
    value: object,
    settings: AngleSettings,
    unit: str = "radian",
    radians: Callable[[float], float] = numbers.orientation_radians,
) -> float:
    """Return an angle in `unit`, or a bare angle in the recipe's unit; `radians` converts degrees as MuJoCo does."""
    if isinstance(value, Angle):
        number = value.value
        written = "degree" if value.unit == "deg" else "radian"
    else:
        number = float(value)  # type: ignore[arg-type]  # a bare one is 0
        written = settings.angle or unit
    if written == unit:
        return number
    return radians(number) if unit == "radian" else number / numbers.RADIANS_PER_DEGREE


def first_angle(value: object) -> Angle | None:
    return next((each for each in (value if isinstance(value, tuple) else (value,)) if isinstance(each, Angle)), None)


def _plain(value: object, unit: str) -> object:
    """Return an angle such as `90deg` in the unit that MJCF uses for a number that is not a pose."""
    if isinstance(value, tuple):
        return tuple(_plain(item, unit) for item in value)
    if not isinstance(value, Angle):
        return value
    return turned(value, AngleSettings(), unit, radians=numbers.joint_radians)


def pose_number(value: Single) -> float:
    """Return a number of a pose. An angle with a unit is converted to radians."""
    return float(_plain(value, "radian"))  # type: ignore[arg-type]


def _read_fragment(node: Node, element: RecipeElement, kind: ElementType, making: ElementBuilder, line: int) -> None:
    """Read the numbers of a fragment as numbers of the recipe. Its other attributes stay as they are written."""
    values: dict[str, Value] = {}
    written = {str(name): str(text) for name, text in node.items() if name in kind.attributes}
    for name, text in written.items():
        attribute = kind.attributes[name]
        if attribute.angle:
            read = numbers.read(text)
            values[name] = tuple(read) if attribute.max_length != 1 else read[0]
        elif attribute.type == "file":
            values[name] = text
    own = RecipeElement(element.tag, {**element.attributes, **values}, at=element.at)
    making.made[node] = own
    making.fragments[node] = line + (line_of(node) or 1)
    for name, value in values.items():
        if kind.attributes[name].angle in ("orientation-euler", "replicate"):
            journal.drop(node, name)
        _set_attribute(node, own, kind.attributes[name], value=value, making=making)
    for name in written:
        if kind.attributes[name].is_interval:
            making.intervals[node, name] = making.span_of(node, name)
    for child in node.iterchildren("*"):
        if (child_kind := kind.children.get(child.tag)) is not None:
            _read_fragment(child, element, child_kind, making=making, line=line)


def set_singleton(step: SetSingleton, linking: Linking, making: ElementBuilder) -> None:
    """Write `option`, `visual` and the like. The recipe is written last, so its values win."""
    update_node(linking.base.section(step.section), step.element, GRAMMAR.section(step.section), making=making)


def set_default(step: SetDefault, linking: Linking, making: ElementBuilder) -> None:
    """Write the settings of a class, and create the class if needed. `main` is the base's own top class."""
    name = (linking.base_class or MAIN) if step.name == MAIN else step.name
    if (node := linking.names.find("default", name)) is None and name in (MAIN, linking.base_class):
        node = _top_class(linking)
    if node is None:
        own = step.parent is None or step.parent == MAIN
        parent = _top_class(linking) if own else linking.names.find("default", str(step.parent))
        node = etree.Element("default", {"class": name})
        if parent is None:  # the class still counts as declared
            span = making.span(step.element, "parent")
            making.sink.add(unresolved(linking, "default", str(step.parent), span=span, written="parent: {}"))
        else:
            journal.place(parent, node)
        linking.names.declared.setdefault("default", {})[name] = node
        making.origins.own(node, step.span)
    elif step.parent is not None:
        message = f"the default class `{step.name}` exists already, and `parent` is for a new one"
        span = making.span(step.element, "parent")
        notes = (Note(f"`{step.name}` is declared here", linking.span(linking.base, node)),)
        help = "leave `parent` out to change the class, or choose another name"
        making.sink.error("class-clash", message, span, notes=notes, help=help, subjects=(step.name,))
        return
    for child in step.element.children:
        kind = GRAMMAR.element(f"default/{child.tag}")
        if (existing := next(node.iterchildren(child.tag), None)) is None:
            # A class's own settings come before the classes nested in it.
            setting = make_node(child, kind, making)
            journal.place(node, setting, len(node) - len(list(node.iterchildren("default"))))
            making.register(setting, "default")
        else:
            update_node(existing, child, kind, making=making)
            making.made[existing] = child
            making.registered.append((existing, "default"))


def _top_class(linking: Linking) -> Node:
    if not linking.base_class:
        return linking.base.section("default")
    return next(node for node in linking.base.root.iter("default") if node.get("class") == linking.base_class)


def append_element(step: AppendElement, linking: Linking, making: ElementBuilder) -> None:
    section = linking.base.section(step.section)
    child = GRAMMAR.section(step.section).children[step.element.tag]
    node = make_node(step.element, child, making)
    if step.section == "extension":
        # All instances of a plugin are in one element, whichever part declares them.
        existing = next((plugin for plugin in section if plugin.get("plugin") == node.get("plugin")), None)
        if existing is not None:
            journal.place_all(existing, node)
            for instance in existing:
                if instance in making.made:
                    making.register(instance, step.section)
            return
    if linking.base_class is not None and node.get("class") is None and _has_class(child, linking):
        journal.write(node, "class", linking.base_class)
    journal.place(section, node)
    making.register(node, step.section)


def _has_class(kind: ElementType, linking: Linking) -> bool:
    """Return whether an element of a section must name the top class of the base."""
    if (attribute := kind.attributes.get("class")) is None or attribute.since is None:
        return attribute is not None
    # `<texture class="c"/>` is an error before MuJoCo 3.17, in which classes have no settings for textures either.
    return kind.tag in linking.request.isolated_tags or _top_class(linking).find(kind.tag) is not None
