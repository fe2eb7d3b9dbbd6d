"""Passes: masses, fitted sizes and length ranges become explicit; static bodies and visuals are removed on request.

The mass of each body becomes explicit if the unit's rule for it is not MuJoCo's default, which the model has. Length
ranges of muscles, which MuJoCo finds by moving the unit, become explicit if a `<lengthrange>` changes the method, or if
a part is attached to an element that moves, because MuJoCo would then move the part too.

`fusestatic` and `discardvisual` make MuJoCo leave out elements, and the linker removes the same elements. MuJoCo
compiles the unit alone to determine which these are, because its rules differ between versions. `discardvisual` removes
geoms that nothing collides with, assets that only these use, and all color. `fusestatic` merges a body without joints
into its parent, so a frame replaces it. The bodies that change get the inertia that they have in the unit alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Cause, Note
from mjcompose.base.rotation import Pose
from mjcompose.link import numbers
from mjcompose.link.key_layout import JOINTS
from mjcompose.link.linking import Linking, Part
from mjcompose.link.measure import BODIES, GEOMS, NAMED, KeptSettings, Survey
from mjcompose.link.numbers import pose_below
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS, Classes, childclass_of, own, through_frames, walk_bodies
from mjcompose.tree.files import SourceSettings, stem
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.journal import Why, because, explained
from mjcompose.tree.names import LISTS, REFERS, naming_table
from mjcompose.tree.unit import Unit

_DEFAULT = SourceSettings()
# Rules that change a whole model after its parts: only MuJoCo knows their result.
# MuJoCo 4.0 gives an empty `<body/>` a mass of 3 under `boundmass="3"`, and makes moments of 1 1 5 three of 2.3333
# under `balanceinertia`; `settotalmass` scales all bodies when everything else is done.
MEASURED = ("balanceinertia", "boundmass", "boundinertia", "settotalmass")
INERTIA_RULES = ("inertiafromgeom", "inertiagrouprange", *MEASURED)
"""All rules by which a file changes the mass or inertia that its elements say."""


def inertia(linking: Linking) -> None:
    """Rewrite each unit whose rule differs; a model of one unit keeps its own rules."""
    if not linking.composed:
        return
    for unit in linking.units:
        settings = unit.settings
        measured = [name for name in MEASURED if getattr(settings, name) != getattr(_DEFAULT, name)]
        if measured:
            with explained(_measured_alone(unit, measured)):
                write_inertias(linking, unit)
            continue
        if settings.inertiagrouprange.split() != ["0", "5"]:
            with explained(_made_explicit(unit, "inertiagrouprange")):
                _exclude_groups(unit, *map(numbers.integer, settings.inertiagrouprange.split()))
        # With the rule `true`, geoms override a written inertial; a body without geoms keeps it. A body whose geoms all
        # have no mass counts as a body without geoms: in MuJoCo 4.0 `<body><inertial mass="7" pos="0 0 0"
        # diaginertia="1 1 1"/></body>` keeps its mass of 7 under `inertiafromgeom="true"`. With the rule `false`, a
        # body without a written inertial has no mass, whatever its geoms are.
        if settings.inertiafromgeom in ("true", "false"):
            with explained(_made_explicit(unit, "inertiafromgeom")):
                for body in _bodies(unit):
                    _apply_rule(linking, unit, body)


def _measured_alone(unit: Unit, settings: list[str]) -> Why:
    named = " and ".join(f"`{name}`" for name in settings)
    place = unit.setting_place(settings[0])
    return because(f"measured by MuJoCo on {unit.file_name} alone, for its {named}", place)


def _made_explicit(unit: Unit, setting: str) -> Why:
    value = getattr(unit.settings, setting)
    return because(f'`{setting}="{value}"` of {unit.file_name}, made explicit', unit.setting_place(setting))


def _apply_rule(linking: Linking, unit: Unit, body: Node) -> None:
    """Apply `inertiafromgeom`, which is `true` or `false`, to one body."""
    inertials = own(body, "inertial")
    if unit.settings.inertiafromgeom == "false":
        if not inertials:
            _write_no_mass(linking, unit, body)
    elif inertials and any(has_mass(geom, unit.classes) for geom in own(body, "geom")):
        for inertial in inertials:
            journal.remove(inertial)


def _bodies(unit: Unit) -> list[Node]:
    return [element for element, _ in walk_bodies(unit.root) if element.tag == "body"]


def _exclude_groups(unit: Unit, low: int, high: int) -> None:
    classes = unit.classes
    for element, childclass in walk_bodies(unit.root):
        if element.tag == "geom":
            group = numbers.integer(classes.effective(element, childclass, "group") or "0")
            # The geom keeps its collisions and its looks: only a mass of 0 excludes it from the inertia. In MuJoCo 4.0
            # `inertiagrouprange="1 2"` leaves of two unit spheres in groups 0 and 1 the mass of one, 4188.79.
            if not low <= group <= high:
                journal.write(element, "mass", "0")


def has_mass(geom: Node, classes: Classes) -> bool:
    childclass = childclass_of(geom)
    mass = classes.effective(geom, childclass, "mass")
    # A mass wins over a density: in MuJoCo 4.0 `<geom size=".1" mass="0" density="1000"/>` weighs nothing.
    if mass is not None:
        return numbers.first(mass) != 0
    density = classes.effective(geom, childclass, "density")
    return density is None or numbers.first(density) != 0


def _write_no_mass(linking: Linking, unit: Unit, body: Node) -> None:
    for geom in own(body, "geom"):
        if has_mass(geom, unit.classes):
            journal.write(geom, "mass", "0")
    # For an inertia that is not set MuJoCo 4.0 copies the frame of the body in its parent: with `<compiler
    # inertiafromgeom="false"/>` the `<body pos="1 2 3"><geom size=".1"/></body>` has `body_ipos` 1 2 3.
    pose = {name: str(body.get(name)) for name in ("pos", *ORIENTATIONS) if body.get(name)}
    inertial = body.makeelement("inertial", {"pos": "0 0 0", **pose, "mass": "0", "diaginertia": "0 0 0"})
    journal.place(body, inertial, 0)
    linking.notes.inertia_written.add(body)


def write_inertias(linking: Linking, unit: Unit) -> None:
    wanting = [name for name in INERTIA_RULES if getattr(unit.settings, name) != getattr(_DEFAULT, name)]
    kept = KeptSettings(linking, unit, wanting)
    found = kept.survey(BODIES)
    if found is not None:
        _write_measured(kept, _bodies(unit), found)


def settle_inertia(linking: Linking, unit: Unit, changed: Collection[Node], found: Survey) -> None:
    """Write the surveyed inertia of changed bodies, or of all if a rule requires it; then MuJoCo's rules hold."""
    ruled = [name for name in INERTIA_RULES if getattr(unit.settings, name).split() != getattr(_DEFAULT, name).split()]
    bodies = [body for body in _bodies(unit) if (ruled or body in changed) and not found.is_gone(body)]
    if _write_measured(KeptSettings(linking, unit, ruled or ["fusestatic"]), bodies, found):
        unit.forget_settings(*ruled)


