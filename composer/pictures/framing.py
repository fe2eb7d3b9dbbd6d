"""Place the camera and lights for a model if no camera of its own is requested: all of it visible, and lit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

_MARGIN = 1.08
_ROUNDS = 4
_SHOWN_GROUPS = 3
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
# MuJoCo's default view: straight at one side, and steeply down.
_UNSAID = (90.0, -45.0)
_OBLIQUE = (135.0, -22.0)
_AMBIENT, _DIFFUSE, _SPECULAR = 0.3, 0.6, 0.3


def camera(mujoco: Any, scenes: Sequence[tuple[Any, Any]], aspect: float) -> Any:
    """Return the free camera that shows the whole of some models, each with its data.

    It looks in the direction of the first model's `azimuth` and `elevation` in `visual/global`, or obliquely if
    these are MuJoCo's defaults. `aspect` is the width of the picture divided by its height.
    """
    model = scenes[0][0]
    free = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, free)
    if (free.azimuth, free.elevation) == _UNSAID:
        free.azimuth, free.elevation = _OBLIQUE
    points = np.concatenate([corners(mujoco, *each) for each in scenes])
    if not len(points):
        return free
    azimuth, elevation = math.radians(free.azimuth), math.radians(free.elevation)
    forward = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.cos(elevation) * math.sin(azimuth),
            math.sin(elevation),
        ]
    )
    right = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    axes = np.stack([right, np.cross(right, forward), forward])
    high = math.tan(math.radians(_fovy(model)) / 2) / _MARGIN
    slopes = np.array([high * aspect, high])
    at, distance = (points.min(axis=0) + points.max(axis=0)) / 2, 0.0
    for _ in range(_ROUNDS):
        seen = (points - at) @ axes.T
        distance = float((np.abs(seen[:, :2]) / slopes - seen[:, 2:]).max())
        # Nearer things look larger: the middle of the picture is not the middle of the box.
        depth = np.maximum(seen[:, 2:] + distance, 1e-9)
        shown = seen[:, :2] / depth
        at = at + ((shown.min(axis=0) + shown.max(axis=0)) / 2 * distance) @ axes[:2]
    seen = (points - at) @ axes.T
    free.lookat[:] = at
    free.distance = max(float((np.abs(seen[:, :2]) / slopes - seen[:, 2:]).max()), 1e-6)
    return free


def corners(mujoco: Any, model: Any, data: Any) -> Any:
    """Return the corners of the boxes around all drawn geoms; the ground counts only if there is nothing else."""
    drawn = [each for each in range(model.ngeom) if _is_drawn(model, each)]
    plane, terrain = int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)
    solid = [each for each in drawn if int(model.geom_type[each]) not in (plane, terrain)]
    found = [np.zeros((0, 3))]
    for geom in solid or drawn:
        centre, half = model.geom_aabb[geom][:3], model.geom_aabb[geom][3:]
        if model.geom_type[geom] == plane:
            centre, half = np.zeros(3), np.array([*_bounded(model.geom_size[geom][:2]), 0.0])
        rotation = data.geom_xmat[geom].reshape(3, 3)
        found.append((centre + _CORNERS * half) @ rotation.T + data.geom_xpos[geom])
    if model.nflexvert:
        found.append(data.flexvert_xpos.reshape(-1, 3))
    if model.nskin:
        found.append(data.xpos[model.skin_bonebodyid])
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def _bounded(half: Any) -> Any:
    """Return half the size of a plane; an infinite one, with size 0, counts as 1."""
    return np.where(half > 0, half, 1.0)


def _is_drawn(model: Any, geom: int) -> bool:
    """Return whether MuJoCo draws the geom with the default groups."""
    material = int(model.geom_matid[geom])
    rgba = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    return int(model.geom_group[geom]) < _SHOWN_GROUPS and float(rgba[3]) > 0


def _fovy(model: Any) -> float:
    """Return the field of view of the free camera; for an orthographic one `fovy` is a length."""
    return 45.0 if model.vis.global_.orthographic else float(model.vis.global_.fovy)


@contextmanager
def prepared(mujoco: Any, model: Any, distance: float = 0.0) -> Iterator[None]:
    """Make a model visible from that distance for the block, and restore it afterwards."""
    headlight, limits, clip = model.vis.headlight, model.vis.global_, model.vis.map
    kept = (
        headlight.active, headlight.ambient.copy(), headlight.diffuse.copy(), headlight.specular.copy(),
        limits.orthographic, clip.zfar,
    )  # fmt: skip
    if not is_lit(model):
        headlight.active = headlight.active or 1
        headlight.ambient[:] = np.maximum(headlight.ambient, _AMBIENT)
        headlight.diffuse[:] = np.maximum(headlight.diffuse, _DIFFUSE)
        headlight.specular[:] = np.maximum(headlight.specular, _SPECULAR)
    limits.orthographic = 0
    clip.zfar = max(clip.zfar, 3 * distance / max(model.stat.extent, 1e-9))
    try:
        yield
    finally:
        headlight.active, limits.orthographic, clip.zfar = kept[0], kept[4], kept[5]
        headlight.ambient[:], headlight.diffuse[:], headlight.specular[:] = kept[1:4]


def is_lit(model: Any) -> bool:
    """Return whether a light of the model is on."""
    return any(
        model.light_active[each] and (model.light_diffuse[each].any() or model.light_ambient[each].any())
        for each in range(model.nlight)
    )


def has_sky(mujoco: Any, model: Any) -> bool:
    """Return whether the model has a skybox."""
    return bool((model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX).any())
