"""Passes: the compiler's settings, sizes and memory of the whole model.

`alignfree`, which aligns free bodies' frames with their inertia, becomes explicit on each free joint. Only
`<freejoint>` has `align`. If a `<joint type="free">` has other attributes that a `<freejoint>` cannot take, the model
keeps `alignfree` and all other free joints opt out.

A request for memory in a source concerns only that source. For the whole model, `memory="1M"` from a lamp next to 300
boxes lets MuJoCo 4.0 drop contacts, and boxes fall through the floor. `njmax`, `nconmax` and `nstack` are older
requests.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.link import numbers
from mjcompose.link.inertia import MEASURED
from mjcompose.link.linking import Linking, MemoryRequest
from mjcompose.tree import journal
from mjcompose.tree.classes import through_frames, walk_bodies
from mjcompose.tree.journal import because, explained
from mjcompose.tree.unit import Unit, line_of, set_line
from mjcompose.tree.values import parse_int

_OF_FREEJOINTS = frozenset({"name", "type", "group", "class"})
_INSIDE_BODIES = ("body", "flexcomp", "composite", "attach")


def alignment(linking: Linking) -> None:
    if not linking.composed:
        return
    stubborn = [
        (unit, joint)
        for unit in linking.units
        if unit.settings.alignfree == "true"
        for joint, plain in _free_joints(unit)
        if not plain
    ]
    linking.notes.aligned = bool(stubborn)
    for unit in linking.units:
        wanted = unit.settings.alignfree == "true"
        if wanted == linking.notes.aligned:
            continue
        for joint in unit.root.iter("freejoint"):
            if joint.get("align") in (None, "", "auto"):
                journal.write(joint, "align", str(wanted).lower())
        for joint, plain in list(_free_joints(unit)):
            # MuJoCo 4.0 knows `align` on `<freejoint>` only: `<joint type="free" align="true"/>` violates the schema.
            # But a `<freejoint/>` takes no joint defaults: its armature is 0 whatever they say.
            if plain:
                journal.retag(joint, "freejoint")
                for name in [str(name) for name, _ in joint.items() if name not in ("name", "group")]:
                    journal.drop(joint, name)
                journal.write(joint, "align", str(wanted).lower())
            else:
                _cannot_differ(linking, unit, joint, *stubborn[0])


def _free_joints(unit: Unit) -> Iterator[tuple[Node, bool]]:
    """Yield each `<joint type="free">` that MuJoCo may align, and whether a `<freejoint>` can replace it."""
    classes = unit.classes
    for joint, childclass in walk_bodies(unit.root):
        if (
            joint.tag == "joint"
            and classes.effective(joint, childclass, "type") == "free"
            and is_leaf(next(joint.iterancestors("body")))
        ):
            given = classes.get(str(joint.get("class") or childclass or "") or None).sets("joint")
            yield joint, not given and _OF_FREEJOINTS.issuperset(joint.keys())


def is_leaf(body: Node) -> bool:
    """Return whether a body has no child bodies. MuJoCo aligns only such bodies."""
    # MuJoCo 4.0 puts `<body pos="1 0 0"><freejoint align="true"/><geom pos=".1 0 0" size=".1"/></body>` at 1.1 0 0, and
    # leaves it at 1 0 0 with another `<body>` inside.
    return not any(
        child.tag in _INSIDE_BODIES or (child.tag == "replicate" and not is_leaf(child))
        for child in through_frames(body)
    )


def _cannot_differ(linking: Linking, unit: Unit, joint: Node, other: Unit, of_other: Node) -> None:
    why = "each has a free joint with settings of its own"
    message = f"`alignfree` of `{other.label}` cannot be kept in a composition with `{unit.label}`: {why}"
    notes = (Note("it does not apply to this one", linking.span(unit, joint)),)
    help = 'make one of them a `<freejoint align="…"/>`'
    linking.sink.error("compiler-setting", message, linking.span(other, of_other), notes=notes, help=help)


FOLDERS = ("meshdir", "texturedir", "assetdir", "strippath")
# Settings that other passes make explicit, that concern a whole model, or that have no effect.
_NOT_KEPT = (
    "inertiafromgeom",
    "inertiagrouprange",
    *MEASURED,
    "fusestatic",
    "discardvisual",
    "alignfree",
    "fitaabb",
    "coordinate",
    "usethread",
    "conflict",
)


def compiler(linking: Linking) -> None:
    """Write the base's settings once, because they now hold for every part."""
    root = linking.base.root
    first = next(root.iterchildren("*"), None)
    at = root.index(first) if first is not None and first.tag == "compiler" else None
    # The last `<compiler>` counts, even for elements above it: in MuJoCo 4.0 `<joint ref="90"/>` between
    # `<compiler angle="radian"/>` and `<compiler angle="degree"/>` has a reference of 1.5708.
    settings = list(root.iterchildren("compiler"))
    element = root.makeelement("compiler")
    for each in settings:
        for name, value in each.items():
            place = linking.base.origins.lasting_place(each, linking.base.file, str(name))
            journal.write(element, str(name), str(value), because("", place))
    children = [child for each in settings for child in each]
    line = next(map(line_of, settings), None)
    owner = linking.base.origins.owner(settings[0], linking.base.file) if settings else None
    for each in settings:
        journal.remove(each)
    _settle(element, linking)
    if not element.attrib and not children:
        return
    _append_once(element, children)
    if owner is not None:
        linking.base.origins.own(element, owner)
        set_line(element, line)
    for replaced in settings:
        journal.note_source(element, replaced)
    with explained(_OF_THE_BASE if len(settings) == 1 else _FOR_ALL):
        if at is None:
            linking.base.insert(element)
        else:
            journal.place(root, element, at)


