"""MJCF that attaches recipes builds as MuJoCo attaches the built models."""

from __future__ import annotations

import json
from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose.base.sink import Sink
from mjcompose.bundle.write import write
from mjcompose.pipeline.cache.inputs import Inputs
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.describe import as_data, describe
from mjcompose.plan.locked import lock_of
from mjcompose.plan.plan import PlanPreview
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching

ARM = """\
<mujoco model="arm">
  <compiler meshdir="meshes"/>
  <asset><mesh file="tetra.obj"/></asset>
  <worldbody>
    <body name="link">
      <joint name="j" axis="0 0 1"/>
      <geom name="g" type="mesh" mesh="tetra" mass="1"/>
      <site name="tip" pos="0 0 1"/>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0.5"/></keyframe>
</mujoco>
"""
TOOL = """\
recipe: 1
base: ./arm.xml
edit: [{select: {geom: g}, set: {mass: 2}}]
attach: {two: {model: ./arm.xml, site: tip}}
"""
SCENE = """\
<mujoco model="scene">
  <asset>
    <model name="tool" file="tool.yaml"/>
    <model name="arm" file="arm.xml"/>
    <model file="inner.xml"/>
    <mesh name="own" file="meshes/tetra.obj"/>
  </asset>
  <worldbody>
    <body name="table">
      <geom name="top" type="mesh" mesh="own"/>
      <attach model="tool" prefix="a_"/>
      <frame pos="0 1 0"><attach model="tool" prefix="b_"/></frame>
      <attach model="arm" body="link" prefix="c_"/>
      <attach model="inner" prefix="d_"/>
    </body>
  </worldbody>
</mujoco>
"""
INNER = """\
<mujoco model="inner">
  <asset><model name="tool" file="tool.yaml"/></asset>
  <worldbody><body name="holder"><attach model="tool" body="link" prefix="e_"/></body></worldbody>
</mujoco>
"""
TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
FILES = {
    "arm.xml": ARM,
    "tool.yaml": TOOL,
    "scene.xml": SCENE,
    "inner.xml": INNER,
    "cell.yaml": "recipe: 1\nbase: ./scene.xml\n",
    "meshes/tetra.obj": TETRA,
    "LICENSE": "MIT License\n",
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    at = tmp_path / "project"
    (at / "meshes").mkdir(parents=True)
    for name, text in FILES.items():
        (at / name).write_text(text)
    monkeypatch.chdir(at)
    return at


def built(recipe: str, context: Context | None = None) -> Built:
    context = context or Context(fetching=Fetching())
    found = build(ModelRequest(Path(recipe)), context)
    assert found is not None, [each.message for each in context.sink.errors]
    return found


def errors(recipe: str = "cell.yaml") -> list[tuple[str, str]]:
    sink = Sink()
    assert build(ModelRequest(Path(recipe)), Context(sink, fetching=Fetching())) is None
    return [(each.code, f"{each.span.file}:{each.span.line}:{each.span.column}") for each in sink.errors if each.span]


def by_mujoco(folder: Path) -> mujoco.MjModel:
    """MuJoCo's own attachments: those of the built model of the recipe."""
    write(built("tool.yaml").bundle, folder / "built", environment={})
    for name in ("scene.xml", "inner.xml"):
        text = FILES[name].replace("tool.yaml", "built/model.xml").replace("inner.xml", "expected_inner.xml")
        (folder / f"expected_{name}").write_text(text)
    return mujoco.MjModel.from_xml_path(str(folder / "expected_scene.xml"))


def arrays(model: mujoco.MjModel) -> dict[str, object]:
    return {name: getattr(model, name) for name in dir(model) if isinstance(getattr(model, name), np.ndarray)}


def assert_same(model: mujoco.MjModel, expected: mujoco.MjModel) -> None:
    known = arrays(expected)
    for name, array in arrays(model).items():
        if name not in ("_sizes", "paths", "mesh_pathadr", "names", "names_map") and not name.startswith("name_"):
            np.testing.assert_array_equal(array, known[name], err_msg=name)
    for count, kind in (("nbody", "BODY"), ("ngeom", "GEOM"), ("njnt", "JOINT"), ("nsite", "SITE"), ("nkey", "KEY")):
        named = [
            [mujoco.mj_id2name(each, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), i) for i in range(getattr(each, count))]
            for each in (model, expected)
        ]
        assert named[0] == named[1]


def test_the_model_is_the_same_as_by_mujoco(folder: Path) -> None:
    write(built("cell.yaml").bundle, folder / "out", environment={})
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml"))
    assert model.nbody == 10 and model.nkey > 0
    expected = by_mujoco(folder)
    assert_same(model, expected)
    assert_same(mjcompose.model("cell.yaml"), expected)
    assert_same(mjcompose.spec("cell.yaml").compile(), expected)


