"""A compiled model as data for a page in the browser."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import RUNS
from mjcompose.mujoco.attributes import KINDS, NameTable, names, place
from mjcompose.mujoco.controls import servo
from mjcompose.mujoco.film import png

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_DIGITS = 24


class Blobs:
    """Writes each content once to a file of `folder`, named by its hash; contents in `known` are not encoded again."""

    def __init__(self, folder: Path, known: Collection[str] = ()) -> None:
        self.folder = folder
        self.known = set(known)
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
    """Return numbers as a flat list with nine digits, which is the full single precision."""
    flat = np.asarray(values).ravel()
    if flat.dtype.kind != "f":
        return flat.astype(int).tolist() if flat.dtype.kind == "b" else flat.tolist()
    return [float(f"{each:.9g}") for each in flat.tolist()]


COLUMNS: dict[str, dict[str, str]] = {
    kind: {
        column: f"{KINDS[kind].arrays}_{array or column}"
        for column, _, array in (each.partition("=") for each in columns.split())
    }
    for kind, columns in {
        "body": "parent=parentid pos quat mass inertia ipos iquat mocap=mocapid gravcomp weld=weldid",
        "joint": "body=bodyid type pos axis range limited qpos=qposadr group stiffness margin solref solimp"
        " forcerange=actfrcrange forcelimited=actfrclimited",
        "geom": "body=bodyid type pos quat size data=dataid material=matid rgba group contype conaffinity"
        " friction priority condim margin gap solref solimp",
        "site": "body=bodyid type pos quat size material=matid rgba group",
        "camera": "body=bodyid mode target=targetbodyid pos quat fovy pos0 mat0 poscom0",
        "light": "body=bodyid type pos dir active shadow=castshadow ambient diffuse specular cutoff exponent"
        " attenuation",
        "material": "rgba repeat=texrepeat uniform=texuniform emission specular shininess reflectance",
        "tendon": "first=adr count=num rgba material=matid width group range limited",
        "actuator": "transmission=trntype target=trnid gear forcerange forcelimited",
        "sensor": "first=adr count=dim",
        "key": "time qpos ctrl mpos mquat",
    }.items()
}
"""A kind's names are added as `name`; every column is one flat list."""


def columns(model: MjModel) -> dict[str, dict[str, list[Any]]]:
    """Return the columns of every kind."""
    table = NameTable(model)
    found = {
        kind: {"name": table.names[kind], **{name: short(getattr(model, array)) for name, array in arrays.items()}}
        for kind, arrays in COLUMNS.items()
    }
    first = getattr(model, "actuator_ctrladr", range(len(model.actuator_trntype)))  # one control before MuJoCo 4.0
    found["actuator"] |= {
        "control": short(first),
        "range": short(model.actuator_ctrlrange),
        "limited": short(model.actuator_ctrllimited),
    }
    freedom = np.asarray(model.jnt_dofadr)  # the first axis of each joint; the others have the same numbers
    for column in ("damping", "armature", "frictionloss"):
        found["joint"][column] = short(getattr(model, f"dof_{column}")[freedom])
    found["joint"]["rest"] = short(model.qpos_spring[model.jnt_qposadr])
    gains = [servo(model, actuator) or {} for actuator in range(len(model.actuator_trntype))]
    found["actuator"] |= {name: [each.get(name) for each in gains] for name in ("gain", "kp", "kv")}
    found["pair"] = {
        name: short(getattr(model, f"pair_{array}"))
        for name, array in (("one", "geom1"), ("other", "geom2"), ("friction", "friction"), ("condim", "dim"))
    }
    signatures = [int(each) for each in model.exclude_signature]  # both bodies in one number
    found["exclude"] = {"body1": [each >> 16 for each in signatures], "body2": [each & 0xFFFF for each in signatures]}
    return found


MAPPED = 1
UNSMOOTH = 2
PLANES = 8
_BITS = 14
_BITS_OF_LARGE = 16
_LARGE = 2.0  # bits of a vertex, bits in a large mesh, its least size in meters
_FLAT_ANGLE = 2.5
_FLAT_SHARE = 0.95


