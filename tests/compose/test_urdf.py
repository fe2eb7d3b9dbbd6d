"""URDF as base and part of a recipe; MuJoCo itself says what it means alone."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import numpy
import pytest
from mjcompose.mujoco.match import Mount
from mjcompose.mujoco.unchanged import compare
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.urdf.inertia import reads_turned

EXACT = hasattr(mujoco.MjSpec, "fuse_static")
"""An older MuJoCo saves compiled values, which are rounded when they are compiled again."""
TOLERANCE = 0.0 if EXACT else 1e-9
CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "urdf"
INERTIA = '<inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="0.002" izz="0.04"/>'
TURN = 'rpy="0.1 0.2 0.3"' if reads_turned(mujoco, None) else ""
"""An older MuJoCo ignores it, and a recipe does not: `tests/urdf/test_inertia.py`."""
ROBOT = f"""<robot name="robot">
  <mujoco>EXTENSION</mujoco>
  <material name="red"><color rgba="1 0.1 0 1"/></material>
  <link name="base">
    <inertial><origin xyz="0.01 0.02 0.03" {TURN}/><mass value="3.3"/>{INERTIA}</inertial>
    <visual name="skin"><geometry><mesh filename="meshes/wedge.obj"/></geometry><material name="red"/></visual>
    <collision><origin xyz="0 0 0.1" rpy="0.7 0 0.2"/><geometry><mesh filename="meshes/wedge.obj"/></geometry></collision>
  </link>
  <link name="arm">
    <collision><origin xyz="0 0.1 0.1"/><geometry><capsule radius="0.03" length="0.3"/></geometry></collision>
    <collision><origin rpy="1 2 3"/><geometry><mesh filename="meshes/wedge.obj" scale="0.5 -1 1"/></geometry></collision>
  </link>
  <link name="plate">
    <inertial><origin xyz="0 0 0.03"/><mass value="0.7"/>{INERTIA}</inertial>
    <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>
    <collision><origin rpy="0.5 0 0"/><geometry><mesh filename="meshes/wedge.obj"/></geometry></collision>
  </link>
  <link name="hand"><inertial><mass value="0.2"/>{INERTIA}</inertial></link>
  <link name="cart"><inertial><mass value="0.2"/>{INERTIA}</inertial></link>
  <joint name="turn" type="revolute">
    <origin xyz="0.1 0.2 0.3" rpy="0.1 -0.2 0.3"/><parent link="base"/><child link="arm"/><axis xyz="0 1 1"/>
    <limit lower="-1.1" upper="2.2" effort="7" velocity="1"/><dynamics damping="0.3" friction="0.1"/>
  </joint>
  <joint name="bolt" type="fixed"><origin xyz="0 0 0.3" rpy="0.3 0.2 0.1"/><parent link="arm"/><child link="plate"/></joint>
  <joint name="grip" type="prismatic">
    <origin xyz="0 0 0.1" rpy="0 0.1 0"/><parent link="plate"/><child link="hand"/>
    <limit lower="0" upper="0.1" effort="0" velocity="1"/><mimic joint="turn" multiplier="0.1"/>
  </joint>
  <joint name="drive" type="planar"><parent link="base"/><child link="cart"/><axis xyz="0 0 1"/></joint>
