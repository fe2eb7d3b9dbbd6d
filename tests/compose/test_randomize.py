"""Draws in a model: what becomes of the attributes, and what a draw depends on."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from mjcompose.bundle.manifest import from_json
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.expression import Angle

MODEL = """\
<mujoco>
  <compiler angle="radian"/>
  <default><joint damping="2"/></default>
  <worldbody>
    <camera name="top" pos="0 0 1" euler="0 0.5 0"/>
    <body name="a">
      <joint name="a" range="-1 1"/>
      <geom name="a" size="0.1" mass="1"/>
      <geom size="0.1" mass="0"/>
      <geom size="0.2" mass="0"/>
    </body>
    <body name="b" pos="1 0 0">
      <joint name="b" type="slide" range="-1 1"/>
      <geom name="b" size="0.1" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""
FRICTION = 'friction: {select: {geom: "{a,b}"}, attr: "friction[0]", uniform: [0.5, 1]}'

Make = Callable[..., Built]


@pytest.fixture
def make(tmp_path: Path) -> Make:
    return maker(tmp_path)


def maker(folder: Path) -> Make:
    def make(
        *fields: str, sample: int = 1, seed: int = 7, samples: int = 4, top: str = "", model: str = MODEL
    ) -> Built:
        (folder / "model.xml").write_text(model)
        lines = "".join(f"    {field}\n" for field in fields)
        text = (
            f"recipe: 1\nbase: ./model.xml\n{top}randomize:\n  seed: {seed}\n  samples: {samples}\n  fields:\n{lines}"
        )
        (folder / "r.yaml").write_text(text)
        context = Context(folder=folder, environment={})
        built = build(ModelRequest(folder / "r.yaml", verified=False, sample=sample), context)
        assert built is not None, [each.message for each in context.sink.diagnostics]
        return built

    return make


def drawn(built: Built) -> dict[str, object]:
    return {name: value for each in built.composed.drawn for name, value in each.columns()}


def written(built: Built, tag: str, name: str) -> dict[str, str]:
    root = ElementTree.fromstring(built.bundle.files["model.xml"])
    (found,) = [
        each.attrib
        for section in root
        if section.tag != "default"
        for each in section.iter(tag)
        if each.get("name") == name
    ]
    return found


def numbers(text: str) -> list[float]:
    return [float(each) for each in text.split()]


# -- what becomes of the attributes -------------------------------------------------------------------------------


def test_sample_0_is_the_nominal_model(make: Make) -> None:
    nominal = make(FRICTION, sample=0)
    assert nominal.composed.drawn == ()
    assert "friction" not in written(nominal, "geom", "a")
    manifest = from_json(nominal.bundle.files["manifest.json"])
    assert (manifest.sample, manifest.seed, manifest.draws) == (0, 7, ())


def test_the_draw_is_the_value(make: Make) -> None:
    built = make(FRICTION)
    value = drawn(built)["friction[a]"]
    assert numbers(written(built, "geom", "a")["friction"])[0] == value


def test_the_draw_is_a_factor_of_what_a_class_gives(make: Make) -> None:
    built = make('d: {select: {joint: "**"}, attr: damping, scale: {uniform: [0.5, 1]}}')
    factor = drawn(built)["d[a]"]
    assert isinstance(factor, float)
    assert numbers(written(built, "joint", "a")["damping"]) == [2 * factor]


def test_vectors_are_drawn_by_component(make: Make) -> None:
    built = make("c: {select: {camera: top}, attr: pos, offset: {uniform: [[0, 0, 1], [0, 1, 2]]}}")
    x, y, z = (drawn(built)[f"c[top][{n}]"] for n in range(3))
    assert x == 0 and 0 < float(str(y)) < 1 < float(str(z)) < 2
    assert numbers(written(built, "camera", "top")["pos"]) == [x, y, 1 + float(str(z))]


