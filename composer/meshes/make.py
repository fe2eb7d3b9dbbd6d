"""What is asked of one mesh, done in the child process; the answer is JSON data."""

from __future__ import annotations

from importlib import metadata
from typing import Any

NEEDS = {
    "hull": ("trimesh", "scipy", "rtree"),
    "fit": ("trimesh", "scipy", "rtree"),
    "decompose": ("trimesh", "scipy", "rtree", "coacd"),
    "spheres": ("trimesh", "scipy", "rtree"),
    "simplify": ("trimesh", "scipy", "rtree", "fast-simplification"),
}
"""The distributions that each method imports."""


def make(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """For `composer.engine.call`: what comes of a mesh.

    The argument has the attributes of the `mesh`, the `method`, what is `wanted` of it, and `most_faces`. The answer
    has `missing` where a package is not installed, `unusable` where nothing can be made of the mesh, and otherwise what
    `composer.compose.shape_store` keeps.
    """
    method, wanted = argument["method"], argument["wanted"]
    versions = {}
    for name in NEEDS[method]:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            return {"missing": name}
    from composer.meshes.mesh import UnusableError, check_thick, read_mesh

    try:
        mesh = read_mesh(mujoco, argument["mesh"], argument["most_faces"])
        if method != "simplify":
            check_thick(mesh)
        return {
            **_made(mesh, method, wanted),
            "mesh": {
                "faces": len(mesh.faces),
                "closed": mesh.is_closed,
                "size": float(f"{mesh.size:.4g}"),
                "mapped": mesh.is_mapped,
            },
            "made_with": {name: versions[name] for name in sorted(versions)},
        }
    except UnusableError as error:
        return {"unusable": str(error), "limit": error.limit}


def _made(mesh: Any, method: str, wanted: Any) -> dict[str, Any]:
    from composer.meshes.measure import measure_surfaces, measured
    from composer.meshes.shape import Hull, hull_of

    if method == "simplify":
        from composer.meshes.simplify import simplify

        smaller = simplify(mesh, wanted["faces"])
        found = Hull(smaller.vertices, smaller.faces)
        return {"shapes": [found.to_data()], "error": _digits(measure_surfaces(mesh, smaller))}
    if method == "hull":
        shapes: list[Any] = [hull_of(mesh.vertices, wanted["vertices"])]
    elif method == "fit":
        from composer.meshes.fit import fit

        shapes = [fit(mesh, wanted)]
    elif method == "decompose":
        from composer.meshes.decompose import decompose

        shapes = list(decompose(mesh, wanted))
    else:
        from composer.meshes.spheres import spheres

        shapes = list(spheres(mesh, wanted))
    return {"shapes": [shape.to_data() for shape in shapes], "error": _digits(measured(mesh, shapes))}


def _digits(error: dict[str, Any]) -> dict[str, Any]:
    """Four digits, so that they are the same on other machines."""
    return {
        name: float(f"{value:.4g}") if isinstance(value, float) else value for name, value in error.items()
    }
