"""The verb `inertia`: what is written is what MuJoCo computes itself of the same geoms."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

CORNERS = "0 0 0 .4 0 0 0 .3 0 0 0 .2 .1 .1 .3"
MODEL = """<mujoco{settings}
  <default><default class="seen"><geom group="2" contype="0" conaffinity="0" mass="0"/></default></default>
  <asset><mesh name="link" vertex="{corners}"/><mesh name="thin" inertia="exact" vertex="{corners}"/></asset>
  <worldbody>
    <body name="link" pos="0 0 1">
      <joint name="j" axis="0 1 0"/>
      {inertial}
      <geom class="seen" type="mesh" mesh="link" pos=".1 0 0" euler="10 20 30"/>
      <frame pos="0 .2 0" euler="0 0 40"><geom class="seen" type="mesh" mesh="thin"/></frame>
      <geom name="hull" type="capsule" size=".1 .2" group="3"/>
      <body name="tip" pos="0 0 .3"><joint axis="1 0 0"/><geom type="box" size=".1 .2 .05" mass="3"/></body>
    </body>
  </worldbody>
</mujoco>"""
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
WHOLE = ("body_mass", "body_ipos", "body_inertia")


def source(settings: str = ">", inertial: str = INERTIAL) -> str:
    return MODEL.format(settings=settings, corners=CORNERS, inertial=inertial)


def edited(text: str, edit: str, folder: Path, more: str = "") -> mujoco.MjModel | list[tuple[str, str]]:
    """The compiled model, or the codes and messages of what is wrong."""
    (folder / "model.xml").write_text(text)
    (folder / "recipe.yaml").write_text(
        f"recipe: 1\nallow: [license-missing]\nbase: {{model: ./model.xml{more}}}\n{edit}"
    )
    context = Context(folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml"), context)
    if built is None:
        return [(each.code, each.message) for each in context.sink.errors]
    assert not context.sink.diagnostics
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def of(density: float, groups: str, text: str) -> mujoco.MjModel:
    """MuJoCo's own: of a body without an inertial, its geoms of a group at the density and the others without mass."""
    spec = mujoco.MjSpec.from_string(text)
    body = spec.body("link")
    for geom in body.geoms:
        counts = str(geom.group) in groups
        geom.mass = np.nan if counts else 0.0
        if counts:
            geom.density = density
    return spec.compile()


def assert_same(model: mujoco.MjModel | list[tuple[str, str]], truth: mujoco.MjModel) -> None:
    assert isinstance(model, mujoco.MjModel), model
    for name in WHOLE:
        assert np.allclose(getattr(model, name), getattr(truth, name), rtol=1e-12, atol=1e-15), name
    turned = [np.zeros(9), np.zeros(9)]
    for each, into in zip((model, truth), turned, strict=True):
        mujoco.mju_quat2Mat(into, each.body("link").iquat)
    assert np.allclose(*turned, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "density", "groups"),
    [("from: mesh, density: 1200", 1200, "2"), ("from: geoms, density: 500, group: 3", 500, "3")],
)
@pytest.mark.parametrize(
    "settings", [">", '><compiler inertiafromgeom="true"/>', '><compiler inertiafromgeom="false"/>']
)
@pytest.mark.parametrize("where", ["model", "part"])
def test_it_is_what_mujoco_computes(
    given: str, density: float, groups: str, settings: str, where: str, tmp_path: Path
) -> None:
    entry = f"{{select: {{body: link}}, inertia: {{{given}}}}}"
    edit, more = (f"edit: [{entry}]", "") if where == "model" else ("", f", edit: [{entry}]")
    truth = of(density, groups, source(inertial=""))
    if "false" in settings:  # what has no inertial has no mass there
        truth.body_mass[2] = 0
        truth.body_inertia[2] = 0
        truth.body_ipos[2] = (0, 0, 0.3)
        text = (
            source(settings)
            .replace(' size=".1 .2 .05" mass="3"/>', ' size=".1 .2 .05"/>')
            .replace('<joint axis="1 0 0"/>', "")
        )
        truth.body_ipos[2] = (0, 0, 0.3)
        assert_same(edited(text, edit, tmp_path, more), truth)
        return
    assert_same(edited(source(settings), edit, tmp_path, more), truth)


