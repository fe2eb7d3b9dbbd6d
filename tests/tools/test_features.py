"""The features of a data set are those of LeRobot's own robots, and what has none is said."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.context import Context
from mjcompose.tools.features import features, to_json
from mjcompose.tools.names import names

MOTORS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
HEAD = '<mujoco><worldbody>{world}<body><joint name="{joint}"/><geom size=".1"/></body></worldbody>'
SERVO = '<actuator><position name="{}" joint="{}" kp="4"/></actuator></mujoco>'


def read(text: str, folder: Path) -> tuple[dict[str, Any] | None, Context]:
    (folder / "model.xml").write_text(text, encoding="utf-8")
    context = Context(environment={}, folder=folder)
    found = names("model.xml", context)
    assert found is not None, context.sink.diagnostics
    return features(found, context.sink), context


def one(world: str = "", joint: str = "elbow", actuator: str = SERVO) -> str:
    return HEAD.format(world=world, joint=joint) + actuator.format(joint, joint)


def arm(prefixes: tuple[str, ...] = ("",)) -> str:
    """Arms with the motors of an SO-101, and a camera each."""
    bodies = ""
    motors = ""
    for prefix in prefixes:
        joints = "".join(f'<joint name="{prefix}{name}" axis="{at} 1 0"/>' for at, name in enumerate(MOTORS))
        camera = f'<camera name="{prefix}wrist" resolution="640 480"/>'
        bodies += f'<body>{joints}<geom size=".1"/>{camera}</body>'
        motors += "".join(f'<position name="{prefix}{name}" joint="{prefix}{name}" kp="4"/>' for name in MOTORS)
    return f"<mujoco><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>"


def test_an_arm_has_the_features_of_the_follower(tmp_path: Path) -> None:
    found, context = read(arm(), tmp_path)
    motors = [f"{name}.pos" for name in MOTORS]
    assert found == {
        "observation.state": {"dtype": "float32", "shape": [6], "names": motors},
        "action": {"dtype": "float32", "shape": [6], "names": motors},
        "observation.images.wrist": {
            "dtype": "video",
            "shape": [480, 640, 3],
            "names": ["height", "width", "channels"],
        },
    }
    assert context.sink.diagnostics == []
    assert json.loads(to_json(found)) == found


def test_two_arms_have_the_names_of_the_pair(tmp_path: Path) -> None:
    """LeRobot's `bi_so_follower` has `left_shoulder_pan.pos` and no `/` in names of features."""
    found, _ = read(arm(("left/", "right/")), tmp_path)
    assert found is not None
    assert found["action"]["names"][::6] == ["left_shoulder_pan.pos", "right_shoulder_pan.pos"]
    assert [name for name in found if "images" in name] == [
        "observation.images.left_wrist",
        "observation.images.right_wrist",
    ]


def test_lerobot_makes_the_same(tmp_path: Path) -> None:
    try:
        utils = importlib.import_module("lerobot.datasets.utils")
    except ImportError:
        pytest.skip("lerobot is not installed")
    found, _ = read(arm(), tmp_path)
    assert found is not None
    own = dict.fromkeys((f"{name}.pos" for name in MOTORS), float)
    cameras = {"wrist": (480, 640, 3)}
    expected = {
        **utils.hw_to_dataset_features({**own, **cameras}, "observation"),
        **utils.hw_to_dataset_features(own, "action"),
    }
    assert found == json.loads(json.dumps(expected))


@pytest.mark.parametrize(
    ("motor", "name"),
    [
        ('<position name="m" joint="elbow" kp="4"/>', "m.pos"),
        ('<velocity name="m" joint="elbow" kv="4"/>', "m.vel"),
        ('<motor name="m" joint="elbow"/>', "m.torque"),
        ('<motor name="m" joint="elbow" gear="3"/>', "m"),
        ('<general name="m" joint="elbow" gainprm="7" biasprm="1 2 3" biastype="affine"/>', "m"),
    ],
)
def test_an_end_says_what_is_commanded(motor: str, name: str, tmp_path: Path) -> None:
    found, _ = read(one(actuator=f"<actuator>{motor}</actuator></mujoco>"), tmp_path)
    assert found is not None
    assert found["action"]["names"] == [name]
    assert found["observation.state"]["names"] == ["elbow.pos"]


def test_joints_without_a_motor_are_no_state(tmp_path: Path) -> None:
    cube = '<body><freejoint name="cube"/><geom size=".1"/></body>'
    found, _ = read(one(world=cube), tmp_path)
    assert found is not None
    assert found["observation.state"]["names"] == ["elbow.pos"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (one(world='<camera name="front"/>'), "camera `front`: no resolution, so the data set has no images"),
        (one(world='<camera resolution="9 9"/>'), "1 camera without a name: the data set has no images of it"),
        (
            one(
                actuator='<tendon><fixed name="t"><joint joint="elbow" coef="1"/></fixed></tendon>'
                '<actuator><motor name="pull" tendon="t"/></actuator></mujoco>'
            ),
            "`observation.state` has no number for actuator `pull`",
        ),
    ],
)
def test_nothing_is_left_out_without_a_word(text: str, said: str, tmp_path: Path) -> None:
    found, context = read(text, tmp_path)
    assert found is not None
    assert not [name for name in found if "images" in name]
    (warning,) = context.sink.diagnostics
    assert (warning.code, warning.message, warning.severity.value) == ("target-loss", said, "warning")


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (one(actuator="</mujoco>"), "target-cannot", "the model has no actuators"),
        (one(actuator='<actuator><motor joint="elbow"/></actuator></mujoco>'), "target-cannot", "1 actuator without"),
        (
            one(
                world='<camera name="a/b" resolution="9 9"/><camera name="a_b" resolution="9 9"/>',
            ),
            "name-clash",
            "two cameras would both be `observation.images.a_b`",
        ),
        (
            one(
                joint="l/elbow",
                actuator='<actuator><motor name="l/a" joint="l/elbow"/><motor name="l_a" joint="l/elbow"/></actuator></mujoco>',
            ),
            "name-clash",
            "two numbers of `action` would both be `l_a.torque`",
        ),
    ],
)
def test_what_a_data_set_cannot_have(text: str, code: str, said: str, tmp_path: Path) -> None:
    found, context = read(text, tmp_path)
    assert found is None
    (error,) = context.sink.errors
    assert error.code == code and said in error.message and error.help
