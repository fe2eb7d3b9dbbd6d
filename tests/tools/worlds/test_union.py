"""`build --as union`: each world of one model with all parts behaves as the model that is built with its parts alone."""

from __future__ import annotations

import shutil
from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import worlds
from mjcompose.mujoco.attributes import NameTable
from mjcompose.tools.worlds.union import references, referring_bodies, words
from tools.worlds.studies import differing
from tools.worlds.test_join import run

RECIPES = Path(__file__).resolve().parents[3] / "recipes"
ARM = """\
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 1"/>
    <body name="arm" pos="0 0 0.6">
      <joint name="hinge" axis="0 1 0" damping="0.5" ref="0.1"/>
      <geom name="link" type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="1"/>
      <site name="flange" pos="0.4 0 0"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="hinge"/></actuator>
  <keyframe><key name="home" qpos="0.2"/></keyframe>
</mujoco>
"""
HAMMER = """\
<mujoco>
  <worldbody>
    <body name="handle">
      <joint name="swing" axis="0 1 0" damping="0.01" stiffness="2" frictionloss="0.05"/>
      <geom name="grip" type="capsule" fromto="0 0 0 0.2 0 0" size="0.02" mass="0.3"/>
      <body name="head" pos="0.2 0 0"><geom type="box" size="0.03 0.05 0.03" mass="0.8"/></body>
    </body>
  </worldbody>
  <actuator><position name="swing" joint="swing" kp="5"/></actuator>
</mujoco>
"""
HOOK = """\
<mujoco>
  <worldbody>
    <body name="hook"><geom type="sphere" size="0.04" mass="0.5"/>
      <body name="tip" pos="0 0 -0.2">
        <joint name="a" axis="1 0 0"/><joint name="b" axis="0 1 0"/><geom name="tip" size="0.03" mass="0.1"/>
      </body>
    </body>
  </worldbody>
  <sensor><jointpos name="a" joint="a"/></sensor>
</mujoco>
"""
PROP = '<mujoco><worldbody><body name="prop" pos="0.3 0.2 0.1"><freejoint name="prop"/><geom name="prop" type="{}" size="{}" mass="0.2"/></body></worldbody></mujoco>'
RECIPE = """\
recipe: 1
name: m
base: ./model.xml
params:
  prop: {default: ./box.xml, choices: [./box.xml, ./ball.xml]}
  friction: 1
attach:
  hammer: {model: ./hammer.xml, site: flange, when: {tool: hammer}}
  hook: {model: ./hook.xml, site: flange, when: {tool: hook}}
  prop: {model: "${prop}"}
edit: [{select: {geom: "prop/prop"}, set: {"friction[0]": "${friction}"}}]
variants: {tool: {hammer: {}, hook: {}, none: {}}}
"""
MATRIX = f"""{RECIPE}matrix:
  axes: {{tool: [hammer, hook], prop: [./box.xml, ./ball.xml], friction: [1, 0.3]}}
"""
DRAWN = f"""{RECIPE}randomize:
  seed: 7
  samples: 9
  fields:
    prop: {{param: prop, choice: [./box.xml, ./ball.xml]}}
    tool: {{param: tool, choice: [hammer, hook, none]}}
    mass: {{select: {{body: "prop/prop"}}, attr: mass, scale: {{uniform: [0.5, 2]}}}}
"""