def _write_measured(kept: KeptSettings, bodies: Iterable[Node], found: Survey) -> bool:
    """Write the surveyed inertia onto these bodies. Report a body for which that is impossible."""
    if next(kept.unit.root.iter("flexcomp"), None) is not None and any(name in kept.names for name in MEASURED):
        kept.refuse("MuJoCo expands `<flexcomp>`")
        return False
    for body in bodies:
        rows = [found.values(body, array, width) for array, width in zip(BODIES, (1, 3, 4, 3), strict=True)]
        mass, pos, quat, moments = rows
        if mass is None or pos is None or quat is None or moments is None:
            gone = found.is_gone(body)
            kept.refuse("`fusestatic` joins this body with another" if gone else "the copies of a body differ", body)
            return False
        written = own(body, "inertial")
        for inertial in written:
            journal.remove(inertial)
        if not written:
            kept.linking.notes.inertia_written.add(body)
        # A body without mass and geoms needs no inertial. In a body with geoms, the inertial replaces theirs, as it
        # does under `auto`: `<body><inertial mass="1" …/><geom size="1"/></body>` weighs 1 in MuJoCo 4.0.
        if any(mass) or any(moments) or written or own(body, "geom"):
            values = {"pos": pos, "quat": quat, "mass": mass, "diaginertia": moments}
            inertial = body.makeelement("inertial", {name: numbers.text(given) for name, given in values.items()})
            journal.place(body, inertial, 0)
            for replaced in written:
                journal.note_source(inertial, replaced)
    return True


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def fitted_sizes(linking: Linking) -> None:
    if linking.composed:
        for unit in linking.units:
            if unit.settings.fitaabb != "true":
                continue
            classes = unit.classes
            fitted = {
                geom: str(kind)
                for geom, childclass in walk_bodies(unit.root)
                if geom.tag == "geom"
                and (kind := classes.effective(geom, childclass, "type")) in _SIZES
                and classes.effective(geom, childclass, "mesh")
            }
            kept = KeptSettings(linking, unit, ("fitaabb",))
            found = kept.survey(GEOMS) if fitted else None
            if found is None:
                continue
            words = f"fitted by MuJoCo to the mesh's bounding box: `fitaabb` of {unit.file_name}"
            with explained(because(words, unit.setting_place("fitaabb"))):
                for geom, kind in fitted.items():
                    _write_fitted(kept, geom, _SIZES[kind], found=found)


