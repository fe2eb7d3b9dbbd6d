"""Limits of targets: trees of bodies, actuators, ignored elements, and MuJoCo's solver.

Options of the solver are reported only if they differ from MuJoCo's defaults, because default options were not chosen.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.targets.plain import simple_actuators, text
from mjcompose.targets.same import Pose, about, back, joined, pose, quat, shifted
from mjcompose.targets.target import Draft, FeatureOutcome, Limit

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

NAME = "world_root"
_EMPTY = {"mass": "0", "pos": "0 0 0", "quat": "1 0 0 0", "diaginertia": "0 0 0"}


def one_root(*, with_free: bool) -> Limit:
    """Return a limit that puts the bodies of the world into one.

    It is for a target that reads one body in the world, or places it by its center of mass. Bodies with a free joint
    are moved only `with_free`, because MuJoCo does not read them there.
    """

    def apply(draft: Draft) -> None:
        for world in draft.root.iterfind("worldbody"):
            bodies = list(world.iterchildren("body"))
            free = [body for body in bodies if _is_free(body)]
            if with_free and len(bodies) == 1 and free:
                continue
            held = bodies if with_free else [body for body in bodies if body not in free]
            if not held:
                continue
            draft.mujoco_reads &= not (with_free and free)  # MJCF has free joints at the top alone
            root = etree.SubElement(world, "body", name=NAME, pos="0 0 0", quat="1 0 0 0")
            etree.SubElement(root, "inertial", _EMPTY)
            root.extend(held)
            for body in held:
                draft.lose(
                    "roots", body, f"a body `{NAME}` holds the bodies of the world", outcome=FeatureOutcome.WRITTEN
                )

    return Limit("roots", FeatureOutcome.WRITTEN, apply)


def _is_free(body: Node) -> bool:
    joints = body.iterchildren("joint", "freejoint")
    return any(each.tag == "freejoint" or each.get("type") == "free" for each in joints)


def single_joints(mass: str = "0") -> Limit:
    """Return a limit that gives each further joint of a body a body of its own, with this mass (kg) and inertia."""

    def apply(draft: Draft) -> None:
        for body in list(draft.root.iterfind(".//body")):
            joints = list(body.iterchildren("joint"))
            holder = body.getparent()
            if len(joints) < 2 or holder is None:
                continue
            draft.mujoco_reads &= mass != "0"  # nothing that moves may be without a mass there
            draft.lose("joints", body, "each joint but the last has a body of its own", outcome=FeatureOutcome.WRITTEN)
            at = holder.index(body)
            place = {"pos": str(body.get("pos")), "quat": str(body.get("quat"))}
            for joint in joints[:-1]:
                between = etree.Element("body", {"name": f"{body.get('name')}__{joint.get('name')}", **place})
                heavy = {"mass": mass, "diaginertia": f"{mass} {mass} {mass}"}
                etree.SubElement(between, "inertial", _EMPTY | heavy)
                between.append(joint)
                holder.insert(at, between)
                holder = between
                at = len(between)
                place = {"pos": "0 0 0", "quat": "1 0 0 0"}
            body.set("pos", place["pos"])
            body.set("quat", place["quat"])
            holder.append(body)

    return Limit("joints", FeatureOutcome.WRITTEN, apply)


def _zeroed(draft: Draft) -> None:
    for body in draft.root.iterfind(".//body"):
        joints = [each for each in body.iterchildren("joint") if each.get("type") in ("hinge", "slide")]
        if not any(_reference(each) for each in joints):
            continue
        stands = pose(_numbers(body, "pos"), _numbers(body, "quat"))
        behind = shifted((0, 0, 0))
        for joint in reversed(joints):
            to_zero = _moved(joint, -_reference(joint))
            moved, turned = back(behind)  # the frame of the joint's body has moved
            joint.set("pos", text(moved + turned @ _numbers(joint, "pos")))
            joint.set("axis", text(turned @ _numbers(joint, "axis")))
            behind = joined(to_zero, behind)
        at, turned = joined(stands, behind)
        body.set("pos", text(at))
        body.set("quat", text(quat(turned)))
        for joint in joints:
            if joint.attrib.pop("ref", ""):
                why = "their bodies are where the joints are at zero"
                draft.lose("references", joint, why, outcome=FeatureOutcome.WRITTEN)


def _moved(joint: Node, by: float) -> Pose:
    """Return the motion of a joint's body, in its frame, when the joint moves by an angle (rad) or a distance (m)."""
    anchor = shifted(_numbers(joint, "pos"))
    axis = _numbers(joint, "axis")
    return shifted(by * axis) if joint.get("type") == "slide" else joined(anchor, about(axis, by), back(anchor))


