"""Passes: note the unit of each `<replicate>`, write out the replicates that cannot stay, and refuse the others.

MuJoCo (3.12 to 4.0) treats an element as replicated if all names in it still resolve with the copy's number
appended. That includes a sensor without an object, a tuple of assets, and an element that refers to `j1` if there
is a `j10` before the replicate, either written or made by another replicate.

A replicate cannot stay next to another unit if MuJoCo would also multiply elements of that unit, if the model has
another Euler sequence, or if the model is in radians and the multiples of its angles round differently. A replicate
is written out only if nothing outside refers to its contents: MuJoCo multiplies such references itself.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Set
from functools import cache, lru_cache, partial

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Cause, Note
from mjcompose.base.rotation import ORIGIN, Pose, Vec3, rotate
from mjcompose.link import numbers
from mjcompose.link.expansion import Name, copied_names, inner_first, names_of_copies, references_to_copied, suffixes
from mjcompose.link.key_layout import BLOCKS
from mjcompose.link.linking import Linking, shown_name
from mjcompose.link.numbers import orientation_radians
from mjcompose.tree import journal
from mjcompose.tree.cost import scaled_above
from mjcompose.tree.files import read_settings
from mjcompose.tree.journal import because, explained
from mjcompose.tree.names import WORLD, NameIndex, declaration, naming_table
from mjcompose.tree.unit import Unit


@lru_cache(maxsize=16)  # every copy of a part needs the same rows
def copy_poses(
    count: int, offset: Vec3, angles: tuple[float, ...], sequence: str, *, degrees: bool = False
) -> tuple[Pose, ...]:
    """Return the poses of all copies. Copy N is turned by N times each angle; the next one is at `offset` in it."""
    made: list[Pose] = []
    pos = ORIGIN
    for number in range(count):
        turns = [number * angle for angle in angles]
        if degrees:
            turns = [orientation_radians(turn) for turn in turns]
        made.append(Pose(pos, numbers.quat_from_euler(turns, sequence)))
        x, y, z = rotate(made[-1].quat, offset)
        pos = (pos[0] + x, pos[1] + y, pos[2] + z)
    return tuple(made)


_SECTIONS = ("contact", "tendon", "equality", "actuator", "sensor", "custom")
_OF_NOTHING = ("numeric", "text")


def check_replicates(linking: Linking) -> None:
    """Refuse a replicate that would change another unit."""
    waiting = {unit: list(multiplied_elements(unit)) for unit in linking.units if linking.notes.replicates}
    if not any(found for other, found in waiting.items() for unit, _ in linking.notes.replicates if other is not unit):
        return
    places = {element: at for at, element in enumerate(linking.base.root.iter("*"))}
    made = copied_names(linking.base.root)
    reported: set[tuple[Unit, Unit]] = set()
    for unit, replicate in linking.notes.replicates:
        for other, elements in waiting.items():
            if other is not unit and (unit, other) not in reported:
                for element in elements:
                    if resolves_in_copies(linking, element, replicate, places=places, made=made):
                        reported.add((unit, other))
                        _refuse(linking, unit, replicate, other=other, thing=element)
                        break


def multiplied_elements(unit: Unit) -> Iterator[Node]:
    for section in unit.root.iterchildren(*_SECTIONS):
        yield from (each for each in section.iterchildren("*") if each.tag not in _OF_NOTHING)


def resolves_in_copies(
    linking: Linking, thing: Node, replicate: Node, places: Mapping[Node, int], made: Set[Name]
) -> bool:
    """Return whether MuJoCo, when it reads the replicate, also finds the reference with a number appended."""
    names = list(references_of(thing))
    ends = suffixes(replicate)
    here = places.get(replicate, 0)
    if not names or is_made_by(names, ends, linking.names.find, made=made):
        return True
    for element in (linking.names.find(kind, name + end) for kind, name in names for end in ends):
        # MuJoCo reads some sections before the bodies.
        section = None if element is None else element.getparent()
        is_listed = section is not None and section.tag in _SECTIONS
        if element is not None and (is_listed or places.get(element, here) < here):
            return True
    return False


def is_made_by(
    names: Iterable[Name], ends: Collection[str], find: Callable[[str, str], Node | None], made: Set[Name]
) -> bool:
    return any(
        (kind, name + end) in made
        and (element := find(kind, name)) is not None
        and next(element.iterancestors("replicate"), None) is None
        for kind, name in names
        for end in ends
    )


def references_of(thing: Node) -> Iterator[Name]:
    """Yield the references of a thing to something that a replicate copies; a tuple may always refer to the world."""
    section = thing.getparent()
    assert section is not None
    for kind, name in references_to_copied(thing, str(section.tag)):
        if name != WORLD or thing.tag != "tuple":
            yield kind, name


def _refuse(linking: Linking, unit: Unit, replicate: Node, other: Unit, thing: Node) -> None:
    what = f"the `<{thing.tag}>` {shown_name(thing)} of `{other.file}`"
    message = f"the `<replicate>` of `{unit.file}` would multiply {what}, too"
    notes = (Note("MuJoCo would replicate this element", linking.span(other, thing)),)
    help = "write the copies out instead of `<replicate>`"
    linking.sink.error("not-supported", message, linking.span(unit, replicate), notes=notes, help=help)


def replicates(linking: Linking) -> None:
    """Record every replicate, and write out those whose meaning would change in the model."""
    if not linking.parts:
        return
    holding = [unit for unit in linking.units if next(unit.root.iter("replicate"), None) is not None]
    if not holding:
        return
    _write_out_places(linking, holding)
    _write_out_foreign(linking, holding)
    for unit in holding:
        linking.notes.replicates.extend((unit, replicate) for replicate in unit.root.iter("replicate"))


def spare_added(linking: Linking) -> None:
    """Write out the replicates that would multiply other elements, if the recipe added one of the two.

    Report those that cannot be written out.
    """
    base = linking.base
    nests = list(_outermost(base))
    candidates = list(multiplied_elements(base)) if nests else []
    if not candidates:
        return
    added = {each for each in candidates if _is_added(base, each)}
    index_of = cache(lambda unit: NameIndex.of(unit.root))
    places = {element: at for at, element in enumerate(base.root.iter("*"))}
    made = copied_names(base.root)
    linking.names.declared = index_of(base).declared
    for nest in nests:
        inside = list(inner_first(nest))
        resolves = partial(resolves_in_copies, linking, places=places, made=made)
        affected = candidates if _is_added(base, nest) else added
        multiplied = [each for each in affected if any(resolves(each, replicate) for replicate in inside)]
        if multiplied and _is_separate(base, index_of, nest, inside=inside, spared=multiplied):
            for each in inside:
                _write_out(linking, base, each)
            linking.names.declared = NameIndex.of(base.root).declared
            continue
        for element in sorted(multiplied, key=places.__getitem__):
            _refuse_added(linking, element, nest)


def _is_added(base: Unit, element: Node) -> bool:
    return not isinstance(base.origins.owner(element, base.file), str)


def _refuse_added(linking: Linking, element: Node, nest: Node) -> None:
    base = linking.base
    called = shown_name(element)
    place = linking.span(base, nest)
    linking.sink.error(
        "not-supported",
        f"MuJoCo would multiply the `<{element.tag}>` {called} with the contents of a `<replicate>`",
        linking.span(base, element),
        notes=(Note("the `<replicate>`", place),),
        help="write the copies out instead of `<replicate>`",
        cause=Cause(f"multiplied by line {place}", called),
        subjects=(str(element.get("name") or ""),),
    )


_IndexOf = Callable[[Unit], NameIndex]


def original_of(unit: Unit, kind: str, name: str) -> str | None:
    """Return the name in the file of an element whose copy has this name, or None."""
    element = _copied_element(unit, kind, name)
    return None if element is None else str(element.get("name"))


def _copied_element(unit: Unit, kind: str, name: str) -> Node | None:
    inside = unit.root.iterfind(f"worldbody//replicate//{kind}[@name]")
    return next(
        (each for each in inside if name.startswith(str(each.get("name"))) and name in names_of_copies(each)), None
    )


def _write_out_places(linking: Linking, holding: list[Unit]) -> None:
    """Write out the replicates of which one copy is the place of a part, if nothing refers to their content."""
    prefixes = {linking.base: "", **{part.unit: part.prefix for part in linking.parts}}
    for part in linking.parts:
        place = part.place
        if place.name and place.kind != "world":
            for unit in holding:
                name = str(place.name).removeprefix(prefixes[unit])
                element = _copied_element(unit, place.kind, name)
                if unit is part.unit or element is None or not str(place.name).startswith(prefixes[unit]):
                    continue
                nest = list(element.iterancestors("replicate"))[-1]
                inside = list(inner_first(nest))
                if _is_separate(unit, lambda unit: NameIndex.of(unit.root), nest, inside=inside):
                    for each in inside:
                        _write_out(linking, unit, each)


def _write_out_foreign(linking: Linking, holding: list[Unit]) -> None:
    """Write out the replicates that would change another unit, or whose sequence of rotations differs."""
    units = linking.units
    index_of = cache(lambda unit: NameIndex.of(unit.root))
    for unit in holding:
        for nest in list(_outermost(unit)):
            inside = list(inner_first(nest))
            changes = any(_turns_otherwise(linking, unit, each) for each in inside) or any(
                _multiplies(other, index_of, inside) for other in units if other is not unit
            )
            if changes and _is_separate(unit, index_of, nest, inside=inside):
                for other in units:  # as they are before anything is written out
                    index_of(other)
                for each in inside:
                    _write_out(linking, unit, each)


def _outermost(unit: Unit) -> Iterator[Node]:
    found = unit.root.iterfind("worldbody//replicate")
    return (each for each in found if next(each.iterancestors("replicate"), None) is None)


def _turns_otherwise(linking: Linking, unit: Unit, replicate: Node) -> bool:
    """Return whether a replicate's sequence of rotations differs from the model's, or its radians round differently."""
    turning = [angle for angle in numbers.read(str(replicate.get("euler") or "")) if angle]
    if len(turning) > 1 and unit.settings.eulerseq != linking.base.settings.eulerseq:
        return True
    if unit.settings.angle != "degree" or linking.angle != "radian":
        return False
    # MuJoCo multiplies first and converts then: the fourth copy of `euler="1 0 0"` is turned by 3 degrees, which are
    # 0.05235987755982988 radians. Three times one degree in radians ends in 9.
    return any(
        orientation_radians(number * angle) != number * orientation_radians(angle)
        for angle in turning
        for number in range(len(suffixes(replicate)))
    )


def _multiplies(unit: Unit, index_of: _IndexOf, replicates: list[Node], spared: Collection[Node] = ()) -> bool:
    """Return whether one of the replicates may multiply any element of the unit, except for spared elements."""
    found = [each for each in multiplied_elements(unit) if each not in spared]
    if not found:
        return False
    index = index_of(unit)
    ends = {end for replicate in replicates for end in suffixes(replicate)}
    made = copied_names(unit.root)
    for thing in found:
        names = list(references_of(thing))
        # MuJoCo also multiplies elements that refer to nothing, or to an element that a replicate makes. MuJoCo 3.12
        # and 4.0 make four clocks of this one:
        #   <worldbody><replicate count="2"><geom name="g" size=".1"/></replicate></worldbody><sensor><clock/></sensor>
        if not names or is_made_by(names, ends, index.find, made=made):
            return True
        if any(index.find(kind, name + end) is not None for kind, name in names for end in ends):
            return True
    return False


def _is_separate(unit: Unit, index_of: _IndexOf, nest: Node, inside: list[Node], spared: Collection[Node] = ()) -> bool:
    """Return whether the replicate multiplies only its own content, so the copies can be written in the tree."""
    if next(nest.iter(*BLOCKS), None) is not None or scaled_above(nest) is not None:
        return False
    index = index_of(unit)
    for declared in _names_in(nest):
        if any(nest not in user.iterancestors() for user, _ in index.users(*declared)):
            return False
    return not _multiplies(unit, index_of, inside, spared=spared)


def _names_in(top: Node) -> Iterator[tuple[str, str]]:
    return filter(None, (declaration(node, "worldbody") for node in top.iterdescendants("*")))


def _write_out(linking: Linking, unit: Unit, replicate: Node) -> None:
    """Replace the replicate by a frame for each copy. The names in it get the number of the copy."""
    place = unit.origins.lasting_place(replicate, unit.file)
    with explained(because(f"a copy by the `<replicate>` of {unit.file_name}, written out", place)):
        _place_copies(linking, unit, replicate)
    journal.remove(replicate, because("its copies are written out"))


def _place_copies(linking: Linking, unit: Unit, replicate: Node) -> None:
    holder = replicate.getparent()
    assert holder is not None
    settings = read_settings(unit.root)
    table = naming_table("worldbody")
    x, y, z = [*numbers.read(str(replicate.get("offset") or "")), 0.0, 0.0, 0.0][:3]
    angles = tuple(numbers.read(str(replicate.get("euler") or "0 0 0")))
    ends = suffixes(replicate)
    poses = copy_poses(len(ends), (x, y, z), angles, sequence=settings.eulerseq, degrees=settings.angle == "degree")
    declared = set(_names_in(replicate))
    at = holder.index(replicate)
    for number, (pose, end) in enumerate(zip(poses, ends, strict=True)):
        made = copy.deepcopy(replicate)
        for old, new in zip(replicate.iter("*"), made.iter("*"), strict=True):
            unit.origins.own_as(new, old)
            linking.notes.copied[new] = (old, (replicate, number))
            if new is not made:
                journal.note_source(new, old)
        journal.retag(made, "frame")
        journal.drop_all(made)
        if not pose.is_identity:
            # As a quaternion, since the model may read `euler` in another sequence, or in radians.
            journal.write(made, "pos", numbers.text(pose.pos))
            journal.write(made, "quat", numbers.text(pose.quat))
        # In MuJoCo 4.0 the `childclass` of a `<replicate>` counts for its contents, as of a `<frame>`.
        if replicate.get("childclass"):
            journal.write(made, "childclass", str(replicate.get("childclass")))
        for node in made.iterdescendants("*"):
            for attribute, (_, namespace) in table.get(str(node.tag), {}).items():
                name = node.get(attribute)
                if name and (namespace, str(name)) in declared:
                    journal.write(node, attribute, f"{name}{end}")
        journal.place(holder, made, at + number)
