from __future__ import annotations

import mujoco
import pytest
from lxml import etree

from composer.verify.ignored_attributes import unread


def found(inside: str) -> list[tuple[str, str]]:
    root = etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    return [(str(element.tag), name) for element, name in unread(root)]


def test_below_frames_and_replicates() -> None:
    assert found('<frame><geom siz="1" size="1"/></frame>') == [("geom", "siz")]
    assert found('<body><frame x="1"><body><geom/><joint rang="1"/></body></frame></body>') == [
        ("frame", "x"),
        ("joint", "rang"),
    ]
    assert found('<replicate count="2"><site colour="1"/></replicate>') == [("site", "colour")]


def test_nothing_where_mujoco_looks_itself() -> None:
    assert found('<geom siz="1"/><body odd="1"><geom siz="1"/></body>') == []
    assert found('<frame><unheard_of x="1"/></frame>') == []
    assert (
        found(
            '<frame name="f" pos="0 0 1" childclass="c"><body mocap="true"><geom fitscale="1"/></body></frame>'
        )
        == []
    )


@pytest.mark.parametrize("holder", ["frame", 'replicate count="2"'])
def test_mujoco_does_not_look_there(holder: str) -> None:
    """The reason for all this; the day it looks, this can go."""
    inside = f'<{holder}><geom size="1" colour="1"/></{holder.split()[0]}>'
    assert mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{inside}</worldbody></mujoco>").ngeom > 0
