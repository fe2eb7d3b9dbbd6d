"""Copies that `replicate` makes share meshes, textures and height fields, and never materials."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from click.testing import CliRunner, Result
from mjcompose.cli.main import main
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context

WEDGE = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
ARM = """<mujoco model="arm">
  <default><default class="visual"><mesh scale="2 2 2"/></default></default>
  <asset>
    <mesh name="link" file="wedge.obj"/>
    <mesh name="cover" file="wedge.obj" class="visual"/>
    <mesh name="points" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <texture name="checks" type="2d" builtin="checker" width="4" height="4" rgb1="1 0 0"/>
    <material name="paint" texture="checks"/>
    <hfield name="ground" nrow="2" ncol="2" size="1 1 1 .1" elevation="0 1 0 1"/>
  </asset>
  <worldbody>
    <body name="base">
      <geom name="link" type="mesh" mesh="link" material="paint"/>
      <body name="upper" pos="0 0 .2">
        <joint name="j" axis="0 1 0" damping=".1"/>
        <geom name="cover" type="mesh" mesh="cover"/>
        <geom name="field" type="hfield" hfield="ground"/>
        <geom name="points" type="mesh" mesh="points"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="m" joint="j"/></actuator>
</mujoco>"""
COPIES = "attach: {arm: {model: ./arm.xml, replicate: [{count: 3, offset: [5, 0, 0]}]}}\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "wedge.obj").write_text(WEDGE)
    (tmp_path / "arm.xml").write_text(ARM)
    return tmp_path


def built(folder: Path, recipe: str, **options: Any) -> Built:
    (folder / "recipe.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    made = build(ModelRequest(folder / "recipe.yaml", **options), context)
    assert made is not None, context.sink.diagnostics
    return made


def names(made: Built, kind: str) -> list[str]:
    return [str(each.get("name")) for each in made.composed.model.root.iterfind(f"asset/{kind}")]


def model_of(made: Built, out: Path) -> mujoco.MjModel:
    for name, content in made.bundle.files.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(content)
    return mujoco.MjModel.from_xml_path(str(out / "model.xml"))


def manifest(made: Built) -> dict[str, Any]:
    read: dict[str, Any] = json.loads(made.bundle.files["manifest.json"])
    return read


def test_copies_share_what_is_large(folder: Path) -> None:
    made = built(folder, COPIES + "check: {same: {unchanged: {}}}\n")
    assert names(made, "mesh") == ["arm0/link", "arm0/cover", "arm0/points"]
    assert names(made, "texture") == ["arm0/checks"]
    assert names(made, "hfield") == ["arm0/ground"]
    assert names(made, "material") == ["arm0/paint", "arm1/paint", "arm2/paint"]
    assert manifest(made)["merged"]["mesh"] == {
        f"arm{copy}/{name}": f"arm0/{name}" for name in ("link", "cover", "points") for copy in (1, 2)
    }
    assert "deduplicated" not in manifest(made)


def test_the_model_moves_as_one_that_shares_nothing(folder: Path) -> None:
    """MuJoCo judges: parts with keys of their own are no copies, so they share nothing."""
    shared = model_of(built(folder, COPIES), folder / "shared")
    parts = ", ".join(f"arm{n}: {{model: ./arm.xml, pos: [{5 * n}, 0, 0]}}" for n in range(3))
    alone = model_of(built(folder, f"attach: {{{parts}}}\n"), folder / "alone")
    assert (shared.nmesh, alone.nmesh) == (3, 9)
    assert (shared.ntex, alone.ntex, shared.nhfield, alone.nhfield) == (1, 3, 1, 3)
    one = mujoco.MjData(shared)
    other = mujoco.MjData(alone)
    for step in range(200):
        one.ctrl[:] = other.ctrl[:] = [np.sin(0.1 * step), 0.5, -0.3]
        mujoco.mj_step(shared, one)
        mujoco.mj_step(alone, other)
    assert one.qpos.any() and (one.qpos == other.qpos).all()


def test_copies_of_copies_share_too(folder: Path) -> None:
    (folder / "pair.yaml").write_text(
        "recipe: 1\nattach: {left: {model: ./arm.xml}, right: {model: ./arm.xml, pos: [0, 5, 0]}}\n"
    )
    made = built(folder, "attach: {cell: {model: ./pair.yaml, replicate: [{count: 2, offset: [9, 0, 0]}]}}\n")
    assert names(made, "texture") == ["cell0/left/checks", "cell0/right/checks"]


@pytest.mark.parametrize(
    ("edit", "textures", "meshes"),
    [
        ("edit: [{select: {mesh: arm1/link}, set: {scale: [3, 3, 3]}}]", 1, ["arm0/link", "arm1/link"]),
        ("edit: [{select: {mesh: arm0/link}, set: {scale: [3, 3, 3]}}]", 1, ["arm0/link", "arm1/link"]),
        ("edit: [{select: {texture: arm2/checks}, set: {rgb1: [0, 1, 0]}}]", 2, ["arm0/link"]),
        ("edit: [{select: {mesh: '*/link'}, set: {scale: [3, 3, 3]}}]", 1, ["arm0/link"]),
    ],
)
def test_a_copy_with_an_edit_of_its_own_keeps_its_own(
    folder: Path, edit: str, textures: int, meshes: list[str]
) -> None:
    made = built(folder, f"{COPIES}{edit}\n")
    assert len(names(made, "texture")) == textures
    assert [name for name in names(made, "mesh") if name.endswith("link")] == meshes


@pytest.mark.parametrize(
    ("field", "meshes", "textures"),
    [
        ("{select: {mesh: arm0/link}, attr: 'scale[0]', uniform: [1, 2]}", 9, 1),
        ("{select: {texture: '**'}, attr: 'rgb1[0]', uniform: [0, 1]}", 3, 3),
        ("{select: {material: '**'}, attr: 'rgba[0]', uniform: [0, 1]}", 3, 1),
    ],
)
@pytest.mark.parametrize("sample", [0, 1])
def test_kinds_that_a_draw_selects_are_shared_in_no_sample(
    folder: Path, field: str, meshes: int, textures: int, sample: int
) -> None:
    made = built(folder, f"{COPIES}randomize: {{seed: 1, samples: 1, fields: {{f: {field}}}}}\n", sample=sample)
    assert (len(names(made, "mesh")), len(names(made, "texture"))) == (meshes, textures)


def test_dedup_merges_the_rest(folder: Path) -> None:
    recipe = COPIES.replace("attach: {", "attach: {other: {model: ./arm.xml, pos: [0, 9, 0]}, ")
    shared = built(folder, recipe)
    merged = built(folder, recipe, deduplicated=True)
    assert names(shared, "mesh")[:4] == ["other/link", "other/cover", "other/points", "arm0/link"]
    assert names(merged, "mesh") == ["other/link", "other/cover", "other/points"]
    assert names(merged, "material") == ["other/paint"]
    assert manifest(merged)["deduplicated"]
    assert manifest(merged)["merged"]["mesh"]["arm2/link"] == "other/link"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, prog_name="mjcompose")


def test_commands_know_what_is_shared(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    Path("recipe.yaml").write_text(f"recipe: 1\n{COPIES}")
    assert "merged 2 textures, 6 meshes, 2 hfields" in run("build", "recipe.yaml", "-o", "out.zip").output
    assert "3 of 3 parts compared with their sources and unchanged" in run("verify", "out.zip").output
    assert "the same" in run("diff", "recipe.yaml", "out.zip").output
    for name in ("arm0/link", "arm2/link"):
        told = run("explain", "recipe.yaml", f"mesh {name}").output
        assert "mesh arm0/link\n" in told and "shared with arm1/link, arm2/link\n" in told
    used = run("explain", "recipe.yaml", "geom arm2/link").output
    assert "the copies of the part share it\n      mesh  arm2/link → arm0/link" in used
    assert run("explain", "recipe.yaml", "texture arm2/link").exit_code == 1
