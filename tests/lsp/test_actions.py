"""Changes that are offered for faults and places."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsp.client import MARK, Editor, applied
from lsp.conftest import RECIPES
from lsp.test_hover import mark

DEMO = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
MODEL = '<mujoco><option cone="{}"/><worldbody><body name="b"><site name="tip"/><geom size="1"/></body></worldbody></mujoco>'


def offered(editor: Editor, marked: str, name: str = "acted.yaml") -> tuple[dict[str, Any], str]:
    """The actions at the mark by title, and the text."""
    params, text = editor.at(marked, name)
    editor.diagnostics(editor.uri(name))
    place = {"start": params["position"], "end": params["position"]}
    found = editor.ask(
        "textDocument/codeAction",
        {"textDocument": params["textDocument"], "range": place, "context": {"diagnostics": []}},
    )
    return {each["title"]: each for each in found}, text


def result(editor: Editor, action: dict[str, Any], text: str, name: str = "acted.yaml") -> str:
    return applied(text, action["edit"]["changes"][editor.uri(name)])


def test_every_did_you_mean(editor: Editor) -> None:
    marked = mark(DEMO.replace("actuator: gripper/grip", "actuator: gripper/gripp"), "gripper/gripp")
    found, text = offered(editor, marked)
    action = found["did you mean `actuator: gripper/grip`?"]
    assert action["isPreferred"]
    assert action["diagnostics"][0]["code"] == "unknown-name"
    assert result(editor, action, text) == DEMO
    found, text = offered(editor, mark(DEMO.replace("sensor:", "sensr:"), "\nsen▮sr:"))
    (title,) = [each for each in found if "sensor" in each]
    assert result(editor, found[title], text) == DEMO


def test_several_names_may_be_meant(editor: Editor) -> None:
    marked = mark(DEMO.replace("site: table/mount", "site: table/mout"), "table/mout")
    found, text = offered(editor, marked)
    assert list(found)[:2] == ["write `table/mount`", "write `gripper/mount`"]
    assert result(editor, found["write `table/mount`"], text) == DEMO


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", "option: {cone: pyramidal}\n"),
        ("option: {impratio: 10}\n", "option: {impratio: 10, cone: pyramidal}\n"),
        ("option:\n  impratio: 10\n", "option:\n  impratio: 10\n  cone: pyramidal\n"),
    ],
)
def test_a_setting_that_parts_disagree_about_is_settled(editor: Editor, folder: Path, before: str, after: str) -> None:
    for name, cone in (("one", "elliptic"), ("two", "pyramidal")):
        (folder / f"{name}.xml").write_text(MODEL.format(cone))
    parts = "recipe: 1\nattach:\n  a: {model: ./one.xml}\n  b: {model: ./two.xml}\n"
    found, text = offered(editor, mark(parts + before, "  b:"))
    assert {title.partition(" as ")[0] for title in found if title.startswith("settle")} == {
        "settle `option.cone: pyramidal`",
        "settle `option.cone: elliptic`",
    }
    settled = result(editor, found["settle `option.cone: pyramidal` as in `b`"], text)
    assert settled.rstrip("\n") == (parts + after).rstrip("\n")
    editor.change(editor.uri("acted.yaml"), settled)
    assert editor.diagnostics(editor.uri("acted.yaml")) == []


def test_a_part_that_is_missing_is_attached(editor: Editor) -> None:
    text = DEMO.replace("sensor:\n", "sensor:\n  s: {type: framepos, objtype: body, objname: gripper2/base}\n")
    found, text = offered(editor, mark(text, "gripper2/base"))
    action = found["attach `gripper2`: `./models/gripper2/gripper2.xml`"]
    after = result(editor, action, text)
    assert "\n  gripper2: {model: ./models/gripper2/gripper2.xml}\n" in after


def test_angles_in_the_other_unit(editor: Editor) -> None:
    found, text = offered(editor, mark(DEMO.replace("euler: [180,", "euler: [180deg,"), "180deg"))
    assert "euler: [3.141592654rad," in result(editor, found["write it as `3.141592654rad`"], text)
    found, text = offered(
        editor, mark(DEMO.replace("angle: degree", "#").replace("[180, -28, 90]", "[0, -28, 0]"), "-28")
    )
    assert "euler: [0, -28deg, 0]" in result(editor, found["it is in deg: `-28deg`"], text)


@pytest.mark.parametrize(
    ("before", "after"),
    [("", "allow: [unused-allow-x]\n"), ("allow: [subtree-cut]\n", ""), ("allow:\n  - subtree-cut\n", "")],
)
def test_a_warning_is_acknowledged(editor: Editor, folder: Path, before: str, after: str) -> None:
    """A key outside of the range of its joint is warned of."""
    (folder / "ranged.xml").write_text(
        '<mujoco><worldbody><body name="b"><joint name="j" range="-10 10"/><geom size="1"/></body></worldbody></mujoco>'
    )
    text = "recipe: 1\nbase: ./ranged.xml\nkeyframe:\n  k: {qpos: {j: 1rad}}\n" + before
    _, text = editor.at(mark(text, "1rad"), "warned.yaml")
    uri = editor.uri("warned.yaml")
    found = editor.wait(uri, lambda found: any(each["code"] == "out-of-range" for each in found))
    (warning,) = [each for each in found if each["code"] == "out-of-range"]
    actions = editor.ask(
        "textDocument/codeAction",
        {"textDocument": {"uri": uri}, "range": warning["range"], "context": {"diagnostics": []}},
    )
    (action,) = [each for each in actions if each["title"].startswith("acknowledge")]
    after = result(editor, action, text, "warned.yaml")
    editor.change(uri, after)
    editor.wait(uri, lambda found: not any(each["code"] == "out-of-range" for each in found))
    editor.tell("textDocument/didClose", {"textDocument": {"uri": uri}})
    del editor.versions[uri]


def test_nothing_where_nothing_is_wrong(editor: Editor) -> None:
    found, _ = offered(editor, DEMO.replace("name: demo", f"name: de{MARK}mo"))
    assert found == {}


@pytest.mark.parametrize(
    ("text", "is_offered"),
    [
        ("add: [{to: b, site: {name: s, euler: [0, ▮90, 0]}}]", True),
        ("params: {t: 90}\nadd: [{to: b, site: {name: s, euler: [0, '${▮t}', 0]}}]", False),
        ("params: {t: 90}\nadd: [{to: b, site: {name: s, euler: ['${t}', ▮0, 0]}}]", False),
        ("add: [{to: b, site: {name: s, euler: [0, ▮90, 0], eulr: [0, 1rad, 0]}}]", True),
        ("keyframe: {k: {ctrl: [], ▮ctlr: []}}", False),  # the right key is there, too
    ],
)
def test_a_fix_is_offered_if_it_holds(editor: Editor, folder: Path, text: str, is_offered: bool) -> None:
    (folder / "simple.xml").write_text(MODEL.format("elliptic"))
    found, _ = offered(editor, f"recipe: 1\nbase: ./simple.xml\n{text}\n")
    assert any(each.get("isPreferred") for each in found.values()) is is_offered
