"""Limits of MJX and MuJoCo Warp."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.arrays import words
from mjcompose.targets.restrictions import NO_SOFT
from mjcompose.targets.target import OPTION, Draft, FeatureOutcome, Limit, UnsupportedElement

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Missing = tuple[str, str, Collection[str], str]
"""An array of the compiled model, its enumeration, those members that the simulator lacks, and the effect."""
Flagged = Callable[[Any, Any], Iterator[tuple[int, str]]]
"""Of MuJoCo and a model: the numbers of the elements that the simulator refuses, each with the reason."""


def refused_members(feature: str, kind: str, missing: Sequence[Missing], help: str) -> Limit:
    """Return a limit that refuses a model if an array has one of these enum members.

    A member that the running MuJoCo does not have is ignored.
    """

    def flagged(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
        for array, enum, names, why in missing:
            members = getattr(mujoco, enum).__members__
            lacking = [int(members[name]) for name in names if name in members]
            yield from ((number, why) for number in np.flatnonzero(np.isin(getattr(model, array), lacking)).tolist())

    return refused_elements(feature, kind, flagged, help=help)


def refused_elements(
    feature: str, kind: str, flagged: Flagged, help: str, outcome: FeatureOutcome = FeatureOutcome.SOME_REFUSED
) -> Limit:
    """Return a limit that refuses a model with an element that `flagged` finds."""

    def refuses(mujoco: Any, model: MjModel) -> Iterator[UnsupportedElement]:
        for number, why in flagged(mujoco, model):
            yield UnsupportedElement(kind, number, why, help=help)

    def apply(draft: Draft) -> None:
        option = next(draft.root.iterchildren(OPTION), draft.root)
        nodes = {0: option} if kind == OPTION else dict(draft.of(kind))
        for number, why in flagged(draft.mujoco, draft.model):
            if number in nodes:
                draft.lose(feature, nodes[number], why, outcome=FeatureOutcome.REFUSED, help=help)

    return Limit(feature, outcome, apply, refuses=refuses)


def refused_options(
    name: str, enums: Sequence[tuple[str, str, Collection[str]]], flags: Collection[str], together: Flagged
) -> Limit:
    """Return a limit that refuses a model with one of these values of an option, or one of these flags enabled.

    `together` finds values that are refused only in combination with something else; its numbers have no meaning.
    """

    def flagged(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
        for field, enum, names in enums:
            members = getattr(mujoco, enum).__members__
            value = int(getattr(model.opt, field))
            for word in names:
                if word in members and int(members[word]) == value:
                    yield 0, f"{name} has no {field} `{word.partition('_')[2].lower()}`"
        for flag in flags:
            if is_enabled(mujoco, model, flag):
                yield 0, f"{name} does not have the flag `{flag}`"
        yield from together(mujoco, model)

    return refused_elements("options", OPTION, flagged, help="write another one in the section `option` of the recipe")


def is_enabled(mujoco: Any, model: MjModel, flag: str) -> bool:
    """Whether a flag is on that is off by default; some versions of MuJoCo do not have it."""
    bit = getattr(mujoco.mjtEnableBit, f"mjENBL_{flag.upper()}", None)
    return bit is not None and bool(int(model.opt.enableflags) & int(bit))


def with_plugins(kind: str) -> Flagged:
    def flagged(_mujoco: object, model: MjModel) -> Iterator[tuple[int, str]]:
        for number in np.flatnonzero(getattr(model, f"{kind}_plugin") >= 0).tolist():
            yield number, f"a plugin computes this {kind}"

    return flagged


# From `_COLLISION_FUNC` of MJX 3.17.
_KNOWN = frozenset(
    tuple(pair.split("-"))
    for pair in (
        "plane-sphere plane-capsule plane-box plane-ellipsoid plane-cylinder plane-mesh hfield-sphere hfield-capsule"
        " hfield-box hfield-mesh sphere-sphere sphere-capsule sphere-cylinder sphere-ellipsoid sphere-box sphere-mesh"
        " capsule-capsule capsule-box capsule-ellipsoid capsule-cylinder capsule-mesh ellipsoid-ellipsoid"
        " ellipsoid-cylinder cylinder-cylinder box-box box-mesh mesh-mesh"
    ).split()
)


def _unknown_pairs(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    shapes = words(mujoco, "geom_type")
    reported = set()
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for first, second in chain(colliding(model), pairs):
        pair = sorted((first, second), key=lambda number: int(model.geom_type[number]))
        one, other = (shapes[int(model.geom_type[number])] for number in pair)
        if (one, other) not in _KNOWN and (pair[0], one, other) not in reported:
            reported.add((pair[0], one, other))
            yield pair[0], f"MJX cannot compute contacts of a {one} with a {other}"


def colliding(model: MjModel) -> Iterator[tuple[int, int]]:
    """Yield the pairs of geoms that may touch by MuJoCo's filters: bits, bodies, parents and excludes."""
    excluded = set(model.exclude_signature.tolist())
    welded = model.body_weldid.tolist()
    parents = model.body_parentid.tolist()
    bodies = model.geom_bodyid.tolist()
    bits = model.geom_contype.tolist()
    others = model.geom_conaffinity.tolist()
    for first in range(model.ngeom):
        for second in range(first + 1, model.ngeom):
            if not (bits[first] & others[second] or bits[second] & others[first]):
                continue
            one = bodies[first]
            other = bodies[second]
            roots = welded[one], welded[other]
            if roots[0] == roots[1] or (min(one, other) << 16) + max(one, other) in excluded:
                continue
            above = welded[parents[roots[0]]], welded[parents[roots[1]]]
            if all(roots) and (roots[0] == above[1] or roots[1] == above[0]):
                continue
            yield first, second