def _reference(joint: Node) -> float:
    return float(joint.get("ref") or 0)


def _numbers(element: Node, name: str) -> Any:
    return np.array([float(each) for each in str(element.get(name)).split()])


SINGLE_JOINTS = single_joints()
NO_REFERENCES = Limit("references", FeatureOutcome.WRITTEN, _zeroed)


_DYNAMICS = {"damping": "damping", "frictionloss": "friction", "armature": "armature"}
_WORDS = {"frictionloss": "dry friction"}
_SHOWN_GROUP = 2
"""Programs show the groups up to this one, as MuJoCo does at first."""
_ZERO = frozenset("0. ")


def left_out(feature: str, *paths: str, why: str = "", but: Collection[str] = ()) -> Limit:
    """Return a limit that removes the elements at these paths, except some tags. `why` names the consequence."""

    def apply(draft: Draft) -> None:
        for path in paths:
            for element in list(draft.root.iterfind(path)):
                if element.tag not in but:
                    draft.lose(feature, element, why)
                    draft.remove(element)

    return Limit(feature, FeatureOutcome.PARTLY if but else FeatureOutcome.LEFT_OUT, apply)


def refused(feature: str, path: str, why: str, help: str) -> Limit:
    def apply(draft: Draft) -> None:
        for element in draft.root.iterfind(path):
            draft.lose(feature, element, why, outcome=FeatureOutcome.REFUSED, help=help)

    return Limit(feature, FeatureOutcome.REFUSED, apply)


def without_attribute(
    feature: str,
    path: str,
    name: str,
    what: str,
    why: str = "",
    *,
    also: Collection[str] = (),
    outcome: FeatureOutcome = FeatureOutcome.LEFT_OUT,
) -> Limit:
    """Return a limit that removes an attribute, and attributes that have no meaning without it.

    A value other than zero is a loss. The outcome is `PARTLY` if other elements or attributes keep the feature.
    """

    def apply(draft: Draft) -> None:
        for element in draft.root.iterfind(path):
            value = str(element.attrib.pop(name, ""))
            for each in also:
                element.attrib.pop(each, "")
            if not _ZERO.issuperset(value):
                draft.lose(feature, element, why, what=what)

    return Limit(feature, outcome, apply)


def no_shapes(*kinds: str) -> Limit:
    """Return a limit that removes geoms of these types, and the height fields that no other geom uses."""

    def apply(draft: Draft) -> None:
        for _, geom in list(draft.of("geom")):
            if geom.get("type") in kinds:
                shape = "height field" if geom.get("type") == "hfield" else geom.get("type")
                draft.lose("shapes", geom, what=f"the {shape}")
                draft.remove(geom)
        used = {geom.get("hfield") for geom in draft.root.iterfind(".//geom")}
        for field in list(draft.root.iterfind("asset/hfield")):
            if field.get("name") not in used:
                draft.remove(field)

    return Limit("shapes", FeatureOutcome.PARTLY, apply)


def unread_in(joints: str, *attributes: str) -> tuple[Limit, ...]:
    """Return limits that remove attributes from joints of a type."""
    path = f".//joint[@type='{joints}']"
    return tuple(
        without_attribute(_DYNAMICS[name], path, name, what=_WORDS.get(name, name), outcome=FeatureOutcome.PARTLY)
        for name in attributes
    )


