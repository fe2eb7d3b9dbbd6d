from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import mujoco
import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from mjcompose.base import rotation
from mjcompose.base.rotation import Pose, Quat, Vec3

SEQUENCES = ["".join(letters) for letters in itertools.product("xyzXYZ", repeat=3)]
ANGLES = st.floats(-720, 720).map(lambda number: number if abs(number) > 1e-12 else 0.0)
NUMBERS = st.floats(-5, 5).map(lambda number: number if abs(number) > 1e-12 else 0.0)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
AXES = VECTORS.filter(lambda vector: math.hypot(*vector) > 1e-3)
QUATS = st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS).filter(lambda quat: math.hypot(*quat) > 1e-3)

STEADY = settings(max_examples=60, deadline=None, derandomize=True)


def text(values: Sequence[float]) -> str:
    return " ".join(map(repr, values))


def compiled(orientations: Sequence[str], settings: str = 'angle="radian"') -> list[Quat]:
    """What MuJoCo makes of attributes, each on a site of its own."""
    sites = "".join(f"<site {written}/>" for written in orientations)
    xml = f"<mujoco><compiler {settings}/><worldbody>{sites}</worldbody></mujoco>"
    return [tuple(quat) for quat in mujoco.MjModel.from_xml_string(xml).site_quat.tolist()]


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_euler_angles_give_the_bits_that_mujoco_gives(sequence: str) -> None:
    random = np.random.default_rng(SEQUENCES.index(sequence))
    eulers = [
        *random.uniform(-math.pi, math.pi, (40, 3)).tolist(),
        *itertools.product((0.0, math.pi / 2, -math.pi), repeat=3),
    ]
    found = compiled([f'euler="{text(each)}"' for each in eulers], f'angle="radian" eulerseq="{sequence}"')
    assert found == [rotation.quat_from_euler(each, sequence) for each in eulers]


@STEADY
@given(st.lists(st.tuples(ANGLES, ANGLES, ANGLES), min_size=1, max_size=20), st.sampled_from(SEQUENCES))
def test_degrees_become_radians_before_anything_else(eulers: list[Vec3], sequence: str) -> None:
    found = compiled([f'euler="{text(each)}"' for each in eulers], f'eulerseq="{sequence}"')
    radians = [[angle / 180.0 * math.pi for angle in each] for each in eulers]
    assert found == [rotation.quat_from_euler(each, sequence) for each in radians]


def test_a_sequence_must_fit_the_angles() -> None:
    with pytest.raises(ValueError, match="zip"):
        rotation.quat_from_euler((1, 2), "xyz")


@STEADY
@given(st.lists(st.tuples(AXES, ANGLES), min_size=1, max_size=20))
def test_an_axis_and_an_angle_give_the_bits_that_mujoco_gives(turns: list[tuple[Vec3, float]]) -> None:
    found = compiled([f'axisangle="{text((*axis, angle))}"' for axis, angle in turns])
    assert found == [rotation.quat_from_axisangle(axis, angle) for axis, angle in turns]


@STEADY
@example([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1e-11, 0.0, -2.0), (0.0, 3e-8, 1.0), (0.0, -3e-7, -1.0)])
@given(st.lists(AXES, min_size=1, max_size=20))
def test_a_z_axis_gives_the_bits_that_mujoco_gives(axes: list[Vec3]) -> None:
    found = compiled([f'zaxis="{text(axis)}"' for axis in axes])
    assert found == [rotation.quat_from_zaxis(axis) for axis in axes]


@STEADY
@given(st.lists(st.tuples(AXES, AXES), min_size=1, max_size=20))
def test_two_axes_give_the_bits_that_mujoco_gives(axes: list[tuple[Vec3, Vec3]]) -> None:
    axes = [(x, y) for x, y in axes if math.hypot(*rotation.cross(rotation.unit(x), rotation.unit(y))) > 1e-3]
    found = compiled([f'xyaxes="{text((*x, *y))}"' for x, y in axes])
    assert found == [rotation.quat_from_xyaxes((*x, *y)) for x, y in axes]


@pytest.mark.parametrize(
    "axes",
    [
        # Each of the four ways in which a rotation matrix is read: the trace, or one of the axes, is largest.
        (1, 0, 0, 0, 1, 0),
        (1, 0, 0, 0, -1, 0),
        (-1, 0, 0, 0, 1, 0),
        (-1, 0, 0, 0, -1, 0),
        (0, 1, 0, 0, 0, 1),
        (-1, 0.1, 0, 0.1, 0.5, -1),
        (0.1, -1, 0.1, -1, 0, 0.3),
    ],
)
def test_every_way_of_reading_a_matrix(axes: tuple[float, ...]) -> None:
    assert compiled([f'xyaxes="{text(axes)}"']) == [rotation.quat_from_xyaxes(axes)]


