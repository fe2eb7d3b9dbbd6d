"""The arrays of `mjModel` for MJCF attributes; kinds, names, sizes and positions of a compiled model.

Everything is read from the arrays of the model object, so MuJoCo itself is never imported here.
"""

from __future__ import annotations

import ctypes
from collections.abc import Hashable, Iterable, Iterator, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.arrays import ENUMS, with_trait

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

"""A compiled ``mujoco.MjModel``; untyped, because only ``mjcompose.mujoco`` may import MuJoCo."""


class ElementKind(Struct):
    """One kind of element: its word in messages, the prefix of its arrays, and its value of `mjtObj`."""

    word: str
    arrays: str
    object_type: int

    @property
    def addresses(self) -> str:
        """The array with the addresses of the names; its length is the number of elements in every version."""
        return f"name_{self.arrays}adr"

    @property
    def size(self) -> str:
        """The size of `mjModel` for the number of elements; MuJoCo 3 has no `nactuator`, which would equal `nu`."""
        return f"n{self.arrays}"


KINDS: dict[str, ElementKind] = {
    word: ElementKind(word, arrays, object_type)
    for word, arrays, object_type in (
        ("body", "body", 1), ("joint", "jnt", 3), ("geom", "geom", 5), ("site", "site", 6), ("camera", "cam", 7),
        ("light", "light", 8), ("texture", "tex", 13), ("material", "mat", 14), ("mesh", "mesh", 10),
        ("hfield", "hfield", 12), ("skin", "skin", 11), ("flex", "flex", 9), ("tendon", "tendon", 18),
        ("equality", "eq", 17), ("pair", "pair", 15), ("exclude", "exclude", 16), ("actuator", "actuator", 19),
        ("sensor", "sensor", 20), ("numeric", "numeric", 21), ("text", "text", 22), ("tuple", "tuple", 23),
        ("plugin", "plugin", 25), ("key", "key", 24),
    )
}  # fmt: skip
"""Every kind of element that `mjModel` names, in the order in which models are compared."""

KIND_OF: dict[str, str] = {
    **{kind.arrays: word for word, kind in KINDS.items()},
    "dof": "joint",
    "qpos0": "joint",
    "qpos": "joint",
    "wrap": "tendon",
}
"""The kind of element that an array is about, by the word before the first underscore of its name."""

_XBODY = 2
OF_OBJECT_TYPE: dict[int, str] = {_XBODY: "body", **{kind.object_type: word for word, kind in KINDS.items()}}
"""The kind for each value of `mjtObj`; body and xbody are one kind."""

ON_BODIES: dict[str, str] = {
    kind: f"{KINDS[kind].arrays}_bodyid" for kind in ("joint", "geom", "site", "camera", "light")
}
"""The kinds of elements on bodies, and the arrays with their bodies."""

HOLDERS: dict[str, str] = {"body": "body_parentid", **ON_BODIES}
"""The same with bodies themselves, which are on their parents."""


def holder(model: MjModel, kind: str, index: int) -> int:
    """Return the body of an element of one of the `HOLDERS`; the body of the world is the world."""
    return int(getattr(model, HOLDERS[kind])[index])


def names(model: MjModel, kind: str) -> list[str]:
    """Return the names of a kind's elements by id, with `""` for unnamed elements; invalid UTF-8 is replaced."""
    starts = getattr(model, KINDS[kind].addresses)
    count = len(starts)
    if not count:
        return []
    text: bytes = model.names[int(starts[0]) :]  # the names of a kind follow one another, each with a zero at its end
    return text.decode("utf-8", "replace").split("\0", count)[:count]


def all_names(model: MjModel) -> dict[str, list[str]]:
    """Return the names of all elements by kind."""
    return {kind: names(model, kind) for kind in KINDS}