def _hidden(draft: Draft) -> None:
    for number, geom in list(draft.of("geom")):
        touches = draft.model.geom_contype[number] or draft.model.geom_conaffinity[number]
        if not touches and draft.model.geom_group[number] > _SHOWN_GROUP:
            draft.lose("shapes", geom, "they neither collide nor are shown")
            draft.remove(geom)


def _linear(draft: Draft) -> None:
    for path in (".//joint", "tendon/*", "actuator/*"):
        for element in draft.root.iterfind(path):
            for name in ("damping", "stiffness"):
                first, *rest = str(element.get(name) or "0").split()
                if rest:
                    element.set(name, first)
                    draft.lose("polynomials", element, "what is linear is read", what=f"the higher terms of {name}")


def _plain_colors(draft: Draft) -> None:
    for material in draft.root.iterfind("asset/material"):
        layers = list(material.iterchildren("layer"))
        for layer in layers:
            material.remove(layer)
        if material.attrib.pop("texture", "") or layers:
            draft.lose("textures", material, what="textures")
    for texture in list(draft.root.iterfind("asset/texture")):
        draft.remove(texture)


def _bare(draft: Draft) -> None:
    for inertial in list(draft.root.iterfind(".//inertial")):
        if float(str(inertial.get("mass"))) == 0:
            draft.remove(inertial)
    for compiler in draft.root.iterchildren("compiler"):
        compiler.attrib.pop("inertiafromgeom", "")  # their geoms are written without a mass


NO_HIDDEN_SHAPES = Limit("shapes", FeatureOutcome.PARTLY, _hidden)
NO_EMPTY_INERTIA = Limit("massless", FeatureOutcome.KEPT, _bare)
"""For a target in which an inertia needs a mass."""
NO_KEYS = left_out("keys", "keyframe/key")
NO_SENSORS = left_out("sensors", "sensor/*")
NO_CAMERAS = left_out("cameras", ".//camera")
NO_LIGHTS = left_out("lights", ".//light")
NO_SITES = left_out("sites", ".//site")
NO_TENDONS = left_out("tendons", "tendon/*")
NO_EQUALITY = left_out("equality", "equality/*", why="what they couple moves freely")
NO_PAIRS = left_out("pairs", "contact/pair")
NO_EXCLUDES = left_out("excludes", "contact/exclude", why="these bodies collide")
NO_SOFT = left_out("soft", "deformable/*", "asset/skin")
NO_PLUGINS = left_out("plugins", "extension/*", ".//plugin")
NO_CUSTOM = left_out("custom", "custom/*")
NO_SPRINGS = without_attribute(
    "springs", ".//joint", "stiffness", what="stiffness", also=("springref", "springdamper", "springyield")
)
NO_FRICTION = without_attribute("friction", ".//joint", "frictionloss", what="dry friction")
NO_DAMPING = without_attribute("damping", ".//joint", "damping", what="damping")
NO_ARMATURE = without_attribute("armature", ".//joint", "armature", what="armature")


def _no_effort(outcome: FeatureOutcome) -> Limit:
    also = ("actuatorfrclimited", "actuatorgravcomp")
    what = "the greatest force"
    return without_attribute("effort", ".//joint", "actuatorfrcrange", what=what, also=also, outcome=outcome)


NO_EFFORT = _no_effort(FeatureOutcome.LEFT_OUT)
NO_JOINT_EFFORT = _no_effort(FeatureOutcome.PARTLY)
"""For a target that reads the force ranges of actuators."""
NO_TEXTURES = Limit("textures", FeatureOutcome.LEFT_OUT, _plain_colors)
NO_YIELD = without_attribute("springs", ".//joint", "springyield", what="`springyield`", outcome=FeatureOutcome.PARTLY)
NO_POLYNOMIALS = Limit("polynomials", FeatureOutcome.LEFT_OUT, _linear)


