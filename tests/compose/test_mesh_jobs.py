from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.diagnostic import Span
from mjcompose.base.limits import allow
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.language.parameters import node_of
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching

ARM = """\
<mujoco model="arm">
  <compiler angle="degree"/>
  <default>
    <default class="solid"><geom type="mesh" density="500" pos="0 0 0.1" euler="0 20 0"/></default>
    <mesh scale="0.1 0.2 0.1"/>
  </default>
  <asset>
    <mesh name="ball" builtin="sphere" params="4" refpos="0.3 0 0" refquat="1 1 0 0"/>
    <mesh name="open" vertex="0 0 0  1 0 0  0 1 0  0 0 1" face="0 2 1  0 1 3  0 3 2" inertia="shell"/>
  </asset>
  <worldbody>
    <body name="link" euler="0 30 0">
      <freejoint/>
      <geom name="one" class="solid" mesh="ball"/>
      <geom name="two" class="solid" mesh="ball" pos="1 0 0" euler="10 0 40" friction="0.3" condim="4" contype="2"/>
    </body>
    <body name="other" pos="5 0 0">
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <geom name="seen" type="mesh" mesh="ball" contype="0" conaffinity="0"/>
    </body>
    <body name="third" pos="9 0 0"><geom name="open" type="mesh" mesh="open" mass="0"/></body>
  </worldbody>
</mujoco>
"""
needs_extra = pytest.mark.skipif(
    any(find_spec(name) is None for name in ("trimesh", "scipy", "rtree", "coacd", "fast_simplification")),
    reason="needs the extra `mesh`",
)


def built(folder: Path, edits: str, arm: str = ARM) -> tuple[Built | None, Context]:
    (folder / "arm.xml").write_text(arm, encoding="utf-8")
    recipe = folder / "recipe.yaml"
    recipe.write_text(f"recipe: 1\nbase: ./arm.xml\nedit:\n  - {edits}\n", encoding="utf-8")
    environment = {"MJCOMPOSE_CACHE": str(folder / "cache")}
    context = Context(environment=environment, folder=folder, fetching=Fetching())
    return build(ModelRequest(recipe), context), context


def compiled(made: Built | None) -> mujoco.MjModel:
    assert made is not None
    return mujoco.MjModel.from_xml_string(made.bundle.files["model.xml"].decode(), dict(made.bundle.files))


def points(model: mujoco.MjModel, name: str) -> np.ndarray:
    """The vertices of a geom's mesh in the world."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    geom = model.geom(name).id
    mesh = model.geom_dataid[geom]
    start = model.mesh_vertadr[mesh]
    count = model.mesh_vertnum[mesh]
    return model.mesh_vert[start : start + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


@pytest.mark.skipif(find_spec("trimesh") is not None, reason="the extra `mesh` is here")
def test_without_the_extra_the_error_names_it(tmp_path: Path) -> None:
    found, context = built(tmp_path, "{select: {geom: one}, collision: {hull: {}}}")
    assert found is None
    (error,) = context.sink.errors
    assert error.code == "mesh-tools-missing" and "mjcompose[mesh]" in (error.help or "")


def test_an_editor_makes_nothing(tmp_path: Path) -> None:
    built(tmp_path, "{select: {geom: nothing}, optional: true, collision: {hull: {}}}")
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(recipe.read_text().replace("nothing}, optional: true", "one}"))
    context = Context(environment={"MJCOMPOSE_CACHE": str(tmp_path / "cache")}, folder=tmp_path)
    plan = make_plan(recipe, context)
    assert plan is not None
    composed = Composer(context, None, options=ComposeOptions(makes_shapes=False)).compose(plan)
    assert composed is not None and composed.shapes == ()
    assert not context.sink.diagnostics


@needs_extra
@pytest.mark.slow
def test_hulls_stand_where_the_meshes_do_and_weigh_nothing(tmp_path: Path) -> None:
    found, context = built(tmp_path, '{select: {geom: "{one,two,seen}"}, collision: {hull: {}}}')
    assert not context.sink.diagnostics
    after = compiled(found)
    before = mujoco.MjModel.from_xml_string(ARM)
    for array in ("body_mass", "body_inertia", "body_ipos", "body_iquat"):
        assert np.array_equal(getattr(after, array), getattr(before, array)), array
    for name in ("one", "two", "seen"):
        hull = f"{name}_hull"
        ours, theirs = (np.sort(points(after, each), axis=0) for each in (hull, name))
        assert np.allclose([ours[0], ours[-1]], [theirs[0], theirs[-1]], atol=1e-6)
        assert after.geom(name).contype == after.geom(name).conaffinity == 0
        assert after.geom(hull).group == 3
    assert after.geom("two_hull").contype == 2 and after.geom("two_hull").condim == 4
    assert after.geom("two_hull").friction[0] == 0.3
    assert after.geom("seen_hull").contype == after.geom("seen_hull").conaffinity == 1
    # The ball is one mesh: so is its hull.
    assert after.nmesh == before.nmesh + 1


@needs_extra
@pytest.mark.slow
def test_settings_are_parameters_and_what_is_made_differs_by_them(tmp_path: Path) -> None:
    edits = """{select: {geom: one}, collision: {spheres: {count: "${2 * balls}", seed: "${balls}"}}}
  - {select: {geom: two}, collision: {fit: "${around}"}}