def test_with_or_without_an_inertial_before(tmp_path: Path) -> None:
    edit = "edit: [{select: {body: link}, inertia: {from: mesh, density: 700}}]"
    assert_same(edited(source(inertial=""), edit, tmp_path), of(700, "2", source(inertial="")))


def test_an_inertial_in_a_frame(tmp_path: Path) -> None:
    inside = f'<frame pos="0 0 1" euler="0 90 0">{INERTIAL.replace("diaginertia", "fullinertia").replace("1 1 1", "1 1 1 0 0 0")}</frame>'
    edit = "edit: [{select: {body: link}, inertia: {from: mesh, density: 700}}]"
    assert_same(edited(source(inertial=inside), edit, tmp_path), of(700, "2", source(inertial="")))


def test_then_a_mass(tmp_path: Path) -> None:
    edit = (
        "edit:\n  - {select: {body: link}, inertia: {from: mesh, density: 1}}\n"
        "  - {select: {body: link}, set: {mass: 2.5}}"
    )
    model = edited(source(), edit, tmp_path)
    assert isinstance(model, mujoco.MjModel) and model.body("link").mass[0] == pytest.approx(2.5)
    truth = of(1, "2", source(inertial=""))
    truth.body_inertia[1] *= 2.5 / truth.body_mass[1]
    truth.body_mass[1] = 2.5
    assert_same(model, truth)


@pytest.mark.parametrize(
    ("given", "code", "told"),
    [
        ("from: geoms, density: 1", "selector", "has geoms in the groups 2, 3, which may be the same shape"),
        ("from: mesh, density: 1, group: 3", "selector", "has no meshes in the group 3"),
        ("density: 1", "missing-key", "`inertia` lacks `from`"),
        ("from: mesh", "missing-key", "`inertia` lacks `density`"),
        ("from: meshes, density: 1", "wrong-keyword", "`from` of `inertia` cannot be `meshes`"),
        ("from: mesh, density: -1", "out-of-range", "must be more than 0"),
        ("from: mesh, density: steel", "wrong-type", "expects a number"),
        ("from: mesh, density: 1, groups: 2", "unknown-key", "`inertia` has no key `groups`"),
    ],
)
def test_faults(given: str, code: str, told: str, tmp_path: Path) -> None:
    found = edited(source(), f"edit: [{{select: {{body: link}}, inertia: {{{given}}}}}]", tmp_path)
    assert isinstance(found, list)
    ((first, message),) = found
    assert first == code and told in message


def test_only_bodies_have_one(tmp_path: Path) -> None:
    found = edited(source(), "edit: [{select: {geom: hull}, inertia: {from: mesh, density: 1}}]", tmp_path)
    assert found == [("wrong-type", "`inertia` is for bodies, and `geom` is not a body")]


def test_a_body_without_meshes(tmp_path: Path) -> None:
    found = edited(source(), "edit: [{select: {body: tip}, inertia: {from: mesh, density: 1}}]", tmp_path)
    assert found == [("selector", "body `tip` has no meshes")]


def test_what_mujoco_refuses_is_told_where_it_is_written(tmp_path: Path) -> None:
    flat = re.sub(r'vertex="[^"]*"', 'vertex="0 0 0 1 0 0 0 1 0 1 1 0" face="0 1 2 1 3 2"', source())
    found = edited(flat, "edit: [{select: {body: link}, inertia: {from: mesh, density: 1}}]", tmp_path)
    assert isinstance(found, list) and found[0][0] == "mujoco-rejects"


def test_a_shell_is_refused_until_it_is_solid(tmp_path: Path) -> None:
    """MuJoCo 4.0 reads the density of a shell in kg/m²: 500 would be a plate of 500 kg/m², not a body of 500 kg/m³."""
    text = source().replace('name="link" vertex', 'name="link" inertia="shell" vertex')
    verb = "edit: [{select: {body: link}, inertia: {from: mesh, density: 500}}]"
    ((code, message),) = edited(text, verb, tmp_path)  # type: ignore[misc]
    assert code == "wrong-type" and "the mesh `link` is a shell" in message
    solid = "edit: [{select: {mesh: link}, set: {inertia: convex}}, {select: {body: link}, inertia: {from: mesh, density: 500}}]"
    model = edited(text, solid, tmp_path)
    assert isinstance(model, mujoco.MjModel)
    whole = source(inertial="").replace('name="link" vertex', 'name="link" inertia="convex" vertex')
    assert model.body("link").mass == pytest.approx(of(500, "2", whole).body("link").mass)
