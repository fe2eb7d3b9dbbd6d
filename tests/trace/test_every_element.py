"""Every element and every attribute of every model has an explanation that holds."""

from __future__ import annotations

from pathlib import Path

from mjcompose.base.sink import Sink
from mjcompose.trace import query
from mjcompose.trace.explanation import render
from mjcompose.trace.traced import Traced
from mjcompose.tree.select import kind_of

# What is about the whole model, and made for it, stands nowhere.
_MADE = {"mujoco", "compiler", "default", "worldbody", "keyframe", "frame"}
# Recipes that read no model.
_WITHOUT_SOURCES = {
    "add_to_added",
    "attached_by_edit",
    "attached_by_recipe",
    "empty",
    "gantry",
    "piano",
    "player",
    "when_of_others",
}


def test_every_element_comes_from_somewhere(recipe: Path, traced: Traced) -> None:
    for node in traced.model.root.iter("*"):
        told = traced.element(node)
        assert told.written
        spans = [each.span for each in told.written if each.span is not None]
        assert spans or str(node.tag) in _MADE or node.getparent() is traced.model.root, told.label
        for span in spans:
            lines = (recipe.parent / span.file).read_text(encoding="utf-8").splitlines()
            assert 1 <= span.line <= len(lines)


def test_what_was_read_from_a_file_stands_there(recipe: Path, traced: Traced) -> None:
    checked = 0
    for node in traced.model.root.iter("*"):
        life = traced.watch.life(node)
        if life.made_by is None and life.line is not None:
            span = life.span(traced.model.origins)
            line = (recipe.parent / span.file).read_text(encoding="utf-8").splitlines()[span.line - 1]
            tag = (
                "" if span.file.endswith((".urdf", ".xacro")) else life.tag
            )  # there it is `link`, `visual`, `robot`, …
            assert line[span.column - 1 :].startswith(f"<{tag}")
            checked += 1
    assert checked or not _WITHOUT_SOURCES.isdisjoint({recipe.parent.name, recipe.stem})


def test_every_label_finds_its_element(traced: Traced) -> None:
    root = traced.model.root
    for node, label in traced.labels.items():
        if node.getparent() is root and node.tag not in ("worldbody", "default"):
            continue
        sink = Sink()
        asked = query.read(label, None, sink)
        assert asked is not None, label
        found = query.find(asked, root, traced.separator)
        assert found == [node] or (len(found) > 1 and node in found and "#" not in label), label


def test_every_attribute_is_explained(traced: Traced) -> None:
    for node in traced.model.root.iter("*"):
        assert render(traced.element(node))
        for name, text in node.items():
            told = traced.attribute(node, str(name))
            assert told.levels[0].text == text
            assert " ".join(str(told.value).split()).startswith(" ".join(str(text).split()))
            assert render(told)


def test_a_value_from_a_class_is_the_one_that_is_listed(traced: Traced) -> None:
    for node in traced.model.root.iter("*"):
        for given in traced.element(node).given:
            assert given.attribute in kind_of(node).attributes
            told = traced.attribute(node, given.attribute)
            assert next(each.name for each in told.levels if each.wins) == given.by
            assert given.span is not None
