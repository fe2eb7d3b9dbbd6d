"""Compare two compiled models by the table of arrays: element by element, or every attribute of `mjModel`.

The caller says which elements belong together, which differences are allowed, and how to report a difference. This
module finds the numbers that differ.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import dataclass
from mjcompose.mujoco.addresses import runs, span
from mjcompose.mujoco.arrays import Treatment, with_trait
from mjcompose.mujoco.attributes import KINDS, Model
from mjcompose.mujoco.match import Correspondence, Difference, Value
from mjcompose.mujoco.references import DOF, Array, arrays, same_width, unequal

Pairs = list[tuple[int, int]]
"""The ids of elements in both models."""
Run = tuple[Array, Array]
"""The data of an element in both models."""
_NOT_ROWS = (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA)


@dataclass(frozen=True, slots=True, eq=False)
class Unequal:
    """The numbers of an array that differ for one element: in its own row, or in several rows.

    ``expected`` are the numbers in the first model as they should be in the second, ``actual`` those in the second.
    ``different`` says where they differ, or is None if the element has another number of rows there.
    """

    kind: str
    index: int
    target: int
    array: str
    treatment: Treatment
    expected: Array
    actual: Array
    different: NDArray[np.bool_] | None


class Rules:
    """The allowed differences: none, bit for bit. Other rules override this."""

    def ignores(self, kind: str, array: str, index: int) -> bool:
        """Return whether an array says nothing of this element of the first model."""
        return False

    def expected(self, array: str, pairs: Pairs, mine: Array, theirs: Array) -> Array:
        """Return the rows of elements as they should be in the second model, which has the array ``theirs``."""
        return mine

    def bound(self, treatment: Treatment) -> float:
        """Return how far numbers may be apart, relative to the larger of 1 and the number."""
        return 0.0

    def excuses(self, treatment: Treatment, kind: str, array: str, pair: tuple[int, int]) -> bool:
        """Return whether a difference in a row follows from the second model itself."""
        return False

    def run(self, kind: str, array: str, index: int, run: Run) -> tuple[*Run, float] | None:
        """Return the data of an element that must be equal, and how far apart it may be; None if it need not be."""
        return *run, 0.0


def unequal_elements(matching: Correspondence, rules: Rules) -> Iterator[Unequal]:
    """Yield where elements that both models have differ: array by array, kind by kind, but not in references and keys.

    The rows of degrees of freedom belong to a joint and come last.
    """
    for kind in KINDS:
        if kind != "key":
            pairs = matching.pairs(kind)
            rows = [[i for i, _ in pairs], [j for _, j in pairs]]
            yield from _unequal_rows(matching, rules, kind, pairs=pairs, rows=rows)
            yield from _unequal_runs(matching, rules, kind)
    alone, composed = matching.alone.model, matching.composed.model
    pairs, rows = [], [[], []]
    for index, target in matching.pairs("joint"):
        if int(alone.jnt_type[index]) == int(composed.jnt_type[target]):
            rows[0] += (own := span(alone, "qvel", index))
            rows[1] += span(composed, "qvel", target)
            pairs += [(index, target)] * len(own)
    yield from _unequal_rows(matching, rules, DOF, pairs=pairs, rows=rows)


def _unequal_rows(
    matching: Correspondence, rules: Rules, group: str, pairs: Pairs, rows: list[list[int]]
) -> Iterator[Unequal]:
    """Compare the arrays of a group at these rows of both models, each of which is of one of the pairs."""
    kind = "joint" if group == DOF else group
    if not pairs:
        return
    starts = [at for at, pair in enumerate(pairs) if not at or pair != pairs[at - 1]]
    composed = {name: array for name, array, _ in arrays(matching.composed.model, group)}
    for name, array, treatment in arrays(matching.alone.model, group):
        if treatment in _NOT_ROWS or name not in composed:
            continue
        theirs = composed[name]
        expected, actual = rules.expected(name, pairs, mine=array[rows[0]], theirs=theirs), theirs[rows[1]]
        if treatment is Treatment.PRESENT:
            expected, actual = np.not_equal(expected, -1), np.not_equal(actual, -1)
        elif treatment is Treatment.USER:
            expected, actual = same_width(expected, actual)
        if not expected.size:
            continue
        different = unequal(expected, actual, rules.bound(treatment))
        wrong = np.flatnonzero(different.reshape(len(expected), -1).any(axis=1))
        for at in sorted({bisect_right(starts, row) - 1 for row in wrong.tolist()}):
            pair, first = pairs[starts[at]], starts[at]
            if rules.ignores(kind, name, pair[0]) or rules.excuses(treatment, kind, name, pair=pair):
                continue
            end = starts[at + 1] if at + 1 < len(starts) else len(pairs)
            own: Any = slice(first, end) if group == DOF else first
            yield Unequal(
                kind, *pair, array=name, treatment=treatment, expected=expected[own], actual=actual[own],
                different=different[own],
            )  # fmt: skip


def _unequal_runs(matching: Correspondence, rules: Rules, kind: str) -> Iterator[Unequal]:
    for index, target in matching.pairs(kind):
        theirs = dict(runs(matching.composed.model, kind, target))
        for name, mine in runs(matching.alone.model, kind, index):
            other = theirs.get(name)
            if other is None or rules.ignores(kind, name, index):
                continue
            different = None
            if mine.shape == other.shape:
                compared = rules.run(kind, name, index, run=(mine, other))
                if compared is None:
                    continue
                mine, other, bound = compared
                different = unequal(mine, other, bound)
                if not different.any():
                    continue
            yield Unequal(
                kind, index, target, array=name, treatment=Treatment.DATA, expected=mine, actual=other,
                different=different,
            )  # fmt: skip


_VISUAL = ("global_", "quality", "headlight", "map", "scale", "rgba")
_OF_THE_PLACE = with_trait("path") | {"paths", "npaths", "nbuffer"}
"""File paths at compilation, and the memory for them, which are not part of the model itself."""


def unequal_attributes(a: Model, b: Model) -> Iterator[tuple[str, Any, Any]]:
    """Yield the attributes of `mjModel` that differ, including `opt.timestep` and the like, with both values.

    NaN equals NaN. Both models must come from the same MuJoCo: an attribute that only the first one has counts as
    different, and is None in the second.
    """
    yield from _unequal("", a, b)
    yield from _unequal("opt.", a.opt, b.opt)
    for group in sorted(_VISUAL):
        yield from _unequal(f"vis.{group}.", getattr(a.vis, group), getattr(b.vis, group))
    yield from _unequal("stat.", a.stat, b.stat)


def _unequal(prefix: str, mine: Any, theirs: Any) -> Iterator[tuple[str, Any, Any]]:
    for name in dir(mine):
        value = None if name.startswith("_") or name in _OF_THE_PLACE else getattr(mine, name)
        if isinstance(value, int | float | str | bytes | np.ndarray):
            other = getattr(theirs, name, None)
            if _differ(value, other):
                yield prefix + name, value, other


def _differ(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape != b.shape or bool(unequal(a, b).any())
    return bool(a != b) and bool(a == a or b == b)


def option_differences(alone: Model, composed: Model) -> list[Difference]:
    """Return the settings of `opt` and `vis` in which a composition differs from a part alone, bit for bit.

    A part is not changed if these differ, but its author wrote them for a reason.
    """
    found = _settings("option", alone.opt, composed.opt)
    for group in _VISUAL:
        kind = f"visual/{group.rstrip('_')}"
        found += _settings(kind, getattr(alone.vis, group), getattr(composed.vis, group))
    return found


def statistic_differences(alone: Model, composed: Model) -> list[Difference]:
    """Return the numbers of `stat` that differ, written or computed."""
    return _settings("statistic", alone.stat, composed.stat)


def _settings(kind: str, mine: Any, theirs: Any) -> list[Difference]:
    return [
        Difference(kind, name, "value", expected=plain_value(before), actual=plain_value(after))
        for name, before, after in _unequal("", mine, theirs)
    ]


def plain_value(numbers: Any) -> Value:
    """Return an array as nested tuples of numbers."""
    array = np.asarray(numbers)
    return tuple(map(plain_value, array)) if array.ndim else array.item()
