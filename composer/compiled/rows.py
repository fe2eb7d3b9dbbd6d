"""The arrays of `mjModel` that hold one row an element."""

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
"""Not a kind of element of its own: the rows belong to joints."""


@cache
def _arrays_of(model_type: Hashable) -> dict[str, tuple[str, ...]]:
    """The attributes of a class of models by the word they begin with: that of a kind, or ``dof``."""
    words = {kind.arrays: word for word, kind in KINDS.items()} | {DOF: DOF}
    found: dict[str, list[str]] = {}
    for attribute in sorted(dir(model_type)):
        word = words.get(attribute.split("_", 1)[0])
        if word is not None and not attribute.startswith("_"):
            found.setdefault(word, []).append(attribute)
    return {word: tuple(names) for word, names in found.items()}


def arrays(model: Model, kind: str) -> Iterator[tuple[str, Array, Rule | None]]:
    """The arrays of one kind with one row an element (or a dof), shape (n,) or (n, width), in order of their names.

    An array that happens to be as long as there are elements is one of them, too: `fields` says how it is compared.
    """
    count = len(model.dof_bodyid) if kind == DOF else len(getattr(model, KINDS[kind].addresses))
    for name in _arrays_of(cast("Hashable", type(model))).get(kind, ()):
        array = getattr(model, name)
        if isinstance(array, np.ndarray) and array.ndim and array.shape[0] == count:
            yield name, array, rule(name)


def row_key(model: Model, kind: str, index: int) -> bytes:
    """The plain values of one element as bytes: neither where it stands nor what it refers to."""
    return b"".join(
        array[index].tobytes()
        for _, array, how in arrays(model, kind)
        if how is None or (kind == "body" and how.treatment is Treatment.HOST)
    )


def unequal(expected: Array, actual: Array, tolerance: float = 0.0) -> NDArray[np.bool_]:
    """Where two arrays of one shape differ: bit for bit, but zeros and NaNs are equal whatever their sign.

    ``tolerance`` is relative to the larger of 1 and the expected value.
    """
    different = expected != actual
    if np.issubdtype(expected.dtype, np.floating):
        a, b = expected.astype(np.float64), actual.astype(np.float64)
        different &= ~(np.isnan(a) & np.isnan(b))
        if tolerance > 0:
            with np.errstate(invalid="ignore"):
                different &= ~(np.abs(a - b) <= tolerance * np.maximum(1.0, np.abs(a)))
    return np.asarray(different, dtype=np.bool_)


def same_width(a: Array, b: Array) -> tuple[Array, Array]:
    """Two tables, shape (n, width), the narrower filled up with columns of zeros."""
    width = max(a.shape[1], b.shape[1])
    return _widened(a, width), _widened(b, width)


def _widened(array: Array, width: int) -> Array:
    return np.pad(array, ((0, 0), (0, width - array.shape[1])))