def encoded(corners: Any, normals: Any, faces: Any, of_normals: Any, flat: Any, of_flat: Any) -> bytes:
    """Return the surface of a mesh in few bytes that compress well. `flat` are its texture coordinates, or None.

    The bytes are a head of three uint32 (vertices, triangles, flags), six float32 (the smallest vertex and the step of
    each axis) and, if `MAPPED`, two float32 of texture coordinates for each vertex. Then come differences in byte
    planes, which means the lowest byte of all numbers, then the next byte:

    - vertices: for each axis the zigzag differences to the vertex before, in two planes
    - normals, unless `UNSMOOTH`: the differences of their two bytes (`octahedral`), in one plane each
    - triangles: three numbers each, in as many planes as the flags say above `PLANES`: the differences of the first
      vertex to the triangle before, and of the second vertex to the first, and the zigzag difference of the third to
      the second

    Vertices are in Morton order, and triangles in the order of their first vertex, which is their least.
    """
    low = corners.min(axis=0)
    extent = float(np.ptp(corners, axis=0).max())
    step = extent / ((1 << (_BITS if extent <= _LARGE else _BITS_OF_LARGE)) - 1) or 1.0
    whole = np.rint((corners - low) / step).astype(np.uint64)
    is_flat = _is_flat(corners, normals, faces, of_normals=of_normals)
    folded = octahedral(normals)
    place = _morton(whole)
    key = place[faces.ravel()]
    if not is_flat:
        bytes_of = folded.astype(np.uint8).astype(np.uint64)
        key = key << np.uint64(16) | (bytes_of[:, 0] << np.uint64(8) | bytes_of[:, 1])[of_normals.ravel()]
    if flat is not None:
        ranks = np.unique(key, return_inverse=True)[1].ravel().astype(np.uint64)
        key = ranks * np.uint64(len(flat)) + of_flat.ravel().astype(np.uint64)
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    corner = faces.ravel()[first]
    triangles = _ordered(index.reshape(-1, 3), place[corner])
    differences = np.diff(whole[corner].astype(np.uint16), axis=0, prepend=np.uint16(0)).view(np.int16)
    found = [_planes(each, 2) for each in _zigzag(differences).view(np.uint16).T]
    if not is_flat:
        found += [np.diff(each, prepend=np.int8(0)).tobytes() for each in folded[of_normals.ravel()[first]].T]
    numbers = np.diff(triangles, axis=1, prepend=0)
    numbers[:, 0] = np.diff(triangles[:, 0], prepend=0)
    numbers[:, 2] = _zigzag(numbers[:, 2])
    count = max(1, (int(numbers.max(initial=0)).bit_length() + 7) // 8)
    flags = MAPPED * (flat is not None) | UNSMOOTH * is_flat | count << PLANES
    head = np.array([len(first), len(triangles), flags], np.uint32).tobytes()
    head += np.array([*low, step, step, step], np.float32).tobytes()
    if flat is not None:
        head += flat[of_flat.ravel()[first]].astype(np.float32).tobytes()
    return b"".join([head, *found, _planes(numbers.ravel(), count)])


def _is_flat(corners: Any, normals: Any, faces: Any, of_normals: Any) -> bool:
    """Return whether nearly all of a surface has the normals of its triangles, which needs no bytes."""
    ends = corners[faces].astype(float)
    across = np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0])
    area = np.linalg.norm(across, axis=1)
    least = np.einsum("tkj,tj->tk", normals[of_normals], across).min(axis=1)
    near = least >= np.cos(np.radians(_FLAT_ANGLE)) * area
    return bool(area[near].sum() >= _FLAT_SHARE * area.sum())


def octahedral(directions: Any) -> Any:
    """Return unit vectors in two bytes each, by folding the sphere into a square."""
    length = np.abs(directions).sum(axis=1, keepdims=True)
    flat = directions[:, :2] / np.maximum(length, 1e-12)
    turned = (1 - np.abs(flat[:, ::-1])) * np.where(flat >= 0, 1, -1)
    folded = np.where(directions[:, 2:] < 0, turned, flat)
    return np.rint(np.clip(folded, -1, 1) * 127).astype(np.int8)


def _morton(whole: Any) -> Any:
    """Return for each row of three 16-bit numbers one number with their bits interleaved; close places stay close."""
    spread = whole.astype(np.uint64)
    for shift, mask in (
        (32, 0xFFFF00000000FFFF),
        (16, 0xFF0000FF0000FF),
        (8, 0xF00F00F00F00F00F),
        (4, 0xC30C30C30C30C3),
        (2, 0x249249249249249),
    ):
        spread = (spread | spread << np.uint64(shift)) & np.uint64(mask)
    return spread[:, 0] | spread[:, 1] << np.uint64(1) | spread[:, 2] << np.uint64(2)


