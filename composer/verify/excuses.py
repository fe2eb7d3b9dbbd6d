"""From an attribute of MJCF to the arrays of `mjModel` that may differ where it was changed on purpose."""

from __future__ import annotations

from composer.verify.fields import RULES, Treatment
from composer.verify.roster import KINDS

_DERIVED = frozenset(
    array for array, rule in RULES.items() if rule.treatment in (Treatment.DERIVED, Treatment.GAIN)
)
_INERTIA = "mass inertia ipos iquat subtreemass sameframe invweight0 pos quat rbound aabb"
_GAINS = "gainprm gaintype biasprm biastype dynprm dyntype actnum"
_POSE = "pos quat sameframe"
# What attributes become that are not called as their arrays are.
_BECOMES = {
    **dict.fromkeys(("mass", "density", "inertia", "diaginertia", "fullinertia", "shellinertia"), _INERTIA),
    **dict.fromkeys(
        ("kp", "kv", "ki", "dampratio", "timeconst", "diameter", "area", "bias", "force", "scale", "lmin",
         "lmax", "vmax", "fpmax", "fvmax", "inheritrange", "gainprm", "biasprm", "dynprm", "gaintype",
         "biastype", "dyntype"),
        f"{_GAINS} ctrlrange ctrllimited",
    ),
    **dict.fromkeys(("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis"), _POSE),
    **dict.fromkeys(("size", "fromto", "type", "mesh"), f"size type rbound aabb dataid {_POSE} {_INERTIA}"),
    **dict.fromkeys(("range", "limited"), "range limited lengthrange"),
    **dict.fromkeys(("ref", "springref"), "qpos0 qpos_spring"),
    **dict.fromkeys(("stiffness", "springdamper"), "stiffness stiffnesspoly damping lengthspring"),
    "springlength": "lengthspring",
    "damping": "damping dampingpoly",
    "actuatorfrcrange": "actfrcrange actfrclimited",
    "actuatorfrclimited": "actfrcrange actfrclimited",
    "actuatorgravcomp": "actgravcomp",
    "ctrlrange": "ctrlrange ctrllimited biasprm gainprm",
    "forcerange": "forcerange forcelimited",
    "actrange": "actrange actlimited",
    "material": "matid rgba",
    "solreflimit": "solref",
    "solimplimit": "solimp",
    "solreffriction": "solref",
    "solimpfriction": "solimp",
    "fluidshape": "fluid",
    "fluidcoef": "fluid",
    "dir": "dir quat",
    "target": "targetbodyid mode",
    "mode": "mode",
    "focal": "intrinsic fovy sensorsize",
    "principal": "intrinsic",
    "sensorsize": "sensorsize intrinsic fovy",
    "texture": "texid",
    "gravcomp": "gravcomp",
}  # fmt: skip
# The kind of the elements of a tag, where it is another word.
_KINDS = {
    "freejoint": "joint",
    **dict.fromkeys(("fixed", "spatial"), "tendon"),
    **dict.fromkeys(
        ("connect", "weld", "flex", "flexvert", "flexstrain"), "equality"
    ),
    **dict.fromkeys(
        "general motor position velocity intvelocity damper cylinder muscle adhesion plugin dcmotor pid"
        " orientation".split(),
        "actuator",
    ),
}  # fmt: skip
_BEYOND = {"joint": ("dof",), "geom": ("body",), "inertial": ("body",)}


def arrays_of(attribute: str, tag: str | None = None) -> frozenset[str]:
    """The arrays, or ends of their names without `tag`, that follow from an attribute of its elements.

    What is computed from the inertia of everything, or from a gain, is among them: it follows from all.

    >>> sorted(arrays_of("friction", "geom") - arrays_of("friction"))
    ['body_friction', 'geom_friction']
    """
    ends = _BECOMES.get(attribute, attribute).split()
    if tag is None:
        return frozenset(ends) | _DERIVED
    kind = _KINDS.get(tag, tag)
    starts = [KINDS[kind].arrays if kind in KINDS else kind, *_BEYOND.get(kind, ())]
    return (
        frozenset(end if end.startswith("qpos") else f"{start}_{end}" for start in starts for end in ends)
        | _DERIVED
    )
