from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cases import Case, cases
from language.validating import validate
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.language.recipe import SETTABLE
from mjcompose.language.schema import recipe_schema, text
from mjcompose.language.sections import MARKS
from mjcompose.text.load import load
from mjcompose.text.node import to_python
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType

ROOT = Path(__file__).parents[2]
FILE = ROOT / "schemas" / "recipe.schema.json"
RECIPES = sorted((ROOT / "recipes").glob("*.yaml"))
CASES = cases(Path(__file__).parent / "errors")

# What a schema cannot see: how an angle is written, characters that XML cannot hold, what is in a fragment.
UNSEEN = {"bare_angle", "bare_angle_of_joint", "no_orientation", "unprintable", "expression"}


@pytest.fixture(scope="module")
def validator() -> Any:
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schema = json.loads(FILE.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def parsed(text: str) -> Any:
    node = load(text, "recipe.yaml", Sink())
    assert node is not None
    return to_python(node)


def test_is_current() -> None:
    assert FILE.read_text(encoding="utf-8") == text(), "run `make schemas`"


def test_every_pointer_leads_somewhere() -> None:
    schema = json.loads(text())
    pointers = set(re.findall(r'"#/\$defs/([^"]*)"', text()))
    assert pointers == set(schema["$defs"])


def test_dialect(validator: Any) -> None:
    assert validator.schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_what_is_written_twice_is_a_definition() -> None:
    """Editors load the whole file before they say anything."""
    assert len(text().encode()) < 1_390_000


def test_choices_by_type_are_no_giant_alternatives() -> None:
    def alternatives(value: Any) -> Iterator[int]:
        if isinstance(value, dict):
            yield from (len(value[key]) for key in ("oneOf", "anyOf") if isinstance(value.get(key), list))
            value = list(value.values())
        if isinstance(value, list):
            for each in value:
                yield from alternatives(each)

    assert max(alternatives(json.loads(text()))) <= 3


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.name)
def test_accepts_shipped_recipe(validator: Any, path: Path) -> None:
    assert list(validator.iter_errors(parsed(path.read_text(encoding="utf-8")))) == []


@pytest.mark.parametrize(
    "case", [case for case in CASES if case.path.stem not in UNSEEN], ids=lambda case: case.path.stem
)
def test_refuses_wrong_recipe(validator: Any, case: Case) -> None:
    assert list(validator.iter_errors(parsed(case.texts["recipe.yaml"]))) != []


@pytest.mark.parametrize(
    "text",
    [
        "{recipe: 1, option: {gravity: '${g}', timestep: '${t}', cone: '${c}', iterations: '${i}'}}",
        "{recipe: 1, option: {gravity: [0, 0, '${g}']}, visual: {global: {orthographic: '${o}'}}}",
        "{recipe: 1, add: [{to: a, site: {euler: [90deg, 1.5e-1rad, .5rad]}}]}",
        "{recipe: 1, add: [{to: a, joint: {limited: true, range: [0, 1]}}]}",
        "{recipe: 1, add: [{to: {frame: f}, xml: <site/>}]}",
        "{recipe: 1, sensor: {a: {xml: <clock/>}}}",
        "{recipe: 1, edit: [{select: {geom: a}, expect: '${n}', collision: {spheres: {count: '${n}', seed: '${n}'}}}]}",
        "{recipe: 1, edit: [{select: {geom: a}, collision: {fit: '${shape}'}}]}",
        "{recipe: 1, edit: [{select: {geom: a}, collision: {decompose: {parts: '${n}', threshold: '${t}'}}}]}",
        "{recipe: 1, edit: [{select: {mesh: a}, simplify: {faces: '${n}'}}]}",
        "{recipe: 1, edit: [{select: {body: a}, inertia: {from: '${f}', density: '${d}', group: '${n}'}}]}",
        "{recipe: 1, edit: [{select: {motor: a}, datasheet: {model: '${m}', bandwidth: '${b}', effort: '${e}'}}]}",
        "{recipe: 1, contact: {exclude: {auto: {samples: '${n}', seed: '${n}'}}}}",
        "{recipe: 1, base: {model: a.xml, drop: [key]}}",
        "{recipe: 1, attach: {a: {model: m, prefix: '', joint: [{name: x, type: slide}]}}}",
        "{recipe: 1, attach: {a: {model: m, replicate: [{count: 2}, {count: '${n}', euler: [0, 0, 9deg]}]}}}",
        "{recipe: 1, keyframe: {a: {}, b: {time: 1, from: {base: home}, qpos: {x: 90deg, y: [1, 2]}, mpos: {z: [1, 2, 3]}}}}",
    ],
)
def test_accepts(validator: Any, text: str) -> None:
    assert list(validator.iter_errors(to_python(load(text, "r.yaml", Sink())))) == []  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "{recipe: 1, name: null}",
        "{recipe: 1, option: {gravity: [0, 0]}}",
        "{recipe: 1, option: {gravity: 0 0 1}}",
        "{recipe: 1, option: {timestep: 90 deg}}",
        "{recipe: 1, option: {iterations: 1.5}}",
        "{recipe: 1, option: {cone: round}}",
        "{recipe: 1, sensor: {a: {type: force, site: a, objtype: site}}}",
        "{recipe: 1, sensor: {a: {type: force}}}",
        "{recipe: 1, sensor: {a: {site: a}}}",
        "{recipe: 1, sensor: {a: {xml: <clock/>, type: clock}}}",
        "{recipe: 1, add: [{to: a, site: {quat: [1, 0, 0, 0], euler: [0, 0, 0]}}]}",
        "{recipe: 1, attach: {base: {model: m}}}",
        "{recipe: 1, attach: {a: {model: m, joint: hinge}}}",
        "{recipe: 1, compiler: {angle: degree}}",
        "{recipe: 1, keyframe: {a: {qpos: [1, 2]}}}",
        "{recipe: 1, keyframe: {a: {from: home}}}",
        "{recipe: 1, keyframe: {a: {mpos: {x: [1, 2]}}}}",
        "{recipe: 1, keyframe: {a: {plastic: {x: 1}}}}",
        "{recipe: 1, attach: {a: {model: m, replicate: [{offset: [1, 0, 0]}]}}}",
        "{recipe: 1, attach: {a: {model: m, replicate: [{count: 2, sep: _}]}}}",
        "{recipe: 1, tendon: {a: {type: spatial, path: [{joint: j, coef: 1}]}}}",
    ],
)
def test_refuses(validator: Any, text: str) -> None:
    assert list(validator.iter_errors(to_python(load(text, "r.yaml", Sink())))) != []  # type: ignore[arg-type]


