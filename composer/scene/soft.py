"""Skins, flexes and tendons: everything that is not rigid."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.scene.blobs import Blobs, packed, short


def skins(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each skin: its bones, and bytes with vertices, triangles, and for each bone its vertices and weights."""
    return [_skin(model, number, blobs) for number in range(model.nskin)]


def _skin(model: Any, number: int, blobs: Blobs) -> dict[str, Any]:
    def rows(values: Any, first: Any, count: Any, at: int = number) -> Any:
        return values[int(first[at]) : int(first[at]) + int(count[at])]

    corners = rows(model.skin_vert, model.skin_vertadr, model.skin_vertnum)
    faces = rows(model.skin_face, model.skin_faceadr, model.skin_facenum)
    mapped = bool(model.skin_texcoordadr[number] >= 0)
    first, count = int(model.skin_boneadr[number]), int(model.skin_bonenum[number])
    bones = range(first, first + count)
    moved = [
        rows(model.skin_bonevertid, model.skin_bonevertadr, model.skin_bonevertnum, at=bone) for bone in bones
    ]
    weights = [
        rows(model.skin_bonevertweight, model.skin_bonevertadr, model.skin_bonevertnum, at=bone)
        for bone in bones
    ]
    flat = (
        rows(model.skin_texcoord, model.skin_texcoordadr, model.skin_vertnum) if mapped else np.zeros((0, 2))
    )
    arrays = [
        corners.astype(np.float32), faces.astype(np.uint32), flat.astype(np.float32),
        np.concatenate([*moved, np.zeros(0)]).astype(np.uint32),
        np.concatenate([*weights, np.zeros(0)]).astype(np.float32),
    ]  # fmt: skip
    return {
        "blob": blobs.put("skin 1", arrays, lambda: packed(*arrays)), "count": len(corners), "triangles": len(faces),
        "mapped": mapped, "material": int(model.skin_matid[number]), "rgba": short(model.skin_rgba[number]),
        "group": int(model.skin_group[number]), "inflate": float(model.skin_inflate[number]),
        "bones": short(model.skin_bonebodyid[first : first + count]), "moved": [len(each) for each in moved],
        "pos": short(model.skin_bonebindpos[first : first + count]),
        "quat": short(model.skin_bonebindquat[first : first + count]),
    }  # fmt: skip


def flexes(model: Any, data: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each flex at rest: its vertices in the frames of their bodies, and the drawn parts.

    `shell` are triangles: the elements of a two-dimensional flex, the surface of a three-dimensional one. A
    one-dimensional flex has only `edges`. `nodes` are the bodies of a flex that MuJoCo interpolates; it is drawn at
    rest.
    """
    return [_flex(model, data, number, blobs=blobs) for number in range(model.nflex)]


def _flex(model: Any, data: Any, number: int, blobs: Blobs) -> dict[str, Any]:
    def rows(values: Any, first: Any, count: Any) -> Any:
        return values[int(first[number]) : int(first[number]) + int(count[number])]

    dimensions = int(model.flex_dim[number])
    world = rows(data.flexvert_xpos.reshape(-1, 3), model.flex_vertadr, model.flex_vertnum)
    bodies = rows(model.flex_vertbodyid, model.flex_vertadr, model.flex_vertnum)
    interpolated = bool(model.flex_interp[number]) or bool((bodies < 0).any())
    bodies = np.zeros_like(bodies) if interpolated else bodies
    turned = data.xmat[bodies].reshape(-1, 3, 3)
    local = np.einsum("nji,nj->ni", turned, world - data.xpos[bodies])
    edges = rows(model.flex_edge, model.flex_edgeadr, model.flex_edgenum)
    elements = model.flex_elem[int(model.flex_elemdataadr[number]) :][
        : int(model.flex_elemnum[number]) * (dimensions + 1)
    ]
    if dimensions == 3:
        shell = model.flex_shell[int(model.flex_shelldataadr[number]) :][
            : int(model.flex_shellnum[number]) * 3
        ]
    else:
        shell = elements if dimensions == 2 else np.zeros(0)
    arrays = [
        local.astype(np.float32), bodies.astype(np.uint32), np.asarray(shell).astype(np.uint32), edges.astype(np.uint32)
    ]  # fmt: skip
    return {
        "blob": blobs.put("flex 1", arrays, lambda: packed(*arrays)), "count": len(world), "dimensions": dimensions,
        "triangles": len(arrays[2]) // 3, "edges": len(edges), "radius": float(model.flex_radius[number]),
        "material": int(model.flex_matid[number]), "rgba": short(model.flex_rgba[number]),
        "group": int(model.flex_group[number]),
    }  # fmt: skip


def wraps(model: Any) -> dict[str, list[Any]]:
    """Return the path of spatial tendons: sites, geoms, pulleys and joints, and their parameters."""
    return {
        "type": short(model.wrap_type), "object": short(model.wrap_objid),
        "parameter": [float(each) for each in model.wrap_prm],
    }  # fmt: skip
