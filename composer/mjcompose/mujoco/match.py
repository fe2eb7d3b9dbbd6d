"""The element of a composition for each element of a part, and elements that are missing or foreign.

Named elements are found by their name with the part's prefix. Unnamed elements are found by order: on a body among the
unnamed elements of that body, elsewhere among elements that refer only to the part. If the composition has more of them
than the part, the most similar elements are paired first, so a change shows as a change of a field.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN, Pose, Quat, Vec3, normalize
from mjcompose.mujoco.addresses import RowRange, counted, runs
from mjcompose.mujoco.attributes import HOLDERS, KINDS, ON_BODIES, NameTable, holder, name_table
from mjcompose.mujoco.references import UNORDERED, Link, World, links, row_key

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Value: TypeAlias = bool | int | float | str | tuple["Value", ...] | None

MISSING = "missing"
EXTRA = "extra"


class Difference(Struct):
    """A field of an element that differs.

    ``kind`` is MJCF's word for the element, and ``name`` is its name in the composition. An unnamed element is reported
    by its place. ``field`` is the array of `mjModel`, with an index if only one entry is shown, or ``missing`` for an
    element that the composition lacks, or ``extra`` for an element that the part lacks. ``expected`` is the value in
    the part alone, and ``actual`` is the value in the composition. References are names. ``why`` says in words if
    MuJoCo itself causes the difference.
    """

    kind: str
    name: str
    field: str
    expected: Value
    actual: Value
    why: str = ""

    @property
    def array(self) -> str:
        """The array of `mjModel`, without the index or the element of a key's entry."""
        return re.split(r"[\[, ]", self.field, maxsplit=1)[0]

    def __str__(self) -> str:
        subject = f"{self.kind} {self.name}" if self.name.startswith("#") else f"{self.kind} `{self.name}`"
        if self.field == MISSING:
            return f"{subject} is missing"
        if self.field == EXTRA:
            return f"{subject} is not in the part alone"
        why = f" ({self.why})" if self.why else ""
        return f"{subject}: `{self.field}` is {_number(self.actual)}, alone it is {_number(self.expected)}{why}"


def _number(value: Value) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_number, value))}]"
    return f"`{value}`" if isinstance(value, str) else "none" if value is None else repr(value)


def distinguishes(link: Link) -> bool:
    """Return whether a reference helps to identify an element; its place and elements matched later do not."""
    return link.kind != "plugin" and link.world in (World.WORLD, World.KEPT) and link.field != "jnt_actuatorid"


def raw(model: MjModel, kind: str, index: int) -> Hashable:
    """Return the references of an element of the composition, comparable with the translated references of the part."""
    return _comparable(kind, ((each.kind, each.index) for each in links(model, kind, index) if distinguishes(each)))


_Likeness: TypeAlias = "Callable[[MjModel, str, int], Hashable]"
"""Returns a key that alike elements of both models have in common."""


def _comparable(kind: str, targets: Iterable[tuple[str, int]]) -> Hashable:
    return tuple(sorted(targets) if kind in UNORDERED else targets)


def values(model: MjModel, kind: str, index: int) -> Hashable:
    """Return all values of an element, without its place and references."""
    data = tuple((name, array.tobytes()) for name, array in runs(model, kind, index) if kind != "flex")
    return row_key(model, kind, index), data


def shape(model: MjModel, kind: str, index: int) -> Hashable:
    """Return the traits of an element that rarely change: its type, or a body's joints and the number of its geoms."""
    if kind == "body":
        joints = RowRange("body_jntadr", counted("body_jntnum")).rows(model, index)
        return tuple(int(model.jnt_type[each]) for each in joints), int(model.body_geomnum[index])
    types_of = getattr(model, f"{KINDS[kind].arrays}_type", None)
    return None if types_of is None else int(types_of[index])


AT_ORIGIN = Pose()


