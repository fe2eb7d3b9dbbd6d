from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.language.attach import Attachment
from mjcompose.language.check import checks_of
from mjcompose.language.checks.unchanged import Unchanged
from mjcompose.language.recipe import Recipe
from mjcompose.language.value import RecipeElement
from mjcompose.text.expression import Angle
from mjcompose.tree.pattern import EVERYTHING, Selector
from pydantic import ValidationError


def test_targets(recipe: Callable[[str], Recipe]) -> None:
    add = recipe(
        """
        add:
          - {to: world, body: {name: a}}
          - {to: a, site: {}}
          - {to: {frame: f}, geom: {size: 1}}
        """
    ).add
    assert [(each.to_kind, each.to_name, each.elements[0].tag, each.at) for each in add] == [
        ("world", "world", "body", ("add", 0)),
        ("body", "a", "site", ("add", 1)),
        ("frame", "f", "geom", ("add", 2)),
    ]


def test_children_keep_the_order_of_the_file(recipe: Callable[[str], Recipe]) -> None:
    (added,) = recipe(
        """
        add:
          - to: world
            body:
              geom: [{name: a, size: 1}, {name: b, size: 1}]
              inertial: {pos: [0, 0, 0], mass: 1}
              body: [{name: inner, freejoint: {}}]
        """
    ).add
    assert [child.tag for child in added.elements[0].children] == ["geom", "geom", "inertial", "body"]
    assert added.elements[0].children[1].at == ("add", 0, "body", "geom", 1)
    assert added.elements[0].children[3].children == (
        RecipeElement("freejoint", at=("add", 0, "body", "body", 0, "freejoint")),
    )


def test_an_entry_adds_one_element_or_a_list(recipe: Callable[[str], Recipe]) -> None:
    one, several = recipe(
        "add: [{to: a, site: {name: s}}, {to: a, geom: [{name: x, size: 1}, {xml: '<geom name=\"y\"/>'}]}]"
    ).add
    assert [(element.tag, element.at) for element in one.elements] == [("site", ("add", 0, "site"))]
    assert [(element.tag, element.at) for element in several.elements] == [
        ("geom", ("add", 1, "geom", 0)),
        ("geom", ("add", 1, "geom", 1)),
    ]
    assert several.elements[1].xml == '<geom name="y"/>'


def test_fragment(recipe: Callable[[str], Recipe]) -> None:
    (added,) = recipe("add: [{to: hand, xml: '<site name=\"tcp\"/>'}]").add
    assert added.elements[0] == RecipeElement("site", xml='<site name="tcp"/>', at=("add", 0))


def test_plugin_with_settings(recipe: Callable[[str], Recipe]) -> None:
    text = "add: [{to: a, plugin: {plugin: p, config: {n: 3, on: true, v: [1, 2.5], t: x}}}]"
    (added,) = recipe(text).add
    settings = {child.attributes["key"]: child.attributes["value"] for child in added.elements[0].children}
    assert settings == {"n": "3", "on": "true", "v": "1 2.5", "t": "x"}


@pytest.mark.parametrize(
    ("entry", "code"),
    [
        ("{to: hand}", "missing-key"),
        ("{site: {}}", "missing-key"),
        ("{to: 3, site: {}}", "wrong-type"),
        ("{to: {site: a}, site: {}}", "unknown-key"),
        ("{to: world, freejoint: {}}", "unknown-element"),
        ("{to: hand, sensor: {}}", "unknown-element"),
        ("{to: hand, site: {}, geom: {}}", "wrong-type"),
        ("{to: hand, site: []}", "missing-key"),
        ("{to: hand, site: tcp}", "wrong-type"),
        ("{to: hand, inertial: {}}", "missing-key"),
        ("{to: hand, body: {inertial: [{mass: 1, pos: [0, 0, 0]}, {mass: 1, pos: [0, 0, 0]}]}}", "wrong-length"),
        ("hand", "wrong-type"),
    ],
)
def test_wrong_entry(faults: Callable[[str], list[Diagnostic]], entry: str, code: str) -> None:
    assert " ".join(sorted(fault.code for fault in faults(f"add: [{entry}]"))) == code


