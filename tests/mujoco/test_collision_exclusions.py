from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco import collision_exclusions
from mjcompose.mujoco.collision_exclusions import Branches, needless

ARM = """\
<mujoco>
  <compiler angle="radian"/>
  <default><geom type="capsule" size="0.04"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="pedestal" pos="0 0 0.2">
      <geom fromto="0 0 -0.1 0 0 0"/>
      <body name="upper">
        <joint name="shoulder" axis="0 1 0" range="-0.5 0.5"/>
        <geom fromto="0 0 0 0 0 0.3"/>
        <body name="fore" pos="0 0 0.3">
          <joint name="elbow" axis="0 1 0" range="-1.5 1.5"/>
          <geom fromto="0 0 0 0 0 0.2"/>
          <body name="hand" pos="0 0 0.2">
            <joint name="wrist" axis="0 1 0" range="-2.9 2.9"/>
            <geom fromto="0 0 0 0 0 0.3"/>
          </body>
        </body>
      </body>
    </body>
    <body name="wall" pos="0.3 0 0.5"><geom type="box" size="0.05 0.3 0.3"/></body>
    <body name="rail" pos="3 0 0.5"><joint type="slide" axis="1 0 0"/><geom type="box" size="0.05 0.3 0.3"/></body>
    <body name="cube" pos="0 3 0.5"><freejoint/><geom type="box" size="0.05 0.3 0.3"/></body>
    <body name="ghost" pos="0 4 0.5"><geom type="box" size="1 1 1" contype="0" conaffinity="0"/></body>
  </worldbody>
  <contact><exclude body1="pedestal" body2="fore"/></contact>
  <keyframe><key name="folded" qpos="0 0 2.9 0 0 3 0.5 1 0 0 0"/></keyframe>
</mujoco>
"""


def found(samples: int = 200, seed: int = 1, text: str = ARM) -> dict[tuple[str, ...], tuple[str, str]]:
    model = mujoco.MjModel.from_xml_string(text)
    pairs = needless(mujoco, model, {"samples": samples, "seed": seed})["pairs"]
    return {tuple(each["bodies"]): (each["why"], each["where"]) for each in pairs}


def test_each_pair_has_its_reason() -> None:
    assert found() == {
        ("pedestal", "upper"): ("adjacent", ""),
        ("pedestal", "hand"): ("never", ""),
        ("upper", "hand"): ("touching", "the key `folded`"),
        ("upper", "wall"): ("never", ""),
    }


def test_what_touches_in_some_pose_stays() -> None:
    pairs = found()
    assert ("fore", "wall") not in pairs and ("hand", "wall") not in pairs


def test_a_search_finds_what_few_samples_miss() -> None:
    assert found(1) == found(200)


JAW = '<body name="{}" pos="0 {} 0.1"><joint name="{}" type="slide" axis="0 {} 0" range="0 {}"/>{}</body>'
JAWS = """<mujoco>
  <worldbody><body name="palm"><joint name="roll" axis="0 0 1" range="-3 3"/><geom type="box" size=".02 .1 .02"/>{}{}</body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="l" coef="1"/></fixed><fixed name="u"><joint joint="r" coef="1"/></fixed></tendon>
  <equality>{}</equality>
  <actuator>{}</actuator>
  <keyframe><key name="closed" qpos="0 0 0"/><key name="open" qpos="0 .04 .04"/></keyframe>
</mujoco>"""
PAD = '<geom type="box" size="0.01 0.005 0.02"/>'


@pytest.mark.parametrize(
    ("gap", "equality", "actuator"),
    [
        (0.0, '<joint joint1="l" joint2="r"/>', '<position tendon="t"/>'),  # they touch where both are at 0
        (0.0, '<tendon tendon1="u" tendon2="t"/>', '<motor joint="l"/>'),
        (0.0, '<joint joint1="l" joint2="r"/><joint joint1="l" joint2="roll"/>', '<motor joint="roll"/>'),
        (0.001, "", '<position joint="l"/><motor joint="r"/>'),  # samples miss the last millimetre
        (0.05, "", '<position joint="l"/><position joint="r"/>'),  # a hard grasp of something thin bends the limits
    ],
)
def test_jaws_that_an_actuator_closes_collide(gap: float, equality: str, actuator: str) -> None:
    at = 0.005 + gap / 2
    jaws = (JAW.format("left", at, "l", 1, 0.04, PAD), JAW.format("right", -at, "r", -1, 0.04, PAD))
    assert ("left", "right") not in found(50, text=JAWS.format(*jaws, equality, actuator))
    if gap > 0.01:  # nothing closes them
        assert ("left", "right") in found(50, text=JAWS.format(*jaws, equality, ""))


def test_jaws_that_overlap_everywhere_do_not() -> None:
    jaws = [JAW.format(name, 0, joint, y, 0.004, PAD) for name, joint, y in (("left", "l", 1), ("right", "r", -1))]
    text = JAWS.format(*jaws, "", '<motor joint="l"/><motor joint="r"/>').replace(".04 .04", ".004 .004")
    assert found(50, text=text)["left", "right"] == ("touching", "the reference configuration")


