"""The files that the physics of a page needs, without visual meshes and textures."""

from __future__ import annotations

import os
import re
import shutil
import struct
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

import numpy as np

from mjcompose.mujoco.film import png

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
_TENT = {
    ".obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    ".stl": bytes(80)
    + struct.pack("<I", 4)
    + b"".join(struct.pack("<12fH", 0, 0, 0, *(number for k in each for number in _CORNERS[k]), 0) for each in _FACES),
}
_OF_BODIES = ("body_mass", "body_inertia", "body_ipos", "body_iquat")
_OF_MODEL = "body_invweight0 dof_M0 dof_invweight0 geom_fluid geom_bodyid geom_condim geom_friction qpos0".split()
_ROUNDS = 4
_SAME = 1e-11


def strip(mujoco: Any, asked: Mapping[str, Any]) -> str:
    """Write the model with tiny files instead of purely visual meshes and textures, and return the path of its MJCF.

    ``model`` is the path of the original, and ``out`` is a new folder. The physics stay the same: a body whose mass
    comes from such a mesh gets an `inertial`, meshes of colliding geoms stay, and all meshes stay if a sensor looks at
    geoms. Runs under `mjcompose.mujoco.engine.call`.
    """
    path = Path(asked["model"])
    spec = mujoco.MjSpec.from_file(str(path))
    model = spec.compile()
    if _looks_at_geoms(mujoco, model):
        return str(path)
    paired = {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
    of_mesh = _geoms_of_meshes(mujoco, model)
    kept: set[str] = set()
    bodies: dict[str, set[int]] = {}
    for mesh in spec.meshes:
        geoms = of_mesh.get(mesh.id, [])
        bodies.setdefault(mesh.file, set()).update(int(model.geom_bodyid[geom]) for geom in geoms)
        collides = any(model.geom_contype[geom] or model.geom_conaffinity[geom] or geom in paired for geom in geoms)
        if collides or not geoms or Path(mesh.file).suffix.lower() not in _TENT:
            kept.add(mesh.file)
    visual = sorted(name for name in bodies if name and name not in kept)
    files = {name: _TENT[Path(name).suffix.lower()] for name in visual}
    pixel = png(np.zeros((12, 12, 3), np.uint8))
    files |= {texture.file: pixel for texture in spec.textures if texture.file.lower().endswith(".png")}
    return str(_replaced(mujoco, path, model, files=files, bodies=bodies, out=Path(asked["out"])) or path)


def _looks_at_geoms(mujoco: Any, model: MjModel) -> bool:
    """Return whether a sensor sees the surfaces of geoms."""
    kinds = mujoco.mjtSensor
    seeing = {kinds.mjSENS_RANGEFINDER, kinds.mjSENS_GEOMDIST, kinds.mjSENS_GEOMNORMAL, kinds.mjSENS_GEOMFROMTO}
    geom = int(mujoco.mjtObj.mjOBJ_GEOM)
    if geom in (*model.sensor_objtype.tolist(), *model.sensor_reftype.tolist()):
        return True
    return any(int(kind) in seeing for kind in model.sensor_type)


def _geoms_of_meshes(mujoco: Any, model: MjModel) -> dict[int, list[int]]:
    """Return the geoms that have the shape of each mesh."""
    geoms: dict[int, list[int]] = {}
    for geom in np.flatnonzero(model.geom_dataid >= 0).tolist():
        if int(model.geom_type[geom]) == mujoco.mjtGeom.mjGEOM_MESH:
            geoms.setdefault(int(model.geom_dataid[geom]), []).append(geom)
    return geoms


def _replaced(
    mujoco: Any, path: Path, model: MjModel, files: dict[str, bytes], bodies: Mapping[str, Iterable[int]], out: Path
) -> Path | None:
    """Write the model with the files that do not change the physics; return None if there are none."""
    text = path.read_text(encoding="utf-8")
    weighed: set[int] = set()
    for number in range(_ROUNDS):
        tried = out / str(number) / path.name  # a new path, because MuJoCo keeps meshes by their path
        shutil.copytree(path.parent, tried.parent, copy_function=os.link)
        for name, content in [*files.items(), (path.name, _weighed(text, model, weighed).encode())]:
            (tried.parent / name).unlink()
            (tried.parent / name).write_bytes(content)
        try:
            now = mujoco.MjSpec.from_file(str(tried)).compile()
            changed = {body for name in _OF_BODIES for body in _differing(getattr(model, name), getattr(now, name))}
            if not changed and all(not _differing(getattr(model, name), getattr(now, name)) for name in _OF_MODEL):
                return tried
        except (ValueError, mujoco.FatalError):
            changed = set()
        lost = changed & weighed if changed else set(range(model.nbody))
        files = {name: content for name, content in files.items() if lost.isdisjoint(bodies.get(name, ()))}
        weighed = (weighed | changed) - lost
    return None


def _weighed(text: str, model: MjModel, bodies: Iterable[int]) -> str:
    """Return MJCF in which these bodies have the mass and inertia that their geoms give them."""
    for body in bodies:
        values = {"pos": model.body_ipos, "quat": model.body_iquat, "diaginertia": model.body_inertia}
        written = " ".join(f'{name}="{" ".join(map(repr, rows[body].tolist()))}"' for name, rows in values.items())
        name = re.escape(escape(model.body(body).name, {'"': "&quot;"}))
        inertial = f'<inertial mass="{float(model.body_mass[body])!r}" {written}/>'
        tag = re.search(f'<body\\b[^<>]*\\bname="{name}"[^<>]*(?<!/)>', text)
        text = text if tag is None else f"{text[: tag.end()]}{inertial}{text[tag.end() :]}"
    return text


def _differing(a: Any, b: Any) -> list[int]:
    """Return the rows that differ by more than the last digits."""
    if a.shape != b.shape:
        return [0]
    near = np.isclose(a, b, rtol=_SAME, atol=_SAME * np.abs(a).max(initial=0))
    found: list[int] = np.flatnonzero(~near.reshape(len(a), -1).all(axis=1)).tolist()
    return found
