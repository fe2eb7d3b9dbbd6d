from __future__ import annotations

import mujoco

from composer.compiled.needless import needless

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
    pairs = needless(mujoco, model, {"samples": samples, "seed": seed})
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


def test_few_samples_claim_more() -> None:
    assert set(found(1)) > set(found(200))


def test_what_can_go_away_is_no_claim() -> None:
    assert not any("rail" in pair or "cube" in pair for pair in found())


def test_what_cannot_touch_and_what_is_excluded_is_not_named() -> None:
    assert not any("ghost" in pair for pair in found())
    assert ("pedestal", "fore") not in found()


def test_the_same_seed_gives_the_same() -> None:
    assert found(3, 5) == found(3, 5)


def test_a_body_without_a_name_is_called_by_where_it_is() -> None:
    model = mujoco.MjModel.from_xml_string(ARM.replace('<body name="upper">', "<body>"))
    pairs = needless(mujoco, model, {"samples": 10, "seed": 0})
    (first, *_) = [each for each in pairs if not all(each["bodies"])]
    assert first["called"] == ["`pedestal`", "a body in `pedestal`"]
