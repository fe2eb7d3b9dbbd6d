"""Whether a part inside a composed model is numerically what it is alone."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

from composer.verify.coupling import Coupling
from composer.verify.difference import EXTRA, MISSING, Difference, Value
from composer.verify.fields import DERIVED_ROUNDING, ROUNDING, Rule, Treatment
from composer.verify.gains import same_dampratio, same_springdamper
from composer.verify.keyframes import Keys, Roots, key_differences
from composer.verify.links import UNORDERED, Link, links
from composer.verify.matching import ABSENT, ON_BODIES, Matching
from composer.verify.mount import Mount
from composer.verify.placing import Placing
from composer.verify.roster import JOINT_VELOCITIES, KINDS, Model, Roster
from composer.verify.rows import DOF, Array, arrays, unequal
from composer.verify.runs import FROM_THE_WORLD, IN_THE_WORLD, runs

_SHOWN = 12
"""Longer rows are shown by their first entry that differs."""

_AUTHORED_SLEEP = 3
"""The first value of `mjtSleepPolicy` that an author wrote; those below are decided by the whole tree."""

_PER_ELEMENT_BEFORE_4 = {
    "actuator_ctrllimited": Treatment.PLAIN,
    "actuator_ctrlrange": Treatment.PLAIN,
    "actuator_gear": Treatment.PLAIN,
    "actuator_length0": Treatment.ROUNDED,
    "actuator_lengthrange": Treatment.ROUNDED,
    "actuator_acc0": Treatment.DERIVED,
}
"""Arrays that have one row an actuator in MuJoCo 3, where an actuator has one control and one output."""


def compare(
    alone: Model,
    composed: Model,
    *,
    prefix: str = "",
    hung_on: Mount | None = None,
    renamed: Mapping[str, Mapping[str, str]] | None = None,
    keys: Keys = Keys.MERGE,
    roots_in_keys: Roots = Roots.MOVED,
    others: Sequence[tuple[str, Model]] | None = None,
    ignore: Collection[str] = (),
    tolerance: float = 0.0,
) -> list[Difference]:
    """What differs between a part compiled alone and the same part in a composition.

    ``prefix`` includes its separator; the base's is ``""``. ``hung_on`` is where the part's world stands (default:
    the world, unmoved). ``renamed`` maps names of the part to names of the composition by kind, where they are not
    simply prefixed. With ``others``, the prefixes and models of all other parts, elements
    that bear this part's prefix but are of no part count as differences too. ``ignore`` are arrays, or
    attributes of every kind, that were changed on purpose. ``tolerance`` is relative to the larger of 1 and the
    value; 0 asks for equality bit for bit wherever composition can give it (``fields.RULES`` says where not).

    Options, statistics and visual settings belong to the whole model and are not compared here. No I/O; raises
    KeyError if ``hung_on`` names a body the composition has not got.
    """
    mount = hung_on or Mount()
    matching = Matching(Roster(alone), Roster(composed), prefix=prefix, mount=mount, renamed=renamed or {})
    judge = _Judge(matching, mount, tolerance)
    found = judge.presence(others)
    for kind in KINDS:
        if kind != "key":
            found += judge.links(kind)
            found += judge.rows(kind)
            found += judge.runs(kind)
    found += judge.dofs()
    found += judge.sleep()
    if not judge.coupling.in_place:
        found += judge.placing.differences(tolerance)
    transform = judge.placing.transform if matching.mount == 0 else None
    found += key_differences(matching, transform, keys, roots_in_keys, tolerance)
    return [difference for difference in found if not _ignored(difference, ignore)]


class _Judge:
    def __init__(self, matching: Matching, mount: Mount, tolerance: float) -> None:
        self.matching = matching
        self.coupling = Coupling(matching, mount)
        self.placing = Placing(matching, mount)
        self.tolerance = tolerance
        self.alone, self.composed = matching.alone.model, matching.composed.model

    def presence(self, others: Sequence[tuple[str, Model]] | None) -> list[Difference]:
        """Elements the composition lacks, and those that bear the part's prefix without being of it."""
        found: list[Difference] = []
        rosters = [(prefix, Roster(model)) for prefix, model in others or ()]
        gone = {body for body, target in enumerate(self.matching.ids["body"]) if target == ABSENT}
        for kind, ids in self.matching.ids.items():
            if kind == "key":
                continue
            roster = self.matching.alone
            owners = getattr(self.alone, ON_BODIES[kind]) if kind in ON_BODIES else None
            for index, target in enumerate(ids):
                went_with_body = owners is not None and int(owners[index]) in gone and not roster.names[kind][index]
                if target == ABSENT and not went_with_body:
                    name = roster.names[kind][index]
                    shown = self.matching.name(kind, name) if name else roster.describe(kind, index)
                    found.append(Difference(kind, shown, MISSING, True, False))
            if others is not None and self.matching.prefix:
                found += self._extras(kind, rosters)
        return found

    def _extras(self, kind: str, others: Iterable[tuple[str, Roster]]) -> list[Difference]:
        prefix = self.matching.prefix
        taken = {other + name for other, roster in others for name in roster.names[kind] if name}
        return [
            Difference(kind, name, EXTRA, False, True)
            for index, name in enumerate(self.matching.composed.names[kind])
            if name.startswith(prefix)
            and name not in taken
            and name != prefix
            and index not in self.matching.taken[kind]
            and not (kind == "body" and index in self.matching.worlds)
        ]

    def _matched(self, kind: str) -> tuple[list[int], list[int]]:
        pairs = [
            (i, j) for i, j in enumerate(self.matching.ids[kind]) if j != ABSENT and not (kind == "body" and i == 0)
        ]
        return [i for i, _ in pairs], [j for _, j in pairs]

    def _name(self, kind: str, target: int) -> str:
        return self.matching.composed.describe(kind, target)

    def links(self, kind: str) -> list[Difference]:
        """References that stand for another element than in the part alone."""
        found: list[Difference] = []
        for index, target in zip(*self._matched(kind), strict=True):
            mine, theirs = links(self.alone, kind, index), links(self.composed, kind, target)
            if kind in UNORDERED:
                theirs = self._reordered(mine, theirs)
            for a, b in zip(mine, theirs, strict=False):
                allowed = self.matching.targets(a)
                if a.kind == b.kind and b.index in allowed:
                    continue
                if not allowed and a.kind == b.kind:
                    continue  # the target is missing altogether: told once, there
                expected = self._called(self.matching.alone, a)
                actual = self._called(self.matching.composed, b)
                found.append(Difference(kind, self._name(kind, target), a.field, expected, actual))
        return found

    def _reordered(self, mine: Sequence[Link], theirs: Sequence[Link]) -> list[Link]:
        first, second = theirs
        return [second, first] if second.index in self.matching.targets(mine[0]) else [first, second]

    def _called(self, roster: Roster, link: Link) -> Value:
        if link.index < 0:
            return None
        name = roster.describe(link.kind, link.index)
        mine = roster is self.matching.alone and not (link.kind == "body" and link.index == 0)
        return self.matching.name(link.kind, name) if mine and not name.startswith("#") else name

    def rows(self, kind: str) -> list[Difference]:
        """Arrays with one row an element."""
        mine, theirs = self._matched(kind)
        found: list[Difference] = []
        if not mine:
            return found
        composed = {name: array for name, array, _ in arrays(self.composed, kind)}
        for name, array, how in arrays(self.alone, kind):
            other = composed.get(name)
            if other is not None:
                found += self._row(kind, name, how, (mine, theirs), array[mine], other[theirs])
        return found

    def _row(
        self,
        kind: str,
        name: str,
        how: Rule | None,
        ids: tuple[list[int], list[int]],
        expected: Array,
        actual: Array,
    ) -> list[Difference]:
        treatment = how.treatment if how else Treatment.PLAIN
        if treatment in (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA):
            if name not in _PER_ELEMENT_BEFORE_4 or hasattr(self.alone, "actuator_ctrladr"):
                return []
            treatment = _PER_ELEMENT_BEFORE_4[name]
        if treatment is Treatment.PRESENT:
            expected, actual = expected >= 0, actual >= 0
        if treatment is Treatment.USER:
            expected, actual = _same_width(expected, actual)
        different = unequal(expected, actual, self._bound(treatment))
        rows = np.flatnonzero(different.reshape(len(expected), -1).any(axis=1)) if expected.size else ()
        return [
            self._difference(kind, ids[1][row], name, expected[row], actual[row])
            for row in rows
            if not self._excused(treatment, kind, name, ids[0][row], ids[1][row])
        ]

    def _bound(self, treatment: Treatment) -> float:
        if treatment is Treatment.ROUNDED and not self.coupling.in_place:
            return max(ROUNDING, self.tolerance)
        if treatment is Treatment.DERIVED:
            return max(DERIVED_ROUNDING, self.tolerance)
        return self.tolerance

    def _excused(self, treatment: Treatment, kind: str, name: str, index: int, target: int) -> bool:
        """Whether a difference in this row is what the place in the composition makes of it."""
        coupling, in_place = self.coupling, self.coupling.in_place
        match treatment:
            case Treatment.ROOT_POSE:
                return not in_place and self._at_root(kind, index)
            case Treatment.HOST:
                return self._body(kind, index) in coupling.hosts or (not in_place and self._at_root(kind, index))
            case Treatment.SUBTREE:
                return index in coupling.carriers
            case Treatment.DERIVED:
                return self._acted_on(kind, index)
            case Treatment.GAIN if kind == "actuator":
                return same_dampratio(self.alone, self.composed, index, target)
            case Treatment.GAIN:
                return self._acted_on(kind, index) and same_springdamper(self.alone, self.composed, index, target)
            case Treatment.ROUNDED if name == "eq_data":
                return not in_place and any(
                    link.kind == "body" and link.index == 0 for link in links(self.alone, kind, index)
                )
            case Treatment.ROUNDED:
                return not in_place and name == "flex_size"
            case _:
                return False

    def _at_root(self, kind: str, index: int) -> bool:
        if kind == "body":
            return int(self.alone.body_parentid[index]) == 0
        return kind in ON_BODIES and int(getattr(self.alone, ON_BODIES[kind])[index]) == 0

    def _body(self, kind: str, index: int) -> int:
        return index if kind == "body" else int(getattr(self.alone, ON_BODIES[kind])[index])

    def _acted_on(self, kind: str, index: int) -> bool:
        if kind in ("body", "joint"):
            return self.coupling.acts_on(self._body(kind, index))
        return self.coupling.anywhere

    def runs(self, kind: str) -> list[Difference]:
        """Data that elements point to."""
        found: list[Difference] = []
        for index, target in zip(*self._matched(kind), strict=True):
            theirs = dict(runs(self.composed, kind, target))
            for name, mine in runs(self.alone, kind, index):
                other = theirs.get(name)
                if other is not None:
                    found += self._run(kind, name, index, target, mine, other)
        return found

    def _run(self, kind: str, name: str, index: int, target: int, mine: Array, other: Array) -> list[Difference]:
        if mine.shape != other.shape:
            return [Difference(kind, self._name(kind, target), f"{name}, rows", len(mine), len(other))]
        bound = self.tolerance
        if not self.coupling.in_place:
            if name in IN_THE_WORLD:
                return []
            if name == "flex_vert":
                first = int(self.alone.flex_vertadr[index])
                free = self.alone.flex_vertbodyid[first : first + len(mine)] != 0
                mine, other = mine[free], other[free]
            elif name in FROM_THE_WORLD and mine.size:
                bound = max(bound, DERIVED_ROUNDING * max(1.0, float(np.abs(mine).max())))
            elif name in ("actuator_length0", "actuator_lengthrange"):
                bound = max(bound, ROUNDING)
        if name == "actuator_acc0":
            if self._acted_on(kind, index):
                return []
            bound = self._bound(Treatment.DERIVED)
        different = unequal(mine, other, bound)
        if not different.any():
            return []
        return [self._difference(kind, target, name, mine, other, different)]

    def dofs(self) -> list[Difference]:
        """The arrays with one row a degree of freedom, told by joint."""
        joints: list[tuple[int, int]] = []
        mine: list[int] = []
        theirs: list[int] = []
        for index, target in zip(*self._matched("joint"), strict=True):
            kind = int(self.alone.jnt_type[index])
            if kind == int(self.composed.jnt_type[target]):
                first, other = int(self.alone.jnt_dofadr[index]), int(self.composed.jnt_dofadr[target])
                mine += range(first, first + JOINT_VELOCITIES[kind])
                theirs += range(other, other + JOINT_VELOCITIES[kind])
                joints += [(index, target)] * JOINT_VELOCITIES[kind]
        if not joints:
            return []
        ids = [i for i, _ in joints], [j for _, j in joints]
        composed = {name: array for name, array, _ in arrays(self.composed, DOF)}
        found: list[Difference] = []
        for name, array, how in arrays(self.alone, DOF):
            if name in composed:
                found += self._row("joint", name, how, ids, array[mine], composed[name][theirs])
        return list(dict.fromkeys(found))

    def sleep(self) -> list[Difference]:
        """The sleep policy of a kinematic tree, where the part's author wrote one on its root."""
        if not hasattr(self.alone, "tree_sleep_policy"):
            return []
        found: list[Difference] = []
        for index, target in zip(*self._matched("body"), strict=True):
            mine, theirs = int(self.alone.body_treeid[index]), int(self.composed.body_treeid[target])
            is_root = int(self.alone.body_rootid[index]) == index and int(self.composed.body_rootid[target]) == target
            if not is_root or mine < 0 or theirs < 0:
                continue
            policy, actual = int(self.alone.tree_sleep_policy[mine]), int(self.composed.tree_sleep_policy[theirs])
            if policy >= _AUTHORED_SLEEP and policy != actual:
                found.append(Difference("body", self._name("body", target), "tree_sleep_policy", policy, actual))
        return found

    def _difference(
        self, kind: str, target: int, name: str, expected: Array, actual: Array, different: Array | None = None
    ) -> Difference:
        a, b = np.asarray(expected), np.asarray(actual)
        if a.size > _SHOWN:
            first = tuple(np.argwhere(unequal(a, b, self.tolerance) if different is None else different)[0].tolist())
            return Difference(kind, self._name(kind, target), f"{name}{list(first)}", a[first].item(), b[first].item())
        return Difference(kind, self._name(kind, target), name, _value(a), _value(b))


def _value(array: Array) -> Value:
    return tuple(_value(item) for item in array) if array.ndim else array.item()


def _same_width(a: Array, b: Array) -> tuple[Array, Array]:
    width = max(a.shape[1], b.shape[1])
    return _widened(a, width), _widened(b, width)


def _widened(array: Array, width: int) -> Array:
    return np.pad(array, ((0, 0), (0, width - array.shape[1])))


def _ignored(difference: Difference, ignore: Collection[str]) -> bool:
    """Whether ``ignore`` holds the array of the difference, or the attribute behind the array's first word."""
    array = difference.field.split("[")[0].split(",")[0].split(" ")[0]
    return array in ignore or array.partition("_")[2] in ignore
