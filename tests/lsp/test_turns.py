"""Entries with `for` and tables in an editor: completion, hover, references, rename, hints, and no false errors."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lsp.client import MARK, Editor, applied, labels, stretch
from lsp.test_hover import mark, shown
from lsp.test_rename import edits
from mjcompose.base.sink import Sink
from mjcompose.lsp.glance import faults_of_entries
from mjcompose.text.load import load

NAME = "repeated.yaml"
LEGS = """\
recipe: 1
params:
  legs: [FL, FR, RL]
  gains: {default: {hip: {kp: 20, kd: 1}, knee: {kp: 40, kd: 2}}}
  scale: 2
add:
  - for: {leg: "${legs}"}
    to: world
    body:
      name: "${leg}_trunk"
      joint: [{name: "${leg}_hip", axis: [1, 0, 0]}, {name: "${leg}_knee", axis: [0, 1, 0]}]
      geom: {size: [0.1]}
actuator:
  "${leg}_${j}": {for: {leg: "${legs}", j: "${gains}"}, type: position, joint: "${leg}_${j}", kp: "${scale * gains[j].kp}"}
sensor:
  "at_${leg}": {for: {leg: "${legs}"}, type: framepos, objtype: body, objname: "${leg}_trunk"}
edit:
  - {for: {j: "${gains}"}, select: {joint: "*_${j}"}, set: {damping: "${gains[j].kd + index}"}}
  - {select: {position: "*_hip"}, set: {kp: "${gains.hip.kp}"}}