def _ordered(triangles: Any, place: Any) -> Any:
    """Return triangles with their smallest vertex first and sorted by it, without those whose corners coincide."""
    at = place[triangles]
    kept = triangles[(at[:, 0] != at[:, 1]) & (at[:, 1] != at[:, 2]) & (at[:, 0] != at[:, 2])].astype(np.int64)
    turned = np.take_along_axis(kept, (kept.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T[::-1])]


def _zigzag(values: Any) -> Any:
    """Return small positive numbers for small differences of either sign."""
    return values << 1 ^ values >> (8 * values.itemsize - 1)


def _planes(values: Any, count: int) -> bytes:
    return b"".join((values >> (8 * each) & 255).astype(np.uint8).tobytes() for each in range(count))


def _rows(number: int, values: Any, first: Any, count: Any) -> Any:
    """Return the rows of an element in an array with the rows of all elements, one after the other."""
    return values[int(first[number]) : int(first[number]) + int(count[number])]


def _mesh(model: MjModel, number: int, blobs: Blobs) -> str:
    """Return the hash of the bytes of a mesh, which `encoded` describes."""
    rows = partial(_rows, number)
    corners = rows(model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum)
    normals = rows(model.mesh_normal, model.mesh_normaladr, model.mesh_normalnum)
    faces = rows(model.mesh_face, model.mesh_faceadr, model.mesh_facenum)
    of_normals = rows(model.mesh_facenormal, model.mesh_faceadr, model.mesh_facenum)
    flat = None
    of_flat = None
    if model.mesh_texcoordadr[number] >= 0:
        flat = rows(model.mesh_texcoord, model.mesh_texcoordadr, model.mesh_texcoordnum)
        of_flat = rows(model.mesh_facetexcoord, model.mesh_faceadr, model.mesh_facenum)
    mapping = [] if flat is None else [flat, of_flat]
    return blobs.put(
        "mesh 2",
        [corners, normals, faces, of_normals, *mapping],
        lambda: encoded(corners, normals, faces, of_normals=of_normals, flat=flat, of_flat=of_flat),
    )