def test_a_part_attaches_recipes(folder: Path) -> None:
    (folder / "cell.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./scene.xml, drop: [key]}\n  right: {model: ./scene.xml, drop: [key]}\n"
    )
    write(built("cell.yaml").bundle, folder / "out", environment={})
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml"))
    assert model.nbody == 19 and model.body("left/a_link").mass == 2 == model.body("right/d_e_link").mass


def test_the_files_of_the_recipe_are_inputs_and_in_the_manifest(folder: Path) -> None:
    context = Context(fetching=Fetching())
    found = built("cell.yaml", context)
    inputs = Inputs()
    named = {Path(path).name for path in (*inputs.recipes(found.plan), *inputs.others(found, context))}
    assert {"cell.yaml", "tool.yaml", "scene.xml", "inner.xml", "arm.xml", "tetra.obj"} <= named
    manifest = json.loads(found.bundle.files["manifest.json"])
    assert [each["path"] for each in manifest["inputs"]] == ["scene.xml", "arm.xml", "arm.xml"]
    assert [each["part"] for each in manifest["parts"]] == ["base"]


def test_a_changed_part_of_the_recipe_is_another_model(folder: Path) -> None:
    assert mjcompose.model("cell.yaml").body("a_link").mass == 2
    (folder / "tool.yaml").write_text(TOOL.replace("mass: 2", "mass: 3"))
    assert mjcompose.model("cell.yaml").body("a_link").mass == 3


def test_an_error_is_in_the_recipe(folder: Path) -> None:
    (folder / "tool.yaml").write_text(TOOL.replace("geom: g", "geom: gg"))
    assert errors() == [("selector", "tool.yaml:3:17")]
    (folder / "tool.yaml").write_text("recipe: 1\nbas: ./arm.xml\n")
    assert errors() == [("unknown-key", "tool.yaml:2:1")]
    (folder / "tool.yaml").unlink()
    assert errors() == [("source-not-found", "scene.xml:3:30")]


def test_recipes_that_contain_one_another_are_a_cycle(folder: Path) -> None:
    (folder / "tool.yaml").write_text("recipe: 1\nbase: ./scene.xml\n")
    assert {code for code, _ in errors()} == {"source-cycle"}
    (folder / "tool.yaml").write_text(TOOL)
    (folder / "inner.xml").write_text(INNER.replace("<asset>", '<asset><model name="s" file="scene.xml"/>'))
    assert {code for code, _ in errors()} == {"source-cycle"}


def test_a_recipe_outside_of_the_project_is_refused(folder: Path) -> None:
    (folder / "pyproject.toml").write_text("")  # marks the project
    (folder.parent / "outside.yaml").write_text("recipe: 1\n")
    (folder / "scene.xml").write_text(SCENE.replace("tool.yaml", "../outside.yaml"))
    assert errors() == [("source-outside", "scene.xml:3:30")]


@pytest.mark.parametrize(
    "text",
    [
        "base: ../outside.xml\n",
        "extends: ../outside.yaml\n",
        "attach: {nested: {model: ../outside.yaml}}\n",
        "asset: {mesh: {m: {file: ../outside.obj}}}\n",
        "base: descriptions:ur5e_mj_description\n",
        "extends: descriptions:ur5e_mj_description\n",
    ],
)
def test_a_recipe_may_do_no_more_than_the_model_that_attaches_it(folder: Path, text: str) -> None:
    (folder / "pyproject.toml").write_text("")
    for name, content in (("xml", ARM), ("yaml", "recipe: 1\n"), ("obj", TETRA)):
        (folder.parent / f"outside.{name}").write_text(content)
    (folder / "tool.yaml").write_text(f"recipe: 1\n{text}")
    assert {code for code, _ in errors()} == {"source-outside"}


def test_keys_are_dropped_with_those_of_the_part(folder: Path) -> None:
    (folder / "cell.yaml").write_text("recipe: 1\nbase: {model: ./scene.xml, drop: [key]}\n")
    assert mjcompose.model("cell.yaml").nkey == 0


def test_the_plan_names_the_recipe(folder: Path) -> None:
    plan = built("cell.yaml").plan
    assert "      tool: the model of tool.yaml" in describe(plan).splitlines()
    assert as_data(plan, PlanPreview())["attaches"][0]["parts"][0]["prefix"] == "two/"


def test_a_recipe_that_the_section_asset_names_is_an_error(folder: Path) -> None:
    (folder / "cell.yaml").write_text("recipe: 1\nasset: {model: {tool: {file: tool.yaml}}}\n")
    assert errors() == [("source-kind", "cell.yaml:2:30")]


def test_the_recipe_is_locked(folder: Path) -> None:
    fetching = Fetching()
    context = Context(fetching=fetching)
    lock = lock_of([built("cell.yaml", context).plan], fetching, folder, context)
    assert {"./tool.yaml", "./scene.xml", "./arm.xml"} <= set(lock.sources)
