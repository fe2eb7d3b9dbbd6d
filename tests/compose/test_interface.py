"""`interface`: the built model numbers its elements as the recipe says, and moves and starts as before."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from lxml import etree
from mjcompose.base.diagnostic import Span
from mjcompose.mujoco.addresses import VECTORS, span
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.node import Scalar

Build = Callable[..., mujoco.MjModel | str]
OF = {"joint": "njnt", "sensor": "nsensor", "key": "nkey"}


@pytest.fixture
def made(tmp_path: Path) -> Build:
    """The compiled model of a recipe, or its errors as `LINE:COLUMN CODE MESSAGE`."""

    def made(recipe: dict[str, Any] | str, **given: Any) -> mujoco.MjModel | str:
        path = tmp_path / "recipe.yaml"
        path.write_text(recipe if isinstance(recipe, str) else json.dumps(recipe), encoding="utf-8")
        context = Context(environment={}, folder=tmp_path)
        result = build(ModelRequest(path, **given), context)
        if result is None:
            found = [each for each in context.sink.sorted() if each.severity == "error"]
            return "\n".join(
                f"{each.span and each.span.line}:{each.span and each.span.column} {each.code} {each.message}"
                for each in found
            )
        files = result.bundle.files
        return mujoco.MjModel.from_xml_string(files["model.xml"].decode(), {**files})

    return made


def names(model: mujoco.MjModel, kind: str) -> list[str]:
    count = len(model.actuator_trntype) if kind == "actuator" else getattr(model, OF[kind])
    return [getattr(model, kind)(each).name for each in range(count)]


def numbers(model: mujoco.MjModel, vector: str, row: Any) -> dict[str, list[float]]:
    """The numbers of a vector by the names of their owners."""
    kind = VECTORS[vector][0]
    return {
        name: [float(row[at]) for at in span(model, vector, index)] for index, name in enumerate(names(model, kind))
    }


def goals(model: mujoco.MjModel, row: Any) -> dict[str, list[float]]:
    """The positions of mocap bodies by their names."""
    bodies = {model.body(at).name: int(model.body_mocapid[at]) for at in range(model.nbody)}
    return {name: row.reshape(-1, 3)[at].tolist() for name, at in bodies.items() if at >= 0}


def as_keys(model: mujoco.MjModel) -> dict[str, Any]:
    rows = ("qpos", "qvel", "ctrl", "act")
    return {
        name: {row: numbers(model, row, getattr(model, f"key_{row}")[at]) for row in rows}
        | {"time": float(model.key_time[at]), "mpos": goals(model, model.key_mpos[at])}
        for at, name in enumerate(names(model, "key"))
    }


def run(model: mujoco.MjModel, key: str, like: mujoco.MjModel, steps: int = 20) -> dict[str, dict[str, list[float]]]:
    """The state after some steps from a key, with controls that the actuators of `like` get by name."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    pushed = dict(zip(names(like, "actuator"), np.sin(np.arange(like.nu)), strict=False))
    for index, name in enumerate(names(model, "actuator")):
        data.ctrl[list(span(model, "ctrl", index))] = pushed[name]
    mujoco.mj_step(model, data, steps)
    return {vector: numbers(model, vector, getattr(data, vector)) for vector in ("qpos", "qvel", "act", "sensordata")}


def same(one: mujoco.MjModel, other: mujoco.MjModel, rounding: float = 1e-9) -> None:
    assert as_keys(one) == as_keys(other)
    for key in names(one, "key"):
        left = run(one, key, one)
        right = run(other, key, one)
        for vector, found in left.items():
            assert found.keys() == right[vector].keys()
            for name, row in found.items():
                np.testing.assert_allclose(right[vector][name], row, rtol=rounding, atol=rounding, err_msg=name)


