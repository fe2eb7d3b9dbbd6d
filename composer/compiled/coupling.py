"""Where a part and the rest of a composition affect each other through shared bodies."""

from __future__ import annotations

from composer.compiled.correspondence import ABSENT, Correspondence
from composer.compiled.mount import Mount


class Coupling:
    """Bodies of a part, by their ids in the part alone, that the rest of the composition affects.

    ``hosts`` carry geoms of other parts, which contribute to their mass and inertia. ``carriers`` have elements of
    other parts on them or below them. ``trees`` are the root bodies of kinematic trees with fixed elements of other
    parts, or on a moving body: the inertia at their joints is not only their own. If the part is ``cut`` out of the
    other model, this holds for all trees, because a removed tendon may have had an armature.
    """

    def __init__(self, matching: Correspondence, mount: Mount, *, cut: bool = False) -> None:
        alone, composed = matching.alone.model, matching.composed.model
        bodies = matching.ids["body"]
        self.in_place = mount.is_in_place and matching.worlds == {0}
        self.moving = bool(composed.body_weldid[matching.mount])

        mine = {target: body for body, target in enumerate(bodies) if body and target != ABSENT}
        geoms: dict[int, int] = {}
        for target in matching.ids["geom"]:
            if target != ABSENT:
                owner = int(composed.geom_bodyid[target])
                geoms[owner] = geoms.get(owner, 0) + 1
        number = composed.body_geomnum
        self.hosts = {body for target, body in mine.items() if int(number[target]) > geoms.get(target, 0)}

        foreign = [i for i in range(1, len(number)) if i not in mine and i not in matching.worlds]
        starts = [int(composed.body_parentid[i]) for i in foreign] + [bodies[body] for body in self.hosts]
        self.carriers: set[int] = set()
        for target in starts:
            while target and target in mine and mine[target] not in self.carriers:
                self.carriers.add(mine[target])
                target = int(composed.body_parentid[target])
        roots = alone.body_rootid.tolist()
        self.trees = set(roots) if self.moving or cut else {roots[body] for body in self.carriers}
        self._roots = roots

    def acts_on(self, body: int) -> bool:
        """Return whether the kinematic tree of this body of the part is shared."""
        return self._roots[body] in self.trees

    @property
    def anywhere(self) -> bool:
        return bool(self.trees)
