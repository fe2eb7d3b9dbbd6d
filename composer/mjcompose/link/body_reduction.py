"""Pass: `fusestatic` and `discardvisual`, which make MuJoCo leave out elements. The linker removes the same ones.

MuJoCo compiles the unit alone to determine which elements these are, because its rules differ between versions.
`discardvisual` removes geoms that nothing collides with, the assets that only these use, and everything that gives
color. `fusestatic` merges a body without joints into its parent, so a frame replaces it. The bodies that change
get the inertia that they have in the unit alone.
"""

from __future__ import annotations

from collections.abc import Collection

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Cause, Note
from mjcompose.link.inertia import has_mass, settle_inertia
from mjcompose.link.key_layout import JOINTS
from mjcompose.link.linking import Linking, Part, detach
from mjcompose.link.measure import BODIES, NAMED, KeptSettings, Survey
from mjcompose.tree.classes import childclass_of, own, through_frames, walk_bodies
from mjcompose.tree.files import stem
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.names import LISTS, REFERS, naming_table
from mjcompose.tree.unit import Unit


def body_reduction(linking: Linking) -> None:
    """Reduce each unit that asks for it; MuJoCo itself reduces a model of one unit."""
    for part in (None, *linking.parts) if linking.composed else ():
        unit = linking.base if part is None else part.unit
        wanted = [name for name in ("fusestatic", "discardvisual") if getattr(unit.settings, name) == "true"]
        # Below a joint of the recipe, bodies that would be part of the world alone keep their mass.
        pinned = static_bodies(unit) if wanted and part is not None and part.has_body else ()
        found = KeptSettings(linking, unit, wanted).survey((*BODIES, *NAMED), pinned=pinned) if wanted else None
        if found is not None:
            changed = discard(unit, found) if "discardvisual" in wanted else set()
            changed |= fuse(linking, unit, part, found=found) if "fusestatic" in wanted else set()
            unit.forget_settings(*wanted)
            settle_inertia(linking, unit, changed, found=found)


_ASSETS = ("mesh", "material", "texture")


def discard(unit: Unit, found: Survey) -> set[Node]:
    """Remove the elements that MuJoCo has discarded from the unit. Return the bodies that have lost geoms."""
    changed: set[Node] = set()
    for geom, _ in list(walk_bodies(unit.root)):
        if geom.tag == "geom" and found.is_gone(geom):
            # MuJoCo 4.0 leaves the mass of the geom in the body: of geoms of 1 and 2 kg, the body weighs 3 without the
            # second, too.
            body = next((each for each in geom.iterancestors("body") if not found.is_gone(each)), None)
            if body is not None:
                changed.add(body)
            detach(geom)
    # With `discardvisual` MuJoCo 4.0 leaves out every material, also those of geoms that stay: `nmat` is 0 for
    # `<material name="m"/>` and `<geom size=".1" material="m"/>`.
    for section in unit.root.iterchildren("*"):
        _remove_colors(section)
    left = {tag: found.names(tag) for tag in _ASSETS}
    for section in unit.root.iterchildren("asset"):
        for asset in list(section.iterchildren(*_ASSETS)):
            if (asset.get("name") or stem(str(asset.get("file") or ""))) not in left[str(asset.tag)]:
                detach(asset)
    return changed


def _remove_colors(section: Node) -> None:
    """Remove every reference to a material or texture, except those that keep it in the model."""
    table = naming_table(str(section.tag))
    for element in list(section.iter("*")):
        for name, (kind, namespace) in table.get(str(element.tag), {}).items():
            if kind in (REFERS, LISTS) and namespace in ("material", "texture") and name in element.attrib:
                del element.attrib[name]
                if section.tag == "default" and not element.attrib:
                    detach(element)
    for layer in list(section.iter("layer")):
        detach(layer)


def static_bodies(unit: Unit) -> list[Node]:
    """Return the bodies that no joint moves, neither their own nor one above them."""
    found: list[Node] = []
    for element, _ in walk_bodies(unit.root):
        if element.tag == "body" and element.get("mocap") != "true" and not own(element, *JOINTS):
            above = next(element.iterancestors("body"), None)
            if above is None or above in found:
                found.append(element)
    return found


