"""Values of a unit that only MuJoCo knows after compiling the unit alone, and the reference configuration."""

from __future__ import annotations

import copy
import math
import os
import shutil
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.rotation import Pose
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.link import numbers
from mjcompose.link.expansion import Copy, Within, actuators_in_order, copies_of, element_of
from mjcompose.link.key_layout import BLOCK, BLOCKS, Holder, KeyLayout, Slot, Unknown, actuator_slot, lay_out
from mjcompose.link.linking import Linking, ModelMeasure
from mjcompose.link.numbers import pose_in_world, read_pose
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import FREE, HINGE
from mjcompose.mujoco.messages import CRASH_HELP, CRASHES, parse, report, translate
from mjcompose.sources.context import Context
from mjcompose.tree.classes import childclass_of, walk_bodies, written
from mjcompose.tree.cost import first_scaled
from mjcompose.tree.files import file_attributes, is_absolute, written_path
from mjcompose.tree.mesh_cost import check_meshes
from mjcompose.tree.names import declaration
from mjcompose.tree.unit import KeySource, Number, Unit, element_at, texts
from mjcompose.tree.xml_text import write

_SIZES = ("nq", "nv", "narena")


def measure_with(
    context: Context, limits: engine.RequestLimits | None = None, session: engine.Session | None = None
) -> ModelMeasure:
    """Return a function that compiles a unit alone, in the process of a `session`, and reports failures."""

    def measure(unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
        if not check_meshes(unit, 0, Sink() if attempt else context.sink):
            return {}
        wanted = tuple(name for name in arrays if name not in _SIZES)
        text = write(unit.root)
        with folder_of(unit) as folder:
            measured = engine.measure(folder, arrays=wanted, text=text.decode(), limits=limits, session=session)
        compiled = measured.compiled
        if not compiled.ok:
            if not attempt:
                _rejected(compiled, unit, text, context=context)
            return {}
        found = {name: [float(value) for value in array.ravel()] for name, array in measured.arrays.items()}
        return {**found, **{name: [float(compiled.sizes[name])] for name in _SIZES}}

    return measure


def compiled_names(unit: Unit, context: Context) -> Mapping[str, Sequence[str]] | None:
    """Return the names of the compiled unit by kind, or None after a refusal, which is reported."""
    if not check_meshes(unit, 0, context.sink):
        return None
    text = write(unit.root)
    with folder_of(unit) as folder:
        measured = engine.measure(folder, arrays=(), text=text.decode())
    if not measured.compiled.ok:
        _rejected(measured.compiled, unit, text, context=context)
        return None
    return measured.names


@contextmanager
def folder_of(unit: Unit) -> Iterator[Path]:
    """Yield the folder with the unit's files: its own folder, or a temporary one with files in memory."""
    if not unit.contents:
        yield unit.directory
        return
    contents = dict(unit.contents)
    for element, _, file_name in file_attributes(unit.root):  # files next to the unit that it also refers to
        path = written_path(unit.settings, element, file_name)
        if path not in unit.contents and unit.door.sees(unit.directory / path):
            contents[path] = unit.directory / path
    contents = {path: content for path, content in contents.items() if not is_absolute(path)}
    outward = max((path.count("../") for path in contents), default=0)
    with scratch("unit") as name:
        folder = Path(name, *["model"] * outward)  # deep enough for every `..`
        folder.mkdir(parents=True, exist_ok=True)
        for path, content in contents.items():
            file = Path(os.path.normpath(folder / path))
            file.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, bytes):
                file.write_bytes(content)
            elif os.path.isfile(content):
                shutil.copyfile(content, file)
        yield folder