def lay_out(folder: Path) -> None:
    for name, text in {
        "hammer": HAMMER,
        "hook": HOOK,
        "box": PROP.format("box", "0.05 0.04 0.03"),
        "ball": PROP.format("sphere", "0.05"),
    }.items():
        (folder / f"{name}.xml").write_text(text)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(MATRIX, id="matrix"),
        pytest.param(DRAWN, id="choice", marks=pytest.mark.slow),
        pytest.param((RECIPES / "parts_study.yaml").read_text(), id="parts_study", marks=pytest.mark.slow),
    ],
)
def both(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[worlds.Worlds, list[mjcompose.Loaded]]:
    folder = tmp_path_factory.mktemp("union")
    lay_out(folder)
    text: str = request.param
    shutil.copytree(RECIPES / "models", folder / "models")
    result = run(folder, text, "--as", "union", "--worlds", "study.npz", "-o", "out/", model=ARM)
    assert result.exit_code == 0, result.output
    found = worlds.load(folder / "out", folder / "study.npz")
    result = run(folder, text, "--all", "-o", "each/{name}/", model=ARM)
    assert result.exit_code == 0, result.output
    return found, [each.load() for each in mjcompose.load_many(folder / "each")]


def prefixes(study: worlds.Worlds) -> list[str]:
    """What names of parts begin with in the union."""
    return ["", *dict.fromkeys(part.partition("/")[0] + "/" for part in study.table.parts)]


def joints(
    study: worlds.Worlds, world: int, union: mujoco.MjModel, model: mujoco.MjModel
) -> list[tuple[int, int, int]]:
    """Of each joint of a model its address in qpos, that in the union, and how many numbers it has there."""
    found = []
    for joint in range(model.njnt):
        names = [prefix + model.joint(joint).name for prefix in prefixes(study)]
        numbers = [mujoco.mj_name2id(union, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        (number,) = [n for n in numbers if n >= 0 and union.body_mass[union.jnt_bodyid[n]] > 0]
        width = 7 if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE else 1
        found.append((int(model.jnt_qposadr[joint]), int(union.jnt_qposadr[number]), width))
    return found


def forces(model: mujoco.MjModel, data: mujoco.MjData) -> list[float]:
    """How hard each contact presses, sorted."""
    force = np.zeros(6)
    found = []
    for contact in range(data.ncon):
        mujoco.mj_contactForce(model, data, contact, force)
        found.append(float(force[0]))
    return sorted(found)


def test_worlds_behave_as_their_models(both: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    found, built = both
    assert len(found) == len(built) and len({tuple(row) for row in found.table.has}) >= 2
    touched = 0
    for world, each in enumerate(built):
        union = found.model(world)
        model = each.model
        pairs = joints(found, world, union, model)
        for each_model in (
            union,
            model,
        ):  # a solver that stops early leaves something open, in each model something else
            each_model.opt.tolerance = 0
            each_model.opt.iterations = 300
        mine = mujoco.MjData(union)
        other = mujoco.MjData(model)
        for at, here, width in pairs:
            assert np.allclose(mine.qpos[here : here + width], other.qpos[at : at + width], rtol=0, atol=1e-14)
        mine.ctrl[:] = 0.3
        other.ctrl[:] = 0.3
        for _ in range(300):
            mujoco.mj_step(union, mine)
            mujoco.mj_step(model, other)
            assert mine.ncon == other.ncon
            touched += other.ncon
        for at, here, width in pairs:
            assert np.allclose(mine.qpos[here : here + width], other.qpos[at : at + width], rtol=0, atol=1e-9)
        assert np.allclose(forces(union, mine), forces(model, other), rtol=1e-6, atol=1e-9)
    assert touched > 1000


def test_keys_and_masses(both: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    found, built = both
    for world, each in enumerate(built):
        union = found.model(world)
        assert np.isclose(union.body_mass.sum(), each.model.body_mass.sum())
        for at, here, width in joints(found, world, union, each.model):
            assert np.allclose(union.key_qpos[0, here : here + width], each.model.key_qpos[0, at : at + width])


def test_a_batch_of_a_union(both: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    pytest.importorskip("mujoco.batch", reason="MuJoCo 3.17")
    found, _ = both
    batch = worlds.mujoco(found, nthread=1)
    batch.reset()
    batch.step(nstep=100)
    for world, model in enumerate(found.models()):
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, 100)
        assert np.allclose(batch.qpos[world], data.qpos, rtol=0, atol=1e-6)


def test_warp_of_a_union(both: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    mujoco_warp = pytest.importorskip("mujoco_warp", reason="mujoco-warp is not installed")
    found, _ = both
    data = worlds.warp_data(found, nconmax=50, njmax=200)
    model = worlds.warp(found)
    for _ in range(100):
        mujoco_warp.step(model, data)
    for world, each in enumerate(found.models()):
        wanted = mujoco.MjData(each)
        mujoco.mj_step(each, wanted, 100)
        assert np.allclose(data.qpos.numpy()[world], wanted.qpos, atol=1e-4)


def test_a_union_says_of_how_many_models(both: tuple[worlds.Worlds, list[mjcompose.Loaded]]) -> None:
    manifest = both[0].manifest
    assert manifest.parts == () and manifest.union is not None and manifest.union > 1


def test_one_structure_needs_no_union(tmp_path: Path) -> None:
    lay_out(tmp_path)
    text = MATRIX.replace("[hammer, hook]", "[hook]").replace(
        "[./box.xml, ./ball.xml], friction", "[./box.xml], friction"
    )
    result = run(tmp_path, text, "--as", "union", "--worlds", "study.npz", "-o", "out/", model=ARM)
    assert result.exit_code == 0, result.output
    found = worlds.load(tmp_path / "out", tmp_path / "study.npz")
    assert found.table.parts == () and len(found) == 2
    for world, each in enumerate(all_of(tmp_path, text)):
        assert {name for name in differing(found.model(world), each) if not name.startswith("name")} == set()


def all_of(folder: Path, text: str) -> list[mujoco.MjModel]:
    result = run(folder, text, "--all", "-o", "each/{name}/", model=ARM)
    assert result.exit_code == 0, result.output
    return [each.load().model for each in mjcompose.load_many(folder / "each")]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("  hook: {add: [{to: world, light: {name: lamp}}]}\n", "has the light `lamp` on the world"),
        (
            "  hook: {sensor: {s: {type: framepos, objtype: site, objname: flange}}}\n",
            "has the sensor `s`, which belongs to no part",
        ),
        ("  hook: {equality: {e: {type: joint, joint1: hinge}}}\n", "has the equality `e`, which belongs to no part"),
        (
            "  hook: {contact: {exclude: [{body1: arm, body2: prop/prop}]}}\n",
            "has the exclude `#0`, which belongs to no part",
        ),
    ],
)
def test_what_no_part_can_be(tmp_path: Path, more: str, said: str) -> None:
    lay_out(tmp_path)
    text = MATRIX.replace(
        "variants: {tool: {hammer: {}, hook: {}, none: {}}}\n",
        f"variants:\n tool:\n  hammer: {{}}\n  none: {{}}\n{more}",
    )
    result = run(tmp_path, text, "--as", "union", "--worlds", "study.npz", "-o", "out/", model=ARM)
    assert result.exit_code == 1 and "error[not-a-world]" in result.output and said in result.output, result.output
    assert not (tmp_path / "out").exists()


def test_what_would_act_on_others(tmp_path: Path) -> None:
    """An equality of the first cell that acts on what all have."""
    lay_out(tmp_path)
    text = MATRIX.replace("hammer: {}, hook", "hammer: {equality: {e: {type: joint, joint1: hinge}}}, hook")
    result = run(tmp_path, text, "--as", "union", "--worlds", "study.npz", "-o", "out/", model=ARM)
    assert result.exit_code == 1 and "lacks the equality `e`, which would act in its world" in result.output


def test_a_union_has_a_table(tmp_path: Path) -> None:
    lay_out(tmp_path)
    result = run(tmp_path, MATRIX, "--as", "union", "--all", "-o", "each/{name}/", model=ARM)
    assert result.exit_code == 2 and "--as union also needs --worlds FILE" in result.output


def test_what_elements_refer_to_is_what_is_written() -> None:
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody>
      <body name="a"><joint name="ja"/><geom name="ga" size=".1"/><site name="sa"/><camera name="ca"/>
        <body name="b" pos="1 0 0"><joint name="jb"/><geom name="gb" size=".1"/><site name="sb"/></body></body>
      </worldbody>
      <contact><pair geom1="ga" geom2="gb"/><exclude body1="a" body2="b"/></contact>
      <tendon><fixed name="tf"><joint joint="jb" coef="1"/><joint joint="ja" coef="2"/></fixed>
        <spatial name="ts"><site site="sa"/><geom geom="gb"/><site site="sb"/><pulley divisor="2"/><site site="sb"/><site site="sa"/></spatial></tendon>
      <equality><connect body1="b" body2="a" anchor="0 0 0"/><weld site1="sb" site2="sa"/>
        <joint joint1="jb" joint2="ja"/><joint joint1="jb"/><tendon tendon1="ts" tendon2="tf"/></equality>
      <actuator><motor joint="jb"/><motor jointinparent="ja"/><motor tendon="ts"/><motor site="sb" refsite="sa"/>
        <motor cranksite="sa" slidersite="sb" cranklength="1"/><adhesion body="b" ctrlrange="0 1"/></actuator>
      <sensor><jointpos joint="jb"/><framepos objtype="site" objname="sb" reftype="camera" refname="ca"/><clock/></sensor>
    </mujoco>""")
    table = NameTable(model)

    def of(kind: str, count: int) -> list[str]:
        return [
            " ".join(table.names[each][number] for each, number in references(model, kind, at)) for at in range(count)
        ]

    assert of("pair", 1) == ["ga gb"] and of("exclude", 1) == ["a b"]
    assert of("tendon", 2) == ["jb ja", "sa gb sb sb sa"]
    assert of("equality", 5) == ["b a", "sb sa", "jb ja", "jb", "ts tf"]
    assert of("actuator", 6) == ["jb", "ja", "ts", "sb sa", "sa sb", "b"]
    assert of("sensor", 3) == ["jb", "sb ca", ""]
    assert [*referring_bodies(model, "actuator", 2)] == [1, 2, 2, 2, 1] and [*referring_bodies(model, "sensor", 1)] == [
        2,
        1,
    ]
    assert words(model, "equality", 0, lambda kind, at: table.names[kind][at]) == "equality 0 body b body a"
