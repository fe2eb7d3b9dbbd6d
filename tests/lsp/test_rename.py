"""Another key for a part: its prefix changes wherever it is used, and the model stays what it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsp.client import MARK, Editor, applied
from lsp.conftest import RECIPES
from lsp.test_hover import mark
from mjcompose.lsp.rename import NotSure, renamed

DEMO = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
ARM = '<mujoco><worldbody><body name="b"><site name="tip"/><geom name="g" size="1"/></body></worldbody></mujoco>'
INNER = """\
recipe: 1
params: {gap: 0.1}
attach:
  left: {model: ./renamed.xml, pos: ["${gap}", 0, 0]}
  right: {model: ./renamed.xml, site: left/tip, pos: ["${-gap}", 0, 0]}
add:
  - to: left/b
    xml: |
      <site name="more" pos="0 0 ${gap}"/>
contact:
  exclude: [{body1: left/b, body2: "right/b"}]
edit:
  - {select: {geom: "left/*"}, set: {condim: 4}}
  - {select: {geom: "{left,right}/*"}, set: {margin: 0.01}}
  - {select: {geom: "*/g", part: left}, set: {gap: 0.01}}
sensor:
  left: {type: framepos, objtype: site, objname: left/tip}
"""
OUTER = """\
recipe: 1
attach:
  robot: {model: ./renamed_inner.yaml, with: {gap: 0.2}}
  tool: {model: ./renamed.xml, site: robot/left/tip}
sensor:
  there: {type: framepos, objtype: body, objname: robot/left/b}
keyframe:
  home: {from: {robot/left: home}}
