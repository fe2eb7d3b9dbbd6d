"""The data that the linker works on: the request, parts, notes, keys and the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple, Protocol

from lxml.etree import _Element as Node

from mjcompose.base.access import Passed
from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.base.rotation import Pose
from mjcompose.base.sink import Sink
from mjcompose.link.key_layout import Holder, KeyLayout, Slot
from mjcompose.tree.classes import MAIN
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.names import Names, may_be_generated
from mjcompose.tree.unit import KeyValues, PartKeys, Unit, Watch, nobody

Policy = Literal["error", "base", "mujoco"]


class LinkRequest(Struct):
    """How to join the parts, and the recipe's later changes of the model.

    `conflict` is the policy for options on which two units disagree; `overridden_options` are the options
    (`option/cone`) that the recipe sets itself. `base_keyframes` is the policy for the keys of the base.
    `requested_keys` has the paths of the parts whose keys the recipe uses in its own keys, or None if it writes no
    keys. `isolated_tags` are the tags for which it sets the top default class of the base, which must not affect the
    parts. `adds_mass` is set if it adds elements that the base's rules for a whole model (`settotalmass`) would reach.
    """

    separator: str = "/"
    conflict: Policy = "error"
    overridden_options: frozenset[str] = frozenset()
    base_keyframes: KeyPolicy = "merge"
    requested_keys: frozenset[str] | None = None
    isolated_tags: frozenset[str] = frozenset()
    adds_mass: bool = False


class AttachmentPlace(Struct):
    """The place where a part is attached: an element of the model, by its final name, and an offset in its frame.

    `offset` holds the attributes of a `<frame>`: `pos` in meters, `quat`. `written` has the places of these attributes
    in the recipe. If `computed` is set, the value was computed for the key `mate`, `mirror` or `replicate`, and the
    place is the key's.
    """

    kind: Literal["world", "body", "site", "frame"] = "world"
    name: str | None = None
    offset: Mapping[str, str] = field(default_factory=dict)
    span: Span | None = None
    written: Mapping[str, Span] = field(default_factory=dict)
    computed: Literal["", "mate", "replicate", "mirror"] = ""


class Joint(Struct):
    """A joint between a place and a part: its tag, its attributes, and the places of written attributes.

    `top_class_of` is the unit whose top class it takes; the linker chooses the name of that class.
    """

    tag: Literal["joint", "freejoint"]
    attributes: Mapping[str, str]
    written: Mapping[str, Span] = field(default_factory=dict)
    top_class_of: Unit | None = None


class SensorBody(Struct):
    """A body between a place and a part, with a site and sensors of the load that the body carries.

    `name` is the name of the body and of the site, and `sensors` has the tag and the name of each sensor. All names are
    final. `cutoff` is "" for none, and `span` is the place in the recipe.
    """

    name: str
    sensors: tuple[tuple[str, str], ...]
    cutoff: str
    span: Span


class MirroredPart(Struct, eq=False):
    """The part whose reflected pose another part has: its unit, and the numbers of the world's and of its own axis."""

    unit: Unit
    across: tuple[int, int]


class Part(Struct, eq=False):
    """A unit, the prefix of its names (including the separator), and how it is to be attached to the model.

    `by_itself` is set if the bodies of the part have free joints of their own, or are mocap bodies. It is then attached
    to the world, wherever its place is. `key` is its key in the recipe. `outward` has the final names of the elements
    that the part refers to outside itself, by the text of the reference.

    A part is complete when it is made. `Linking` has the facts that passes add: `top_classes`, `attachments` and
    `keys.layouts`.
    """

    unit: Unit
    prefix: str
    place: AttachmentPlace = AttachmentPlace()
    mirrored: MirroredPart | None = None
    keyframes: KeyPolicy = "merge"
    joints: tuple[Joint, ...] = ()
    weld: bool = False
    mocap: bool = False
    sense: SensorBody | None = None
    by_itself: bool = False
    span: Span | None = None
    key: str = ""
    outward: Mapping[str, str] = MappingProxyType({})

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
        """Whether the part moves freely and can therefore only be in the world."""
        return self.by_itself or self.mocap or any(joint.tag == "freejoint" for joint in self.joints)


class AttachedPart(Struct, eq=False):
    """Where the pass `bodies` has attached a part.

    `mount` is the element of the place, and `content` the element that holds the bodies and geoms of the part's world.
    The pose of the part in the world is set if its keys need it.
    """

    mount: Node
    content: Node
    pose_in_world: Pose | None = None