def sample(attribute: Attribute) -> Any:
    """A value that fits."""
    if attribute.is_number:
        count = attribute.lengths[-1] if attribute.lengths else attribute.max_length or 2
        return 1 if count == 1 and attribute.max_length == 1 else [1] * count
    if attribute.type == "bool":
        return True
    if attribute.type in ("keyword", "keywords"):
        word = attribute.keywords[-1]
        return [word] if attribute.type == "keywords" else word
    return ["a", "b"] if attribute.type == "references" else "a"


def excluded(kind: ElementType, given: str) -> set[str]:
    """Attributes that cannot stand beside a given one."""
    bundles = [rule.bundles for rule in kind.constraints if rule.kind == "exclusive"]
    own = [(each, bundle) for each in bundles for bundle in each if given in bundle]
    return {name for each, bundle in own for other in each if other != bundle for name in other}


def needed(kind: ElementType, given: str) -> dict[str, Any]:
    """Attributes that must stand beside a given one."""
    names = {name for name, attribute in kind.attributes.items() if attribute.required}
    for rule in kind.constraints:
        if rule.kind == "oneof":
            names.update(next(each for each in rule.bundles if not set(each) & excluded(kind, given)))
        elif rule.kind == "together" and any(given in bundle for bundle in rule.bundles):
            names.update(name for bundle in rule.bundles for name in bundle)
        elif rule.kind == "requires" and given in rule.bundles[0]:
            names.update(rule.bundles[1])
    return {name: sample(kind.attributes[name]) for name in names - excluded(kind, given)}


def elements(kind: ElementType, skip: set[str]) -> Iterator[dict[str, Any]]:
    """An element with each of its attributes in turn."""
    for name, attribute in kind.attributes.items():
        if name not in skip:
            element = {**needed(kind, name), name: sample(attribute)}
            yield {key: value for key, value in element.items() if key not in skip}


def recipes() -> Iterator[tuple[str, dict[str, Any]]]:
    """A small recipe for each attribute of each element that a recipe can have."""
    head = {"recipe": 1, "angle": "degree"}
    for tag in ("sensor", "actuator", "equality", "tendon"):
        for kind in GRAMMAR.section(tag).children.values():
            for element in elements(kind, {"name"}):
                step = {"joint": "a", "coef": 1} if kind.tag == "fixed" else {"site": "a"}
                path = {"path": [step]} if tag == "tendon" else {}
                yield kind.path, {**head, tag: {"n": {"type": kind.tag, **path, **element}}}
    for tag in ("asset", "custom", "deformable"):
        for kind in GRAMMAR.section(tag).children.values():
            for element in elements(kind, {"name"}):
                yield kind.path, {**head, tag: {kind.tag: {"n": element}}}
    for kind in GRAMMAR.section("contact").children.values():
        for element in elements(kind, set()):
            yield kind.path, {**head, "contact": {kind.tag: [element]}}
    for kind in GRAMMAR.element("body").children.values():
        for element in elements(kind, set()):
            yield kind.path, {**head, "add": [{"to": "a", kind.tag: element}]}
    for tag in ("option", "size", "statistic", "visual", "compiler"):
        kind = GRAMMAR.section(tag)
        for element in elements(kind, set(kind.attributes) - SETTABLE if tag == "compiler" else set()):
            yield kind.path, {**head, tag: element}
        for child in kind.children.values():
            for element in elements(child, set()):
                yield child.path, {**head, tag: {child.tag: element}}
    for kind in GRAMMAR.section("default").children.values():
        if kind.tag != "default":
            for element in elements(kind, set()):
                yield kind.path, {**head, "default": {"c": {kind.tag: element}}}


