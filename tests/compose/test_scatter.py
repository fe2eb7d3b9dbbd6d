"""Copies at random places on a surface: MuJoCo finds no overlap, and every machine finds the same places."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.compose.compose import Composer
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.plan import Plan
from mjcompose.sources.context import Context
from mjcompose.tree.unit import Unit

FILES = {
    "table.xml": """<mujoco model="table"><worldbody><body name="table">
      <geom name="top" type="box" size=".3 .2 .02" pos="0 0 .7"/><geom name="leg" type="box" size=".02 .02 .34" pos="0 0 .34"/>
      <geom name="post" size=".03 .1" type="cylinder" pos=".1 0 .82"/><site name="side" pos="0 .1 .72" euler="0 90 0"/>
    </body></worldbody></mujoco>""",
    "mug.xml": """<mujoco model="mug"><worldbody><body name="mug"><freejoint name="free"/>
      <geom type="cylinder" size=".03 .05" pos="0 0 .05"/><geom type="capsule" size=".005 .02" pos=".035 0 .05"/>
    </body></worldbody></mujoco>""",
    "block.xml": """<mujoco model="block"><asset><mesh name="m" vertex="0 0 0 .06 0 0 0 .06 0 0 0 .04 .06 .06 .02"/></asset>
      <worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>""",
    "arm.xml": """<mujoco model="arm"><worldbody><body name="link" pos="0 0 .75"><joint name="j" axis="0 0 1"/>
      <geom name="rod" type="capsule" fromto="0 0 0 .4 0 0" size=".04"/></body></worldbody>
      <keyframe><key name="home" qpos="1.5707963"/></keyframe></mujoco>""",
    "hills.xml": """<mujoco model="hills"><asset><hfield name="h" nrow="3" ncol="3" size="1 1 .1 .1" elevation="0 1 0 1 .4 1 0 1 0"/>
      <mesh name="m" vertex="-1 -1 0 1 -1 0 -1 1 0 1 1 0 0 0 .1"/></asset><worldbody>
      <geom name="hills" type="hfield" hfield="h" pos="0 4 0"/><geom name="ramp" type="box" size=".5 .5 .01" pos="3 0 0" euler="0 15 0"/>
      <geom name="cone" type="mesh" mesh="m" pos="0 -4 0"/><geom name="floor" type="plane" size="1 1 1" pos="5 5 0"/>
    </worldbody></mujoco>""",
}


def built(folder: Path, recipe: str) -> bytes | list[Diagnostic]:
    for name, text in {**FILES, "r.yaml": f"recipe: 1\nattach:\n  table: {{model: ./table.xml}}\n{recipe}"}.items():
        (folder / name).write_text(text)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "r.yaml"), context)
    return list(context.sink.errors) if done is None else done.bundle.files["model.xml"]


def model_of(folder: Path, recipe: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    found = built(folder, recipe)
    assert isinstance(found, bytes), found
    model = mujoco.MjModel.from_xml_string(found.decode())
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def scattered(part: str, scatter: str, rest: str = "") -> str:
    return f"  c: {{model: ./{part}.xml, replicate: [{{scatter: {{{scatter}}}}}]{rest}}}\n"


def of_copies(model: mujoco.MjModel, data: mujoco.MjData) -> dict[str, list[int]]:
    """The geoms of each copy: those with its body, or of `block`, which has none, by their order."""
    copies: dict[str, list[int]] = {}
    for geom in range(model.ngeom):
        name = model.body(model.body_rootid[model.geom_bodyid[geom]]).name
        if name.startswith("c") and "/" in name:
            copies.setdefault(name.partition("/")[0], []).append(geom)
    return copies


@pytest.mark.parametrize("upright", ["true", "false"])
def test_copies_keep_their_distance_and_lie_on_the_surface(tmp_path: Path, upright: str) -> None:
    scatter = f"count: 8, over: {{geom: table/top}}, clearance: 1cm, seed: 3, upright: {upright}"
    model, data = model_of(tmp_path, scattered("mug", scatter))
    copies = of_copies(model, data)
    top = model.geom("table/top").id
    others = [model.geom(name).id for name in ("table/leg", "table/post")]
    assert len(copies) == 8

    def apart(one: list[int], other: list[int]) -> float:
        return min(mujoco.mj_geomDistance(model, data, a, b, 1, None) for a in one for b in other)

    assert all(apart(*pair) > 0.01 - 1e-6 for pair in itertools.combinations(copies.values(), 2))
    for name, geoms in copies.items():
        assert abs(apart(geoms, [top])) < 3e-5
        assert apart(geoms, others) > -1e-5
        x, y, _ = data.xpos[model.body(f"{name}/mug").id]
        assert abs(x) < 0.3 and abs(y) < 0.2
        up = data.xmat[model.body(f"{name}/mug").id].reshape(3, 3)[2, 2]
        assert (up == pytest.approx(1)) == (upright == "true")
    middles = np.array([data.xpos[model.body(f"{name}/mug").id, :2] for name in copies])
    assert len(np.unique(middles.round(3), axis=0)) == 8


def test_another_seed_and_a_longer_row(tmp_path: Path) -> None:
    """The first copies stay where they are if others are added; another seed moves all."""

    def places(count: int, seed: int) -> list[list[float]]:
        model, data = model_of(tmp_path, scattered("mug", f"count: {count}, over: table/top, seed: {seed}"))
        return [list(data.xpos[model.body(f"c{n}/mug").id]) for n in range(count)]

    five = places(5, 1)
    assert places(7, 1)[:5] == five
    assert all(a != b for a, b in zip(five, places(5, 2), strict=True))


@pytest.mark.parametrize(
    ("joint", "place"),
    [
        ("", ""),
        (", joint: none", ""),
        (", joint: free", ", site: table/side"),
        (", joint: mocap, euler: [90deg, 0, 0]", ""),
    ],
)
def test_any_joint_place_and_orientation(tmp_path: Path, joint: str, place: str) -> None:
    """The pose in the world does not depend on the place that carries the part, except for its orientation."""
    model, data = model_of(tmp_path, scattered("block", "count: 3, over: table/top, clearance: 2mm", joint + place))
    geoms = [geom for geom in range(model.ngeom) if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH]
    top = model.geom("table/top").id
    assert len(geoms) == 3
    for geom in geoms:
        assert abs(mujoco.mj_geomDistance(model, data, geom, top, 1, None)) < 3e-5
    for one, other in itertools.combinations(geoms, 2):
        assert mujoco.mj_geomDistance(model, data, one, other, 1, None) > 0.002 - 1e-6


@pytest.mark.parametrize("over", ["geom: h/hills", "geom: h/ramp", "geom: h/cone", "geom: h/floor", "site: spot"])
def test_any_surface(tmp_path: Path, over: str) -> None:
    extra = "  h: {model: ./hills.xml}\n"
    recipe = scattered("mug", f"count: 4, over: {{{over}}}, clearance: 1mm") + extra
    recipe += "add: [{to: world, site: {name: spot, type: ellipsoid, size: [.3, .2, .05], pos: [8, 0, 1]}}]\n"
    model, data = model_of(tmp_path, recipe)
    mujoco.mj_forward(model, data)
    mugs = {geom for geoms in of_copies(model, data).values() for geom in geoms}
    assert len(mugs) == 8
    for contact in data.contact:
        assert contact.dist > -2e-5
    for name in (f"c{n}/mug" for n in range(4)):
        x, y, z = data.xpos[model.body(name).id]
        center = {"hills": (0, 4), "ramp": (3, 0), "cone": (0, -4), "floor": (5, 5), "spot": (8, 0)}[
            over.rpartition("/")[2].rpartition(" ")[2]
        ]
        assert abs(x - center[0]) < 1 and abs(y - center[1]) < 1 and -0.2 < z < 1.1


def test_the_keyframe_in_which_nothing_overlaps(tmp_path: Path) -> None:
    arm = "  arm: {model: ./arm.xml}\n"

    def hits(key: str) -> set[str]:
        recipe = scattered("mug", f"count: 9, over: table/top, seed: 2{key}") + arm
        model, data = model_of(tmp_path, recipe)
        found = set()
        for name in ("reference", "home"):
            mujoco.mj_resetData(model, data)
            if name == "home":
                mujoco.mj_resetDataKeyframe(model, data, 0)
            mujoco.mj_forward(model, data)
            pair = {model.geom("arm/rod").id, *(geom for geoms in of_copies(model, data).values() for geom in geoms)}
            found |= {name for contact in data.contact if pair.issuperset(contact.geom) and contact.dist < 0}
        return found

    assert "reference" not in hits("")
    assert "home" not in hits(", key: home")


@pytest.mark.since("3.12", "boxes on a box tremble and never come to rest")
def test_settled_copies_stay(tmp_path: Path) -> None:
    model, data = model_of(
        tmp_path, scattered("block", "count: 4, over: table/top, upright: false, settle: 2s", ", joint: free")
    )
    before = data.xpos.copy()
    for _ in range(500):
        mujoco.mj_step(model, data)
    assert np.abs(data.xpos - before).max() < 2e-3
    assert np.abs(data.qvel).max() < 0.05


def test_two_parts_and_a_nested_recipe(tmp_path: Path) -> None:
    """The copies of a later part keep their distance from those of an earlier one, also in a nested recipe."""
    rows = [
        scattered("mug", "count: 4, over: table/top, clearance: 1cm"),
        scattered("block", "count: 4, over: table/top, clearance: 1cm", ", joint: free").replace("c:", "d:"),
    ]
    (tmp_path / "inner.yaml").write_text("recipe: 1\nattach:\n  table: {model: ./table.xml}\n" + "".join(rows))
    model, data = model_of(tmp_path, "  in: {model: ./inner.yaml, pos: [3, 0, 0], euler: [0, 0, 40deg]}\n")
    movable = [geom for geom in range(model.ngeom) if model.body_dofnum[model.body_rootid[model.geom_bodyid[geom]]]]
    assert len(movable) == 12
    for one, other in itertools.combinations(movable, 2):
        if model.geom_bodyid[one] != model.geom_bodyid[other]:
            assert mujoco.mj_geomDistance(model, data, one, other, 1, None) > 0.01 - 1e-6


@pytest.mark.slow
@pytest.mark.since("3.12", "boxes on a box tremble and never come to rest")
@pytest.mark.parametrize("tunables", ["", "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-FMA4"])
def test_the_same_bytes_on_another_processor(tmp_path: Path, tunables: str) -> None:
    """Without fused operations, the C library rounds in another way in our code; MuJoCo's own bits stay the same.

    `tests/mujoco/test_scatter.py` has noise in the bits of MuJoCo.
    """
    scatter = "count: 6, over: {geom: table/top}, clearance: 1cm, upright: false, settle: 2s"
    first = built(tmp_path, scattered("block", scatter, ", joint: free"))
    program = "import pathlib, sys; sys.path.insert(0, sys.argv[2]); from compose.test_scatter import built, scattered;"
    program += (
        "sys.stdout.buffer.write(built(pathlib.Path(sys.argv[1]), scattered('block', sys.argv[3], ', joint: free')))"
    )
    environment = {**os.environ, "GLIBC_TUNABLES": tunables}
    tests = str(Path(__file__).parents[1])
    again = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path), tests, scatter], env=environment, capture_output=True, check=True
    )
    assert again.stdout == first


def test_a_drawn_seed_scatters_each_sample(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nparams: {layout: 0}\nattach:\n  table: {model: ./table.xml}\n"
        + scattered("mug", "count: 3, over: table/top, seed: '${layout}'")
        + "randomize: {seed: 1, samples: 3, fields: {layout: {param: layout, integers: [0, 1000000]}}}\n"
    )
    models = [
        build(ModelRequest(tmp_path / "r.yaml", sample=n), Context(environment={}, folder=tmp_path)) for n in range(4)
    ]
    assert len({each.bundle.files["model.xml"] for each in models if each}) == 4


def test_each_recipe_is_composed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However many recipes around it scatter copies, the sources of a recipe are composed once."""
    scatter = "replicate: [{scatter: {count: 1, over: {geom: %s}, clearance: 1cm, seed: %d}}]"
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    inner = "table.xml"
    top = "m/top"
    for level in range(3):
        mug = f"mug: {{model: ./mug.xml, {scatter % (top, level)}}}"
        (tmp_path / f"{level}.yaml").write_text(f"recipe: 1\nattach:\n  m: {{model: ./{inner}}}\n  {mug}\n")
        inner = f"{level}.yaml"
        top = f"m/{top}"
    composed: Counter[str] = Counter()
    plain = Composer._units

    def counted(self: Composer, plan: Plan, is_fixed: bool) -> list[Unit | None] | None:
        composed[plan.path.name] += 1
        return plain(self, plan, is_fixed)

    monkeypatch.setattr(Composer, "_units", counted)
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(tmp_path / "2.yaml"), context) is not None, context.sink.diagnostics
    assert composed == {"0.yaml": 1, "1.yaml": 1, "2.yaml": 1}