class NameTable:
    """The names of a model's elements, by kind and in the order of their ids; unnamed elements are ``""``."""

    def __init__(self, model: MjModel) -> None:
        self.model = model
        self.kept: dict[Hashable, Any] = {}  # values that others derive from these names
        self.names: dict[str, list[str]] = {}
        self.ids: dict[str, dict[str, int]] = {}
        for kind in KINDS:
            self.names[kind] = names(model, kind)
            self.ids[kind] = {name: i for i, name in enumerate(self.names[kind]) if name}

    def count(self, kind: str) -> int:
        return len(self.names[kind])

    def describe(self, kind: str, index: int) -> str:
        """Return the element's name, or the place of an unnamed element: ``#2 of body `arm```, or ``#5``."""
        name = self.names[kind][index]
        if name:
            return name
        if kind not in ON_BODIES:
            return f"#{index}"
        bodies = getattr(self.model, ON_BODIES[kind])
        body = int(bodies[index])
        place = int((bodies[:index] == body).sum())
        return f"#{place} of body `{self.describe('body', body)}`"


@lru_cache(maxsize=2)
def name_table(model: MjModel) -> NameTable:
    """Return the names of a compiled model. Each part of a composition needs the names of the whole."""
    return NameTable(model)


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
            **{name: f"dof_{name}" for name in ("armature", "damping", "frictionloss")}, "ref": "qpos0",
            "springref": "qpos_spring", "solreflimit": "jnt_solref", "solimplimit": "jnt_solimp",
            "solreffriction": "dof_solref", "solimpfriction": "dof_solimp", "actuatorfrcrange": "jnt_actfrcrange",
            "actuatorfrclimited": "jnt_actfrclimited", "actuatorgravcomp": "jnt_actgravcomp",
        },
    ),
    "geom": (f"{_SHAPE} {_CONTACT} condim contype conaffinity priority solmix", {}),
    "site": (_SHAPE, {}),
    "camera": ("pos quat fovy ipd resolution user", {}),
    "light": (f"{_LAMP} pos dir cutoff exponent castshadow active bulbradius range", {}),
    "material": ("rgba emission specular shininess reflectance metallic roughness texrepeat texuniform", {}),
    "pair": (f"{_CONTACT} solreffriction", {"condim": "pair_dim"}),
    "equality": ("solref solimp", {"active": "eq_active0"}),
    "tendon": (
        "range limited stiffness damping armature frictionloss margin width rgba group user",
        {
            "springlength": "tendon_lengthspring", "solreflimit": "tendon_solref_lim",
            "solimplimit": "tendon_solimp_lim", "solreffriction": "tendon_solref_fri",
            "solimpfriction": "tendon_solimp_fri", "actuatorfrcrange": "tendon_actfrcrange",
            "actuatorfrclimited": "tendon_actfrclimited",
        },
    ),
    "actuator": (f"{_RANGES} gear cranklength gainprm biasprm dynprm group user", {}),
    "sensor": ("cutoff noise user", {}),
    "key": ("time", {}),
}  # fmt: skip
TAGS = tuple(_TABLE)
ANGLES: Mapping[str, frozenset[str]] = {"hinge": frozenset({"range", "ref", "springref"}), "ball": frozenset({"range"})}
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


_WORDS = [array.partition("_") for array in ENUMS if array != "actuator_trntype"]  # that one is not written
ENUMERATED: Mapping[str, frozenset[str]] = {
    tag: frozenset(name for arrays, _, name in _WORDS if arrays == kind.arrays) for tag, kind in KINDS.items()
}
"""By tag, the attributes whose values are words (`type`, `mode`); `enums.words` has these for each `array_of`."""


DERIVED = with_trait("tree inertia", "gain") | set(
    "actuator_acc0 actuator_length0 tendon_length0 tendon_lengthspring".split()
)
"""Arrays that follow from nearly everything: they differ if anything else does."""

