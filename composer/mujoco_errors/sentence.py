"""Parse a message of MuJoCo into fields: its topic, and the names in it."""

from __future__ import annotations

import re
from enum import Enum

from composer.dataclass import dataclass

_UNKNOWN_ATTRIBUTE = re.compile(r"unrecognized attribute: '(?P<name>[^']*)'")
_UNKNOWN_ELEMENT = re.compile(r"unrecognized (?:model )?element")
_ATTRIBUTE = re.compile(r"attribute '(?P<name>[^']*)'")
_MISSING = re.compile(r"missing element: '(?P<tag>[^']*)'|attribute missing: '(?P<name>[^']*)'")
_SIZE = re.compile(r"^size (?P<index>\d) must be positive")
_PLUGIN = re.compile(r"failed for plugin id (?P<id>\d+)")
_ARRAY = re.compile(r"^Invalid model: (?P<name>[a-z]+_\w+)")
_WORD = re.compile(r"\w+")
_QUOTED = re.compile(r"'([^'\n]+)'")
# Messages about settings of the whole model, for which MuJoCo knows no line.
_SECTIONS = {
    "size": re.compile(r"<size |arena memory|mj_stackAlloc"),
    "option": re.compile(r"\bintegrator='"),
}


class Topic(Enum):
    """The topic of a message of MuJoCo; the value is the pattern that recognizes it."""

    MASS = r"mass and inertia of moving bodies"
    GEOM_SIZE = r"^size \d must be positive in geom"
    SIZE = r"^size \d must be positive"
    NEGATIVE = r"are negative in geom"
    FREE_JOINT = r"^free joint can only be used on top level"
    MOCAP = r"^mocap body .* is not a fixed child of world"
    WRAP = r"is not sphere or cylinder"
    VERTICES = r"vertices required"
    MESH_FILE = r"^invalid header in|^stl_decoder: |^obj_decoder: "
    PICTURE = r"PNG"
    TRANSMISSION = r"^missing transmission target"
    MESH_FORMAT = r"no decoder found"
    FLEX_UNPINNED = r"has joints but no flex vertices/nodes are pinned"
    PLUGIN_INSTANCE = r"actuator not found for plugin instance"
    DOFS = r"^more than 6 dofs"
    FLAT = r"has coplanar vertices|^qhull error"
    FORMAT = r"^bad format in attribute"
    INERTIA = r"A \+ B >= C|^error 'inertia must have positive eigenvalues'"
    FRAMEBUFFER = r"framebuffer"
    URDF_GEOMETRY = r"geometry specification"
    URDF_REPEATED = r"^repeated URDF name|^repeated name '.*' in joint"
    URDF_RING = r"^URDF body not found$"
    URDF_PARENTS = r"has multiple parents"
    URDF_LINK = r"^URDF joint parent or child missing$"
    URDF_JOINT_TYPE = r"^invalid joint type"


@dataclass(frozen=True, slots=True)
class Sentence:
    """A parsed message of MuJoCo; no other code in this package parses messages.

    `attribute` is the one that it names, `unknown_attribute` one that MJCF does not have there, `missing_attribute`
    and `missing_element` are required ones; `names` are the names in quotes. `size_index` is the size that must be
    positive, `plugin` the number of the plugin that failed, `section` the section with the faulty setting, `array`
    the faulty array of the compiled model.
    """

    topic: Topic | None = None
    attribute: str | None = None
    unknown_attribute: str | None = None
    is_unknown_element: bool = False
    missing_attribute: str | None = None
    missing_element: str | None = None
    names: tuple[str, ...] = ()
    words: frozenset[str] = frozenset()
    size_index: int | None = None
    plugin: int | None = None
    section: str | None = None
    array: str | None = None


def read_sentence(message: str) -> Sentence:
    """Parse a message of MuJoCo.

    >>> read_sentence("required attribute missing: 'pos'").missing_attribute
    'pos'
    """
    attribute, unknown = _ATTRIBUTE.search(message), _UNKNOWN_ATTRIBUTE.search(message)
    array = _ARRAY.search(message)
    missing, size, plugin = _MISSING.search(message), _SIZE.search(message), _PLUGIN.search(message)
    return Sentence(
        next((topic for topic in Topic if re.search(topic.value, message)), None),
        attribute["name"] if attribute else None,
        unknown["name"] if unknown else None,
        is_unknown_element=_UNKNOWN_ELEMENT.search(message) is not None,
        missing_attribute=missing["name"] if missing else None,
        missing_element=missing["tag"] if missing else None,
        names=tuple(_QUOTED.findall(message)),
        words=frozenset(_WORD.findall(message)),
        size_index=int(size["index"]) if size else None,
        plugin=int(plugin["id"]) if plugin else None,
        section=next((section for section, said in _SECTIONS.items() if said.search(message)), None),
        array=array["name"] if array else None,
    )