def random_model(seed: int) -> str:
    """A tree of bodies with joints of all types, actuators with and without activation, sensors and two keys."""
    draw = random.Random(seed)
    root = etree.fromstring('<mujoco model="m"><option integrator="Euler"/><worldbody/></mujoco>')
    joints: list[tuple[str, str]] = []
    count = 0

    def body(parent: Any, depth: int) -> None:
        nonlocal count
        count += 1
        name = f"b{count}"
        if draw.random() < 0.2:
            parent = etree.SubElement(parent, "frame", pos="0 0.1 0")
        made = etree.SubElement(parent, "body", name=name, pos=f"{draw.random():.2f} 0.3 {count % 5}")
        kinds = draw.choice(
            [
                ["free" if depth == 0 else "ball"],
                ["hinge"],
                ["slide"] * draw.randint(1, 3),
                draw.choices(["hinge", "slide"], k=draw.randint(depth == 0, 3)),
            ]
        )
        for number, kind in enumerate(kinds):
            etree.SubElement(
                made,
                "joint",
                name=f"{name}{'xyz'[number]}",
                type=kind,
                damping="0.1",
                axis="1 0 0" if kind == "free" else f"{number} 1 {draw.random():.2f}",
            )
            joints.append((f"{name}{'xyz'[number]}", kind))
        etree.SubElement(made, "geom", size=".1", contype="0", conaffinity="0", pos=".1 0 0")
        etree.SubElement(made, "site", name=f"s{count}")
        for _ in range(draw.randint(0, 2) if depth < 3 else 0):
            body(made, depth + 1)

    world = root.find("worldbody")
    for at in range(3):
        goal = etree.SubElement(world, "body", name=f"goal{at}", mocap="true", pos=f"{at} 5 0")
        etree.SubElement(goal, "geom", size=".1", contype="0", conaffinity="0")
        if at == 1:
            body(goal, 1)
        body(world, 0)
    actuator = etree.SubElement(root, "actuator")
    sensor = etree.SubElement(root, "sensor")
    for at, (joint, kind) in enumerate(joints):
        if kind in ("hinge", "slide"):
            extra: dict[str, str] = {"kp": "3"}
            tag = draw.choice(["position", "intvelocity", "motor"])
            if tag == "intvelocity":
                extra["actrange"] = "-1 1"
            etree.SubElement(actuator, tag, name=f"a{at}", joint=joint, **({} if tag == "motor" else extra))
            etree.SubElement(sensor, "actuatorfrc", name=f"f{at}", actuator=f"a{at}")
            etree.SubElement(sensor, "jointpos", name=f"p{at}", joint=joint)
    for at in range(1, count + 1):
        etree.SubElement(sensor, "framepos", name=f"w{at}", objtype="site", objname=f"s{at}")
    model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
    keyframe = etree.SubElement(root, "keyframe")
    for name in ("home", "away", "last"):
        rows = {
            row: [round(draw.uniform(-1, 1), 3) for _ in range(getattr(model, size))]
            for row, size in (("qpos", "nq"), ("qvel", "nv"), ("ctrl", "nu"), ("act", "na"))
        }
        rows["mpos"] = [round(draw.uniform(-1, 1), 3) for _ in range(3 * model.nmocap)]
        etree.SubElement(
            keyframe,
            "key",
            name=name,
            time=str(draw.randint(0, 3)),
            **{row: " ".join(map(str, each)) for row, each in rows.items() if each},
        )
    return etree.tostring(root, pretty_print=True).decode()


def another_joint_order(text: str, draw: random.Random) -> list[str]:
    """The joints after the bodies next to each other, and slides on one body, change places at random."""

    def of(body: Any) -> Iterator[str]:
        own = [(each.get("name"), each.get("type")) for each in body.iterchildren("joint")]
        if all(kind == "slide" for _, kind in own):
            draw.shuffle(own)
        yield from (name for name, _ in own)
        inner = [
            each if each.tag == "body" else next(each.iterchildren("body"))
            for each in body.iterchildren("body", "frame")
        ]
        draw.shuffle(inner)
        for each in inner:
            yield from of(each)

    return list(of(etree.fromstring(text).find("worldbody")))


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(6, 150))])
def test_shuffled_models_move_as_before(made: Build, tmp_path: Path, seed: int) -> None:
    text = random_model(seed)
    draw = random.Random(seed)
    (tmp_path / "m.xml").write_text(text)
    before = mujoco.MjModel.from_xml_string(text)
    interface = {
        kind: draw.sample(listed := names(before, kind), len(listed)) for kind in ("actuator", "sensor", "key")
    }
    interface["joint"] = another_joint_order(text, draw)
    after = made({"recipe": 1, "base": "./m.xml", "interface": interface})
    assert not isinstance(after, str), after
    assert {kind: names(after, kind) for kind in interface} == interface
    same(before, after)
    some = {kind: [*listed[: draw.randint(0, len(listed))], "…"] for kind, listed in interface.items()}
    partly = made({"recipe": 1, "base": "./m.xml", "interface": some})
    if isinstance(partly, str):  # joints that are not listed may have to come first
        assert all("interface-order the joint" in line for line in partly.splitlines())
    else:
        for kind, listed in some.items():
            assert names(partly, kind)[: len(listed) - 1] == listed[:-1]
        same(before, partly)


PAIR = """
<mujoco model="pair"><worldbody>
  <body name="a"><joint name="a"/><geom size=".1"/><site name="end"/></body>
  <body name="b" pos="1 0 0"><joint name="b" type="slide"/><joint name="c" type="slide" axis="1 0 0"/><geom size=".1"/></body>
</worldbody>
<actuator><motor name="a" joint="a"/><position name="b" joint="b" kp="20"/></actuator>
<keyframe><key name="home" qpos="1 2 3" ctrl="4 5"/></keyframe></mujoco>
"""


