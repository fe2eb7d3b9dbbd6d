from __future__ import annotations

import mujoco
import pytest
from lxml import etree

from composer.verify.unmoved_flexes import unmoved_flexes

FLEX = '<flexcomp name="f" type="grid" count="3 2 1" spacing=".1 .1 .1" dim="2" radius=".01"/>'


@pytest.mark.parametrize(
    ("inside", "found"),
    [
        (FLEX, []),
        (f'<frame childclass="c">{FLEX}</frame>', []),
        (f'<frame pos="1 2 3">{FLEX}</frame>', ["f"]),
        (f'<frame euler="1 2 3"><replicate count="2"><frame>{FLEX}</frame></replicate></frame>', ["f"]),
        (f'<frame pos="1 2 3"><body>{FLEX}</body></frame>', []),
    ],
)
def test_in_a_frame_with_a_pose(inside: str, found: list[str]) -> None:
    root = etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    assert [flex.get("name") for flex in unmoved_flexes(root, "3.16.0")] == found
    assert not [*unmoved_flexes(root, "4.0.0"), *unmoved_flexes(root, None)]


def test_that_is_what_mujoco_does() -> None:
    text = f'<mujoco><worldbody><frame pos="1 2 3">{FLEX}</frame></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    moved = float(model.body_pos[1][1]) > 1
    assert moved != bool([*unmoved_flexes(etree.fromstring(text), mujoco.__version__)])