def _rejected(compiled: engine.Compiled, unit: Unit, text: bytes, context: Context) -> None:
    whole = unit.origins.span(unit.root, unit.file)
    if compiled.crash is not None:
        code = CRASHES.get(compiled.crash, "mujoco-crash")
        message = f"`{unit.file}` by itself: {compiled.error or compiled.crash}"
        context.sink.error(code, message, whole, help=CRASH_HELP.get(code))
        return
    fault = parse(compiled.error or "")
    element = None if fault.line is None else element_at(unit.root, text, fault.line)
    report(translate(" ".join(fault.message.split()), element), element, unit, context=context, at=whole)


_ARRAYS = (
    "nq",
    "nv",
    "qpos0",
    "key_time",
    "body_mocapid",
    "body_pos",
    "body_quat",
    "jnt_type",
    "jnt_qposadr",
    "jnt_dofadr",
    "actuator_actnum",
    "actuator_ctrlnum",
)


def flexible_widths(linking: Linking, unit: Unit) -> dict[Node, Slot] | None:
    """Measure the widths in a unit's keys that the tree does not have. Return None if MuJoCo refuses the unit.

    These are the widths of all models that MuJoCo attaches, (nctrl, nact) of every actuator, (nq, nv) of every flex and
    of one more block of unknown size. Raises `Unknown` if the layout is not as wide as MuJoCo's.
    """
    arrays = linking.measure(unit, _ARRAYS) if linking.measure else None
    if not arrays:
        return None
    found = attached_slots(linking, unit)
    brought = sum(slot.actuators for slot in found.values())
    found.update(_flexes(linking, unit))
    actuators = list(map(element_of, actuators_in_order(unit.root)))
    slots = list(map(actuator_slot, _counts(arrays, "actnum"), _counts(arrays, "ctrlnum")))
    # MuJoCo 4.0 puts the actuators of a model that it attaches behind all others: the first rows are the unit's own.
    if len(slots) - brought == len(actuators):
        found.update(zip(actuators, slots, strict=False))
    elif (replicate := next(unit.root.iter("replicate"), None)) is not None:
        raise Unknown(replicate)  # it multiplies actuators that refer to nothing in it: see `replicates.py`
    size = int(arrays["nq"][0]), int(arrays["nv"][0])
    try:
        layout = lay_out(unit, found)
    except Unknown as reason:
        unknown = reason.element
        found[unknown] = Slot(BLOCK, (0, 0))
        layout = lay_out(unit, found)
        widths = size[0] - layout.total("qpos"), size[1] - layout.total("qvel")
        found[unknown] = Slot(BLOCK, widths, _free_inside(layout, unknown, widths, arrays=arrays))
        layout = lay_out(unit, found)
    mocaps = [body for body, number in enumerate(arrays["body_mocapid"]) if number >= 0]
    if (layout.total("qpos"), layout.total("qvel"), sum(layout.mocaps.values())) != (*size, len(mocaps)):
        raise Unknown(next(unit.root.iter("replicate", *BLOCKS, "worldbody")))
    at = 0
    for joint, slot in layout.joints.items():
        if is_measured(unit, joint, slot):
            linking.keys.references[joint] = numbers.text(arrays["qpos0"][at : at + slot.widths[0]]).split()
        at += slot.widths[0]
    bodies = iter(mocaps)
    for holder, count in layout.mocaps.items():
        own = list(islice(bodies, count))
        if is_expanded(holder):
            linking.keys.mocap_references[holder] = [_pose(arrays, body) for body in own]
    return found


def attached_slots(linking: Linking, unit: Unit) -> dict[Node, Slot]:
    """Measure the additions of each `<attach>`, alone in an empty world. `linking.keys.measured` caches the results."""
    found: dict[Node, Slot] = {}
    for attach in unit.root.iter("attach"):
        slot = linking.keys.measured.get(attach) or _measured_attach(linking, unit, attach)
        if slot is not None:
            found[attach] = linking.keys.measured[attach] = slot
    return found