def test_parts_of_a_nested_recipe_and_their_keys_follow(made: Build, tmp_path: Path) -> None:
    (tmp_path / "pair.xml").write_text(PAIR)
    (tmp_path / "inner.yaml").write_text(
        "recipe: 1\nbase: ./pair.xml\ninterface: {joint: [b, c, a], actuator: [b, a], key: [home]}\n"
    )
    recipe = {
        "recipe": 1,
        "attach": {each: {"model": "./inner.yaml", "pos": [3 * at, 0, 0]} for at, each in enumerate(("l", "r"))},
        "keyframe": {"rest": {"ctrl": "hold"}},
        "interface": {
            "joint": ["r/b", "r/c", "r/a", "l/b", "l/c", "l/a"],
            "actuator": ["l/a", "r/a", "…"],
            "key": ["rest", "home"],
        },
    }
    model = made(recipe)
    assert not isinstance(model, str), model
    assert names(model, "joint") == recipe["interface"]["joint"]
    assert names(model, "actuator") == ["l/a", "r/a", "l/b", "r/b"]
    assert names(model, "key") == ["rest", "home"]
    home = as_keys(model)["home"]
    assert home["qpos"] == {
        f"{part}/{name}": [value] for part in "rl" for name, value in (("b", 2), ("c", 3), ("a", 1))
    }
    assert home["ctrl"] == {"l/a": [4], "r/a": [4], "l/b": [5], "r/b": [5]}


def test_cells_choose_names_with_when_and_variants(made: Build, tmp_path: Path) -> None:
    (tmp_path / "pair.xml").write_text(PAIR)
    recipe = """
recipe: 1
base: ./pair.xml
variants:
  tool:
    none: {}
    pusher: {actuator: {push: {type: motor, joint: c}}}
    turner: {actuator: {turn: {type: motor, joint: a}}, interface: {actuator: [turn, a, b]}}
interface: {actuator: [b, {name: push, when: {tool: pusher}}, a], joint: [b, …]}
"""
    for tool, expected in (("none", "b a"), ("pusher", "b push a"), ("turner", "turn a b")):
        model = made(recipe, given={"tool": Scalar(tool, Span("recipe.yaml", 1, 1), tool, True)})
        assert not isinstance(model, str), model
        assert names(model, "actuator") == expected.split()
        assert names(model, "joint") == ["b", "c", "a"]


def test_draws_follow_the_elements(made: Build, tmp_path: Path) -> None:
    (tmp_path / "pair.xml").write_text(PAIR)
    recipe: dict[str, Any] = {
        "recipe": 1,
        "base": "./pair.xml",
        "randomize": {
            "samples": 2,
            "seed": 1,
            "fields": {
                "kp": {"select": {"actuator": "b"}, "attr": "kp", "scale": {"uniform": [0.5, 2]}},
                "stop": {"select": {"joint": "*"}, "attr": "damping", "uniform": [1, 2]},
            },
        },
    }
    plain, ordered = (
        made(recipe | more, sample=1)
        for more in ({}, {"interface": {"actuator": ["b", "a"], "joint": ["c", "b", "a"]}})
    )
    assert not isinstance(plain, str) and not isinstance(ordered, str)
    assert names(ordered, "joint") == ["c", "b", "a"]
    for kind, array in (("actuator", "actuator_gainprm"), ("joint", "dof_damping")):
        rows = [
            {name: np.ravel(getattr(each, array)[at]).tolist() for at, name in enumerate(names(each, kind))}
            for each in (plain, ordered)
        ]
        assert rows[0] == rows[1]


REPLICATED = """
<mujoco model="many"><worldbody>
  <body name="o"><joint name="o"/><geom size=".1"/></body>
  <replicate count="2" offset="1 0 0"><body name="k"><joint name="k"/><geom size=".1"/></body></replicate>
</worldbody>
<tendon><fixed name="t"><joint joint="k" coef="1"/></fixed></tendon>
<actuator><motor name="k" joint="k"/><motor name="t" tendon="t"/><motor name="o" joint="o"/></actuator>
<sensor><jointpos name="k" joint="k"/><actuatorfrc name="m" actuator="t"/><jointpos name="o" joint="o"/></sensor>
<keyframe><key name="home" qpos="1 2 3" ctrl="1 2 3 4 5"/></keyframe></mujoco>
"""


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_copies_of_a_replicate_are_together(made: Build, tmp_path: Path) -> None:
    (tmp_path / "many.xml").write_text(REPLICATED)
    before = mujoco.MjModel.from_xml_string(REPLICATED)
    interface = {
        "joint": ["k0", "k1", "o"],
        "actuator": ["o", "t0", "k0", "t1", "k1"],
        "sensor": ["o", "m0", "k0", "m1", "k1"],
    }
    after = made({"recipe": 1, "base": "./many.xml", "interface": interface})
    assert not isinstance(after, str), after
    assert {kind: names(after, kind) for kind in interface} == interface
    same(before, after)
    wrong = made({"recipe": 1, "base": "./many.xml", "interface": {"actuator": ["k0", "…"], "joint": ["k1", "…"]}})
    assert isinstance(wrong, str) and wrong.count("interface-order") == 2


