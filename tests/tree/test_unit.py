from __future__ import annotations

from pathlib import Path

from composer.diagnostics.sink import Sink
from composer.tree.parse import parse_text

TEXT = """<mujoco><compiler fusestatic="true" angle="radian"/><compiler fusestatic="true" boundmass="1"/></mujoco>"""


def test_settings_that_are_forgotten_are_nowhere_written() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    assert (unit.settings.fusestatic, unit.settings.boundmass) == ("true", "1")
    unit.forget_settings("fusestatic", "boundmass", "fitaabb")
    assert (unit.settings.fusestatic, unit.settings.boundmass, unit.settings.angle) == (
        "false",
        "0",
        "radian",
    )
    assert [dict(each.attrib) for each in unit.root] == [{"angle": "radian"}, {}]