_OF_THE_BASE = because("the base's settings, which apply to every part")
_FOR_ALL = because("the settings that hold for every part")
_BY_BUNDLE_PATH = because("every file is named by its path in the bundle")
_EXPLICIT = because("made explicit on the elements that it affects, so it does not reach other parts")
_EXPLICIT_LIMITS = because("made explicit where it matters")


def _settle(compiler: Node, linking: Linking) -> None:
    """Turn the base's settings of `<compiler>` into the settings of the whole model."""
    # All files have their whole path below `assets/`. MuJoCo 4.0 would put `meshdir`, or without it `assetdir`, before
    # the path of every mesh, in whatever order the two are written.
    for name in FOLDERS:
        journal.drop(compiler, name, _BY_BUNDLE_PATH)
    if linking.composed:
        for name in _NOT_KEPT:
            journal.drop(compiler, name, _EXPLICIT)
    if linking.composed and linking.notes.aligned:
        journal.write(compiler, "alignfree", "true", because("kept for the free joints that cannot say it themselves"))
    if linking.parts:
        if compiler.get("angle") != linking.angle:
            journal.write(compiler, "angle", linking.angle, because(f"one unit for all parts: {linking.angle}s"))
        if model_autolimits(linking) == "true":
            journal.drop(compiler, "autolimits", _EXPLICIT_LIMITS)


def _append_once(element: Node, children: Iterable[Node]) -> None:
    """Append the children, and merge those with the same tag: MuJoCo takes one `<lengthrange>` in a `<compiler>`."""
    for child in children:
        same = element.find(str(child.tag)) if isinstance(child.tag, str) else None
        if same is None:
            journal.place(element, child)
        else:
            journal.write_all(same, {str(name): str(text) for name, text in child.items()})


def model_autolimits(linking: Linking) -> str:
    """Return the model's `autolimits`. A unit that compiles with `false` has no range without an explicit `limited`."""
    return "false" if all(unit.settings.autolimits == "false" for unit in linking.units) else "true"


_LARGEST = ("njmax", "nconmax", "nstack", "nuserdata")
# Older settings of memory. MuJoCo 4.0 refuses `<size memory="1M" njmax="5"/>`: "at most one of".
INSTEAD_OF_MEMORY = ("njmax", "nstack")


def merge_sizes(linking: Linking) -> None:
    """Write the larger of each size into the base, wide enough for the user data of every part."""
    linking.notes.memory = memory_requests(linking)
    for part in linking.parts:
        for section in part.unit.root.iterchildren("size"):
            for name, value in section.items():
                place = partial(linking.span, part.unit, section, str(name))
                with explained(because(f"required by the part `{part.called}`", place)):
                    _enlarge(linking, str(name), str(value))
    sizes = list(linking.base.root.iterchildren("size"))
    for size in sizes:
        _widen(linking, size)
    if any(size.get("memory") for size in sizes):
        for size in sizes:
            _remove_all_but_memory(linking, size)


def _widen(linking: Linking, size: Node) -> None:
    """Make the written widths of user data wide enough for every part."""
    # MuJoCo 4.0 refuses `<size nuser_geom="1"/>` next to `<geom user="1 2"/>` ("more values than nuser_geom"); without
    # a written width it takes the widest.
    for key, text in size.items():
        name = str(key)
        width = _count(str(text)) if name.startswith("nuser_") else -1
        if width >= 0:
            holders = (holder for unit in linking.units for holder in _with_user(unit, name))
            widths = (len(str(holder.get("user") or "").split()) for holder in holders)
            widest = str(max([width, *widths]))
            if widest != text:
                journal.write(size, name, widest, because("enough for all parts"))


def _remove_all_but_memory(linking: Linking, size: Node) -> None:
    """Remove the settings that MuJoCo refuses next to `memory`, with a warning."""
    for name in INSTEAD_OF_MEMORY:
        own = size.get(name)
        if own is None:
            continue
        span = linking.span(linking.base, size, name)
        journal.drop(size, name, because("only one of these settings may be written"))
        for part in linking.parts:
            for section in part.unit.root.iterchildren("size"):
                if section.get(name) == own:
                    span = linking.span(part.unit, section, name)
        message = f"`size.{name}` = {own} gives way to `size.memory` of another part: only one may be written"
        linking.sink.warning("option-conflict", message, span)