def test_angles_are_in_radians_where_they_are_told(make: Make) -> None:
    """The slide beside the hinge has no angles."""
    field = 'r: {select: {joint: "**"}, attr: "range[1]", uniform: [10, 20]}'
    built = make(field, top="angle: degree\n")
    hinge = drawn(built)["r[a]"]
    slide = drawn(built)["r[b]"]
    assert isinstance(hinge, float) and isinstance(slide, float)
    assert 0.17 < hinge < 0.35 and 10 < slide < 20
    assert numbers(written(built, "joint", "a")["range"])[1] == pytest.approx(hinge, rel=1e-15)
    assert numbers(written(built, "joint", "b")["range"])[1] == slide


def test_a_unit_behind_the_numbers(make: Make) -> None:
    built = make("e: {select: {camera: top}, attr: euler, offset: {uniform: [10deg, 20deg]}}")
    value = drawn(built)["e[top][1]"]
    assert isinstance(value, float) and 0.17 < value < 0.35
    assert numbers(written(built, "camera", "top")["euler"])[1] == pytest.approx(0.5 + value, rel=1e-15)


def test_the_mass_of_a_body(make: Make) -> None:
    built = make("m: {select: {body: a}, attr: mass, scale: {loguniform: [0.5, 2]}}")
    assert numbers(written(built, "geom", "a")["mass"]) == [drawn(built)["m[a]"]]


def test_choices(make: Make) -> None:
    fields = (
        "shape: {select: {geom: b}, attr: type, choice: [sphere, box]}",
        "paint: {select: {geom: b}, attr: rgba, choice: [[1, 0, 0, 1], [0, 1, 0, 1]]}",
        "dims: {select: {geom: b}, attr: condim, choice: [1, 4, 6]}",
        "group: {select: {geom: b}, attr: group, integers: [1, 3]}",
    )
    seen: set[tuple[str, ...]] = set()
    for sample in range(1, 12):
        model = MODEL.replace('name="b" size="0.1"', 'name="b" size="0.1 0.1 0.1"')
        found = written(make(*fields, sample=sample, samples=12, model=model), "geom", "b")
        seen.add((found["type"], found["rgba"], found["condim"], found["group"]))
    for place, wanted in enumerate(({"sphere", "box"}, {"1 0 0 1", "0 1 0 1"}, {"1", "4", "6"}, {"1", "2", "3"})):
        assert {each[place] for each in seen} == wanted


def test_one_draw_for_all(make: Make) -> None:
    built = make(FRICTION.replace("uniform", "per: sample, uniform"))
    assert list(drawn(built)) == ["friction"]
    assert written(built, "geom", "a")["friction"] == written(built, "geom", "b")["friction"]


def test_fields_are_done_in_order(make: Make) -> None:
    built = make(
        FRICTION, FRICTION.replace("friction:", "again:").replace("uniform: [0.5, 1]", "scale: {uniform: [2, 3]}")
    )
    found = drawn(built)
    product = float(str(found["friction[a]"])) * float(str(found["again[a]"]))
    assert numbers(written(built, "geom", "a")["friction"])[0] == product


def test_a_parameter(make: Make) -> None:
    top = "params: {size: {default: 1, max: 3}, tilt: 30deg, home: [0, 1]}\nadd: [{to: world, site: {name: s, pos: ['${size}', '${home[1]}', 0], euler: [0, 0, '${tilt}']}}]\n"
    built = make(
        "size: {param: size, scale: {uniform: [2, 3]}}",
        "home: {param: home, uniform: [5, 6]}",
        "turn: {param: tilt, offset: {uniform: [1rad, 2rad]}}",
        top=top,
    )
    found = drawn(built)
    site = written(built, "site", "s")
    assert numbers(site["pos"])[:2] == [found["size"], found["home[1]"]]
    assert isinstance(tilt := built.plan.scope["tilt"], Angle)
    assert tilt.radians == pytest.approx(math.radians(30) + float(str(found["turn"])))
    draws = from_json(built.bundle.files["manifest.json"]).draws
    assert [(each.field, each.element, each.attribute, each.operation) for each in draws] == [
        ("size", None, "size", "scale"),
        ("home", None, "home", "set"),
        ("turn", None, "tilt", "offset"),
    ]


