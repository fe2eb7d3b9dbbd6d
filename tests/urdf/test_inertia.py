"""Inertias that no body can have."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from lxml import etree
from mjcompose.tree.unit import Unit
from mjcompose.urdf.inertia import eigen, reads_turned
from mjcompose.urdf.read import UrdfReader
from urdf.parts import ARM, joint, link, robot

Reader = Callable[..., UrdfReader]


def unit_of(reader: UrdfReader) -> Unit:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    return unit


def inertial(mass: float, *diagonal: float, xy: float = 0.0) -> str:
    x, y, z = diagonal
    return f'<inertial><mass value="{mass}"/><inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="{xy}" ixz="0" iyz="0"/></inertial>'


def test_eigen_is_that_of_numpy() -> None:
    random = np.random.default_rng(0)
    for _ in range(100):
        half = random.normal(size=(3, 3)) * 10.0 ** random.integers(-6, 3)
        tensor = half @ half.T
        values, axes = eigen(tensor.tolist())
        assert np.allclose(values, np.linalg.eigvalsh(tensor), rtol=1e-9, atol=1e-12 * values[2])
        assert np.allclose(np.array(axes) @ np.diag(values) @ np.array(axes).T, tensor, atol=1e-12 * values[2])


BROKEN = {
    "triangle": inertial(1, 0.1, 0.1, 0.5),
    "negative": inertial(1, 0.1, 0.1, 0.1, xy=0.2),
    "flat": inertial(1, 0.0, 0.1, 0.1),
}


@pytest.mark.parametrize("broken", BROKEN.values(), ids=BROKEN)
def test_it_is_an_error_at_its_place(reader: Reader, broken: str) -> None:
    read = reader("r.urdf", robot(ARM[0], link("upper", broken), *ARM[2:]))
    assert read.unit() is None
    (error,) = read.sink.errors
    assert (error.code, error.span and error.span.line) == ("urdf-inertia", 3)
    assert "`upper`" in error.message and "repair" in str(error.help)


@pytest.mark.parametrize("broken", BROKEN.values(), ids=BROKEN)
def test_it_is_mended_with_a_warning(reader: Reader, broken: str) -> None:
    read = reader("r.urdf", robot(ARM[0], link("upper", broken), *ARM[2:]), inertia="repair")
    unit = read.unit()
    assert unit is not None, [each.message for each in read.sink.errors]
    assert [each.code for each in read.sink.sorted()][:1] == ["urdf-inertia"]
    (upper,) = (body for body in unit.root.iter("body") if body.get("name") == "upper")
    found = upper.find("inertial")
    assert found is not None and found.get("mass") == "1"


@pytest.mark.parametrize(
    "small",
    [
        inertial(1e-7, 3e-22, 3e-22, 5e-22),
        inertial(1, 9e-15, 9e-15, 9e-15),
        pytest.param(
            inertial(1, 1e-14, 1e-14, 1e-14, xy=1e-15),
            marks=pytest.mark.skipif(
                not reads_turned(mujoco, None),
                reason="MuJoCo 3.12 looks at what the file has, not at the principal moments",
            ),
        ),
        inertial(1e-20, 0.1, 0.1, 0.1),
        inertial(0, 0.1, 0.1, 0.1),
    ],
)
def test_what_is_below_the_bounds_of_mujoco_is_named_and_mended(reader: Reader, small: str) -> None:
    parts = (ARM[0], link("upper", small), *ARM[2:])
    read = reader("r.urdf", robot(*parts))
    assert read.unit() is None
    (error,) = read.sink.errors
    assert (error.code, error.span and error.span.line) == ("urdf-inertia", 3)
    assert "inertia: repair" in str(error.help)
    assert reader("r.urdf", robot(*parts), inertia="repair").unit() is not None


def test_a_light_link_that_is_fixed_is_left_alone(reader: Reader) -> None:
    tip = link("tip", inertial(1e-20, 0.1, 0.1, 0.1))
    broken = link("upper", BROKEN["triangle"])
    parts = (ARM[0], broken, *ARM[2:], tip, joint("tip", "fore", "tip", kind="fixed"))
    read = reader("r.urdf", robot(*parts), inertia="repair")
    assert read.unit() is not None
    assert "`tip`" not in " ".join(each.message for each in read.sink.sorted())


ZERO = '<geometry><box size="0 0 0"/></geometry>'


@pytest.mark.parametrize("choice", [None, "repair"])
def test_a_size_of_zero_is_no_inertia(reader: Reader, choice: str | None) -> None:
    base = link("base", f"<visual>{ZERO}</visual>{inertial(0.001, 0, 0, 0)}")
    read = reader("r.urdf", robot(base, *ARM[1:]), visuals="keep", inertia=choice)
    assert read.unit() is None
    (fault,) = [each for each in read.sink.sorted() if each.severity != "note"]
    assert fault.code == "mujoco-rejects" and "`size` of `<box>`" in fault.message


@pytest.mark.parametrize(("visuals", "tag"), [(None, "sphere"), ("drop", "sphere"), ("keep", "box")])
def test_a_size_of_zero_is_that_of_a_shape_that_is_read(reader: Reader, visuals: str | None, tag: str) -> None:
    shapes = f'<visual>{ZERO}</visual><collision><geometry><sphere radius="0"/></geometry></collision>'
    read = reader("r.urdf", robot(link("base", shapes), *ARM[1:]), visuals=visuals)
    assert read.unit() is None
    (error,) = read.sink.errors
    assert f"of `<{tag}>`" in error.message


def test_the_axes_stay_and_the_large_moments_too(reader: Reader) -> None:
    read = reader("r.urdf", robot(ARM[0], link("upper", inertial(1, 0.1, 0.2, 0.5)), *ARM[2:]), inertia="repair")
    unit = read.unit()
    assert unit is not None
    (upper,) = (body for body in unit.root.iter("body") if body.get("name") == "upper")
    found = upper.find("inertial")
    assert found is not None
    moments = sorted(float(each) for each in str(found.get("diaginertia") or found.get("fullinertia")).split()[:3])
    assert moments == pytest.approx([0.2, 0.3, 0.5])


def test_a_link_that_moves_without_mass(reader: Reader) -> None:
    parts = (ARM[0], link("virtual", ""), ARM[1], joint("a", "base", "virtual"), joint("b", "virtual", "upper"))
    read = reader("r.urdf", robot(*parts))
    assert read.unit() is None and [each.code for each in read.sink.errors] == ["urdf-inertia"]
    assert reader("r.urdf", robot(*parts), inertia="repair").unit() is not None


def test_what_mujoco_accepts_is_not_touched(reader: Reader) -> None:
    zeros = inertial(0, 0, 0, 0)
    parts = (*ARM, link("tip", zeros), joint("tip", "fore", "tip", kind="fixed"))
    read = reader("r.urdf", robot(*parts), inertia="repair")
    assert read.unit() is not None
    assert "urdf-inertia" not in {each.code for each in read.sink.sorted()}


def turned(rpy: str) -> str:
    inside = f'<inertial><origin xyz="0.1 0.2 0.3" rpy="{rpy}"/><mass value="2"/>{_MOMENTS}</inertial>'
    return robot(ARM[0], link("upper", inside), *ARM[2:])


_MOMENTS = '<inertia ixx="0.02" iyy="0.05" izz="0.06" ixy="0.004" ixz="-0.003" iyz="0.002"/>'


def moments_of(reader: UrdfReader, name: str = "upper") -> tuple[np.ndarray, np.ndarray]:
    """Return the inertia of a body in its frame, and its center of mass, as MuJoCo compiles them."""
    (body,) = (each for each in unit_of(reader).root.iter("body") if each.get("name") == name)
    inertial = etree.tostring(body.find("inertial")).decode()
    text = f"<mujoco><worldbody><body><joint/>{inertial}</body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    axes = rotation(model.body_iquat[1])
    return axes @ np.diag(model.body_inertia[1]) @ axes.T, model.body_ipos[1]


def rotation(quat: np.ndarray) -> np.ndarray:
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quat)
    return matrix.reshape(3, 3)


@pytest.mark.parametrize("rpy", ["0 0 1.5707963267948966", "0.3 -0.5 1.1", "-2 0.7 0", "3.14159 0 0.4"])
def test_an_inertia_is_in_the_axes_of_its_origin(reader: Reader, rpy: str) -> None:
    """MuJoCo 3.11 to 3.13 ignore `rpy` of an `<inertial>`. The expected axes are those of a site with `euler`."""
    frame = f'<mujoco><compiler angle="radian" eulerseq="XYZ"/><worldbody><site euler="{rpy}"/></worldbody></mujoco>'
    axes = rotation(mujoco.MjModel.from_xml_string(frame).site_quat[0])
    written = np.array([[0.02, 0.004, -0.003], [0.004, 0.05, 0.002], [-0.003, 0.002, 0.06]])
    moments, center = moments_of(reader("r.urdf", turned(rpy)))
    assert np.allclose(moments, axes @ written @ axes.T, atol=1e-9)
    assert np.allclose(center, [0.1, 0.2, 0.3])


def test_an_inertia_that_is_repaired_is_turned_too(reader: Reader) -> None:
    text = turned("0 0 1.5707963267948966").replace('iyy="0.05"', 'iyy="0.5"')
    moments, _ = moments_of(reader("r.urdf", text, inertia="repair"))
    assert np.isclose(moments[0, 0], 0.5, rtol=1e-3) and moments[1, 1] < 0.49


BOX = '<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'


def guessed(reader: UrdfReader) -> list[str]:
    unit_of(reader)
    return [each.message for each in reader.sink.sorted() if each.code == "urdf-mass"]


def test_links_without_mass_are_one_note(reader: Reader) -> None:
    text = robot(ARM[0], link("upper", BOX), link("fore", BOX), *ARM[3:])
    expected = "2 links have no `<inertial>` and weigh as much as their shapes at 1000 kg/m³: `upper`, `fore`"
    assert guessed(reader("r.urdf", text)) == [expected]
    assert guessed(reader("r.urdf", robot(*ARM))) == []


def test_what_is_fixed_in_the_world_needs_no_mass(reader: Reader) -> None:
    stand = joint("stand", "base", "upper", kind="fixed")
    text = robot(link("base", BOX), link("upper", BOX), ARM[2], stand, ARM[4])
    assert guessed(reader("r.urdf", text)) == []
    moving = reader("r.urdf", text)
    moving.is_fixed_in_world = False
    assert [message.partition(" ")[0] for message in guessed(moving)] == ["2"]