def test_a_check_knows_its_name_and_place(recipe: Callable[[str], Recipe]) -> None:
    found = recipe("""
        check:
          whole: {unchanged: {}}
          hand: {unchanged: {part: left/hand, except: [gravcomp, friction]}}
    """).check
    whole, hand = checks_of(found)
    assert isinstance(whole, Unchanged) and isinstance(hand, Unchanged)
    assert (whole.name, whole.at, whole.part, whole.excepted) == ("whole", ("check", "whole", "unchanged"), None, ())
    assert (hand.name, hand.part, hand.excepted) == ("hand", "left/hand", ("gravcomp", "friction"))


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("[{unchanged: {}}]", "wrong-type", "expects a mapping"),
        ("{a: {}}", "missing-key", "checks nothing"),
        ("{a: unchanged}", "wrong-type", "expects a mapping"),
        ("{a: {unchange: {}}}", "unknown-key", "has no kind"),
        ("{a: {unchanged: gripper}}", "wrong-type", "expects a mapping"),
        ("{a: {unchanged: {parts: gripper}}}", "unknown-key", "has no key `parts`"),
        ("{a: {unchanged: {part: [gripper]}}}", "wrong-type", "the prefix of a part"),
        ("{a: {unchanged: {except: gravcomp}}}", "wrong-type", "a list of attributes"),
        ("{a: {unchanged: {except: [gravcom]}}}", "unknown-attribute", "no attribute `gravcom`"),
        ("{a: {unchanged: {except: [1]}}}", "wrong-type", "an attribute of MJCF"),
        ("{a: {unchanged: {except: [class]}}}", "unknown-attribute", "could be excepted"),
    ],
)
def test_one_fault_at_its_place(faults: Callable[[str], list[Diagnostic]], text: str, code: str, told: str) -> None:
    (fault,) = faults(f"check: {text}")
    assert fault.code == code
    assert told in fault.message
    assert fault.span is not None
    assert fault.span.line == 2


def test_of_a_misspelt_attribute_the_right_one_is_named(faults: Callable[[str], list[Diagnostic]]) -> None:
    (fault,) = faults("check: {a: {unchanged: {part: arm, except: [gravcom]}}}")
    assert fault.help == "write `gravcomp`"
    assert fault.span is not None
    assert fault.span.column == 45


ROOT = Path(__file__).parents[2]


def test_defaults(recipe: Callable[[str], Recipe]) -> None:
    read = recipe("")
    assert (read.name, read.description, read.angle, read.base) == (None, None, None, None)
    assert (read.eulerseq, read.separator, read.conflict) == ("xyz", "/", "error")
    assert (read.attach, read.add, read.sensor, read.option) == ({}, (), (), None)


def test_head(recipe: Callable[[str], Recipe]) -> None:
    read = recipe(
        """
        name: cell
        description: ""
        angle: radian
        eulerseq: ZYX
        separator: "__"
        conflict: mujoco
        base: ./arm.xml
        """
    )
    assert (read.name, read.description, read.angle, read.eulerseq) == ("cell", "", "radian", "ZYX")
    assert (read.separator, read.conflict) == ("__", "mujoco")
    assert read.base == Attachment(model="./arm.xml", keys="merge")


def test_base_as_a_mapping(recipe: Callable[[str], Recipe]) -> None:
    base = recipe("base: {model: ./arm.xml, drop: [key]}").base
    assert base is not None and base.key_policy == "none"
    (drop,) = base.drop
    assert (base.model, drop.section, drop.select, drop.index) == ("./arm.xml", None, Selector("key", EVERYTHING), 0)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("base: [./arm.xml]", "wrong-type"),
        ("base: 3", "wrong-type"),
        ('base: ""', "wrong-type"),
        ("base: {}", "missing-key"),
        ("name: ''", "wrong-type"),
        ("eulerseq: xy", "wrong-keyword"),
        ("angle: 1", "wrong-type"),
        ("attach: 1", "wrong-type"),
    ],
)
def test_wrong_head(faults: Callable[[str], list[Diagnostic]], text: str, code: str) -> None:
    assert [fault.code for fault in faults(text)] == [code]


def test_frozen(recipe: Callable[[str], Recipe]) -> None:
    with pytest.raises(ValidationError):
        recipe("name: cell").name = "other"  # type: ignore[misc]


def test_python_data_without_places() -> None:
    read = Recipe.model_validate({"recipe": 1, "add": [{"to": "hand", "site": {"euler": [0, 90, "1rad"]}}]})
    assert read.add[0].elements[0].attributes["euler"] == (0, 90, Angle(1.0, "rad"))
    assert read.add[0].elements[0].at == ()


PROBE = """
import sys, time
def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result
def pydantic():
    from pydantic import BaseModel, ValidationError, model_validator
    class Model(BaseModel):
        x: int
    Model(x=1)
def read():
    from mjcompose.language.validate import validate_what_remains
    return validate_what_remains(node, sink)
base, _ = timed(pydantic)
from mjcompose.text.load import load
from mjcompose.base.sink import Sink
sink = Sink()
node = load(open(sys.argv[1]).read(), "recipe.yaml", sink)
own, recipe = timed(read)
assert recipe is not None
unwanted = {"lxml", "numpy", "mujoco", "mjcompose.language.schema"}
print(own / base, *unwanted.intersection(sys.modules))
"""


def test_reading_costs_little_beside_pydantic(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(tmp_path)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, "-c", PROBE, str(ROOT / "recipes" / "demo.yaml")]
    ratios = []
    for _ in range(4):  # the first one compiles
        done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True)
        ratio, *heavy = done.stdout.split()
        assert heavy == []
        ratios.append(float(ratio))
    assert min(ratios) < 0.6
