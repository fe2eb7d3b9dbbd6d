"""What a recipe writes in the sections of a model whose base has given its top class a name."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

Compose = Callable[..., Any]
HEAD = "recipe: 1\nbase: ./robot.xml\n"


def added(model: Any, name: str) -> dict[str, str]:
    (element,) = (each for each in model.iter("*") if each.get("name") == name)
    return dict(element.items())


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


@pytest.mark.parametrize("unit", ["degree", "radian"])
@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("written", ["bare", "deg", "rad"])
def test_angles_in_any_unit_mean_the_same(compose: Compose, unit: str, angle: str, written: str) -> None:
    """A right angle, however it is written, in a recipe and a model of any unit."""
    right = {"deg": "90deg", "rad": f"{math.pi / 2!r}rad", "bare": "90" if angle == "degree" else repr(math.pi / 2)}[
        written
    ]
    model = compose(
        f"{HEAD}angle: {angle}\nadd:\n  - to: base\n    body:\n      name: b\n      euler: [{right}, 0, 0]\n"
        f"      geom: [{{name: g, size: [1], axisangle: [0, 0, 1, {right}]}}]\n"
        f"      joint: [{{name: j, range: [0, {right}], ref: {right}}}]\n"
        f"  - {{to: base, replicate: {{count: 2, euler: [0, 0, {right}], geom: {{size: [1]}}}}}}\n",
        angle=unit,
    )
    expected = 90.0 if unit == "degree" else math.pi / 2
    assert numbers(added(model, "b")["euler"]) == pytest.approx([expected, 0, 0], abs=0, rel=1e-15)
    assert numbers(added(model, "g")["axisangle"])[3] == pytest.approx(expected, rel=1e-15)
    assert numbers(added(model, "j")["range"]) == pytest.approx([0, expected], rel=1e-15)
    assert numbers(added(model, "j")["ref"]) == pytest.approx([expected], rel=1e-15)
    assert numbers(model.find(".//replicate").get("euler"))[2] == pytest.approx(expected, rel=1e-15)


def test_only_hinges_and_balls_turn(compose: Compose) -> None:
    model = compose(
        f"{HEAD}angle: degree\ndefault: {{rail: {{joint: {{type: slide}}}}}}\nadd:\n  - to: base\n    body:\n      name: b\n"
        "      geom: [{size: [1]}]\n      joint:\n"
        "        - {name: a, type: slide, range: [0, 90], ref: 90}\n"
        "        - {name: b, class: rail, range: [0, 90]}\n"
        "        - {name: c, type: ball, range: [0, 90]}\n"
        "        - {name: d, class: rail, type: hinge, range: [0, 90]}\n"
    )
    assert added(model, "a")["range"] == "0 90" and added(model, "a")["ref"] == "90"
    joints = {each.get("name"): each.get("range") for each in model.iter("joint")}
    assert joints["b"] == "0 90"
    assert numbers(joints["c"])[1] == numbers(joints["d"])[1] == pytest.approx(math.pi / 2)


def test_units_on_numbers_that_are_no_angles_to_mjcf(compose: Compose) -> None:
    model = compose(f"{HEAD}add:\n  - {{to: base, camera: {{name: eye, fovy: 1rad}}}}\n")
    assert numbers(added(model, "eye")["fovy"]) == pytest.approx([math.degrees(1)])
    model = compose(f"{HEAD}sensor: {{s: {{type: framequat, objtype: body, objname: base, cutoff: 90deg}}}}\n")
    assert numbers(added(model, "s")["cutoff"]) == pytest.approx([math.pi / 2])


def test_bare_angles_are_told_at_the_number(compose: Compose) -> None:
    body = "add:\n  - to: base\n    body:\n      name: b\n      geom: [{size: [1]}]\n"
    assert compose(
        HEAD + "default: {c: {joint: {type: hinge}}}\n" + body + "      joint: [{class: c, range: [0, 90]}]\n"
    ) == ["9:37 bare-angle"]
    assert not isinstance(compose(HEAD + body + "      joint: [{type: slide, range: [0, 90]}]\n"), list)
    assert not isinstance(compose(HEAD + body + "      joint: [{type: hinge, range: [0, 0]}]\n"), list)


def test_the_sequence_of_the_recipe(compose: Compose) -> None:
    """A model of another sequence gets a quaternion, one of the same the angles."""
    text = f"{HEAD}angle: degree\neulerseq: zyx\nadd:\n  - {{to: base, site: {{name: s, euler: [90, 0, 0]}}}}\n"
    assert numbers(added(compose(text), "s")["quat"]) == pytest.approx([0.5**0.5, 0, 0, 0.5**0.5])
    same = '<mujoco>\n<compiler eulerseq="zyx"/>\n<worldbody><body name="base"/></worldbody>\n</mujoco>'
    assert added(compose(text.replace("robot", "same"), same__xml=same), "s")["euler"] == "90 0 0"


@pytest.mark.parametrize(
    ("fragment", "place"),
    [
        ('    xml: <geom name="x" material="m"/>\n', "5:35"),
        ('    xml: \'<geom name="x" material="m"/>\'\n', "5:36"),
        ('    xml: |\n      <body name="x">\n        <geom\n          material="m"/>\n      </body>\n', "8:21"),
        ('    xml: |\n\n      <geom material="m"/>\n', "7:23"),
        ('    xml: >\n      <geom name="x"\n      material="m"/>\n', "5:10"),
    ],
)
def test_where_a_fragment_is_wrong(compose: Compose, fragment: str, place: str) -> None:
    """At the line of the fragment; a folded one has no lines, and is told as a whole."""
    assert compose(f"{HEAD}add:\n  - to: base\n{fragment}") == [f"{place} unknown-name"]


def test_a_fragment_is_in_the_recipes_unit(compose: Compose) -> None:
    model = compose(f'{HEAD}angle: degree\nadd:\n  - to: base\n    xml: <site name="s" euler="0 90 0"/>\n')
    assert numbers(added(model, "s")["euler"])[1] == pytest.approx(math.pi / 2)


def test_files_of_the_recipe_are_found_from_its_folder(compose: Compose, tmp_path: Any) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    model = compose(HEAD + "asset:\n  mesh: {m: {file: ./a/m.obj}, n: {xml: '<mesh file=\"a/m.obj\"/>'}}\n")
    assert {each.get("file") for each in model.iter("mesh")} == {"assets/a/m.obj"}


SectionCompose = Callable[..., Any]
BASE = '<mujoco><default><geom density="5"/></default><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
RECIPE = """\
recipe: 1
base: ./own.xml
attach: {a: {model: ./robot.xml}}
asset: {texture: {sky: {type: skybox, builtin: flat, width: 8, height: 8}}, material: {m: {}}}
"""


@pytest.mark.parametrize(
    ("default", "expected"), [("", None), ("default: {main: {texture: {colorspace: sRGB}}}\n", "base/")]
)
def test_only_what_the_top_class_sets_makes_a_texture_name_it(
    compose: SectionCompose, default: str, expected: str | None
) -> None:
    """`<texture class="c"/>` is an error in MuJoCo before 3.17. A material has had a class at all times."""
    model = compose(RECIPE + default, own__xml=BASE)
    assert model.find("asset/texture").get("class") == expected
    assert model.find("asset/material").get("class") == "base/"
