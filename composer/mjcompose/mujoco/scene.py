"""A compiled model as data for a page in the browser."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mjcompose.mujoco.attributes import NameTable, names, place
from mjcompose.mujoco.film import png
from mjcompose.mujoco.mesh_bytes import encoded

_DIGITS = 24


class Blobs:
    """Writes each content once to a file of `folder`, named by its hash; those in `known` are not even encoded."""

    def __init__(self, folder: Path, known: Collection[str] = ()) -> None:
        self.folder, self.known = folder, set(known)
        self.used: dict[str, None] = {}

    def put(self, form: str, arrays: Iterable[Any], encode: Callable[[], bytes]) -> str:
        """Return the hash of some arrays in the format `form`; `encode` returns their bytes if they are new."""
        digest = hashlib.sha256(form.encode())
        for each in arrays:
            array = np.ascontiguousarray(each)
            digest.update(f"{array.dtype}{array.shape}".encode())
            digest.update(array.data)
        name = digest.hexdigest()[:_DIGITS]
        if name not in self.used and name not in self.known:
            (self.folder / name).write_bytes(encode())
        self.used[name] = None
        return name


def packed(*arrays: Any) -> bytes:
    """Concatenate arrays, each padded so that the next one begins at a multiple of four bytes."""
    found = bytearray()
    for each in arrays:
        found += np.ascontiguousarray(each).tobytes()
        found += bytes(-len(found) % 4)
    return bytes(found)


def short(values: Any) -> list[Any]:
    """Return numbers with nine digits, which is all that single precision has, as a flat list."""
    flat = np.asarray(values).ravel()
    if flat.dtype.kind != "f":
        return flat.astype(int).tolist() if flat.dtype.kind == "b" else flat.tolist()
    return [float(f"{each:.9g}") for each in flat.tolist()]


COLUMNS: dict[str, dict[str, str]] = {
    "body": {
        "parent": "body_parentid", "pos": "body_pos", "quat": "body_quat", "mass": "body_mass",
        "inertia": "body_inertia", "ipos": "body_ipos", "iquat": "body_iquat", "mocap": "body_mocapid",
    },
    "joint": {
        "body": "jnt_bodyid", "type": "jnt_type", "pos": "jnt_pos", "axis": "jnt_axis", "range": "jnt_range",
        "limited": "jnt_limited", "qpos": "jnt_qposadr", "group": "jnt_group",
    },
    "geom": {
        "body": "geom_bodyid", "type": "geom_type", "pos": "geom_pos", "quat": "geom_quat", "size": "geom_size",
        "data": "geom_dataid", "material": "geom_matid", "rgba": "geom_rgba", "group": "geom_group",
        "contype": "geom_contype", "conaffinity": "geom_conaffinity",
    },
    "site": {
        "body": "site_bodyid", "type": "site_type", "pos": "site_pos", "quat": "site_quat", "size": "site_size",
        "material": "site_matid", "rgba": "site_rgba", "group": "site_group",
    },
    "camera": {
        "body": "cam_bodyid", "mode": "cam_mode", "target": "cam_targetbodyid", "pos": "cam_pos", "quat": "cam_quat",
        "fovy": "cam_fovy", "pos0": "cam_pos0", "mat0": "cam_mat0", "poscom0": "cam_poscom0",
    },
    "light": {
        "body": "light_bodyid", "type": "light_type", "pos": "light_pos", "dir": "light_dir",
        "active": "light_active", "shadow": "light_castshadow", "ambient": "light_ambient",
        "diffuse": "light_diffuse", "specular": "light_specular", "cutoff": "light_cutoff",
        "exponent": "light_exponent", "attenuation": "light_attenuation",
    },
    "material": {
        "rgba": "mat_rgba", "repeat": "mat_texrepeat", "uniform": "mat_texuniform", "emission": "mat_emission",
        "specular": "mat_specular", "shininess": "mat_shininess", "reflectance": "mat_reflectance",
    },
    "tendon": {
        "first": "tendon_adr", "count": "tendon_num", "rgba": "tendon_rgba", "material": "tendon_matid",
        "width": "tendon_width", "group": "tendon_group", "range": "tendon_range", "limited": "tendon_limited",
    },
    "actuator": {
        "transmission": "actuator_trntype", "target": "actuator_trnid", "gear": "actuator_gear",
    },
    "sensor": {"first": "sensor_adr", "count": "sensor_dim"},
    "key": {"time": "key_time", "qpos": "key_qpos", "ctrl": "key_ctrl", "mpos": "key_mpos", "mquat": "key_mquat"},
}  # fmt: skip
"""A kind's names are added as `name`; every column is one flat list."""


