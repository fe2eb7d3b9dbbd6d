"""The arrays of `mjModel` that may differ if an MJCF attribute is changed on purpose."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from composer.compiled.attributes import TAGS, array_of, attributes
from composer.compiled.fields import RULES, Treatment
from composer.compiled.kinds import KINDS

DERIVED = {
    *(array for array, rule in RULES.items() if rule.treatment in (Treatment.DERIVED, Treatment.GAIN)),
    *"actuator_acc0 actuator_length0 tendon_length0 tendon_lengthspring".split(),
}
"""Arrays that follow from nearly everything: they differ if anything else does."""

_INERTIA = "mass inertia ipos iquat subtreemass sameframe pos quat rbound aabb"
_GAINS = "gainprm gaintype biasprm biastype dynprm dyntype actnum ctrlrange ctrllimited"
_SHAPE = f"size type dataid {_INERTIA}"
_MESH = f"{_SHAPE} scale vert normal face facenormal extrema graph polynormal polyvert polyvertnum polymap polymapnum"
# Attributes with another name than their arrays: the suffixes of the arrays' names.
_BECOMES = {
    **dict.fromkeys("mass density diaginertia fullinertia shellinertia".split(), _INERTIA),
    **dict.fromkeys("pos quat euler axisangle xyaxes zaxis".split(), _INERTIA),
    **dict.fromkeys("size fromto type mesh".split(), _SHAPE),
    **dict.fromkeys("inertia vertex refpos refquat maxhullvert".split(), _MESH),
    "scale": f"{_MESH} {_GAINS}",
    **dict.fromkeys(
        "kp kv ki dampratio timeconst diameter area bias force lmin lmax vmax fpmax fvmax inheritrange gainprm"
        " biasprm dynprm gaintype biastype dyntype ctrlrange".split(),
        _GAINS,
    ),
    **dict.fromkeys("limited range".split(), "range limited lengthrange"),
    **dict.fromkeys("ref springref".split(), "qpos0 qpos_spring spring"),
    **dict.fromkeys("stiffness springdamper".split(), "stiffness stiffnesspoly"),
    **dict.fromkeys("anchor relpose torquescale polycoef".split(), "data"),
    **dict.fromkeys("actuatorfrcrange actuatorfrclimited".split(), "actfrcrange actfrclimited"),
    **dict.fromkeys("solreflimit solreffriction".split(), "solref"),
    **dict.fromkeys("solimplimit solimpfriction".split(), "solimp"),
    **dict.fromkeys("fluidshape fluidcoef".split(), "fluid"),
    **dict.fromkeys("focal principal sensorsize".split(), "intrinsic fovy sensorsize"),
    "damping": "damping dampingpoly",
    "active": "active0",
    "condim": "condim dim",
    "actuatorgravcomp": "actgravcomp",
    "forcerange": "forcerange forcelimited",
    "actrange": "actrange actlimited",
    "material": "matid rgba",
    "target": "targetbodyid mode",
    "texture": "texid",
}
# The kind of a tag's elements, if it is another word.
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
# Kinds that are affected too: a mesh shapes geoms, geoms give a body its inertia.
_BEYOND = {"joint": ["dof"], "geom": ["body"], "mesh": ["geom", "body"], "inertial": ["body"]}


@cache
def arrays_of(attribute: str, tag: str | None = None) -> frozenset[str]:
    """Return the arrays that follow from an attribute of an element, or without `tag` the suffixes of their names.

    Arrays computed from the inertia of the whole model, or from a gain, are included, because they follow from
    everything. The array with the attribute itself is always included.

    >>> sorted(arrays_of("friction", "geom") - arrays_of("friction"))
    ['body_friction', 'geom_friction']
    """
    ends = _BECOMES.get(attribute, attribute).split()
    if tag is None:
        return frozenset(
            {*ends, *DERIVED, *(array.partition("_")[2] or array for array in _own(attribute, TAGS))}
        )
    kind = _KINDS.get(tag, tag)
    starts = [KINDS[kind].arrays if kind in KINDS else kind, *_BEYOND.get(kind, [])]
    following = {end if end.startswith("qpos") else f"{start}_{end}" for start in starts for end in ends}
    return frozenset(following | DERIVED | _own(attribute, (kind,)))


def _own(attribute: str, kinds: Iterable[str]) -> set[str]:
    """Return the arrays with the value itself; for some kinds they have special names: `tendon_solref_lim`."""
    return {array_of(kind, attribute) for kind in kinds if kind in TAGS and attribute in attributes(kind)}