def test_bounds_with_expressions_see_what_was_drawn(make: Make) -> None:
    top = "params: {size: 1}\n"
    size = "size: {param: size, uniform: [2, 3]}"
    built = make(size, FRICTION.replace("[0.5, 1]", '["${size}", "${size}"]'), top=top)
    assert drawn(built)["friction[a]"] == drawn(built)["size"]


def test_a_variant(make: Make) -> None:
    top = "variants: {light: {none: {}, lamp: {add: [{to: world, light: {name: l}}]}}}\n"
    names = {
        len(
            make(
                "light: {param: light, choice: [none, lamp]}", top=top, sample=n, samples=9
            ).composed.model.root.findall(".//light")
        )
        for n in range(1, 9)
    }
    assert names == {0, 1}


def test_keys_follow(make: Make) -> None:
    model = MODEL.replace("</mujoco>", "<keyframe><key name='k' qpos='0.5 0.25'/></keyframe></mujoco>")
    model = model.replace('<joint name="b" type="slide" range="-1 1"/>', '<freejoint name="b"/>').replace(
        "0.5 0.25", "0.5 1 0 0 1 0 0 0"
    )
    built = make("p: {select: {key: k}, attr: 'qpos[0]', offset: {uniform: [1, 2]}}", model=model)
    assert numbers(written(built, "key", "k")["qpos"])[0] == 0.5 + float(str(drawn(built)["p[k]"]))


# -- what a draw depends on -----------------------------------------------------------------------------------------


def test_another_seed_and_another_sample_are_other_draws(make: Make) -> None:
    found = {str(drawn(make(FRICTION, sample=sample, seed=seed))) for sample in (1, 2) for seed in (7, 8)}
    assert len(found) == 4


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    before=st.lists(st.sampled_from("uvw"), unique=True),
    after=st.lists(st.sampled_from("xyz"), unique=True),
    elements=st.integers(0, 3),
    samples=st.integers(2, 9),
    sample=st.integers(1, 2),
)
def test_what_is_added_moves_no_draw(
    tmp_path: Path, before: list[str], after: list[str], elements: int, samples: int, sample: int
) -> None:
    make = maker(tmp_path)
    alone = drawn(make(FRICTION, sample=sample))
    added = "".join(f'<body><geom name="new{n}" size="0.1"/><geom size="1"/></body>' for n in range(elements))
    model = MODEL.replace("<worldbody>", f"<worldbody>{added}")
    others = (
        [FRICTION.replace("friction:", f"{name}:") for name in before],
        [FRICTION.replace("friction:", f"{name}:") for name in after],
    )
    wide = FRICTION.replace('"{a,b}"', '"{a,b,new*}"')
    found = drawn(make(*others[0], wide, *others[1], model=model, samples=samples, sample=sample))
    assert {name: found[name] for name in alone} == alone
    assert sum(name.startswith("friction[") for name in found) == 2 + elements


def test_without_a_name_it_is_its_place_in_its_body(make: Make) -> None:
    every = 'f: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.5, 1]}'
    alone = drawn(make(every))
    assert list(alone) == ["f[a]", "f[a geom#0]", "f[a geom#1]", "f[b]"]
    named = MODEL.replace('<geom name="a"', '<geom name="c" size="0.1"/><geom name="a"')
    found = drawn(make(every, model=named))
    assert {name: found[name] for name in alone} == alone


def test_an_edit_that_renames_comes_first(make: Make) -> None:
    built = make(FRICTION.replace("{a,b}", "new"), top="edit: [{select: {geom: a}, rename: new}]\n")
    assert list(drawn(built)) == ["friction[new]"]
