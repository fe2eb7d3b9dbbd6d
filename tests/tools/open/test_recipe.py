"""`mjcompose.spec` and `mjcompose.model`: recipes as models of this process."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose.tools.open import recipe as opening

CELL = """\
recipe: 1
base: ./base.xml
params: {size: {default: 0.1, min: 0.01, max: 1}, kind: {default: box, choices: [box, sphere]}}
add:
  - {to: table, geom: {name: part, type: "${kind}", size: ["${size}", "${size}", "${size}"]}}
attach:
  arm: {model: ./arm.xml, site: flange}
randomize: {seed: 7, samples: 10, fields: {mass: {select: {geom: top}, attr: mass, uniform: [0.5, 2]}}}
"""
BASE = """\
<mujoco>
  <worldbody>
    <body name="table">
      <geom name="top" size=".1" mass="1"/>
      <site name="flange" pos="0 0 1"/>
    </body>
  </worldbody>
</mujoco>
"""
ARM = """\
<mujoco>
  <compiler meshdir="assets"/>
  <asset><mesh file="tetra.obj"/></asset>
  <worldbody>
    <body name="link"><joint name="j" axis="0 0 1"/><geom type="mesh" mesh="tetra" mass="1"/></body>
  </worldbody>
</mujoco>
"""
TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "tetra.obj").write_text(TETRA)
    for name, text in {"base.xml": BASE, "arm.xml": ARM, "cell.yaml": CELL}.items():
        (tmp_path / name).write_text(text)
    return tmp_path / "cell.yaml"


def builds(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The recipes that are built from now on."""
    seen: list[Path] = []
    build = opening.build
    monkeypatch.setattr(
        opening,
        "build",
        lambda request, *rest, **named: (seen.append(request.recipe), build(request, *rest, **named))[1],
    )
    return seen


def test_is_the_model_that_a_build_writes(cell: Path, tmp_path: Path) -> None:
    from mjcompose.bundle.write import write
    from mjcompose.pipeline.stages import ModelRequest, build
    from mjcompose.sources.context import Context

    built = build(ModelRequest(cell), Context())
    assert built is not None
    write(built.bundle, tmp_path / "out", environment={})
    written = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))
    for model in (mjcompose.model(cell), mjcompose.spec(cell).compile(), mjcompose.model(cell, verified=True)):
        assert [model.geom(i).name for i in range(model.ngeom)] == [written.geom(i).name for i in range(written.ngeom)]
        for name in ("body_mass", "body_pos", "geom_size", "mesh_vert"):
            np.testing.assert_array_equal(getattr(model, name), getattr(written, name))


def test_takes_values_cells_and_samples(cell: Path) -> None:
    model = mjcompose.model(cell, size=np.float64(0.25), kind="sphere")
    assert model.geom("part").size[0] == 0.25 and model.geom("part").type == mujoco.mjtGeom.mjGEOM_SPHERE
    assert mjcompose.model(cell, sample=1).body("table").mass != mjcompose.model(cell).body("table").mass


def test_a_cell_has_its_values_and_samples(cell: Path) -> None:
    cell.write_text(CELL + "matrix: {axes: {kind: [box, sphere]}, name: 'cell-${kind}'}\n")
    model = mjcompose.model(cell, cell="cell-sphere")
    assert model.geom("part").type == mujoco.mjtGeom.mjGEOM_SPHERE
    sample = mjcompose.model(cell, cell="cell-sphere", sample=2)
    assert sample.geom("part").type == mujoco.mjtGeom.mjGEOM_SPHERE
    assert sample.body("table").mass != model.body("table").mass
    assert mjcompose.model(cell, cell="cell-sphere-s0002").body("table").mass == sample.body("table").mass
    for wrong in (
        {"cell": "cell-cube"},
        {"cell": "cell-box", "sample": 11},
        {"sample": 1},
        {"cell": "cell-box", "kind": "box"},
    ):
        with pytest.raises(mjcompose.BuildError):
            mjcompose.spec(cell, **wrong)


def test_a_wrong_value_is_an_error_with_all_diagnostics(cell: Path) -> None:
    with pytest.raises(mjcompose.BuildError, match=r"size=:1:1: error\[.*") as caught:
        mjcompose.spec(cell, size=7)
    assert len(caught.value.diagnostics) == 1
    assert len(caught.traceback) == 2, "the line of the program, and the function that it calls"
    with pytest.raises(TypeError, match="size is of type `object`; a recipe has no such values"):
        mjcompose.spec(cell, size=object())
    with pytest.raises(mjcompose.BuildError, match="unknown"):
        mjcompose.spec(cell, sise=0.2)


