"""Rotations and poses, bit for bit as MuJoCo computes them: `(w, x, y, z)`, meters, radians. It does not need numpy."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mjcompose.base.dataclass import Struct

Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]

IDENTITY_QUAT: Quat = (1.0, 0.0, 0.0, 0.0)
_NOWHERE = (math.nan, math.nan, math.nan, math.nan)  # MuJoCo's result for infinite angles
ORIGIN: Vec3 = (0.0, 0.0, 0.0)
_AXES = {"x": 1, "y": 2, "z": 3}
_NEARLY_UNIT = 1e-14
_TINY = 1e-14
_PARALLEL = 1e-7


class Pose(Struct):
    """A rigid transform: rotate by ``quat``, then translate by ``pos``."""

    pos: Vec3 = ORIGIN
    quat: Quat = IDENTITY_QUAT

    @property
    def is_identity(self) -> bool:
        return self.pos == ORIGIN and self.quat == IDENTITY_QUAT

    @property
    def is_finite(self) -> bool:
        return all(map(math.isfinite, (*self.pos, *self.quat)))

    def __matmul__(self, inner: Pose) -> Pose:
        """Return the pose of ``inner``, which is given in this frame, in the parent of this frame."""
        if self.is_identity:
            return inner
        x, y, z = rotate(self.quat, inner.pos)
        pos = (self.pos[0] + x, self.pos[1] + y, self.pos[2] + z)
        return Pose(pos, normalize(multiply(self.quat, inner.quat)))

    def rounded(self, pos: int = 9, quat: int = 9) -> Pose:
        """Return the pose rounded to these numbers of decimals, without -0."""
        x, y, z = (round(each, pos) + 0.0 for each in self.pos)
        a, b, c, d = (round(each, quat) + 0.0 for each in self.quat)
        return Pose((x, y, z), (a, b, c, d))

    def reflected(self, axis: int, own: int) -> Pose:
        """Return the pose of the mirror image, across an axis, of an object that is symmetric across its `own` axis.

        >>> Pose((1.0, 2.0, 3.0), (0.8, 0.0, 0.0, 0.6)).reflected(1, 1)
        Pose(pos=(1.0, -2.0, 3.0), quat=(0.8, 0.0, 0.0, -0.6))
        >>> Pose((1.0, 2.0, 3.0)).reflected(0, 1)
        Pose(pos=(-1.0, 2.0, 3.0), quat=(0.0, 0.0, 0.0, 1.0))
        """
        signs = [-1.0 if each == axis else 1.0 for each in range(3)]
        x, y, z = (sign * each + 0.0 for sign, each in zip(signs, self.pos, strict=True))
        a, b, c = (0.0 - sign * each for sign, each in zip(signs, self.quat[1:], strict=True))
        quat: Quat = (self.quat[0], a, b, c)
        if own != axis:  # half a turn about the third axis
            w, i, j, k = (float(each == 4 - axis - own) for each in range(4))
            quat = multiply(quat, (w, i, j, k))
        return Pose((x, y, z), quat)

    def inverse(self) -> Pose:
        w, x, y, z = self.quat
        back: Quat = (w, -x, -y, -z)
        a, b, c = rotate(back, self.pos)
        return Pose((-a, -b, -c), back)


def multiply(a: Quat, b: Quat) -> Quat:
    """Return the Hamilton product: the rotation ``b`` followed by ``a``."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def normalize(quat: Sequence[float]) -> Quat:
    """Return ``quat`` at unit length, bit for bit as in MuJoCo; a unit quaternion stays unchanged."""
    w, x, y, z = quat
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    if norm < _TINY:
        return IDENTITY_QUAT
    # MuJoCo 3.12 to 4.0 leave such a quaternion alone: dividing it changes the last bits of three in ten.
    if abs(norm - 1.0) > _NEARLY_UNIT:
        return (w / norm, x / norm, y / norm, z / norm)
    return (w, x, y, z)


