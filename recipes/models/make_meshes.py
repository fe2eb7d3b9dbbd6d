"""Makes the meshes and the texture of the demo models: `python recipes/models/make_meshes.py`.

Every solid is a loft: outlines in a plane, joined along an axis, closed at both ends. Lengths are meters.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Solid = tuple[Array, NDArray[np.int64]]
"""Vertices (n, 3) and triangles (m, 3), counter-clockwise seen from outside."""

HERE = Path(__file__).resolve().parent


def circle(radius: float, count: int = 28) -> Array:
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def squircle(a: float, b: float, exponent: float = 4, count: int = 28) -> Array:
    """A rectangle of half sizes `a` and `b` with round corners, an ellipse at the exponent 2."""
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    wave = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    outline: Array = np.sign(wave) * np.abs(wave) ** (2 / exponent) * [a, b]
    return outline


def stadium(radius: float, length: float, count: int = 28) -> Array:
    """A strip with round ends, from the first end's center at 0 to the other's at `length`."""
    outline = circle(radius, count)
    outline[outline[:, 0] > 1e-9, 0] += length
    return outline


def gear(radius: float, depth: float, teeth: int) -> Array:
    turn = np.linspace(0, 2 * np.pi, 4 * teeth, endpoint=False)
    r = np.where(np.arange(4 * teeth) % 4 < 2, radius, radius - depth)
    return np.stack([r * np.cos(turn), r * np.sin(turn)], axis=1)


def loft(sections: list[tuple[float, Array]], axis: str = "z") -> Solid:
    """Join outlines of equal length, each at its height; along `y` an outline lies in (z, x)."""
    count = len(sections[0][1])
    rings = [np.column_stack([outline, np.full(count, height)]) for height, outline in sections]
    ends = [ring.mean(axis=0, keepdims=True) for ring in (rings[0], rings[-1])]
    vertices = np.concatenate([*rings, *ends])[:, {"x": [2, 0, 1], "y": [1, 2, 0], "z": [0, 1, 2]}[axis]]
    here = np.arange(count)
    there = np.roll(here, -1)
    faces: list[NDArray[np.int64]] = []
    for low in range(0, count * (len(rings) - 1), count):
        high = low + count
        faces.append(np.stack([low + here, low + there, high + there], 1))
        faces.append(np.stack([low + here, high + there, high + here], 1))
    top = count * (len(rings) - 1)
    bottom_centre, top_centre = (np.full(count, count * len(rings) + end) for end in (0, 1))
    faces += [np.stack([bottom_centre, there, here], 1), np.stack([top_centre, top + here, top + there], 1)]
    return vertices, np.concatenate(faces)


def bevelled(outline: Array, low: float, high: float, bevel: float, axis: str = "z") -> Solid:
    """An outline pushed from `low` to `high`, its edges taken off by `bevel`."""
    center = (outline.max(axis=0) + outline.min(axis=0)) / 2
    size = (outline.max(axis=0) - outline.min(axis=0)) / 2
    small = center + (outline - center) * (1 - bevel / size)
    return loft([(low, small), (low + bevel, outline), (high - bevel, outline), (high, small)], axis)


def rod(radius: float, low: float, high: float, bevel: float = 0.004, axis: str = "z", count: int = 28) -> Solid:
    return bevelled(circle(radius, count), low, high, bevel, axis)


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], bevel: float = 0.002) -> Solid:
    a = (x[1] - x[0]) / 2
    b = (y[1] - y[0]) / 2
    corners = np.array([[a, -b], [a, b], [-a, b], [-a, -b]])
    center = np.array([x[0] + x[1], y[0] + y[1]]) / 2
    return bevelled(center + corners, z[0], z[1], bevel)


def moved(solid: Solid, offset: tuple[float, float, float]) -> Solid:
    return solid[0] + np.array(offset), solid[1]


def joined(*solids: Solid) -> Solid:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in solids[:-1])])
    faces = [triangles + start for (_, triangles), start in zip(solids, starts, strict=True)]
    return np.concatenate([vertices for vertices, _ in solids]), np.concatenate(faces)


def write(file: str, solid: Solid) -> None:
    path = HERE / file
    vertices, faces = solid
    if path.suffix == ".obj":
        lines = ["v " + " ".join(f"{value:.5g}" for value in vertex + 0.0) for vertex in vertices.round(5)]
        lines += ["f " + " ".join(str(index + 1) for index in face) for face in faces]
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        return
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    record = np.zeros(len(faces), np.dtype([("data", "<f4", (4, 3)), ("unused", "<u2")]))
    record["data"] = np.concatenate([normals[:, None], corners], axis=1)
    path.write_bytes(b"mjcompose demo mesh".ljust(80) + struct.pack("<I", len(faces)) + record.tobytes())


def write_png(file: str, indices: NDArray[np.uint8], palette: NDArray[np.uint8]) -> None:
    """A PNG of palette indices (height, width)."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = indices.shape
    rows = b"".join(b"\0" + row.tobytes() for row in indices)
    head = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    parts = [(b"IHDR", head), (b"PLTE", palette.tobytes()), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b"")]
    (HERE / file).write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunk(kind, data) for kind, data in parts))


