"""The meaning of a unit's keys, and the layouts of units and of the finished model, partly measured with MuJoCo.

`BareModel` has little more than a model's joints, actuators and mocap bodies. MuJoCo compiles it in a moment, with
the same names and addresses as the whole model, so it shows the owner of each number of a key. `KeyNotes` has the
bare source of every key, and the keys that recipes write and edit: `verify/kept_keys.py` compares the finished keys
with it.

`layouts` is a pass; it runs while the units are still separate.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field, replace
from itertools import accumulate, product

from lxml.etree import _Element as Node, tostring

from mjcompose.base.dataclass import Struct
from mjcompose.base.rotation import Pose
from mjcompose.link import numbers
from mjcompose.link.expansion import Copy, element_of, ends_of_copies
from mjcompose.link.key_layout import KeyLayout, Slot, Unknown, lay_out
from mjcompose.link.linking import Linking, WrittenKey
from mjcompose.link.measure import attached_slots, flexible_widths, is_expanded, is_measured, strip
from mjcompose.tree import journal
from mjcompose.tree.files import read_settings
from mjcompose.tree.unit import KeyRecord, KeySource, Number, Unit, numbers_of, texts

Within = frozenset[tuple[Node, int]]
"""The number of a copy in each `<replicate>` around it."""
Holder = tuple[Node, Within, str]
"""A joint, actuator or mocap body as MuJoCo makes it: its element, the copy, and its name in a `<flexcomp>`."""

MARK = "\u00b7"
"""The first letter of the names that bare models give to elements without a name."""
# Models that MuJoCo attaches itself, and shapes that it reads from files, are more than a tree.
_BEYOND = ("attach", "composite")
_POSES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")
_KEPT: Mapping[str, tuple[str, ...] | None] = {
    "body": ("name", "mocap", "childclass", *_POSES),
    "frame": ("childclass", *_POSES),
    "replicate": None,
    "joint": ("name", "class", "type", "pos", "axis", "ref", "range", "limited"),
    "freejoint": ("name",),
    "site": ("name",),
}
# They limit or tune, and may name elements that a bare model does not have.
_LEFT_OUT = ("user", "group", "inheritrange", "ctrllimited", "dampratio", "material", "class")
_INERTIA = {"pos": "0 0 0", "mass": "1", "diaginertia": "1 1 1"}


class BareModel(Struct, frozen=False, eq=False):
    """A model as text, with the element of each name in it. `rows` has the length of each row of each key.

    `moves` are the poses of the parts that contain it now, innermost first; `file` is its name in messages.
    """

    file: str
    text: str
    named: dict[tuple[str, str], tuple[Node, Within]]
    flexes: dict[str, tuple[Node, dict[str, Within]]]
    rows: dict[Node, dict[str, int]]
    moves: list[Pose] = field(default_factory=list)

    def holder(self, kind: str, name: str, body: str) -> Holder | None:
        """Return the owner of a joint or another element of the compiled model; `body` is the name of its body."""
        found = self.named.get((kind, name))
        if found is not None:
            return *found, ""
        # `rod_3` and `rod_twist_0` are of `<flexcomp name="rod">`. The first is `rod_30` and `rod_31` in a replicate.
        for flex in (body[:at] for at, letter in enumerate(body) if letter == "_"):
            if flex in self.flexes:
                node, ends = self.flexes[flex]
                if not name and ends:
                    for end, within in ends.items():
                        if body.endswith(end):
                            return node, within, body[len(flex) : len(body) - len(end)]
                return node, frozenset(), body[len(flex) :]
        return None


class KeyNotes(Struct, frozen=False, eq=False):
    """Notes about the keys of a composition.

    `sources` has the bare models by the root of the tree that they are in. `written` has the keys of recipes, `edited`
    the keys with numbers that edits or draws change, `copied` has the elements of written-out replicates, each with its
    origin.
    """

    sources: dict[Node, list[BareModel]] = field(default_factory=dict)
    written: dict[Node, WrittenKey] = field(default_factory=dict)
    edited: set[Node] = field(default_factory=set)
    copied: dict[Node, tuple[Node, tuple[Node, int]]] = field(default_factory=dict)

    def note_source(self, unit: Unit) -> None:
        if keys_of(unit) and (found := bare_model(unit)) is not None:
            self.sources[unit.root] = [found]

    def note_joined(self, linking: Linking) -> None:
        """Note that the parts have become a part of the base, which moves the elements of their worlds."""
        joined = self.sources.setdefault(linking.base.root, [])
        for part in linking.parts:
            found = self.sources.pop(part.unit.root, [])
            pose = linking.pose_in_world(part)
            if pose is not None:
                for each in found:
                    each.moves.append(pose)
            joined += found
        self.copied |= linking.notes.copied

    def note_written(self, linking: Linking) -> None:
        self.written |= linking.keys.noted
        self.edited |= linking.keys.edited_keys
        self.copied |= linking.notes.copied

    def origin(self, node: Node, within: Within) -> tuple[Node, Within]:
        while node in self.copied:
            node, number = self.copied[node]
            within |= {number}
        return node, within


def bare_model(unit: Unit) -> BareModel | None:
    """Return the bare model of a unit, or None if MuJoCo needs more than the tree."""
    root = unit.root
    if next(root.iter(*_BEYOND), None) is not None:
        return None
    flexes = list(root.iter("flexcomp"))
    if any(flex.get("file") or flex.get("mesh") for flex in flexes):
        return None
    named = {
        str(flex.get("name") or ""): (
            flex,
            {end: frozenset(within) for end, within in ends_of_copies(list(flex.iterancestors("replicate"))).items()},
        )
        for flex in flexes
    }
    found = BareModel(unit.file, "", {}, flexes=named, rows={})
    made = root.makeelement("mujoco")
    settings = read_settings(root)
    compiler = made.makeelement("compiler", {"angle": settings.angle, "eulerseq": settings.eulerseq})
    compiler.append(compiler.makeelement("lengthrange", {"mode": "none"}))
    made.append(compiler)
    for section in root.iterchildren("extension", *_SECTIONS):
        if section.tag == "extension":
            made.append(copy.copy(section))
        else:
            _SECTIONS[str(section.tag)](section, made, found)
    keyframe = made.makeelement("keyframe")
    for key in keys_of(unit):
        rows = {vector: str(key.get(vector)) for vector in VECTORS if key.get(vector)}
        keyframe.append(keyframe.makeelement("key", rows))
        found.rows[key] = {vector: len(row.split()) for vector, row in rows.items()}
    made.append(keyframe)
    found.text = tostring(made, encoding="unicode")
    return found


def _default(section: Node, made: Node, found: BareModel) -> None:
    own = _with_attributes(section, made, ("class",))
    for child in section.iterchildren("*"):
        if child.tag == "default":
            _default(child, own, found)
        elif child.tag == "joint":
            own.append(_with_attributes(child, own, _KEPT["joint"]))
        elif child.tag in _ACTUATORS:
            own.append(_actuator(child))
    made.append(own)


def _worldbody(section: Node, made: Node, found: BareModel) -> None:
    # Spatial tendons wrap around geoms.
    wrapped = {str(each.get("geom")) for each in section.getroottree().iterfind("tendon/spatial/geom")}
    own = made.makeelement("worldbody")
    _tree(section, own, found, wrapped=wrapped, around=())
    made.append(own)


def _tree(source: Node, made: Node, found: BareModel, wrapped: set[str], around: tuple[Node, ...]) -> None:
    """Copy the content of a body. `around` are the replicates around it, innermost first."""
    if made.tag == "body":
        made.append(made.makeelement("inertial", _INERTIA))
    for child in source.iterchildren("*"):
        tag = str(child.tag)
        if tag in _KEPT:
            own = _with_attributes(child, made, _KEPT[tag])
            if tag in ("body", "joint", "freejoint"):
                _name(child, own, "joint" if tag == "freejoint" else tag, found=found, around=around)
            made.append(own)
            if tag in ("body", "frame", "replicate"):
                _tree(child, own, found, wrapped=wrapped, around=(child, *around) if tag == "replicate" else around)
        elif tag == "flexcomp":
            own = copy.copy(child)
            own.tail = None
            strip(own)
            made.append(own)
        elif tag == "geom" and child.get("name") in wrapped:
            made.append(
                made.makeelement("geom", {"name": str(child.get("name")), "type": "sphere", "size": ".01", "mass": "0"})
            )


def _tendon(section: Node, made: Node, found: BareModel) -> None:
    own = made.makeelement("tendon")
    for tendon in section.iterchildren("*"):
        each = _with_attributes(tendon, own, ("name",))
        each.extend(copy.copy(child) for child in tendon.iterchildren("*"))
        own.append(each)
    made.append(own)


def _actuators(section: Node, made: Node, found: BareModel) -> None:
    # Actuators that act on something in a replicate are multiplied with it, even through a tendon.
    tree = section.getroottree()
    multiplied: dict[str, list[Node]] = {}
    for each in tree.iterfind("worldbody//replicate//*[@name]"):
        multiplied.setdefault(str(each.get("name")), list(each.iterancestors("replicate")))
    if multiplied:
        for tendon in tree.iterfind("tendon/*[@name]"):
            ends = (str(value) for each in tendon.iter("*") for value in each.attrib.values())
            if around := next((multiplied[end] for end in ends if end in multiplied), None):
                multiplied.setdefault(str(tendon.get("name")), around)
    own = made.makeelement("actuator")
    for actuator in section.iterchildren("*"):
        each = _actuator(actuator)
        if actuator.get("class"):
            each.set("class", str(actuator.get("class")))
        _name(actuator, each, "actuator", found=found, around=())
        acted = (str(value) for name, value in actuator.attrib.items() if name not in ("name", "class"))
        if around := next((multiplied[end] for end in acted if end in multiplied), None):
            _note_copies(actuator, str(each.get("name")), "actuator", found=found, around=tuple(around))
        own.append(each)
    made.append(own)


def _actuator(actuator: Node) -> Node:
    own = copy.copy(actuator)
    own.tail = None
    for attribute in _LEFT_OUT:
        own.attrib.pop(attribute, "")
    return own


_SECTIONS = {"default": _default, "worldbody": _worldbody, "tendon": _tendon, "actuator": _actuators}
_ACTUATORS = frozenset(
    "general motor position velocity intvelocity damper cylinder muscle adhesion dcmotor pid orientation plugin".split()
)


def _with_attributes(source: Node, made: Node, names: tuple[str, ...] | None) -> Node:
    attributes = {str(name): str(value) for name, value in source.attrib.items() if names is None or str(name) in names}
    return made.makeelement(str(source.tag), attributes)


def _name(source: Node, made: Node, kind: str, found: BareModel, around: tuple[Node, ...]) -> None:
    """Note the names that MuJoCo gives to the copies of an element, after giving it one if it has none."""
    name = str(source.get("name") or f"{MARK}{len(found.named)}{MARK}")
    made.set("name", name)
    found.named.setdefault((kind, name), (source, frozenset()))
    _note_copies(source, name, kind, found=found, around=around)


def _note_copies(source: Node, name: str, kind: str, found: BareModel, around: tuple[Node, ...]) -> None:
    for end, within in ends_of_copies(around).items():
        found.named.setdefault((kind, name + end), (source, frozenset(within)))


VECTORS = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat")


def layouts(linking: Linking) -> None:
    """Record the key layout of each unit before the units are joined."""
    # MuJoCo 4.0 counts up to `nkey` in the whole model: `<size nkey="3"/>` and one key of a part would give three keys,
    # and the padding would belong to no part.
    if linking.parts:
        for unit in linking.units:
            for size in unit.root.iterchildren("size"):
                for _ in range(len(keys_of(unit)), numbers.integer(journal.drop(size, "nkey") or "-1")):
                    journal.place(unit.section("keyframe"), unit.root.makeelement("key"))
    for part in linking.parts:
        if part.keyframes != "none":
            linking.keys.attached += [
                (part, each)
                for each, slot in attached_slots(linking, part.unit).items()
                if slot.keys and (slot.free or slot.mocaps)
            ]
    keeping = [part for part in linking.parts if part.keyframes != "none" and keys_of(part.unit)]
    if linking.request.requested_keys is None and not keeping and not keys_of(linking.base):
        return
    linking.keys.base_layout = layout_of(linking, linking.base)
    for part in linking.parts:
        layout = layout_of(linking, part.unit)
        if layout is not None:
            linking.keys.layouts[part] = layout


def keys_of(unit: Unit) -> list[Node]:
    return unit.root.findall("keyframe/key")


def remove_keys(root: Node) -> list[Node]:
    """Remove the sections of keys, and return them."""
    sections = root.findall("keyframe")
    for section in sections:
        journal.remove(section)
    return sections


def layout_of(linking: Linking, unit: Unit) -> KeyLayout | None:
    """Return the key layout of a unit alone, measured and with completed rows if needed, or None after an error."""
    layout = _layout_of(linking, unit)
    linking.keys.shapes |= {flex: _shape(flex) for flex in unit.root.iter("flexcomp")}
    if layout is not None:
        _complete_rows(linking, unit, layout)
    return layout


_SHAPING = ("type", "count", "dim", "dof", "rigid", "file", "mesh", "point", "element", "cellcount")


def reshaped_flexes(linking: Linking) -> set[Node]:
    shapes = linking.keys.shapes
    return {flex for flex in linking.base.root.iter("flexcomp") if _shape(flex) != shapes.get(flex, _shape(flex))}


def _shape(flex: Node) -> str:
    own = [f"{name}={flex.get(name)}" for name in _SHAPING if flex.get(name)]
    return " ".join([*own, *(str(sorted(pin.items())) for pin in flex.iterchildren("pin"))])


def _complete_rows(linking: Linking, unit: Unit, layout: KeyLayout) -> None:
    """Complete short rows with the numbers that MuJoCo would use, which are measured."""
    # MuJoCo 4.0 fills `qpos` up from the reference: `<key qpos="1"/>` with `<joint/><joint ref="30"/>` is 1 0.5236.
    keys = keys_of(unit)
    if keys:
        for vector in ("qpos", "qvel", "act", "ctrl"):
            rows = [str(key.get(vector) or "").split() for key in keys]
            if not any(rows) or all(len(row) in (0, layout.total(vector)) for row in rows):
                continue
            ends = list(accumulate(width for _, width in layout.holders(vector)))
            short = [at for at, row in enumerate(rows) if ends and 0 < len(row) < ends[-1] and len(row) not in ends]
            array = f"key_{vector}"
            if not short or linking.measure is None or not (measured := linking.measure(unit, (array,))):
                continue
            for at in short:
                start = max((end for end in ends if end < len(rows[at])), default=0)
                end = next(end for end in ends if end > len(rows[at]))
                whole = measured[array][at * ends[-1] + start : at * ends[-1] + end]
                _complete(unit, keys[at], vector, start=start, whole=numbers.text(whole).split())


def _complete(unit: Unit, key: Node, vector: str, start: int, whole: list[str]) -> None:
    """If a row ends within a joint, add its missing numbers, and record that they come from MuJoCo."""
    record = unit.origins.keys.get(key)
    written = numbers_of(record, key, vector)
    source = KeySource("mujoco", vector, key)
    row: list[Number] = written[:start]
    for at, text in enumerate(whole, start):
        is_own = at < len(written) and numbers.read(written[at].text) == numbers.read(text)
        row.append(written[at] if is_own else Number(text, source, at))
    journal.write(key, vector, " ".join(texts(row)))
    record = record or KeyRecord()
    unit.origins.keys[key] = replace(record, numbers={**record.numbers, vector: row})


def _layout_of(linking: Linking, unit: Unit) -> KeyLayout | None:
    """Return a layout with the widths and references that only MuJoCo knows, or None after a reported error."""
    try:
        layout = lay_out(unit, {})
        # A body that MuJoCo aligns does not start at its `pos`: see `is_leaf`. Only MuJoCo knows which actuators a
        # replicate multiplies.
        if not (
            any(is_measured(unit, joint, slot) for joint, slot in layout.joints.items())
            or (layout.actuators and next(unit.root.iter("replicate"), None) is not None)
            or any(is_expanded(holder) for holder in layout.mocaps)
        ):
            return layout
    except Unknown:
        pass
    try:
        known = flexible_widths(linking, unit)
        if known is None:
            return None
        linking.keys.measured.update(known)
        return lay_out(unit, known)
    except Unknown as unknown:
        report_not_laid_out(linking, unit, unknown)
        return None


def final_layout(linking: Linking) -> KeyLayout | None:
    known = {**linking.keys.measured, **_slots(linking)}
    for node, slots in product(linking.keys.reshaped, (known, linking.keys.measured)):
        slots.pop(node, None)
    try:
        return lay_out(linking.base, known)
    except Unknown as unknown:
        return _measure_again(linking, known, unknown)


def measure_references_again(linking: Linking, layout: KeyLayout) -> None:
    """Measure the references that only MuJoCo knows again if the recipe added some or may have changed them."""
    joints = (
        linking.keys.edited or joint not in linking.keys.references
        for joint, slot in layout.joints.items()
        if is_measured(linking.base, joint, slot)
    )
    mocaps = (
        linking.keys.edited or holder not in linking.keys.mocap_references
        for holder in layout.mocaps
        if is_expanded(holder)
    )
    if any(joints) or any(mocaps):
        _measure_again(linking, {}, None)


def _measure_again(linking: Linking, known: Mapping[Node, Slot], unknown: Unknown | None) -> KeyLayout | None:
    """Measure the recipe's additions and changes, on the finished model without its keys."""
    unit = linking.flat()
    # MuJoCo refuses keys whose rows do not fit the model any more.
    sections = remove_keys(unit.root)
    try:
        widths = flexible_widths(linking, unit)
        return None if widths is None else lay_out(linking.base, {**widths, **known})
    except Unknown as still:
        report_not_laid_out(linking, linking.base, unknown or still)
        return None
    finally:
        journal.place_all(unit.root, sections)