def fuse(linking: Linking, unit: Unit, part: Part | None, found: Survey) -> set[Node]:
    """Turn the bodies that MuJoCo has fused into frames. Return the bodies that they became part of."""
    fused = [element for element, _ in walk_bodies(unit.root) if element.tag == "body" and found.is_gone(element)]
    # A fused body becomes part of the next body above that stays, or of the world (None).
    hosts = {
        body: next((above for above in body.iterancestors("body") if not found.is_gone(above)), None) for body in fused
    }
    if any(_report_flexcomp(linking, unit, body, host=host) for body, host in hosts.items()):
        return set()
    if part is not None and part.place.kind != "world":
        _remove_mass(linking, unit, part, bodies=[body for body, host in hosts.items() if host is None])
    frames = {str(frame.get("name")) for frame in unit.root.iter("frame")}
    for body in fused:
        _make_frame(body, frames)
    for host in dict.fromkeys(hosts.values()):
        for parent in (host,) if host is not None else unit.root.iterchildren("worldbody"):
            _own_elements_first(unit, parent, hosts)
    # The host has the mass of both.
    return {host for host in hosts.values() if host is not None}


def _make_frame(body: Node, frames: set[str]) -> None:
    """Turn a body into a frame, which keeps its name if it is free, so parts can still be attached there."""
    for child in own(body, "inertial", "plugin"):
        detach(child)
    body.tag = "frame"
    known = GRAMMAR.element("frame").attributes
    for name in list(body.attrib):
        if name not in known:
            del body.attrib[name]
    name = str(body.get("name") or "")
    # A frame may have the name of a body. Two frames of one name are "repeated name" in MuJoCo 4.0.
    if name in frames:
        del body.attrib["name"]
    elif name:
        frames.add(name)


def _own_elements_first(unit: Unit, parent: Node, fused: Collection[Node]) -> list[Node]:
    """Put a body's own elements before those of fused bodies, as MuJoCo numbers them. Return the bodies, at the end."""
    # Under `fusestatic` MuJoCo 4.0 counts the geom of `<body><joint/><body><geom/></body><geom/></body>` first that is
    # written last.
    first: list[Node] = []
    inner: list[Node] = []
    for child in list(parent):
        if child in fused:
            _own_elements_first(unit, child, fused)
        if not _is_inner(child, fused):
            first.append(child)
            continue
        inner.append(child)
        if child.tag == "frame" and child not in fused:
            behind = _own_elements_first(unit, child, fused)
            if len(behind) < len(child):
                # The elements except the bodies get a frame of their own with the same pose.
                attributes = {str(name): str(value) for name, value in child.items() if name != "name"}
                other = child.makeelement("frame", attributes)
                other.extend([each for each in child if each not in behind])
                if child in unit.origins.owners:
                    unit.origins.own(other, unit.origins.owners[child])
                first.append(other)
    parent.extend([*first, *inner])
    return inner


def _is_inner(element: Node, fused: Collection[Node]) -> bool:
    """Return whether an element is a body or contains bodies."""
    if element in fused or element.tag in ("body", "flexcomp"):
        return True
    return element.tag in ("frame", "replicate") and any(_is_inner(child, fused) for child in element)


def _report_flexcomp(linking: Linking, unit: Unit, body: Node, host: Node | None) -> bool:
    """Report a `<flexcomp>` whose joints would change: their classes come from its body, never from a frame."""
    flexcomp = next((child for child in through_frames(body) if child.tag == "flexcomp"), None)
    if flexcomp is None:
        return False
    before = unit.classes.get(body.get("childclass") or childclass_of(body))
    after = unit.classes.get(None if host is None else host.get("childclass") or childclass_of(host))
    if before is after or not (before.sets("joint") or after.sets("joint")):
        return False
    KeptSettings(linking, unit, ("fusestatic",)).refuse(
        "the joints of a `<flexcomp>` would have another class", flexcomp
    )
    return True


def _remove_mass(linking: Linking, unit: Unit, part: Part, bodies: list[Node]) -> None:
    """Remove the mass of bodies that are fused with the world, so the part adds no mass at its place."""
    # MuJoCo gives the world no mass, whatever its geoms: `body_mass` of `<worldbody><geom size=".1"/></worldbody>` is
    # 0.
    heavy: list[Node] = []
    for body in bodies:
        weighty = [geom for geom in own(body, "geom") if has_mass(geom, unit.classes)]
        for geom in weighty:
            geom.set("mass", "0")
        if weighty or own(body, "inertial"):
            heavy.append(body)
    if heavy:
        compiler = next(each for each in unit.root.iterchildren("compiler") if each.get("fusestatic"))
        linking.sink.warning(
            "compiler-setting",
            f"`fusestatic` makes bodies of `{part.called}` part of the world, which has no mass: "
            "the composition loses their mass",
            linking.span(unit, compiler, "fusestatic"),
            notes=[Note("such a body", linking.span(unit, heavy[0]))],
            help='remove `fusestatic="true"` from a copy of the file, and they stay bodies',
            cause=Cause(unit.file, f"`{part.called}`"),
        )