def _flexes(linking: Linking, unit: Unit) -> Iterator[tuple[Node, Slot]]:
    wanted = ("nq", "nv", "jnt_type")
    if linking.measure is None:
        return
    for flex in unit.root.iter("flexcomp"):
        if arrays := linking.measure(_flex_alone(unit, flex), wanted, attempt=True):
            # The vertices and nodes of a flex slide; hinges are the twists of a rod (since MuJoCo 4.0).
            twists = arrays["jnt_type"].count(HINGE)
            yield (flex, Slot(BLOCK, (int(arrays["nq"][0]) - twists, int(arrays["nv"][0]) - twists), twists=twists))


def _flex_alone(unit: Unit, flex: Node) -> Unit:
    """Return a model with only a flex in its world, and only the sections that affect its number of joints."""
    name = flex.get("mesh")
    meshes = unit.root.iterfind("asset/mesh") if name else ()
    alone = _alone(unit, flex, (mesh for mesh in meshes if declaration(mesh, "asset") == ("mesh", name)))
    for element in alone.root.iterfind("*/*"):
        strip(element)
    return alone


def strip(flex: Node) -> None:
    """Remove attributes and plugins that do not affect the number of joints but may name missing elements."""
    for attribute in ("material", "class"):
        flex.attrib.pop(attribute, "")
    for plugin in flex.findall("plugin"):
        flex.remove(plugin)


def _alone(unit: Unit, element: Node, assets: Iterable[Node]) -> Unit:
    root = unit.root.makeelement("mujoco")
    root.extend(copy.copy(compiler) for compiler in unit.root.iterchildren("compiler"))
    for tag, children in (("asset", assets), ("worldbody", [element])):
        section = root.makeelement(tag)
        section.extend(copy.copy(child) for child in children)
        root.append(section)
    return replace(unit, root=root)


def _measured_attach(linking: Linking, unit: Unit, attach: Node) -> Slot | None:
    if linking.measure is None:
        return None
    arrays = linking.measure(_alone(unit, attach, unit.root.iterfind("asset/model")), _ARRAYS, attempt=True)
    if not arrays:
        return None
    acts = _counts(arrays, "actnum")
    controls = _counts(arrays, "ctrlnum")
    return Slot(
        BLOCK,
        (int(arrays["nq"][0]), int(arrays["nv"][0])),
        tuple(_free_joints(arrays)),
        controls=(sum(controls), sum(acts)),
        actuators=len(acts),
        mocaps=sum(number >= 0 for number in arrays["body_mocapid"]),
        keys=len(arrays["key_time"]),
    )


def _counts(arrays: Mapping[str, list[float]], name: str) -> list[int]:
    """Return the number of activations or controls of each actuator. Before MuJoCo 4, each has one control."""
    return [int(n) for n in arrays.get(f"actuator_{name}") or [1.0] * len(arrays["actuator_actnum"])]


def _free_joints(arrays: Mapping[str, list[float]]) -> Iterator[tuple[int, int]]:
    """Yield the indices at which the numbers of each free joint begin."""
    joints = zip(arrays["jnt_type"], arrays["jnt_qposadr"], arrays["jnt_dofadr"], strict=True)
    return ((int(q), int(v)) for kind, q, v in joints if kind == FREE)


def _free_inside(
    layout: KeyLayout, block: Node, widths: tuple[int, int], arrays: Mapping[str, list[float]]
) -> tuple[tuple[int, int], ...]:
    nq = nv = 0
    for joint, slot in layout.joints.items():
        if joint is block:
            break
        nq = nq + slot.widths[0]
        nv = nv + slot.widths[1]
    return tuple((q - nq, v - nv) for q, v in _free_joints(arrays) if nq <= q < nq + widths[0])


def is_measured(unit: Unit, joint: Holder, slot: Slot) -> bool:
    """Return whether only MuJoCo knows the reference: because MuJoCo expands, aligns or copies a floating body."""
    if slot.kind == BLOCK:
        return slot.widths[0] > 0
    if slot.kind != "free":
        return False
    return isinstance(joint, Copy) or "true" in (joint.get("align"), unit.settings.alignfree)


