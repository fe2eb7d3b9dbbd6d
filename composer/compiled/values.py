"""Compare the numbers of a part's elements: rows of arrays, and the data that elements point to."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from composer.compiled.addresses import span
from composer.compiled.correspondence import Correspondence
from composer.compiled.coupling import Coupling
from composer.compiled.difference import Difference, Value
from composer.compiled.fields import (
    AUTHORED_SLEEP,
    BEFORE_CONTROLS,
    DERIVED_ROUNDING,
    HULL,
    ROUNDING,
    Rule,
    Treatment,
)
from composer.compiled.gains import same_damping, same_dampratio, same_stiffness
from composer.compiled.kinds import HOLDERS, KINDS, holder
from composer.compiled.links import ON_TENDON, WRAP_SITE, links, twists_a_rod
from composer.compiled.placing import Placing
from composer.compiled.ragged import FROM_THE_WORLD, IN_THE_WORLD, runs
from composer.compiled.rows import DOF, Array, arrays, same_width, unequal
from composer.numerics.pose import Pose, multiply

_WELD = 1  # mjEQ_WELD
_ONE_POINT = 1e-9
"""Metres; at this distance the direction between two points is made of rounding errors."""
_SHOWN = 12
"""Longer rows are shown by their first differing entry."""


class Values:
    """Compares every array that belongs to an element, by the rules in ``fields``."""

    def __init__(
        self, matching: Correspondence, coupling: Coupling, placing: Placing, tolerance: float
    ) -> None:
        self.matching, self.coupling, self.placing, self.tolerance = matching, coupling, placing, tolerance
        self.alone, self.composed = matching.alone.model, matching.composed.model

    def differences(self) -> list[Difference]:
        found: list[Difference] = []
        for kind in KINDS:
            if kind != "key":
                pairs = self.matching.pairs(kind)
                found += self._rows(
                    kind, kind, pairs, mine=[i for i, _ in pairs], theirs=[j for _, j in pairs]
                )
                found += self._runs(kind)
        found += self._dofs()
        found += self._sleep()
        return found

    def _dofs(self) -> list[Difference]:
        """Compare the arrays with one row for each degree of freedom, by joint."""
        pairs: list[tuple[int, int]] = []
        mine: list[int] = []
        theirs: list[int] = []
        for index, target in self.matching.pairs("joint"):
            if int(self.alone.jnt_type[index]) == int(self.composed.jnt_type[target]):
                mine += (own := span(self.alone, "qvel", index))
                theirs += span(self.composed, "qvel", target)
                pairs += [(index, target)] * len(own)
        return list(dict.fromkeys(self._rows("joint", DOF, pairs, mine=mine, theirs=theirs)))

    def _rows(
        self, kind: str, group: str, pairs: list[tuple[int, int]], mine: list[int], theirs: list[int]
    ) -> list[Difference]:
        """Compare the arrays of a group at ``mine`` alone and ``theirs`` composed: the rows of ``pairs``."""
        found: list[Difference] = []
        if not pairs:
            return found
        composed = {name: array for name, array, _ in arrays(self.composed, group)}
        for name, array, how in arrays(self.alone, group):
            other = composed.get(name)
            if other is not None:
                expected = array[mine]
                if name == "eq_data" and not self.coupling.in_place:
                    expected = np.array([self._moved(*pair, other[pair[1]]) for pair in pairs])
                found += self._array(kind, name, how, pairs=pairs, expected=expected, actual=other[theirs])
        return found

    def _array(
        self,
        kind: str,
        name: str,
        how: Rule | None,
        pairs: list[tuple[int, int]],
        expected: Array,
        actual: Array,
    ) -> list[Difference]:
        treatment = how.treatment if how else Treatment.PLAIN
        if treatment in (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA):
            if name not in BEFORE_CONTROLS or hasattr(self.alone, "actuator_ctrladr"):
                return []
            treatment = BEFORE_CONTROLS[name]
        if treatment is Treatment.PRESENT:
            expected, actual = np.not_equal(expected, -1), np.not_equal(actual, -1)
        elif treatment is Treatment.USER:
            expected, actual = same_width(expected, actual)
        if not expected.size:
            return []
        different = unequal(expected, actual, self._bound(treatment)).reshape(len(expected), -1)
        return [
            self._difference(kind, pairs[row][1], name, expected=expected[row], actual=actual[row])
            for row in np.flatnonzero(different.any(axis=1)).tolist()
            if not self._excused(treatment, kind, name, *pairs[row])
        ]

    def _moved(self, index: int, target: int, actual: Array) -> Array:
        """Return the numbers of an equality, with what they measure in the part's world where the part is."""
        data = np.array(self.alone.eq_data[index])
        first, second = links(self.alone, "equality", index)
        of_world = [link.kind == "body" and link.index == 0 for link in (first, second)]
        if not any(of_world):
            return data
        ids = (self.composed.eq_obj1id[target], self.composed.eq_obj2id[target])
        pose = self.placing.seen_from(int(ids[of_world.index(True)]))
        # A `connect` has the point in the first body and then that in the second. A `weld` has them the other way
        # round, and then the rotation of the second body in the first.
        is_weld = int(self.alone.eq_type[index]) == _WELD
        at = 3 if of_world[0] == is_weld else 0
        x, y, z = data[at : at + 3].tolist()
        data[at : at + 3] = (pose @ Pose((x, y, z))).pos
        if is_weld:
            w, a, b, c = data[6:10].tolist()
            turn = (
                multiply(pose.quat, (w, a, b, c))
                if of_world[0]
                else multiply((w, a, b, c), pose.inverse().quat)
            )
            data[6:10] = np.array(turn) * (1.0 if np.dot(turn, actual[6:10]) >= 0 else -1.0)
        return data

    def _bound(self, treatment: Treatment) -> float:
        if treatment in (Treatment.ROUNDED, Treatment.GAIN) and not self.coupling.in_place:
            return max(ROUNDING, self.tolerance)
        if treatment is Treatment.DERIVED:
            return max(DERIVED_ROUNDING, self.tolerance)
        return self.tolerance

    def _excused(self, treatment: Treatment, kind: str, name: str, index: int, target: int) -> bool:
        """Return whether a difference in this row only follows from the part's place in the composition."""
        coupling, moved = self.coupling, not self.coupling.in_place
        if name in HULL and self._hull_for_others(kind, index):
            return True
        match treatment:
            case Treatment.ROOT_POSE:
                if kind == "body" and twists_a_rod(self.alone, index):
                    return True  # it has no place: only its angle counts
                return moved and self._at_root(kind, index)
            case Treatment.HOST:
                on_host = self._body(kind, index) in coupling.hosts
                return on_host or (moved and kind != "body" and self._at_root(kind, index))
            case Treatment.SUBTREE:
                return index in coupling.carriers
            case Treatment.LENS:
                return not self.alone.cam_sensorsize[index].any()
            case Treatment.DERIVED:
                acted_on = self._acted_on(kind, index) or self._less_simple(kind, index)
                return acted_on or (moved and kind == "tendon" and self._has_no_direction(index))
            case Treatment.GAIN if kind == "actuator":
                return same_dampratio(self.alone, self.composed, index, target=target)
            case Treatment.GAIN:
                same = same_stiffness if name == "jnt_stiffness" else same_damping
                seen_otherwise = self._acted_on(kind, index) or self._less_simple(kind, index)
                return seen_otherwise and same(self.alone, self.composed, index, target)
            case Treatment.ROUNDED:
                return moved and name == "flex_size"
            case _:
                return False

    def _hull_for_others(self, kind: str, index: int) -> bool:
        """Return whether nothing of the part collides with this mesh; only then MuJoCo computes no convex hull."""
        return kind == "mesh" and int(self.alone.mesh_graphadr[index]) < 0

    def _at_root(self, kind: str, index: int) -> bool:
        return kind in HOLDERS and holder(self.alone, kind, index) == 0

    def _body(self, kind: str, index: int) -> int:
        return index if kind == "body" else holder(self.alone, kind, index)

    def _acted_on(self, kind: str, index: int) -> bool:
        if kind in ("body", "joint"):
            return self.coupling.acts_on(self._body(kind, index))
        return self.coupling.anywhere

    def _less_simple(self, kind: str, index: int) -> bool:
        """Return whether only one of the models uses MuJoCo's shortcut for bodies that slide in the world.

        The shortcut's inverse weights differ from those of the whole mass matrix.
        """
        if kind not in ("body", "joint"):
            return False
        body = self._body(kind, index)
        there = self.matching.ids["body"][body]
        return there >= 0 and int(self.alone.body_simple[body]) != int(self.composed.body_simple[there])

    def _has_no_direction(self, tendon: int) -> bool:
        """Return whether two neighbouring sites of a tendon lie in one point in the reference configuration.

        MuJoCo 4.0 then takes the x axis of the world for the direction between them, or that of a rounding error: what
        follows from it depends on how the part is turned.
        """
        model = self.alone
        first = int(model.tendon_adr[tendon])
        rows = range(first, first + int(model.tendon_num[tendon]))
        points = [
            self._reference(int(model.wrap_objid[row])) if int(model.wrap_type[row]) == WRAP_SITE else None
            for row in rows
        ]
        return any(
            one is not None and other is not None and np.allclose(one, other, rtol=0, atol=_ONE_POINT)
            for one, other in pairwise(points)
        )

    def _reference(self, site: int) -> tuple[float, ...]:
        """Return where a site of the part alone is in the reference configuration."""
        model = self.alone
        x, y, z = model.site_pos[site].tolist()
        pose, body = Pose((x, y, z)), int(model.site_bodyid[site])
        while body:
            (x, y, z), (w, a, b, c) = model.body_pos[body].tolist(), model.body_quat[body].tolist()
            pose, body = Pose((x, y, z), (w, a, b, c)) @ pose, int(model.body_parentid[body])
        return pose.pos

    def _runs(self, kind: str) -> list[Difference]:
        """Compare the data that elements point to."""
        found: list[Difference] = []
        for index, target in self.matching.pairs(kind):
            theirs = dict(runs(self.composed, kind, target))
            for name, mine in runs(self.alone, kind, index):
                other = theirs.get(name)
                if other is not None:
                    found += self._run(kind, name, index, target=target, mine=mine, other=other)
        return found

    def _run(
        self, kind: str, name: str, index: int, target: int, mine: Array, other: Array
    ) -> list[Difference]:
        if name in HULL and self._hull_for_others(kind, index):
            return []
        if mine.shape != other.shape:
            shown = self.matching.composed.describe(kind, target)
            return [Difference(kind, shown, f"{name}, rows", expected=len(mine), actual=len(other))]
        moved, bound = not self.coupling.in_place, self.tolerance
        if name == "actuator_acc0":
            on_tendon = int(self.alone.actuator_trntype[index]) == ON_TENDON
            tendon = int(self.alone.actuator_trnid[index, 0])
            if self._acted_on(kind, index) or (moved and on_tendon and self._has_no_direction(tendon)):
                return []
            bound = self._bound(Treatment.DERIVED)
        elif moved and name in IN_THE_WORLD:
            return []
        elif moved and name == "flex_vert":
            first = int(self.alone.flex_vertadr[index])
            # -1: nodes carry the vertex. `flex_vert0` says where it is between them, and this where the frame puts it.
            free = self.alone.flex_vertbodyid[first : first + len(mine)] > 0
            mine, other = mine[free], other[free]
        elif moved and name in FROM_THE_WORLD and mine.size:
            bound = max(bound, DERIVED_ROUNDING * max(1.0, float(np.abs(mine.astype(np.float64)).max())))
        elif name in ("actuator_length0", "actuator_lengthrange"):
            bound = self._bound(Treatment.ROUNDED)
        different = unequal(mine, other, bound)
        if not different.any():
            return []
        return [self._difference(kind, target, name, expected=mine, actual=other, different=different)]

    def _sleep(self) -> list[Difference]:
        """Compare the sleep policy of a kinematic tree, if the part's author wrote one on its root."""
        found: list[Difference] = []
        if not hasattr(self.alone, "tree_sleep_policy"):
            return found
        for index, target in self.matching.pairs("body"):
            if self.alone.body_rootid[index] != index or self.composed.body_rootid[target] != target:
                continue
            mine, theirs = int(self.alone.body_treeid[index]), int(self.composed.body_treeid[target])
            if mine < 0 or theirs < 0:
                continue
            expected = int(self.alone.tree_sleep_policy[mine])
            actual = int(self.composed.tree_sleep_policy[theirs])
            if expected >= AUTHORED_SLEEP and expected != actual:
                name = self.matching.composed.describe("body", target)
                found.append(Difference("body", name, "tree_sleep_policy", expected=expected, actual=actual))
        return found

    def _difference(
        self,
        kind: str,
        target: int,
        name: str,
        expected: Array,
        actual: Array,
        different: Array | None = None,
    ) -> Difference:
        a, b = np.asarray(expected), np.asarray(actual)
        shown = self.matching.composed.describe(kind, target)
        if a.size <= _SHOWN:
            return Difference(kind, shown, name, expected=_value(a), actual=_value(b))
        places = np.argwhere(unequal(a, b, self.tolerance) if different is None else different)
        first = tuple(places[0].tolist())
        return Difference(
            kind, shown, f"{name}{list(first)}", expected=a[first].item(), actual=b[first].item()
        )


def _value(array: Array) -> Value:
    return tuple(_value(item) for item in array) if array.ndim else array.item()