@STEADY
@given(st.lists(QUATS, min_size=1, max_size=20))
def test_a_quaternion_is_brought_to_unit_length_as_in_mujoco(quats: list[Quat]) -> None:
    found = compiled([f'quat="{text(quat)}"' for quat in quats])
    assert found == [rotation.normalize(quat) for quat in quats]


def test_what_is_nearly_of_unit_length_is_left_alone() -> None:
    nearly = (math.sqrt(0.5), math.sqrt(0.5) + 1e-16, 0.0, 0.0)
    assert rotation.normalize(nearly) == nearly
    assert rotation.normalize((0, 0, 0, 0)) == rotation.IDENTITY_QUAT


@STEADY
@given(st.lists(st.tuples(VECTORS, QUATS), min_size=1, max_size=6))
def test_frames_in_frames_are_multiplied_as_mujoco_does(steps: list[tuple[Vec3, Quat]]) -> None:
    opening = "".join(f'<frame pos="{text(pos)}" quat="{text(quat)}">' for pos, quat in steps)
    xml = f"<mujoco><worldbody>{opening}<site/>{'</frame>' * len(steps)}</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    found = Pose()
    for pos, quat in reversed(steps):
        found = Pose(pos, rotation.normalize(quat)) @ found
    assert found.pos == pytest.approx(model.site_pos[0], rel=1e-14, abs=1e-13)
    assert found.quat == pytest.approx(model.site_quat[0], abs=1e-14)


@STEADY
@given(VECTORS, QUATS, VECTORS, QUATS)
def test_an_inverse_undoes(pos: Vec3, quat: Quat, other: Vec3, turned: Quat) -> None:
    outer = Pose(pos, rotation.normalize(quat))
    inner = Pose(other, rotation.normalize(turned))
    back = outer.inverse() @ (outer @ inner)
    assert back.pos == pytest.approx(inner.pos, abs=1e-12)
    assert back.quat == pytest.approx(inner.quat, abs=1e-12)


@STEADY
@given(VECTORS, QUATS)
def test_the_identity_moves_no_bit(pos: Vec3, quat: Quat) -> None:
    inner = Pose(pos, quat)
    assert Pose() @ inner == inner
    assert rotation.rotate(rotation.IDENTITY_QUAT, pos) == pos
    assert Pose().is_identity
    assert not Pose((0, 0, 1e-300)).is_identity
    assert not Pose(quat=(-1, 0, 0, 0)).is_identity


@STEADY
@given(QUATS, VECTORS)
def test_a_rotation_is_that_of_its_matrix(quat: Quat, vector: Vec3) -> None:
    quat = rotation.normalize(quat)
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, np.array(quat))
    assert rotation.rotate(quat, vector) == pytest.approx(matrix.reshape(3, 3) @ vector, abs=1e-13)


def test_a_direction_without_length_is_the_x_axis() -> None:
    assert rotation.unit((0, 0, 0)) == (1, 0, 0)
    assert rotation.unit((0, 3, 4)) == (0, 0.6, 0.8)


@pytest.mark.parametrize("angle", [math.inf, -math.inf, math.nan])
def test_angles_without_end_lead_nowhere(angle: float) -> None:
    assert all(map(math.isnan, rotation.quat_from_euler((angle, 0, 0), "xyz")))
    assert all(map(math.isnan, rotation.quat_from_axisangle((0, 0, 1), angle)))


@STEADY
@given(QUATS, VECTORS, QUATS, VECTORS)
@pytest.mark.mujoco4("another order of operations")
def test_a_frame_in_a_frame_is_where_mujoco_puts_it(quat: Quat, pos: Vec3, turned: Quat, other: Vec3) -> None:
    outer = Pose(pos, rotation.normalize(quat))
    inner = Pose(other, rotation.normalize(turned))
    frame, site = (f'pos="{_text(each.pos)}" quat="{_text(each.quat)}"' for each in (outer, inner))
    xml = f"<mujoco><worldbody><frame {frame}><site {site}/></frame></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    there = outer @ inner
    assert tuple(model.site_pos[0]) == there.pos
    assert tuple(model.site_quat[0]) == there.quat


def _text(values: Sequence[float]) -> str:
    return " ".join(map(repr, values))
