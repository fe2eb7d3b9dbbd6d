"""The arrays of `mjModel` with one row for each element."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from functools import cache
from typing import cast

import numpy as np
from numpy.typing import NDArray

from composer.compiled.fields import Rule, Treatment, rule
from composer.compiled.kinds import KINDS, Model

Array = NDArray[np.generic]

DOF = "dof"
"""Not a kind of element: the rows belong to joints."""


@cache
def _arrays_of(model_type: Hashable) -> dict[str, tuple[str, ...]]:
    """Return the attributes of a class of models by the word they begin with: that of a kind, or ``dof``."""
    words = {kind.arrays: word for word, kind in KINDS.items()} | {DOF: DOF}
    found: dict[str, list[str]] = {}
    for attribute in sorted(dir(model_type)):
        word = words.get(attribute.split("_", 1)[0])
        if word is not None and not attribute.startswith("_"):
            found.setdefault(word, []).append(attribute)
    return {word: tuple(names) for word, names in found.items()}


def arrays(model: Model, kind: str) -> Iterator[tuple[str, Array, Rule | None]]:
    """Yield the arrays of one kind with one row for each element (or dof), sorted by name.

    The shapes are (n,) or (n, width). An array that happens to be as long as the number of elements is included:
    `fields` says how it is compared.
    """
    count = len(model.dof_bodyid) if kind == DOF else len(getattr(model, KINDS[kind].addresses))
    for name in _arrays_of(cast("Hashable", type(model))).get(kind, ()):
        array = getattr(model, name)
        if isinstance(array, np.ndarray) and array.ndim and array.shape[0] == count:
            yield name, array, rule(name)


def row_key(model: Model, kind: str, index: int) -> bytes:
    """Return the plain values of one element as bytes, without its place and references."""
    return b"".join(
        array[index].tobytes()
        for _, array, how in arrays(model, kind)
        if how is None or (kind == "body" and how.treatment is Treatment.HOST)
    )


def unequal(expected: Array, actual: Array, tolerance: float = 0.0) -> NDArray[np.bool_]:
    """Return where two arrays of one shape differ, bit for bit; zeros and NaNs are equal whatever their sign.

    ``tolerance`` is relative to the larger of 1 and the expected value.
    """
    different = expected != actual
    if different.any() and np.issubdtype(expected.dtype, np.floating):
        a, b = expected.astype(np.float64), actual.astype(np.float64)
        different &= ~(np.isnan(a) & np.isnan(b))
        if tolerance > 0:
            with np.errstate(invalid="ignore"):
                near = np.abs(a - b) <= tolerance * np.maximum(1.0, np.abs(a))
            different &= ~(near & np.isfinite(a))  # everything is near an infinite number
    return np.asarray(different, dtype=np.bool_)


def same_width(a: Array, b: Array) -> tuple[Array, Array]:
    """Return two tables, shape (n, width), with the narrower one padded with columns of zeros."""
    width = max(a.shape[1], b.shape[1])
    return _widened(a, width), _widened(b, width)


def _widened(array: Array, width: int) -> Array:
    return np.pad(array, ((0, 0), (0, width - array.shape[1])))
