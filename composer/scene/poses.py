"""Contacts and tendon paths at the start and at each keyframe, which a page cannot compute itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.compiled.placed import place
from composer.scene.blobs import short

_MOST_CONTACTS = 500
# The value of `wrap_obj` for a pulley, which cuts a tendon's path.
_PULLEY = -2


def poses(mujoco: Any, model: Any, data: Any) -> Iterator[dict[str, Any]]:
    """Yield contacts and tendon paths at the reference configuration, then at each keyframe.

    `data` is at the reference configuration again afterwards.
    """
    for key in (None, *range(model.nkey)):
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        place(mujoco, model, data)
        yield {"contacts": contacts(data), "tendons": _ways(data)}
    mujoco.mj_resetData(model, data)
    place(mujoco, model, data)


def contacts(data: Any) -> list[list[Any]]:
    """Return each contact: its two geoms, its position and its normal; a flex is geom -1."""
    shown = min(int(data.ncon), _MOST_CONTACTS)
    return [
        [*(int(geom) for geom in each.geom), *short(each.pos), *short(each.frame[:3])]
        for each in (data.contact[number] for number in range(shown))
    ]


def _ways(data: Any) -> list[list[float]]:
    """Return the straight segments of each tendon, from and to: six numbers each."""
    points, objects = data.wrap_xpos.reshape(-1, 3), data.wrap_obj.ravel()
    found = []
    for first, count in zip(data.ten_wrapadr, data.ten_wrapnum, strict=True):
        ends = [
            [*short(points[at]), *short(points[at + 1])]
            for at in range(int(first), int(first) + int(count) - 1)
            if objects[at] != _PULLEY and objects[at + 1] != _PULLEY
        ]
        found.append([number for end in ends for number in end])
    return found
