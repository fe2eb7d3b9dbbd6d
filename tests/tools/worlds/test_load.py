from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose.bundle.staging import manifest_beside, with_version
from mjcompose.bundle.write import write
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.worlds import load as module
from mjcompose.tools.worlds.load import Loaded, _compiled

MODEL = """<mujoco model="{name}">
  <worldbody>
    <geom size="0.1"/>
    <body name="base">
      <joint name="turn" axis="0 0 1" range="-90 90"/>
      <geom size="0.1"/>
      <camera name="eye" fovy="50"/>
    </body>
  </worldbody>
  <actuator><position name="turn" joint="turn" kp="5" ctrlrange="-1 1"/></actuator>
  <sensor><framepos name="where" objtype="body" objname="base"/></sensor>
</mujoco>"""
RECIPE = """recipe: 1
name: cell
attach:
  left: {model: ./arm.xml}
  right: {model: ./arm.xml, pos: [1, 0, 0], joint: free}
keyframe:
  bent: {qpos: {left/turn: 0.5rad}}
check: {weight: {expect: {attr: mass, range: [0.1, 100]}}}
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the same model as `cell/`, `cell.zip`, `cell.mjz` and `cell.mjb`."""
    folder = tmp_path_factory.mktemp("load")
    (folder / "arm.xml").write_text(MODEL.format(name="arm"))
    (folder / "cell.yaml").write_text(RECIPE)
    built = build(ModelRequest(folder / "cell.yaml"), Context(folder=folder))
    assert built is not None
    for name in ("cell/", "cell.zip", "cell.mjz", "cell.mjb"):
        write(built.bundle, f"{folder}/{name}", environment={})
    return folder


@pytest.fixture
def cell(written: Path, tmp_path: Path) -> Path:
    """The folder form, to be changed."""
    loaded = tmp_path / "cell"
    with zipfile.ZipFile(written / "cell.zip") as archive:
        archive.extractall(loaded)
    return loaded


def change(cell: Path, key: str, value: Any) -> None:
    file = cell / "manifest.json"
    data = json.loads(file.read_text())
    data[key] = value(data[key]) if callable(value) else value
    file.write_text(json.dumps(data))


@pytest.mark.parametrize("name", ["cell", "cell.zip", "cell.mjz", "cell.mjb"])
def test_every_form_gives_the_same(written: Path, name: str) -> None:
    model, manifest, index = mjcompose.load(written / name)
    assert isinstance(model, mujoco.MjModel)
    assert manifest.name == "cell"
    assert model.nq == index.qpos.size == 9
    assert manifest.checks[0].values == {"mass": pytest.approx(model.body_mass.sum())}


def test_positions_are_where_mujoco_has_them(written: Path) -> None:
    loaded = mjcompose.load(written / "cell.zip")
    model = loaded.model
    index = loaded.index
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, index.key["bent"])
    assert data.qpos[index.qpos["left/turn"]] == data.joint("left/turn").qpos[0] == 0.5
    assert list(data.qpos[index.qpos["right/"]]) == list(data.joint("right/").qpos)
    mujoco.mj_forward(model, data)
    assert list(data.sensordata[index.sensordata["right/where"]]) == [1, 0, 0]
    assert index.camera["right/eye"] == model.camera("right/eye").id
    assert index.body["left/base"] == model.body("left/base").id


def test_origins_units_and_limits_come_along(written: Path) -> None:
    index = mjcompose.load(written / "cell.zip").index
    assert index.qpos.origin("left/turn") == "arm.xml:5"
    assert index.qpos.units("right/") == ("m", "m", "m", *["quaternion"] * 4)
    assert index.qpos.limits("left/turn").tolist() == [[-np.pi / 2, np.pi / 2]]
    assert index.ctrl.units() == ("rad", "rad")
    assert index.ctrl.limits().tolist() == [[-1, 1], [-1, 1]]


def test_a_batch_is_indexed_like_one(written: Path) -> None:
    index = mjcompose.load(written / "cell.zip").index
    batch = np.arange(5 * 9).reshape(5, 9)
    assert batch[..., index.qpos["left/turn"]].shape == (5,)
    assert batch[..., index.qpos["right/"]].shape == (5, 7)
    assert batch[..., index.qpos["left/turn", "right/turn"]].tolist() == batch[:, [0, 8]].tolist()


