from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from foreign import lift
from foreign.by_name import LeftOut, differences, driven_apart

ARM = """<mujoco><option timestep="0.002"/><worldbody><body name="link" pos="0 0 1"><joint name="turn" axis="0 1 0" damping="0.1"/>
  <geom size="0.05" pos="0.3 0 0"/><geom name="tip" size="0.02" pos="0.4 0 0"/><site name="end"/></body></worldbody>
  <actuator><position name="servo" joint="turn" kp="20" ctrlrange="-1 1"/></actuator>
  <sensor><jointpos joint="turn"/></sensor></mujoco>"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('damping="0.1"', 'damping="0.2"', "joint `turn`: damping"),
        ('damping="0.1"', 'armature="5"', "armature"),
        ('damping="0.1"', 'frictionloss="1"', "frictionloss"),
        ('pos="0 0 1"', 'pos="0 0 0.08"', "body `link`: pos"),
        ('kp="20"', 'kp="21"', "actuator `servo`: gainprm"),
        ('name="tip" size="0.02"', 'name="tip" size="0.02" friction="2"', "geom `tip`: friction"),
        ('<geom size="0.05"', '<geom size="0.05" density="1"', "body `link`: mass"),
        ('<geom size="0.05"', '<geom size="0.05" mass="0" condim="4"', "geom `link#1`: condim"),
        ('<site name="end"/>', "", "site `end` is only in the first"),
        ('timestep="0.002"', 'timestep="0.001"', "option timestep"),
        ("<jointpos", "<jointvel", "sensor `#1`: type"),
    ],
)
def test_a_change_is_told(old: str, new: str, said: str) -> None:
    assert old in ARM
    other = ARM.replace(old, new)
    models = [mujoco.MjModel.from_xml_string(text) for text in (ARM, other)]
    assert said in "\n".join(_fields(*models))


def _fields(first: mujoco.MjModel, second: mujoco.MjModel) -> list[str]:
    return [line.replace("dof ", "joint ") for line in differences(first, second, LeftOut())]


def test_the_same_model_is_the_same_and_stays_together() -> None:
    models = [mujoco.MjModel.from_xml_string(text) for text in (ARM, ARM.replace('"tip"', '"g0_col"'))]
    assert list(differences(*models, LeftOut(names="tip|g0_col"))) == []
    assert list(differences(*models, LeftOut(elements="tip|g0_col"))) == []
    assert driven_apart(*models, {"turn": [0.3]}) == 0


def test_a_heavier_link_ends_somewhere_else() -> None:
    models = [mujoco.MjModel.from_xml_string(text) for text in (ARM, ARM.replace('damping="0.1"', 'damping="0.3"'))]
    assert driven_apart(*models, {"turn": [0.3]}) > 1e-6


def test_a_motion_in_which_nothing_moves_is_no_motion() -> None:
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body name="a"><joint/><geom size="1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(AssertionError, match="nothing moves"):
        driven_apart(model, model, {})


def test_the_recipe_of_the_page_is_found() -> None:
    assert lift.recipe().startswith("recipe: 1\nname: lift\n")
    for word in (*lift.ROBOTS, *lift.GRIPPERS):
        assert word in lift.recipe()
    assert Path(lift.PAGE).is_file()
