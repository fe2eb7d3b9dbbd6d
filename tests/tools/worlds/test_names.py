from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.manifest import index_of
from mjcompose.mujoco.attributes import names
from mjcompose.mujoco.index import index as compiled_index
from mjcompose.tools.worlds.names import (
    UNLIMITED,
    Index as LoadingIndex,
    Numbers,
    UnknownNameError,
    Vector,
    VectorEntry,
)

MODEL = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="a"><joint name="ball" type="ball" range="0 1"/><geom size="0.1"/>
      <body name="b"><joint name="slide" type="slide" range="0 2"/><joint name="hinge"/><geom size="0.1"/>
        <site name="s"/></body>
    </body>
    <body name="c"><freejoint/><geom size="0.1"/></body>
  </worldbody>
  <actuator>
    <motor name="push" joint="slide" ctrlrange="-3 3"/>
    <velocity name="spin" joint="hinge" kv="2"/>
    <intvelocity name="creep" joint="slide" kp="2" actrange="0 1"/>
    <motor name="geared" joint="hinge" gear="5"/>
    <general name="servo" joint="hinge" gainprm="4" biastype="affine" biasprm="0 -4 -1"/>
  </actuator>
  <sensor>
    <gyro name="gyro" site="s" cutoff="7"/><jointpos name="pos" joint="slide"/><actuatorfrc name="torque" actuator="spin"/>
  </sensor>
