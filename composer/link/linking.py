"""What the linker works on: a base, the parts that hang on it, and the model that comes out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.layout import Layout, Slot
from composer.numerics.pose import Pose
from composer.tree.key import Key, PartKeys
from composer.tree.names import Names
from composer.tree.unit import Unit
from composer.tree.watch import Watch, nobody

if TYPE_CHECKING:
    from composer.link.room import Asked

Policy = Literal["error", "warning", "merge"]
KeyPolicy = Literal["merge", "prefix", "none"]


@dataclass(frozen=True, slots=True)
class Place:
    """Where a part hangs: an element of the model by its final name, and an offset in that element's frame.

    `offset` holds the attributes of a `<frame>`: `pos` in metres, `quat`. `written` says where the recipe has each of
    them. With `computed` that is not its value but the key, `mate` or `replicate`, for whose sake it was computed.
    """

    kind: Literal["world", "body", "site", "frame"] = "world"
    name: str | None = None
    offset: Mapping[str, str] = field(default_factory=dict)
    span: Span | None = None
    written: Mapping[str, Span] = field(default_factory=dict)
    computed: Literal["", "mate", "replicate"] = ""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between a place and a part: the tag, its attributes, and where the recipe has those that it writes."""

    tag: Literal["joint", "freejoint"]
    attributes: Mapping[str, str]
    written: Mapping[str, Span] = field(default_factory=dict)


@dataclass(eq=False)
class Part:
    """A unit, the prefix that its names get (separator included), and how it hangs on the model.

    `content` is the element of the model in which the part's world is, once it hangs there.
    `by_itself`: it stands in the world by the free joint, or as the mocap body, that it brings, wherever its place is.
    `key` is its key in a recipe.
    """

    unit: Unit
    prefix: str
    place: Place = Place()
    keyframes: KeyPolicy = "merge"
    joints: tuple[Joint, ...] = ()
    weld: bool = False
    mocap: bool = False
    by_itself: bool = False
    span: Span | None = None
    key: str = ""
    mount: Node | None = None
    top_class: str = ""
    layout: Layout | None = None
    pose_in_world: Pose | None = None
    content: Node | None = None

    @property
    def called(self) -> str:
        """What messages call it: its prefix, or its file where it has none."""
        return self.prefix or self.unit.label

    def path(self, separator: str) -> str:
        """What a recipe calls it among the parts: its prefix, or its key where it has none."""
        return self.prefix.removesuffix(separator) or self.key

    @property
    def floats(self) -> bool:
        """Whether it moves freely, so that it can only stand in the world."""
        return self.by_itself or self.mocap or any(joint.tag == "freejoint" for joint in self.joints)


class Floating(NamedTuple):
    """A body at the root of a part that is free by a `joint` or (None) a mocap body; what messages call it.

    `alone`: there is nothing else in the part's world.
    """

    part: Part
    body: Node
    joint: Node | None
    called: str
    alone: bool


class Flex(NamedTuple):
    """A `<flexcomp>` at the root of a unit, and the joint settings of the unit's top class that it takes."""

    element: Node
    unit: Unit
    part: Part | None
    joint: Mapping[str, str]


class Measure(Protocol):
    """MuJoCo at work on a unit alone: arrays of `mjModel` by name; none of a unit that it refuses.

    That is told, but of an `attempt`.
    """

    def __call__(
        self, unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False
    ) -> Mapping[str, list[float]]: ...


class FileUse(NamedTuple):
    """An attribute of the model that names a file of the bundle, and where that file's bytes are.

    A file that is not `shared` must stand under its own path, whatever other file has the same bytes.
    """

    element: Node
    attribute: str
    path: str
    source: str
    content: bytes | None
    shared: bool = True


