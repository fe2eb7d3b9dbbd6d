from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.multiplied import Copy
from composer.tree.key import Key, PartKeys
from composer.tree.parse import parse_text
from composer.tree.read_row import ReadRow
from composer.tree.unit import Unit

TEXT = """<mujoco><compiler fusestatic="true" angle="radian"/><compiler fusestatic="true" boundmass="1"/></mujoco>"""

KEYED = """<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>
<keyframe><key name="home" qpos="1"/></keyframe></mujoco>"""


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


def test_a_copy_has_everything_and_shares_no_element() -> None:
    unit = parse_text(KEYED, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    joint, element = unit.root.find(".//joint"), unit.root.find(".//key")
    assert joint is not None and element is not None
    several = Copy(joint, (2,))
    key = Key("home", None, element, "a.xml", unit.origins, {"qpos": {joint: [], several: []}})
    unit.part_keys, unit.table = (
        {"arm": PartKeys(1, (key,))},
        (ReadRow("link", 1, "body", "", Span("a.xml", 1, 1)),),
    )
    copy = unit.copied()
    for field in fields(Unit):
        if field.name not in ("root", "header", "origins", "part_keys"):
            assert getattr(copy, field.name) == getattr(unit, field.name), field.name
    (kept,) = copy.part_keys["arm"].keys
    assert [*kept.values["qpos"]] == [copy.root.find(".//joint"), Copy(copy.root.find(".//joint"), (2,))]  # type: ignore[arg-type]
    assert [*key.values["qpos"]] == [joint, several]
