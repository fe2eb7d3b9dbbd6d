from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from composer.diagnostics.sink import Sink
from composer.link.link import link
from composer.link.linking import Linking
from composer.link.part import Part
from composer.tree.parse import parse_text
from composer.tree.unit import Unit

BODY = '<worldbody><body><joint name="j" {}/><geom size="0.1"/></body></worldbody>{}'
HELD = "<tendon><fixed {}><joint joint='j' coef='1'/></fixed></tendon>"
MOVED = "<actuator><general joint='j' {}/></actuator>"


def unit(text: str, label: str) -> Unit:
    found = parse_text(f"<mujoco>{text}</mujoco>", Sink(), file=f"{label}.xml", directory=Path(), label=label)
    assert found is not None
    return found


def messages(part: str) -> list[str]:
    sink = Sink()
    link(Linking(unit("", "base"), [Part(unit(part, "part"), "p/")], sink))
    return [each.message for each in sink.errors]


@pytest.mark.parametrize(
    ("joint", "other", "is_refused"),
    [
        ('range="-1 1"', "", True),
        ('range="-1 1" limited="true"', "", False),
        ('range="-1 1" limited="false"', "", False),
        ('range="0 0"', "", False),
        ('type="free" range="-1 1"', "", False),
        ('type="free" actuatorfrcrange="-1 1"', "", False),
        ('type="ball" range="0 1"', "", True),
        ('type="ball" actuatorfrcrange="-1 1"', "", False),
        ('actuatorfrcrange="-1 1"', "", True),
        ("", HELD.format('range="0 1"'), True),
        ("", HELD.format('range="0 1" limited="true"'), False),
        ("", MOVED.format('ctrlrange="0 1"'), True),
        ("", MOVED.format('forcerange="0 1"'), True),
        ("", MOVED.format('dyntype="integrator" actrange="0 1"'), True),
        ("", MOVED.format('ctrlrange="0 1" ctrllimited="false"'), False),
        ("", '<default><joint range="-1 1"/></default>', True),
        ("", '<default><joint range="-1 1" limited="true"/></default>', False),
    ],
)
def test_a_part_is_refused_where_mujoco_refuses_it_alone(joint: str, other: str, is_refused: bool) -> None:
    text = f'<compiler autolimits="false"/>{BODY.format(joint, other)}'
    try:
        mujoco.MjModel.from_xml_string(f"<mujoco>{text}</mujoco>")
        refused_by_mujoco = False
    except ValueError:
        refused_by_mujoco = True
    assert refused_by_mujoco == is_refused
    assert bool(messages(text)) == is_refused
    assert messages(text.replace('"false"/>', '"true"/>', 1)) == []