class Floating(NamedTuple):
    """A body at the root of a part that moves freely: by its free `joint` or, if that is None, as a mocap body.

    `called` is its name in messages. `alone` is set if the part's world contains nothing else.
    """

    part: Part
    body: Node
    joint: Node | None
    called: str
    alone: bool


class Flex(NamedTuple):
    """A `<flexcomp>` at the root of a unit, and the joint settings that it takes from the unit's top class."""

    element: Node
    unit: Unit
    part: Part | None
    joint: Mapping[str, str]


class MemoryRequest(NamedTuple):
    """The memory that a source requests by an attribute of `<size>`; `called` is the source's name in messages."""

    name: str
    value: str
    called: str
    span: Span


class Notes(Struct, frozen=False, eq=False):
    """The findings of the passes so far.

    `aligned`: the model has `alignfree`. `floating` and `planes` must not be attached below a moving body. `flexes` are
    in the world of their units; `main_joint` are the joint settings that the model's top class keeps for them.
    `replicates` has the unit of each `<replicate>`, `copied` has the original of each element of a written-out
    replicate, and the number of the copy. `inertia_written` are the bodies whose inertia is explicit, so elements added
    to them add no mass. `drawn` holds the values drawn for an element, by field. `memory` are the requests of the
    sources, if MuJoCo may need more memory. `attached` are the models that MuJoCo attaches, by their `<model>`.
    `nameless` are bodies whose name is only for the linker.
    """

    aligned: bool = False
    floating: list[Floating] = field(default_factory=list)
    planes: list[tuple[Part, Node]] = field(default_factory=list)
    flexes: list[Flex] = field(default_factory=list)
    main_joint: dict[str, str] = field(default_factory=dict)
    replicates: list[tuple[Unit, Node]] = field(default_factory=list)
    copied: dict[Node, tuple[Node, tuple[Node, int]]] = field(default_factory=dict)
    inertia_written: set[Node] = field(default_factory=set)
    drawn: dict[Node, dict[str, object]] = field(default_factory=dict)
    memory: tuple[MemoryRequest, ...] = ()
    attached: dict[Node, Node] = field(default_factory=dict)
    nameless: set[Node] = field(default_factory=set)


class WrittenKey(Struct, frozen=False, eq=False):
    """A key that a recipe writes: the keys that it starts from, its entries by vector, and its holding controls.

    `void` has the elements whose values earlier edits have made meaningless.
    """

    taken: tuple[Node, ...]
    void: frozenset[Node]
    entries: dict[str, dict[Node, tuple[list[float], Span]]] = field(default_factory=dict)
    held: dict[Node, Span] = field(default_factory=dict)


class KeyTable(Struct, frozen=False, eq=False):
    """The keys of the units and their layouts.

    `own` holds the keys of the base (under None) and of each part. `by_part` holds the keys of every part by path,
    including the parts of parts, and of the base under `base`. `part_keys` fills both. `written` are the keys of the
    recipe, and `replaced` are the keys of parts that they replace. `attached` are the models that MuJoCo attaches to
    parts and whose keys contain poses in the world.

    `base_layout`, `layouts` and `final_layout` are the layouts of the base alone, of the parts alone, and of the
    finished model. `measured` has the widths that only MuJoCo knows, and `references` and `mocap_references` have the
    reference configuration.

    `edited` is set if there may be edits, `reshaped` are elements whose number of values may have changed, `shapes` has
    the attributes that decided the vertices of each `<flexcomp>`, and `void_keys` are elements whose values in keys
    have become meaningless. `edited_keys` are keys that edits or draws have changed, and `noted` has the values that
    the recipe writes into its own keys.
    """

    own: dict[Part | None, tuple[KeyValues, ...]] = field(default_factory=dict)
    by_part: dict[str, PartKeys] | None = None
    written: list[KeyValues] = field(default_factory=list)
    replaced: dict[str, KeyValues] = field(default_factory=dict)
    attached: list[tuple[Part, Node]] = field(default_factory=list)
    base_layout: KeyLayout | None = None
    layouts: dict[Part, KeyLayout] = field(default_factory=dict)
    final_layout: KeyLayout | None = None
    measured: dict[Node, Slot] = field(default_factory=dict)
    references: dict[Holder, list[str]] = field(default_factory=dict)
    mocap_references: dict[Holder, list[Pose]] = field(default_factory=dict)
    edited: bool = False
    reshaped: set[Node] = field(default_factory=set)
    shapes: dict[Node, str] = field(default_factory=dict)
    void_keys: set[Node] = field(default_factory=set)
    edited_keys: set[Node] = field(default_factory=set)
    noted: dict[Node, WrittenKey] = field(default_factory=dict)