def is_expanded(holder: Holder) -> bool:
    """Return whether a holder of mocap bodies is not a body of the tree, or is one of several copies."""
    return isinstance(holder, Copy) or holder.tag != "body"


def _pose(arrays: Mapping[str, list[float]], body: int) -> Pose:
    x, y, z = arrays["body_pos"][3 * body : 3 * body + 3]
    w, a, b, c = arrays["body_quat"][4 * body : 4 * body + 4]
    return Pose((x, y, z), (w, a, b, c))


BODIES = ("body_mass", "body_ipos", "body_iquat", "body_inertia")
GEOMS = ("geom_size", "geom_pos", "geom_quat")
_NAMES = {"mesh": "name_meshadr", "material": "name_matadr", "texture": "name_texadr"}
NAMED = ("names", *_NAMES.values())
_SURVEYED = ("body", "geom")
_MARKS = ("body_user", "geom_user", "body_mass", "geom_type")


class Survey(Struct):
    """The result of compiling a unit alone: arrays, and for each body and geom the rows of its copies, if any."""

    arrays: Mapping[str, list[float]]
    rows: Mapping[Node, tuple[int, ...]]

    def is_gone(self, element: Node) -> bool:
        return not self.rows[element]

    def values(self, element: Node, array: str, width: int) -> list[float] | None:
        numbers = self.arrays[array]
        found = [numbers[width * row : width * (row + 1)] for row in self.rows[element]]
        return found[0] if found and all(each == found[0] for each in found) else None

    def names(self, tag: str) -> set[str]:
        text = bytes(int(character) for character in self.arrays["names"])
        starts = [int(start) for start in self.arrays[_NAMES[tag]]]
        return {text[start : text.index(b"\0", start)].decode("utf-8", "replace") for start in starts}


class Unmeasurable(Struct):
    """The reason why a unit cannot be measured, and the element that causes it, if there is one."""

    why: str
    element: Node | None = None


class KeptSettings(Struct):
    """Settings of a unit whose effect is kept by writing out the values that MuJoCo measures."""

    linking: Linking
    unit: Unit
    names: Sequence[str]

    def survey(self, arrays: tuple[str, ...], *, pinned: Collection[Node] = ()) -> Survey | None:
        found = compile_unaligned(self.linking, self.unit, arrays, pinned=pinned)
        if isinstance(found, Unmeasurable):
            self.refuse(found.why, found.element)
            return None
        return found

    def refuse(self, why: str, element: Node | None = None) -> None:
        """Report that the settings cannot be kept, at an element or where the first of them is written."""
        linking = self.linking
        unit = self.unit
        first = self.names[0]
        named = " and ".join(f"`{name}`" for name in self.names)
        compilers = list(unit.root.iterchildren("compiler"))
        compiler = next((each for each in compilers if each.get(first) is not None), [*compilers, unit.root][0])
        message = f"{named} of `{unit.label}` cannot be kept in a composition: {why}"
        span = linking.span(unit, compiler, first) if element is None else linking.span(unit, element)
        help = "remove the setting from the source, or write the values it gives"
        linking.sink.error("compiler-setting", message, span, help=help)


def compile_unaligned(
    linking: Linking, unit: Unit, arrays: tuple[str, ...], *, pinned: Collection[Node] = ()
) -> Survey | Unmeasurable | None:
    """Compile the unit alone, without aligning free bodies or fusing `pinned` bodies; None after a reported refusal."""
    unmeasurable = _unmeasurable(unit.root)
    if unmeasurable is not None:
        return unmeasurable
    if linking.measure is None:
        return Unmeasurable("MuJoCo is not available")
    copy = unit.copied()
    marked = _mark(unit, copy, pinned)
    # Without alignment, the inertia is in the frame in which it will be written.
    for joint in copy.root.iter("freejoint"):
        joint.set("align", "false")
    for element in copy.root.iterchildren("compiler", "size"):
        for name in ("alignfree", "nuser_body", "nuser_geom"):
            element.attrib.pop(name, "")
    compiled = linking.measure(copy, tuple(dict.fromkeys((*arrays, *_MARKS))))
    if not compiled:
        return None
    rows = _rows_of(marked, compiled)
    for element, places in rows.items():
        if places and len(places) != math.prod(map(copies_of, element.iterancestors("replicate"))):
            return Unmeasurable(f"it omits only some copies of `<{element.tag}>`", element)
    return Survey(compiled, {element: tuple(places) for element, places in rows.items()})


