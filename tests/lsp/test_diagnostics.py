"""Faults while a recipe is being written: at once, in the file that has them, at the right characters."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsp.client import Editor, stretch
from lsp.conftest import needs_robots

MODEL = '<mujoco><worldbody><body name="b"><site name="tip"/><geom size="1"/></body></worldbody></mujoco>'
ARM = "recipe: 1\nbase: ./arm.xml\nattach:\n  tool:\n    model: ./tool.xml\n    site: tip\n"


@pytest.fixture
def small(folder: Path) -> Path:
    """A folder in that of the editor with two models."""
    made = folder / "small"
    made.mkdir(exist_ok=True)
    (made / "arm.xml").write_text(MODEL)
    (made / "tool.xml").write_text(MODEL)
    return made


def test_the_shipped_demo_has_none(editor: Editor) -> None:
    assert editor.diagnostics(editor.open("demo.yaml")) == []


def test_a_wrong_name_is_reported_at_its_place_and_goes_when_it_is_put_right(editor: Editor, small: Path) -> None:
    uri = editor.open("small/a.yaml", ARM.replace("site: tip", "site: tipp"))
    (found,) = editor.diagnostics(uri)
    assert (found["code"], found["severity"], found["source"]) == ("attach-place", 1, "mjcompose")
    assert "did you mean `site: tip`?" in found["message"]
    assert stretch(found["range"], ARM.replace("tip\n", "tipp\n")) == "tipp"
    editor.change(uri, ARM)
    assert editor.diagnostics(uri) == []


@pytest.mark.parametrize("ends", ["\n", "\r\n"], ids=["LF", "CRLF"])
def test_columns_are_counted_as_editors_do(editor: Editor, small: Path, ends: str) -> None:
    text = 'recipe: 1\ndescription: "🤖 \u2028 é"\nattach: {"🤖": {model: ./tool.xml, "sit🤖": x}}\n'.replace(
        "\n", ends
    )
    uri = editor.open("small/emoji.yaml", text)
    found = {each["code"]: each for each in editor.diagnostics(uri)}
    assert stretch(found["unknown-key"]["range"], text) == '"sit🤖"'


def test_another_encoding_is_heeded_where_the_editor_asks_for_it(folder: Path, small: Path) -> None:
    text = 'recipe: 1\nattach: {"🤖": {model: ./tool.xml, sitt: x}}\n'
    with Editor(folder, encodings=["utf-8"]) as own:
        assert own.capabilities["positionEncoding"] == "utf-8"
        (found,) = own.diagnostics(own.open("small/utf8.yaml", text))
    begin = found["range"]["start"]
    end = found["range"]["end"]
    line = text.splitlines()[1].encode()
    assert line[begin["character"] : end["character"]] == b"sitt"


def test_notes_with_a_place_are_related_places(editor: Editor, small: Path) -> None:
    for name, cone in (("arm", "elliptic"), ("tool", "pyramidal")):
        (small / f"{name}_cone.xml").write_text(MODEL.replace("<mujoco>", f'<mujoco><option cone="{cone}"/>'))
    text = "recipe: 1\nattach:\n  a: {model: ./arm_cone.xml}\n  b: {model: ./tool_cone.xml}\n"
    uri = editor.open("small/conflict.yaml", text)
    reported = editor.diagnostics(uri)
    (found,) = [each for each in reported if each["code"] == "option-conflict"]
    places = [each["location"]["uri"].rpartition("/")[2] for each in found["relatedInformation"]]
    assert places == ["tool_cone.xml", "arm_cone.xml"]
    assert stretch(found["range"], text) == "b", "it is shown at the part that brings it, and in its file"
    (there,) = editor.wait(editor.uri("small/tool_cone.xml"), lambda found: bool(found))
    assert stretch(there["range"], (small / "tool_cone.xml").read_text()) == "pyramidal"


def test_a_fault_in_a_model_is_shown_in_the_model_saved_or_not(editor: Editor, small: Path) -> None:
    uri = editor.open("small/with_model.yaml", ARM)
    assert editor.diagnostics(uri) == []
    model = editor.open("small/tool.xml")
    editor.diagnostics(model)
    editor.change(model, MODEL.replace("<geom ", "<geom nosuch='1' "))
    (found,) = editor.wait(model, lambda found: bool(found))
    assert found["code"] == "unknown-attribute"
    (at_use,) = editor.wait(uri, lambda found: bool(found))
    assert stretch(at_use["range"], ARM) == "tool"
    editor.change(model, MODEL)
    assert editor.wait(model, lambda found: not found) == []
    editor.tell("textDocument/didClose", {"textDocument": {"uri": model}})


def test_a_site_that_is_typed_into_the_model_exists_at_once_in_the_recipe(editor: Editor, small: Path) -> None:
    uri = editor.open("small/typed.yaml", ARM.replace("site: tip", "site: new_tip"))
    assert len(editor.diagnostics(uri)) == 1
    model = editor.open("small/arm.xml")
    editor.change(model, MODEL.replace('"tip"', '"new_tip"'))
    assert editor.wait(uri, lambda found: not found) == []
    editor.tell("textDocument/didClose", {"textDocument": {"uri": model}})
    assert len(editor.wait(uri, lambda found: bool(found))) == 1, "the disk has it no more"
    editor.tell("textDocument/didClose", {"textDocument": {"uri": uri}})


def test_a_nested_recipe_is_read_as_it_is_being_written(editor: Editor, small: Path) -> None:
    (small / "inner.yaml").write_text("recipe: 1\nbase: ./arm.xml\n")
    inner = editor.open("small/inner.yaml")
    uri = editor.open(
        "small/outer.yaml",
        "recipe: 1\nattach:\n  a:\n    model: ./inner.yaml\nsensor:\n  s: {type: force, site: a/tip}\n",
    )
    assert editor.diagnostics(uri) == []
    editor.change(inner, "recipe: 1\nbase: ./arm.xml\nedit:\n  - {select: {site: tip}, rename: top}\n")
    (found,) = editor.wait(uri, lambda found: bool(found))
    assert "`a/tip`" in found["message"]


def test_what_only_mujoco_finds_comes_after_a_pause_and_stays_with_its_line(editor: Editor, small: Path) -> None:
    text = ARM + "check:\n  load: {expect: {attr: mass, equals: 1}}\n"
    uri = editor.open("small/check.yaml", text)
    (found,) = editor.wait(uri, lambda found: bool(found))
    assert (found["code"], found["range"]["start"]["line"]) == ("check-failed", 7)
    editor.change(uri, text.replace("recipe: 1\n", "recipe: 1\nname: x\n"))
    (found,) = editor.diagnostics(uri)
    assert (found["code"], found["range"]["start"]["line"]) == ("check-failed", 8), "before MuJoCo is asked again"
    editor.change(uri, text.replace("equals: 1", "equals: 2"))
    assert editor.diagnostics(uri) == [], "the line is another one"


@pytest.mark.parametrize("text", ["services:\n  web: {image: nginx}\n", "- just\n- a list\n", ""])
def test_other_yaml_is_left_alone(editor: Editor, text: str) -> None:
    uri = editor.open("compose.yaml", text)
    place = {"textDocument": {"uri": uri}, "position": {"line": 0, "character": 0}}
    assert editor.ask("textDocument/completion", place) is None
    editor.diagnostics(editor.open("demo.yaml"))
    assert uri not in editor.published
    editor.tell("textDocument/didClose", {"textDocument": {"uri": uri}})


def test_a_half_written_recipe_stays_a_recipe(editor: Editor, small: Path) -> None:
    uri = editor.open("small/half.yaml", ARM)
    editor.diagnostics(uri)
    editor.change(uri, ARM.replace("recipe: 1", "recip"))
    assert editor.diagnostics(uri)


@needs_robots
def test_robots_of_menagerie(editor: Editor) -> None:
    text = (editor.folder / "menagerie_ur5e_2f85.yaml").read_text()
    uri = editor.open("menagerie_ur5e_2f85.yaml")
    assert editor.diagnostics(uri) == []
    editor.change(uri, text.replace("site: attachment_site\n", "site: attachment\n"))
    found = editor.diagnostics(uri)
    assert any("did you mean `site: attachment_site`?" in each["message"] for each in found)


def test_where_the_text_has_errors_there_is_no_model_for_mujoco_to_judge(editor: Editor, small: Path) -> None:
    text = ARM + "check:\n  load: {expect: {attr: mass, equals: 1}}\n"
    uri = editor.open("small/judged.yaml", text)
    editor.wait(uri, lambda found: [each["code"] for each in found] == ["check-failed"])
    editor.change(uri, text + "sensr: {}\n")
    assert [each["code"] for each in editor.diagnostics(uri)] == ["unknown-key"]


def test_a_file_that_is_there_to_be_included_is_no_model_by_itself(editor: Editor, small: Path) -> None:
    uri = editor.open("small/inner.xml", "<mujocoinclude><worldbody/></mujocoinclude>")
    assert editor.diagnostics(uri) == []
    editor.change(uri, "<mujocoinclude><worldbody></mujocoinclude>")
    assert [each["code"] for each in editor.wait(uri, bool)] == ["xml-syntax"]
