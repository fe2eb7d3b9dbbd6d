"""Height fields that mjcompose makes: MuJoCo finds the heights where they are said to be, and every machine the same."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.bundle.bundle import Bundle
from mjcompose.compose.terrain import height_field
from mjcompose.language.terrain import KINDS, Terrain
from mjcompose.mujoco.heights import HeightField
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.matrix import read_matrix
from mjcompose.sources.context import Context

SMALL = "size: [2.4, 2], cell: 0.1, seed: 3, border: 0.2, "
# By kind: the settings that fit into so small a place.
FITTING = {
    "rough": "octaves: 3",
    "stairs": "platform: 0.6",
    "slope": "platform: 0.6",
    "stones": "platform: 0.6, gap: [0.1, 0.3]",
    "gaps": "platform: 0.6, gap: [0.1, 0.3], every: 0.4",
    "waves": "waves: 2",
    "boxes": "platform: 0.6",
}


def built(folder: Path, recipe: str, **options: float) -> Bundle:
    (folder / "r.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "r.yaml"), context)
    assert done is not None, [each.message for each in context.sink.errors]
    assert not context.sink.diagnostics
    return done.bundle


def with_ground(terrain: str, geom: str = "", rest: str = "") -> str:
    return (
        f"asset: {{hfield: {{ground: {{terrain: {{{terrain}}}}}}}}}\n"
        f"add:\n  - {{to: world, geom: {{name: ground, type: hfield, hfield: ground{geom}}}}}\n{rest}"
    )


def model_of(bundle: Bundle) -> mujoco.MjModel:
    files = {name: bundle.files[name] for name in bundle.files if name.startswith("assets/")}
    return mujoco.MjModel.from_xml_string(bundle.files["model.xml"].decode(), files)


def terrain(**keys: object) -> HeightField:
    return height_field(Terrain.model_validate(keys))


def heights_below(model: mujoco.MjModel, points: np.ndarray, down: tuple[float, ...] = (0, 0, -1)) -> np.ndarray:
    """The distance from each point to the ground, by MuJoCo's rays."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found = np.zeros(1, np.int32)
    normal = np.zeros(3)
    arguments = (found, normal) if "normal" in str(mujoco.mj_ray.__doc__) else (found,)
    return np.array([mujoco.mj_ray(model, data, each, np.array(down), None, 1, -1, *arguments) for each in points])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("difficulty", [0.0, 0.7])
def test_mujoco_finds_every_height_of_the_array(tmp_path: Path, kind: str, difficulty: float) -> None:
    text = f"kind: {kind}, {SMALL}difficulty: {difficulty}, {FITTING[kind]}"
    model = model_of(built(tmp_path, with_ground(text, ", pos: [1, 2, 3]")))
    heights = terrain(**yaml.safe_load(f"{{{text}}}")).heights
    rows, columns = heights.shape
    assert (rows, columns) == (21, 25)
    # Not on the edge of the field, and beside the corners of triangles: a ray may miss both.
    places = [(row, column) for row in range(1, rows - 1, 3) for column in range(1, columns - 1, 2)]
    points = np.array([(1 + (column - 12) * 0.1 + 1e-6, 2 + (row - 10) * 0.1 + 2e-6, 13.0) for row, column in places])
    expected = np.array([heights[place] for place in places])
    assert np.allclose(10 - heights_below(model, points), expected, atol=5e-5)


def test_heights_are_along_the_geom(tmp_path: Path) -> None:
    bundle = built(
        tmp_path, with_ground(f"kind: stones, {SMALL}{FITTING['stones']}", ", pos: [1, 2, 3], euler: [0, 90deg, 0]")
    )
    assert heights_below(model_of(bundle), np.array([[11.0, 2.0, 3.0]]), (-1, 0, 0)) == pytest.approx([10.0])


def test_a_class_gives_the_pose_and_the_ground(tmp_path: Path) -> None:
    recipe = (
        "default: {earth: {geom: {type: hfield, hfield: ground, pos: [0, 0, 2]}}}\n"
        f"asset: {{hfield: {{ground: {{terrain: {{kind: gaps, {SMALL}{FITTING['gaps']}}}}}}}}}\n"
        "add: [{to: world, geom: {class: earth}}]\n"
    )
    assert heights_below(model_of(built(tmp_path, recipe)), np.array([[0.0, 0.0, 12.0]])) == pytest.approx([10.0])


