"""A text that is read again from its changed lines has the tree of the whole text."""

from __future__ import annotations

import random

import pytest
from mjcompose.base.sink import Sink
from mjcompose.lsp.reread import reread
from mjcompose.text.load import load
from mjcompose.text.node import Node, lines_of

RECIPE = """\
# at the top
recipe: 1
params: {a: 1, b: 2}
name: cell
attach:
  # the first arm
  left: {model: ./arm.xml, pos: [0, 0, "${a}"]}
  right:
    model: ./arm.xml
    pos:
      - 1
      - 2

      - 3
  "quoted": {model: ./arm.xml}  # at the end
  tool: {model: ./tool.xml,
    site: left/tip}
edit:
  - {select: {geom: a}, set: {group: 1}}
  - select: {geom: b}
    set: {group: 2}
  - select: {geom: c}
    set:
      group: 3
add:
  - to: world
    xml: |
      <geom
        size="1"/>

  - {to: world, body: {name: b}}
interface: {joints: [a,
  b]}
texts:
- one
- "${two}"
- three
last: true
"""
TEXTS = [
    "x",
    "1",
    ": ",
    "{",
    "}",
    "[",
    "]",
    "- ",
    ",",
    '"',
    "'",
    "#",
    " ",
    "  ",
    "|",
    "&a ",
    "*a",
    "!!str ",
    "${b}",
    "?",
    "\t",
    "---",
    "...",
    "left: 1",
    "~",
    "<<: ",
    "%",
    "",
]


def _tree(text: str) -> tuple[Node | None, int]:
    sink = Sink()
    return load(text, "r.yaml", sink), len(sink.diagnostics)


def _changed(text: str, chance: random.Random) -> str:
    lines = lines_of(text)
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        at = chance.randrange(len(lines))
        start = chance.randrange(len(lines[at]) + 1)
        end = min(len(lines[at]), start + chance.choice((0, 0, 1, 2, 9)))
        lines[at] = lines[at][:start] + chance.choice(TEXTS) + lines[at][end:]
    return "\n".join(lines)


@pytest.mark.parametrize("seed", range(8))
def test_any_change_gives_the_tree_of_the_whole_text_or_none(seed: int) -> None:
    chance = random.Random(seed)
    text = RECIPE
    taken = 0
    for number in range(400):
        tree, faults = _tree(text)
        assert tree is not None
        assert not faults
        changed = _changed(text, chance)
        found = reread(tree, lines_of(text), lines_of(changed), "r.yaml")
        whole, faults = _tree(changed)
        if found is not None:
            assert faults == 0, changed
            assert found == whole, changed
            taken += changed != text
        text = changed if whole is not None and faults == 0 and number % 7 else RECIPE
    assert taken > 30


def test_only_the_changed_entries_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = ["recipe: 1", "attach:", *(f"  p{number}: {{model: ./part.xml}}" for number in range(50)), "name: n"]
    tree, _ = _tree("\n".join(lines))
    assert tree is not None
    read: list[str] = []

    def count(text: str, file: str, sink: Sink) -> Node | None:
        read.append(text.strip())
        return load(text, file, sink)

    monkeypatch.setattr("mjcompose.lsp.reread.load", count)
    changed = [*lines[:20], "  other: {model: ./part.xml, pos: [1, 0, 0]}", *lines[21:]]
    assert reread(tree, lines, changed, "r.yaml") == _tree("\n".join(changed))[0]
    assert [text.count("model") for text in read] == [1]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("  b: 2", "   b: 2"),
        ("  b: 2", "  a: 2"),
        ("  b: 2", "  b: &x 2"),
        ("  b: 2", "  b: {"),
        ("  b: 2", "  # b: 2"),
        ("  b: 2", "b: 2"),
        ("params:", "param:"),
    ],
)
def test_changes_that_need_the_whole_text(old: str, new: str) -> None:
    lines = ["recipe: 1", "params:", "  a: 1", "  b: 2", "  c: 3"]
    tree, _ = _tree("\n".join(lines))
    assert tree is not None
    assert reread(tree, lines, [new if line == old else line for line in lines], "r.yaml") is None
    assert reread(tree, lines, [*lines, "  d: 4"], "r.yaml") is None
    assert reread(tree, lines, lines, "r.yaml") is tree