def _slots(linking: Linking) -> dict[Node, Slot]:
    known: dict[Node, Slot] = {}
    for layout in (linking.keys.base_layout, *linking.keys.layouts.values()):
        if layout is not None:
            known |= {element_of(holder): slot for holder, slot in layout.actuators.items()}
            known |= {
                element_of(holder): slot
                for holder, slot in layout.joints.items()
                if not (isinstance(holder, Copy) and holder.twists)
            }
    return known


def report_not_laid_out(linking: Linking, unit: Unit, unknown: Unknown) -> None:
    more = "" if linking.request.requested_keys is None else ", and no `keyframe` in the recipe"
    message = f"keyframes of a model with this `<{unknown.element.tag}>` cannot be laid out: only MuJoCo knows its size"
    help = f"omit the keys: `drop: [key]`{more}"
    linking.sink.error("not-supported", message, linking.span(unit, unknown.element), help=help)


@contextmanager
def without_keys(root: Node) -> Iterator[None]:
    """Take the keys out of a tree for the block."""
    # MuJoCo 4.0 refuses numbers that are too many for the model as it is: "keyframe 0: invalid ctrl size, expected
    # length 0".
    sections = [(root.index(section), section) for section in root.iterchildren("keyframe")]
    for _, section in sections:
        journal.remove(section)
    try:
        yield
    finally:
        for at, section in sections:
            journal.place(root, section, at)
