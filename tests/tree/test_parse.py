from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.base.sink import Sink
from mjcompose.tree.parse import above, parse_file, parse_text
from mjcompose.tree.xml_text import write

TEXT = """<?xml version="1.0"?>
<!-- license -->
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
        assert [comment.text for comment in each.header] == [" license ", " more "]
        world = each.root.find("worldbody")
        assert world is not None
        assert [comment.text for comment in above(world, each.header)] == [" world "]
        each.section("default")
        assert write(each.root).decode().split("\n")[1:4] == ["  <!-- license -->", "  <!-- more -->", "  <default/>"]


ASSETS = """<mujoco><asset><mesh file="m.obj"/><texture type="cube" file="t.png" fileup="u.png"/>
  <model file="s.xml"/></asset></mujoco>"""


@pytest.mark.parametrize(
    ("there", "found"),
    [
        (["meshes/m.obj", "sub/m.obj"], {"m.obj"}),
        (["sub/m.obj"], {"../sub/m.obj"}),
        ([], {"m.obj"}),
        (["sub/t.png", "sub/u.png", "images/u.png"], {"../sub/t.png", "u.png"}),
        (["s.xml", "sub/s.xml"], {"sub/s.xml"}),
        (["s.xml"], {"s.xml"}),
    ],
)
def test_files_are_looked_for_as_mujoco_does(tmp_path: Path, there: list[str], found: set[str]) -> None:
    for name in ["sub/assets.xml", *there]:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(ASSETS)
    main = tmp_path / "main.xml"
    main.write_text('<mujoco><compiler meshdir="meshes" texturedir="images"/><include file="sub/assets.xml"/></mujoco>')
    unit = parse_file(main, Sink())
    assert unit is not None
    assert found <= {str(value) for element in unit.root.iter() for value in element.values()}


def test_what_the_main_file_names_is_not_looked_for(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text("")
    (tmp_path / "main.xml").write_text(
        '<mujoco><compiler meshdir="meshes"/><asset><mesh file="m.obj"/></asset></mujoco>'
    )
    unit = parse_file(tmp_path / "main.xml", Sink())
    assert unit is not None and unit.root.xpath("//mesh/@file") == ["m.obj"]