def _write_fitted(kept: KeptSettings, geom: Node, sizes: int, found: Survey) -> None:
    unit = kept.unit
    size, pos, quat = [found.values(geom, array, width) for array, width in zip(GEOMS, (3, 3, 4), strict=True)]
    if size is None or pos is None or quat is None:
        kept.refuse("the copies of a geom differ", geom)
        return
    x, y, z = pos
    w, a, b, c = quat
    pose = Pose((x, y, z), (w, a, b, c))
    # MuJoCo dissolves frames: `<frame euler="0 0 90"><geom size="1" pos="1 0 0"/></frame>` has `geom_pos` 0 1 0.
    holder = geom.getparent()
    assert holder is not None
    frame, *_ = pose_below(holder, unit.settings.angle == "degree", unit.settings.eulerseq)
    if not frame.is_identity:
        pose = frame.inverse() @ pose
    for name in ("mesh", "fitscale", "fromto", *ORIENTATIONS):
        journal.drop(geom, name)
    # An empty text reverts the class: with `<default><geom mesh="m" type="mesh"/></default>` MuJoCo 4.0
    # compiles `<geom mesh="" type="sphere" size="1"/>` to a sphere without a mesh.
    if unit.classes.effective(geom, childclass_of(geom), "mesh"):
        journal.write(geom, "mesh", "")
    journal.write(geom, "size", numbers.text(size[:sizes]))
    journal.write(geom, "pos", numbers.text(pose.pos))
    journal.write(geom, "quat", numbers.text(pose.quat))


def lengthranges(linking: Linking) -> None:
    """Measure the actuators of each unit that has rules of its own; the model keeps MuJoCo's rules."""
    if not linking.parts:
        return
    for unit in linking.units:
        rules = list(unit.root.iter("lengthrange"))
        actuators = unit.root.findall("actuator/*")
        measured: list[float] | None = []
        if not rules:
            measured = _ranges_without_rules(linking, unit)
        elif actuators:
            measured = _ranges_by_rules(linking, unit)
        # MuJoCo makes copies of some actuators, whose ranges it computes again.
        if measured is None or len(measured) != 2 * len(actuators):
            continue
        why = _own_lengths(unit, rules)
        for at, actuator in enumerate(actuators):
            limits = measured[2 * at : 2 * at + 2]
            # MuJoCo reads `0 0` as not written: for `<muscle lengthrange="0 0"/>` it computes a range.
            if any(limits):
                journal.write(actuator, "lengthrange", numbers.text(limits), why)
            elif rules and _is_muscle(actuator):
                _report_no_range(linking, unit, actuator, rules[-1])
                break
        for rule in rules:
            journal.remove(rule, because("the length ranges that it gives are written on the actuators"))


_LENGTHRANGE = "actuator_lengthrange"


def _ranges_by_rules(linking: Linking, unit: Unit) -> list[float] | None:
    """Return the ranges of the actuators by the unit's own rules, or None after an error."""
    kept = KeptSettings(linking, unit, ("lengthrange",))
    survey = kept.survey((_LENGTHRANGE,))
    if survey is None:
        return None
    measured = survey.arrays[_LENGTHRANGE]
    if len(measured) != 2 * len(unit.root.findall("actuator/*")):
        kept.refuse("MuJoCo makes copies of actuators")
        return None
    return measured


def _ranges_without_rules(linking: Linking, unit: Unit) -> list[float]:
    """Return the ranges of the actuators if a muscle may move a body that another part hangs on."""
    # MuJoCo would move a part with the unit that it is attached to, and it may stop that earlier.
    hanging = any(part.joints or part.place.kind != "world" for part in linking.parts)
    sections = unit.root.iterchildren("actuator", "default")
    candidates = (element for section in sections for element in section.iter("muscle", "general"))
    if not hanging or linking.measure is None or not any(map(_is_muscle, candidates)):
        return []
    return linking.measure(unit, (_LENGTHRANGE,)).get(_LENGTHRANGE, [])


def _report_no_range(linking: Linking, unit: Unit, muscle: Node, rule: Node) -> None:
    message = f"`lengthrange` of `{unit.label}` cannot be kept in a composition: it leaves a muscle without a range"
    notes = (Note("the muscle", linking.span(unit, muscle)),)
    help = "write the `lengthrange` of the muscle"
    linking.sink.error("compiler-setting", message, linking.span(unit, rule), notes=notes, help=help)


