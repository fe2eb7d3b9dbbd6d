"""The arrays of `mjModel` that hold one row an element."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np
from numpy.typing import NDArray

from composer.verify.fields import Rule, Treatment, rule
from composer.verify.roster import KINDS, Model

Array = NDArray[np.generic]

DOF = "dof"
"""Not a kind of element of its own: the rows belong to joints."""


@cache
def _arrays_of(model_type: type) -> dict[str, tuple[str, ...]]:
    """The attributes of the model class by the word they begin with, which is that of a kind, or ``dof``."""
    words = {kind.arrays: word for word, kind in KINDS.items()} | {DOF: DOF}
    found: dict[str, list[str]] = {}
    for attribute in sorted(dir(model_type)):
        word = words.get(attribute.split("_", 1)[0])
        if word is not None and not attribute.startswith("_"):
            found.setdefault(word, []).append(attribute)
    return {word: tuple(names) for word, names in found.items()}


def arrays(model: Model, kind: str) -> Iterator[tuple[str, Array, Rule | None]]:
    """The arrays of one kind with one row an element (or a dof), in order of their names."""
    count = len(model.dof_bodyid) if kind == DOF else len(getattr(model, KINDS[kind].addresses))
    for name in _arrays_of(type(model)).get(kind, ()):
        array = getattr(model, name)
        if isinstance(array, np.ndarray) and array.ndim and array.shape[0] == count:
            yield name, array, rule(name)


def row_key(model: Model, kind: str, index: int) -> bytes:
    """The plain values of one element as bytes: equal for elements that differ only in place and references."""
    plain = (array for _, array, how in arrays(model, kind) if how is None)
    inertial = (Treatment.HOST,) if kind == "body" else ()
    own = (array for _, array, how in arrays(model, kind) if how is not None and how.treatment in inertial)
    return b"".join(array[index].tobytes() for group in (plain, own) for array in group)


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
