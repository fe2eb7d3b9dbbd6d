"""What was measured of the whole model, by the names that the models attached to it have for their own elements."""

from __future__ import annotations

from pathlib import Path

import pytest

from composer.context import Context
from composer.migrate.attached import Pieces
from composer.migrate.migrate import read

ARM = """\
<mujoco>
  <asset><model name="hand" file="hand.xml"/></asset>
  <worldbody><frame><attach model="hand" body="palm" prefix="l_"/><attach model="hand" body="palm" prefix="r_"/></frame></worldbody>
  <actuator><position name="turn" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
HAND = """\
<mujoco model="hand">
  <asset><model file="tip.xml"/></asset>
  <worldbody><body name="palm"><joint name="j"/><attach model="tip" body="tip" prefix="t_"/></body></worldbody>
  <actuator><position name="grip" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
TIP = """\
<mujoco model="tip">
  <worldbody><body name="tip"><joint name="j"/></body></worldbody>
  <actuator><position name="press" joint="j" kp="1" dampratio="1"/></actuator>
</mujoco>
"""
ALL = {"turn": "1", "l_grip": "2", "r_grip": "2", "l_t_press": "3", "r_t_press": "3"}


@pytest.mark.parametrize(
    ("measured", "hand", "tip"),
    [
        (ALL, {"grip": "2"}, {"press": "3"}),
        ({**ALL, "r_grip": "4"}, {}, {"press": "3"}),
        ({name: value for name, value in ALL.items() if name != "l_t_press"}, {"grip": "2"}, {}),
    ],
    ids=["all the same", "one has another", "one is missing"],
)
def test_an_actuator_has_what_all_of_its_copies_have(
    measured: dict[str, str], hand: dict[str, str], tip: dict[str, str], tmp_path: Path
) -> None:
    for name, text in (("arm", ARM), ("hand", HAND), ("tip", TIP)):
        (tmp_path / f"{name}.xml").write_text(text)
    context = Context(environment={}, folder=tmp_path)
    unit = read(Path("arm.xml"), context)
    assert unit is not None
    pieces = Pieces.of(unit, context)
    assert [each.unit.label for each in pieces.every] == ["arm", "hand", "tip"]
    assert [pieces.measured(each, {"kv": measured})["kv"] for each in pieces.every] == [measured, hand, tip]
    assert [pieces.measured(each, {}) for each in pieces.every] == [{}, {}, {}]