def test_the_ground_of_a_part(tmp_path: Path) -> None:
    (tmp_path / "land.yaml").write_text("recipe: 1\n" + with_ground(f"kind: gaps, {SMALL}{FITTING['gaps']}"))
    attach = "attach: {a: {model: ./land.yaml, pos: [5, 0, 1]}, b: {model: ./land.yaml, pos: [9, 0, 2]}}\n"
    bundle = built(tmp_path, attach)
    assert heights_below(model_of(bundle), np.array([[5.0, 0, 11], [9, 0, 12]])) == pytest.approx([10.0, 10.0])
    assert list(json.loads(bundle.files["terrain.json"])) == ["a/ground", "b/ground"]


def test_the_bundle_says_where_the_patches_of_a_grid_are(tmp_path: Path) -> None:
    columns = ", ".join(f"{{kind: {kind}, {FITTING[kind]}}}" for kind in KINDS)
    bundle = built(tmp_path, with_ground(f"{SMALL}rows: 3, difficulty: [0.2, 1], columns: [{columns}]"))
    facts = json.loads(bundle.files["terrain.json"])["ground"]
    assert facts["kinds"] == list(KINDS)
    assert facts["difficulties"] == [0.2, 0.6, 1]
    origins = np.array(facts["origins"])
    assert origins.shape == (3, len(KINDS), 3)
    assert origins[0, 0, :2].tolist() == [-7.2, -2.0]
    assert origins[2, 6, :2].tolist() == [7.2, 2.0]
    above = origins.reshape(-1, 3) + np.array([1e-6, 2e-6, 10])
    assert np.allclose(heights_below(model_of(bundle), above), 10, atol=5e-5)


def test_a_row_is_the_field_of_its_level_alone() -> None:
    grid = terrain(columns=["stairs", {"kind": "slope", "down": True}], rows=3, size=[8, 8], cell=0.1)
    alone = terrain(kind="slope", down=True, difficulty=0.5, size=[8, 8], cell=0.1)
    assert np.array_equal(grid.heights[80:160, 80:160], alone.heights[:80, :80])


@pytest.mark.parametrize("kind", KINDS)
def test_difficulty_changes_the_ground_and_0_is_easier_than_1(kind: str) -> None:
    easy, middle, hard = (terrain(kind=kind, difficulty=each).heights for each in (0, 0.5, 1))
    assert not np.array_equal(easy, middle)
    spread = [np.abs(np.diff(each, axis=1)).max() for each in (easy, middle, hard)]
    share = [np.mean(each < -0.5) for each in (easy, middle, hard)]
    assert sorted(spread) == spread if kind not in ("stones", "gaps") else sorted(share) == share


@pytest.mark.parametrize("kind", ["rough", "stones", "boxes"])
def test_another_seed_gives_other_heights(kind: str) -> None:
    assert not np.array_equal(terrain(kind=kind, seed=1).heights, terrain(kind=kind, seed=2).heights)


def test_every_number_of_a_kind_counts() -> None:
    for kind, keys in KINDS.items():
        usual = terrain(kind=kind, difficulty=0.4).heights
        for key, value in keys.items():
            other = not value if isinstance(value, bool) else value[-1] if isinstance(value, tuple) else value / 2
            changed = terrain(kind=kind, difficulty=0.4, **{key: int(other) if key == "octaves" else other}).heights
            assert not np.array_equal(usual, changed), (kind, key)


def test_stairs_have_the_rise_and_the_tread_that_are_written() -> None:
    heights = terrain(kind="stairs", rise=0.1, tread=0.4, platform=1, size=[8, 8], border=0).heights
    middle = heights[80]
    steps = np.flatnonzero(np.diff(middle[80:])) + 1
    assert np.allclose(np.diff(middle[80:])[steps - 1], -0.1)
    assert steps.tolist() == [11, *range(19, 80, 8)]  # half of the platform, and then a step for each tread
    assert middle[0] == 0


def test_gaps_and_stones_have_the_width_that_is_written() -> None:
    row = terrain(kind="gaps", gap=0.05, every=1, platform=1.5, size=[8, 8], border=0).heights[80, 80:]
    assert np.flatnonzero(row < 0).tolist() == [16, 37, 58, 79]
    flat = terrain(kind="stones", stone=0.5, gap=0.1, jitter=0, platform=0.1, size=[8, 8], border=0).heights
    assert (np.flatnonzero(flat[0] < 0)[:4]).tolist() == [10, 11, 22, 23]