def turned(profile: list[tuple[float, float]], count: int = 28) -> Solid:
    """A solid of revolution about z from its heights and radii."""
    return loft([(height, circle(radius, count)) for height, radius in profile])


def arm() -> None:
    foot = [(0, 0.105), (0.003, 0.11), (0.017, 0.11), (0.02, 0.105), (0.026, 0.09)]
    write("arm6/assets/base.obj", turned([*foot, (0.1, 0.08), (0.127, 0.08), (0.13, 0.077)]))

    turret = turned([(0, 0.077), (0.003, 0.08), (0.05, 0.08), (0.12, 0.066), (0.15, 0.05)])
    motor = moved(rod(0.074, -0.062, 0.062, axis="y"), (0.03, 0, 0.14))
    write("arm6/assets/shoulder.obj", joined(turret, motor))

    cheek = stadium(0.066, 0.11)
    beam = [
        (0.086, squircle(0.05, 0.07)),
        (0.09, squircle(0.056, 0.086)),
        (0.13, squircle(0.056, 0.086)),
        (0.2, squircle(0.042, 0.052)),
        (0.28, squircle(0.042, 0.052)),
        (0.33, squircle(0.046, 0.052)),
    ]
    upper_arm = joined(
        bevelled(cheek, 0.063, 0.088, 0.004, "y"),
        bevelled(cheek, -0.088, -0.063, 0.004, "y"),
        loft(beam),
        moved(rod(0.062, -0.054, 0.054, axis="y"), (0, 0, 0.36)),
    )
    write("arm6/assets/upper_arm.obj", upper_arm)

    cheek = stadium(0.055, 0.08)
    block = [
        (0.072, squircle(0.045, 0.066, 3)),
        (0.076, squircle(0.052, 0.074, 3)),
        (0.1, squircle(0.052, 0.074, 3)),
        (0.125, squircle(0.05, 0.052, 3)),
        (0.13, squircle(0.047, 0.049, 3)),
    ]
    elbow = joined(bevelled(cheek, 0.055, 0.076, 0.004, "y"), bevelled(cheek, -0.076, -0.055, 0.004, "y"), loft(block))
    write("arm6/assets/elbow.obj", elbow)

    cheek = stadium(0.034, 0.06)
    tube = [
        (0, circle(0.045)),
        (0.003, circle(0.048)),
        (0.06, circle(0.046)),
        (0.12, squircle(0.036, 0.056, 3)),
        (0.158, squircle(0.034, 0.058, 3)),
        (0.162, squircle(0.03, 0.054, 3)),
    ]
    forearm = joined(
        loft(tube),
        moved(bevelled(cheek, 0.041, 0.058, 0.003, "y"), (0, 0, 0.15)),
        moved(bevelled(cheek, -0.058, -0.041, 0.003, "y"), (0, 0, 0.15)),
    )
    write("arm6/assets/forearm.obj", forearm)

    neck = turned([(0.01, 0.03), (0.045, 0.03), (0.057, 0.036), (0.06, 0.034)], 24)
    write("arm6/assets/wrist.stl", joined(rod(0.034, -0.039, 0.039, 0.003, "y", 24), neck))

    rim = [(0.001, 0.035), (0.003, 0.037), (0.02, 0.037), (0.022, 0.035), (0.022, 0.02), (0.025, 0.019)]
    write("arm6/assets/flange.stl", turned(rim, 32))