</robot>"""
EXTENSIONS = {
    "none": "",
    "visuals": '<compiler discardvisual="false"/>',
    "unfused": '<compiler fusestatic="false"/>',
    "folders": '<compiler meshdir="meshes" strippath="true"/>',
    "inertia": '<compiler boundmass="0.5" boundinertia="0.01" balanceinertia="true" settotalmass="7"/>',
    "from geoms": '<compiler inertiafromgeom="true"/>',
    "options": '<option timestep="0.003" integrator="implicit"><flag gravity="disable"/></option><size memory="1M"/>',
}


def files(folder: Path, extension: str = "", **recipes: str) -> Path:
    """A folder with the robot and `NAME.yaml` for every recipe; the first recipe."""
    (folder / "meshes").mkdir()
    wedge = (GOLDEN / "cell_description" / "meshes" / "wedge.obj").read_bytes()
    (folder / "meshes" / "wedge.obj").write_bytes(wedge)
    (folder / "robot.urdf").write_text(ROBOT.replace("EXTENSION", extension))
    for name, text in recipes.items():
        (folder / f"{name}.yaml").write_text(f"recipe: 1\n{text}")
    return folder / f"{next(iter(recipes))}.yaml"


def built(recipe: Path) -> mujoco.MjModel:
    context = Context(environment={}, folder=recipe.parent)
    found = build(ModelRequest(recipe, verified=False), context)
    assert found is not None, [each.message for each in context.sink.diagnostics]
    bundle = {path: bytes(content) for path, content in found.bundle.files.items()}
    return mujoco.MjModel.from_xml_string(bundle[found.bundle.model].decode(), bundle)


def arrays(model: mujoco.MjModel) -> dict[str, numpy.ndarray]:
    """All that is in a model but the names of its files and models."""
    found = {}
    for name in dir(model):
        if name.startswith("_") or name in ("names", "paths", "names_map", "nnames", "npaths", "nbuffer"):
            continue
        value = getattr(model, name)
        if isinstance(value, numpy.ndarray | int | float) and not name.startswith(("name_", "mesh_pathadr")):
            found[name] = numpy.asarray(value)
    for group in ("opt", "stat"):
        part = getattr(model, group)
        found |= {f"{group}.{n}": numpy.asarray(getattr(part, n)) for n in dir(part) if not n.startswith("_")}
    return {name: value for name, value in found.items() if value.dtype != object}


def names(model: mujoco.MjModel) -> list[str]:
    return model.names.decode().split("\0")[1:]


def assert_same(alone: mujoco.MjModel, model: mujoco.MjModel) -> None:
    assert names(alone) == names(model)
    expected = arrays(alone)
    found = arrays(model)
    assert len(expected) > 300
    for name, value in expected.items():
        if EXACT:
            assert value.shape == found[name].shape and value.tobytes() == found[name].tobytes(), name
        elif not name.startswith(("bvh", "nbvh")):
            numpy.testing.assert_allclose(found[name], value, rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("extension", EXTENSIONS.values(), ids=EXTENSIONS)
def test_alone_it_is_what_mujoco_makes_of_it(tmp_path: Path, extension: str) -> None:
    recipe = files(tmp_path, extension, recipe="name: robot\nbase: ./robot.urdf\n")
    if not EXACT:  # MuJoCo 3 ignores `<mimic>`, which becomes an equality here all the same
        robot = tmp_path / "robot.urdf"
        robot.write_text(robot.read_text().replace('<mimic joint="turn" multiplier="0.1"/>', ""))
    assert_same(mujoco.MjModel.from_xml_path(str(tmp_path / "robot.urdf")), built(recipe))


@pytest.mark.parametrize("extension", EXTENSIONS.values(), ids=EXTENSIONS)
def test_as_a_part_it_stays_what_it_is(tmp_path: Path, extension: str) -> None:
    text = "conflict: mujoco\nattach:\n  a: {model: ./robot.urdf, pos: [1, 2, 3]}\n  b: {model: ./robot.urdf}\n"
    model = built(files(tmp_path, extension, recipe=text))
    alone = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.urdf"))
    mount = Mount.of(model, pos=(1.0, 2.0, 3.0))
    assert not compare(alone, model, prefix="a/", hung_on=mount, others=[("b/", alone)], tolerance=TOLERANCE)
    assert not compare(alone, model, prefix="b/", others=[("a/", alone)], tolerance=TOLERANCE)


@pytest.mark.parametrize("place", ["body: cube", "joint: free", "frame: spot"])
def test_the_root_link_comes_along_where_it_is_no_part_of_the_world(tmp_path: Path, place: str) -> None:
    recipe = files(tmp_path, recipe=f"base: ./base.xml\nattach: {{r: {{model: ./robot.urdf, {place}}}}}\n")
    (tmp_path / "base.xml").write_text(
        '<mujoco><worldbody><body name="cube"><freejoint/><geom size="1"/><frame name="spot"/></body></worldbody></mujoco>'
    )
    model = built(recipe)
    base = model.body("r/base")
    assert base.mass == 3.3 and model.body(base.parentid[0]).name in ("cube", "r/")


def test_the_root_link_comes_along_in_a_recipe_that_hangs_on_something(tmp_path: Path) -> None:
    recipe = files(
        tmp_path,
        outer="attach:\n  in: {model: ./inner.yaml, joint: free}\n  out: {model: ./inner.yaml}\n",
        inner="base: ./robot.urdf\nattach: {second: {model: ./robot.urdf}}\n",
    )
    model = built(recipe)
    bodies = [model.body(i).name for i in range(model.nbody)]
    assert [name for name in bodies if name.endswith("base")] == ["in/base", "in/second/base"]


@pytest.mark.skipif(not EXACT, reason="this MuJoCo fuses without a trace")
def test_a_fused_link_is_a_frame_to_attach_to(tmp_path: Path) -> None:
    text = "base: ./robot.urdf\nadd: [{to: {frame: plate}, site: {name: tip, pos: [0, 0, 1]}}]\n"
    model = built(files(tmp_path, recipe=text))
    assert model.body(model.site("tip").bodyid[0]).name == "arm"


@pytest.mark.skipif(not EXACT, reason="this MuJoCo passes over `<mimic>` without a word")
def test_warnings_stand_in_the_urdf(tmp_path: Path) -> None:
    recipe = files(
        tmp_path,
        '<compiler fusestaic="false"/>\n<actuator/>',
        recipe="base: ./robot.urdf\nattach: {r: {model: ./robot.urdf, joint: free}}\n",
    )
    text = (tmp_path / "robot.urdf").read_text()
    (tmp_path / "robot.urdf").write_text(text.replace('mimic joint="turn"', 'mimic joint="no"'))
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(recipe), context) is not None
    lines = (tmp_path / "robot.urdf").read_text().splitlines()
    line = next(number for number, text in enumerate(lines, 1) if 'mimic joint="no"' in text)
    told = [(each.code, each.span and each.span.line) for each in context.sink.sorted() if each.code != "urdf-unread"]
    guessed = next(number for number, text in enumerate(lines, 1) if '<link name="arm">' in text)
    assert sorted(told) == [
        ("mujoco-warning", line),
        ("unknown-attribute", 2),
        ("unknown-element", 3),
        ("urdf-mass", guessed),
    ]


def test_a_part_is_parsed_once_for_each_way_to_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.mujoco.convert import Converted
    from mjcompose.urdf import read

    calls = []
    convert = read.convert_urdf

    def counted(*given: object, **named: object) -> Converted:
        calls.append(named["is_fixed"])
        return convert(*given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(read, "convert_urdf", counted)
    parts = "".join(f"  r{i}: {{model: ./robot.urdf, pos: [{i}, 0, 0]}}\n" for i in range(4))
    built(files(tmp_path, recipe=f"attach:\n{parts}  m: {{model: ./robot.urdf, joint: free}}\n"))
    assert calls == [True, False]


@pytest.mark.skipif(not CORPUS, reason="MJCOMPOSE_CORPUS names no corpus")
@pytest.mark.parametrize(
    "path", sorted(Path(CORPUS or ".").rglob("*.urdf")) if CORPUS else [], ids=lambda path: path.stem
)
def test_of_the_corpus(tmp_path: Path, path: Path) -> None:
    alone = mujoco.MjModel.from_xml_path(str(path))
    (tmp_path / "recipe.yaml").write_text(f"recipe: 1\nname: {names(alone)[0]}\nbase: {path}\n")
    assert_same(alone, built(tmp_path / "recipe.yaml"))


def test_a_suffix_in_capitals(tmp_path: Path) -> None:
    recipe = files(tmp_path, robot="base: ./robot.urdf", capitals="name: robot\nbase: ./robot.URDF")
    expected = built(recipe)
    (tmp_path / "robot.urdf").rename(tmp_path / "robot.URDF")
    found = built(tmp_path / "capitals.yaml")
    assert (found.nmesh, found.nbody) == (expected.nmesh, expected.nbody)
    assert numpy.array_equal(found.mesh_vert, expected.mesh_vert)
    assert numpy.array_equal(found.body_inertia, expected.body_inertia)