"""


def offered(editor: Editor, text: str) -> list[dict[str, object]]:
    return editor.complete(text, NAME, previous=LEGS)


def changed(old: str, new: str) -> str:
    assert LEGS.count(old) == 1, old
    return LEGS.replace(old, new)


def test_a_good_recipe_has_no_errors(editor: Editor) -> None:
    uri = editor.open(NAME, LEGS)
    assert editor.diagnostics(uri) == []


def test_88_turns_are_one_error(editor: Editor) -> None:
    text = 'recipe: 1\nsensor:\n  "s${i}": {for: {i: 88}, type: framepos, objtype: body, objname: "no${i}"}\n'
    uri = editor.open("many.yaml", text)
    assert len(editor.diagnostics(uri)) == 1


@pytest.mark.parametrize(
    "text",
    [
        changed('kp: "${scale * gains[j].kp}"', f'kp: "${{scale * {MARK}"'),
        changed('"${leg}_${j}": {for', f'"${{leg}}_${{{MARK}": {{for'),
        changed('joint: "${leg}_${j}"', f'joint: "${{{MARK}}}"'),
    ],
    ids=["value", "key", "name"],
)
def test_names_of_for_come_first_in_its_entry(editor: Editor, text: str) -> None:
    found = offered(editor, text)
    assert labels(found)[:2] == ["leg", "j"]
    assert found[0]["detail"] == "of `for`: FL, FR, RL"
    assert found[1]["detail"] == "of `for`: hip, knee"
    assert {"legs", "gains", "scale"} <= set(labels(found))


def test_names_of_for_are_offered_nowhere_else(editor: Editor) -> None:
    assert "j" not in labels(offered(editor, changed('      name: "${leg}_trunk"', f'      name: "${{{MARK}}}"')))
    assert "j" not in labels(offered(editor, changed("${gains.hip.kp}", f"${{{MARK}}}")))
    in_for = labels(
        offered(
            editor, changed('{for: {leg: "${legs}", j: "${gains}"}', f'{{for: {{leg: "${{legs}}", j: "${{{MARK}}}"}}')
        )
    )
    assert "leg" not in in_for and "gains" in in_for


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        (changed("gains[j].kp}", f"gains[j].{MARK}"), ["kp", "kd"]),
        (changed("gains[j].kp}", f"gains[j].k{MARK}}}"), ["kp", "kd"]),
        (changed("${gains.hip.kp}", f"${{gains.{MARK}}}"), ["hip", "knee"]),
        (changed("${gains.hip.kp}", f"${{gains.hip.{MARK}}}"), ["kp", "kd"]),
        (changed("${gains.hip.kp}", f"${{gains[name].{MARK}}}"), ["kp", "kd"]),
    ],
)
def test_rows_and_columns_of_a_table(editor: Editor, text: str, keys: list[str]) -> None:
    assert labels(offered(editor, text)) == keys


def test_rows_in_brackets_have_the_other_quotes(editor: Editor) -> None:
    found = offered(editor, changed("${gains.hip.kp}", f"${{gains[{MARK}].kp}}"))
    assert labels(found)[:2] == ["hip", "knee"]
    assert [each.get("textEdit", each)["newText"] for each in found[:2]] == ["'hip'", "'knee'"]
    in_entry = labels(offered(editor, changed("gains[j].kp}", f"gains[{MARK}].kp}}")))
    assert {"hip", "knee", "leg", "j"} <= set(in_entry)


def test_tables_and_lists_to_repeat_over(editor: Editor) -> None:
    found = labels(
        offered(editor, changed('at_${leg}": {for: {leg: "${legs}"}', f'at_${{leg}}": {{for: {{leg: {MARK}}}'))
    )
    assert found[:2] == ["${legs}", "${gains}"] and "${scale}" not in found


def test_for_is_offered_as_a_key(editor: Editor) -> None:
    assert "for" in labels(offered(editor, LEGS + f"  - {{{MARK}}}\n"))


def test_hover_of_a_name_has_its_values(editor: Editor) -> None:
    text = shown(editor, mark(LEGS, '{le▮g: "${legs}", j:'), NAME)
    assert text == "**`leg`**, a name of `for` with 3 values: FL, FR, RL"
    text = shown(editor, mark(LEGS, 'joint: "${le▮g}_${j}"'), NAME)
    assert "| leg FL, j hip | **FL_hip** |" in text and "| leg RL, j knee | **RL_knee** |" in text
    assert "**`leg`**, a name of `for` with 3 values: FL, FR, RL" in text


def test_hover_of_a_reading_has_the_value_of_each_turn(editor: Editor) -> None:
    text = shown(editor, mark(LEGS, "gains[j].k▮p}"), NAME)
    assert "| leg FL, j hip | **40** |" in text and "| leg RL, j knee | **80** |" in text
    text = shown(editor, mark(LEGS, "${gains.hip.k▮p}"), NAME)
    assert "= **20**" in text


def test_hover_of_a_row_that_the_element_chooses_has_the_column(editor: Editor) -> None:
    text = LEGS.replace("${gains.hip.kp}", "${gains[name].kd}")
    text = shown(editor, mark(text, "${gains[name].k▮d}"), NAME)
    assert "| `gains[name].kd` | value |" in text
    assert "| hip | **1** |" in text and "| knee | **2** |" in text


def test_definition_and_references_of_a_name(editor: Editor) -> None:
    params, _ = editor.at(mark(LEGS, 'type: position, joint: "${le▮g}'), NAME)
    (place,) = editor.ask("textDocument/definition", params)
    assert place["range"]["start"] == {"line": 13, "character": 24}
    found = editor.ask("textDocument/references", {**params, "context": {"includeDeclaration": True}})
    assert [stretch(each["range"], LEGS) for each in found] == ["leg"] * 3
    assert {each["range"]["start"]["line"] for each in found} == {13}


def test_rename_of_a_name_stays_in_its_entry(editor: Editor) -> None:
    for place in ('{le▮g: "${legs}", j:', 'joint: "${le▮g}_${j}"', '"${le▮g}_${j}": {for'):
        found = edits(editor, mark(LEGS, place), "side", NAME)
        after = applied(LEGS, found[editor.uri(NAME)])
        lines = LEGS.splitlines()
        lines[13] = lines[13].replace("${leg}", "${side}").replace("{leg:", "{side:")
        assert after == "\n".join(lines) + "\n"


def test_rename_of_a_parameter_reaches_keys(editor: Editor) -> None:
    text = LEGS.replace('"at_${leg}"', '"at_${leg}_${scale}"')
    found = edits(editor, mark(text, "  sca▮le: 2"), "factor", NAME)
    after = applied(text, found[editor.uri(NAME)])
    assert after == text.replace("scale", "factor")
    editor.change(editor.uri(NAME), after)
    assert editor.diagnostics(editor.uri(NAME)) == []


@pytest.mark.parametrize("new", ["legs", "j", "1a", "index", "pi"])
def test_rename_to_a_taken_name_is_refused(editor: Editor, new: str) -> None:
    params, _ = editor.at(mark(LEGS, '{le▮g: "${legs}", j:'), NAME)
    with pytest.raises(Exception, match="already|meaning of its own|letters"):
        editor.ask("textDocument/rename", {**params, "newName": new})


def test_hints_have_the_values_of_turns(editor: Editor) -> None:
    uri = editor.open(NAME, LEGS)
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 40, "character": 0}}
    found = editor.ask("textDocument/inlayHint", {"textDocument": {"uri": uri}, "range": whole})
    hints = {each["label"] for each in found}
    assert "= FL_hip | FL_knee | FR_hip | FR_knee | … 2 more" in hints
    assert "= 40 | 80" in hints


def test_nested_for_in_a_recipe_in_place(editor: Editor, folder: Path) -> None:
    text = """\