def rotate(quat: Quat, vec: Sequence[float]) -> Vec3:
    """Return ``vec`` turned by ``quat``, through its matrix: the same bits as in MuJoCo."""
    w, x, y, z = quat
    a, b, c = vec
    if quat == IDENTITY_QUAT:
        return (a, b, c)
    ww = w * w
    xx = x * x
    yy = y * y
    zz = z * z
    wx = w * x
    wy = w * y
    wz = w * z
    xy = x * y
    xz = x * z
    yz = y * z
    return (
        (ww + xx - yy - zz) * a + 2 * (xy - wz) * b + 2 * (xz + wy) * c,
        2 * (xy + wz) * a + (ww - xx + yy - zz) * b + 2 * (yz - wx) * c,
        2 * (xz - wy) * a + 2 * (yz + wx) * b + (ww - xx - yy + zz) * c,
    )


def quat_from_euler(euler: Sequence[float], sequence: str) -> Quat:
    """Convert Euler angles in radians; lower-case letters rotate about moving axes, upper-case about fixed ones."""
    quat = IDENTITY_QUAT
    for angle, letter in zip(euler, sequence, strict=True):
        if not math.isfinite(angle):
            return _NOWHERE
        turn = [math.cos(angle / 2), 0.0, 0.0, 0.0]
        turn[_AXES[letter.lower()]] = math.sin(angle / 2)
        step: Quat = (turn[0], turn[1], turn[2], turn[3])
        quat = multiply(quat, step) if letter.islower() else multiply(step, quat)
    return normalize(quat)


def quat_from_axisangle(axis: Sequence[float], angle: float) -> Quat:
    """Return a rotation of ``angle`` radians about ``axis`` (any length)."""
    x, y, z = unit(axis)
    if not math.isfinite(angle):
        return _NOWHERE
    half = math.sin(angle / 2)
    return (math.cos(angle / 2), x * half, y * half, z * half)


def quat_from_xyaxes(axes: Sequence[float]) -> Quat:
    """Return the frame whose x axis is ``axes[:3]`` and whose y axis is ``axes[3:]``, made orthogonal to it."""
    x = unit(axes[:3])
    along = x[0] * axes[3] + x[1] * axes[4] + x[2] * axes[5]
    y = unit([axes[3] - x[0] * along, axes[4] - x[1] * along, axes[5] - x[2] * along])
    return _quat_from_columns(x, y, cross(x, y))


def quat_from_zaxis(axis: Sequence[float]) -> Quat:
    """Return the smallest rotation that takes the z axis to ``axis``."""
    x, y, z = unit(axis)
    turn = (-y, x, 0.0)
    sine = math.sqrt(y * y + x * x)
    if sine < _PARALLEL:
        turn = (1.0, 0.0, 0.0)
        sine = 0.0
    return quat_from_axisangle(turn, math.atan2(sine, z))


