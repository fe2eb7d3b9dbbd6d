"""Compare the numbers of elements that both models have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from composer.compiled.addresses import span
from composer.compiled.correspondence import Correspondence
from composer.compiled.enums import ENUMS, SWITCHES, words
from composer.compiled.fields import BEFORE_CONTROLS, Treatment
from composer.compiled.joints import JOINT_TYPES
from composer.compiled.kinds import KINDS, Model
from composer.compiled.quantities import follows
from composer.compiled.ragged import runs
from composer.compiled.rows import DOF, Array, arrays, same_width
from composer.compiled.servos import NO_BIAS, servo
from composer.diff.change import Change, Value
from composer.diff.named import named

FLOOR = 1e-6
"""The tolerance treats smaller values as if they were this large."""

_SHOWN = 12
_COUNTED = ("mesh_vert", "mesh_face")
"""The sizes of these are reported by arrays of their own."""

_SHAPES = ("mesh_", "hfield_", "tex_", "skin_", "flex_", "oct_")
"""The data of these is never listed number by number."""


def close(a: float, b: float, tolerance: float) -> bool:
    """Return whether two numbers count as equal. NaN equals NaN, and nothing else is near an infinite number."""
    if a == b or (a != a and b != b):
        return True
    return math.isfinite(a - b) and abs(a - b) <= tolerance * max(abs(a), abs(b), FLOOR)


class Values:
    """Compares every array with a row for each element, in the unit and words of MuJoCo's arrays."""

    def __init__(self, mujoco: Any, matching: Correspondence, tolerance: float) -> None:
        self.mujoco, self.matching, self.tolerance = mujoco, matching, tolerance
        self.a, self.b = matching.alone.model, matching.composed.model
        self._known: dict[tuple[int, str], list[tuple[str, Array, Treatment]]] = {}

    def changes(self) -> Iterator[Change]:
        """Yield changes in the order of kinds, and of elements in B."""
        for kind in KINDS:
            if kind == "key":
                continue
            for index, target in sorted(self.matching.pairs(kind), key=lambda pair: pair[1]):
                seen: set[str] = set()
                for field, before, after in self._of(kind, index, target):
                    if field not in seen:
                        seen.add(field)
                        note = str(after) if before is None and isinstance(after, str) else ""
                        names = (
                            named(self.matching.alone, kind, index),
                            named(self.matching.composed, kind, target),
                        )
                        yield Change(
                            "changed",
                            kind,
                            names[1],
                            field=field,
                            before=before,
                            after=None if note else after,
                            form=self._form(kind, target),
                            entry="",
                            index=(index, target),
                            name_before=names[0],
                            follows=follows(field),
                            note=note,
                        )

    def _of(self, kind: str, index: int, target: int) -> Iterator[tuple[str, Value, Value]]:
        gains = self._gains(index, target) if kind == "actuator" else None
        yield from gains or ()
        there = {name: array for name, array, _ in self._arrays(self.b, kind)}
        for name, array, treatment in self._arrays(self.a, kind):
            other = there.get(name)
            if other is None or (gains is not None and name in ("actuator_gainprm", "actuator_biasprm")):
                continue
            yield from self._row(name, treatment, array, theirs=other, index=index, target=target)
        if kind == "joint":
            yield from self._dofs(index, target)
        theirs = dict(runs(self.b, kind, target))
        for name, run in runs(self.a, kind, index):
            if name in theirs:
                yield from self._run(name, run, theirs[name])

    def _arrays(self, model: Model, kind: str) -> list[tuple[str, Array, Treatment]]:
        """Return the arrays with one row for each element that are compared as numbers."""
        key = (id(model), kind)
        if key not in self._known:
            found: list[tuple[str, Array, Treatment]] = []
            for name, array, how in arrays(model, kind):
                treatment: Treatment = how.treatment if how else Treatment.PLAIN
                if name in BEFORE_CONTROLS and not hasattr(model, "actuator_ctrladr"):
                    treatment = BEFORE_CONTROLS[name]
                if treatment not in (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA):
                    found.append((name, array, treatment))
            self._known[key] = found
        return self._known[key]

    def _row(
        self, name: str, treatment: Treatment, mine: Array, theirs: Array, index: int, target: int
    ) -> Iterator[tuple[str, Value, Value]]:
        if treatment is Treatment.USER:
            mine, theirs = same_width(mine, theirs)
        before, after = mine[index].tolist(), theirs[target].tolist()
        if before == after:
            return
        if treatment is Treatment.PRESENT:
            if (before == -1) != (after == -1):
                yield name, before != -1, after != -1
        elif name in ENUMS:
            yield name, self._word(name, before), self._word(name, after)
        elif name.partition("_")[2] in SWITCHES:
            yield name, bool(before), bool(after)
        else:
            yield from self._numbers(name, before, after)

    def _numbers(self, name: str, before: Any, after: Any) -> Iterator[tuple[str, Value, Value]]:
        ours, others = list(_flat(before)), list(_flat(after))
        different = [
            at for at, (x, y) in enumerate(zip(ours, others, strict=True)) if not close(x, y, self.tolerance)
        ]
        if not different:
            return
        if len(ours) <= _SHOWN:
            yield name, _value(before), _value(after)
            return
        for at in different[:_SHOWN]:
            yield f"{name}[{at}]", ours[at], others[at]

    def _dofs(self, index: int, target: int) -> Iterator[tuple[str, Value, Value]]:
        """Yield changes of arrays with a row for each degree of freedom.

        If all rows of a joint are equal, one number is shown.
        """
        if int(self.a.jnt_type[index]) != int(self.b.jnt_type[target]):
            return
        mine, theirs = span(self.a, "qvel", index), span(self.b, "qvel", target)
        there = {name: array for name, array, _ in self._arrays(self.b, DOF)}
        for name, array, _ in self._arrays(self.a, DOF):
            if name in there:
                before = array[mine].tolist()
                after = there[name][theirs].tolist()
                if before != after:
                    yield from self._numbers(name, _one(before), _one(after))

    def _run(self, name: str, mine: Array, theirs: Array) -> Iterator[tuple[str, Value, Value]]:
        if mine.shape == theirs.shape and bool((mine == theirs).all()):
            return  # the common case, and meshes have millions of numbers
        if name == "text_data":
            before, after = (
                bytes(run.tolist()).rstrip(b"\0").decode("utf-8", "replace") for run in (mine, theirs)
            )
            if before != after:
                yield name, before, after
        elif mine.shape != theirs.shape:
            if mine.size <= _SHOWN and theirs.size <= _SHOWN and not name.startswith(_SHAPES):
                yield name, _value(_one(mine.tolist())), _value(_one(theirs.tolist()))
            elif name not in _COUNTED:
                yield name, f"{len(mine)} rows", f"{len(theirs)} rows"
        elif mine.size <= _SHOWN and not name.startswith(_SHAPES):
            before, after = mine.tolist(), theirs.tolist()
            if before != after and name.endswith("limited"):
                yield name, bool(before[0]), bool(after[0])
            elif before != after:
                yield from self._numbers(name, _one(before), _one(after))
        else:
            pairs = zip(_flat(mine.tolist()), _flat(theirs.tolist()), strict=True)
            off = [abs(x - y) for x, y in pairs if not close(x, y, self.tolerance)]
            if off:
                yield name, None, f"{len(off)} of {mine.size} numbers differ, by up to {max(off):.3g}"

    def _gains(self, index: int, target: int) -> list[tuple[str, Value, Value]] | None:
        """Return gains by name, if both models have the actuator in the same form."""
        before, after = _servo(self.a, index), _servo(self.b, target)
        if before is None or after is None or before.keys() != after.keys():
            return None
        return [
            (name, value, after[name])
            for name, value in before.items()
            if not close(value, after[name], self.tolerance)
        ]

    def _form(self, kind: str, target: int) -> str:
        if kind == "joint":
            return JOINT_TYPES[int(self.b.jnt_type[target])].word
        return ""

    def _word(self, name: str, value: int) -> str:
        return words(self.mujoco, name).get(int(value), str(value))


def _servo(model: Model, index: int) -> dict[str, float] | None:
    """Return the gains of a motor or servo without other parameters, which describe it completely."""
    gain, bias = model.actuator_gainprm[index], model.actuator_biasprm[index]
    beside = bias if int(model.actuator_biastype[index]) == NO_BIAS else bias[3:]
    return None if gain[1:].any() or beside.any() else servo(model, index)


def _flat(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for each in value:
            yield from _flat(each)
    else:
        yield value


def _one(rows: list[Any]) -> Any:
    """Return a single row if all rows are equal."""
    return rows[0] if rows and all(row == rows[0] for row in rows) else rows


def _value(value: Any) -> Value:
    return tuple(_value(each) for each in value) if isinstance(value, list) else value