@dataclass(eq=False)
class Linking:
    """The state that the passes share, from parts apart to one flat model.

    `settled` holds the option paths (`option/cone`) that the recipe sets itself: no conflict there. `isolate_base` has
    the tags for which it sets the base's top class, which must not reach the parts. `aligned` is whether the model says
    `alignfree`. `asked` are the parts, by path, of whose keys the recipe makes its own; None where it makes no key.
    `own_keys` and `part_keys` are what `part_keys.py` finds, the base under None and `base`; `written_keys` are the
    recipe's, `replaced_keys` those of the parts, by name, in whose place they stand; `final_layout` is how the
    finished model lays them out. Edits of what is linked note in `reshaped` whose numbers in a key may be more or
    fewer now, and in `emptied` whose old numbers have no meaning any more; `edited` is that there may be edits;
    `drawn` has what was drawn for an element, by field. `grows` is that the recipe adds what rules for a whole
    model would reach. `weighed` are the bodies whose inertia has been written out, so that what is added to them
    adds no mass. `references` and `mocap_references` have what only MuJoCo can tell of the reference
    configuration. `placed_keys` are the models that MuJoCo attaches to parts whose keys say where something is in
    the world. `coming` has where the recipe writes the places, by kind and name, that it adds when all parts
    hang. `room` is what the sources ask for of memory, where MuJoCo may have to give more.
    """

    base: Unit
    parts: list[Part]
    sink: Sink
    separator: str = "/"
    conflict: Policy = "error"
    settled: frozenset[str] = frozenset()
    isolate_base: frozenset[str] = frozenset()
    base_keyframes: KeyPolicy = "merge"
    asked: frozenset[str] | None = None
    measure: Measure | None = None
    watch: Watch = nobody
    coming: Mapping[tuple[str, str], Span] = field(default_factory=dict)
    names: Names = field(default_factory=Names)
    base_class: str | None = None
    aligned: bool = False
    base_layout: Layout | None = None
    final_layout: Layout | None = None
    files: list[FileUse] = field(default_factory=list)
    measured: dict[Node, Slot] = field(default_factory=dict)
    references: dict[Node, list[str]] = field(default_factory=dict)
    mocap_references: dict[Node, list[Pose]] = field(default_factory=dict)
    placed_keys: list[tuple[Part, Node]] = field(default_factory=list)
    floating: list[Floating] = field(default_factory=list)
    own_keys: dict[Part | None, tuple[Key, ...]] = field(default_factory=dict)
    part_keys: dict[str, PartKeys] | None = None
    written_keys: list[Key] = field(default_factory=list)
    replaced_keys: dict[str, Key] = field(default_factory=dict)
    planes: list[tuple[Part, Node]] = field(default_factory=list)
    reshaped: set[Node] = field(default_factory=set)
    emptied: set[Node] = field(default_factory=set)
    drawn: dict[Node, dict[str, object]] = field(default_factory=dict)
    edited: bool = False
    grows: bool = False
    weighed: set[Node] = field(default_factory=set)
    flexes: list[Flex] = field(default_factory=list)
    replicates: list[tuple[Unit, Node]] = field(default_factory=list)
    main_joint: dict[str, str] = field(default_factory=dict)
    room: tuple[Asked, ...] = ()

    @property
    def composed(self) -> bool:
        """Whether there is more in the model than the base: its rules for a whole model are for the base alone."""
        return bool(self.parts) or self.grows

    @property
    def units(self) -> list[Unit]:
        return [self.base, *[part.unit for part in self.parts]]

    @cached_property
    def angle(self) -> str:
        """What the model says: `degree` only where every unit does."""
        return "degree" if all(unit.settings.angle == "degree" for unit in self.units) else "radian"

    def flat(self) -> Unit:
        """The model as it stands, with its files; of parts that are not joined yet it has nothing."""
        base = self.base
        contents = {
            use.path: use.content if use.content is not None else Path(use.source) for use in self.files
        }
        return Unit(
            base.root,
            base.file,
            base.directory,
            base.label,
            contents or base.contents,
            base.origins,
            base.part_keys,
            base.header,
        )

    def span(self, unit: Unit, element: Node, attribute: str | None = None) -> Span:
        """Where an element of a unit, or the value of its attribute, is written."""
        return unit.origins.span(element, unit.file, attribute)
