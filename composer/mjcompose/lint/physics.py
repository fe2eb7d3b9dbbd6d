"""Rules about masses, inertias, gains and damping."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mjcompose.base.files import URDF_FILES
from mjcompose.lint.rule import Finding, Found, Subject, rule
from mjcompose.mujoco.arrays import HINGE, SLIDE
from mjcompose.tree.classes import class_in_force
from mjcompose.tree.values import parse_real

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.mujoco.model_types import MjData
    from mjcompose.mujoco.servos import Servos
    from mjcompose.mujoco.solids import Shapes

_HEAVIEST = 22_590.0
"""The density of osmium, in kg/m³."""
_DENSE = 100_000.0
"""A density that is too high even for a geom that is too small, in kg/m³."""
_MARKER = 1e-6
"""The volume (m³) of a geom that only marks a place."""
_BOXES = 0.1
"""A mesh fills more of its box than this."""
_GYRATION = 1.5
_OUTSIDE = 1.0
_SMALL = 0.005
_MUCH = 1.02
_NEGLIGIBLE = 1e-6
_MASS = "NVIDIA SimReady, RB.007 “Rigid Body Mass”: {}"
_UNITS = _MASS.format("“all units must be consistent with the stage’s unit system”")
_DRIVE = "NVIDIA SimReady, DJ.006 “drive-joint-value-reasonable”: {}"
_RESISTING = ("damping", "armature", "frictionloss", "stiffness")
_SECONDS = 1.0


@rule(
    "inertia-implausible",
    "A mass or inertia that the shapes of the body cannot have",
    in_mujoco=True,
    profiles={"robot-asset": _UNITS},
)
def inertia_implausible(subject: Subject) -> Found:
    from mjcompose.mujoco.solids import faults

    shapes = subject.shapes
    for body in range(1, subject.model.nbody):
        if not _is_worth_a_look(shapes, body):
            continue
        inertial = _inertial(subject, body)
        place = subject.node("body", body) if inertial is None else inertial
        for fault in faults(shapes, body, gyration=_GYRATION, outside=_OUTSIDE):
            help = "correct `<inertial>`, or remove it to compute the inertia from the geoms"
            yield Finding(place, f"{subject.name('body', body)}: {fault}", help=help)


def _is_worth_a_look(shapes: Shapes, body: int) -> bool:
    """Return whether a body has geoms that are not tiny, and a share in the mass of its tree."""
    model = shapes.model
    whole = model.body_subtreemass[model.body_rootid[body]]
    geoms = shapes.welded(body)
    if geoms is None or not shapes.own(body) or model.body_mass[body] <= _NEGLIGIBLE * whole:
        return False
    return geoms.reaches(shapes.data.xipos[body], _SMALL)


def _inertial(subject: Subject, body: int) -> Node | None:
    node = subject.node("body", body)
    return None if node is None else node.find("inertial")


@rule("density-impossible", "A body that is denser than any metal", in_mujoco=True, profiles={"robot-asset": _UNITS})
def density_impossible(subject: Subject) -> Found:
    for body in range(1, subject.model.nbody):
        mass = float(subject.model.body_mass[body])
        geoms = subject.shapes.welded(body)
        if geoms is None or mass <= _DENSE * _BOXES * geoms.volume_of_boxes:
            continue
        most = geoms.volume.most
        if most > _MARKER and mass / most > _DENSE:
            density = f"{mass / most:,.0f} kg/m³; the densest metal has {_HEAVIEST:,.0f} kg/m³"
            name = subject.name("body", body)
            message = f"{name} weighs {mass:.4g} kg in {most * 1e6:.4g} cm³, which is {density}"
            yield Finding(subject.node("body", body), message, help="write the mass in kilograms")


@rule(
    "inertial-missing",
    "A moving body whose mass nobody wrote",
    usual=False,
    profiles={
        "robot-asset": _MASS.format("“mass & their other inertial properties explicitly specified”"),
    },
)
def inertial_missing(subject: Subject) -> Found:
    for body in subject.each("body"):
        geoms = list(body.iterchildren("geom"))
        joints = list(body.iterchildren("joint", "freejoint"))
        is_given = any(subject.given(geom, name) is not None for geom in geoms for name in ("mass", "density"))
        if joints and geoms and not is_given and body.find("inertial") is None:
            message = f"{subject.called(body)} has no `<inertial>`, and none of its geoms has a `mass` or `density`"
            yield Finding(body, message, help="add `<inertial>`, or `mass` to a geom")


@rule("mass-guessed", "A moving link of a URDF whose mass is guessed from its shapes")
def mass_guessed(subject: Subject) -> Found:
    unit = subject.unit
    for body in subject.each("body"):
        if unit is None or not unit.origins.span(body, unit.file).file.endswith(URDF_FILES):
            continue
        weighed = ("mass", "density")
        guessed = [geom for geom in body.iter("geom") if all(subject.given(geom, name) is None for name in weighed)]
        own = [geom for geom in guessed if next(geom.iterancestors("body"), None) is body]
        if own and body.find("inertial") is None and _moves(body):
            message = f"the link `{body.get('name')}` has no `<inertial>`: its shapes weigh 1000 kg/m³"
            yield Finding(body, message, help="write its `<inertial>`")


def _moves(body: Node) -> bool:
    """Return whether a body, or a body that holds it, has a joint."""
    return any(
        each.find("joint") is not None or each.find("freejoint") is not None
        for each in (body, *body.iterancestors("body"))
    )


@rule("inertial-ignored", "An `<inertial>` that MuJoCo ignores", in_mujoco=True)
def inertial_ignored(subject: Subject) -> Found:
    if subject.setting("compiler", "inertiafromgeom") != "true":
        return
    for body in range(1, subject.model.nbody):
        inertial = _inertial(subject, body)
        written = None if inertial is None else parse_real(str(inertial.get("mass") or "").strip())
        mass = float(subject.model.body_mass[body])
        if written is not None and abs(written - mass) > 1e-3 * max(written, mass):
            message = f"MuJoCo ignores this `mass` of {written:g} kg: it computes {mass:.4g} kg from the geoms"
            yield Finding(inertial, message, "mass", help='remove `inertiafromgeom="true"`, or `<inertial>`')


@rule("inertia-balanced", "An inertia that no rigid body can have, which MuJoCo replaces silently")
def inertia_balanced(subject: Subject) -> Found:
    import numpy as np

    balances, by_geoms = (subject.setting("compiler", name) for name in ("balanceinertia", "inertiafromgeom"))
    if balances != "true" or by_geoms == "true":
        return
    for element in subject.each("inertial"):
        full = subject.numbers(element, "fullinertia")
        name = "fullinertia"
        moments = subject.numbers(element, "diaginertia")
        if full is not None and len(full) == 6:
            a, b, c, ab, ac, bc = full
            moments = np.linalg.eigvalsh(np.array([[a, ab, ac], [ab, b, bc], [ac, bc, c]])).tolist()
        elif moments is not None:
            name = "diaginertia"
        low, middle, high = sorted(moments) if moments is not None and len(moments) == 3 else (0.0, 0.0, 0.0)
        if low + middle < high * (1 - 1e-6):
            times = f"{high / (low + middle):.3g} times the sum of the others"
            mean = (low + middle + high) / 3
            three = f"the principal moments {low:.4g}, {middle:.4g} and {high:.4g} kg·m²"
            message = f"a body cannot have {three}: the largest is {times}, so MuJoCo replaces all three by {mean:.4g}"
            yield Finding(element, message, name, help="write the inertia of the CAD model")


@rule("free-joint-damped", "A free joint with the damping, armature, friction or stiffness of hinges")
def free_joint_damped(subject: Subject) -> Found:
    free = []
    others = set()
    for joint in subject.each("joint"):
        own = subject.classes.get(class_in_force(joint).name)
        found = {name: own.lookup("joint", name) for name in _RESISTING if joint.get(name) is None}
        values = {name: each for name, each in found.items() if each is not None and parse_real(each[0].strip())}
        if subject.value(joint, "type") == "free":
            free.append((joint, values))
        else:
            others |= {(name, writer) for name, (_, writer) in values.items()}
    for joint, values in free:
        shared = [f"`{name}` {value}" for name, (value, writer) in values.items() if (name, writer) in others]
        if shared:
            resists = " and ".join(shared)
            message = f"the free {subject.called(joint)} has {resists} of its default class, as hinges have"
            yield Finding(joint, message, help="write `<freejoint/>`, which ignores the classes")


@rule(
    "timestep-too-long",
    "A servo or spring that is too stiff for the time step",
    in_mujoco=True,
    profiles={
        "robot-asset": _DRIVE.format("“within reasonable ranges for stable simulation”"),
    },
)
def timestep_too_long(subject: Subject) -> Found:
    servos = subject.servos
    for mode in servos.unstable():
        joint = int(subject.model.dof_jntid[mode.dof])
        actuators = servos.of_dof(mode.dof)
        node = subject.node("actuator", actuators[0]) if actuators else None
        by = f" with {subject.name('actuator', actuators[0])}" if actuators else ""
        longest = "" if mode.timestep is None else f"; up to {mode.timestep * 1000:.2g} ms it does not"
        each = f"each step of {subject.model.opt.timestep * 1000:g} ms{longest}"
        message = f"{subject.name('joint', joint)}{by}: small motions grow {mode.factor:.3g} times in {each}"
        place = node if node is not None else subject.node("joint", joint)
        yield Finding(place, message, help="shorten `timestep`, add `armature` to the joint, or lower the gains")


def _single(subject: Subject) -> Iterator[tuple[int, int]]:
    """Yield the hinges and slides, each with its degree of freedom."""
    model = subject.model
    yield from ((joint, int(model.jnt_dofadr[joint])) for joint in (model.jnt_type >= SLIDE).nonzero()[0].tolist())


@rule(
    "servo-undamped",
    "A position servo that nothing damps",
    in_mujoco=True,
    profiles={
        "robot-asset": _DRIVE.format("“include sufficient damping for stability”"),
    },
)
def servo_undamped(subject: Subject) -> Found:
    model = subject.model
    servos = subject.servos
    for joint, dof in _single(subject):
        stiff = [each for each in servos.of_dof(dof) if servos.gains(each)[0] > 0]
        own = slice(dof, dof + 1)
        damping = model.dof_damping[dof].ravel()[0] + servos.damping(own).item()
        if stiff and damping == 0 and model.dof_frictionloss[dof] == 0:
            stiffness = f"{servos.stiffness(own).item():.4g} {_unit(subject, joint)}"
            held = f"it holds {subject.name('joint', joint)} with {stiffness}, without damping or friction"
            message = f"nothing damps {subject.name('actuator', stiff[0])}: {held}"
            yield Finding(subject.node("actuator", stiff[0]), message, help='add `dampratio="1"`')


def _unit(subject: Subject, joint: int, per: bool = True) -> str:
    is_hinge = int(subject.model.jnt_type[joint]) == HINGE
    return ("N·m" if is_hinge else "N") + (("/rad" if is_hinge else "/m") if per else "")


@rule("friction-exceeds-motor", "A joint with more dry friction than its motors can overcome", in_mujoco=True)
def friction_exceeds_motor(subject: Subject) -> Found:
    servos = subject.servos
    for joint, dof in _single(subject):
        ends = servos.strongest(dof)
        friction = float(subject.model.dof_frictionloss[dof])
        if ends is not None and friction > 0 and max(abs(each) for each in ends) <= friction:
            unit = _unit(subject, joint, per=False)
            most = f"its actuators give at most {max(abs(each) for each in ends):.4g} {unit}"
            message = f"{subject.name('joint', joint)} has {friction:.4g} {unit} of dry friction, and {most}"
            yield Finding(subject.node("joint", joint), message, "frictionloss", help="lower `frictionloss`")


@rule("motor-too-weak", "A motor that cannot hold its joint against gravity in a keyframe", in_mujoco=True)
def motor_too_weak(subject: Subject) -> Found:
    from mjcompose.mujoco.servos import Servos

    seen: dict[int, Finding] = {}
    for _, name, data in subject.at_keys():
        servos = Servos(subject.mujoco, subject.model, data)
        if not data.qvel.any():
            for joint, dof, needed, ends in _held(subject, data, servos):
                unit = _unit(subject, joint, per=False)
                node = subject.node("actuator", servos.of_dof(dof)[0])
                given = f"its actuators give {ends[0]:.4g} to {ends[1]:.4g} {unit}"
                message = f"holding {subject.name('joint', joint)} in {name} takes {needed:.4g} {unit}, and {given}"
                seen.setdefault(joint, Finding(node, message, help="raise the limit of the force"))
    yield from seen.values()


def _held(subject: Subject, data: MjData, servos: Servos) -> Iterator[tuple[int, int, float, tuple[float, float]]]:
    """Yield joint, degree of freedom, necessary force and limits of each joint that its actuators cannot hold."""
    model = subject.model
    floating = set(model.dof_treeid[model.jnt_dofadr[model.jnt_type < SLIDE]].tolist())
    touching = {int(model.body_treeid[model.geom_bodyid[geom]]) for geom in data.contact.geom.ravel() if geom >= 0}
    for joint, dof in _single(subject):
        tree = int(model.dof_treeid[dof])
        at = float(data.qpos[model.jnt_qposadr[joint]])
        low, high = map(float, model.jnt_range[joint])
        is_at_end = model.jnt_limited[joint] and not low + 1e-2 < at < high - 1e-2
        if is_at_end or tree in floating | touching | servos.coupled:
            continue
        needed = float(data.qfrc_bias[dof] - data.qfrc_passive[dof])
        if model.jnt_actgravcomp[joint]:
            needed -= float(data.qfrc_gravcomp[dof])
        friction = float(model.dof_frictionloss[dof])
        ends = servos.strongest(dof)
        if ends is not None and not ends[0] * _MUCH - friction <= needed <= ends[1] * _MUCH + friction:
            yield joint, dof, needed, ends


@rule(
    "simulation-diverges",
    "A simulation that diverges within a second",
    in_mujoco=True,
    profiles={
        "menagerie": (
            "CONTRIBUTING.md, section “Unit Tests”: a test “simulates each robot for a fixed"
            " duration of time and"
            " checks that no simulation instabilities occur”"
        ),
    },
)
def simulation_diverges(subject: Subject) -> Found:
    from mjcompose.mujoco.controls import advance

    mujoco = subject.mujoco
    model = subject.model
    data = mujoco.MjData(model)
    has_key = model.nkey and (subject.node("key", 0) is not None or subject.roster.names["key"][0])
    if has_key:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    why = advance(mujoco, model, data, end=_SECONDS, begun=data.time) if model.nv and model.opt.timestep > 0 else None
    if why is not None:
        start = subject.name("key", 0) if has_key else "the reference configuration"
        yield Finding(subject.node("key", 0) if has_key else None, f"from {start}, the simulation is {why}")


@rule("armature-missing", "A joint with an actuator but without armature", in_mujoco=True, usual=False)
def armature_missing(subject: Subject) -> Found:
    servos = subject.servos
    for joint, dof in _single(subject):
        if servos.of_dof(dof) and subject.model.dof_armature[dof] == 0:
            message = f"{subject.name('joint', joint)} has an actuator, and no `armature`"
            yield Finding(subject.node("joint", joint), message, help="add `armature`: rotor inertia · ratio²")