def columns(model: Any) -> dict[str, dict[str, list[Any]]]:
    """Return the columns of every kind."""
    table = NameTable(model)
    found = {
        kind: {"name": table.names[kind], **{name: short(getattr(model, array)) for name, array in arrays.items()}}
        for kind, arrays in COLUMNS.items()
    }
    first = getattr(model, "actuator_ctrladr", range(len(model.actuator_trntype)))  # one control before MuJoCo 4.0
    found["actuator"] |= {
        "control": short(first), "range": short(model.actuator_ctrlrange), "limited": short(model.actuator_ctrllimited),
    }  # fmt: skip
    signatures = [int(each) for each in model.exclude_signature]  # both bodies in one number
    found["exclude"] = {"body1": [each >> 16 for each in signatures], "body2": [each & 0xFFFF for each in signatures]}
    return found


def meshes(model: Any, blobs: Blobs) -> list[str]:
    """Return the hash of each mesh's bytes, which `mjcompose.mujoco.mesh_bytes` describes."""
    return [_mesh(model, number, blobs) for number in range(model.nmesh)]


def _rows(number: int, values: Any, first: Any, count: Any) -> Any:
    """Return the rows of an element in an array with the rows of all elements, one after the other."""
    return values[int(first[number]) : int(first[number]) + int(count[number])]


def _mesh(model: Any, number: int, blobs: Blobs) -> str:
    rows = partial(_rows, number)
    corners = rows(model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum)
    normals = rows(model.mesh_normal, model.mesh_normaladr, model.mesh_normalnum)
    faces = rows(model.mesh_face, model.mesh_faceadr, model.mesh_facenum)
    of_normals = rows(model.mesh_facenormal, model.mesh_faceadr, model.mesh_facenum)
    flat, of_flat = None, None
    if model.mesh_texcoordadr[number] >= 0:
        flat = rows(model.mesh_texcoord, model.mesh_texcoordadr, model.mesh_texcoordnum)
        of_flat = rows(model.mesh_facetexcoord, model.mesh_faceadr, model.mesh_facenum)
    mapping = [] if flat is None else [flat, of_flat]
    return blobs.put(
        "mesh 2", [corners, normals, faces, of_normals, *mapping],
        lambda: encoded(corners, normals, faces, of_normals=of_normals, flat=flat, of_flat=of_flat),
    )  # fmt: skip


