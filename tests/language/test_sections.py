"""The sections of MJCF in every form: singleton, typed, by tag, lists, classes, plugins."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.language.recipe import Recipe
from mjcompose.language.value import RecipeElement
from mjcompose.text.expression import Angle
from mjcompose.text.load import load
from mjcompose.text.node import locate


def test_singleton(recipe: Callable[[str], Recipe]) -> None:
    option = recipe("option: {cone: elliptic, flag: {contact: disable}}").option
    flag = RecipeElement("flag", {"contact": "disable"}, at=("option", "flag"))
    assert option == RecipeElement("option", {"cone": "elliptic"}, (flag,), at=("option",))


def test_visual_has_children_alone(recipe: Callable[[str], Recipe]) -> None:
    visual = recipe("visual: {headlight: {active: 1}, global: {fovy: 1rad}}").visual
    assert visual is not None
    assert [child.tag for child in visual.children] == ["headlight", "global"]
    assert visual.children[1].attributes["fovy"] == Angle(1.0, "rad")


@pytest.mark.parametrize("name", ["discardvisual: true", "boundmass: 0.1", "lengthrange: {mode: all}"])
def test_compiler_settings_of_a_whole_model(recipe: Callable[[str], Recipe], name: str) -> None:
    assert recipe(f"compiler: {{{name}}}").compiler is not None


@pytest.mark.parametrize("name", ["angle: degree", "meshdir: x", "eulerseq: xyz", "xml: <compiler/>"])
def test_compiler_settings_of_a_part(faults: Callable[[str], list[Diagnostic]], name: str) -> None:
    assert [fault.code for fault in faults(f"compiler: {{{name}}}")] == ["compiler-setting"]


def test_typed(recipe: Callable[[str], Recipe]) -> None:
    read = recipe("actuator: {lift: {type: position, joint: slide, kp: 400, ctrlrange: [0, 90deg]}}")
    attributes = {"name": "lift", "joint": "slide", "kp": 400, "ctrlrange": (0, Angle(90.0, "deg"))}
    assert read.actuator == (RecipeElement("position", attributes, at=("actuator", "lift")),)


def test_name_that_is_the_key_can_be_located() -> None:
    sink = Sink()
    node = load("recipe: 1\nsensor:\n  wrist: {type: clock}\n", "recipe.yaml", sink)
    assert node is not None
    assert locate(node, ("sensor", "wrist"), key=True).column == 3


def test_fragment_takes_the_name_of_its_key(recipe: Callable[[str], Recipe]) -> None:
    (sensor,) = recipe("sensor: {pad: {xml: '<touch site=\"a\"/>'}}").sensor
    assert sensor == RecipeElement("touch", {"name": "pad"}, xml='<touch site="a"/>', at=("sensor", "pad"))


@pytest.mark.parametrize(
    ("section", "entry"),
    [
        ("equality", "{name: '', type: joint, joint1: a}"),
        ("equality", "{name: '', xml: '<joint joint1=\"a\"/>'}"),
        ("actuator", "{name: '', type: motor, joint: a}"),
        ("tendon", "{name: '', type: fixed, path: [{joint: a, coef: 1}]}"),
    ],
)
def test_an_empty_name_leaves_an_element_without_one(recipe: Callable[[str], Recipe], section: str, entry: str) -> None:
    (element,) = getattr(recipe(f"{section}: {{label: {entry}}}"), section)
    assert "name" not in element.attributes and element.at == (section, "label")


def test_an_asset_without_a_name(recipe: Callable[[str], Recipe]) -> None:
    (sky,) = recipe("asset: {texture: {sky: {name: '', type: skybox, builtin: flat}}}").asset
    assert "name" not in sky.attributes


def test_tendon_path_keeps_its_order(recipe: Callable[[str], Recipe]) -> None:
    (rope,) = recipe(
        """
        tendon:
          rope:
            type: spatial
            width: 0.01
            path:
              - {site: a}
              - {geom: g, sidesite: s}
              - {pulley: 2}
              - {divisor: 3}
              - {site: b}
              - {xml: <site site="c"/>}
        """
    ).tendon
    assert rope.attributes == {"name": "rope", "width": 0.01}
    assert [(step.tag, dict(step.attributes)) for step in rope.children] == [
        ("site", {"site": "a"}),
        ("geom", {"geom": "g", "sidesite": "s"}),
        ("pulley", {"divisor": 2}),
        ("pulley", {"divisor": 3}),
        ("site", {"site": "b"}),
        ("site", {}),
    ]
    assert rope.children[1].at == ("tendon", "rope", "path", 1)


def test_fixed_tendon(recipe: Callable[[str], Recipe]) -> None:
    (couple,) = recipe("tendon: {c: {type: fixed, path: [{joint: a, coef: 1}, {joint: b, coef: -1}]}}").tendon
    assert [step.attributes["coef"] for step in couple.children] == [1, -1]


@pytest.mark.parametrize(
    ("tendon", "code"),
    [
        ("{type: spatial}", "missing-key"),
        ("{type: spatial, path: []}", "wrong-length"),
        ("{type: spatial, path: {site: a}}", "wrong-type"),
        ("{type: spatial, path: [a]}", "wrong-type"),
        ("{type: spatial, path: [{}]}", "missing-key"),
        ("{type: spatial, path: [{joint: a, coef: 1}]}", "missing-key"),
        ("{type: spatial, path: [{geom: a, site: b}]}", "wrong-type"),
        ("{type: spatial, path: [{pulley: a}]}", "wrong-type"),
        ("{type: spatial, path: [{pulley: 2, divisor: 2}]}", "unknown-attribute"),
        ("{type: spatial, path: [{site: a, offset: 1}]}", "unknown-attribute"),
        ("{type: fixed, path: [{joint: a}]}", "missing-key"),
        ("{type: fixed, joint: [{joint: a, coef: 1}]}", "unknown-key"),
    ],
)
def test_wrong_tendon(faults: Callable[[str], list[Diagnostic]], tendon: str, code: str) -> None:
    assert [fault.code for fault in faults(f"tendon: {{t: {tendon}}}")] == [code]


def test_by_tag(recipe: Callable[[str], Recipe]) -> None:
    read = recipe(
        """
        asset:
          material: {m: {layer: [{texture: a, role: rgb}, {texture: b, role: normal}]}}
          texture: {a: {type: 2d}}
        custom:
          tuple: {t: {element: [{objtype: body, objname: b, prm: 1}]}}
        deformable:
          skin: {s: {file: ./s.skn}}
        """
    )
    assert [(each.tag, each.attributes["name"]) for each in read.asset] == [("material", "m"), ("texture", "a")]
    assert [layer.attributes["texture"] for layer in read.asset[0].children] == ["a", "b"]
    assert read.asset[1].attributes["type"] == "2d"
    assert read.custom[0].children[0].attributes == {"objtype": "body", "objname": "b", "prm": 1}
    assert read.deformable[0].at == ("deformable", "skin", "s")


def test_lists(recipe: Callable[[str], Recipe]) -> None:
    contact = recipe("contact: {exclude: [{body1: a, body2: b}], pair: [{geom1: c, geom2: d}]}").contact
    assert [(each.tag, each.at) for each in contact.elements] == [
        ("exclude", ("contact", "exclude", 0)),
        ("pair", ("contact", "pair", 0)),
    ]


def test_classes(recipe: Callable[[str], Recipe]) -> None:
    main, finger = recipe("default: {main: {geom: {condim: 4}}, finger: {parent: hand, joint: {}}}").default
    assert (main.name, main.parent, main.element.tag) == ("main", None, "default")
    assert main.element.children == (RecipeElement("geom", {"condim": 4}, at=("default", "main", "geom")),)
    assert (finger.parent, finger.element.at) == ("hand", ("default", "finger"))


def test_joint_in_a_class_may_be_of_any_type(recipe: Callable[[str], Recipe]) -> None:
    recipe("default: {finger: {joint: {range: [0, 0.4]}}}")


def test_plugins(recipe: Callable[[str], Recipe]) -> None:
    one, two = recipe("extension: {plugin: {a: {instance: {i: {config: {k: 1}}}}, b: {}}}").extension
    assert (one.tag, one.attributes, two.attributes) == ("plugin", {"plugin": "a"}, {"plugin": "b"})
    (instance,) = one.children
    assert instance.attributes == {"name": "i"}
    assert instance.children[0].attributes == {"key": "k", "value": "1"}
    assert instance.children[0].at == ("extension", "plugin", "a", "instance", "i", "config", "k")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("sensor: {'': {type: clock}}", "bad-name"),
        ("sensor: {a: {type: 3}}", "wrong-type"),
        ("sensor: {a: clock}", "wrong-type"),
        ("sensor: {a: {xml: <clok/>}}", "unknown-element"),
        ("sensor: {a: {xml: 3}}", "wrong-type"),
        ("sensor: [{type: clock}]", "wrong-type"),
        ("asset: [{mesh: a}]", "wrong-type"),
        ("asset: {geom: {}}", "unknown-element"),
        ("contact: {exclude: [{body1: a}]}", "missing-key"),
        ("custom: {numeric: {n: {data: abc}}}", "wrong-type"),
        ("option: [1]", "wrong-type"),
        ("option: {flag: 1}", "wrong-type"),
        ("default: {a: 1}", "wrong-type"),
        ("default: {a: {parent: 3}}", "wrong-type"),
        ("default: {a: {body: {}}}", "unknown-element"),
        ("extension: {plugin: {a: {instance: {i: {config: [1]}}}}}", "wrong-type"),
        ("extension: {plugin: {a: {instance: {i: {config: {k: {}}}}}}}", "wrong-type"),
    ],
)
def test_wrong_section(faults: Callable[[str], list[Diagnostic]], text: str, code: str) -> None:
    assert [fault.code for fault in faults(text)] == [code]


def test_mesh_may_be_called_like_a_key_of_later(recipe: Callable[[str], Recipe]) -> None:
    (mesh,) = recipe("asset: {mesh: {when: {file: a.stl}}}").asset
    assert mesh.attributes["name"] == "when"