def height_fields(model: MjModel, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each height field: rows times columns of uint16; 65535 is its full height."""
    found = []
    for number in range(model.nhfield):
        rows, columns, first = (int(each[number]) for each in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr))
        heights = model.hfield_data[first : first + rows * columns]
        blob = blobs.put("heights 1", [heights], partial(_encoded_heights, heights))
        found.append({"blob": blob, "rows": rows, "columns": columns, "size": short(model.hfield_size[number])})
    return found


def _encoded_heights(heights: Any) -> bytes:
    return packed(np.rint(np.clip(heights, 0, 1) * 65535).astype(np.uint16))


_KINDS = ("2d", "cube", "skybox")
_COLOR_ROLES = (1, 8)  # mjTEXROLE_RGB and mjTEXROLE_RGBA


def textures(model: MjModel, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each texture; the faces of a cube are below each other: right, left, up, down, front, back."""
    found = []
    run = RUNS["texture"]["ntexdata"]
    for number in range(model.ntex):
        rows = run.rows(model, number)
        shape = run.shape and run.shape(model, number)
        pixels = model.tex_data[rows.start : rows.stop].reshape(shape)
        shown = pixels if pixels.shape[2] in (3, 4) else np.repeat(pixels[:, :, :1], 3, axis=2)
        found.append(
            {
                "blob": blobs.put("texture 1", [pixels], partial(png, shown)),
                "kind": _KINDS[int(model.tex_type[number])],
                "width": pixels.shape[1],
                "height": pixels.shape[0],
            }
        )
    return found


def of_materials(model: MjModel) -> list[int]:
    """Return the texture for the color of each material, -1 for none."""
    roles: Any = np.asarray(model.mat_texid).reshape(model.nmat, -1) if model.nmat else []
    return [next((int(row[role]) for role in _COLOR_ROLES if row[role] >= 0), -1) for row in roles]


def _skin(model: MjModel, number: int, blobs: Blobs) -> dict[str, Any]:
    """Return a skin: its bones, and bytes with vertices, triangles, and for each bone its vertices and weights."""
    rows = partial(_rows, number)
    corners = rows(model.skin_vert, model.skin_vertadr, model.skin_vertnum)
    faces = rows(model.skin_face, model.skin_faceadr, model.skin_facenum)
    mapped = bool(model.skin_texcoordadr[number] >= 0)
    first = int(model.skin_boneadr[number])
    count = int(model.skin_bonenum[number])
    bones = range(first, first + count)
    moved, weights = (
        [_rows(bone, values, first=model.skin_bonevertadr, count=model.skin_bonevertnum) for bone in bones]
        for values in (model.skin_bonevertid, model.skin_bonevertweight)
    )
    flat = rows(model.skin_texcoord, model.skin_texcoordadr, model.skin_vertnum) if mapped else np.zeros((0, 2))
    arrays = [
        corners.astype(np.float32),
        faces.astype(np.uint32),
        flat.astype(np.float32),
        np.concatenate([*moved, np.zeros(0)]).astype(np.uint32),
        np.concatenate([*weights, np.zeros(0)]).astype(np.float32),
    ]
    return {
        "blob": blobs.put("skin 1", arrays, lambda: packed(*arrays)),
        "count": len(corners),
        "triangles": len(faces),
        "mapped": mapped,
        "material": int(model.skin_matid[number]),
        "rgba": short(model.skin_rgba[number]),
        "group": int(model.skin_group[number]),
        "inflate": float(model.skin_inflate[number]),
        "name": names(model, "skin")[number],
        "body": int(model.skin_bonebodyid[first]) if count else 0,
        "bones": short(model.skin_bonebodyid[first : first + count]),
        "moved": [len(each) for each in moved],
        "pos": short(model.skin_bonebindpos[first : first + count]),
        "quat": short(model.skin_bonebindquat[first : first + count]),
    }


def _flex(model: MjModel, data: MjData, number: int, blobs: Blobs) -> dict[str, Any]:
    """Return a flex at rest: its vertices in the frames of their bodies, and the drawn parts.

    `shell` are triangles: the elements of a two-dimensional flex, the surface of a three-dimensional one. A
    one-dimensional flex has only `edges`. A flex that MuJoCo interpolates is drawn at rest.
    """
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
    shell = np.zeros(0)
    if dimensions == 3:
        shell = rows(model.flex_shell, model.flex_shelldataadr, 3 * model.flex_shellnum)
    elif dimensions == 2:
        shell = rows(model.flex_elem, model.flex_elemdataadr, 3 * model.flex_elemnum)
    arrays = [local.astype(np.float32), *(each.astype(np.uint32) for each in (bodies, shell, edges))]
    return {
        "blob": blobs.put("flex 1", arrays, lambda: packed(*arrays)),
        "count": len(world),
        "dimensions": dimensions,
        "triangles": len(arrays[2]) // 3,
        "edges": len(edges),
        "radius": float(model.flex_radius[number]),
        "material": int(model.flex_matid[number]),
        "rgba": short(model.flex_rgba[number]),
        "group": int(model.flex_group[number]),
        "name": names(model, "flex")[number],
        "body": held,
    }


def wraps(model: MjModel) -> dict[str, list[Any]]:
    """Return the path of spatial tendons: sites, geoms, pulleys and joints, and their parameters."""
    parameters = [float(each) for each in model.wrap_prm]
    return {"type": short(model.wrap_type), "object": short(model.wrap_objid), "parameter": parameters}


_MOST_CONTACTS = 500
_PULLEY = -2  # the value of `wrap_obj` for a pulley, which cuts a tendon's path


def poses(mujoco: Any, model: MjModel, data: MjData) -> Iterator[dict[str, Any]]:
    """Yield the answer of `seen` at the reference configuration, to which `data` returns, and at each keyframe."""
    for key in (None, *range(model.nkey)):
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        place(mujoco, model, data)
        yield seen(mujoco, model, data)
    mujoco.mj_resetData(model, data)
    place(mujoco, model, data)


def seen(mujoco: Any, model: MjModel, data: MjData) -> dict[str, Any]:
    """Return contacts (geoms, -1 for a flex; position, normal, force on the second), tendon paths and sensors."""
    contacts = []
    for number in range(min(int(data.ncon), _MOST_CONTACTS)):
        contact = data.contact[number]
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, number, force)
        along = force[:3] @ contact.frame.reshape(3, 3)
        geoms = map(int, contact.geom)
        contacts.append([*geoms, *short(contact.pos), *short(contact.frame[:3]), *_rounded(along)])
    return {"contacts": contacts, "tendons": _ways(data), "sensors": _rounded(data.sensordata)}