def _unmeasurable(root: Node) -> Unmeasurable | None:
    """Return why the elements cannot be found again in the compiled model, or None if they can."""
    # MuJoCo makes bodies or geoms of these that are elements of no unit.
    opaque = next(root.iter("attach", "composite"), None)
    if opaque is not None:
        return Unmeasurable(f"MuJoCo expands `<{opaque.tag}>`")
    if first_scaled(root) is not None:
        return Unmeasurable("MuJoCo scales the contents of a `<frame>`")
    return None


def _mark(unit: Unit, copy: Unit, pinned: Collection[Node]) -> list[Node]:
    """Number the surveyed elements of a copy by `user`, and keep `pinned` bodies. Return the elements of the unit."""
    # `user` finds an element again in the arrays: MuJoCo copies it with the element. Names may be missing, and
    # numbers change when bodies are fused or geoms discarded.
    marked: list[Node] = []
    for (original, _), (element, _) in zip(walk_bodies(unit.root), walk_bodies(copy.root), strict=True):
        if original.tag in _SURVEYED:
            marked.append(original)
            element.set("user", str(len(marked)))
        if original in pinned:
            # Under `fusestatic` MuJoCo 4.0 fuses a body without joints, except one that a `framepos` names.
            if not element.get("name"):
                element.set("name", f"pinned body {len(marked)} of {len(copy.root)}")
            sensors = copy.section("sensor")
            sensors.append(sensors.makeelement("framepos", {"objtype": "body", "objname": str(element.get("name"))}))
    return marked


def _rows_of(marked: Sequence[Node], compiled: Mapping[str, Sequence[float]]) -> dict[Node, list[int]]:
    """Return for each marked element the rows in the arrays that have its mark."""
    rows: dict[Node, list[int]] = {element: [] for element in marked}
    for marks, counted in (("body_user", "body_mass"), ("geom_user", "geom_type")):
        count = len(compiled[counted])
        width = len(compiled[marks]) // count if count else 0
        if width == 0:
            continue
        for row in range(count):
            mark = int(compiled[marks][row * width])
            if mark:
                rows[marked[mark - 1]].append(row)
    return rows