def test_is_built_again_only_if_a_file_of_it_changed(cell: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for path in [cell, *cell.parent.glob("*.xml"), *cell.parent.glob("assets/*")]:
        os.utime(path, (1, 1))
    seen = builds(monkeypatch)
    for _ in range(3):
        mjcompose.spec(cell)
    assert len(seen) == 1
    arm = cell.with_name("arm.xml")
    arm.write_text(ARM.replace('mass="1"', 'mass="3"'))
    assert mjcompose.model(cell).body("arm/link").mass == 3 and len(seen) == 2
    (cell.parent / "assets" / "tetra.obj").write_text(TETRA.replace("v 1 0 0", "v 2 0 0"))
    assert mjcompose.model(cell).mesh_vert.max() > 1 or len(seen) == 3
    assert len(seen) == 3


def test_a_change_that_keeps_size_and_time_is_seen(cell: Path) -> None:
    arm = cell.with_name("arm.xml")
    os.utime(arm, (1, 1))
    mjcompose.spec(cell)
    before = arm.stat()
    arm.write_text(ARM.replace('mass="1"', 'mass="4"'))
    os.utime(arm, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert (arm.stat().st_size, arm.stat().st_ino) == (before.st_size, before.st_ino)
    assert mjcompose.model(cell).body("arm/link").mass == 4


def test_a_mesh_that_changes_within_a_second_is_read_again(cell: Path) -> None:
    mesh = cell.parent / "assets" / "tetra.obj"
    os.utime(mesh, (1, 1))
    before = mjcompose.model(cell).mesh_vert
    mesh.write_text(TETRA.replace("v 1 0 0", "v 7 0 0"))
    os.utime(mesh, (1, 1))
    for recipe in (cell, {"recipe": 1, "extends": "./cell.yaml"}):
        after = mjcompose.model(recipe, **({} if recipe is cell else {"base_dir": cell.parent})).mesh_vert
        assert np.ptp(after, axis=0).max() > 3 * np.ptp(before, axis=0).max()


def test_is_built_again_if_a_variable_names_another_robot(
    cell: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell.write_text("recipe: 1\nbase: menagerie:agilex_piper/piper\n")
    for number in (1, 2):
        robot = tmp_path / f"robots{number}" / "agilex_piper"
        robot.mkdir(parents=True)
        (robot / "piper.xml").write_text(BASE.replace('mass="1"', f'mass="{number}"'))
        monkeypatch.setenv("MENAGERIE_ROOT", str(robot.parent))
        assert mjcompose.model(cell).body("table").mass == number


def test_warnings_are_at_the_line_of_the_program(cell: Path) -> None:
    cell.write_text(CELL + "allow: [unstable]\n")
    with pytest.warns(mjcompose.RecipeWarning, match="unused-allow") as caught:
        mjcompose.spec(cell, verified=True)
    assert caught[0].filename == __file__


def test_threads_share_one_build(cell: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for path in [cell, *cell.parent.glob("*.xml"), *cell.parent.glob("assets/*")]:
        os.utime(path, (1, 1))
    seen = builds(monkeypatch)
    with ThreadPoolExecutor(8) as pool:
        models = list(pool.map(lambda _: mjcompose.model(cell), range(16)))
    assert len(seen) == 1 and {model.nbody for model in models} == {3}


def test_what_is_remembered_has_a_limit(cell: Path) -> None:
    for number in range(opening._MOST + 5):
        mjcompose.spec(cell, size=0.1 + number / 1000)
    assert len(opening._opened) == opening._MOST


def test_a_model_that_mujoco_refuses_has_the_line_of_the_recipe(tmp_path: Path) -> None:
    """Without `verified`, MuJoCo in this process is the first to see the model."""
    for name, text, function in (
        ("massless", "add: [{to: world, body: {name: ghost, freejoint: {}}}]", mjcompose.model),
        ("sizeless", "add: [{to: world, geom: {type: box, size: [1, 1]}}]", mjcompose.model),
    ):
        recipe = tmp_path / f"{name}.yaml"
        recipe.write_text(f"recipe: 1\n{text}\n", encoding="utf-8")
        with pytest.raises(mjcompose.BuildError, match=rf"{name}\.yaml:2:\d+: error\[mujoco-rejects\]"):
            function(recipe)