def _enlarge(linking: Linking, name: str, value: str) -> None:
    have = [str(size.get(name)) for size in linking.base.root.iterchildren("size") if size.get(name)]
    if name == "memory":
        if not have or bytes_of(value) > bytes_of(have[-1]):
            journal.write(linking.base.section("size"), name, value)
    elif name in _LARGEST or name.startswith("nuser_"):
        largest = max(map(_count, (value, *have)))
        if largest >= 0:
            journal.write(linking.base.section("size"), name, str(largest))


def _count(value: str) -> int:
    """Return the number, or -1 for a text that MuJoCo refuses, which is reported elsewhere."""
    number = parse_int(value.strip())
    return -1 if number is None else number


_USERS = {
    "nuser_body": ("body",),
    "nuser_jnt": ("joint", "freejoint"),
    "nuser_geom": ("geom",),
    "nuser_site": ("site",),
    "nuser_cam": ("camera",),
}
_USER_SECTIONS = {"nuser_tendon": "tendon", "nuser_actuator": "actuator", "nuser_sensor": "sensor"}


def _with_user(unit: Unit, name: str) -> Iterator[Node]:
    for section in unit.root.iterchildren(_USER_SECTIONS.get(name, "worldbody"), "default"):
        yield from section.iter(*_USERS.get(name, ()))


ROOM = ("memory", "njmax", "nconmax", "nstack")
_MOVING = ("joint", "freejoint", "flexcomp", "attach", "composite")
_SCALE = {"k": 2**10, "m": 2**20, "g": 2**30, "t": 2**40, "p": 2**50, "e": 2**60}


def memory_requests(linking: Linking) -> tuple[MemoryRequest, ...]:
    """Return the memory that the units request if several of them move, which MuJoCo must then check."""
    moving = sum(
        bool(part and part.joints) or next(unit.root.iter(*_MOVING), None) is not None
        for unit, part in zip(linking.units, (None, *linking.parts), strict=True)
    )
    if moving < 2 or any(f"size/{name}" in linking.request.overridden_options for name in ROOM):
        return ()
    calls = ["the base", *(part.called for part in linking.parts)]
    # `memory="-1"` leaves it to MuJoCo, as if it were not written.
    return tuple(
        MemoryRequest(name, value, called, span=linking.span(unit, size, name))
        for unit, called in zip(linking.units, calls, strict=True)
        for size in unit.root.iterchildren("size")
        for name in ROOM
        if (value := str(size.get(name) or "").strip()) not in ("", "-1")
    )


def memory_size(linking: Linking) -> None:
    """Remove the memory size if MuJoCo's own for the whole model is larger than any source requests."""
    if not linking.notes.memory or linking.measure is None:
        return
    unit = linking.flat()
    sizes = [size for size in unit.root.iterchildren("size") if any(size.get(name) for name in ROOM)]
    memory = [str(size.get("memory")) for size in sizes if size.get("memory")]
    written = bytes_of(memory[-1]) if memory else _measured(linking, unit)
    kept = [(size, dict(size.attrib)) for size in sizes]
    for size in sizes:
        for name in ROOM:
            journal.drop(size, name)
    own = _measured(linking, unit)
    if written is None or own is None or own <= written:
        for size, attributes in kept:
            journal.write_all(size, attributes)
        return
    for size in sizes:
        if not size.attrib and not len(size):
            journal.remove(size)
    first, *others = linking.notes.memory
    amount = f"{round(own / 2**20)}M"
    why = f"is {first.value}, which is too little for the whole model"
    message = f"`size.{first.name}` of {_quoted(first.called)} {why}: MuJoCo's own choice, {amount}, is used"
    notes = [Note(f"{_quoted(each.called)} requests `{each.name}` {each.value}", each.span) for each in others]
    help = f"to set it yourself, write in the recipe `size: {{memory: {amount}}}`, or another amount"
    linking.sink.warning("option-conflict", message, first.span, notes=notes, help=help)


def _measured(linking: Linking, unit: Unit) -> float | None:
    """Return MuJoCo's memory size for the current model, or None if it refuses the model, which is reported later."""
    assert linking.measure is not None
    arrays = linking.measure(unit, ("narena",), attempt=True)
    return arrays["narena"][0] if arrays else None


def bytes_of(text: str) -> float:
    """Return an amount of memory written in MJCF as a number of bytes.

    >>> bytes_of("2M")
    2097152.0
    """
    text = text.strip().lower()
    scale = _SCALE.get(text[-1:])
    return numbers.first(text or "0") if scale is None else numbers.first(text[:-1]) * scale


def _quoted(called: str) -> str:
    return called if called == "the base" else f"`{called}`"
