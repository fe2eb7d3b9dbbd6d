"""The array of `mjModel` for each attribute of MJCF, for numbers and words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from composer.compiled.enums import ENUMS
from composer.compiled.kinds import KINDS

_CONTACT = "friction solref solimp margin gap"
_RANGES = "ctrlrange forcerange actrange ctrllimited forcelimited actlimited lengthrange"
_LAMP = "ambient diffuse specular attenuation intensity"
_SHAPE = "pos quat size rgba group user"

# By tag: the attributes with the name of their array, and the others.
_TABLE: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "body": ("pos quat mass gravcomp user", {"diaginertia": "body_inertia"}),
    "joint": (
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
    "geom": (f"{_SHAPE} {_CONTACT} condim contype conaffinity priority solmix", {}),
    "site": (_SHAPE, {}),
    "camera": ("pos quat fovy ipd resolution user", {}),
    "light": (
        f"{_LAMP} pos dir cutoff exponent castshadow active bulbradius range",
        {},
    ),
    "material": (
        "rgba emission specular shininess reflectance metallic roughness texrepeat texuniform",
        {},
    ),
    "pair": (f"{_CONTACT} solreffriction", {"condim": "pair_dim"}),
    "equality": ("solref solimp", {"active": "eq_active0"}),
    "tendon": (
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
    "actuator": (f"{_RANGES} gear cranklength gainprm biasprm dynprm group user", {}),
    "sensor": ("cutoff noise user", {}),
    "key": ("time", {}),
}
TAGS = tuple(_TABLE)
ANGLES: Mapping[str, frozenset[str]] = {
    "hinge": frozenset({"range", "ref", "springref"}),
    "ball": frozenset({"range"}),
}
"""Attributes of joints that are angles, by the type of the joint."""


def attributes(tag: str) -> Iterator[str]:
    """Yield the attributes of a tag's elements that have an array."""
    plain, other = _TABLE[tag]
    yield from plain.split()
    yield from other


def array_of(tag: str, attribute: str) -> str:
    """Return the array of mjModel for an attribute.

    >>> array_of("joint", "range"), array_of("joint", "damping")
    ('jnt_range', 'dof_damping')
    """
    other = _TABLE[tag][1] if tag in _TABLE else {}
    return other.get(attribute, f"{KINDS[tag].arrays}_{attribute}")


_NOT_WRITTEN = frozenset({"actuator_trntype"})
ENUMERATED: Mapping[str, frozenset[str]] = {
    tag: frozenset(
        array.removeprefix(f"{kind.arrays}_")
        for array in ENUMS
        if array.startswith(f"{kind.arrays}_") and array not in _NOT_WRITTEN
    )
    for tag, kind in KINDS.items()
}
"""By tag, the attributes whose values are words (`type`, `mode`); `enums.words` has these for each `array_of`."""
