from __future__ import annotations

from composer.diagnostics import Sink
from composer.document import load, to_python
from composer.recipe.validate import validate_what_remains

WRONG = """
recipe: 1
base: ./arm.xml
attach:
  left: {model: ./hand.xml, sight: flange}
  right: {model: ./hand.xml, site: flange}
add:
  - {to: world, body: {name: cup, poss: 1 2 3}}
  - {to: world}
  - {to: world, body: {name: plate, pos: [0, 0, 1]}}
sensor:
  touch: {site: flange}
  force: {type: force, site: flange}
"""


def remaining(text: str) -> tuple[object, frozenset[str]] | None:
    node = load(text, "recipe.yaml", Sink())
    assert node is not None
    found = validate_what_remains(node, sink := Sink())
    assert sink.has_errors or found is not None
    return (to_python(found.document), found.lost) if found is not None else None


def test_the_smallest_piece_is_left_out() -> None:
    found = remaining(WRONG)
    assert found is not None
    document, lost = found
    assert document == {
        "recipe": 1,
        "base": "./arm.xml",
        "attach": {"left": {"model": "./hand.xml"}, "right": {"model": "./hand.xml", "site": "flange"}},
        "add": [
            {"to": "world", "body": {"name": "cup"}},
            {"to": "world", "body": {"name": "plate", "pos": [0, 0, 1]}},
        ],
        "sensor": {"force": {"type": "force", "site": "flange"}},
    }
    assert {"sight", "poss", "touch"} <= lost


def test_a_right_recipe_remains_whole() -> None:
    assert remaining("recipe: 1\nbase: ./arm.xml\n") == ({"recipe": 1, "base": "./arm.xml"}, frozenset())


def test_without_base_version_or_separator_nothing_can_be_judged() -> None:
    assert remaining("recipe: 2\nbase: ./arm.xml\n") is None
    assert remaining("recipe: 1\nbase: [1]\n") is None
    assert remaining("recipe: 1\nseparator: '#'\n") is None


def test_nothing_remains_without_the_base_however_it_is_spelt() -> None:
    assert remaining("recipe: 1\nbsae: ./arm.xml\nadd: []\n") is None
    assert remaining("recipe: 1\ncolour: ./arm.xml\nadd: []\n") is not None


def test_two_faults_in_a_part_of_which_one_takes_all_of_it() -> None:
    found = remaining("recipe: 1\nattach:\n  hand: {model: 1, subtree: [hand]}\n")
    assert found is not None and found[0] == {"recipe": 1, "attach": {}}