_SINGLE = ("hinge", "slide")
_GAINS = ("kp", "kv")
_SIMPLE = ("motor", "position", "velocity")
_JOINT = 0  # mjTRN_JOINT


def servos(*tags: str) -> Limit:
    """Return a limit that keeps actuators with these tags that act on a hinge or a slide, and removes the others."""
    why = f"it reads {' and '.join(f'`{tag}`' for tag in tags)} of hinges and slides" if tags else ""

    def apply(draft: Draft) -> None:
        simple_actuators(draft.root, any_input=True)
        single = {joint.get("name") for joint in draft.root.iterfind(".//joint") if joint.get("type") in _SINGLE}
        for actuator in list(draft.root.iterfind("actuator/*")):
            if actuator.tag not in tags or actuator.get("joint") not in single:
                draft.lose("actuators", actuator, why)
                draft.remove(actuator)

    return Limit("actuators", FeatureOutcome.PARTLY if tags else FeatureOutcome.LEFT_OUT, apply)


def _one_for_each_joint(draft: Draft) -> None:
    """Keep actuators without dynamics that are the only ones of a hinge or a slide."""
    single = {joint.get("name") for joint in draft.root.iterfind(".//joint") if joint.get("type") in _SINGLE}
    actuators = list(draft.root.iterfind("actuator/*"))
    joints = [actuator.get("joint") for actuator in actuators]
    for actuator, joint in zip(actuators, joints, strict=True):
        if joint not in single or joints.count(joint) > 1 or actuator.get("dyntype", "none") != "none":
            draft.lose("actuators", actuator, "it reads one for each hinge or slide, without dynamics")
            draft.remove(actuator)


def _at_joints(draft: Draft) -> None:
    """Multiply each gear into the values that it changes."""
    for actuator in draft.root.iterfind("actuator/*"):
        gear = _gear(actuator)
        if actuator.get("joint") is None or gear in (0, 1):
            continue
        if actuator.tag not in _SIMPLE:
            draft.lose("gears", actuator, what="`gear`")
            continue
        del actuator.attrib["gear"]
        for name in _GAINS:
            if actuator.get(name):
                actuator.set(name, text(float(str(actuator.get(name))) * gear**2))
        _scale(actuator, "forcerange", gear)
        _scale(actuator, "ctrlrange", gear if actuator.tag == "motor" else 1 / gear)
        why = "their gear is in their gains, and controls are at the joint"
        draft.lose("gears", actuator, why, outcome=FeatureOutcome.WRITTEN)


def _gear(actuator: Node) -> float:
    return float((actuator.get("gear") or "1").split()[0])


def _scale(element: Node, name: str, by: float) -> None:
    if element.get(name):
        element.set(name, text(sorted(float(each) * by for each in str(element.get(name)).split())))


_BOTH_SIDES = "it has the same limit on both sides"


def _symmetric(draft: Draft) -> None:
    """Widen each range of a force to the same limit on both sides."""
    _widen(draft, "actuator/*", "forcerange")
    _widen(draft, "actuator/motor", "ctrlrange")


def _symmetric_efforts(draft: Draft) -> None:
    """Widen the ranges of forces of joints and actuators, and keep the ranges of controls."""
    _widen(draft, "actuator/*", "forcerange")
    _widen(draft, ".//joint", "actuatorfrcrange")


def _widen(draft: Draft, path: str, name: str) -> None:
    for element in draft.root.iterfind(path):
        ends = [float(each) for each in (element.get(name) or "").split()]
        most = max(map(abs, ends), default=0.0)
        if ends and (ends[0] != -most or ends[1] != most):
            element.set(name, text((-most, most)))
            draft.lose("effort", element, _BOTH_SIDES, what=f"the narrower side of `{name}`")