recipe: 1
attach:
  "arm${i}":
    for: {i: 2}
    model:
      add:
        - {for: {k: 2}, to: world, site: {name: "s${i}${k}", pos: ["${i + k}", 0, 0]}}
"""
    uri = editor.open("nested_for.yaml", text)
    assert editor.diagnostics(uri) == []
    found = labels(editor.complete(text.replace('"${i + k}"', f'"${{{MARK}}}"'), "nested_for.yaml", previous=text))
    assert found[:2] == ["i", "k"]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ("scale: 2", "scale: 2", []),
        ("kp: 20, kd: 1", "kp: 20, kd: 1", []),
        ("{default: {hip: {kp: 20, kd: 1}, knee: {kp: 40, kd: 2}}}", "{type: table}", []),
        ("type: position, joint", "type: position, jont", [("unknown-attribute", 14)]),
    ],
)
def test_a_keystroke_in_a_long_recipe_finds_no_false_errors(old: str, new: str, found: list[tuple[str, int]]) -> None:
    text = changed(old, new)
    count = len(text.splitlines())
    tree = load(text, NAME, Sink())
    assert tree is not None
    faults = list(faults_of_entries(tree, count, frozenset(range(count))))
    assert [(each.code, each.span.line) for each in faults if each.span is not None] == found


def test_columns_of_a_list_of_mappings(editor: Editor) -> None:
    text = """\
recipe: 1
add:
  - {for: {g: [{name: a, x: 1}, {name: b, x: 2}]}, to: world, site: {name: "${g.name}", pos: ["${g.x}", 0, 0]}}
"""
    assert editor.diagnostics(editor.open("rows.yaml", text)) == []
    found = editor.complete(text.replace("${g.x}", f"${{g.{MARK}}}"), "rows.yaml", previous=text)
    assert labels(found) == ["name", "x"]
    assert "**`g`**, a name of `for` with 2 values: {name: a, x: 1}, {name: b, x: 2}" in shown(
        editor, mark(text, "${▮g.x}"), "rows.yaml"
    )


def test_a_table_without_a_default_has_the_columns_that_it_lists(editor: Editor) -> None:
    text = LEGS.replace("{default: {hip: {kp: 20, kd: 1}, knee: {kp: 40, kd: 2}}}", "{type: table, columns: [kp, kd]}")
    found = editor.complete(text.replace("gains[j].kp}", f"gains[j].{MARK}}}"), NAME, previous=text)
    assert labels(found) == ["kp", "kd"]
    found = editor.complete(text.replace("gains[j].kp}", f"gains[{MARK}].kp}}"), NAME, previous=text)
    assert next(each["detail"] for each in found if each["label"] == "j") == "of `for`"


ARMS = """\
recipe: 1
params: {side: x}
attach:
  "arm${i}_${side}": {for: {i: 2}, model: {add: [{to: world, body: {name: b}}]}, pos: ["${i}", 0, 0]}
add:
  - {to: arm1_x/b, site: {name: tip}}
keyframe: {home: {from: {arm1_x: none}}}
edit:
  - {select: {body: "*/b", part: arm1_x}, set: {gravcomp: 1}}
"""


@pytest.mark.parametrize("place", ["part: arm▮1_x", '"ar▮m${i}_'])
def test_a_part_that_a_for_makes_is_not_renamed(editor: Editor, place: str) -> None:
    params, _ = editor.at(mark(ARMS, place), "arms.yaml")
    with pytest.raises(Exception, match="a `for` makes `arm.*: change the key of its entry"):
        editor.ask("textDocument/rename", {**params, "newName": "left"})


@pytest.mark.parametrize(("place", "old", "new"), [('"arm${▮i}_', "i", "number"), ("_${si▮de}", "side", "word")])
def test_names_in_the_key_of_a_part_are_renamed(editor: Editor, place: str, old: str, new: str) -> None:
    found = edits(editor, mark(ARMS, place), new, "arms.yaml")
    after = applied(ARMS, found[editor.uri("arms.yaml")])
    assert after == re.sub(rf"(?<={{){old}(?=[:}}])", new, ARMS)


def test_the_definition_of_a_part_that_a_for_makes_is_its_entry(editor: Editor) -> None:
    params, _ = editor.at(mark(ARMS, "part: arm▮1_x"), "arms.yaml")
    (place,) = editor.ask("textDocument/definition", params)
    assert place["range"]["start"]["line"] == 3


def test_nobody_counts_what_a_selector_with_an_expression_matches(editor: Editor) -> None:
    assert "matches" not in shown(editor, mark(LEGS, "select: {jo▮int"), NAME)
    assert "**matches 3 elements**" in shown(editor, mark(LEGS, "select: {po▮sition"), NAME)
