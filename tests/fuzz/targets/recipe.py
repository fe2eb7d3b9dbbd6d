"""Recipes: they are built, and put into their canonical layout."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fuzz.mutation import yaml_changed
from fuzz.target import RECIPES, Seed, Target, Tools, without_a_place
from mjcompose.base.sink import Sink
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.layout import format_recipe


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    for path in [*RECIPES.glob("*.yaml"), *RECIPES.glob("patches/*.yaml")]:
        if "menagerie" not in path.read_text(encoding="utf-8"):
            yield Seed(path.read_bytes())


def check(path: Path, tools: Tools) -> str | None:
    data = path.read_bytes()
    once = format_recipe(data, path.name, Sink())
    if once is not None and format_recipe(once, path.name, Sink()) != once:
        return "layout-not-stable"
    context = Context(environment={}, folder=path.parent)
    built = build(ModelRequest(path), context, session=tools.session)
    if built is None and not context.sink.has_errors:
        return "refused-without-a-word"
    return without_a_place(context)


TARGET = Target("recipe", ".yaml", _seeds, yaml_changed, check, RECIPES)
