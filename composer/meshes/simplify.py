"""A mesh with fewer faces, by fast-simplification."""

from __future__ import annotations

from collections.abc import Iterator

import numpy

from composer.meshes.mesh import Mesh, UnusableError

_BOLDNESS = (2, 3, 4, 5, 6, 7)
"""How much an edge may be off to be taken away, by fast-simplification's measure: the careful ones first."""
_PASSES = 3


def simplify(mesh: Mesh, faces: int) -> Mesh:
    """The mesh with so many faces at most; itself where it has no more. Raises UnusableError."""
    if len(mesh.faces) <= faces:
        return mesh
    fewest = len(mesh.faces)
    for found in _tries(mesh, faces):
        # What was closed and has a hole now was torn.
        if len(found.faces) and (found.is_closed or not mesh.is_closed):
            fewest = min(fewest, len(found.faces))
            if 4 <= len(found.faces) <= faces:
                return found
    raise UnusableError(
        f"it cannot be simplified to {faces} faces without being torn: {fewest} is the fewest"
    )


def _tries(mesh: Mesh, faces: int) -> Iterator[Mesh]:
    import fast_simplification
    import trimesh

    for boldness in _BOLDNESS:
        found = mesh
        for _ in range(_PASSES):
            if len(found.faces) <= faces:
                break
            points, triangles = fast_simplification.simplify(
                found.vertices.astype(numpy.float32),
                found.faces.astype(numpy.int32),
                target_count=faces,
                agg=boldness,
            )[:2]
            solid = trimesh.Trimesh(points, triangles, process=True)
            solid.update_faces(solid.nondegenerate_faces())
            solid.remove_unreferenced_vertices()
            found = Mesh(numpy.asarray(solid.vertices), numpy.asarray(solid.faces), solid)
            yield found
