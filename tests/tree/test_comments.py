from __future__ import annotations

from pathlib import Path

from composer.diagnostics.sink import Sink
from composer.tree.comments import above
from composer.tree.parse import parse_text
from composer.tree.write import write

TEXT = """<?xml version="1.0"?>
<!-- licence -->
<!-- more -->
<mujoco>
  <!-- world -->
  <worldbody/>
</mujoco>
"""


def test_the_comments_before_the_root_stand_in_it() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    for each in (unit, unit.copied()):
        assert [comment.text for comment in each.header] == [" licence ", " more "]
        world = each.root.find("worldbody")
        assert world is not None
        assert [comment.text for comment in above(world, each.header)] == [" world "]
        each.section("default")
        assert write(each.root).decode().split("\n")[1:4] == [
            "  <!-- licence -->",
            "  <!-- more -->",
            "  <default/>",
        ]