class Mount(Struct):
    """The body that replaces the part's world in a composition, and the pose of the part in it.

    ``body`` is a name in the composition, the id of an unnamed body, or None for the world. ``pose=None`` means that
    the pose is unknown: it is then taken from the first element at the part's root, and all other elements must have
    moved with it.
    """

    body: str | int | None = None
    pose: Pose | None = AT_ORIGIN

    @property
    def is_in_place(self) -> bool:
        """Whether the part has the same pose in the composition as alone."""
        return self.body is None and self.pose is not None and self.pose.is_identity

    @classmethod
    def of(
        cls,
        composed: MjModel,
        *,
        site: str | None = None,
        body: str | None = None,
        pos: Vec3 = ORIGIN,
        quat: Quat = IDENTITY_QUAT,
    ) -> Mount:
        """Return the mount for a place in a recipe, with an offset in its frame (m). Raises KeyError if unknown."""
        offset = Pose(pos, normalize(quat))
        if site is None:
            return cls(body, offset)
        index = name_table(composed).ids["site"][site]
        return cls(holder(composed, "site", index) or None, pose_of(composed, "site", index) @ offset)

    def index(self, roster: NameTable) -> int:
        """Return the id of the body in the composition. Raises KeyError for an unknown body."""
        if self.body is None:
            return 0
        return self.body if isinstance(self.body, int) else roster.ids["body"][self.body]


def pose_of(model: MjModel, kind: str, index: int) -> Pose:
    """Return the pose of an element in its body."""
    arrays = KINDS[kind].arrays
    x, y, z = getattr(model, f"{arrays}_pos")[index].tolist()
    w, a, b, c = getattr(model, f"{arrays}_quat")[index].tolist()
    return Pose((x, y, z), (w, a, b, c))


_ASSETS = ("texture", "material", "mesh", "hfield")
_GLOBAL = "skin flex tendon equality pair exclude sensor actuator numeric text tuple".split()

ABSENT = -1

_SAME_PLACE = 1e-6
"""Meters; elements that are closer are distinguished by their order."""


