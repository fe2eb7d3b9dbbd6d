"""What an editor has is read in place of what the disk has, wherever a file is read."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.plan.planner import make_plan
from composer.reading.door import ALL
from composer.reading.regular import TooLarge
from composer.reading.unsaved import unsaved, unsaved_text
from composer.tree.parse import parse_file


def test_a_model_its_includes_and_a_recipe_are_read_as_the_editor_has_them(tmp_path: Path) -> None:
    for name in ("arm.xml", "inner.xml", "arm.yaml"):
        (tmp_path / name).write_text("nothing that can be read")
    texts = {
        "arm.xml": b'<mujoco><include file="inner.xml"/></mujoco>',
        "inner.xml": b'<mujoco><worldbody><site name="tip"/></worldbody></mujoco>',
        "arm.yaml": b"recipe: 1\nname: typed\nbase: ./arm.xml\n",
    }
    with unsaved({os.path.realpath(tmp_path / name): text for name, text in texts.items()}):
        unit = parse_file(tmp_path / "arm.xml", sink := Sink())
        plan = make_plan(tmp_path / "arm.yaml", Context())
    assert not sink.diagnostics
    assert unit is not None and unit.root.find(".//site") is not None
    assert plan is not None and plan.name == "typed"
    assert make_plan(tmp_path / "arm.yaml", Context()) is None, "it is forgotten after the block"


def test_a_link_is_the_file_that_it_leads_to(tmp_path: Path) -> None:
    file, link = tmp_path / "a.xml", tmp_path / "b.xml"
    file.write_text("old")
    link.symlink_to(file)
    with unsaved({os.path.realpath(file): b"new"}):
        assert ALL.read(link) == b"new"
        with unsaved({os.path.realpath(tmp_path / "c.xml"): b"other"}):
            assert unsaved_text(link) == b"new", "one block adds to the one around it"


def test_text_of_an_editor_has_the_same_bounds_as_a_file(tmp_path: Path) -> None:
    with unsaved({os.path.realpath(tmp_path / "a.xml"): b"x" * 100}), pytest.raises(TooLarge):
        ALL.read(tmp_path / "a.xml", most=99)