</mujoco>"""


def index(text: str = MODEL) -> LoadingIndex:
    model = mujoco.MjModel.from_xml_string(text)
    listed = index_of(compiled_index(model, mujoco))
    return LoadingIndex(listed, lambda kind: names(model, kind))


def test_units_are_those_of_what_mujoco_computes() -> None:
    found = index()
    assert dict(zip(found.ctrl.names, found.ctrl.units(), strict=True)) == {
        "push": "N",
        "spin": "rad/s",
        "creep": "m/s",
        "geared": None,
        "servo": "rad",
    }
    assert found.sensordata.units() == ("rad/s", "rad/s", "rad/s", "m", "N m")
    assert found.qpos.units(["slide", "hinge"]) == ("m", "rad")
    assert found.qvel.units("ball") == ("rad/s",) * 3


def test_limits_are_of_single_numbers() -> None:
    found = index()
    assert found.qpos.limits(["slide", "hinge"]).tolist() == [[0, 2], [-np.inf, np.inf]]
    assert np.isinf(found.qpos.limits("ball")).all()  # an angle of the whole, no bound of a quaternion's numbers
    assert found.act.limits("creep").tolist() == [[0, 1]]
    assert found.ctrl.limits("push").tolist() == [[-3, 3]]
    assert found.sensordata.limits("gyro").tolist() == [[-7, 7]] * 3


def test_a_limit_may_be_infinite() -> None:
    """MuJoCo takes `inf`, which JSON has not."""
    found = index(
        MODEL.replace('range="0 2"', 'range="-inf inf"')
        .replace('"-3 3"', '"0 inf"')
        .replace('cutoff="7"', 'cutoff="inf"')
    )
    assert found.qpos.limits("slide").tolist() == [[-np.inf, np.inf]]
    assert found.ctrl.limits("push").tolist() == [[0, np.inf]]
    assert found.sensordata.limits("gyro").tolist() == [[-np.inf, np.inf]] * 3


def test_vectors_are_addressed_as_in_the_model() -> None:
    found = index()
    assert (found.qpos["ball"], found.qpos["slide"], found.qpos.on("c")) == (slice(0, 4), 4, slice(6, 13))
    assert (found.qvel["ball"], found.qvel["hinge"], found.qvel.on("c")) == (slice(0, 3), 4, slice(5, 11))
    assert list(found.act) == ["creep"] and found.act["creep"] == 0
    assert (found.qpos.size, found.qvel.size, found.ctrl.size) == (13, 11, 5)
    assert repr(found) == "<Index: qpos 13, qvel 11, ctrl 5, act 1, sensordata 5>"


def test_a_number_is_no_name() -> None:
    with pytest.raises(TypeError, match="give one or several names"):
        index().qpos[3]  # type: ignore[index]


VECTOR = Vector(
    "qpos",
    "joint",
    [
        VectorEntry("left/a", 0, ("rad",), ((-1, 1),), "l", "arm.xml:3"),
        VectorEntry("left/a/b", 1, ("m",), ((0, 2),), "l"),
        VectorEntry("", 2, ("quaternion",) * 4, (UNLIMITED,) * 4, "ball"),
        VectorEntry("right/a", 6, ("rad",), (UNLIMITED,), "r"),
        VectorEntry("odd*", 7, (), ()),
    ],
    "/",
)


def test_one_number_is_an_int_and_several_a_slice() -> None:
    assert VECTOR["left/a"] == 0
    assert VECTOR.on("ball") == slice(2, 6)
    assert VECTOR.on("l") == slice(0, 2)
    assert VECTOR.on("r") == 6
    assert VECTOR["odd*"] == slice(7, 7)  # what is there is no glob


def test_several_names_are_an_array_in_their_order() -> None:
    found = VECTOR["right/a", "left/a"]
    assert isinstance(found, np.ndarray) and found.dtype == np.intp
    assert found.tolist() == [6, 0]
    assert VECTOR.array("left/a").tolist() == [0]


@pytest.mark.parametrize(
    ("glob", "expected"),
    [("*/a", [0, 6]), ("left/**", [0, 1]), ("{right,left}/a", [0, 6]), ("**/b", [1]), ("/.*a/", [0, 6])],
)
def test_globs_have_the_order_of_the_model(glob: str, expected: list[int]) -> None:
    found = VECTOR[glob]
    assert isinstance(found, np.ndarray)
    assert found.tolist() == expected


def test_limits_and_units_are_told_for_each_number() -> None:
    assert VECTOR.limits(["left/a", "right/a"]).tolist() == [[-1, 1], [-np.inf, np.inf]]
    assert VECTOR.limits().shape == (VECTOR.size, 2) == (7, 2)
    assert VECTOR.units("left/*") == ("rad",)
    assert VECTOR.origin("left/a") == "arm.xml:3"


def test_it_is_a_collection_of_names() -> None:
    assert list(VECTOR) == ["left/a", "left/a/b", "right/a", "odd*"]
    assert "left/a" in VECTOR and "a" not in VECTOR
    assert len(VECTOR) == 5


@pytest.mark.parametrize("name", ["a", "lefta", "left/c*"])
def test_a_name_that_is_not_there_is_told_with_those_that_are(name: str) -> None:
    with pytest.raises(UnknownNameError) as caught:
        VECTOR[name]
    assert isinstance(caught.value, KeyError)
    assert f"the model has no joint `{name}`" in str(caught.value)
    assert "joints that exist:" in str(caught.value) and "right/a" in str(caught.value)


def test_a_regular_expression_that_is_not_valid_is_reported() -> None:
    with pytest.raises(UnknownNameError, match=r"`/\(/` is not valid: missing \)"):
        VECTOR["/(/"]


def test_what_was_meant_is_told() -> None:
    with pytest.raises(UnknownNameError, match="did you mean `left/a`"):
        VECTOR["left/A"]
    with pytest.raises(UnknownNameError, match="no body with a joint `bal`"):
        VECTOR.on("bal")


def test_numbers_of_elements() -> None:
    cameras = Numbers("camera", ["", "left/eye", "right/eye"], "/")
    assert cameras["right/eye"] == 2
    assert cameras["right/eye", "left/eye"].tolist() == [2, 1]
    assert np.asarray(cameras["*/eye"]).tolist() == [1, 2]
    assert len(cameras) == 3 and list(cameras) == ["left/eye", "right/eye"]