def test_a_file_that_was_changed_is_an_error(cell: Path) -> None:
    model = cell / "model.xml"
    model.write_text(model.read_text().replace('kp="5"', 'kp="6"'))
    with pytest.raises(mjcompose.LoadError, match="`model.xml` in .* is not the file that its manifest lists"):
        mjcompose.load(cell)
    with pytest.warns(mjcompose.BundleWarning, match="is not the file"):
        loaded = mjcompose.load(cell, allow_changes=True)
    assert loaded.model.actuator("left/turn").gainprm[0] == 6


@pytest.mark.parametrize("name", ["cell", "cell.zip", "cell.mjb"])
def test_the_same_bytes_are_written_once(written: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """MuJoCo's cache knows meshes and textures by their paths: from another folder each of them is read again."""
    paths: list[Path] = []

    def compiled(given: Any, file: Path, shown: str) -> Any:
        paths.append(file)
        return _compiled(given, file, shown)

    monkeypatch.setattr(module, "_compiled", compiled)
    first, second = (mjcompose.load(written / name) for _ in range(2))
    assert paths[0] == paths[1]
    assert first.model is not second.model and first.manifest == second.manifest
    paths[0].write_text("<mujoco/>")  # in the folder of another process of this user
    assert mjcompose.load(written / name).model.nq == 9
    assert paths[2] != paths[0] and not paths[0].exists()
    paths[2].unlink()
    assert mjcompose.load(written / name).model.nq == 9


@pytest.mark.parametrize("form", ["cell", "cell.zip"])
def test_what_was_loaded_with_changes_is_an_error_the_next_time(cell: Path, tmp_path: Path, form: str) -> None:
    change(cell, "files", lambda files: files[1:])
    with zipfile.ZipFile(tmp_path / "cell.zip", "w") as archive:
        for file in cell.iterdir():
            archive.write(file, file.name)
    for _ in range(2):
        with pytest.warns(mjcompose.BundleWarning, match="does not list it"):
            mjcompose.load(tmp_path / form, allow_changes=True)
    with pytest.raises(mjcompose.LoadError, match="does not list it"):
        mjcompose.load(tmp_path / form)


def test_bundles_are_kept_only_so_far(written: Path, cell: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_KEPT_BYTES", 0)
    mjcompose.load(written / "cell")
    assert not module._kept


def test_threads_and_children_load_the_same_bundle(written: Path) -> None:
    with ThreadPoolExecutor(4) as pool:
        assert [each.model.nq for each in pool.map(mjcompose.load, [written / "cell"] * 12)] == [9] * 12
    if hasattr(os, "fork"):
        program = (
            f"import mjcompose, os, sys\nmjcompose.load({str(written / 'cell')!r})\n"
            "child = os.fork()\n"
            f"assert mjcompose.load({str(written / 'cell')!r}).model.nq == 9\n"
            "if child: sys.exit(os.waitpid(child, 0)[1] != 0)\n"
        )
        subprocess.run([sys.executable, "-W", "ignore", "-c", program], check=True)


def test_warnings_are_at_the_line_that_loads(cell: Path, tmp_path: Path) -> None:
    change(cell, "mujoco", "3.1.0")
    (tmp_path / "models.csv").write_text("model,path\ncell,cell\n")
    (listed,) = mjcompose.load_many(tmp_path)
    for load in (lambda: mjcompose.load(cell), listed.load):
        with pytest.warns(mjcompose.BundleWarning) as caught:
            load()
        assert [each.filename for each in caught] == [__file__]


def test_an_index_of_another_model_is_an_error(cell: Path) -> None:
    change(cell, "index", lambda index: {**index, "joints": index["joints"][::-1]})
    with pytest.raises(mjcompose.LoadError, match="the joints of the compiled .* are not the joints of its manifest"):
        mjcompose.load(cell)
    with pytest.warns(mjcompose.BundleWarning):
        assert mjcompose.load(cell, allow_changes=True).index.qpos["left/turn"] == 0


def test_another_mujoco_is_told(cell: Path) -> None:
    change(cell, "mujoco", "3.1.0")
    with pytest.warns(mjcompose.BundleWarning, match=rf"verified by MuJoCo 3\.1\.0, and this is {mujoco.__version__}"):
        assert isinstance(mjcompose.load(cell), Loaded)


def test_an_mjb_of_another_mujoco_is_an_error(written: Path, tmp_path: Path) -> None:
    copy = tmp_path / "cell.mjb"
    copy.write_bytes((written / "cell.mjb").read_bytes())
    with pytest.raises(mjcompose.LoadError, match="the manifest of `cell.mjb`"):
        mjcompose.load(copy)
    manifest = json.loads(manifest_beside(written / "cell.mjb").read_text())
    manifest_beside(copy).write_text(json.dumps({**manifest, "mujoco": "3.1.0"}))
    with pytest.raises(mjcompose.LoadError, match=r"compiled by MuJoCo 3\.1\.0"):
        mjcompose.load(copy)


def test_an_mjb_may_be_renamed_with_its_manifest(written: Path, tmp_path: Path) -> None:
    copy = tmp_path / "other.mjb"
    copy.write_bytes((written / "cell.mjb").read_bytes())
    manifest = manifest_beside(written / "cell.mjb").read_bytes()
    manifest_beside(copy).write_bytes(manifest)
    assert mjcompose.load(copy).index.qpos.names == mjcompose.load(written / "cell.mjb").index.qpos.names
    manifest_beside(copy).write_text(json.dumps({**json.loads(manifest), "model": "../other.mjb"}))
    with pytest.raises(mjcompose.LoadError, match="the manifest of .* cannot be read") as caught:
        mjcompose.load(copy)
    assert "`model`: `../other.mjb` is not a path in a bundle: it leads out of the bundle" in str(caught.value)


@pytest.mark.parametrize("name", ["nowhere", "nowhere.zip", "nowhere.mjb"])
def test_what_is_not_there_is_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(mjcompose.LoadError, match="the file .* does not exist") as caught:
        mjcompose.load(tmp_path / name)
    assert caught.value.diagnostics[0].code == "file-not-found"


def test_a_manifest_is_needed(cell: Path) -> None:
    (cell / "manifest.json").unlink()
    with pytest.raises(mjcompose.LoadError, match="has no `manifest.json`"):
        mjcompose.load(cell)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"manifest": 2}, "was written by a newer mjcompose: its format is 2, this one knows 1"),
        ({"manifest": 2, "more": []}, "was written by a newer mjcompose"),
        ({"more": []}, "`more` is not a key of a manifest"),
        ({"files": 3}, "`files`: input should be a valid array"),
    ],
)
def test_a_manifest_that_is_another_says_why(cell: Path, change: dict[str, Any], told: str) -> None:
    file = cell / "manifest.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | change))
    with pytest.raises(mjcompose.LoadError) as caught:
        mjcompose.load(cell)
    said = str(caught.value)
    assert told in said
    assert "pydantic" not in said and "validation error" not in said


@pytest.mark.parametrize(("text", "told"), [("{", "it is not JSON: EOF while parsing"), ("[]", "it is not a mapping")])
def test_a_manifest_that_is_none(cell: Path, text: str, told: str) -> None:
    (cell / "manifest.json").write_text(text)
    with pytest.raises(mjcompose.LoadError, match=told):
        mjcompose.load(cell)


def test_the_version_stands_in_the_name_where_it_is_asked_for() -> None:
    assert with_version("a.mjb") == "a.mjb"
    assert with_version("a-{mujoco}.mjb") == f"a-{mujoco.__version__}.mjb"


def test_importing_composer_imports_nothing_heavy() -> None:
    code = "import sys, mjcompose; print({'mujoco', 'numpy', 'pydantic', 'lxml', 'yaml'} & set(sys.modules))"
    root = Path(mjcompose.__file__).parents[1]
    command = [sys.executable, "-c", code]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    assert shown.stdout.strip() == "set()"