class Correspondence:
    """For every element of the part alone, the id of its counterpart, or ``ABSENT``.

    With ``by_order=False`` unnamed elements are paired by similarity even if both models have the same number. Keys are
    not matched here, because they may be merged, kept apart or left out. With ``cut``, elements that refer to the world
    may refer to it in both models.
    """

    def __init__(
        self,
        alone: NameTable,
        composed: NameTable,
        *,
        prefix: str,
        mount: Mount,
        renamed: Mapping[str, Mapping[str, str]],
        by_order: bool = True,
        cut: bool = False,
    ) -> None:
        self.by_order = by_order
        self.cut = cut
        self.alone = alone
        self.composed = composed
        self.prefix = prefix
        self.renamed = renamed
        self.ids: dict[str, list[int]] = {kind: [ABSENT] * alone.count(kind) for kind in KINDS}
        self.mount = mount.index(composed)
        self.pose = mount.pose
        self.taken: dict[str, set[int]] = {kind: set() for kind in KINDS}
        self.ids["body"][0] = self.mount
        self.worlds = {self.mount}
        self._match_named()
        for kind in _ASSETS:
            self._match_global(kind)
        self.worlds = self._frame_bodies()
        self._match_bodies()
        for kind in ON_BODIES:
            self._match_on_bodies(kind)
        for kind in _GLOBAL:
            self._match_global(kind)
        self._match_plugins()

    def name(self, kind: str, name: str) -> str:
        """Return the name in the composition of the part's ``name``."""
        given = self.renamed.get(kind, {}).get(name)
        return self.prefix + name if given is None else given

    def pairs(self, kind: str) -> list[tuple[int, int]]:
        """Return the ids, alone and composed, of every element with a counterpart, except the world."""
        first = 1 if kind == "body" else 0
        return [(i, j) for i, j in enumerate(self.ids[kind]) if j != ABSENT and i >= first]

    def targets(self, link: Link) -> set[int]:
        """Return the possible ids in the composition of a reference's target; none if its target is missing."""
        if link.index < 0:
            return {link.index}  # no target; -2 means several
        if link.kind == "body" and link.index == 0:
            if link.world is World.EITHER or (link.world is not World.MOUNT and self.cut):
                return {0, *self.worlds}
            return {0} if link.world is World.KEPT else self.worlds
        target = self.ids[link.kind][link.index]
        return set() if target == ABSENT else {target}

    def _match_named(self) -> None:
        for kind in KINDS:
            there = self.composed.ids[kind]
            for index, name in enumerate(self.alone.names[kind] if kind != "key" else ()):
                target = there.get(self.name(kind, name)) if name else None
                if target is not None and not (kind == "body" and index == 0):
                    self._take(kind, index, target)

    def _take(self, kind: str, index: int, target: int) -> None:
        self.ids[kind][index] = target
        self.taken[kind].add(target)

    def _frame_bodies(self) -> set[int]:
        """Return the mount, and bodies without joints that a composition may have put between it and the part."""
        worlds = {self.mount}
        model = self.composed.model
        for index, name in enumerate(self.composed.names["body"] if self.prefix else ()):
            is_frame = index not in self.taken["body"] and not model.body_jntnum[index]
            if is_frame and name.startswith(self.prefix) and int(model.body_parentid[index]) in worlds:
                worlds.add(index)
        return worlds

    def _match_bodies(self) -> None:
        found = self.ids["body"]
        self._owners = {
            kind: (getattr(self.alone.model, array).tolist(), getattr(self.composed.model, array).tolist())
            for kind, array in HOLDERS.items()
        }
        self._loads: dict[int, list[tuple[str, int]]] = {}
        for kind, (owners, _) in self._owners.items():
            for index, owner in enumerate(owners):
                if self.alone.names[kind][index]:
                    self._loads.setdefault(owner, []).append((kind, index))
        there = _unnamed_by_body(self.composed, "body")
        for parent, children in sorted(_unnamed_by_body(self.alone, "body").items()):
            if found[parent] != ABSENT:
                parents = sorted(self.worlds) if parent == 0 else [found[parent]]
                candidates = [i for p in parents for i in there.get(p, ()) if i not in self.taken["body"]]
                self._assign("body", *self._match_by_load(children, candidates))

    def _match_by_load(self, mine: list[int], theirs: list[int]) -> tuple[list[int], list[int]]:
        """Match unnamed bodies by the named elements on them; return the others."""
        for index in mine:
            owners = {
                int(self._owners[kind][1][self.ids[kind][i]])
                for kind, i in self._loads.get(index, ())
                if self.ids[kind][i] != ABSENT
            }
            target = next((j for j in theirs if j in owners and j not in self.taken["body"]), None)
            if target is not None:
                self._take("body", index, target)
        left = [i for i in mine if self.ids["body"][i] == ABSENT]
        return left, [j for j in theirs if j not in self.taken["body"]]

    def _match_on_bodies(self, kind: str) -> None:
        there = _unnamed_by_body(self.composed, kind)
        for body, children in _unnamed_by_body(self.alone, kind).items():
            target = self.ids["body"][body]
            if target != ABSENT:
                bodies = sorted(self.worlds) if body == 0 else [target]
                self._assign(kind, children, [i for b in bodies for i in there.get(b, ())])

    def _match_global(self, kind: str) -> None:
        children = [i for i, name in enumerate(self.alone.names[kind]) if not name and self.ids[kind][i] == ABSENT]
        if not children:
            return
        images = self.taken | {"body": {*self.taken["body"], 0, *self.worlds}}

        def is_owned(index: int) -> bool:
            others = (link for link in links(self.composed.model, kind, index) if link.kind != "plugin")
            return all(link.index < 0 or link.index in images[link.kind] for link in others)

        unnamed = (i for i, name in enumerate(self.composed.names[kind]) if not name and i not in self.taken[kind])
        self._assign(kind, children, [i for i in unnamed if is_owned(i)], ordered=kind not in UNORDERED)

    def _match_plugins(self) -> None:
        found = self.ids["plugin"]
        names = self.composed.names["plugin"]
        for kind in ("body", "geom", "actuator", "sensor"):
            for index, target in enumerate(self.ids[kind]):
                if target == ABSENT or (kind == "body" and index == 0):
                    continue
                here = links(self.alone.model, kind, index)
                there = links(self.composed.model, kind, target)
                for mine, theirs in zip(here, there, strict=False):
                    if not mine.kind == theirs.kind == "plugin" or mine.index < 0 or theirs.index < 0:
                        continue
                    is_named = self.alone.names["plugin"][mine.index] or names[theirs.index]
                    if found[mine.index] == ABSENT and not is_named:
                        self._take("plugin", mine.index, theirs.index)
        self._match_global("plugin")

    def _assign(self, kind: str, mine: list[int], theirs: list[int], *, ordered: bool = True) -> None:
        """Pair ``mine`` with ``theirs``: by order if their counts are equal, otherwise by similarity."""
        targets = self.ids[kind]
        if ordered and self.by_order and len(mine) == len(theirs):
            for i, j in zip(mine, theirs, strict=True):
                self._take(kind, i, j)
            return
        # By all values and references, then by the traits that rarely change and references, by the traits, by nothing.
        for likeness, refers in ((values, True), (shape, True), (shape, False), (lambda *_: None, False)):
            self._pair_alike(kind, mine, theirs, likeness=likeness, refers=refers)
            mine = [i for i in mine if targets[i] == ABSENT]
            theirs = [j for j in theirs if j not in self.taken[kind]]

    def _pair_alike(self, kind: str, mine: list[int], theirs: list[int], likeness: _Likeness, refers: bool) -> None:
        """Pair the elements with the same likeness and, with `refers`, the same references; nearest first."""
        alone = self.alone.model
        composed = self.composed.model
        waiting: dict[Hashable, list[int]] = {}
        for j in theirs:
            waiting.setdefault((likeness(composed, kind, j), refers and raw(composed, kind, j)), []).append(j)
        for i in mine:
            alike = waiting.get((likeness(alone, kind, i), refers and self._translated(kind, i)), [])
            if alike and likeness is values and all(self._apart(kind, i, j) for j in alike):
                continue  # an equal element elsewhere belongs to another part
            if alike:
                nearest = min(alike, key=lambda j: self._apart(kind, i, j)) if len(alike) > 1 else alike[0]
                alike.remove(nearest)
                self._take(kind, i, nearest)

    def _apart(self, kind: str, index: int, target: int) -> float:
        """Return the distance of ``target`` from the expected position of ``index`` in meters; 0 if unknown."""
        if kind not in HOLDERS or kind == "joint":
            return 0.0
        positions = f"{KINDS[kind].arrays}_pos"
        x, y, z = getattr(self.alone.model, positions)[index].tolist()
        expected = Pose((x, y, z))
        if holder(self.alone.model, kind, index) == 0:
            if self.pose is None:
                return 0.0
            expected = self.pose @ expected
        distance = math.dist(expected.pos, getattr(self.composed.model, positions)[target].tolist())
        return distance if distance > _SAME_PLACE else 0.0

    def _translated(self, kind: str, index: int) -> Hashable:
        own = (link for link in links(self.alone.model, kind, index) if distinguishes(link))
        return _comparable(kind, ((link.kind, min(self.targets(link), default=-2)) for link in own))


