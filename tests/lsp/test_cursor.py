"""Where a cursor stands: in whole recipes as the tree says, in half-written ones as a person reads them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lsp.client import MARK
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.lsp.cursor import Cursor, cursor_at
from mjcompose.text.load import load
from mjcompose.text.node import Node, Scalar, Sequence, lines_of

RECIPES = sorted((Path(__file__).resolve().parents[2] / "recipes").glob("*.yaml"))


def at(marked: str) -> Cursor:
    before = marked[: marked.index(MARK)]
    return cursor_at(lines_of(marked.replace(MARK, "")), before.count("\n"), len(before.rpartition("\n")[2]))


def scalars(node: Node, path: tuple[Any, ...]) -> Iterator[tuple[tuple[Any, ...], str, Span]]:
    """Every key and value of a tree, with what the cursor in it is to find."""
    if isinstance(node, Scalar):
        yield path, "value", node.span
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from scalars(item, (*path, index))
    else:
        for name, (key, value) in node.entries.items():
            yield path, "key", key.span
            yield from scalars(value, (*path, name))


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.stem)
def test_every_key_and_value_of_a_recipe_is_found_where_the_tree_has_it(recipe: Path) -> None:
    text = recipe.read_text(encoding="utf-8")
    tree = load(text, recipe.name, Sink())
    assert tree is not None
    lines = lines_of(text)
    count = 0
    for path, role, span in scalars(tree, ()):
        if span.end_column is None or span.end_column == span.column:
            continue
        for column in (span.column, span.end_column - 1):
            found = cursor_at(lines, span.line - 1, column)
            assert (found.path, found.role in (role, "either", "text")) == (path, True), (span, found)
            count += 1
    assert count > 20


@pytest.mark.parametrize(
    ("marked", "path", "role", "word"),
    [
        ("▮", (), "key", ""),
        ("recipe: 1\nba▮", (), "key", "ba"),
        ("recipe: ▮1", ("recipe",), "value", ""),
        ("attach:\n  ▮", ("attach",), "either", ""),
        ("attach:\n  arm:\n    model: a\n    ▮", ("attach", "arm"), "key", ""),
        ("attach:\n  arm:\n    model: a\n  ▮", ("attach",), "key", ""),
        ("attach:\n  arm:\n    model: a\n▮", (), "key", ""),
        ("attach:\n  arm:\n    site: ti▮p # a comment", ("attach", "arm", "site"), "value", "ti"),
        ("attach:\n  arm:\n    site:▮", ("attach", "arm", "site"), "value", ""),
        ("attach: {arm: {model: x, ▮", ("attach", "arm"), "key", ""),
        ("attach: {arm: {model: x, site: a▮b}}", ("attach", "arm", "site"), "value", "a"),
        ("attach: {arm: {model: x}, ▮}", ("attach",), "key", ""),
        ("edit:\n  - {select: {geom: '**/▮", ("edit", 0, "select", "geom"), "value", "**/"),
        ('edit:\n  - {select: {geom: "a, {b}/▮"}}', ("edit", 0, "select", "geom"), "value", "a, {b}/"),
        ("edit:\n- a: 1\n- ▮", ("edit", 1), "either", ""),
        ("edit:\n- a: 1\n  ▮", ("edit", 0), "key", ""),
        ("edit:\n  - a: 1\n  - b▮", ("edit", 1), "either", "b"),
        (
            "add:\n  - to: world\n    body:\n      geom:\n        - {type: box}\n        - {▮",
            ("add", 0, "body", "geom", 1),
            "key",
            "",
        ),
        ("a:\n  pos: [0, 1, ▮", ("a", "pos", 2), "either", ""),
        ("a:\n  pos: [0,\n    1,\n    ▮", ("a", "pos", 2), "either", ""),
        ("a:\n  xml: |\n    <geom ▮", ("a", "xml"), "text", ""),
        ("a:\n  xml: |\n    <geom/>\n  ▮", ("a",), "key", ""),
        ("# a comment ▮", (), "text", ""),
        ('a: "# no comment ▮', ("a",), "value", "# no comment "),
        ("a: 'it''s ▮", ("a",), "value", "it''s "),
        ("🤖: {b: ▮}", ("🤖", "b"), "value", ""),
        ('"quoted key":\n  ▮', ("quoted key",), "either", ""),
        ("a: &anchor ▮", ("a",), "value", ""),
        ("]]}} : ▮", (), "key", "]]}} : "),
    ],
)
def test_half_written(marked: str, path: tuple[Any, ...], role: str, word: str) -> None:
    found = at(marked)
    assert (found.path, found.role, found.word) == (path, role, word)


def test_the_word_ends_where_the_value_does() -> None:
    found = at("a: {site: left/▮tip, pos: 1}")
    assert (found.start, found.end, found.whole) == (10, 18, "left/tip")
    found = at('a: "left/▮tip" # why')
    assert (found.start, found.end, found.quote) == (4, 12, '"')


def test_a_key_that_has_its_colon_gets_no_other() -> None:
    assert at("a:\n  mo▮del: x").has_colon
    assert not at("a:\n  mo▮").has_colon