def test_every_attribute_is_accepted_by_both(validator: Any) -> None:
    count = 0
    for path, recipe in recipes():
        sink = Sink()
        node = load(json.dumps(recipe), "recipe.yaml", sink)
        assert node is not None
        assert validate(node, sink) is not None, (path, recipe, [render(each) for each in sink.diagnostics])
        count += 1
        if count % 3 == 0:  # the schema is slower
            assert validator.is_valid(recipe), (path, recipe)
    assert count > 1500


def test_steps_of_tendons_are_marked() -> None:
    kinds = GRAMMAR.section("tendon").children.values()
    steps = {step.tag: step for kind in kinds for step in kind.children.values()}
    assert {tag: mark for tag, mark in MARKS.items() if mark in steps[tag].attributes} == MARKS


def test_no_attribute_is_called_like_a_key_of_the_language() -> None:
    own = {"xml", "config", "when"}
    for path in GRAMMAR.paths:
        kind = GRAMMAR.element(path)
        assert not own & set(kind.attributes), path
        assert not set(kind.attributes) & set(kind.children), path
    for tag in ("sensor", "actuator", "equality", "tendon"):
        for kind in GRAMMAR.section(tag).children.values():
            assert not {"type", "path"} & set(kind.attributes), kind


@pytest.mark.parametrize("seed", range(3))
def test_what_is_valid_is_valid_in_editors(validator: Any, seed: int) -> None:
    chance = random.Random(seed)
    values = [parsed(path.read_text(encoding="utf-8")) for path in RECIPES]
    for each in values:
        each.pop("variants", None)  # these are validated only when they are chosen
    accepted = 0
    for _ in range(150):
        value = pruned(chance.choice(values), chance)
        sink = Sink()
        node = load(json.dumps(value), "recipe.yaml", sink)
        assert node is not None
        if validate(node, sink) is not None:
            accepted += 1
            assert validator.is_valid(value), value
    assert accepted > 10


def pruned(value: Any, chance: random.Random) -> Any:
    """The value with some of what is in it left out or put elsewhere."""
    if isinstance(value, list):
        return [pruned(item, chance) for item in value if chance.random() > 0.02]
    if not isinstance(value, dict):
        return chance.choice(("a", 1, [0, 0, 1], "90deg", True)) if chance.random() < 0.02 else value
    return {
        name: item if name == "id" else pruned(item, chance)  # `expand` judges these
        for name, item in value.items()
        if chance.random() > 0.04 or name == "recipe"
    }


def test_every_key_is_explained() -> None:
    """Each property has a description, its own or that of what it refers to; conditions are not shown."""
    schema = recipe_schema()
    silent: list[str] = []

    def walk(value: Any, place: str) -> None:
        if isinstance(value, list):
            for index, each in enumerate(value):
                walk(each, f"{place}/{index}")
        if not isinstance(value, dict):
            return
        properties = value.get("properties", {})
        for name, each in properties.items():
            if isinstance(each, dict):
                target = schema["$defs"].get(each.get("$ref", "").rpartition("/")[2], {})
                if not each.get("description") and not target.get("description"):
                    silent.append(f"{place}/{name}")
        for key, each in value.items():
            if key != "if":
                walk(each, f"{place}/{key}")

    walk(schema, "")
    assert silent == []


@pytest.mark.parametrize("head", ["extends: ./a.yaml\n{}", "variants:\n  tool:\n    large:\n{}"])
@pytest.mark.parametrize(
    ("piece", "right"),
    [
        ("sensor: {tip: {noise: 0.1}}", True),
        ("sensor: null", True),
        ("attach: {left: {pos: [0, 0, 1], euler: null}, right: null}", True),
        ("keyframe: {home: {qpos: {elbow: null}}}", True),
        ("randomize: {samples: 3}", True),
        ("sensor: {tip: {type: force, nose: 0.1}}", False),
        ("attach: {left: {pos: [0, 0]}}", False),
        ("randomize: {samples: many}", False),
    ],
)
def test_a_piece_may_lack_keys_and_take_some_out(validator: Any, head: str, piece: str, right: bool) -> None:
    indented = f"      {piece}" if head.startswith("variants") else piece
    node = load(f"recipe: 1\n{head.replace('{}', indented)}\n", "recipe.yaml", Sink())
    assert node is not None
    assert (list(validator.iter_errors(to_python(node))) == []) is right
