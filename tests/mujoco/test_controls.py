"""Time that passes for a model: it ends, whatever the model does."""

from __future__ import annotations

import time

import mujoco
import pytest
from mjcompose.mujoco.controls import advance, steps_in

SPRING = """<mujoco><option timestep="{timestep}"><flag autoreset="{reset}"/></option><worldbody>
<body><joint type="ball"/><geom size="0.1"/><body><joint {name} type="slide" axis="0 0 1" stiffness="{stiffness}" springref="0.5"/>
<geom size="0.05" mass="0.1"/></body></body></worldbody>{keys}</mujoco>"""
WRONG = {"stiffness": 1e6, "timestep": 0.02}


def of(
    name: str = 'name="spring"', stiffness: float = 1, timestep: float = 0.002, reset: str = "enable", keys: str = ""
) -> mujoco.MjModel:
    xml = SPRING.format(name=name, stiffness=stiffness, timestep=timestep, reset=reset, keys=keys)
    return mujoco.MjModel.from_xml_string(xml)


def test_it_steps_until_a_time_and_no_further() -> None:
    model = of()
    data = mujoco.MjData(model)
    assert advance(mujoco, model, data, 1) is None and abs(data.time - 1) < 0.003
    assert advance(mujoco, model, data, 0.5, begun=1) is None and abs(data.time - 1.5) < 0.003


@pytest.mark.parametrize("reset", ["enable", "disable"])
def test_what_diverges_is_a_sentence_with_the_joint(reset: str) -> None:
    model = of(**WRONG, reset=reset)  # type: ignore[arg-type]
    data = mujoco.MjData(model)
    said = advance(mujoco, model, data, 1e9)
    assert said == "unstable: NaN or a huge acceleration in joint `spring` after 0.04 s"
    unnamed = of("", **WRONG)  # type: ignore[arg-type]
    assert "in joint 1, which has no name" in str(advance(mujoco, unnamed, mujoco.MjData(unnamed), 1))


@pytest.mark.parametrize(("vector", "at", "word"), [("qpos", 4, "position"), ("qvel", 3, "velocity")])
def test_a_number_of_the_state_names_its_joint(vector: str, at: int, word: str) -> None:
    model = of()
    data = mujoco.MjData(model)
    getattr(data, vector)[at] = float("nan")
    assert f"NaN or a huge {word} in joint `spring`" in str(advance(mujoco, model, data, 1))


def test_a_time_that_does_not_pass_ends_too() -> None:
    late = of(keys='<keyframe><key time="1e17"/></keyframe>')
    data = mujoco.MjData(late)
    mujoco.mj_resetDataKeyframe(late, data, 0)
    assert advance(mujoco, late, data, 0.1, begun=data.time) is None and data.time == 1e17
    still = of(timestep=0)
    assert "timestep of the model is 0" in str(advance(mujoco, still, mujoco.MjData(still), 1))


def test_it_takes_no_more_of_this_machine_than_it_may() -> None:
    model = of(timestep=1e-12)
    begun = time.monotonic()
    assert advance(mujoco, model, mujoco.MjData(model), 1, most=0.1) is None
    assert time.monotonic() - begun < 1
    assert steps_in(model, 3600) < 1e10 and steps_in(of(timestep=0), 1) < 1e10
