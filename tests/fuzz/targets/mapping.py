"""Mappings: a recipe as data of Python gives the same model as its text in a file, or the same errors.

A case is YAML, which PyYAML reads: its data has numbers as keys, dates, NaN and shared lists.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mjcompose
import yaml
from fuzz.mutation import yaml_changed
from fuzz.target import RECIPES, Seed, Target, Tools
from mjcompose.base.files import DATA
from mjcompose.base.sink import Sink
from mjcompose.text.layout import format_recipe
from mjcompose.tools.open import recipe as opening


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    for path in [*RECIPES.glob("*.yaml"), *RECIPES.glob("patches/*.yaml")]:
        if "menagerie" not in path.read_text(encoding="utf-8"):
            yield Seed(path.read_bytes())


def _outcome(recipe: Any, **options: Any) -> tuple[str | None, list[str]]:
    """The text of the model, and the codes of the errors."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return opening._text_of(opening._Opening.of(recipe, **options)), []
    except mjcompose.BuildError as error:
        if DATA in str(error):
            return None, ["unnamed"]
        return None, [each.code for each in error.diagnostics]


def check(path: Path, tools: Tools) -> str | None:
    try:
        data = yaml.safe_load(path.read_bytes())
    except (yaml.YAMLError, UnicodeError, ValueError, RecursionError):
        return None
    if not isinstance(data, dict):
        return None
    try:
        text = mjcompose.dumps(data)
    except TypeError as error:
        return None if "recipe" in str(error) else "type-error-without-a-place"
    except mjcompose.MjcomposeError:
        return None
    if format_recipe(text.encode(), path.name, Sink()) not in (text.encode(), None):
        return "not-its-layout"
    file = path.with_name("model.yaml")  # the name of a model from a mapping
    file.write_text(text, encoding="utf-8")
    try:
        ours = _outcome(data, base_dir=path.parent)
        theirs = _outcome(file)
    finally:
        file.unlink()
    if "unnamed" in ours[1]:
        return "the-name-in-memory-is-shown"
    if ours[1] != theirs[1]:
        return f"other-errors-{'-'.join(sorted({*ours[1]} ^ {*theirs[1]}))}"
    return None if ours == theirs else "another-model"


TARGET = Target("mapping", ".yaml", _seeds, yaml_changed, check, RECIPES)