def _reflected(draft: Draft) -> None:
    """Leave out the armature of joints without an actuator.

    Drake 1.51 reads the armature of a joint as the inertia of the rotor of its actuator. It uses one of several
    actuators.
    """
    driven = {actuator.get("joint") for actuator in draft.root.iterfind("actuator/*")}
    for joint in draft.root.iterfind(".//joint"):
        if joint.get("name") not in driven and float(joint.attrib.pop("armature", "") or 0):
            draft.lose("armature", joint, "it reads that of joints with an actuator", what="armature")


def _carried(draft: Draft) -> None:
    """Also write the largest force of a joint's actuators as the joint's own limit."""
    for number, joint in draft.of("joint"):
        most = greatest_force(draft.model, number)
        if joint.get("type") in _SINGLE and most is not None and not draft.model.jnt_actgravcomp[number]:
            joint.set("actuatorfrcrange", text((-most, most)))
            joint.set("actuatorfrclimited", "true")


def greatest_force(model: MjModel, joint: int) -> float | None:
    """Return the greatest force (N) or torque (N·m) at a joint, from its actuators and its own limit; None without."""
    limits = [float(np.abs(model.jnt_actfrcrange[joint]).max())] if model.jnt_actfrclimited[joint] else []
    drives = np.flatnonzero((model.actuator_trntype == _JOINT) & (model.actuator_trnid[:, 0] == joint)).tolist()
    known = [each for each in [_greatest(model, each) for each in drives] if each is not None]
    if drives and len(known) == len(drives):
        limits.append(sum(known))
    return min(limits, default=None)


def _greatest(model: MjModel, actuator: int) -> float | None:
    """Return the greatest force of an actuator at its joint: by its range, or of a motor by its control's range."""
    ends = np.array([-np.inf, np.inf])
    if model.actuator_forcelimited[actuator]:
        ends = model.actuator_forcerange[actuator]
    is_motor = not any(getattr(model, f"actuator_{name}type")[actuator] for name in ("gain", "bias", "dyn"))
    if is_motor and model.actuator_ctrllimited[actuator]:
        ends = np.clip(ends, *np.sort(model.actuator_ctrlrange[actuator] * model.actuator_gainprm[actuator][0]))
    most = float(np.abs(ends).max()) * abs(float(model.actuator_gear[actuator][0]))
    return most if np.isfinite(most) else None


def _geared(draft: Draft) -> None:
    for actuator in draft.root.iterfind("actuator/*"):
        if actuator.get("joint") and _gear(actuator) != 1:
            why = "its solvers other than MuJoCo take the gains as they are"
            draft.lose("gears", actuator, why, what="`gear`")


ONE_FOR_EACH_JOINT = Limit("actuators", FeatureOutcome.PARTLY, _one_for_each_joint)
AT_JOINTS = Limit("gears", FeatureOutcome.WRITTEN, _at_joints)
GEARS = Limit("gears", FeatureOutcome.PARTLY, _geared)
SYMMETRIC_FORCES = Limit("effort", FeatureOutcome.PARTLY, _symmetric)
SYMMETRIC_EFFORTS = Limit("effort", FeatureOutcome.PARTLY, _symmetric_efforts)
REFLECTED_ARMATURE = Limit("armature", FeatureOutcome.PARTLY, _reflected)
CARRIED_FORCES = Limit("effort", FeatureOutcome.WRITTEN, _carried)
NO_SERVO_DAMPING = without_attribute("gains", "actuator/position", "kv", what="`kv`")
NO_ACTUATOR_ARMATURE = without_attribute(
    "armature", "actuator/*", "armature", what="armature", outcome=FeatureOutcome.PARTLY
)
NO_DELAY = without_attribute(
    "actuators", "actuator/*", "delay", what="`delay`", also=("nsample", "interp"), outcome=FeatureOutcome.PARTLY
)
NO_ACTUATOR_DAMPING = without_attribute(
    "damping", "actuator/*", "damping", what="damping", outcome=FeatureOutcome.PARTLY
)


