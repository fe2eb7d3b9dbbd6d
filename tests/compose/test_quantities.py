"""An angle from a parameter is the angle that is written in its place: for each attribute, in each place, in each unit.

MuJoCo judges: it compiles the model of the recipe, and MJCF in radians that this module writes itself. Each model has
an element for each attribute of the grammar that is an angle.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np
import pytest
import yaml
from mjcompose.compose.compose import Composer
from mjcompose.link.measure import measure_with
from mjcompose.plan.matrix import read_matrix
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.tools.open.recipe import nodes_of
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.values import is_in_degrees
from mjcompose.tree.xml_text import as_it_is

Attributes = dict[str, Any]


class Subject(NamedTuple):
    """An element with an attribute that is an angle; `frame` makes the element that holds it in the world."""

    path: str
    name: str
    own: Attributes
    numbers: Callable[[Any], Any]
    """The value of the attribute for an angle."""
    place: int | None
    """The index of the angle in the attribute, for a subscript."""
    around: str = "body"

    @property
    def tag(self) -> str:
        return self.path.rpartition("/")[2]

    @property
    def called(self) -> str:
        return f"{self.tag}_{self.name}"


_ORIENTATIONS = {
    "euler": (lambda angle: [0, angle, 0], 1),
    "axisangle": (lambda angle: [0, 0, 1, angle], 3),
}
_OF_JOINTS = {
    "range": (lambda angle: [0, angle], 1),
    "ref": (lambda angle: angle, None),
    "springref": (lambda angle: angle, None),
    "springyield": (lambda angle: angle, None),
}
_BOX = {"type": "box", "size": [0.1, 0.2, 0.3], "mass": 1}
_OWN: Mapping[str, Attributes] = {
    "body": {"geom": _BOX},
    "frame": {"geom": _BOX},
    "inertial": {"mass": 1, "pos": [0, 0, 0], "diaginertia": [1, 2, 2.5]},
    "geom": _BOX,
    "site": {"type": "box", "size": [0.1, 0.2, 0.3]},
    "camera": {},
    "flexcomp": {"type": "grid", "dim": 2, "count": [3, 3, 1], "spacing": [0.1, 0.1, 0.1], "mass": 1},
    "replicate": {"count": 2, "offset": [1, 0, 0], "geom": _BOX},
    "joint": {"axis": [0, 1, 0]},
}
_IN_BODIES = ("inertial", "joint")
_LEFT_OUT = {("composite/joint", "range")}  # MuJoCo 4.0 has only cables, whose joints are balls without a range


def subjects() -> Iterator[Subject]:
    for path in GRAMMAR.paths:
        kind = GRAMMAR.element(path)
        for attribute in kind.attributes.values():
            if kind.path.startswith("default/") or (path, attribute.name) in _LEFT_OUT:
                continue
            if not attribute.exists_in(mujoco.__version__):
                continue
            if attribute.angle == "joint":
                yield Subject(path, attribute.name, _OWN[path], *_OF_JOINTS[attribute.name])
            elif attribute.angle is not None:
                yield Subject(path, attribute.name, _OWN[path], *_ORIENTATIONS[attribute.name])
            elif is_in_degrees(kind.tag, attribute.name) and path in ("camera", "light"):
                yield Subject(path, attribute.name, {}, lambda angle: angle, None)


SUBJECTS = [*subjects()]
SELECTABLE = [each for each in SUBJECTS if each.tag != "replicate"]
# What a class can give. MuJoCo 4.0 refuses an orientation of a class next to one of the element.
OF_CLASSES = [each for each in SUBJECTS if each.tag == "joint"]
MOVABLE = [each for each in SELECTABLE if each.name in _ORIENTATIONS and each.tag in ("body", "geom", "site", "camera")]


def element(subject: Subject, value: Any) -> tuple[str, Attributes]:
    """Return the child of the world that has the element of a subject, with the value of its attribute or none."""
    own: Attributes = {"name": subject.called, **subject.own}
    if subject.tag in ("inertial", "replicate"):
        del own["name"]
    if value is not None:
        own[subject.name] = value
    if subject.tag not in _IN_BODIES:
        return subject.tag, own
    beside = {} if subject.tag == "inertial" else {"geom": _BOX}
    return "body", {"name": f"body_of_{subject.called}", subject.tag: own, **beside}


def markup(tag: str, attributes: Attributes) -> str:
    written = ""
    below = ""
    for name, value in attributes.items():
        if isinstance(value, dict):
            below += markup(name, value)
        else:
            text = " ".join(map(repr, value)) if isinstance(value, list) else str(value)
            written += f' {name}="{text}"'
    return f"<{tag}{written}>{below}</{tag}>"


class Meant(NamedTuple):
    """An angle in the units of MJCF, where `fovy` and `cutoff` are in degrees and all others here in radians."""

    radians: float
    degrees: float

    @classmethod
    def of(cls, radians: float) -> Meant:
        return cls(radians, math.degrees(radians))

    @classmethod
    def bare(cls, number: float, angle: str) -> Meant:
        """A number without a unit is in the unit of the recipe, and in degrees where MJCF has degrees only."""
        return cls(math.radians(number) if angle == "degree" else number, number)


def world(chosen: list[Subject], meant: Meant, others: float | None, angle: str = "radian") -> str:
    """Return MJCF in which the `chosen` subjects have one angle, and the others another, or no such attribute."""
    rows = []
    for each in SUBJECTS:
        value = meant if each in chosen else None if others is None else Meant.of(others)
        in_degrees = is_in_degrees(each.tag, each.name)
        number = None if value is None else each.numbers(value.degrees if in_degrees else value.radians)
        rows.append(markup(*element(each, number)))
    return f'<mujoco model="w"><compiler angle="{angle}"/><worldbody>{"".join(rows)}</worldbody></mujoco>'


_ARRAYS = {
    "body": ("body_quat", "body_iquat"),
    "geom": ("geom_quat", "geom_pos"),
    "site": ("site_quat",),
    "camera": ("cam_quat", "cam_fovy"),
    "light": ("light_cutoff",),
    "joint": ("jnt_range", "qpos0", "qpos_spring"),
}


def assert_same(found: mujoco.MjModel, expected: mujoco.MjModel) -> None:
    for kind, arrays in _ARRAYS.items():
        object_type = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
        for array in arrays:
            ours = getattr(found, array)
            theirs = getattr(expected, array)
            assert ours.shape == theirs.shape, array
            for row in range(len(theirs)):
                name = mujoco.mj_id2name(expected, object_type, row)
                place = row if name is None else mujoco.mj_name2id(found, object_type, name)
                np.testing.assert_allclose(ours[place], theirs[row], atol=1e-12, err_msg=f"{array} of {name}")


Place = Callable[[dict[str, Any], str], list[Subject]]
"""Add the entries of a place to a recipe, with this text for the angle. Return the subjects whose angles it sets."""


def _select(subject: Subject) -> dict[str, Any]:
    if subject.tag == "inertial":
        return {"inertial": "**", "parent": {"body": f"body_of_{subject.called}"}}
    return {subject.tag: subject.called}


def add(recipe: dict[str, Any], value: str) -> list[Subject]:
    recipe["add"] = [{"to": "world", **dict([element(each, each.numbers(value))])} for each in SUBJECTS]
    return SUBJECTS


def set_whole(recipe: dict[str, Any], value: str) -> list[Subject]:
    recipe["base"] = "./bare.xml"
    recipe["edit"] = [{"select": _select(each), "set": {each.name: each.numbers(value)}} for each in SELECTABLE]
    return SELECTABLE


def set_of_a_part(recipe: dict[str, Any], value: str) -> list[Subject]:
    set_whole(recipe, value)
    recipe["attach"] = {"p": {"model": recipe.pop("base"), "prefix": "", "edit": recipe.pop("edit")}}
    return SELECTABLE


def _one_number(subject: Subject) -> str:
    return subject.name if subject.place is None else f"{subject.name}[{subject.place}]"


def set_one_number(recipe: dict[str, Any], value: str) -> list[Subject]:
    recipe["base"] = "./other.xml"
    recipe["edit"] = [{"select": _select(each), "set": {_one_number(each): value}} for each in SELECTABLE]
    return SELECTABLE


def move(recipe: dict[str, Any], value: str) -> list[Subject]:
    recipe["base"] = "./other.xml"
    recipe["edit"] = [
        {"select": _select(each), "move": {"to": "world", each.name: each.numbers(value)}} for each in MOVABLE
    ]
    return MOVABLE


def classes(recipe: dict[str, Any], value: str) -> list[Subject]:
    recipe["base"] = "./bare.xml"
    recipe["default"] = {each.called: {each.tag: {each.name: each.numbers(value)}} for each in OF_CLASSES}
    recipe["edit"] = [{"select": _select(each), "set": {"class": each.called}} for each in OF_CLASSES]
    return OF_CLASSES


def variant(recipe: dict[str, Any], value: str) -> list[Subject]:
    piece: dict[str, Any] = {}
    add(piece, value)
    recipe["variants"] = {"size": {"large": piece, "small": {}}}
    return SUBJECTS


def condition(recipe: dict[str, Any], value: str) -> list[Subject]:
    """Set angles of elements that `where` selects by their angles."""
    recipe["base"] = "./other.xml"
    chosen = [each for each in SELECTABLE if each.tag == "joint" and each.place is None]
    held = value.removeprefix("${").removesuffix("}")
    recipe["edit"] = [
        {"select": {**_select(each), "where": f"${{{each.name} < {held}}}"}, "set": {each.name: value}}
        for each in chosen
    ]
    return chosen


PLACES: dict[str, Place] = {
    "add": add,
    "set": set_whole,
    "set of a part": set_of_a_part,
    "one number": set_one_number,
    "move": move,
    "class": classes,
    "variant": variant,
    "where": condition,
}
OTHER = 0.125
FROM_BARE = ("set", "set of a part", "class")
VALUES: Mapping[str, tuple[Any, Any]] = {
    "deg": ("20deg", math.radians(20)),
    "rad": ("0.35rad", 0.35),
    "none": (0.3, None),
}
ANGLES = {"none": None, "degree": "degree", "radian": "radian"}
FORMS = (
    "${t}",
    "${-(-t)}",
    "${t * 2 - t}",
    "${[0, t][1]}",
    "${max(t, t / 2)}",
    "${t if t > 0 else 0}",
    "${clamp(t, 0, 2 * t)}",
)


def compiled(folder: Path, recipe: dict[str, Any], **given: str) -> tuple[mujoco.MjModel | None, list[str]]:
    """Return the model of a recipe as MuJoCo compiles it, and the codes of the errors; `sample` is one of the draws."""
    sample = int(given.pop("sample", "0"))
    cell = given.pop("cell", None)
    (folder / "r.yaml").write_text(yaml.safe_dump(recipe, sort_keys=False))
    context = Context(environment={}, folder=folder)
    nodes = nodes_of(given, context)
    if cell is not None and (matrix := read_matrix(folder / "r.yaml", context)) is not None:
        nodes = matrix.cells[int(cell)].given
    plan = make_plan(folder / "r.yaml", context, nodes, sample=sample)
    composed = None if plan is None else Composer(context, measure_with(context)).compose(plan)
    errors = [each.code for each in context.sink.errors]
    if composed is None:
        return None, errors
    return mujoco.MjModel.from_xml_string(as_it_is(composed.model.root).decode()), errors


def recipe_of(angle: str | None, declared: Any) -> dict[str, Any]:
    recipe: dict[str, Any] = {"recipe": 1, "name": "r", "allow": ["license-missing"], "params": {"t": declared}}
    return recipe if angle is None else {**recipe, "angle": angle}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "bare.xml").write_text(world([], Meant(0, 0), None, "degree"))
    (tmp_path / "other.xml").write_text(world([], Meant(0, 0), OTHER))
    return tmp_path


CASES = [*itertools.product(PLACES, VALUES, ANGLES)]


@pytest.mark.parametrize(("place", "unit", "angle"), CASES, ids=map("-".join, CASES))
def test_each_angle_in_each_place(place: str, unit: str, angle: str, folder: Path) -> None:
    value, radians = VALUES[unit]
    form = FORMS[CASES.index((place, unit, angle)) % len(FORMS)]
    recipe = recipe_of(ANGLES[angle], value)
    chosen = PLACES[place](recipe, form)
    found, errors = compiled(folder, recipe)
    if radians is None and angle == "none":
        assert found is None
        assert set(errors) <= {"bare-angle", "expression"}, errors
        return
    if radians is None and place == "where":  # an angle beside a plain number
        assert set(errors) == {"expression"}
        return
    assert found is not None, errors
    others = None if place in FROM_BARE else OTHER
    meant = Meant.bare(value, angle) if radians is None else Meant.of(radians)
    expected = world(chosen, meant, others)
    assert_same(found, mujoco.MjModel.from_xml_string(expected))


def given_by_default(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"t": value}
    return {}


def given_to_the_build(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"t": {"default": 0.125, "unit": "rad"}} if isinstance(value, str) else {"t": 1}
    return {"t": str(value)}


def given_by_a_variant(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"t": "0.125rad" if isinstance(value, str) else 1}
    recipe["variants"] = {"size": {"small": {}, "large": {"params": {"t": value}}}}
    return {"size": "large"}


def given_in_a_list(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"v": [0, value]}
    for entry in recipe["add"]:
        entry.update(yaml.safe_load(yaml.safe_dump(entry).replace("${t}", "${v[1]}")))
    return {}


def drawn(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"t": "0.125rad" if isinstance(value, str) else 1}
    recipe["randomize"] = {"seed": 1, "samples": 2, "fields": {"f": {"param": "t", "uniform": [value, value]}}}
    return {"sample": "1"}


def given_by_a_cell(recipe: dict[str, Any], value: Any) -> dict[str, str]:
    recipe["params"] = {"t": "0.125rad" if isinstance(value, str) else 1}
    recipe["matrix"] = {"axes": {"t": [value, 0]}}
    return {"cell": "0"}


GIVEN = {
    "cell": given_by_a_cell,
    "default": given_by_default,
    "set": given_to_the_build,
    "variant": given_by_a_variant,
    "list": given_in_a_list,
    "draw": drawn,
}


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("unit", VALUES)
@pytest.mark.parametrize("way", GIVEN)
def test_each_way_to_give_a_parameter(way: str, unit: str, angle: str, folder: Path) -> None:
    value, radians = VALUES[unit]
    recipe = recipe_of(angle, value)
    add(recipe, "${t}")
    given = GIVEN[way](recipe, value)
    found, errors = compiled(folder, recipe, **given)
    assert found is not None, errors
    meant = Meant.bare(value, angle) if radians is None else Meant.of(radians)
    assert_same(found, mujoco.MjModel.from_xml_string(world(SUBJECTS, meant, None)))


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("inner", ["degree", "radian"])
@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_a_nested_recipe_takes_an_angle(unit: str, inner: str, angle: str, folder: Path) -> None:
    value, radians = VALUES[unit]
    nested = recipe_of(inner, {"default": 1, "unit": "deg"})
    add(nested, "${t}")
    (folder / "inner.yaml").write_text(yaml.safe_dump(nested))
    recipe = recipe_of(angle, value)
    recipe["attach"] = {"p": {"model": "./inner.yaml", "prefix": "", "with": {"t": "${2 * t - t}"}}}
    found, errors = compiled(folder, recipe)
    assert found is not None, errors
    assert_same(found, mujoco.MjModel.from_xml_string(world(SUBJECTS, Meant.of(radians), None)))


@pytest.mark.parametrize("angle", [None, "degree", "radian"])
@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_draws_of_attributes(unit: str, angle: str | None, folder: Path) -> None:
    value, radians = VALUES[unit]
    recipe = recipe_of(angle, 1)
    recipe["base"] = "./other.xml"
    fields = [*enumerate(SELECTABLE)]
    recipe["randomize"] = {
        "seed": 1,
        "samples": 1,
        "fields": {
            f"f{n}": {
                "select": _select(each),
                "attr": _one_number(each),
                "choice" if n % 2 else "uniform": [value, value],
            }
            for n, each in fields
        },
    }
    found, errors = compiled(folder, recipe, sample="1")
    assert found is not None, errors
    assert_same(found, mujoco.MjModel.from_xml_string(world(SELECTABLE, Meant.of(radians), OTHER)))


SERVO = """<mujoco model="servo"><compiler angle="{}"/><worldbody><body name="link"><joint name="a" axis="0 1 0" {}/>
<geom size=".1"/></body></worldbody><actuator><position name="m" joint="a" kp="1" ctrlrange="-9 9"/></actuator></mujoco>"""
OTHERS: Mapping[str, tuple[str, Callable[[Any], Any]]] = {
    "control": (
        "actuator: {n: {type: position, joint: a, kp: 1, ctrlrange: [M, T]}}",
        lambda m: m.actuator_ctrlrange[1],
    ),
    "set of a control": (
        "edit: [{select: {actuator: m}, set: {ctrlrange: [M, T]}}]",
        lambda m: m.actuator_ctrlrange[0],
    ),
    "one number of a control": (
        "edit: [{select: {actuator: m}, set: {'ctrlrange[0]': M, 'ctrlrange[1]': T}}]",
        lambda m: m.actuator_ctrlrange[0],
    ),
    "convert": (
        "edit: [{select: {actuator: m}, convert: {to: general, ctrlrange: [M, T]}}]",
        lambda m: m.actuator_ctrlrange[0],
    ),
    "key": ("keyframe: {k: {qpos: {a: T}, qvel: {a: M}}}", lambda m: (-m.key_qpos[0, 0], m.key_qpos[0, 0])),
    "key's control": ("keyframe: {k: {ctrl: {m: T}}}", lambda m: (-m.key_ctrl[0, 0], m.key_ctrl[0, 0])),
    "condition on a part": (
        "attach: {p: {model: ./servo.xml, edit: [{select: {actuator: m, where: {ctrlrange: [-9, 9]}}, set: {ctrlrange: [M, T]}}]}}",
        lambda m: m.actuator_ctrlrange[1],
    ),
    "place": ("attach: {p: {model: ./servo.xml, axisangle: [0, 0, 1, T]}}", lambda m: _turn(m.body_quat[-1])),
    "copies": (
        "attach: {p: {model: ./servo.xml, replicate: [{count: 2, euler: [0, 0, T], offset: [1, 0, 0]}]}}",
        lambda m: _turn(m.body_quat[-1]),
    ),
    "offset": (
        "edit: [{select: {joint: a}, set: {ref: T}}]\nrandomize: {seed: 1, samples: 1, fields: {f: {select: {joint: a}, attr: ref, offset: {uniform: [0deg, 0deg]}}}}",
        lambda m: (-m.qpos0[0], m.qpos0[0]),
    ),
    "check": (
        "edit: [{select: {joint: a}, set: {ref: T}}]\ncheck: {c: {expect: {select: {joint: a}, attr: ref, equals: T}}}",
        lambda m: (-m.qpos0[0], m.qpos0[0]),
    ),
}


def _turn(quat: Any) -> tuple[float, float]:
    angle = 2 * math.atan2(quat[3], quat[0])
    return -angle, angle


@pytest.mark.parametrize("angle", ["", "angle: degree\n", "angle: radian\n"], ids=["none", "degree", "radian"])
@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("place", OTHERS)
def test_places_that_mean_angles_of_a_joint(place: str, unit: str, angle: str, folder: Path) -> None:
    value, radians = VALUES[unit]
    text, measured = OTHERS[place]
    text = text.replace("M,", '"${-t}",').replace("M}", '"${-t}"}').replace("T", '"${t}"')
    (folder / "servo.xml").write_text(SERVO.format("degree" if unit == "rad" else "radian", ""))
    written = f"recipe: 1\nallow: [license-missing]\n{angle}base: ./servo.xml\nparams: {{t: {value}}}\n{text}\n"
    found, errors = compiled(folder, yaml.safe_load(written), **({"sample": "1"} if place == "offset" else {}))
    assert found is not None, errors
    np.testing.assert_allclose(measured(found), (-radians, radians), atol=1e-12)


CABLE = "add: [{to: link, site: {name: x}}, {to: world, site: {name: y, pos: [0, 0, 1]}}]\ntendon: {cable: {type: spatial, path: [{site: x}, {site: y}]}}\n"
WITHOUT_ANGLES = {
    "pos": "add: [{to: link, site: {name: s, pos: [T, 0, 0]}}]",
    "time step": "option: {timestep: T}",
    "damping": "edit: [{select: {joint: a}, set: {damping: T}}]",
    "one number": "edit: [{select: {geom: '**'}, set: {'size[0]': T}}]",
    "range of a slide": "edit: [{select: {joint: a}, set: {type: slide, range: [0, T]}}]",
    "range of an added slide": "add: [{to: link, joint: {name: b, type: slide, range: [0, T]}}]",
    "range of a class": "default: {c: {joint: {type: slide, range: [0, T]}}}\nadd: [{to: link, joint: {name: b, class: c}}]",
    "place": "attach: {p: {model: ./servo.xml, pos: [T, 0, 0]}}",
    "axis": "attach: {p: {model: ./servo.xml, axisangle: [T, 0, 1, 0]}}",
    "copies": "attach: {p: {model: ./servo.xml, replicate: [{count: 2, offset: [T, 0, 0]}]}}",
    "motor": "actuator: {n: {type: motor, joint: a, ctrlrange: [0, T]}}",
    "servo of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nactuator: {n: {type: position, joint: b, ctrlrange: [0, T]}}",
    "edited servo of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nactuator: {n: {type: position, joint: b}}\nedit: [{select: {actuator: n}, set: {ctrlrange: [0, T]}}]",
    "sensor of a servo of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nactuator: {n: {type: position, joint: b}}\nsensor: {s: {type: actuatorpos, actuator: n, noise: T}}",
    "servo of a tendon": CABLE + "actuator: {n: {type: position, tendon: cable, ctrlrange: [0, T]}}",
    "control of a servo of a tendon": CABLE
    + "actuator: {n: {type: position, tendon: cable}}\nkeyframe: {k: {ctrl: {n: T}}}",
    "sensor of a tendon": CABLE + "sensor: {s: {type: tendonpos, tendon: cable, cutoff: T}}",
    "range of a tendon": CABLE + "edit: [{select: {tendon: cable}, set: {range: [0, T]}}]",
    "equality of slides": "add: [{to: link, joint: {name: b, type: slide}}]\nequality: {e: {type: joint, joint1: b, polycoef: [T, 0, 0, 0, 0]}}",
    "sensor of a force": "sensor: {s: {type: force, site: x, cutoff: T}}\nadd: [{to: link, site: {name: x}}]",
    "sensor of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nsensor: {s: {type: jointpos, joint: b, cutoff: T}}",
    "key of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nkeyframe: {k: {qpos: {b: T}}}",
    "velocity of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nkeyframe: {k: {qvel: {b: T}}}",
    "control of a motor": "actuator: {n: {type: motor, joint: a}}\nkeyframe: {k: {ctrl: {n: T}}}",
    "force of a general": "actuator: {n: {type: general, joint: a}}\nkeyframe: {k: {ctrl: {n: T}}}",
    "move": "edit: [{select: {geom: '**'}, move: {to: link, pos: [T, 0, 0]}}]",
    "convert": "edit: [{select: {actuator: m}, convert: {to: position, kp: T}}]",
    "config": "extension: {plugin: [{plugin: mujoco.pid, instance: {name: p, config: {kp: T}}}]}",
    "mass": "edit: [{select: {body: link}, set: {mass: T}}]",
    "draw for a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nrandomize: {seed: 1, samples: 1, fields: {f: {select: {joint: b}, attr: ref, uniform: [10deg, 20deg]}}}",
    "choice for a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nrandomize: {seed: 1, samples: 1, fields: {f: {select: {joint: b}, attr: range, choice: [[0, 20deg]]}}}",
    "draw for a servo of a slide": "add: [{to: link, joint: {name: b, type: slide}}]\nactuator: {n: {type: position, joint: b, ctrlrange: [0, 1]}}\nrandomize: {seed: 1, samples: 1, fields: {f: {select: {actuator: n}, attr: 'ctrlrange[1]', offset: {uniform: [10deg, 20deg]}}}}",
    "joint of a part": "attach: {p: {model: ./servo.xml, joint: {type: slide, range: [0, T]}}}",
    "draw": "randomize: {seed: 1, samples: 1, fields: {f: {select: {joint: a}, attr: damping, uniform: [10deg, 20deg]}}}",
}


@pytest.mark.parametrize("value", ["30deg", "'${t}'", "'${t - 0.5rad}'"])
@pytest.mark.parametrize("place", WITHOUT_ANGLES)
def test_an_angle_where_none_can_be(place: str, value: str, folder: Path) -> None:
    (folder / "servo.xml").write_text(SERVO.format("radian", ""))
    text = WITHOUT_ANGLES[place].replace("T", value)
    written = f"recipe: 1\nallow: [license-missing]\nbase: ./servo.xml\nparams: {{t: 30deg}}\n{text}\n"
    found, errors = compiled(folder, yaml.safe_load(written))
    assert found is None
    assert set(errors) == {"wrong-type"}
