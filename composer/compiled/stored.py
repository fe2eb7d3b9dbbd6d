"""The file format for numbers that differ between worlds."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from composer.compiled.kinds import Model
from composer.compiled.varying import Numbers
from composer.compiled.whose import whose


def stored(model: Model, found: Iterable[tuple[str, Numbers, Numbers]]) -> dict[str, Numbers]:
    """Return the entries of an `.npz` file by key.

    For every array NAME there are `NAME/index`, the numbers' places in the flattened array, `(numbers,)`;
    `NAME/values`, `(worlds, numbers)`; and for readers `NAME/kind`, `NAME/element` and `NAME/attribute`,
    `(numbers,)`, with the owner of each number.
    """
    arrays: dict[str, Numbers] = {}
    for name, index, values in found:
        owners = whose(model, name, index)
        arrays |= {
            f"{name}/index": index,
            f"{name}/kind": np.array(owners[0].kind if owners else ""),
            f"{name}/element": np.array([each.element for each in owners], str),
            f"{name}/attribute": np.array([each.attribute for each in owners], str),
            f"{name}/values": values,
        }
    return arrays
