"""A recipe for two arms, a table and a tool, written from nothing: every name and key is one that was offered."""

from __future__ import annotations

from lsp.client import Editor, applied, labels, position

LINES = """\
«recipe»: «1»
«angle»: «degree»
«base»: «./models/scenes/floor.xml»
«attach»:
  table:
    «model»: «./models/table/table.xml»
  left:
    «model»: «./models/arm6/arm6.xml»
    «site»: «table/mount»
  right:
    «model»: «./models/arm6/arm6.xml»
    «site»: «table/corner»
    «euler»: [0, 0, 180]
  tool:
    «model»: «./models/gripper2/gripper2.xml»
    «site»: «left/attachment_site»
    «mate»: «mount»
«option»: {«integrator»: «implicitfast», «cone»: «elliptic», «impratio»: 10}
«contact»:
  «exclude»:
    - {«body1»: «left/base», «body2»: «right/base»}
«sensor»:
  push: {«type»: «force», «site»: «right/attachment_site»}
  grip: {«type»: «actuatorfrc», «actuator»: «tool/grip»}
«keyframe»:
  ready:
    «qpos»: {«left/elbow»: 30, «right/elbow»: -30}
«edit»:
  - {«select»: {«geom»: "«tool/*»"}, «set»: {«condim»: 4}}
"""
OPEN = "«"
CLOSE = "»"


def test_two_arms_a_table_and_a_tool(editor: Editor) -> None:
    name = "two_arms_from_nothing.recipe.yaml"
    uri = editor.open(name, "")
    text = ""
    missing = []
    for line in LINES.splitlines(keepends=True):
        for piece in line.split(OPEN):
            wanted, closed, rest = piece.partition(CLOSE)
            if not closed:
                text += piece
                continue
            closing = '"' * (line[: line.index(wanted)].count('"') % 2)
            editor.change(uri, text + closing)
            place = {"textDocument": {"uri": uri}, "position": position(f"{text}▮")}
            offered = editor.ask("textDocument/completion", place)["items"]
            item = next((each for each in offered if each["label"] == wanted), None)
            if item is None:
                missing.append((text.rpartition("\n")[2], wanted, labels(offered)[:8]))
            else:
                assert applied(text + closing, [item["textEdit"]]).startswith(text + wanted)
            text += wanted + rest
        editor.change(uri, text)
        editor.diagnostics(uri)
    assert not missing
    assert text == LINES.replace(OPEN, "").replace(CLOSE, "")
    assert editor.diagnostics(uri) == []
