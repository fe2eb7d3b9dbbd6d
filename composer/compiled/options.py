"""Compare the settings that a composition has once for all its parts: `option` and `visual`.

A part is not changed if these differ, but its author wrote them for a reason. Statistics are separate: the compiled
model does not distinguish a written `extent` from a computed one.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from composer.compiled.difference import Difference, Value
from composer.compiled.kinds import Model
from composer.compiled.rows import unequal

_VISUAL = ("global_", "quality", "headlight", "map", "scale", "rgba")


def option_differences(alone: Model, composed: Model) -> list[Difference]:
    """Return the settings of `opt` and `vis` in which a composition differs from a part alone, bit for bit."""
    found = _differing("option", alone.opt, composed.opt)
    for group in _VISUAL:
        found += _differing(
            f"visual/{group.rstrip('_')}", getattr(alone.vis, group), getattr(composed.vis, group)
        )
    return found


def statistic_differences(alone: Model, composed: Model) -> list[Difference]:
    """Return the numbers of `stat` that differ, written or computed."""
    return _differing("statistic", alone.stat, composed.stat)


def _differing(kind: str, mine: object, theirs: object) -> list[Difference]:
    return [
        Difference(kind, name, "value", expected=_value(a), actual=_value(b))
        for name, a in _settings(mine)
        if unequal(a, b := np.asarray(getattr(theirs, name, np.nan))).any()
    ]


def _settings(group: object) -> Iterator[tuple[str, np.ndarray]]:
    for name in dir(group):
        value = None if name.startswith("_") else getattr(group, name)
        if isinstance(value, (int, float, np.ndarray)):
            yield name, np.asarray(value)


def _value(array: np.ndarray) -> Value:
    return tuple(_value(item) for item in array) if array.ndim else array.item()