_PLAIN = "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"
_OPTIONS = (
    "timestep",
    "integrator",
    "cone",
    "impratio",
    "density",
    "viscosity",
    "wind",
    "magnetic",
    "noslip_iterations",
    "disableflags",
    "enableflags",
)
_SOFTNESS = ("solref", "solimp", "margin", "gap", "priority", "solmix", "condim")
_FRICTION = {"sliding": 0, "torsional": 1, "rolling": 2}


def unread_contacts(*friction: str, but: Collection[str] = ()) -> Limit:
    """Return a limit that reports the softness and margins of contacts as lost.

    Attributes in `but` and these kinds of `friction` are read by the target.
    """
    names = [each for each in _SOFTNESS if each not in but]

    def apply(draft: Draft) -> None:
        model = draft.model
        plain = _plain(draft)
        for number, node in draft.of("geom"):
            if model.geom_contype[number] or model.geom_conaffinity[number]:
                changed = _changed(model, plain, number, names=names, kind="geom")
                for word in friction:
                    at = _FRICTION[word]
                    if model.geom_friction[number][at] != plain.geom_friction[0][at]:
                        changed.append(f"{word} friction")
                if changed:
                    draft.lose("contacts", node, what=f"{_listed(changed)} of the contacts")

    return Limit("contacts", FeatureOutcome.LEFT_OUT, apply)


def _plain(draft: Draft) -> Any:
    return draft.mujoco.MjModel.from_xml_string(_PLAIN)


def _options(draft: Draft) -> None:
    mine = draft.model.opt
    plain = _plain(draft).opt
    names = [name for name in _OPTIONS if not np.array_equal(getattr(mine, name), getattr(plain, name))]
    changed = ["flag" if name.endswith("flags") else name for name in names]
    for option in draft.root.iterchildren("option"):
        if changed:
            draft.lose("computing", option, "it has settings of its own", what=_listed(changed))


def _gravity(draft: Draft) -> None:
    if np.array_equal(draft.model.opt.gravity, _plain(draft).opt.gravity):
        return
    for option in draft.root.iterchildren("option"):
        shown = " ".join(f"{each:g}" for each in draft.model.opt.gravity)
        draft.lose("gravity", option, f"set it to {shown} in the program", what="gravity")


def _changed(model: MjModel, plain: Any, number: int, names: Collection[str], kind: str) -> list[str]:
    values = {name: (getattr(model, f"{kind}_{name}")[number], getattr(plain, f"{kind}_{name}")[0]) for name in names}
    return [name for name, (mine, default) in values.items() if not np.array_equal(mine, default)]


def _bits(draft: Draft) -> None:
    model = draft.model
    for number, node in draft.of("geom"):
        bits = int(model.geom_contype[number]), int(model.geom_conaffinity[number])
        if bits not in ((0, 0), (1, 1)):
            draft.lose("bits", node, "they collide with everything", what="`contype` and `conaffinity`")


def _soft_limits(draft: Draft) -> None:
    model = draft.model
    plain = _plain(draft)
    for number, node in draft.of("joint"):
        changed = _changed(model, plain, number, names=("solref", "solimp", "margin"), kind="jnt")
        if changed and model.jnt_limited[number]:
            draft.lose("softness", node, what=f"{_listed(changed)} of the limits")


def _gravcomp(draft: Draft) -> None:
    for number, node in draft.of("body"):
        if draft.model.body_gravcomp[number]:
            draft.lose("gravcomp", node, "all of their weight pulls", what="`gravcomp`")


def _listed(names: Collection[str]) -> str:
    return ", ".join(f"`{each}`" if " " not in each else each for each in dict.fromkeys(names))


COMPUTING = Limit("computing", FeatureOutcome.LEFT_OUT, _options)
GRAVITY = Limit("gravity", FeatureOutcome.LEFT_OUT, _gravity)
BITS = Limit("bits", FeatureOutcome.LEFT_OUT, _bits)
SOFTNESS = Limit("softness", FeatureOutcome.LEFT_OUT, _soft_limits)
GRAVCOMP = Limit("gravcomp", FeatureOutcome.LEFT_OUT, _gravcomp)
