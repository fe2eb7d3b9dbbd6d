"""From names to places and back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsp.client import MARK, Editor, applied, stretch
from lsp.conftest import RECIPES
from lsp.test_hover import mark

DEMO = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
STUDY = (RECIPES / "payload_study.yaml").read_text(encoding="utf-8")


def places(editor: Editor, method: str, marked: str, name: str = "demo.yaml", **more: Any) -> list[tuple[str, str]]:
    """The files and the texts that a request leads to."""
    params, _ = editor.at(marked, name)
    found = editor.ask(f"textDocument/{method}", {**params, **more})
    texts = {editor.uri(name): marked.replace(MARK, "")}
    result = []
    for each in found:
        text = texts.get(each["uri"]) or Path(each["uri"].removeprefix("file://")).read_text(encoding="utf-8")
        result.append((each["uri"].rpartition("/")[2], stretch(each["range"], text)))
    return result


@pytest.mark.parametrize(
    ("where", "place"),
    [
        ("site: arm/attachment_site", ("arm6.xml", "attachment_site")),
        ("objname: cube/cube", ("cube.xml", "cube")),
        ("actuator: gripper/grip", ("gripper2.xml", "grip")),
        ("./models/arm6/arm6.xml", ("arm6.xml", "")),
    ],
)
def test_definition_is_the_line_of_the_model(editor: Editor, where: str, place: tuple[str, str]) -> None:
    assert places(editor, "definition", mark(DEMO, where)) == [place]


def test_definition_of_what_the_recipe_makes_itself(editor: Editor) -> None:
    text = DEMO + "  look: {type: framepos, objtype: camera, objname: wrist_camera}\n"
    (found,) = places(editor, "definition", mark(text, "objname: wrist_camera"))
    assert found[0] == "demo.yaml"


def test_definition_of_parts_and_parameters(editor: Editor) -> None:
    text = DEMO + "check: {same: {unchanged: {part: watcher}}}\n"
    assert places(editor, "definition", mark(text, "part: watcher")) == [("demo.yaml", "watcher")]
    name = "payload_study.yaml"
    assert places(editor, "definition", mark(STUDY, '"${reach}", 0'), name) == [(name, "reach")]
    assert places(editor, "definition", mark(STUDY, "when: {to▮ol"), name)[0][0] == name


def test_definition_in_a_nested_recipe(editor: Editor) -> None:
    outer = "recipe: 1\nattach:\n  a:\n    model: ./payload_study.yaml\n    with: {reach: 0.5}\n"
    assert places(editor, "definition", mark(outer, "reach: 0"), "outer.yaml") == [("payload_study.yaml", "reach")]
    assert places(editor, "definition", mark(outer, "./payload_study.yaml"), "outer.yaml") == [
        ("payload_study.yaml", "")
    ]


def test_references_in_the_recipe_and_in_the_models(editor: Editor) -> None:
    marked = mark(DEMO, "site: arm/attachment_site")
    found = places(editor, "references", marked, context={"includeDeclaration": True})
    assert found[0] == ("arm6.xml", "attachment_site")
    assert found.count(("demo.yaml", "arm/attachment_site")) == 1
    text = DEMO + "  angle: {type: jointpos, joint: arm/elbow}\n"
    found = places(editor, "references", mark(text, "joint: arm/elbow"), context={"includeDeclaration": False})
    assert ("demo.yaml", "arm/elbow") in found
    assert ("arm6.xml", "elbow") in found, "the actuator of the model"


def test_references_of_a_part_and_of_a_parameter(editor: Editor) -> None:
    found = places(editor, "references", mark(DEMO, "  gripper:\n"), context={"includeDeclaration": True})
    assert found == [("demo.yaml", "gripper/base"), ("demo.yaml", "gripper/grip")]
    found = places(
        editor, "references", mark(STUDY, "  payload:"), "payload_study.yaml", context={"includeDeclaration": True}
    )
    assert len(found) == STUDY.count("payload") - 4, "but for the name, the comments and the description"
    assert {each[1] for each in found} == {"payload"}


def test_symbols_folding_and_lenses(editor: Editor) -> None:
    params, text = editor.at(MARK + STUDY, "payload_study.yaml")
    document = {"textDocument": params["textDocument"]}
    found = {each["name"]: each for each in editor.ask("textDocument/documentSymbol", document)}
    (gripper,) = found["attach"]["children"]
    assert (gripper["name"], gripper["detail"]) == ("gripper", "./models/gripper2/gripper2.xml")
    assert gripper["range"]["end"]["line"] > gripper["selectionRange"]["end"]["line"]
    lines = text.split("\n")
    folds = editor.ask("textDocument/foldingRange", document)
    assert any(lines[each["startLine"]] == "matrix:" for each in folds)
    assert all(each["startLine"] < each["endLine"] < len(lines) for each in folds)
    titles = [each["command"]["title"] for each in editor.ask("textDocument/codeLens", document)]
    assert titles[:6] == [
        "view",
        "build",
        "check",
        "view study-gripper-0kg",
        "build study-gripper-0kg",
        "check study-gripper-0kg",
    ]


def test_hints_say_counts_values_and_units(editor: Editor) -> None:
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 999, "character": 0}}
    marked = MARK + DEMO + 'edit:\n  - {select: {body: "arm/*"}, set: {gravcomp: 1}}\n'
    params, text = editor.at(marked, "demo.yaml")
    found = editor.ask("textDocument/inlayHint", {"textDocument": params["textDocument"], "range": whole})
    lines = text.split("\n")
    shown = {
        lines[each["position"]["line"]][: each["position"]["character"]].split()[-1]: each["label"] for each in found
    }
    assert shown['"arm/*"'] == "× 7"
    assert shown["-28"] == "deg"
    assert shown["90"] == "deg"
    params, text = editor.at(MARK + STUDY, "payload_study.yaml")
    found = editor.ask("textDocument/inlayHint", {"textDocument": params["textDocument"], "range": whole})
    assert {"= 0.55", "= 0.001 | 0.5 | 2 | 3"} <= {each["label"] for each in found}


@pytest.mark.parametrize("ends", ["\n", "\r\n"], ids=["LF", "CRLF"])
def test_formatting_is_that_of_fmt_and_leaves_the_rest_alone(editor: Editor, ends: str) -> None:
    messy = DEMO.replace("attach:\n", "attach:\n\n\n").replace("cone: elliptic", "cone:   elliptic").replace("\n", ends)
    params, text = editor.at(MARK + messy, "messy.yaml")
    edits = editor.ask(
        "textDocument/formatting",
        {"textDocument": params["textDocument"], "options": {"tabSize": 2, "insertSpaces": True}},
    )
    result = applied(text, edits)
    from mjcompose.base.sink import Sink
    from mjcompose.text.layout import format_recipe

    assert result.encode() == format_recipe(text.encode(), "messy.yaml", Sink())
    assert len(edits) <= 3


def test_formatting_a_half_written_recipe_changes_nothing(editor: Editor) -> None:
    params, _ = editor.at(f"{DEMO}  x: {{{MARK}", "half_messy.yaml")
    options = {"tabSize": 2, "insertSpaces": True}
    assert editor.ask("textDocument/formatting", {"textDocument": params["textDocument"], "options": options}) == []


def test_check_as_a_command(editor: Editor) -> None:
    said = editor.ask(
        "workspace/executeCommand", {"command": "mjcompose.check", "arguments": [str(editor.folder / "demo.yaml")]}
    )
    assert said.endswith("demo.yaml: ok")


def test_view_as_a_command_gives_the_address(editor: Editor) -> None:
    recipe = str(editor.folder / "demo.yaml")
    said = editor.ask("workspace/executeCommand", {"command": "mjcompose.view", "arguments": [recipe]})
    assert said.startswith("http://127.0.0.1:")
    gone = str(editor.folder / "gone.yaml")
    said = editor.ask("workspace/executeCommand", {"command": "mjcompose.view", "arguments": [gone]})
    assert "file-not-found" in said or "No such file" in said or "does not exist" in said


def test_from_a_line_of_the_model_to_the_recipes_that_use_it(editor: Editor) -> None:
    editor.at(MARK + DEMO, "demo.yaml")
    model = (editor.folder / "models/arm6/arm6.xml").read_text(encoding="utf-8")
    params, _ = editor.at(mark(model, 'site name="attachment_site"'), "models/arm6/arm6.xml")
    shown = editor.ask("textDocument/hover", params)["contents"]["value"]
    assert "in `demo.yaml`: **site `arm/attachment_site`**" in shown
    found = editor.ask("textDocument/references", {**params, "context": {"includeDeclaration": True}})
    lines = DEMO.splitlines()
    at = [each for each in found if each["uri"] == editor.uri("demo.yaml")]
    assert [stretch(each["range"], DEMO) for each in at] == ["arm/attachment_site"]
    assert all("arm/attachment_site" in lines[each["range"]["start"]["line"]] for each in at)


def test_a_file_that_changes_on_the_disk_is_read_again(editor: Editor) -> None:
    (editor.folder / "disk.xml").write_text('<mujoco><worldbody><site name="a"/></worldbody></mujoco>')
    uri = editor.open("disk.yaml", "recipe: 1\nbase: ./disk.xml\nattach:\n  x: {model: ./disk.xml, site: b}\n")
    assert len(editor.diagnostics(uri)) == 1
    (watched,) = [each for each in editor.requests if each["method"] == "client/registerCapability"]
    assert watched["params"]["registrations"][0]["method"] == "workspace/didChangeWatchedFiles"
    (editor.folder / "disk.xml").write_text('<mujoco><worldbody><site name="b"/></worldbody></mujoco>')
    editor.tell("workspace/didChangeWatchedFiles", {"changes": [{"uri": editor.uri("disk.xml"), "type": 2}]})
    assert editor.wait(uri, lambda found: not found) == []


def test_the_lens_of_a_cell_builds_a_file_in_build(editor: Editor, tmp_path: Path) -> None:
    """A cell of a matrix may be called like a path, and the editor builds it where its file name leads."""
    text = """recipe: 1
name: n
base: ./models/arm6/arm6.xml
matrix: {axes: {tool: [/../../../../../victim/cell, b]}}
params: {tool: b}
"""
    (editor.folder / "hostile.yaml").write_text(text)
    params, _ = editor.at(MARK + text, "hostile.yaml")
    lenses = editor.ask("textDocument/codeLens", {"textDocument": params["textDocument"]})
    commands = [each["command"] for each in lenses if each["command"]["command"] == "mjcompose.build"]
    first = next(each for each in commands if len(each["arguments"]) == 2)
    assert first["arguments"][1] == "n-/../../../../../victim/cell"
    assert "wrote" in editor.ask("workspace/executeCommand", {**first, "title": ""})
    assert [each.name for each in (editor.folder / "build").iterdir()] == ["n-_.._.._.._.._.._victim_cell.zip"]