def _own_lengths(unit: Unit, rules: list[Node]) -> Why:
    words = f"measured by MuJoCo on {unit.file_name} alone"
    if not rules:
        return because(f"{words}, without attachments on the bodies that the muscle moves")
    return because(f"{words}, by its own `<lengthrange>`", unit.origins.lasting_place(rules[0], unit.file))


_MUSCLE_LAWS = (("gainprm", "gaintype"), ("biasprm", "biastype"))
_MUSCLE = 2  # mjGAIN_MUSCLE, mjBIAS_MUSCLE
_FORCE = 2
_SCALE = 3
_PARAMETERS = 10
_STRENGTHS = (
    "actuator_acc0",
    "actuator_outadr",
    *(f"actuator_{name}" for pair in _MUSCLE_LAWS for name in pair),
)


def muscle_forces(linking: Linking) -> None:
    """Write the peak force that each muscle has in its file alone, if bodies of other files can change it.

    In MuJoCo 4.0, the peak force of a muscle without `force` is `scale` / `acc0`, and `acc0` depends on all bodies that
    hang together: a finger whose muscle gives 0.26 N m gave 0.06 N m on an arm.
    """
    hanging = any(part.joints or part.place.kind != "world" for part in linking.parts) or linking.request.adds_mass
    if hanging:
        for unit in linking.units:
            sections = unit.root.iterchildren("actuator", "default")
            candidates = (each for section in sections for each in section.iter("muscle", "general"))
            if linking.measure is None or not any(map(_is_muscle, candidates)):
                continue
            arrays = linking.measure(unit, _STRENGTHS)
            actuators = unit.root.findall("actuator/*")
            if len(arrays.get("actuator_gaintype", ())) != len(actuators):
                continue  # MuJoCo makes copies of actuators; a part whose muscles differ then fails as changed
            for row, actuator in enumerate(actuators):
                _write_force(unit, actuator, row, arrays)


def _write_force(unit: Unit, actuator: Node, row: int, arrays: Mapping[str, list[float]]) -> None:
    output = int(arrays["actuator_outadr"][row]) if "actuator_outadr" in arrays else row
    acceleration = arrays["actuator_acc0"][output]
    width = len(arrays["actuator_gainprm"]) // len(arrays["actuator_gaintype"])
    why = because(f"the peak force that its `scale` gives it in {unit.file_name} alone")
    for name, kind in _MUSCLE_LAWS:
        parameters = arrays[f"actuator_{name}"][row * width : row * width + _PARAMETERS]
        if int(arrays[f"actuator_{kind}"][row]) != _MUSCLE or parameters[_FORCE] >= 0 or not acceleration:
            continue
        parameters[_FORCE] = parameters[_SCALE] / acceleration
        if actuator.tag == "muscle":
            journal.write(actuator, "force", numbers.text([parameters[_FORCE]]), why)
        else:
            journal.write(actuator, name, numbers.text(parameters), why)


def _is_muscle(actuator: Node) -> bool:
    return actuator.tag == "muscle" or "muscle" in (actuator.get("gaintype"), actuator.get("biastype"))


def body_reduction(linking: Linking) -> None:
    """Reduce each unit that requests it; MuJoCo itself reduces a model of one unit."""
    if linking.composed:
        for part in (None, *linking.parts):
            unit = linking.base if part is None else part.unit
            wanted = [name for name in ("fusestatic", "discardvisual") if getattr(unit.settings, name) == "true"]
            # Below a joint of the recipe, bodies that would be part of the world alone keep their mass.
            pinned = static_bodies(unit) if wanted and part is not None and part.has_body else ()
            found = KeptSettings(linking, unit, wanted).survey((*BODIES, *NAMED), pinned=pinned) if wanted else None
            if found is None:
                continue
            with explained(_reduced_alone(unit, wanted)):
                changed = discard(unit, found) if "discardvisual" in wanted else set()
                changed |= fuse(linking, unit, part, found=found) if "fusestatic" in wanted else set()
                unit.forget_settings(*wanted)
                settle_inertia(linking, unit, changed, found=found)


def _reduced_alone(unit: Unit, settings: list[str]) -> Why:
    named = " and ".join(f"`{name}`" for name in settings)
    return because(f"as MuJoCo has it in {unit.file_name} alone, by its {named}", unit.setting_place(settings[0]))


_ASSETS = ("mesh", "material", "texture")