def test_fingers_coupled_by_a_loop_are_jaws() -> None:
    """The pads of a linkage have no actuator of their own: a `connect` moves them."""
    finger = (
        '<body name="{0}_crank" pos="0 {1} 0"><joint name="{0}" axis="1 0 0" range="0 .8"/>'
        '<geom size=".004" pos="0 0 .05"/></body><body name="{0}_pad" pos="0 {2} 0">'
        '<joint axis="1 0 0" range="0 .8"/><geom size=".004" pos="0 0 .1"/></body>'
    )
    text = (
        f'<mujoco><worldbody><body name="palm"><geom size=".01"/>{finger.format("l", 0.05, 0.06)}'
        f"{finger.format('r', -0.05, -0.06)}</body></worldbody>"
        '<equality><connect body1="l_crank" body2="l_pad" anchor="0 0 .05"/>'
        '<connect body1="r_crank" body2="r_pad" anchor="0 0 .05"/></equality>'
        '<actuator><motor joint="l"/><motor joint="r"/></actuator></mujoco>'
    )
    pairs = found(50, text=text)
    assert ("l_pad", "r_pad") not in pairs


def test_what_can_go_away_is_no_claim() -> None:
    assert not any("rail" in pair or "cube" in pair for pair in found())


def test_what_cannot_touch_and_what_is_excluded_is_not_named() -> None:
    assert not any("ghost" in pair for pair in found())
    assert ("pedestal", "fore") not in found()


def test_the_same_seed_gives_the_same() -> None:
    assert found(3, 5) == found(3, 5)


def test_a_body_without_a_name_is_called_by_where_it_is() -> None:
    model = mujoco.MjModel.from_xml_string(ARM.replace('<body name="upper">', "<body>"))
    pairs = needless(mujoco, model, {"samples": 10, "seed": 0})["pairs"]
    first, *_ = [each for each in pairs if not all(each["bodies"])]
    assert first["called"] == ["`pedestal`", "a body in `pedestal`"]


def _chain(count: int, start: str = "0 0 0", name: str = "b") -> str:
    links = "".join(
        f'<body name="{name}{number}" pos="{start if number == 0 else "0 0.01 0.06"}">'
        f'<joint axis="{number % 2} 1 0.3" pos="0.01 0 0.02" range="-20 35"/>'
        '<geom size="0.02 0.02" type="capsule" pos="0 0.005 0"/>'
        for number in range(count)
    )
    return links + "</body>" * count


def _model(*chains: str) -> str:
    return f"<mujoco><worldbody>{''.join(chains)}</worldbody></mujoco>"


def test_no_pose_brings_two_bodies_closer_than_the_bound() -> None:
    slider = (
        '<body name="rail" pos="0.4 0 0"><joint type="slide" axis="1 0 0" range="-0.1 0.2" ref="0.05"/>'
        '<geom type="box" size="0.1 0.02 0.03" pos="0 0.1 0"/><body name="ball" pos="0 0.2 0"><joint type="ball" pos="0 0 0.1"/>'
        '<geom size="0.03" pos="0 0 0.2"/></body></body>'
    )
    model = mujoco.MjModel.from_xml_string(_model(_chain(6), _chain(3, "0 1 0", "c"), slider))
    branches = Branches(mujoco, model)
    data = mujoco.MjData(model)
    random = np.random.default_rng(3)
    pairs = [(one, other) for one in range(1, model.nbody) for other in range(one + 1, model.nbody)]
    bounds = {pair: branches.least_distance(pair) for pair in pairs}
    assert sum(bound > 0 for bound in bounds.values()) > 10
    for _ in range(200):
        for joint in range(model.njnt):
            at = model.jnt_qposadr[joint]
            low, high = model.jnt_range[joint]
            is_ball = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL
            data.qpos[at : at + 1 + 3 * is_ball] = random.normal(size=4) if is_ball else random.uniform(low, high)
        mujoco.mj_kinematics(model, data)
        for (one, other), bound in bounds.items():
            distance = mujoco.mj_geomDistance(
                model, data, model.body_geomadr[one], model.body_geomadr[other], 10.0, None
            )
            assert distance >= bound - 1e-9


def test_arms_that_cannot_reach_each_other_are_not_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collision_exclusions, "_MOST_POSES", 0)
    text = _model(_chain(4), _chain(4, "0 2 0", "c"))
    answer = needless(mujoco, mujoco.MjModel.from_xml_string(text), {"samples": 5, "seed": 1})
    never = {tuple(pair["bodies"]) for pair in answer["pairs"] if pair["why"] == "never"}
    assert {(f"b{one}", f"c{other}") for one in range(4) for other in range(4)} <= never


def test_pairs_without_a_search_still_collide_and_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    model = mujoco.MjModel.from_xml_string(_model(_chain(14)))
    every = needless(mujoco, model, {"samples": 5, "seed": 1})
    monkeypatch.setattr(collision_exclusions, "_MOST_POSES", 200)
    some = needless(mujoco, model, {"samples": 5, "seed": 1})
    assert every["unsearched"] == 0 < some["unsearched"]
    assert len(some["pairs"]) < len(every["pairs"])