def height_fields(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each height field: rows times columns of uint16, where 65535 is its full height."""
    found = []
    for number in range(model.nhfield):
        rows, columns, first = (int(each[number]) for each in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
        heights = model.hfield_data[first : first + rows * columns]
        blob = blobs.put("heights 1", [heights], partial(_encoded_heights, heights))
        found.append({"blob": blob, "rows": rows, "columns": columns, "size": short(model.hfield_size[number])})
    return found


def _encoded_heights(heights: Any) -> bytes:
    return packed(np.rint(np.clip(heights, 0, 1) * 65535).astype(np.uint16))


FLAT, CUBE, SKY = 0, 1, 2
_KINDS = {FLAT: "2d", CUBE: "cube", SKY: "skybox"}
# mjTEXROLE_RGB and mjTEXROLE_RGBA.
_COLOR_ROLES = (1, 8)


def textures(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each texture; the faces of a cube are below each other: right, left, up, down, front, back."""
    found = []
    for number in range(model.ntex):
        width, height = int(model.tex_width[number]), int(model.tex_height[number])
        channels, first = int(model.tex_nchannel[number]), int(model.tex_adr[number])
        pixels = model.tex_data[first : first + width * height * channels].reshape(height, width, channels)
        shown = pixels if channels in (3, 4) else np.repeat(pixels[:, :, :1], 3, axis=2)
        found.append({
            "blob": blobs.put("texture 1", [pixels], partial(png, shown)), "kind": _KINDS[int(model.tex_type[number])],
            "width": width, "height": height,
        })  # fmt: skip
    return found


def of_materials(model: Any) -> list[int]:
    """Return the texture for the color of each material, -1 for none."""
    roles: Any = np.asarray(model.mat_texid).reshape(model.nmat, -1) if model.nmat else []
    return [next((int(row[role]) for role in _COLOR_ROLES if row[role] >= 0), -1) for row in roles]


def skins(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each skin: its bones, and bytes with vertices, triangles, and for each bone its vertices and weights."""
    return [_skin(model, number, blobs) for number in range(model.nskin)]


def _skin(model: Any, number: int, blobs: Blobs) -> dict[str, Any]:
    rows = partial(_rows, number)
    corners = rows(model.skin_vert, model.skin_vertadr, model.skin_vertnum)
    faces = rows(model.skin_face, model.skin_faceadr, model.skin_facenum)
    mapped = bool(model.skin_texcoordadr[number] >= 0)
    first, count = int(model.skin_boneadr[number]), int(model.skin_bonenum[number])
    bones = range(first, first + count)
    moved, weights = (
        [_rows(bone, values, first=model.skin_bonevertadr, count=model.skin_bonevertnum) for bone in bones]
        for values in (model.skin_bonevertid, model.skin_bonevertweight)
    )
    flat = rows(model.skin_texcoord, model.skin_texcoordadr, model.skin_vertnum) if mapped else np.zeros((0, 2))
    arrays = [
        corners.astype(np.float32), faces.astype(np.uint32), flat.astype(np.float32),
        np.concatenate([*moved, np.zeros(0)]).astype(np.uint32),
        np.concatenate([*weights, np.zeros(0)]).astype(np.float32),
    ]  # fmt: skip
    return {
        "blob": blobs.put("skin 1", arrays, lambda: packed(*arrays)), "count": len(corners), "triangles": len(faces),
        "mapped": mapped, "material": int(model.skin_matid[number]), "rgba": short(model.skin_rgba[number]),
        "group": int(model.skin_group[number]), "inflate": float(model.skin_inflate[number]),
        "name": names(model, "skin")[number], "body": int(model.skin_bonebodyid[first]) if count else 0,
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
    rows = partial(_rows, number)
    dimensions = int(model.flex_dim[number])
    world = rows(data.flexvert_xpos.reshape(-1, 3), model.flex_vertadr, model.flex_vertnum)
    bodies = rows(model.flex_vertbodyid, model.flex_vertadr, model.flex_vertnum)
    moved = {int(each) for each in bodies if each >= 0}
    held = min(moved, default=0) if len(moved) < 2 else int(model.body_parentid[max(moved)])
    interpolated = bool(model.flex_interp[number]) or bool((bodies < 0).any())
    bodies = np.zeros_like(bodies) if interpolated else bodies
    turned = data.xmat[bodies].reshape(-1, 3, 3)
    local = np.einsum("nji,nj->ni", turned, world - data.xpos[bodies])
    edges = rows(model.flex_edge, model.flex_edgeadr, model.flex_edgenum)
    elements = model.flex_elem[int(model.flex_elemdataadr[number]) :][
        : int(model.flex_elemnum[number]) * (dimensions + 1)
    ]
    if dimensions == 3:
        shell = model.flex_shell[int(model.flex_shelldataadr[number]) :][: int(model.flex_shellnum[number]) * 3]
    else:
        shell = elements if dimensions == 2 else np.zeros(0)
    arrays = [
        local.astype(np.float32), bodies.astype(np.uint32), np.asarray(shell).astype(np.uint32), edges.astype(np.uint32)
    ]  # fmt: skip
    return {
        "blob": blobs.put("flex 1", arrays, lambda: packed(*arrays)), "count": len(world), "dimensions": dimensions,
        "triangles": len(arrays[2]) // 3, "edges": len(edges), "radius": float(model.flex_radius[number]),
        "material": int(model.flex_matid[number]), "rgba": short(model.flex_rgba[number]),
        "group": int(model.flex_group[number]), "name": names(model, "flex")[number], "body": held,
    }  # fmt: skip


def wraps(model: Any) -> dict[str, list[Any]]:
    """Return the path of spatial tendons: sites, geoms, pulleys and joints, and their parameters."""
    return {
        "type": short(model.wrap_type), "object": short(model.wrap_objid),
        "parameter": [float(each) for each in model.wrap_prm],
    }  # fmt: skip


_MOST_CONTACTS = 500
# The value of `wrap_obj` for a pulley, which cuts a tendon's path.
_PULLEY = -2


def poses(mujoco: Any, model: Any, data: Any) -> Iterator[dict[str, Any]]:
    """Yield the answer of `seen` at the reference configuration, then at each keyframe.

    `data` is at the reference configuration again afterwards.
    """
    for key in (None, *range(model.nkey)):
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        place(mujoco, model, data)
        yield seen(mujoco, model, data)
    mujoco.mj_resetData(model, data)
    place(mujoco, model, data)


def seen(mujoco: Any, model: Any, data: Any) -> dict[str, Any]:
    """Return the contacts, tendon paths and values of sensors of a state.

    A contact has its two geoms (-1 for a flex), its position, its normal, and the force on the second geom.
    """
    return {
        "contacts": [_contact(mujoco, model, data, number=each) for each in range(min(int(data.ncon), _MOST_CONTACTS))],
        "tendons": _ways(data), "sensors": _rounded(data.sensordata),
    }  # fmt: skip


def _contact(mujoco: Any, model: Any, data: Any, number: int) -> list[Any]:
    contact, force = data.contact[number], np.zeros(6)
    mujoco.mj_contactForce(model, data, number, force)
    along = force[:3] @ contact.frame.reshape(3, 3)
    return [*(int(geom) for geom in contact.geom), *short(contact.pos), *short(contact.frame[:3]), *_rounded(along)]


def _rounded(values: Any) -> list[float]:
    return [float(f"{each:.5g}") for each in np.nan_to_num(values).tolist()]


_PULL = ("at", "to")


def pull(mujoco: Any, model: Any, data: Any, asked: Mapping[str, Any]) -> None:
    """Pull a ``body`` by its point ``at``, in its frame, to the point ``to``, with a spring and a damper.

    Both suit the body's weight and the model's `visual/map` stiffness. Any other request does nothing.
    """
    body, points = asked.get("body", 0), [asked.get(name) for name in _PULL]
    if not 0 < body < model.nbody or not all(point is not None and len(point) == 3 for point in points):
        return
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ points[0]
    turning, moving = data.cvel[body][:3], data.cvel[body][3:]
    speed = moving + np.cross(turning, at - data.subtree_com[model.body_rootid[body]])
    weight, stiffness = 1 / max(float(model.body_invweight0[body, 0]), 1e-9), float(model.vis.map.stiffness)
    force = weight * (stiffness * (np.array(points[1]) - at) - 2 * np.sqrt(stiffness) * speed)
    data.xfrc_applied[body] = [*force, *np.cross(at - data.xipos[body], force)]


def look(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer of `seen` at ``qpos`` and ``ctrl``, at rest; runs under `mjcompose.mujoco.engine.call`."""
    data = mujoco.MjData(model)
    for name in ("qpos", "ctrl"):
        if len(value := asked[name]) == len(array := getattr(data, name)):
            array[:] = value
    place(mujoco, model, data)
    return seen(mujoco, model, data)


def _ways(data: Any) -> list[list[float]]:
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


FORMAT = 1
FILE = "scene.json"


def describe(mujoco: Any, model: Any, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write `scene.json` and its blobs into ``folder``; runs under `mjcompose.mujoco.engine.call`.

    The answer's `blobs` are all that it refers to; those in ``known`` are not written again. Lengths are in meters,
    angles in radians, quaternions are w x y z, and elements on a body are in its frame, as in `mjModel`. Equal
    models give equal bytes.
    """
    folder = Path(asked["folder"])
    blobs = Blobs(folder, asked.get("known", ()))
    data = mujoco.MjData(model)
    place(mujoco, model, data)
    found: dict[str, Any] = {"format": FORMAT, **columns(model)}
    found["material"]["texture"] = of_materials(model)
    found["sensor"]["kind"] = [mujoco.mjtSensor(int(kind)).name[7:].lower() for kind in model.sensor_type]
    found["mesh"] = meshes(model, blobs)
    found["meshes"] = [name.rpartition("/")[2] for name in names(model, "mesh")]
    found["hfield"] = height_fields(model, blobs)
    found["texture"] = textures(model, blobs)
    found["skin"] = skins(model, blobs)
    found["flex"] = flexes(model, data, blobs)
    found["wrap"] = wraps(model)
    found["poses"] = list(poses(mujoco, model, data))
    found["qpos0"] = short(model.qpos0)
    found["timestep"] = float(model.opt.timestep)
    found["look"] = _look(model)
    text = json.dumps(found, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    (folder / FILE).write_text(text, encoding="utf-8")
    return {"blobs": list(blobs.used)}


def _look(model: Any) -> dict[str, Any]:
    settings, light = model.vis.global_, model.vis.headlight
    return {
        "center": short(model.stat.center), "extent": float(model.stat.extent), "azimuth": float(settings.azimuth),
        "elevation": float(settings.elevation), "fovy": float(settings.fovy),
        "headlight": {
            "active": bool(light.active), "ambient": short(light.ambient), "diffuse": short(light.diffuse),
            "specular": short(light.specular),
        },
        "haze": short(model.vis.rgba.haze), "jointwidth": float(model.vis.scale.jointwidth),
        "stiffness": float(model.vis.map.stiffness),
        "framewidth": float(model.vis.scale.framewidth), "meansize": float(model.stat.meansize),
    }  # fmt: skip