class KeyFiller:
    """Makes rows of keys and fills the missing values from the reference configuration."""

    def __init__(self, linking: Linking) -> None:
        self.linking = linking
        self.disagreeing: list[tuple[str, Node]] = []
        self.lost: list[tuple[str, Node]] = []
        self.sequence = linking.base.settings.eulerseq
        self.degrees = linking.angle == "degree"
        self.class_refs = linking.base.classes.give("joint", "ref")

    def row(
        self, vector: str, layout: KeyLayout, values: Mapping[Holder, list[Number]], void: Collection[Node]
    ) -> list[Number]:
        """Return all numbers of a vector.

        `values` are the values that a key sets; the values of `void` elements no longer have a meaning.
        """
        row: list[Number] = []
        found = self._found(vector, values)
        if vector in ("mpos", "mquat"):
            for body in layout.mocaps:
                poses = self.linking.keys.mocap_references.get(body) or [self._pose(element_of(body))]
                text = [number for pose in poses for number in (pose.pos if vector == "mpos" else pose.quat)]
                said = found(body) or []
                row += [*said, *_unset_numbers(vector, numbers.text(text).split())[len(said) :]]
            return row
        # Numbers still mean something if neither their holder's meaning nor its width has been edited.
        second = vector in ("qvel", "act")
        for holder, slot in (layout.joints if vector in ("qpos", "qvel") else layout.actuators).items():
            width = slot.widths[second]
            given = found(holder)
            element = element_of(holder)
            if given is None or len(given) != width or element in void:
                # `convert` reports the losses of actuators.
                if vector in ("qpos", "qvel") and given and any(numbers.read(" ".join(texts(given)))):
                    self.lost.append((vector, element))
                given = _unset_numbers(vector, self._qpos(holder, slot) if vector == "qpos" else ["0"] * width, given)
            row += given
        return row

    def _found(self, vector: str, values: Mapping[Holder, list[Number]]) -> Callable[[Holder], list[Number] | None]:
        """Return a function for the numbers that a key has for a holder, even if its number of copies has changed.

        Every copy that a replicate makes of a part has the numbers of the part. Copies that have become one element
        must agree; `disagreeing` gets the holders whose copies do not.
        """
        others: dict[tuple[Node, bool], list[tuple[Within, list[Number]]]] = {}

        def found(holder: Holder) -> list[Number] | None:
            if holder in values:
                return values[holder]
            if not others:
                for each, row in values.items():
                    own = each if isinstance(each, Copy) else Copy(each)
                    others.setdefault((own.element, own.twists), []).append((own.within, row))
            now = holder if isinstance(holder, Copy) else Copy(holder)
            inside = dict(now.within)
            rows = [
                row
                for within, row in others.get((now.element, now.twists), ())
                if all(inside.get(replicate, number) == number for replicate, number in within)
            ]
            if any(texts(row) != texts(rows[0]) for row in rows[1:]):
                self.disagreeing.append((vector, now.element))
            return rows[0] if rows else None

        return found

    def _qpos(self, holder: Holder, slot: Slot) -> list[str]:
        measured = self.linking.keys.references.get(holder)
        if measured is not None:
            return measured
        joint = element_of(holder)
        # A free joint starts at its body's place in the world: in `<frame pos="1 0 0">` at 1 0 0 1 0 0 0.
        if slot.kind == "free" and (body := next(joint.iterancestors("body"), None)) is not None:
            pose = self._pose(body)
            return numbers.text([*pose.pos, *pose.quat]).split()
        if slot.kind == BLOCK:
            return ["0"] * slot.widths[0]
        if slot.kind == "ball":
            return "1 0 0 0".split()
        ref = written(joint, "ref")
        if ref is None and self.class_refs:
            ref = self.linking.base.classes.effective(joint, childclass_of(joint), "ref")
        if ref is None:
            return ["0"]
        value = numbers.first(ref)
        if slot.kind == "hinge" and self.degrees:
            value = numbers.joint_radians(value)
        return numbers.text([value]).split()

    def _pose(self, body: Node) -> Pose:
        outer = body.getparent()
        inner = read_pose(body, self.degrees, self.sequence)
        return inner if outer is None else pose_in_world(outer, self.degrees, self.sequence) @ inner


def without_void(values: Mapping[str, dict[Holder, list[Number]]], void: Collection[Node]) -> None:
    """Empty the numbers of a key that an edit has made meaningless, and note the old values."""
    for vector, columns in values.items():
        for holder, row in columns.items():
            if element_of(holder) in void:
                columns[holder] = _unset_numbers(vector, ["0"] * len(row), row)


def _unset_numbers(vector: str, default: list[str], lost: list[Number] | None = None) -> list[Number]:
    """Return the numbers that no key sets, or that have `lost` their meaning through an edit."""
    first = lost[0] if lost else None
    source = KeySource(
        "reference" if vector in ("qpos", "mpos", "mquat") else "zero",
        vector,
        lost=first and (first.source.lost or first),
    )
    return [Number(text, source, at) for at, text in enumerate(default)]
