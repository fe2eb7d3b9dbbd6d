"""The schema in a real editor's server."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from cases import Case
from mjcompose.tree.grammar import GRAMMAR

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
    ("exclusive_attributes", 5, "only one of the two is allowed"),
    ("two_places", 7, "only one of the two is allowed"),
    ("prefixes", 3, "not `base`"),
    ("joint_word", 3, '"free"'),
    ("tendon_path", 3, 'Missing property "path"'),
    ("list_for_names", 9, "Incorrect type"),
    ("globs", 4, "a choice is `{a,b}`"),
]

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.name)
def test_nothing_to_say_about_a_shipped_recipe(yaml_server: YamlServer, path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# yaml-language-server: $schema=../schemas/recipe.schema.json\n")
    assert yaml_server.diagnostics(path, text) == []


@pytest.mark.parametrize(("case", "line", "message"), WRONG, ids=[case for case, *_ in WRONG])
def test_wrong_recipe_is_marked(yaml_server: YamlServer, case: str, line: int, message: str) -> None:
    text = Case(ERRORS / f"{case}.txt").texts["recipe.yaml"]
    marked = yaml_server.diagnostics(ERRORS / case / "recipe.yaml", text)
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
        ("recipe: 1\nattach:\n  arm:\n    model: a.xml\n    replicate:\n      - |\n", {"count", "offset", "euler"}),
        ("recipe: 1\nattach:\n  arm:\n    model: a.xml\n    edit:\n      - |\n", {"select", "convert", "id"}),
        ("recipe: 1\nedit:\n  - select:\n      |\n", {"joint", "actuator", "default", "in", "where"}),
        ("recipe: 1\nedit:\n  - select: {joint: a}\n    convert:\n      to: |\n", {"motor", "pid"}),
        ("recipe: 1\nedit:\n  - select: {camera: a}\n    set:\n      |\n", {"fovy", "pos", "mode"}),
        ("recipe: 1\nedit:\n  - select: {joint: a}\n    scale:\n      |\n", {"damping", "range"}),
        (
            "recipe: 1\nedit:\n  - select: {actuator: a}\n    convert:\n      to: motor\n      |\n",
            {"gear", "ctrlrange"},
        ),
        ("recipe: 1\nparams:\n  reach:\n    |\n", {"default", "min", "unit", "choices"}),
        ("recipe: 1\nvariants:\n  light:\n    dim:\n      |\n", {"visual", "attach", "params", "edit"}),
        ("recipe: 1\nmatrix:\n  |\n", {"axes", "exclude", "include", "name"}),
        ("recipe: 1\nrandomize:\n  |\n", {"seed", "samples", "fields"}),
        ("recipe: 1\nrandomize:\n  fields:\n    f:\n      |\n", {"select", "attr", "param", "truncnormal", "per"}),
        ("recipe: 1\ncheck:\n  a:\n    |\n", {"expect", "reachable", "unchanged", "when"}),
        ("recipe: 1\ncheck:\n  a:\n    expect:\n      select:\n        |\n", {"site", "where", "in", "parent"}),
        ("recipe: 1\nkeyframe:\n  home:\n    |\n", {"from", "qpos", "mquat", "time"}),
    ],
)
def test_completion(yaml_server: YamlServer, tmp_path: Path, text: str, offered: set[str]) -> None:
    found = {each["label"] for each in yaml_server.completions(tmp_path / "recipe.yaml", text)}
    assert offered <= found


def test_a_new_element_is_not_filled_with_defaults(yaml_server: YamlServer, tmp_path: Path) -> None:
    offers = yaml_server.completions(tmp_path / "recipe.yaml", "recipe: 1\nadd:\n  - to: world\n    |\n")
    (geom,) = [each for each in offers if each["label"] == "geom"]
    assert geom["insertText"].split() == ["geom:"]


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("recipe: 1\nactuator:\n  a:\n    type: position\n    |\n", "ctrlrange: [$1, $2]"),
        ("recipe: 1\nattach:\n  arm:\n    model: a.xml\n    |\n", "pos: [$1, $2, $3]"),
        ("recipe: 1\noption:\n  |\n", "gravity: [$1, $2, $3]"),
    ],
)
def test_a_new_list_has_brackets(yaml_server: YamlServer, tmp_path: Path, text: str, offered: str) -> None:
    """A list with dashes would be a fault inside braces."""
    offers = yaml_server.completions(tmp_path / "recipe.yaml", text)
    assert offered in [each["insertText"] for each in offers]


@pytest.mark.parametrize("section", ["sensor", "actuator", "equality"])
def test_a_type_decides_what_is_offered(yaml_server: YamlServer, tmp_path: Path, section: str) -> None:
    kinds = GRAMMAR.section(section).children.values()
    for kind in kinds:
        text = f"recipe: 1\n{section}:\n  a:\n    type: {kind.tag}\n    |\n"
        offers = yaml_server.completions(tmp_path / f"{kind.tag}.yaml", text)
        # To the server `flex` may still become `flexstrain`.
        possible = [each for each in kinds if each.tag.startswith(kind.tag)]
        least, most = (
            {name for each in some for name in (*each.attributes, *each.children, "xml", "for", "when")}
            for some in ([kind], possible)
        )
        assert least <= {each["label"] for each in offers} <= most, kind.path
        assert all(each["documentation"] for each in offers), kind.path


HOVERED = [
    ("sen|sor: {}", "Sensors by name."),
    ("sensor: {a|: {type: force, site: s}}", "force between the site's body and its parent"),
    ("sensor: {a: {ty|pe: force, site: s}}", "* `gyro`: angular velocity of a site in its frame"),
    ("sensor: {a: {type: for|ce, site: s}}", "* `force`: force between"),
    ("sensor: {a: {type: framepos, obj|name: s}}", "name of the object (of the kind that `objtype` names)"),
    ("actuator: {a: {type: position, joint: j, k|p: 1}}", GRAMMAR.element("actuator/position").attributes["kp"].doc),
    ("add: [{to: world, bo|dy: {}}]", "a rigid body"),
    ("add: [{to: world, body: {ge|om: {}}}]", "a shape that collides"),
    ("add: [{to: world, body: {geom: [{ty|pe: box}]}}]", "shape (default: sphere)"),
    ("asset: {tex|ture: {}}", "an image on surfaces"),
    ("default: {pad: {ge|om: {}}}", "defaults of every geom in this class"),
    ("default: {pad: {geom: {fric|tion: [1]}}}", "sliding"),
    ("contact: {ex|clude: []}", "Pairs of bodies that must not collide"),
    ("tendon: {r: {type: spatial, pa|th: [{site: s}]}}", "its elements, in order"),
    ("option: {time|step: 0.001}", "timestep, s (default: 0.002)"),
    ("option: {fl|ag: {}}", "switched on or off"),
    ("attach: {arm: {mo|del: a}}", "`menagerie:…`"),
    ("base: {sub|tree: a, model: b}", "The body of the model"),
    ("attach: {arm: {model: a, ma|te: b}}", "that coincides with the place"),
    ("attach: {arm: {model: a, replicate: [{co|unt: 3}]}}", "how many"),
    ("edit: [{sel|ect: {joint: a}, remove: true}]", "the selected elements"),
    ("edit: [{select: {joint: a, wh|ere: {type: hinge}}, remove: true}]", "attributes and their values in effect"),
    ("edit: [{select: {actuator: a}, con|vert: {to: motor}}]", "another kind of actuator"),
    ("edit: [{select: {joint: a}, s|et: {damping: 1}}]", "attributes and their new values"),
    ("edit: [{select: {camera: a}, set: {fo|vy: 1}}]", GRAMMAR.element("camera").attributes["fovy"].doc),
    ("params: {reach: {defa|ult: 1}}", "the value if you set none"),
    ("var|iants: {light: {dim: {}}}", "One piece of each axis is merged"),
    ("matrix: {ax|es: {light: [dim]}}", "every combination"),
    ("randomize: {seed: 1, samples: 2, fields: {f: {select: {geom: a}, attr: size, uni|form: [0, 1]}}}", "Uniform"),
    ("check: {a: {expect: {select: {geom: a, wh|ere: {type: box}}}}}", "only elements with these values"),
    ("check: {a: {set|tles: {}}}", "does not diverge"),
    ("keyframe: {home: {q|pos: {}}}", "positions of all joints"),
]


@pytest.mark.parametrize(("line", "shown"), HOVERED)
def test_hover(yaml_server: YamlServer, tmp_path: Path, line: str, shown: str) -> None:
    found = yaml_server.hover(tmp_path / "recipe.yaml", f"recipe: 1\n{line}\n")
    assert shown in json.loads(found)["contents"]["value"]


def test_hover_is_about_one_thing(yaml_server: YamlServer, tmp_path: Path) -> None:
    """Without titles, which editors put before a description, once for each alternative."""
    found = yaml_server.hover(tmp_path / "recipe.yaml", "recipe: 1\noption: {integ|rator: RK4}\n")
    assert json.loads(found)["contents"]["value"].startswith("numerical integrator (default: Euler)\n")


MARKED = [
    ("sensor: {a: {type: forc, site: s}}", 19, "Value is not accepted"),
    ("sensor: {a: {type: force, objname: s}}", 26, "objname is not allowed"),
    ("sensor: {a: {type: force}}", 9, 'Missing property "site"'),
    ("actuator: {a: {type: position, joint: j, gainprm: [1]}}", 41, "gainprm is not allowed"),
    ("actuator: {a: {type: motor, joint: j, gear: one}}", 44, "expected a number"),
    ("equality: {a: {type: connect, body1: a, polycoef: [1]}}", 40, "polycoef is not allowed"),
    ("add: [{to: world, geom: {typ: box}}]", 25, "typ is not allowed"),
    ("asset: {mesh: {m: {scale: [1, 1]}}}", 26, "too few items"),
    ("attach: {arm: {site: s}}", 9, 'Missing property "model"'),
    ("edit: [{select: {joint: a}, set: {dampin: 1}}]", 42, "not an attribute of these elements"),
    ("edit: [{select: {geom: a}, set: {rgba: [1, 0, 0]}}]", 39, "too few items"),
    ("edit: [{select: {actuator: a}, convert: {to: motor, kp: 1}}]", 52, "kp is not allowed"),
]


@pytest.mark.parametrize(("line", "column", "message"), MARKED)
def test_a_fault_is_marked_where_it_is(
    yaml_server: YamlServer, tmp_path: Path, line: str, column: int, message: str
) -> None:
    found = yaml_server.diagnostics(tmp_path / "recipe.yaml", f"recipe: 1\n{line}\n")
    there = [each["message"] for each in found if each["range"]["start"] == {"line": 1, "character": column}]
    assert any(message in each for each in there), found