MJX_COLLISIONS = refused_elements(
    "collisions",
    "geom",
    _unknown_pairs,
    help="edit one of the two: `set: {type: capsule}`, or `set: {contype: 0, conaffinity: 0}`",
    outcome=FeatureOutcome.REFUSED,
)


_SENSORS = (
    "JOINTLIMITPOS",
    "JOINTLIMITVEL",
    "JOINTLIMITFRC",
    "TENDONLIMITPOS",
    "TENDONLIMITVEL",
    "TENDONLIMITFRC",
    "INSIDESITE",
    "GEOMDIST",
    "GEOMNORMAL",
    "GEOMFROMTO",
    "E_POTENTIAL",
    "E_KINETIC",
    "PLUGIN",
    "USER",
)
_OUT = "remove it with `edit`"
_NETFORCE = 3  # of `reduce`, in `sensor_intprm`

MJX_ACTUATORS = refused_members(
    "actuators",
    "actuator",
    (
        (
            "actuator_trntype",
            "mjtTrn",
            ("mjTRN_SLIDERCRANK", "mjTRN_BODY", "mjTRN_SO3"),
            "MJX has no such transmission",
        ),
        ("actuator_dyntype", "mjtDyn", ("mjDYN_DCMOTOR", "mjDYN_PID", "mjDYN_USER"), "MJX has no such dynamics"),
        (
            "actuator_gaintype",
            "mjtGain",
            ("mjGAIN_DCMOTOR", "mjGAIN_SO3", "mjGAIN_PID", "mjGAIN_USER"),
            "MJX has no such gain",
        ),
        ("actuator_biastype", "mjtBias", ("mjBIAS_DCMOTOR", "mjBIAS_SO3", "mjBIAS_USER"), "MJX has no such bias"),
    ),
    help=f"{_OUT}, or write a `motor` instead",
)
MJX_EQUALITY = refused_members(
    "equality",
    "equality",
    (
        (
            "eq_type",
            "mjtEq",
            ("mjEQ_FLEX", "mjEQ_FLEXVERT", "mjEQ_FLEXSTRAIN", "mjEQ_DISTANCE"),
            "MJX has no such constraint",
        ),
    ),
    help=_OUT,
)
MJX_SENSORS = refused_members(
    "sensors",
    "sensor",
    (("sensor_type", "mjtSensor", tuple(f"mjSENS_{name}" for name in _SENSORS), "MJX has no such sensor"),),
    help=_OUT,
)


