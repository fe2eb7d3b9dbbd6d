"""Limits of MJX: what `put_model` of MJX 3.17 refuses, except for pairs of shapes (`collisions.py`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from composer.compiled.enums import words
from composer.targets.restrictions.collisions import colliding
from composer.targets.restrictions.compiled import refused_elements, refused_members, refused_options
from composer.targets.restrictions.unread import NO_SOFT

_SENSORS = (
    "JOINTLIMITPOS", "JOINTLIMITVEL", "JOINTLIMITFRC", "TENDONLIMITPOS", "TENDONLIMITVEL", "TENDONLIMITFRC",
    "INSIDESITE", "GEOMDIST", "GEOMNORMAL", "GEOMFROMTO", "E_POTENTIAL", "E_KINETIC", "PLUGIN", "USER",
)  # fmt: skip
_ACTUATORS = "leave it out with `edit`, or write a `motor` in its place"
_NETFORCE = 3  # of `reduce`, in `sensor_intprm`

MJX_ACTUATORS = refused_members(
    "actuators", "actuator",
    (
        ("actuator_trntype", "mjtTrn", ("mjTRN_SLIDERCRANK", "mjTRN_BODY", "mjTRN_SO3"),
         "MJX has no such transmission"),
        ("actuator_dyntype", "mjtDyn", ("mjDYN_DCMOTOR", "mjDYN_PID", "mjDYN_USER"), "MJX has no such dynamics"),
        ("actuator_gaintype", "mjtGain", ("mjGAIN_DCMOTOR", "mjGAIN_SO3", "mjGAIN_PID", "mjGAIN_USER"),
         "MJX has no such gain"),
        ("actuator_biastype", "mjtBias", ("mjBIAS_DCMOTOR", "mjBIAS_SO3", "mjBIAS_USER"), "MJX has no such bias"),
    ),
    help=_ACTUATORS,
)  # fmt: skip
MJX_EQUALITY = refused_members(
    "equality", "equality",
    (("eq_type", "mjtEq", ("mjEQ_FLEX", "mjEQ_FLEXVERT", "mjEQ_FLEXSTRAIN", "mjEQ_DISTANCE"),
      "MJX has no such constraint"),),
    help="leave it out with `edit`",
)  # fmt: skip
MJX_SENSORS = refused_members(
    "sensors", "sensor",
    (("sensor_type", "mjtSensor", tuple(f"mjSENS_{name}" for name in _SENSORS), "MJX has no such sensor"),),
    help="leave it out with `edit`",
)  # fmt: skip


def _medium(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """`implicitfast`, where a medium brakes."""
    option = model.opt
    if option.integrator == int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST) and (
        option.density > 0 or option.viscosity > 0 or option.wind.any()
    ):
        yield 0, "MJX has no integrator `implicitfast` in a medium: with `density`, `viscosity` or `wind`"


MJX_OPTIONS = refused_options(
    "options",
    "MJX",
    (("integrator", "mjtIntegrator", ("mjINT_IMPLICIT",)), ("solver", "mjtSolver", ("mjSOL_PGS",))),
    flags=("override", "energy", "fwdinv", "diagexact", "speculative"),
    help="write another one in the section `option` of the recipe",
    together=_medium,
)


def _margins(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield a geom with a margin from each pair that may touch and that has a mesh or a height field."""
    shapes = words(mujoco, "geom_type")
    reported = set()
    for pair in colliding(model):
        kinds = {shapes[int(model.geom_type[geom])] for geom in pair}
        if kinds & {"mesh", "hfield"} and any(model.geom_margin[geom] for geom in pair):
            geom = next(each for each in pair if model.geom_margin[each])
            if geom not in reported:
                reported.add(geom)
                yield geom, "MJX has no margin for contacts with meshes and height fields"


def _pair_margins(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the contact pairs with a margin and a mesh or a height field."""
    shapes = words(mujoco, "geom_type")
    for pair in range(model.npair):
        geoms = int(model.pair_geom1[pair]), int(model.pair_geom2[pair])
        if model.pair_margin[pair] and {shapes[int(model.geom_type[each])] for each in geoms} & {
            "mesh",
            "hfield",
        }:
            yield pair, "MJX has no margin for contacts with meshes and height fields"


MJX_PAIR_MARGINS = refused_elements("margins", "pair", _pair_margins, help="write `set: {margin: 0}`")
MJX_MARGINS = refused_elements("margins", "geom", _margins, help="write `set: {margin: 0}`")


def _contact_sensors(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the contact sensors that MJX does not support: of a site, a body or a subtree, and sums of forces."""
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
    "contact sensors", "sensor", _contact_sensors, help="name geoms in its place, with another `reduce`"
)


def _flexes(_mujoco: object, model: Any) -> Iterator[tuple[int, str]]:
    for number in range(model.nflex):
        yield number, "MJX has no flexes"


MJX_SOFT = replace(
    NO_SOFT, refuses=refused_elements("soft", "flex", _flexes, help="leave it out with `edit`").refuses
)
"""What is written for MJX is without them; a model that still has one is refused."""
