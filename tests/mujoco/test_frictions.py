"""The thresholds below which a friction has no effect, against the contacts that MuJoCo makes."""

from __future__ import annotations

import itertools
import math

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.frictions import thresholds

STACK = """
<mujoco><option timestep="0.002"/><worldbody>
  <geom name="floor" type="plane" size="2 2 .1" friction="0.9 0.02 0.003" condim="{0}" priority="{1}"/>
  <body name="low" pos="0 0 .099"><freejoint/>
    <geom name="low" type="box" size=".1 .1 .1" friction="0.6 0.01 0.002" condim="{2}" priority="{3}"/></body>
  <body name="high" pos="0 0 .298"><freejoint/><geom name="high" type="box" size=".1 .1 .1" friction="1.3 0.03 0.001"/></body>
  <body name="ghost" pos="0 0 .1"><geom name="ghost" size=".05" contype="0" conaffinity="0"/></body>
</worldbody></mujoco>
"""


def used(model: mujoco.MjModel, other: str, number: int) -> float | None:
    """Return the friction that MuJoCo uses between the low box and another geom; None if the contact ignores it."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pair = {model.geom("low").id, model.geom(other).id}
    contact = next(each for each in data.contact if {each.geom1, each.geom2} == pair)
    rows = {1: 1, 3: 2, 4: 3, 6: 5}[int(contact.dim)]
    return float(contact.friction[(0, 2, 3)[number]]) if (0, 2, 3)[number] < rows else None


@pytest.mark.parametrize("number", [0, 1, 2])
@pytest.mark.parametrize("settings", list(itertools.product((3, 6), (0, 2), (3, 4), (0, 1))))
def test_a_friction_acts_from_its_threshold_on(settings: tuple[int, ...], number: int) -> None:
    model = mujoco.MjModel.from_xml_string(STACK.format(*settings))
    question = {"entries": [[{"place": ("low", "low", 0), "number": number}]], "drawn": []}
    ((found,),) = thresholds(mujoco, model, question)
    assert {each["partner"] for each in found} == {"`floor`", "`high`"}
    low = model.geom("low").id
    for each in found:
        least = each["least"]
        for value in (0.0005, 0.0025, 0.015, 0.025, 0.5, 0.8, 1.1, 2.0):
            if math.isfinite(least) and np.isclose(value, least):
                continue
            model.geom_friction[low, number] = value
            acts = used(model, each["partner"].strip("`"), number) == value
            assert acts == (value > least), (each, value)


def test_a_partner_whose_friction_is_drawn_too_is_no_partner() -> None:
    model = mujoco.MjModel.from_xml_string(STACK.format(3, 0, 3, 0))
    places = [("low", "low", 0), ("", "high", 0)]
    ((found,),) = thresholds(mujoco, model, {"entries": [[{"place": places[0], "number": 0}]], "drawn": places})
    assert [each["partner"] for each in found] == ["`floor`"]