def discard(unit: Unit, found: Survey) -> set[Node]:
    """Remove the elements that MuJoCo has discarded from the unit. Return the bodies that have lost geoms."""
    changed: set[Node] = set()
    for geom, _ in list(walk_bodies(unit.root)):
        if geom.tag == "geom" and found.is_gone(geom):
            # MuJoCo 4.0 leaves the mass of the geom in the body: without the second of 1 and 2 kg it weighs 3, too.
            body = next((each for each in geom.iterancestors("body") if not found.is_gone(each)), None)
            if body is not None:
                changed.add(body)
            journal.remove(geom)
    # With `discardvisual` MuJoCo 4.0 leaves out every material, also those of geoms that stay: `nmat` is 0 for
    # `<material name="m"/>` and `<geom size=".1" material="m"/>`.
    for section in unit.root.iterchildren("*"):
        _remove_colors(section)
    left = {tag: found.names(tag) for tag in _ASSETS}
    for section in unit.root.iterchildren("asset"):
        for asset in list(section.iterchildren(*_ASSETS)):
            if (asset.get("name") or stem(str(asset.get("file") or ""))) not in left[str(asset.tag)]:
                journal.remove(asset)
    return changed


def _remove_colors(section: Node) -> None:
    """Remove every reference to a material or texture, except references that keep it in the model."""
    table = naming_table(str(section.tag))
    for element in list(section.iter("*")):
        for name, (kind, namespace) in table.get(str(element.tag), {}).items():
            if kind in (REFERS, LISTS) and namespace in ("material", "texture") and name in element.attrib:
                journal.drop(element, name)
                if section.tag == "default" and not element.attrib:
                    journal.remove(element)
    for layer in list(section.iter("layer")):
        journal.remove(layer)


def static_bodies(unit: Unit) -> list[Node]:
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
        parents = (host,) if host is not None else unit.root.iterchildren("worldbody")
        for parent in parents:
            _own_elements_first(unit, parent, hosts)
    # The host has the mass of both.
    return {host for host in hosts.values() if host is not None}


def _make_frame(body: Node, frames: set[str]) -> None:
    """Turn a body into a frame, which keeps its name if it is free, so parts can still be attached there."""
    for child in own(body, "inertial", "plugin"):
        journal.remove(child)
    journal.retag(body, "frame")
    known = GRAMMAR.element("frame").attributes
    for name in [str(name) for name, _ in body.items()]:
        if name not in known:
            journal.drop(body, name)
    name = str(body.get("name") or "")
    # A frame may have the name of a body. Two frames of one name are "repeated name" in MuJoCo 4.0.
    if name in frames:
        journal.drop(body, "name")
    elif name:
        frames.add(name)


def _own_elements_first(unit: Unit, parent: Node, fused: Collection[Node]) -> list[Node]:
    """Put a body's own elements before those of fused bodies, as MuJoCo numbers them. Return the bodies, at the end."""
    # Under `fusestatic` MuJoCo 4.0 counts the last geom of `<body><joint/><body><geom/></body><geom/></body>` first.
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
                journal.place_all(other, [each for each in child if each not in behind])
                unit.origins.own_as(other, child)
                first.append(other)
    journal.place_all(parent, [*first, *inner])
    return inner


def _is_inner(element: Node, fused: Collection[Node]) -> bool:
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
    message = "the joints of a `<flexcomp>` would have another class"
    KeptSettings(linking, unit, ("fusestatic",)).refuse(message, flexcomp)
    return True


def _remove_mass(linking: Linking, unit: Unit, part: Part, bodies: list[Node]) -> None:
    """Remove the mass of bodies that are fused with the world, so the part adds no mass at its place."""
    # MuJoCo gives the world no mass: `<worldbody><geom size=".1"/></worldbody>` has a `body_mass` of 0.
    heavy: list[Node] = []
    for body in bodies:
        weighty = [geom for geom in own(body, "geom") if has_mass(geom, unit.classes)]
        for geom in weighty:
            journal.write(geom, "mass", "0")
        if weighty or own(body, "inertial"):
            heavy.append(body)
    if heavy:
        compiler = next(each for each in unit.root.iterchildren("compiler") if each.get("fusestatic"))
        which = "part of the world, which has no mass: the composition loses their mass"
        message = f"`fusestatic` makes bodies of `{part.called}` {which}"
        span = linking.span(unit, compiler, "fusestatic")
        notes = [Note("such a body", linking.span(unit, heavy[0]))]
        cause = Cause(unit.file, f"`{part.called}`")
        help = 'remove `fusestatic="true"` from a copy of the file, and they stay bodies'
        linking.sink.warning("compiler-setting", message, span, notes=notes, help=help, cause=cause)
