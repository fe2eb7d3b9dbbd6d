"""A part: a unit, and how it is attached to the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from types import MappingProxyType
from typing import Literal

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.layout import Layout
from composer.link.request import KeyPolicy
from composer.numerics.pose import Pose
from composer.tree.unit import Unit


@dataclass(frozen=True, slots=True)
class Place:
    """The place where a part is attached: an element of the model, by its final name, and an offset in its frame.

    `offset` holds the attributes of a `<frame>`: `pos` in metres, `quat`. `written` has the places of these in the
    recipe. If `computed` is set, the value was computed for the key `mate` or `replicate`, and the place is that of
    this key.
    """

    kind: Literal["world", "body", "site", "frame"] = "world"
    name: str | None = None
    offset: Mapping[str, str] = field(default_factory=dict)
    span: Span | None = None
    written: Mapping[str, Span] = field(default_factory=dict)
    computed: Literal["", "mate", "replicate"] = ""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between a place and a part: its tag, its attributes, and the places of those that the recipe writes."""

    tag: Literal["joint", "freejoint"]
    attributes: Mapping[str, str]
    written: Mapping[str, Span] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Sense:
    """A body between a place and a part, with a site and sensors of what the body carries.

    `name` is that of the body and of the site, `sensors` has the tag and the name of each, all of them final names.
    `cutoff` is "" for none, and `span` the place in the recipe.
    """

    name: str
    sensors: tuple[tuple[str, str], ...]
    cutoff: str
    span: Span


@dataclass(eq=False)
class Part:
    """A unit, the prefix of its names (including the separator), and how it is attached to the model.

    `content` is the element of the model that holds the part's world once the part is attached. `by_itself` is set
    if the part brings its own free joint or is a mocap body; it is then attached to the world, wherever its place
    is. `key` is its key in the recipe. `outward` has the final names of what the part refers to outside of itself, by
    the text of the reference.
    """

    unit: Unit
    prefix: str
    place: Place = Place()
    keyframes: KeyPolicy = "merge"
    joints: tuple[Joint, ...] = ()
    weld: bool = False
    mocap: bool = False
    sense: Sense | None = None
    by_itself: bool = False
    span: Span | None = None
    key: str = ""
    outward: Mapping[str, str] = MappingProxyType({})
    mount: Node | None = None
    top_class: str = ""
    layout: Layout | None = None
    pose_in_world: Pose | None = None
    content: Node | None = None

    @property
    def called(self) -> str:
        """The name of the part in messages: its prefix, or its file if it has no prefix."""
        return self.prefix or self.unit.label

    def path(self, separator: str) -> str:
        """Return the name of the part in a recipe: its prefix, or its key if it has no prefix."""
        return self.prefix.removesuffix(separator) or self.key

    @property
    def has_body(self) -> bool:
        """Whether a body is added between the place and the part."""
        return bool(self.joints) or self.mocap or self.sense is not None

    @property
    def floats(self) -> bool:
        """Whether the part moves freely, so that it can only be in the world."""
        return self.by_itself or self.mocap or any(joint.tag == "freejoint" for joint in self.joints)
