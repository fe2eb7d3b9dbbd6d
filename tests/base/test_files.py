"""What an editor has is read in place of what the disk has, wherever a file is read."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.base import files
from mjcompose.base.access import ALL
from mjcompose.base.files import TooLarge, unsaved, unsaved_text, untrusted
from mjcompose.base.sink import Sink
from mjcompose.mujoco.engine import CompileRequest, Session
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.sources.reference import SourceError
from mjcompose.sources.store import Store
from mjcompose.tree.parse import parse_file

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no owner of this kind")


def test_ones_own_folder_is_trusted(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    assert untrusted(tmp_path) is None and untrusted(tmp_path, is_temporary=True) is None


def test_a_folder_that_everybody_writes_is_not(tmp_path: Path) -> None:
    tmp_path.chmod(0o777)
    assert untrusted(tmp_path) == "every user may write to it"
    assert untrusted(tmp_path, is_temporary=True) == "every user may remove what others have in it"
    tmp_path.chmod(0o1777)  # as /tmp is
    assert untrusted(tmp_path) == "every user may write to it"
    assert untrusted(tmp_path, is_temporary=True) is None


def test_the_folder_of_another_user_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files.os, "geteuid", lambda: os.stat(tmp_path).st_uid + 1)
    assert untrusted(tmp_path) == "it belongs to another user"


def test_the_store_of_another_user_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files.os, "geteuid", lambda: os.stat(tmp_path).st_uid + 1)
    with pytest.raises(SourceError) as caught:
        Store.of({"MJCOMPOSE_CACHE": str(tmp_path)})
    assert caught.value.code == "store-unusable"
    assert "is not trusted: it belongs to another user" in caught.value.message


@pytest.mark.own_children
def test_mujoco_does_not_work_in_a_folder_that_others_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tmp_path.chmod(0o777)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    with Session() as session:
        answer, _ = session.ask(CompileRequest(tmp_path))
    assert answer["crash"] == "start" and "is not trusted" in answer["error"]


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
    file = tmp_path / "a.xml"
    link = tmp_path / "b.xml"
    file.write_text("old")
    link.symlink_to(file)
    with unsaved({os.path.realpath(file): b"new"}):
        assert ALL.read(link) == b"new"
        with unsaved({os.path.realpath(tmp_path / "c.xml"): b"other"}):
            assert unsaved_text(link) == b"new", "one block adds to the one around it"


def test_text_of_an_editor_has_the_same_bounds_as_a_file(tmp_path: Path) -> None:
    with unsaved({os.path.realpath(tmp_path / "a.xml"): b"x" * 100}), pytest.raises(TooLarge):
        ALL.read(tmp_path / "a.xml", most=99)