def _medium(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    option = model.opt
    has_medium = option.density > 0 or option.viscosity > 0 or option.wind.any()
    if has_medium and option.integrator == int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST):
        yield 0, "MJX has no integrator `implicitfast` in a medium: with `density`, `viscosity` or `wind`"


MJX_OPTIONS = refused_options(
    "MJX",
    (("integrator", "mjtIntegrator", ("mjINT_IMPLICIT",)), ("solver", "mjtSolver", ("mjSOL_PGS",))),
    flags=("override", "energy", "fwdinv", "diagexact", "speculative"),
    together=_medium,
)


_NO_MARGIN = "MJX has no margin for contacts with meshes and height fields"


def _has_mesh(mujoco: Any, model: MjModel, geoms: tuple[int, int]) -> bool:
    shapes = words(mujoco, "geom_type")
    return any(shapes[int(model.geom_type[geom])] in ("mesh", "hfield") for geom in geoms)


def _margins(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield a geom with a margin from each pair that may touch and that has a mesh or a height field."""
    reported = set()
    for pair in colliding(model):
        geom = next((each for each in pair if model.geom_margin[each]), None)
        if geom is not None and geom not in reported and _has_mesh(mujoco, model, pair):
            reported.add(geom)
            yield geom, _NO_MARGIN


def _pair_margins(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for number, geoms in enumerate(pairs):
        if model.pair_margin[number] and _has_mesh(mujoco, model, geoms):
            yield number, _NO_MARGIN


MJX_PAIR_MARGINS = refused_elements("margins", "pair", _pair_margins, help="write `set: {margin: 0}`")
MJX_MARGINS = refused_elements("margins", "geom", _margins, help="write `set: {margin: 0}`")


def _contact_sensors(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield the contact sensors that MJX does not support: of sites, bodies or subtrees, and sums of forces."""
    kinds = mujoco.mjtObj
    contact = getattr(mujoco.mjtSensor, "mjSENS_CONTACT", None)
    for number in range(model.nsensor):
        if contact is None or int(model.sensor_type[number]) != int(contact):
            continue
        objects = {int(model.sensor_objtype[number]), int(model.sensor_reftype[number])}
        if int(kinds.mjOBJ_SITE) in objects:
            yield number, "MJX has no contact sensor of a site"
        elif objects & {int(kinds.mjOBJ_BODY), int(kinds.mjOBJ_XBODY)}:
            yield number, "MJX has no contact sensor of a body"
        elif int(model.sensor_intprm[number][1]) == _NETFORCE:
            yield number, "MJX has no contact sensor of the net force"


MJX_CONTACT_SENSORS = refused_elements(
    "contact sensors", "sensor", _contact_sensors, help="name geoms instead, with another `reduce`"
)


def _flexes_mjx(_mujoco: object, model: MjModel) -> Iterator[tuple[int, str]]:
    return ((number, "MJX has no flexes") for number in range(model.nflex))


MJX_SOFT = replace(NO_SOFT, refuses=refused_elements("soft", "flex", _flexes_mjx, help=_OUT).refuses)
"""The files for MJX are without them; a compiled model that has one is refused."""


_DENSE_DOFS = 60
_AXES = np.eye(3)

WARP_ACTUATORS = refused_members(
    "actuators",
    "actuator",
    (
        ("actuator_trntype", "mjtTrn", ("mjTRN_SO3",), "MuJoCo Warp has no such transmission"),
        ("actuator_dyntype", "mjtDyn", ("mjDYN_PID",), "MuJoCo Warp has no such dynamics"),
        ("actuator_gaintype", "mjtGain", ("mjGAIN_PID",), "MuJoCo Warp has no such gain"),
        ("actuator_biastype", "mjtBias", ("mjBIAS_SO3",), "MuJoCo Warp has no such bias"),
    ),
    help="write a `motor` or a `position` instead: `convert: {to: position}`",
)
WARP_EQUALITY = refused_members(
    "equality",
    "equality",
    (("eq_type", "mjtEq", ("mjEQ_FLEXVERT", "mjEQ_DISTANCE"), "MuJoCo Warp has no such constraint"),),
    help=_OUT,
)


def _options(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield options that MuJoCo Warp refuses in combination with other options."""
    option = model.opt
    sleeps = is_enabled(mujoco, model, "sleep")
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    if option.noslip_iterations > 0 and discrete is not None and option.integrator == int(discrete):
        yield 0, "MuJoCo Warp has no `noslip_iterations` with the integrator `discrete`"
    if option.jacobian == int(mujoco.mjtJacobian.mjJAC_DENSE) and model.nv > _DENSE_DOFS:
        yield 0, f"MuJoCo Warp has no `jacobian` `dense` for more than {_DENSE_DOFS} degrees of freedom"
    if sleeps and option.solver != int(mujoco.mjtSolver.mjSOL_NEWTON):
        yield 0, "MuJoCo Warp has the flag `sleep` only with the solver `Newton`"
    if sleeps and (model.eq_type == int(mujoco.mjtEq.mjEQ_FLEX)).any():
        yield 0, "MuJoCo Warp has no flag `sleep` with equality constraints of flexes"


def _simple(mujoco: Any, model: MjModel, flex: int) -> bool:
    """Whether each vertex of a flex is in the world or on a body of its own, with the three slides of a flexcomp."""
    first = int(model.flex_vertadr[flex])
    for holder in set(model.flex_vertbodyid[first : first + int(model.flex_vertnum[flex])].tolist()):
        body = int(model.body_weldid[holder]) if holder >= 0 else 0
        if model.body_dofnum[body] == 0:
            continue
        joints = slice(int(model.body_jntadr[body]), int(model.body_jntadr[body] + model.body_jntnum[body]))
        slides = (model.jnt_type[joints] == int(mujoco.mjtJoint.mjJNT_SLIDE)).all()
        above = int(model.body_weldid[model.body_parentid[body]])
        if not (slides and model.body_dofnum[body] == len(_AXES) and model.body_dofnum[above] == 0):
            return False
        if not np.allclose(model.jnt_axis[joints], _AXES, atol=1e-15):
            return False
    return True


WARP_OPTIONS = refused_options(
    "MuJoCo Warp",
    (("solver", "mjtSolver", ("mjSOL_PGS",)),),
    flags=("override", "fwdinv", "diagexact", "ipc", "speculative"),
    together=_options,
)


WARP_PLUGINS = refused_elements("plugins", "body", with_plugins("body"), help=_OUT)
WARP_ACTUATOR_PLUGINS = refused_elements("actuators", "actuator", with_plugins("actuator"), help=_OUT)
WARP_SENSORS = refused_elements("sensors", "sensor", with_plugins("sensor"), help=_OUT)


def _sleepers(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield the bodies that set `sleep` themselves; otherwise the compiler chooses `auto_…`."""
    policies = getattr(mujoco, "mjtSleepPolicy", None)
    if policies is not None:
        for body, policy in zip(model.tree_bodyadr.tolist(), model.tree_sleep_policy.tolist(), strict=True):
            if policy in map(int, (policies.mjSLEEP_NEVER, policies.mjSLEEP_ALLOWED, policies.mjSLEEP_INIT)):
                yield body, "MuJoCo Warp does not have `sleep` of a body"


WARP_SLEEP = refused_elements(
    "sleep", "body", _sleepers, help="write `set: {sleep: null}`", outcome=FeatureOutcome.REFUSED
)


def _flexes_warp(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield the flexes that it refuses: quadratic and rigid flexes, and flexes with some kinds of contacts."""
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    newton = model.opt.solver == int(mujoco.mjtSolver.mjSOL_NEWTON) and hasattr(model, "flex_stiffnessadr")
    newton = newton and discrete is not None and model.opt.integrator == int(discrete)
    for flex in range(model.nflex):
        lacking = _lacking_for_flex(model, flex)
        is_simple = _of_flex(model, "interp", flex) != 0 or _simple(mujoco, model, flex)
        if lacking is None and newton and not is_simple and _is_elastic(model, flex):
            lacking = "elastic flex on moving bodies with `discrete` and the solver `Newton`"
        if lacking is not None:
            yield flex, f"MuJoCo Warp has no {lacking}"


def _lacking_for_flex(model: MjModel, flex: int) -> str | None:
    """Return the feature of a flex that MuJoCo Warp lacks with every solver, or None."""
    interpolated = _of_flex(model, "interp", flex)
    if abs(interpolated) == 2:
        return "flexes of quadratic elements"
    if _of_flex(model, "rigid", flex):
        return "rigid flexes"
    if _of_flex(model, "internal", flex):
        return "contacts inside a flex: `internal`"
    if not interpolated:
        return None
    if model.flex_selfcollide[flex] and model.flex_contype[flex] & model.flex_conaffinity[flex]:
        return "contacts of an interpolated flex with itself: `selfcollide`"
    if _of_flex(model, "passive", flex) and model.flex_dim[flex] >= 2:
        return "passive contacts of an interpolated flex: `passive`"
    return None


def _of_flex(model: MjModel, name: str, flex: int) -> int:
    """Return a number of a flex, 0 if this MuJoCo does not have it."""
    numbers = getattr(model, f"flex_{name}", None)
    return 0 if numbers is None else int(numbers[flex])


def _is_elastic(model: MjModel, flex: int) -> bool:
    """Return whether a flex resists bending or stretching."""
    if model.flex_bendingadr[flex] >= 0:
        return True
    first = int(model.flex_stiffnessadr[flex])
    return bool(model.flex_dim[flex] > 1 and first >= 0 and model.flex_stiffness[first] != 0)


def _beside_flexes(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """Yield the shapes that MuJoCo Warp refuses in a model with flexes, even if they touch none."""
    if model.nflex:
        for word in ("sdf", "hfield"):
            shape = int(getattr(mujoco.mjtGeom, f"mjGEOM_{word.upper()}"))
            for number in np.flatnonzero(model.geom_type == shape).tolist():
                yield number, f"MuJoCo Warp has no `{word}` in a model with flexes"


def _velocities(mujoco: Any, model: MjModel) -> Iterator[tuple[int, str]]:
    """The contact sensors with `linvel` or `angvel` in a model with flexes."""
    fields = getattr(mujoco, "mjtConDataField", None)
    if fields is None or not model.nflex:
        return
    bits = 1 << int(fields.mjCONDATA_LINVEL) | 1 << int(fields.mjCONDATA_ANGVEL)
    contact = int(mujoco.mjtSensor.mjSENS_CONTACT)
    for number in np.flatnonzero(model.sensor_type == contact).tolist():
        if int(model.sensor_intprm[number][0]) & bits:
            yield number, "MuJoCo Warp has no `linvel` and `angvel` of contacts in a model with flexes"


WARP_FLEXES = refused_elements("soft", "flex", _flexes_warp, help=_OUT)
WARP_BESIDE_FLEXES = refused_elements("soft", "geom", _beside_flexes, help=_OUT)
WARP_VELOCITIES = refused_elements(
    "contact sensors", "sensor", _velocities, help="remove `linvel` and `angvel` from its `data`"
)
