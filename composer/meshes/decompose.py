"""Convex pieces that are a mesh together, by CoACD."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.meshes.mesh import Mesh, UnusableError
from composer.meshes.shape import Hull, hull_of


def decompose(mesh: Mesh, wanted: Mapping[str, Any]) -> list[Hull]:
    """The pieces, in CoACD's order, which a seed decides."""
    import coacd
    from scipy.spatial import QhullError

    coacd.set_log_level("error")
    found = coacd.run_coacd(
        coacd.Mesh(mesh.vertices, mesh.faces),
        threshold=wanted["threshold"],
        max_convex_hull=-1 if wanted["parts"] is None else wanted["parts"],
        seed=wanted["seed"],
        decimate=True,
        max_ch_vertex=wanted["vertices"],
    )
    pieces = []
    for vertices, _ in found:
        try:
            pieces.append(hull_of(vertices))
        except QhullError:
            continue  # a sliver without volume, which touches nothing that its neighbours do not
    if not pieces:
        raise UnusableError("CoACD makes nothing of it")
    return pieces
