"""The schema in a real editor's server."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from conftest import YamlServer

ROOT = Path(__file__).parents[2]
RECIPES = sorted((ROOT / "recipes").glob("*.yaml"))
ERRORS = Path(__file__).parent / "errors"
# A wrong recipe, the line that the server marks, and a part of what it says.
WRONG = [
    ("unknown_key", 3, "sensors is not allowed"),
    ("misspelt_required_key", 4, "modle is not allowed"),
    ("missing_version", 1, 'Missing property "recipe"'),
    ("unknown_attribute", 4, "frction is not allowed"),
    ("wrong_keyword", 4, '"sphere"'),
    ("text_for_list", 4, "expected a list of 3 numbers"),
    ("wrong_length", 4, "too few items"),
    ("spaced_unit", 4, "an angle such as 90deg"),
    ("unknown_type", 3, '"framepos"'),
    ("missing_attribute", 5, 'Missing property "site"'),
    ("exclusive_attributes", 5, "only one of the two may stand"),
    ("two_places", 7, "only one of the two may stand"),
    ("prefixes", 3, "not `base`"),
    ("joint_word", 3, '"free"'),
    ("tendon_path", 3, 'Missing property "path"'),
    ("list_for_names", 7, "Incorrect type"),
]

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.name)
def test_nothing_to_say_about_a_shipped_recipe(yaml_server: YamlServer, path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# yaml-language-server: $schema=../schemas/recipe.schema.json\n")
    assert yaml_server.diagnostics(path, text) == []


@pytest.mark.parametrize(("case", "line", "message"), WRONG, ids=[case for case, *_ in WRONG])
def test_wrong_recipe_is_marked(yaml_server: YamlServer, case: str, line: int, message: str) -> None:
    path = ERRORS / case / "recipe.yaml"
    marked = yaml_server.diagnostics(path, path.read_text(encoding="utf-8"))
    there = [each["message"] for each in marked if each["range"]["start"]["line"] == line - 1]
    assert any(message in each for each in there), marked


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("recipe: 1\n|", {"attach", "sensor", "base"}),
        ("recipe: 1\nsensor:\n  wrist: {type: |}\n", {"force", "framepos"}),
        ("recipe: 1\nsensor:\n  tip:\n    type: framepos\n    |\n", {"objtype", "reftype", "noise"}),
        ("recipe: 1\nadd:\n  - to: world\n    |\n", {"body", "geom", "xml"}),
        ("recipe: 1\nadd:\n  - to: world\n    geom:\n      type: |\n", {"box", "capsule"}),
        ("recipe: 1\nattach:\n  arm:\n    model: a.xml\n    joint: |\n", {"free", "mocap"}),
    ],
)
def test_completion(yaml_server: YamlServer, tmp_path: Path, text: str, offered: set[str]) -> None:
    found = {each["label"] for each in yaml_server.completions(tmp_path / "recipe.yaml", text)}
    assert offered <= found


def test_a_new_element_is_not_filled_with_defaults(yaml_server: YamlServer, tmp_path: Path) -> None:
    offers = yaml_server.completions(tmp_path / "recipe.yaml", "recipe: 1\nadd:\n  - to: world\n    |\n")
    (geom,) = [each for each in offers if each["label"] == "geom"]
    assert geom["insertText"].split() == ["geom:"]


def test_hover(yaml_server: YamlServer, tmp_path: Path) -> None:
    shown = yaml_server.hover(tmp_path / "recipe.yaml", "recipe: 1\noption: {time|step: 0.001}\n")
    assert "timestep, s" in shown