def test_an_attached_model_is_checked_after_mujoco_compiled_it(made: Build, tmp_path: Path) -> None:
    (tmp_path / "pair.xml").write_text(PAIR.replace("<keyframe>", "<!--").replace("</keyframe>", "-->"))
    (tmp_path / "m.xml").write_text(
        '<mujoco><asset><model name="p" file="pair.xml"/></asset><worldbody><body name="first"><joint name="f"/>'
        '<geom size="1"/></body><body name="at"><attach model="p" body="a" prefix="x_"/></body></worldbody>'
        '<actuator><motor name="own" joint="f"/></actuator></mujoco>'
    )
    recipe = {"recipe": 1, "base": "./m.xml", "interface": {"joint": ["x_a", "f"]}}
    model = made(recipe)
    assert not isinstance(model, str), model
    assert names(model, "joint") == ["x_a", "f"]
    recipe["interface"] = {"actuator": ["x_a", "own"]}
    assert "interface-order the actuator `x_a` cannot come before `own`" in made(recipe)
    recipe["interface"] = {"joint": ["f", "x_b"], "actuator": []}
    assert "unknown-name the joint `x_b` does not exist" in made(recipe)


ROBOTS = [
    "agility_cassie/cassie.xml",
    "aloha/aloha.xml",
    "shadow_hand/right_hand.xml",
    "unitree_g1/g1.xml",
    "unitree_go1/go1.xml",
    "stanford_tidybot/tidybot.xml",
    "universal_robots_ur5e/ur5e.xml",
    "trossen_vx300s/vx300s.xml",
    "robotiq_2f85/2f85.xml",
    "wonik_allegro/left_hand.xml",
]


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_robots_move_as_before(made: Build, corpus: Path, robot: str) -> None:
    path = corpus / "models" / robot
    draw = random.Random(robot)
    before = mujoco.MjModel.from_xml_path(str(path))
    spec = mujoco.MjSpec.from_file(str(path))

    def joints(body: Any) -> Iterator[str]:
        yield from (each.name for each in body.joints)
        for each in draw.sample(list(body.bodies), len(list(body.bodies))):
            yield from joints(each)

    interface: dict[str, list[str]] = {
        kind: draw.sample(listed := names(before, kind), len(listed)) for kind in ("actuator", "sensor", "key")
    }
    interface["joint"] = list(joints(spec.worldbody))
    interface = {kind: listed for kind, listed in interface.items() if all(listed)}
    after = made({"recipe": 1, "base": str(path), "interface": interface, "allow": ["out-of-range"]})
    assert not isinstance(after, str), after
    assert {kind: names(after, kind) for kind in interface} == interface
    if interface.keys() >= {"joint", "actuator", "key"}:
        same(before, after, 1e-6)


def test_worlds_and_samples_have_the_order(made: Build, tmp_path: Path) -> None:
    (tmp_path / "pair.xml").write_text(PAIR)
    recipe: dict[str, Any] = {
        "recipe": 1,
        "base": "./pair.xml",
        "interface": {"actuator": ["b", "a"], "joint": ["c", "b", "a"]},
        "randomize": {
            "samples": 3,
            "seed": 1,
            "fields": {
                "kp": {"select": {"actuator": "b"}, "attr": "kp", "scale": {"uniform": [0.5, 2]}},
                "damping": {"select": {"joint": "*"}, "attr": "damping", "uniform": [1, 2]},
            },
        },
    }
    path = tmp_path / "recipe.yaml"
    path.write_text(json.dumps(recipe))
    context = Context(environment={}, folder=tmp_path)
    result = build(ModelRequest(path, worlds=True), context)
    assert result is not None, context.sink.errors  # which compares the table with samples that are built
    model = mujoco.MjModel.from_xml_string(result.bundle.files["model.xml"].decode())
    assert names(model, "actuator") == ["b", "a"] and names(model, "joint") == ["c", "b", "a"]