"""


def edits(editor: Editor, marked: str, new: str, name: str) -> dict[str, list[Any]]:
    params, _ = editor.at(marked, name)
    editor.ask("textDocument/prepareRename", params)
    return editor.ask("textDocument/rename", {**params, "newName": new})["changes"]


@pytest.fixture
def inner(folder: Path) -> Path:
    (folder / "renamed.xml").write_text(ARM)
    (folder / "renamed_inner.yaml").write_text(INNER)
    (folder / "renamed_outer.yaml").write_text(OUTER)
    return folder / "renamed_inner.yaml"


def test_a_part_everywhere_in_its_recipe_and_in_those_that_include_it(editor: Editor, inner: Path) -> None:
    found = edits(editor, mark(INNER, "  le▮ft: {model"), "west", "renamed_inner.yaml")
    assert set(found) == {editor.uri("renamed_inner.yaml"), editor.uri("renamed_outer.yaml")}
    after = applied(INNER, found[editor.uri("renamed_inner.yaml")])
    expected = INNER.replace("left/", "west/").replace("  left: {model", "  west: {model")
    expected = expected.replace("{left,right}", "{west,right}").replace("part: left}", "part: west}")
    assert after == expected
    assert applied(OUTER, found[editor.uri("renamed_outer.yaml")]) == OUTER.replace("robot/left", "robot/west")
    editor.change(editor.uri("renamed_inner.yaml"), after)
    assert editor.diagnostics(editor.uri("renamed_inner.yaml")) == []


def test_from_a_place_that_names_it(editor: Editor, inner: Path) -> None:
    found = edits(editor, mark(INNER, "part: le▮ft"), "west", "renamed_inner.yaml")
    assert applied(INNER, found[editor.uri("renamed_inner.yaml")]).count("west") == 8


def test_the_demo(editor: Editor) -> None:
    found = edits(editor, mark(DEMO, "  arm:\n"), "robot", "demo.yaml")
    after = applied(DEMO, found[editor.uri("demo.yaml")])
    assert after == DEMO.replace("  arm:\n", "  robot:\n").replace("arm/", "robot/")
    editor.change(editor.uri("demo.yaml"), after)
    assert editor.diagnostics(editor.uri("demo.yaml")) == []
    editor.change(editor.uri("demo.yaml"), DEMO)


def test_globs_of_a_keyframe(editor: Editor) -> None:
    key = 'keyframe:\n  k: {qpos: {"{arm,gripper}/*": 0.1rad}, ctrl: {"arm/*": hold, joint: {"arm/w*": hold}}}\n'
    found = edits(editor, mark(DEMO + key, "  arm:\n"), "robot", "demo.yaml")
    after = applied(DEMO + key, found[editor.uri("demo.yaml")])
    assert after.endswith(key.replace("arm", "robot"))
    editor.change(editor.uri("demo.yaml"), DEMO)


def test_a_parameter(editor: Editor, inner: Path) -> None:
    found = edits(editor, mark(INNER, "params: {ga▮p"), "space", "renamed_inner.yaml")
    after = applied(INNER, found[editor.uri("renamed_inner.yaml")])
    assert after == INNER.replace("{gap: 0.1}", "{space: 0.1}").replace("${gap}", "${space}").replace(
        "${-gap}", "${-space}"
    )
    assert applied(OUTER, found[editor.uri("renamed_outer.yaml")]) == OUTER.replace("{gap:", "{space:")


@pytest.mark.parametrize(
    ("where", "new", "words"),
    [
        ("  le▮ft: {model", "right", "there is a part `right` already"),
        ("  le▮ft: {model", "a/b", "cannot be the key of a part"),
        ("  le▮ft: {model", "base", "cannot be the key of a part"),
        ("condim: ▮4", "x", "only parts, parameters, variants and names of `for`"),
    ],
)
def test_what_cannot_be_is_said(editor: Editor, inner: Path, where: str, new: str, words: str) -> None:
    with pytest.raises(AssertionError, match=words):
        edits(editor, mark(INNER, where), new, "renamed_inner.yaml")


def test_a_pattern_that_would_mean_other_names_stops_it(editor: Editor, inner: Path) -> None:
    text = INNER.replace('"left/*"', '"l*/*"')
    with pytest.raises(AssertionError, match="would match other names"):
        edits(editor, mark(text, "  le▮ft: {model"), "west", "renamed_inner.yaml")


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("left/*", "arm/*"),
        ("**/tip", None),
        ("*/tip", None),
        ("right/*", None),
        ("{left,right}/x", "{arm,right}/x"),
        ("{up,down}/x", None),
        ("left", "arm"),
        ("lefty/x", None),
    ],
)
def test_patterns(text: str, result: str | None) -> None:
    assert renamed(text, "left", "arm", "/", True) == result


@pytest.mark.parametrize("text", ["l*/x", "a?m/x", "/left.*/", "{l*,b}/x"])
def test_patterns_of_which_nobody_can_be_sure(text: str) -> None:
    with pytest.raises(NotSure):
        renamed(text, "left", "arm", "/", True)


def test_a_name_below_two_prefixes() -> None:
    assert renamed("robot/left/tip", "robot/left", "robot/west", "/", False) == "robot/west/tip"
    assert renamed("robot/*/tip", "robot/left", "robot/west", "/", True) is None
    assert renamed("robot/left/**", "robot/left", "robot/west", "/", True) == "robot/west/**"


def test_nothing_can_be_renamed_in_a_comment(editor: Editor) -> None:
    params, _ = editor.at(f"{DEMO}# arm{MARK}\n", "demo.yaml")
    assert editor.ask("textDocument/prepareRename", params) is None


def test_a_part_of_a_recipe_that_is_extended_is_renamed_there(editor: Editor, inner: Path) -> None:
    upper = "extends: ./renamed_inner.yaml\nattach:\n  left: {pos: [1, 0, 0]}\nsensor:\n  u: {type: touch, site: left/tip}\n"
    (editor.folder / "renamed_upper.yaml").write_text(upper)
    with pytest.raises(AssertionError, match=r"is a part of `renamed_inner.yaml`, which this recipe extends"):
        edits(editor, mark(upper, "  le▮ft: {pos"), "west", "renamed_upper.yaml")
    found = edits(editor, mark(INNER, "  le▮ft: {model"), "west", "renamed_inner.yaml")
    after = applied(upper, found[editor.uri("renamed_upper.yaml")])
    assert after == upper.replace("  left: {", "  west: {").replace("left/tip", "west/tip")
    editor.tell("textDocument/didClose", {"textDocument": {"uri": editor.uri("renamed_upper.yaml")}})
    (editor.folder / "renamed_upper.yaml").unlink()


def test_a_recipe_that_cannot_be_read_and_may_use_it_stops_it(editor: Editor, inner: Path) -> None:
    broken = editor.folder / "renamed_broken.yaml"
    broken.write_text("recipe: 1\nattach:\n  a: {model: ./renamed_inner.yaml\n  b: [\n")
    try:
        found = edits(editor, mark(INNER, "  le▮ft: {model"), "west", "renamed_inner.yaml")
    except AssertionError as refused:
        assert "renamed_broken.yaml" in str(refused)
    else:
        raise AssertionError(found)
    finally:
        broken.unlink()


def test_a_prefix_that_is_half_written_changes_no_pattern() -> None:
    with pytest.raises(NotSure):
        renamed("left/*", "left", "arm/hand", "/", True)
