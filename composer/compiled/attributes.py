"""Where a compiled model keeps the attributes of MJCF whose values can be asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

_CONTACT = "friction solref solimp margin gap"
_RANGES = "ctrlrange forcerange actrange ctrllimited forcelimited actlimited lengthrange"
_SHAPE = "pos quat size rgba group user"

# By tag: what the arrays start with, the attributes that are called as their arrays are, and those that are not.
_TABLE: Mapping[str, tuple[str, str, Mapping[str, str]]] = {
    "body": ("body", "pos quat mass gravcomp user", {"diaginertia": "body_inertia"}),
    "joint": (
        "jnt",
        "axis pos range limited stiffness margin group user",
        {
            **{name: f"dof_{name}" for name in ("armature", "damping", "frictionloss")},
            "ref": "qpos0",
            "springref": "qpos_spring",
            "solreflimit": "jnt_solref",
            "solimplimit": "jnt_solimp",
            "solreffriction": "dof_solref",
            "solimpfriction": "dof_solimp",
            "actuatorfrcrange": "jnt_actfrcrange",
            "actuatorfrclimited": "jnt_actfrclimited",
            "actuatorgravcomp": "jnt_actgravcomp",
        },
    ),
    "geom": ("geom", f"{_SHAPE} {_CONTACT} condim contype conaffinity priority solmix", {}),
    "site": ("site", _SHAPE, {}),
    "camera": ("cam", "pos quat fovy ipd resolution user", {}),
    "light": (
        "light",
        "pos dir ambient diffuse specular attenuation cutoff exponent castshadow active bulbradius intensity range",
        {},
    ),
    "material": (
        "mat",
        "rgba emission specular shininess reflectance metallic roughness texrepeat texuniform",
        {},
    ),
    "pair": ("pair", f"{_CONTACT} solreffriction", {"condim": "pair_dim"}),
    "equality": ("eq", "solref solimp", {"active": "eq_active0"}),
    "tendon": (
        "tendon",
        "range limited stiffness damping armature frictionloss margin width rgba group user",
        {
            "springlength": "tendon_lengthspring",
            "solreflimit": "tendon_solref_lim",
            "solimplimit": "tendon_solimp_lim",
            "solreffriction": "tendon_solref_fri",
            "solimpfriction": "tendon_solimp_fri",
            "actuatorfrcrange": "tendon_actfrcrange",
            "actuatorfrclimited": "tendon_actfrclimited",
        },
    ),
    "actuator": ("actuator", f"{_RANGES} gear cranklength gainprm biasprm dynprm group user", {}),
    "sensor": ("sensor", "cutoff noise user", {}),
    "key": ("key", "time", {}),
}
TAGS = tuple(_TABLE)
ANGLES: Mapping[str, frozenset[str]] = {
    "hinge": frozenset({"range", "ref", "springref"}),
    "ball": frozenset({"range"}),
}
"""Attributes of joints that are angles, by the type of the joint."""


def attributes(tag: str) -> Iterator[str]:
    """The attributes of a tag's elements that can be asked for."""
    _, plain, other = _TABLE[tag]
    yield from plain.split()
    yield from other


def array_of(tag: str, attribute: str) -> str:
    """The array of mjModel that has the attribute.

    >>> array_of("joint", "range"), array_of("joint", "damping")
    ('jnt_range', 'dof_damping')
    """
    start, _, other = _TABLE[tag]
    return other.get(attribute, f"{start}_{attribute}")