def _unnamed_by_body(roster: NameTable, kind: str) -> dict[int, list[int]]:
    on_body: dict[int, list[int]] = {}
    bodies: Iterable[int] = getattr(roster.model, HOLDERS[kind]).tolist()
    for index, (body, name) in enumerate(zip(bodies, roster.names[kind], strict=True)):
        if not name:
            on_body.setdefault(body, []).append(index)
    return on_body


def presence_differences(matching: Correspondence, others: Sequence[tuple[str, MjModel]] | None) -> list[Difference]:
    """Return missing elements and, with ``others``, extra elements. ``keyframes`` handles keys."""
    tables = [(prefix, NameTable(model)) for prefix, model in others or ()]
    found: list[Difference] = []
    for kind in KINDS:
        if kind != "key":
            found += _missing(matching, kind)
            found += _extra(matching, kind, tables) if others is not None and matching.prefix else []
    return found


def _missing(matching: Correspondence, kind: str) -> list[Difference]:
    """Return missing elements; an unnamed element on a missing body is not reported again."""
    roster = matching.alone
    bodies = matching.ids["body"]
    owners = getattr(roster.model, ON_BODIES[kind]).tolist() if kind in ON_BODIES else None
    found: list[Difference] = []
    for index, target in enumerate(matching.ids[kind]):
        name = roster.names[kind][index]
        if target != ABSENT or (owners is not None and not name and bodies[owners[index]] == ABSENT):
            continue
        shown = matching.name(kind, name) if name else roster.describe(kind, index)
        found.append(Difference(kind, shown, MISSING, expected=True, actual=False))
    return found