params: {balls: 1, around: box}"""
    (tmp_path / "arm.xml").write_text(ARM, encoding="utf-8")
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(f"recipe: 1\nbase: ./arm.xml\nedit:\n  - {edits}\n", encoding="utf-8")
    for balls in (2, 3):
        for around in ("box", "capsule"):
            context = Context(
                environment={"MJCOMPOSE_CACHE": str(tmp_path / "cache")}, folder=tmp_path, fetching=Fetching()
            )
            given = {
                name: node_of(value, Span("given", 1, 1)) for name, value in (("balls", balls), ("around", around))
            }
            made = build(ModelRequest(recipe, given), context)
            assert not context.sink.diagnostics
            assert made is not None
            of_one, of_two = json.loads(made.bundle.files["manifest.json"])["made"]
            assert of_one["how"] == f"spheres (count {2 * balls}, seed {balls})"
            assert len(of_one["shapes"]) == 2 * balls
            assert of_two["shapes"] == [f"two_{around}"]


@needs_extra
@pytest.mark.slow
def test_primitives_are_around_the_meshes(tmp_path: Path) -> None:
    for primitive in ("box", "sphere", "capsule", "cylinder"):
        found, _ = built(tmp_path, f"{{select: {{geom: two}}, collision: {{fit: {primitive}}}}}")
        model = compiled(found)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        geom = model.geom(f"two_{primitive}").id
        inner = (points(model, "two") - data.geom_xpos[geom]) @ data.geom_xmat[geom].reshape(3, 3)
        size = model.geom_size[geom]
        radial = np.linalg.norm(inner[:, :2], axis=1)
        beyond = {
            "box": (np.abs(inner) - size).max(),
            "sphere": (np.linalg.norm(inner, axis=1) - size[0]).max(),
            "cylinder": max((radial - size[0]).max(), (np.abs(inner[:, 2]) - size[1]).max()),
            "capsule": (np.hypot(radial, np.maximum(np.abs(inner[:, 2]) - size[1], 0)) - size[0]).max(),
        }[primitive]
        assert abs(beyond) < 1e-6


@needs_extra
@pytest.mark.slow
def test_a_simpler_mesh_stands_where_the_old_one_did(tmp_path: Path) -> None:
    arm = ARM.replace('class="solid" mesh="ball"', 'class="solid" mesh="ball" mass="0"').replace(
        "<freejoint/>", '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    )
    found, context = built(tmp_path, "{select: {mesh: ball}, simplify: {faces: 400}}", arm)
    assert not context.sink.diagnostics
    after = compiled(found)
    before = mujoco.MjModel.from_xml_string(arm)
    assert after.mesh("ball").facenum[0] <= 400 < before.mesh("ball").facenum[0]
    for name in ("one", "two"):
        ours = points(after, name)
        theirs = points(before, name)
        assert np.allclose(ours.min(axis=0), theirs.min(axis=0), atol=0.01)
        assert np.allclose(ours.max(axis=0), theirs.max(axis=0), atol=0.01)
    assert np.array_equal(after.body_inertia, before.body_inertia)


@needs_extra
@pytest.mark.slow
def test_an_open_mesh_is_reported_where_an_inside_is_needed(tmp_path: Path) -> None:
    _, context = built(tmp_path, "{select: {geom: open}, collision: {decompose: {parts: 2}}}")
    assert [each.code for each in context.sink.diagnostics] == ["mesh-shape"]
    _, context = built(tmp_path, "{select: {geom: open}, collision: {hull: {}}}")
    assert not context.sink.diagnostics


@needs_extra
@pytest.mark.slow
def test_meshes_of_an_odd_size_are_one_warning_whose_help_keeps_their_scale(tmp_path: Path) -> None:
    arm = ARM.replace('scale="0.1 0.2 0.1"', 'scale="300 600 300"').replace('pos="5 0 0"', 'pos="3 0 0"')
    arm = arm.replace('pos="9 0 0"', 'pos="0 3 0"')
    _, context = built(tmp_path, '{select: {geom: "{one,open}"}, collision: {fit: box}}', arm)
    (warning,) = context.sink.diagnostics
    assert warning.code == "mesh-size" and "at most 3 m apart" in warning.message
    assert "{select: {mesh: ball}, set: {scale: [0.3, 0.6, 0.3]}}" in (warning.help or "")
    assert [each.message for each in warning.others] == ["mesh `open` (arm.xml:9:5)"]
    # In a model that is as large itself it is not odd.
    _, context = built(tmp_path, "{select: {geom: one}, collision: {fit: box}}", arm.replace("0 3 0", "0 30 0"))
    assert not context.sink.diagnostics


@needs_extra
@pytest.mark.slow
def test_the_manifest_says_how_far_it_is_off_and_the_store_has_it(tmp_path: Path) -> None:
    found, _ = built(tmp_path, "{select: {geom: one}, collision: {fit: sphere}}")
    assert found is not None
    (made,) = json.loads(found.bundle.files["manifest.json"])["made"]
    assert (made["mesh"], made["geom"], made["shapes"]) == ("ball", "one", ["one_sphere"])
    # The ball is twice as wide as it is high: half of that is missing above it.
    assert made["beyond"] == pytest.approx(0.1, abs=0.01) and made["short"] == 0
    assert [path.name for path in (tmp_path / "cache" / "shapes").iterdir()] == [made["key"]]


@needs_extra
@pytest.mark.slow
def test_faces_and_time_are_limited(tmp_path: Path) -> None:
    for limit, words in (({"mesh_faces": 100}, "100 are allowed"), ({"mesh_time": 0.02}, "longer than 0.02 s")):
        with allow(**limit):
            found, context = built(tmp_path, "{select: {geom: one}, collision: {fit: sphere}}")
        assert found is None
        (error,) = context.sink.errors
        assert error.code == "limit-exceeded" and words in error.message
        assert f"--limit {next(iter(limit)).replace('_', '-')}=" in (error.help or "")