class ModelMeasure(Protocol):
    """Compiles a unit alone and returns arrays of `mjModel`; none after a refusal, reported unless `attempt`."""

    def __call__(self, unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]: ...


PlaceName = tuple[str, str]
"""The kind and the final name of a body, a frame or a site, or the world."""


class LaterPlace(Struct):
    """A place that the recipe adds: the element that it is added to, and where the place's own name is written."""

    to: PlaceName
    span: Span


class AddedElement(Struct, eq=False):
    """An element that the recipe adds, made but not in the model yet, with the places in it.

    It goes to the end of the element `to`. `step` is the step of the plan that adds it, for whoever watches.
    """

    node: Node
    to: PlaceName
    places: tuple[PlaceName, ...]
    step: object

    @property
    def is_hung(self) -> bool:
        return self.node.getparent() is not None


class FileUse(NamedTuple):
    """An attribute that names a file of the bundle, with its source; a file that is not `shared` keeps its own path."""

    element: Node
    attribute: str
    path: str
    source: Passed
    content: bytes | None
    shared: bool = True


def shown_name(element: Node) -> str:
    return f"`{element.get('name')}`" if element.get("name") else "without a name"


_path = lru_cache(maxsize=4096)(Path)  # a model has the same files in each of its samples


def common_angle(units: Iterable[Unit]) -> str:
    """Return the unit of angle of a model that consists of these units: `degree` if all use degrees, else `radian`."""
    return "degree" if all(unit.settings.angle == "degree" for unit in units) else "radian"


@dataclass(eq=False)
class Linking:
    """The state that the passes share, from separate units to one flat model, with its `names` and `files`."""

    base: Unit
    parts: list[Part]
    sink: Sink
    request: LinkRequest = field(default_factory=LinkRequest)
    measure: ModelMeasure | None = None
    watch: Watch = nobody
    names: Names = field(default_factory=Names)
    base_class: str | None = None
    top_classes: dict[Unit, str] = field(default_factory=dict)
    """The final names of the top classes of the parts, by unit: `choose_classes` notes them."""
    attachments: dict[Part, AttachedPart] = field(default_factory=dict)
    """The parts that are in the tree: `bodies` notes them."""
    files: list[FileUse] = field(default_factory=list)
    submodels: int = 0
    notes: Notes = field(default_factory=Notes)
    keys: KeyTable = field(default_factory=KeyTable)
    additions: tuple[AddedElement, ...] = ()
    """The elements with places that parts may wait for, each after the elements that it is added to."""
    later_places: Mapping[PlaceName, LaterPlace] = field(default_factory=dict)
    """All places that the recipe adds, for messages."""

    @property
    def composed(self) -> bool:
        """Whether the model has more than the base, so the base's rules for a whole model apply only to it."""
        return bool(self.parts) or self.request.adds_mass

    @property
    def units(self) -> list[Unit]:
        return [self.base, *[part.unit for part in self.parts]]

    @cached_property
    def angle(self) -> str:
        return common_angle(self.units)

    def top_class(self, unit: Unit) -> str:
        """Return the final name of the top class of the base or of a part."""
        return self.base_class or MAIN if unit is self.base else self.top_classes[unit]

    def pose_in_world(self, part: Part) -> Pose | None:
        """Return the pose in the world of a part whose keys need it."""
        attachment = self.attachments.get(part)
        return None if attachment is None else attachment.pose_in_world

    def find_node(self, namespace: str, name: str) -> Node | None:
        return self.names.find(namespace, name)

    def known_names(self, namespace: str) -> list[str]:
        return self.names.known(namespace)

    def kinds_of(self, name: str) -> list[str]:
        return self.names.kinds_of(name)

    def may_generate(self, name: str) -> bool:
        return may_be_generated(name, self.base.root)

    def flat(self) -> Unit:
        """Return the current model with its files, without the parts that are not joined yet."""
        contents = {use.path: use.content if use.content is not None else _path(use.source) for use in self.files}
        return replace(self.base, contents=contents or self.base.contents)

    def span(self, unit: Unit, element: Node, attribute: str | None = None) -> Span:
        """Return where an element of a unit, or the value of its attribute, is written."""
        return unit.origins.span(element, unit.file, attribute)