_INERTIA = "mass inertia ipos iquat subtreemass sameframe pos quat rbound aabb"
_GAINS = "gainprm gaintype biasprm biastype dynprm dyntype actnum ctrlrange ctrllimited"
_SHAPES = f"size type dataid {_INERTIA}"
_MESH = f"{_SHAPES} scale vert normal face facenormal extrema graph polynormal polyvert polyvertnum polymap polymapnum"
# Attributes with another name than their arrays: the suffixes of the arrays' names.
_BECOMES = {
    **dict.fromkeys("mass density diaginertia fullinertia shellinertia".split(), _INERTIA),
    **dict.fromkeys("pos quat euler axisangle xyaxes zaxis".split(), _INERTIA),
    **dict.fromkeys("size fromto type mesh".split(), _SHAPES),
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
    **dict.fromkeys(("connect", "weld", "flex", "flexvert", "flexstrain"), "equality"),
    **dict.fromkeys(
        "general motor position velocity intvelocity damper cylinder muscle adhesion plugin dcmotor pid"
        " orientation".split(),
        "actuator",
    ),
}
# Kinds that are affected too: a mesh shapes geoms, geoms give a body its inertia.
_BEYOND = {"joint": ["dof"], "geom": ["body"], "mesh": ["geom", "body"], "inertial": ["body"]}


@cache
def arrays_of(attribute: str, tag: str | None = None) -> frozenset[str]:
    """Return the arrays that follow from an attribute of an element, or the suffixes of their names without `tag`.

    Arrays computed from the inertia of the whole model, or from a gain, are included, because they follow from
    everything. The array with the attribute itself is always included.

    >>> sorted(arrays_of("friction", "geom") - arrays_of("friction"))
    ['body_friction', 'geom_friction']
    """
    ends = _BECOMES.get(attribute, attribute).split()
    if tag is None:
        return frozenset({*ends, *DERIVED, *(array.partition("_")[2] or array for array in _own(attribute, TAGS))})
    kind = _KINDS.get(tag, tag)
    starts = [KINDS[kind].arrays if kind in KINDS else kind, *_BEYOND.get(kind, [])]
    following = {end if end.startswith("qpos") else f"{start}_{end}" for start in starts for end in ends}
    return frozenset(following | DERIVED | _own(attribute, (kind,)))


def _own(attribute: str, kinds: Iterable[str]) -> set[str]:
    """Return the arrays with the value itself, which have special names for some kinds: `tendon_solref_lim`."""
    return {array_of(kind, attribute) for kind in kinds if kind in TAGS and attribute in attributes(kind)}


def save_digits(mujoco: Any, count: int = 17) -> None:
    """Set how many digits MuJoCo saves: six by default, 17 to preserve every bit. Raises ValueError if it cannot."""
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco*.dll"):
        for library in folder.glob(pattern):
            ctypes.CDLL(str(library))._mjPRIVATE__set_xml_precision(count)
            return
    raise ValueError("this version of MuJoCo saves rounded numbers only")


def sizes(model: MjModel) -> dict[str, int]:
    """Return all integer sizes of the model; `nactuator` falls back to `nu`, which is the same in older versions."""
    values = {name: getattr(model, name) for name in dir(model) if name.startswith("n")}
    found = {name: value for name, value in values.items() if isinstance(value, int)}
    return {**found, "nactuator": found.get("nactuator", found["nu"])}


def arrays(wanted: list[str], model: MjModel, data: MjData | None) -> dict[str, Any]:
    """Return the requested arrays that this version has; a size is an array with one number, a text its bytes."""
    import numpy

    found = {}
    for name in wanted:
        owner, _, attribute = name.rpartition(".")
        value = getattr(data if owner == "data" else model, attribute, None)
        if isinstance(value, bytes):
            value = numpy.frombuffer(value, numpy.uint8)
        if isinstance(value, int | float | numpy.ndarray):
            found[name] = numpy.atleast_1d(value)
    return found


_PLACES = ("qpos", "mocap_pos", "mocap_quat")


def place(mujoco: Any, model: MjModel, data: MjData) -> None:
    """Compute positions, and contacts if memory allows: 10,000 bodies need 200 MB, but MuJoCo 4.0 reserves 16 MB."""
    try:
        mujoco.mj_forward(model, data)
        return
    except mujoco.FatalError:
        kept = {name: getattr(data, name).copy() for name in _PLACES}
    flags = int(model.opt.disableflags)
    mujoco.mj_resetData(model, data)
    for name, value in kept.items():
        getattr(data, name)[:] = value
    try:
        model.opt.disableflags = flags | int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        mujoco.mj_forward(model, data)
    finally:
        model.opt.disableflags = flags