def _extra(matching: Correspondence, kind: str, others: Iterable[tuple[str, NameTable]]) -> list[Difference]:
    theirs = {matching.prefix, *(other + name for other, roster in others for name in roster.names[kind] if name)}
    known = matching.taken[kind] | (matching.worlds if kind == "body" else set())
    return [
        Difference(kind, name, EXTRA, expected=False, actual=True)
        for index, name in enumerate(matching.composed.names[kind])
        if name.startswith(matching.prefix) and name not in theirs and index not in known
    ]


def unequal_references(matching: Correspondence) -> Iterator[tuple[str, int, int, Link | None, Link | None]]:
    """Yield the changed references of elements that both models have: kind, both ids, and the link in each model."""
    for kind in KINDS:
        if kind != "key":
            for index, target in matching.pairs(kind):
                mine = links(matching.alone.model, kind, index)
                theirs = links(matching.composed.model, kind, target)
                if kind in UNORDERED and theirs[1].index in matching.targets(mine[0]):
                    # The first may now be the second.
                    first, second = theirs
                    theirs = [replace(second, field=first.field), replace(first, field=second.field)]
                there = {link.field: link for link in theirs}
                for link in mine:
                    other = there.pop(link.field, None)
                    if other is None or other.kind != link.kind or other.index not in matching.targets(link):
                        yield kind, index, target, link, other
                for other in there.values():
                    yield kind, index, target, None, other


def reference_differences(matching: Correspondence) -> list[Difference]:
    """Return changed references, except references whose target is missing."""
    found = []
    for kind, _, target, mine, other in unequal_references(matching):
        if mine is not None and other is not None and (mine.kind != other.kind or matching.targets(mine)):
            alone = _target(matching.alone, mine)
            composed = _target(matching.composed, other)
            if alone and matching.alone.names[mine.kind][mine.index] and (mine.kind, mine.index) != ("body", 0):
                alone = matching.name(mine.kind, alone)
            name = matching.composed.describe(kind, target)
            found.append(Difference(kind, name, mine.field, expected=alone, actual=composed))
    return found


def _target(roster: NameTable, link: Link) -> str | None:
    return None if link.index < 0 else roster.describe(link.kind, link.index)


def _carriers(model: MjModel, starts: Iterable[int], own: Mapping[int, int]) -> set[int]:
    """Return the bodies of a part, by their ids in the part alone, at or above the bodies at `starts`."""
    carriers: set[int] = set()
    for body in starts:
        while body and body in own and own[body] not in carriers:
            carriers.add(own[body])
            body = int(model.body_parentid[body])
    return carriers


class Coupling:
    """Bodies of a part, by their ids in the part alone, that the rest of the composition affects.

    ``hosts`` carry geoms of other parts, which contribute to their mass and inertia. ``carriers`` have elements of
    other parts on or below them. ``trees`` are the root bodies of kinematic trees with fixed elements of other parts,
    or on a moving body, so other bodies contribute to the inertia at their joints. If the part is ``cut`` out of the
    other model, this holds for all trees, because a removed tendon may have had an armature.
    """

    def __init__(self, matching: Correspondence, mount: Mount, *, cut: bool = False) -> None:
        composed = matching.composed.model
        bodies = matching.ids["body"]
        self.in_place = mount.is_in_place and matching.worlds == {0}
        self.moving = bool(composed.body_weldid[matching.mount])

        mine = {target: body for body, target in enumerate(bodies) if body and target != ABSENT}
        geoms = Counter(int(composed.geom_bodyid[target]) for target in matching.ids["geom"] if target != ABSENT)
        self.hosts = {body for target, body in mine.items() if int(composed.body_geomnum[target]) > geoms[target]}

        foreign = [i for i in range(1, composed.nbody) if i not in mine and i not in matching.worlds]
        starts = [int(composed.body_parentid[i]) for i in foreign] + [bodies[body] for body in self.hosts]
        self.carriers = _carriers(composed, starts, mine)
        self._roots: list[int] = matching.alone.model.body_rootid.tolist()
        self.trees = {self._roots[body] for body in (range(len(bodies)) if self.moving or cut else self.carriers)}

    def acts_on(self, body: int) -> bool:
        """Return whether the kinematic tree of this body of the part is shared."""
        return self._roots[body] in self.trees