def test_waves_are_sines() -> None:
    found = terrain(kind="waves", height=0.4, waves=2, size=[8, 4], cell=0.1, border=0).heights
    x, y = np.meshgrid(np.linspace(-4, 4, 81), np.linspace(-2, 2, 41))
    assert np.abs(found - 0.1 * (np.sin(np.pi * x / 2) + np.cos(np.pi * y / 2))).max() < 1e-6


# The files of another machine must be the same to the byte.
HASHES = {
    "rough": "d39d4063726c5745",
    "stairs": "a0171c4ce0158135",
    "slope": "44b41fc6b176558d",
    "stones": "dd53a0b02b0f7183",
    "gaps": "5e4773138b61b62c",
    "waves": "be44e95d08a1b623",
    "boxes": "bb748225a138864f",
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_machine_writes_the_same_bytes(kind: str) -> None:
    content = terrain(kind=kind, seed=3, difficulty=0.6).content
    assert np.frombuffer(content[:8], "<i4").tolist() == [161, 161]
    assert len(content) == 8 + 4 * 161 * 161
    assert hashlib.sha256(content).hexdigest()[:16] == HASHES[kind]


def test_the_bytes_do_not_depend_on_the_process() -> None:
    """NumPy picks its functions by the processor: without the fast ones, the bytes are the same."""
    program = (
        "import hashlib; from mjcompose.compose.terrain import height_field; from mjcompose.language.terrain import KINDS, Terrain\n"
        "for kind in KINDS: print(hashlib.sha256(height_field(Terrain.model_validate(dict(kind=kind, seed=3, difficulty=0.6))).content)"
        ".hexdigest()[:16])"
    )
    known = np.show_config(mode="dicts")["SIMD Extensions"]
    features = " ".join(known.get("found", ()))
    environment = {**os.environ, "NPY_DISABLE_CPU_FEATURES": features, "PYTHONHASHSEED": "1"}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", program], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [*HASHES.values()]


def test_a_value_of_a_matrix_is_a_terrain_of_its_own(tmp_path: Path) -> None:
    recipe = (
        "params: {level: 0, kind: {default: stairs}}\n"
        + with_ground('kind: "${kind}", size: [4, 4], difficulty: "${level}"')
        + "matrix: {axes: {kind: [stairs, boxes], level: [0, 0.5]}}\n"
    )
    (tmp_path / "r.yaml").write_text(f"recipe: 1\n{recipe}")
    found = set()
    context = Context(environment={}, folder=tmp_path)
    matrix = read_matrix(tmp_path / "r.yaml", context)
    assert matrix is not None
    for cell in matrix.cells:
        done = build(ModelRequest(tmp_path / "r.yaml", given=cell.given, name=cell.name), context)
        assert done is not None, context.sink.diagnostics
        (file,) = (name for name in done.bundle.files if name.endswith(".hfield"))
        found.add((done.bundle.files[file], done.bundle.files["model.xml"]))
    assert len(found) == 4


def test_a_robot_stands_on_it(tmp_path: Path) -> None:
    (tmp_path / "bot.xml").write_text(
        '<mujoco><worldbody><body name="trunk" pos="0 0 .4"><freejoint name="f"/><geom type="box" size=".2 .1 .05" mass="5"/>'
        + "".join(
            f'<geom type="capsule" size=".02" fromto="{x} {y} 0 {x} {y} -.2"/>'
            for x in (-0.2, 0.2)
            for y in (-0.1, 0.1)
        )
        + "</body></worldbody></mujoco>"
    )
    recipe = with_ground("kind: stairs, seed: 1, size: [4, 4], down: true", rest="attach: {bot: {model: ./bot.xml}}\n")
    model = model_of(built(tmp_path, recipe))
    data = mujoco.MjData(model)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert data.qpos[2] == pytest.approx(0.22, abs=5e-3)
    assert np.abs(data.qvel).max() < 1e-2


def errors(folder: Path, recipe: str) -> list[Diagnostic]:
    (folder / "r.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    assert build(ModelRequest(folder / "r.yaml"), context) is None
    return list(context.sink.errors)


def test_a_limit_bounds_the_heights(tmp_path: Path) -> None:
    (error,) = errors(tmp_path, with_ground("kind: stairs, size: [800, 800]"))
    assert error.code == "limit-exceeded"
    assert error.message == "`terrain` has 16001 × 16001 heights; 4000000 are allowed"