def _rounded(values: Any) -> list[float]:
    return [float(f"{each:.5g}") for each in np.nan_to_num(values).tolist()]


def pull(mujoco: Any, model: MjModel, data: MjData, asked: Mapping[str, Any]) -> None:
    """Pull a ``body`` at its point ``at``, in its frame, to the point ``to``, with a spring and a damper.

    Both fit the body's weight and the model's `visual/map` stiffness. Any other request does nothing.
    """
    body = asked.get("body", 0)
    points = [asked.get(name) for name in ("at", "to")]
    if not 0 < body < model.nbody or not all(point is not None and len(point) == 3 for point in points):
        return
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ points[0]
    turning = data.cvel[body][:3]
    moving = data.cvel[body][3:]
    speed = moving + np.cross(turning, at - data.subtree_com[model.body_rootid[body]])
    weight = 1 / max(float(model.body_invweight0[body, 0]), 1e-9)
    stiffness = float(model.vis.map.stiffness)
    force = weight * (stiffness * (np.array(points[1]) - at) - 2 * np.sqrt(stiffness) * speed)
    data.xfrc_applied[body] = [*force, *np.cross(at - data.xipos[body], force)]


def look(mujoco: Any, model: MjModel, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer of `seen` at ``qpos`` and ``ctrl``, at rest; runs under `mjcompose.mujoco.engine.call`."""
    data = mujoco.MjData(model)
    for name in ("qpos", "ctrl"):
        value = asked[name]
        array = getattr(data, name)
        if len(value) == len(array):
            array[:] = value
    place(mujoco, model, data)
    return seen(mujoco, model, data)


def _ways(data: MjData) -> list[list[float]]:
    points = data.wrap_xpos.reshape(-1, 3)
    objects = data.wrap_obj.ravel()
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


def describe(mujoco: Any, model: MjModel, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Write `scene.json` and its blobs into ``folder``; runs under `mjcompose.mujoco.engine.call`.

    The answer's `blobs` are all blobs that it refers to; blobs in ``known`` are not written again. Lengths are in
    meters, angles in radians, quaternions are w x y z, and elements on a body are in its frame, as in `mjModel`. Equal
    models give equal bytes.
    """
    folder = Path(asked["folder"])
    blobs = Blobs(folder, asked.get("known", ()))
    data = mujoco.MjData(model)
    place(mujoco, model, data)
    found: dict[str, Any] = {"format": FORMAT, **columns(model)}
    found["material"]["texture"] = of_materials(model)
    found["sensor"]["kind"] = [mujoco.mjtSensor(int(kind)).name[7:].lower() for kind in model.sensor_type]
    found["mesh"] = [_mesh(model, number, blobs) for number in range(model.nmesh)]
    found["meshes"] = [name.rpartition("/")[2] for name in names(model, "mesh")]
    found["hfield"] = height_fields(model, blobs)
    found["texture"] = textures(model, blobs)
    found["skin"] = [_skin(model, number, blobs) for number in range(model.nskin)]
    found["flex"] = [_flex(model, data, number, blobs=blobs) for number in range(model.nflex)]
    found["wrap"] = wraps(model)
    found["poses"] = list(poses(mujoco, model, data))
    found["filterparent"] = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    found |= {"qpos0": short(model.qpos0), "timestep": float(model.opt.timestep), "look": _look(model)}
    text = json.dumps(found, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    (folder / FILE).write_text(text, encoding="utf-8")
    return {"blobs": list(blobs.used)}


def _look(model: MjModel) -> dict[str, Any]:
    settings = model.vis.global_
    light = model.vis.headlight
    return {
        "center": short(model.stat.center),
        "extent": float(model.stat.extent),
        "azimuth": float(settings.azimuth),
        "elevation": float(settings.elevation),
        "fovy": float(settings.fovy),
        "headlight": {
            "active": bool(light.active),
            "ambient": short(light.ambient),
            "diffuse": short(light.diffuse),
            "specular": short(light.specular),
        },
        "haze": short(model.vis.rgba.haze),
        "jointwidth": float(model.vis.scale.jointwidth),
        "stiffness": float(model.vis.map.stiffness),
        "framewidth": float(model.vis.scale.framewidth),
        "meansize": float(model.stat.meansize),
    }
