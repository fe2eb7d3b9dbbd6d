"""Numbers that follow from a drawn pose, compared with what MuJoCo compiles from the pose itself."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from composer.compiled.varying import flat
from composer.verify.run_time import are_close
from composer.verify.worlds import Computed, _following

MODEL = """<mujoco><worldbody>
  <body name="fixed" pos="{fixed}"/>
  <body name="first" mocap="true" pos="{first}" quat="{first_quat}"/>
  <body name="loose" pos="{loose}"><freejoint/><geom size=".1"/></body>
  <body name="second" mocap="true" pos="{second}" quat="{second_quat}"/>
  <body name="third" mocap="true" pos="{third}"/>
</worldbody><keyframe>
  <key name="plain"/><key name="own" mpos="9 9 9 8 8 8 7 7 7" qpos="1 1 1 1 0 0 0"/><key name="again"/>
</keyframe></mujoco>"""
POSES = {
    "fixed": "5 5 5", "first": "1 2 3", "loose": "4 5 6", "second": "7 8 10", "third": "11 12 13",
    "first_quat": "1 0 0 0", "second_quat": ".6 .8 0 0",
}  # fmt: skip


def compiled(**poses: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MODEL.format(**{**POSES, **poses}))


@pytest.mark.parametrize("name", ["fixed", "first", "loose", "second", "third"])
@pytest.mark.parametrize("component", range(3))
def test_what_follows_from_a_position_is_what_mujoco_copies(name: str, component: int) -> None:
    numbers = POSES[name].split()
    numbers[component] = "20"
    before, after = compiled(), compiled(**{name: " ".join(numbers)})
    changed = {
        (array, int(index))
        for array in ("qpos0", "qpos_spring", "key_qpos", "key_mpos", "key_mquat", "body_ipos")
        for index in np.flatnonzero(flat(before, array) != flat(after, array))
    }
    target = {"array": "body_pos", "index": [before.body(name).id, component]}
    found = [place for _, places in _following(before, [{"targets": [target]}]) for place in places]
    assert set(found) == changed and len(found) == len(changed)


@pytest.mark.parametrize(("name", "mocap"), [("first", 0), ("second", 1), ("third", 2)])
def test_an_orientation_goes_into_every_key_that_has_it(name: str, mocap: int) -> None:
    model = compiled()
    target = {"array": "body_quat", "index": [model.body(name).id, 2]}
    found = [place for _, places in _following(model, [{"targets": [target]}]) for place in places]
    assert [index for array, index in found if array == "key_mquat"] == [
        key * 12 + mocap * 4 + 2 for key in range(3)
    ]


@pytest.mark.parametrize("given", ["meaninertia", "meanmass"])
def test_a_mean_that_is_given_is_not_computed(given: str) -> None:
    text = MODEL.format(**POSES).replace("<keyframe>", f'<statistic {given}="7"/><keyframe>')
    model = mujoco.MjModel.from_xml_string(text)
    computed = Computed(mujoco, model, mujoco.MjData(model))
    before = model.stat.meaninertia, model.stat.meanmass
    model.body_mass[3] *= 2
    model.body_inertia[3] *= 2
    computed.settle()
    other = "meanmass" if given == "meaninertia" else "meaninertia"
    assert getattr(model.stat, given) == 7
    assert getattr(model.stat, other) > 1.5 * before[other == "meanmass"]


def test_infinite_numbers_are_near_themselves_alone() -> None:
    inf = np.inf
    pairs = [
        (inf, inf),
        (-inf, -inf),
        (inf, -inf),
        (1, inf),
        (inf, 1),
        (np.nan, np.nan),
        (np.nan, inf),
        (1, 1),
    ]
    assert [are_close(*pair) for pair in pairs] == [True, True, False, False, False, True, False, True]
