"""The offset of a part or an element as a recipe says it, in whichever form of orientation is there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from mjcompose.base.diagnostic import Path as Steps
from mjcompose.base.rotation import (
    IDENTITY_QUAT,
    Pose,
    Quat,
    axisangle_of,
    euler_of,
    normalize,
    quat_from_axisangle,
    quat_from_euler,
    quat_from_xyaxes,
    quat_from_zaxis,
    rotate,
    unit,
)
from mjcompose.build.plan.steps import AngleSettings
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.text.expression import UNITS, Angle
from mjcompose.text.node import Mapping, Scalar, find, is_template, walk
from mjcompose.text.node import Sequence as List
from mjcompose.tools.view.draft import Draft, Refused, short, value_of

_POS, _AXIS, _DEGREES, _RADIANS = 5, 6, 3, 6
"""The digits of numbers: 0.01 mm and 0.001 degrees."""
_TURN = 2e-4
"""Rotations that differ by fewer radians count as equal."""


class Offset:
    """`pos` and an orientation in the mapping at a path of a recipe."""

    def __init__(self, draft: Draft, holder: Steps, settings: AngleSettings) -> None:
        self.draft, self.holder, self.settings = draft, holder, settings
        found = find(draft.tree, holder)
        assert isinstance(found, Mapping)
        self.mapping = found
        self.form = next((each for each in ORIENTATIONS if each in found.entries), None)

    @property
    def computed(self) -> list[tuple[str, str]]:
        """The keys that have an expression, each with it."""
        keys = [key for key in ("pos", self.form) if key is not None and key in self.mapping.entries]
        return [
            (key, each.node.text)
            for key in keys
            for each in walk(self.mapping.entries[key][1])
            if isinstance(each.node, Scalar) and is_template(each.node.text)
        ]

    @property
    def pose(self) -> Pose:
        x, y, z = self._read("pos") or (0.0, 0.0, 0.0)
        return Pose((x, y, z), IDENTITY_QUAT if self.form is None else self._quat(self.form, self._read(self.form)))

    def move(self, pose: Pose, *, anew: bool = False) -> list[str]:
        """Write another pose and return its words; `anew` forgets which of several equal angles were written."""
        before, written = self.pose, list[str]()
        texts = [short(each, _POS) for each in pose.pos]
        if texts != [short(each, _POS) for each in before.pos]:
            self.draft.numbers((*self.holder, "pos"), texts)
            written.append(f"pos: [{', '.join(texts)}]")
        if _turn(before.quat, pose.quat) > _TURN / 10:
            form = self.form or "euler"
            old = self._read(form) if self.form and not anew else []
            texts = self._texts(form, pose.quat, old)
            if not texts:
                form, texts = "quat", self._texts("quat", pose.quat, [])
            self.draft.numbers((*self.holder, self.form or form), texts)
            if self.form not in (None, form):
                self.draft.rename((*self.holder, str(self.form)), form)
                self.draft.notes.append(f"`{self.form}` cannot say this rotation: it is a `quat` now")
            written.append(f"{form}: [{', '.join(texts)}]")
        return written

    def _read(self, key: str) -> list[float]:
        """Return the numbers of a key, angles in radians."""
        node = find(self.mapping, (key,))
        if node is None:
            return []
        if not isinstance(node, List) or not all(isinstance(each, Scalar) for each in node.items):
            raise Refused(f"`{key}` is not a list of numbers")
        values = [each.value for each in node.items if isinstance(each, Scalar)]
        if len(values) != {"quat": 4, "axisangle": 4, "xyaxes": 6}.get(key, 3):
            raise Refused(f"`{key}` does not have the right number of numbers")
        return self._radians(key, values)

    def _radians(self, key: str, values: Sequence[Any]) -> list[float]:
        found = list[float]()
        for at, value in enumerate(values):
            angle = Angle.read(value) if isinstance(value, str) else None
            if angle is None and (isinstance(value, bool) or not isinstance(value, int | float)):
                raise Refused(f"`{key}` has `{value}`, which is not a number")
            number = float(value) if angle is None else angle.radians
            bare = angle is None and self.settings.angle == "degree" and _is_angle(key, at)
            found.append(math.radians(number) if bare else number)
        return found

    def _quat(self, form: str, values: Sequence[float]) -> Quat:
        read: dict[str, Callable[[], Quat]] = {
            "quat": lambda: normalize(values),
            "euler": lambda: quat_from_euler(values, self.settings.eulerseq),
            "axisangle": lambda: quat_from_axisangle(values[:3], values[3]),
            "xyaxes": lambda: quat_from_xyaxes(values),
            "zaxis": lambda: quat_from_zaxis(values),
        }
        return read[form]()

    def _texts(self, form: str, quat: Quat, old: list[float]) -> list[str]:
        """Return the numbers of a rotation in a form; none if the form cannot say it."""
        values: Sequence[float]
        if form == "quat":
            sign = -1 if sum(a * b for a, b in zip(quat, old or quat, strict=True)) < 0 else 1
            values = [sign * each for each in quat]
        elif form == "euler":
            values = euler_of(quat, self.settings.eulerseq, old or (0.0, 0.0, 0.0)) or ()
        elif form == "axisangle":
            axis, angle = axisangle_of(quat, old[:3] or (0.0, 0.0, 1.0))
            same = old and math.dist(axis, unit(old[:3])) < 1e-6
            values = (*(old[:3] if same else axis), angle)
        else:
            axes = ((1, 0, 0), (0, 1, 0)) if form == "xyaxes" else ((0, 0, 1),)
            values = [each for axis in axes for each in rotate(quat, axis)]
        texts = [
            self._angle(form, at, each) if _is_angle(form, at) else short(each, _AXIS) for at, each in enumerate(values)
        ]
        said = self._radians(form, [value_of(each) for each in texts]) if texts else []
        return texts if said and _turn(self._quat(form, said), quat) < _TURN else []

    def _angle(self, form: str, at: int, value: float) -> str:
        """Return an angle in the unit of its present text, or in the unit of the recipe."""
        node = find(self.mapping, (form, at))
        written = node.text[-3:] if isinstance(node, Scalar) and node.text[-3:] in UNITS else None
        bare = {"degree": "deg", "radian": "rad"}.get(self.settings.angle or "")
        is_in_radians = (written or bare) == "rad"
        text = short(value, _RADIANS) if is_in_radians else short(math.degrees(value), _DEGREES)
        return text if (written is None and bare) or (text == "0" and written is None) else f"{text}{written or 'deg'}"


def _is_angle(key: str, at: int) -> bool:
    return key == "euler" or (key == "axisangle" and at == 3)


def _turn(a: Quat, b: Quat) -> float:
    """Return the angle between two rotations, at least 120 degrees for larger ones."""
    sign = math.copysign(1, sum(x * y for x, y in zip(a, b, strict=True)))
    return 4 * math.asin(min(0.5, math.dist([sign * each for each in a], b) / 2))
