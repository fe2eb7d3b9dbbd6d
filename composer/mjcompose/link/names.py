"""Pass: every name of a part gets the part's prefix, and every reference follows."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache
from types import MappingProxyType

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.suggest import unknown_name
from mjcompose.link.linking import Linking, Part
from mjcompose.model.classes import MAIN
from mjcompose.model.files import NAMED_AFTER_FILE, stem
from mjcompose.model.grammar import GRAMMAR
from mjcompose.model.names import (
    DECLARES,
    GENERATES,
    LISTS,
    REFERS,
    REFERS_BY,
    WORLD,
    may_be_generated,
    naming_table,
    object_namespace,
    users,
    word,
)
from mjcompose.model.unit import Unit, line_of

Clash = tuple[str, str, Node, Node]
"""Namespace, name, the element that declares it, and the one that did before."""


def dangling_reference(
    linking: Linking,
    unit: Unit,
    prefix: str,
    namespace: str,
    name: str,
    element: Node,
    declared: Collection[str],
) -> None:
    """Report a reference to nothing within a source. Names are reported without the prefix, as in the source."""
    wanted = name.removeprefix(prefix)
    own = [each.removeprefix(prefix) for each in declared]
    attribute = next(
        (str(key) for key, value in element.items() if name in (value, *str(value).split())), None
    )
    linking.sink.add(
        unknown_name(
            word(namespace),
            wanted,
            own,
            linking.span(unit, element, attribute),
            purpose=f", which `<{element.tag}>` refers to,",
            written=f'{attribute}="{{}}"' if attribute else "{}",
        )
    )


def report_repeated(linking: Linking, unit: Unit, prefix: str, clash: Clash) -> None:
    """Report a name that a source itself declares twice."""
    namespace, name, element, earlier = clash
    linking.sink.error(
        _code(namespace),
        f"`{unit.file}` has two elements that are the {word(namespace)} `{name.removeprefix(prefix)}`",
        linking.span(unit, element, "name" if namespace != "default" else "class"),
        notes=(Note("the first one is here", linking.span(unit, earlier)),),
        subjects=(name.removeprefix(prefix),),
    )


def report_clashes(linking: Linking, part: Part, clashes: Sequence[Clash]) -> None:
    """Report all names of a part that the model already has, as one fault."""
    namespace, name, element, earlier = min(clashes, key=lambda clash: line_of(clash[2]) or 0)
    here = linking.span(part.unit, element)
    there = linking.span(_unit_of(linking, earlier), earlier)
    count = len(clashes) - 1
    more = f"; {count} more of its names {'is' if count == 1 else 'are'} taken too" if count else ""
    notes = [Note("it is declared here first", there)]
    if part.span is not None and here != there:
        notes.insert(0, Note("the part declares it here", here))
    linking.sink.error(
        _code(namespace),
        f"`{part.called}` brings the {word(namespace)} `{name}`, and the model has one of that name{more}",
        part.span or here,
        notes=notes,
        help="give the part another prefix"
        if part.prefix
        else "let the part have a prefix: leave `prefix` out",
        subjects=(part.called, name),
    )


def _code(namespace: str) -> str:
    return "class-clash" if namespace == "default" else "name-clash"


def _unit_of(linking: Linking, element: Node) -> Unit:
    root = element.getroottree().getroot()
    return next((unit for unit in linking.units if unit.root is root), linking.base)


_MAY_REPEAT = ("model",)
_NOTHING: Mapping[str, str] = MappingProxyType({})


def names(linking: Linking) -> None:
    """Rename part by part; afterwards `linking.names` knows every name of the model.

    >>> from mjcompose.link.link import print_after
    >>> part = (
    ...     '<worldbody><body name="b"><joint name="j"/></body></worldbody>'
    ...     '<actuator><motor joint="j"/></actuator>'
    ... )
    >>> print_after(names, part)
    part: <worldbody><body name="p/b"><joint name="p/j"/></body></worldbody>
    part: <actuator><motor joint="p/j"/></actuator>
    """
    _rename_unit(linking, linking.base, "", linking.base_class or MAIN, None)
    for part in linking.parts:
        _rename_unit(linking, part.unit, part.prefix, part.top_class, part)


def _rename_unit(linking: Linking, unit: Unit, prefix: str, top_class: str, part: Part | None) -> None:
    found = rename(unit, prefix, top_class, part.outward if part else {})
    _refer_to_keys(linking, unit, prefix, part)
    for namespace, name, element in found.repeated:
        report_repeated(linking, unit, prefix, (namespace, name, element, found.declared(namespace)[name]))
    for namespace, name, element in found.dangling():
        if not may_be_generated(name, unit.root):
            dangling_reference(linking, unit, prefix, namespace, name, element, found.declared(namespace))
    clashes: list[Clash] = []
    known = linking.names.declared
    for namespace, declared in found.all_declared():
        earlier_ones = known.setdefault(namespace, declared)
        if earlier_ones is declared:
            continue
        if namespace not in _MAY_REPEAT and not earlier_ones.keys().isdisjoint(declared.keys()):
            for name in [name for name in declared if name in earlier_ones]:
                clashes.append((namespace, name, declared[name], earlier_ones[name]))
                declared[name] = earlier_ones[name]  # the first one keeps it
        earlier_ones.update(declared)
    if part is not None and clashes:
        report_clashes(linking, part, clashes)


def _refer_to_keys(linking: Linking, unit: Unit, prefix: str, part: Part | None) -> None:
    """Change references from tuples to keys to the names that the keys will have."""
    policy = linking.request.base_keyframes if part is None else part.keyframes
    members = [each for custom in unit.root.iterchildren("custom") for each in custom.iter("element")]
    for element in members:
        if element.get("objtype") != "key":
            continue
        name = str(element.get("objname") or "")
        own = [str(key.get("name") or "") for key in unit.root.iterfind("keyframe/key")]
        # A tuple of a key that is not in the model is an error: "unrecognized object 'k' in tuple 0" in MuJoCo 4.0.
        if name not in own and may_be_generated(name, unit.root):
            element.set("objname", prefix + name)  # of a model that MuJoCo attaches
        elif name not in own:
            dangling_reference(linking, unit, "", "key", name, element, own)
        elif policy == "prefix":
            element.set("objname", prefix + name)
        elif (
            policy == "none" and linking.request.requested_keys is None
        ):  # else it may be one that the recipe writes
            linking.sink.error(
                "unknown-name",
                f"a tuple refers to the key `{name}`, which `drop: [key]` leaves out",
                linking.span(unit, element, "objname"),
                help="leave out the tuple, too: `drop: [tuple]`",
                subjects=(name,),
            )


class UnitNames:
    """The names of one unit, as in the model, by slot (see `_slots`), each with the first element that has it.

    `repeated` has the elements that declare a name again.
    """

    def __init__(self) -> None:
        self.by_slot: list[dict[str, Node]] = [{} for _ in range(2 * len(_namespaces()) + 2)]
        self.repeated: list[tuple[str, str, Node]] = []

    def declared(self, namespace: str) -> dict[str, Node]:
        return self.by_slot[_slot(namespace)]

    def references(self, namespace: str) -> dict[str, Node]:
        return self.by_slot[_slot(namespace, wanted=True)]

    def all_declared(self) -> Iterator[tuple[str, dict[str, Node]]]:
        """Yield every namespace in which names are declared, with these names."""
        return (
            (namespace, names)
            for namespace, names in zip(_namespaces(), self.by_slot[1:], strict=False)
            if names
        )

    def repeat(self, namespace: str, name: str, element: Node) -> None:
        if namespace not in _MAY_REPEAT:
            self.repeated.append((namespace, name, element))

    def dangling(self) -> Iterator[tuple[str, str, Node]]:
        """Yield the namespace, the name and the referring element of each reference to an undeclared name."""
        spaces = _namespaces()
        for slot, wanted in enumerate(self.by_slot[1 + len(spaces) : -1], 1):
            if wanted and not wanted.keys() <= (declared := self.by_slot[slot]).keys():
                yield from ((spaces[slot - 1], name, wanted[name]) for name in wanted if name not in declared)


@cache
def _namespaces() -> tuple[str, ...]:
    return tuple(sorted(GRAMMAR.namespaces))


@cache
def _slot(namespace: str, wanted: bool = False) -> int:
    """Return the slot for the declared names of a namespace, or with `referred` for the names that are referred to."""
    return 1 + _namespaces().index(namespace) + (len(_namespaces()) if wanted else 0)


@cache
def _slots(section: str) -> dict[str, dict[str, int]]:
    """Return the naming table of a section, with the slot of each name instead of its kind.

    0 is a value that wants a closer look. Names that are declared come next, by namespace, then those that are
    referred to. The last slot is for references in a class, which are not looked up: nothing may take them.
    """
    spaces = _namespaces()
    # What shares a namespace the grammar says: all actuators do, joints with free joints do, frames with bodies do not.
    # MuJoCo 4.0 calls `<freejoint name="j"/>` beside `<joint name="j"/>` a repeated name.
    table: dict[str, dict[str, int]] = {}
    for tag, actions in naming_table(section).items():
        row = table[tag] = {}
        for name, (kind, namespace) in actions.items():
            if kind == DECLARES and namespace != "key":
                row[name] = _slot(namespace)
            elif kind == REFERS and namespace != "key":
                row[name] = 1 + 2 * len(spaces) if section == "default" else _slot(namespace, wanted=True)
            else:
                row[name] = 0
        if section in ("asset", "deformable") and tag in NAMED_AFTER_FILE:
            row["file"] = 0
    return table


def rename(unit: Unit, prefix: str, top_class: str, outward: Mapping[str, str] = _NOTHING) -> UnitNames:
    """Prefix the names of a unit in place, and return its names; `outward` is that of a part.

    This is the one walk over every element of every part: an attribute that holds no name costs one look into a
    dictionary, one that does is written and noted at once.
    """
    found = UnitNames()
    by_slot = found.by_slot
    last_declared = len(_namespaces())
    for section in unit.root.iterchildren("*"):
        table = _slots(section.tag)
        if not table:
            continue
        for element in section.iterdescendants("*"):
            slots = table.get(element.tag)
            if slots is None:
                continue
            items: list[tuple[str, str]] = element.items()  # type: ignore[assignment]  # of a parsed tree
            for key, value in items:
                if key in slots:
                    slot = slots[key]
                    if not slot or not value:
                        if key == "file":
                            _name_asset(found, element, value, prefix)
                        else:
                            _rename_special(found, element, key, value, prefix, section, outward)
                        continue
                    if outward and value in outward and slot > last_declared:
                        element.set(key, outward[value])
                        continue
                    if prefix:
                        value = prefix + value
                        element.set(key, value)
                    if by_slot[slot].setdefault(value, element) is not element and slot <= last_declared:
                        found.repeat(_namespaces()[slot - 1], value, element)
    # MuJoCo 4.0 refuses `<composite>`, which older models have; what it makes is named by its `prefix`.
    for composite in unit.root.iter("composite") if prefix else ():
        if "prefix" not in composite.attrib:
            composite.set("prefix", prefix)
    # Nobody declares these two.
    # `world` is always the whole model's, and nothing else may have the name: `<body name="world"/>` is a repeated name
    # in MuJoCo 4.0. `main` is that of the unit, which is wrapped.
    for namespace, reserved, meant in (("body", WORLD, WORLD), ("default", MAIN, top_class)):
        if (
            found.references(namespace).pop(prefix + reserved, None) is not None
            and prefix + reserved != meant
        ):
            for section in unit.root.iterchildren("*"):
                for element, key in users(section, namespace, prefix + reserved):
                    element.set(key, meant)
    return found


def _rename_special(
    found: UnitNames,
    element: Node,
    key: str,
    value: str,
    prefix: str,
    section: Node,
    outward: Mapping[str, str],
) -> None:
    """Rename a value that is not a plain name: empty, a list, a prefix of names, or a name typed by a sibling."""
    kind, namespace = naming_table(str(section.tag))[str(element.tag)][key]
    name = prefix + value
    if namespace == "key" or (not value and kind != GENERATES):
        return  # keys are named when they are laid out
    if kind == LISTS:
        names = []
        for each in value.split():
            names.append(each if each == WORLD else outward.get(each, prefix + each))
            if each != WORLD and each not in outward:
                found.references(namespace).setdefault(prefix + each, element)
        name = " ".join(names)
    elif kind == REFERS_BY:
        target = object_namespace(element, namespace)
        if value == WORLD and target in (None, "body"):
            return
        if target == "key":
            return  # see `_refer_to_keys`
        if value in outward:
            name = outward[value]
        elif target:
            found.references(target).setdefault(name, element)
    if name != value:
        element.set(key, name)


def _name_asset(found: UnitNames, element: Node, file: str, prefix: str) -> None:
    """If MuJoCo takes the name from the file and a prefix is needed, write the name with the prefix."""
    if element.get("name") or not file:
        return
    tag = str(element.tag)
    # MuJoCo 4.0 takes the name from the file, without its last suffix: `<mesh file="x.y.obj"/>` is the mesh `x.y`.
    name = prefix + stem(file)
    if prefix:
        element.set("name", name)
    if found.declared(tag).setdefault(name, element) is not element:
        found.repeat(tag, name, element)