def gripper() -> None:
    palm = [
        (0, circle(0.034, 32)),
        (0.003, circle(0.036, 32)),
        (0.014, circle(0.036, 32)),
        (0.03, squircle(0.03, 0.062, 4, 32)),
        (0.034, squircle(0.032, 0.066, 5, 32)),
        (0.066, squircle(0.032, 0.066, 5, 32)),
        (0.07, squircle(0.029, 0.063, 5, 32)),
    ]
    write("gripper2/meshes/base.obj", loft(palm))

    blade = [(0.01, 0.012, 0.008, 0.016), (0.03, 0.012, 0.008, 0.015), (0.05, 0.011, 0.006, 0.0115)]
    tip = [(0.084, 0.011, 0.004, 0.0105), (0.088, 0.009, 0.003, 0.0105)]
    outlines = [(z, squircle(a, b, 6, 24) + np.array([0, y])) for z, a, b, y in [*blade, *tip]]
    write("gripper2/meshes/finger.stl", joined(box((-0.014, 0.014), (0.004, 0.032), (0, 0.014)), loft(outlines)))

    write("gripper2/meshes/pinion.stl", loft([(x, gear(0.02, 0.004, 16)) for x in (-0.003, 0.003)], "x"))


def camera_mount() -> None:
    foot = [(0, 0.057), (0.003, 0.06), (0.009, 0.06), (0.012, 0.057), (0.018, 0.02), (0.03, 0.016)]
    write("camera_mount/assets/base.obj", turned(foot, 32))

    body = bevelled(squircle(0.0125, 0.05, 6), -0.028, 0.0, 0.003)
    lenses = [moved(turned([(-0.005, 0.009), (0.003, 0.008)], 16), (0, y, 0)) for y in (-0.03, 0.0, 0.03)]
    write("camera_mount/assets/camera.stl", joined(body, *lenses))


def table() -> None:
    """Boards of wood, each with a grain of its own; the pattern goes on over every edge."""
    size = 128
    boards = 4
    shades = 24
    random = np.random.default_rng(6)
    v, u = np.mgrid[0:size, 0:size] / size
    board = np.floor(u * boards).astype(int)
    phase = 2 * np.pi * random.random((boards, 4))[board]
    bend = sum(np.sin(2 * np.pi * k * v + phase[..., k]) / k for k in (1, 2, 3))
    across = u + 0.012 * bend
    grain = sum(np.sin(2 * np.pi * k * across + phase[..., 0]) for k in (7, 13, 24)) / 3
    tone = 0.55 + 0.3 * grain + 0.25 * (random.random(boards)[board] - 0.5)
    tone[(u * boards) % 1 < boards / size] *= 0.45
    indices = np.clip(tone * shades, 0, shades - 1).astype(np.uint8)
    mix = np.linspace(0, 1, shades)[:, None]
    palette = ((1 - mix) * [128, 86, 54] + mix * [214, 172, 124]).astype(np.uint8)
    write_png("table/textures/wood.png", indices, palette)


if __name__ == "__main__":
    arm()
    gripper()
    camera_mount()
    table()