def euler_of(quat: Quat, sequence: str, near: Sequence[float] = (0.0, 0.0, 0.0)) -> Vec3 | None:
    """Return the Euler angles of a rotation nearest to `near`; at gimbal lock, the first angle keeps its value.

    None if the sequence turns twice in a row about one axis, so most rotations have no angles.

    >>> [round(math.degrees(each), 6) for each in euler_of(quat_from_euler([0.0, math.pi / 2, 0.0], "xyz"), "xyz")]
    [0.0, 90.0, 0.0]
    """
    order: list[int] = []  # of the same turns about moving axes
    for at, letter in enumerate(sequence):
        order = [*order, at] if letter.islower() else [at, *order]
    k, j, i = (_AXES[sequence[at].lower()] for at in order)
    if k == j or j == i:
        return None
    is_proper = i == k
    k = 6 - i - j if is_proper else k
    sign = (i - j) * (j - k) * (k - i) / 2
    q = normalize(quat)
    a = q[0]
    b = q[i]
    c = q[j]
    d = q[k] * sign
    if not is_proper:
        a, b, c, d = a - c, b + d, c + a, d - b
    half = math.atan2(math.hypot(c, d), math.hypot(a, b))
    plus = math.atan2(b, a)
    minus = math.atan2(d, c)
    scale, shift = (1.0, 0.0) if is_proper else (sign, math.pi / 2)
    target = [near[at] for at in reversed(order)]
    if math.sin(2 * half) < _PARALLEL:
        first = target[0]
        is_low = half < math.pi / 4
        solutions = [(first, 2 * half - shift, scale * (2 * plus - first if is_low else 2 * minus + first))]
    else:
        first = plus - minus
        second = 2 * half - shift
        third = scale * (plus + minus)
        other = -second if is_proper else math.pi - second
        solutions = [(first, second, third), (first + math.pi, other, third + math.pi)]
    angles = [0.0, 0.0, 0.0]
    for at, angle in zip(reversed(order), _nearest_turns(solutions, target), strict=True):
        angles[at] = angle
    return (angles[0], angles[1], angles[2])


def _nearest_turns(solutions: list[Vec3], target: Sequence[float]) -> Sequence[float]:
    """Return the solution that is nearest to `target`, with whole turns added to its angles."""
    turn = 2 * math.pi
    shifted = [[a + turn * round((b - a) / turn) for a, b in zip(angles, target, strict=True)] for angles in solutions]
    return min(shifted, key=lambda angles: sum(abs(a - b) for a, b in zip(angles, target, strict=True)))


def axisangle_of(quat: Quat, near: Sequence[float] = (0.0, 0.0, 1.0)) -> tuple[Vec3, float]:
    """Return the axis and the angle of a rotation, in the direction of `near`; without a rotation, the axis is
    `near`.
    """
    w, *axis = normalize(quat)
    size = math.hypot(*axis)
    if size < _TINY:
        return unit(near), 0.0
    sign = -1.0 if sum(a * b for a, b in zip(axis, near, strict=True)) < 0 else 1.0
    x, y, z = (sign * each / size for each in axis)
    return (x, y, z), 2 * math.atan2(size, sign * w)


def unit(vec: Sequence[float]) -> Vec3:
    """Return `vec` at unit length; unchanged if it has that already."""
    x, y, z = vec
    norm = math.sqrt(x * x + y * y + z * z)
    if norm < _TINY:
        return (1.0, 0.0, 0.0)
    return (x / norm, y / norm, z / norm) if abs(norm - 1.0) > _NEARLY_UNIT else (x, y, z)


def cross(a: Sequence[float], b: Sequence[float]) -> Vec3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _quat_from_columns(x: Vec3, y: Vec3, z: Vec3) -> Quat:
    if x[0] + y[1] + z[2] > 0:
        w = 0.5 * math.sqrt(1 + x[0] + y[1] + z[2])
        return normalize((w, (y[2] - z[1]) / (4 * w), (z[0] - x[2]) / (4 * w), (x[1] - y[0]) / (4 * w)))
    if x[0] > y[1] and x[0] > z[2]:
        a = 0.5 * math.sqrt(1 + x[0] - y[1] - z[2])
        return normalize(((y[2] - z[1]) / (4 * a), a, (y[0] + x[1]) / (4 * a), (z[0] + x[2]) / (4 * a)))
    if y[1] > z[2]:
        b = 0.5 * math.sqrt(1 - x[0] + y[1] - z[2])
        return normalize(((z[0] - x[2]) / (4 * b), (y[0] + x[1]) / (4 * b), b, (z[1] + y[2]) / (4 * b)))
    c = 0.5 * math.sqrt(1 - x[0] - y[1] + z[2])
    return normalize(((x[1] - y[0]) / (4 * c), (z[0] + x[2]) / (4 * c), (z[1] + y[2]) / (4 * c), c))
