"""The subject of a picture: the points to show, parts moved apart, and names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from mjcompose.mujoco.attributes import names
from mjcompose.mujoco.solids import SIGNS, box_corners

Link = tuple[Any, Any]
_NEAR = 0.1  # how much of the model is around a point
_APART = 0.5  # how far parts move, as a share of their size
_INK, _WIDTH = (0.96, 0.6, 0.1, 1.0), 2.0
_PLACES = {"site": "site_xpos", "body": "xpos", "joint": "xanchor", "geom": "geom_xpos"}
_SHOWN_GROUPS = 3


def corners(mujoco: Any, model: Any, data: Any, some: Sequence[int] | None = None) -> Any:
    """Return the corners of the boxes around all drawn geoms, or `some`; the ground counts only if all are ground."""
    drawn = [each for each in range(model.ngeom) if _is_drawn(model, each)] if some is None else some
    plane, terrain = int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)
    solid = [each for each in drawn if int(model.geom_type[each]) not in (plane, terrain)]
    found = [np.zeros((0, 3))]
    for geom in solid or drawn:
        center, half = model.geom_aabb[geom][:3], model.geom_aabb[geom][3:]
        if model.geom_type[geom] == plane:
            half = model.geom_size[geom][:2]  # 0 for infinite, which counts as 1
            center, half = np.zeros(3), np.array([*np.where(half > 0, half, 1.0), 0.0])
        found.append(box_corners(data, geom, center=center, half=half))
    if model.nflexvert and some is None:
        found.append(data.flexvert_xpos.reshape(-1, 3))
    if model.nskin and some is None:
        found.append(data.xpos[model.skin_bonebodyid])
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def _is_drawn(model: Any, geom: int) -> bool:
    material = int(model.geom_matid[geom])
    rgba = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    return int(model.geom_group[geom]) < _SHOWN_GROUPS and float(rgba[3]) > 0


def points_of(mujoco: Any, model: Any, data: Any, kind: str, name: str) -> Any:
    """Return the points around an element, for a camera; for a body also around the bodies on it."""
    at = names(model, kind).index(name)
    body = (
        at
        if kind == "body"
        else int(getattr(model, {"joint": "jnt", "geom": "geom", "site": "site"}[kind] + "_bodyid")[at])
    )
    if kind in ("body", "joint"):
        geoms = [geom for geom in range(model.ngeom) if body in _above(model, int(model.geom_bodyid[geom]))]
    else:
        geoms = [at] if kind == "geom" else []
    found = corners(mujoco, model, data, some=geoms) if geoms else np.zeros((0, 3))
    if len(found):
        return found
    whole = corners(mujoco, model, data)
    place, reach = (
        getattr(data, _PLACES[kind])[at],
        _NEAR * float(np.ptp(whole, axis=0).max(initial=0) if len(whole) else 1),
    )
    return place + reach * np.array(SIGNS)


def _above(model: Any, body: int) -> list[int]:
    """Return a body and all bodies that it is on."""
    found = [body]
    while body:
        body = int(model.body_parentid[body])
        found.append(body)
    return found


def explode(mujoco: Any, model: Any, data: Any) -> list[Link]:
    """Move the drawn parts of a model apart, and return the ends of lines to where they belong.

    A part is the bodies with one prefix, or a body if there are no prefixes. It moves away from the part that it is on.
    """
    called = names(model, "body")
    prefixes = [name.rpartition("/")[0] for name in called]
    is_whole = not any(prefixes)
    first = list(range(model.nbody))  # of each body, the first body of its part
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        if not is_whole and prefixes[body] == prefixes[parent] and parent:
            first[body] = first[parent]
    boxes: dict[int, tuple[Any, float]] = {}
    for part in sorted(set(first)):
        geoms = [geom for geom in range(model.ngeom) if first[int(model.geom_bodyid[geom])] == part]
        points = corners(mujoco, model, data, some=geoms) if geoms else data.xpos[part][None]
        low, high = points.min(axis=0), points.max(axis=0)
        boxes[part] = (low + high) / 2, float(np.linalg.norm(high - low))
    middle = np.mean([center for part, (center, _) in boxes.items() if part], axis=0) if len(boxes) > 1 else np.zeros(3)
    moved, links, before = np.zeros((model.nbody, 3)), [], data.xpos.copy()
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        moved[body] = moved[parent]
        if first[body] == body:
            center, size = boxes[body]
            away = center - (boxes[first[parent]][0] if first[parent] else middle)
            away[2] = max(away[2], 0) if not first[parent] else away[2]  # nothing goes below the ground
            length = float(np.linalg.norm(away))
            on = max(size, boxes[first[parent]][1] if first[parent] else 0)
            moved[body] += _APART * on * (away / length if length > 1e-6 else np.array([0, 0, 1.0]))
            if first[parent]:
                links.append((before[body] + moved[parent], before[body] + moved[body]))
    for array, bodies in (
        ("xpos", np.arange(model.nbody)), ("xipos", np.arange(model.nbody)), ("geom_xpos", model.geom_bodyid),
        ("site_xpos", model.site_bodyid), ("xanchor", model.jnt_bodyid), ("cam_xpos", model.cam_bodyid),
    ):  # fmt: skip
        getattr(data, array)[:] += moved[bodies]
    if model.nflexvert:
        data.flexvert_xpos[:] += moved[np.maximum(model.flex_vertbodyid, 0)]
    return links


def decorate(mujoco: Any, model: Any, data: Any, scene: Any, links: Iterable[Link], labels: Iterable[str]) -> None:
    """Add lines, and the names of elements of some kinds, to a scene."""
    kinds = mujoco.mjtGeom
    for start, end in links:
        if (geom := _new(mujoco, scene, kinds.mjGEOM_LINE)) is not None:
            mujoco.mjv_connector(geom, kinds.mjGEOM_LINE, _WIDTH, start, end)
    for kind in labels:
        for name, place in zip(names(model, kind), getattr(data, _PLACES[kind]), strict=True):
            if name not in ("", "world") and (geom := _new(mujoco, scene, kinds.mjGEOM_LABEL)) is not None:
                geom.pos[:], geom.label = place, name


def _new(mujoco: Any, scene: Any, kind: Any) -> Any:
    if scene.ngeom >= scene.maxgeom:
        return None
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(_INK, np.float32))
    geom.category = mujoco.mjtCatBit.mjCAT_DECOR
    scene.ngeom += 1
    return geom
