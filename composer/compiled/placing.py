"""Compare the elements at a part's root, which the mount moves all in the same way."""

from __future__ import annotations

import numpy as np

from composer.compiled.correspondence import ABSENT, Correspondence
from composer.compiled.difference import Difference
from composer.compiled.fields import ROUNDING
from composer.compiled.kinds import HOLDERS, Model, holder
from composer.compiled.links import twists_a_rod
from composer.compiled.mount import Mount
from composer.numerics.pose import Pose, rotate

_OF_FLEXES = "MuJoCo does not turn the axes of a flex's vertices with a frame"
_POSED = {"body": "body", "geom": "geom", "site": "site", "camera": "cam"}


class Placing:
    """The rigid transform from the part's world to the frame of the mount's body: metres, and w x y z.

    ``transform`` is the mount's pose or, if that is unknown, the movement of the first root; None for a part with
    nothing at its root.
    """

    def __init__(self, matching: Correspondence, mount: Mount) -> None:
        self.matching = matching
        self.roots: dict[str, list[int]] = {"body": [], "light": [], **{kind: [] for kind in _POSED}}
        alone = matching.alone.model
        for kind, roots in self.roots.items():
            parents = getattr(alone, HOLDERS[kind])
            found = matching.ids[kind]
            roots += [
                i for i, parent in enumerate(parents.tolist())
                if parent == 0 and found[i] != ABSENT
                and not (kind == "body" and (i == 0 or twists_a_rod(alone, i)))
            ]  # fmt: skip
        self.transform = mount.pose if mount.pose is not None else self._first()

    def _first(self) -> Pose | None:
        for kind in _POSED:
            for index in self.roots[kind]:
                return self._there(kind, index) @ _pose(self.matching.alone.model, kind, index).inverse()
        return None

    def _there(self, kind: str, index: int) -> Pose:
        """Return the pose of a root's counterpart in the frame of the mount, through bodies in between."""
        model, target = self.matching.composed.model, self.matching.ids[kind][index]
        pose = _pose(model, kind, target)
        return self._frame(holder(model, kind, target)) @ pose

    def _frame(self, body: int) -> Pose:
        model, pose = self.matching.composed.model, Pose()
        while body != self.matching.mount and body in self.matching.worlds:
            pose = _pose(model, "body", body) @ pose
            body = int(model.body_parentid[body])
        return pose

    def seen_from(self, body: int) -> Pose:
        """Return the pose of the part's world in a body that holds it; the part's own where nothing says it."""
        return self._frame(body).inverse() @ (self.transform or Pose())

    def differences(self, tolerance: float = 0.0) -> list[Difference]:
        """Return the roots that did not move with the others, for a part that is moved."""
        found: list[Difference] = []
        if self.transform is None:
            return found
        bound = max(ROUNDING, tolerance)
        vertices = set(self.matching.alone.model.flex_vertbodyid.tolist())
        for kind, arrays in _POSED.items():
            for index in self.roots[kind]:
                expected = self.transform @ _pose(self.matching.alone.model, kind, index)
                actual = self._there(kind, index)
                name = self.matching.composed.describe(kind, self.matching.ids[kind][index])
                if not _near(expected.pos, actual.pos, bound):
                    found.append(
                        Difference(kind, name, f"{arrays}_pos", expected=expected.pos, actual=actual.pos)
                    )
                turned = tuple(-x for x in actual.quat)
                if not _near(expected.quat, actual.quat, bound) and not _near(expected.quat, turned, bound):
                    why = _OF_FLEXES if kind == "body" and index in vertices else ""
                    found.append(
                        Difference(
                            kind, name, f"{arrays}_quat", expected=expected.quat, actual=actual.quat, why=why
                        )
                    )
        found += self._lights(bound)
        return found

    def _lights(self, bound: float) -> list[Difference]:
        assert self.transform is not None
        found: list[Difference] = []
        alone, composed = self.matching.alone.model, self.matching.composed.model
        for index in self.roots["light"]:
            target = self.matching.ids["light"][index]
            frame = self._frame(int(composed.light_bodyid[target]))
            name = self.matching.composed.describe("light", target)
            expected = (self.transform @ Pose(_vec(alone.light_pos[index]))).pos
            actual = (frame @ Pose(_vec(composed.light_pos[target]))).pos
            if not _near(expected, actual, bound):
                found.append(Difference("light", name, "light_pos", expected=expected, actual=actual))
            expected = rotate(self.transform.quat, _vec(alone.light_dir[index]))
            actual = rotate(frame.quat, _vec(composed.light_dir[target]))
            if not _near(expected, actual, bound):
                found.append(Difference("light", name, "light_dir", expected=expected, actual=actual))
        return found


def _vec(values: Model) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return (x, y, z)


def _pose(model: Model, kind: str, index: int) -> Pose:
    arrays = _POSED[kind]
    w, x, y, z = getattr(model, f"{arrays}_quat")[index].tolist()
    return Pose(_vec(getattr(model, f"{arrays}_pos")[index]), (w, x, y, z))


def _near(a: tuple[float, ...], b: tuple[float, ...], bound: float) -> bool:
    return bool(np.allclose(a, b, rtol=bound, atol=bound, equal_nan=True))
