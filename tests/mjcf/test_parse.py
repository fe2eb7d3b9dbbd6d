from __future__ import annotations

import hashlib
import io
import os
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError


@pytest.fixture
def both(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> mjcf.RootElement:
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    return arm


def files(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_a_folder_loads_from_anywhere(both: mjcf.RootElement, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "deep" / "out"
    mjcf.export_with_assets(both, out)
    assert files(out) == ["assets/arm/shell.stl", "assets/gripper/shell.stl", "model.xml"]
    (tmp_path / "moved").mkdir()
    out.rename(tmp_path / "moved" / "here")
    monkeypatch.chdir(tmp_path)
    model = mujoco.MjModel.from_xml_path("moved/here/model.xml")
    assert model.nmesh == 2 and model.body("gripper/palm").id > 0


def test_equal_files_are_stored_once(both: mjcf.RootElement, folder: Path, tmp_path: Path) -> None:
    (folder / "gripper" / "shell.stl").write_bytes((folder / "arm" / "meshes" / "shell.stl").read_bytes())
    mjcf.export_with_assets(both, tmp_path / "out", "robot.xml")
    assert files(tmp_path / "out") == ["assets/arm/shell.stl", "robot.xml"]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "robot.xml"))
    assert model.mesh("gripper/shell").id == 1


def test_other_files_stay_and_older_ones_are_replaced(both: mjcf.RootElement, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "notes.txt").write_text("mine")
    mjcf.export_with_assets(both, f"{out}/")
    first = (out / "model.xml").read_bytes()
    both.option.timestep = 0.001
    mjcf.export_with_assets(both, out)
    assert (out / "notes.txt").read_text() == "mine" and (out / "model.xml").read_bytes() != first
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_zip_is_a_bundle_that_mujoco_opens(both: mjcf.RootElement, tmp_path: Path) -> None:
    mjcf.export_with_assets_as_zip(both, tmp_path / "a.zip")
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert archive.namelist() == ["model.xml", "assets/arm/shell.stl", "assets/gripper/shell.stl"]
    assert mujoco.MjSpec.from_zip(str(tmp_path / "a.zip")).compile().nmesh == 2


def test_the_same_model_gives_the_same_bytes(
    both: mjcf.RootElement, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mjcf.export_with_assets_as_zip(both, tmp_path / "a.zip")
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    os.utime(tmp_path / "arm" / "meshes" / "shell.stl", (0, 0))
    mjcf.export_with_assets_as_zip(both, tmp_path / "b.zip")
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


def test_nothing_is_left_of_an_export_that_fails(both: mjcf.RootElement, folder: Path, tmp_path: Path) -> None:
    (folder / "gripper" / "shell.stl").unlink()
    with pytest.raises(mjcf.MjcfError, match="asset-missing.*shell.stl"):
        mjcf.export_with_assets(both, tmp_path / "out" / "inner")
    with pytest.raises(mjcf.MjcfError, match="asset-missing.*shell.stl"):
        mjcf.export_with_assets_as_zip(both, tmp_path / "out" / "x.zip")
    assert not (tmp_path / "out").exists()


def test_what_cannot_be_written_is_told(both: mjcf.RootElement, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(mjcf.MjcfError, match="cannot write"):
        mjcf.export_with_assets(both, tmp_path / "file")
    with pytest.raises(mjcf.MjcfError, match="cannot write"):
        mjcf.export_with_assets(both, tmp_path / "file" / "out")
    with pytest.raises(mjcf.MjcfError, match="a folder of that name"):
        mjcf.export_with_assets_as_zip(both, tmp_path)
    with pytest.raises(mjcf.MjcfError, match="MuJoCo opens `model.xml` or `a.xml`"):
        mjcf.export_with_assets_as_zip(both, tmp_path / "a.zip", "robot.xml")
    assert (tmp_path / "file").read_text() == "x"


@pytest.mark.parametrize("name", ["sub/model.xml", "model", "../model.xml", 3])
def test_the_model_has_a_plain_file_name(both: mjcf.RootElement, tmp_path: Path, name: str) -> None:
    with pytest.raises(mjcf.MjcfError, match="`model_filename`"):
        mjcf.export_with_assets(both, tmp_path / "out", name)


def test_only_a_whole_model_is_exported(both: mjcf.RootElement, tmp_path: Path) -> None:
    with pytest.raises(mjcf.MjcfError, match="its `root` is the model"):
        mjcf.export_with_assets(both.worldbody, tmp_path / "out")  # type: ignore[arg-type]


def test_conflicts_are_settled_as_asked(both: mjcf.RootElement, gripper: mjcf.RootElement, tmp_path: Path) -> None:
    both.option.timestep = 0.002
    gripper.option.timestep = 0.001
    with pytest.raises(mjcf.MjcfError, match=r"option\.timestep"):
        mjcf.export_with_assets(both, tmp_path / "out")
    with pytest.warns(mjcf.MjcfWarning):
        mjcf.export_with_assets(both, tmp_path / "out", conflict="mujoco")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml")).opt.timestep == 0.001


def test_a_zip_comes_back_and_gives_the_same_bytes(both: mjcf.RootElement, tmp_path: Path) -> None:
    mjcf.export_with_assets_as_zip(both, tmp_path / "first.zip")
    again = mjcf.from_zip(tmp_path / "first.zip")
    assert again.find("body", "gripper/palm") is not None
    mjcf.export_with_assets_as_zip(again, tmp_path / "second.zip")
    mjcf.export_with_assets_as_zip(mjcf.from_zip(tmp_path / "second.zip"), tmp_path / "third.zip")
    second = mujoco.MjSpec.from_zip(str(tmp_path / "second.zip")).compile()
    assert second.nmesh == 2 and second.nbody == both.compile_model().model.nbody
    assert (tmp_path / "second.zip").read_bytes() == (tmp_path / "third.zip").read_bytes()


def test_what_mujoco_writes_as_a_zip_is_read(both: mjcf.RootElement, tmp_path: Path) -> None:
    spec = both.to_spec()
    spec.compile()
    if not hasattr(spec, "to_zip"):
        pytest.skip("this MuJoCo writes no zips")
    spec.to_zip(str(tmp_path / "robot.mjz"))
    read = mjcf.from_zip(tmp_path / "robot.mjz")
    assert read.compile_model().model.nmesh == 2
    assert sorted(read.assets.values()) == sorted(both.assets.values())


def test_what_dm_control_writes_is_read_from_a_zip_of_its_folder(folder: Path, tmp_path: Path) -> None:
    """It writes files beside the model, named after their bytes."""
    mesh = (folder / "arm" / "meshes" / "shell.stl").read_bytes()
    name = f"shell-{hashlib.sha1(mesh).hexdigest()}.stl"
    text = (
        f'<mujoco model="arm"><asset><mesh name="gripper/shell" class="/" file="{name}"/></asset>'
        '<default><default class="/"/><default class="gripper/"/></default>'
        '<worldbody><body name="gripper/"><geom name="gripper/unnamed_geom_0" class="gripper/" type="mesh" '
        'mesh="gripper/shell"/></body></worldbody></mujoco>'
    )
    for inner in ("", "arm/"):
        path = tmp_path / f"{inner.strip('/') or 'flat'}.zip"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr(f"{inner}arm.xml", text)
            archive.writestr(f"{inner}{name}", mesh)
        model = mjcf.from_zip(path)
        assert model.compile_model().model.nmesh == 1
        assert model.find("geom", "gripper/unnamed_geom_0").mesh.file.contents == mesh  # type: ignore[union-attr]


def test_a_file_that_a_zip_lacks_is_told(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "z.zip", "w") as archive:
        archive.writestr("model.xml", '<mujoco><asset><mesh name="m" file="a/m.stl"/></asset></mujoco>')
    with pytest.raises(mjcf.MjcfError, match=r"z\.zip` has no file `a/m\.stl`"):
        mjcf.from_zip(tmp_path / "z.zip").find("mesh", "m").file.contents  # type: ignore[union-attr]  # noqa: B018


def test_files_that_vanish_are_told_and_the_model_stays(both: mjcf.RootElement, folder: Path, tmp_path: Path) -> None:
    text = both.to_xml_string()
    (folder / "arm" / "meshes" / "shell.stl").unlink()
    for attempt in (
        lambda: mjcf.export_with_assets(both, tmp_path / "out"),
        lambda: mjcf.export_with_assets_as_zip(both, tmp_path / "out.zip"),
        lambda: both.assets,
        both.compile_model,
        both.to_spec,
        lambda: both.find("mesh", "shell").file.contents,  # type: ignore[union-attr]
    ):
        with pytest.raises(mjcf.MjcfError, match=r"asset-missing.*shell\.stl") as caught:
            attempt()
        (fault,) = caught.value.diagnostics
        assert fault.code == "asset-missing" and fault.span is not None
        here = "cannot be read" in fault.message  # an `Asset` knows no element
        assert fault.span.file == (__file__ if here else str(folder / "arm" / "arm.xml"))
    assert both.to_xml_string() == text
    assert not (tmp_path / "out").exists() and not (tmp_path / "out.zip").exists()


def test_paths_stay_what_they_are_through_export_and_reading(arm: mjcf.RootElement, tmp_path: Path) -> None:
    expected = ["assets/arm/shell.stl"]
    for number in range(3):
        mjcf.export_with_assets(arm, tmp_path / str(number))
        arm = mjcf.from_path(tmp_path / str(number) / "model.xml")
        assert list(arm.assets) == expected
        assert arm.to_xml_string() == (tmp_path / str(number) / "model.xml").read_text()
    twice = mjcf.from_path(tmp_path / "2" / "model.xml")
    twice.model = "second"
    arm.attach(twice)
    assert list(arm.assets) == expected
    arm.asset.add("mesh", name="other", file=mjcf.Asset(b"...", ".stl", "other"))
    assert list(arm.assets) == [*expected, "assets/model/other.stl"]


Compiled = Callable[[mjcf.RootElement], mujoco.MjModel]


def test_a_file_finds_what_is_beside_it(folder: Path, compiled: Compiled) -> None:
    for path in (folder / "arm" / "arm.xml", str(folder / "arm" / "arm.xml")):
        assert compiled(mjcf.from_path(path)).nmesh == 1


def test_included_files_are_followed(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "ball.xml").write_text(
        '<mujocoinclude><worldbody><geom name="ball" size="1"/></worldbody></mujocoinclude>'
    )
    (tmp_path / "scene.xml").write_text(
        '<mujoco><include file="parts/ball.xml"/><worldbody><site name="s"/></worldbody></mujoco>'
    )
    model = mjcf.from_path(tmp_path / "scene.xml")
    assert [each.name for each in model.worldbody.all_children()] == ["ball", "s"]
    origin = model.find("geom", "ball").origin  # type: ignore[union-attr]
    assert origin.file.endswith("ball.xml")


@pytest.mark.parametrize("mode", ["r", "rb"])
def test_an_open_file_has_a_folder(mode: str, folder: Path, compiled: Compiled) -> None:
    with open(folder / "arm" / "arm.xml", mode) as file:
        assert compiled(mjcf.from_file(file)).nmesh == 1


def test_a_file_without_a_name_has_none() -> None:
    model = mjcf.from_file(io.StringIO('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>'))
    assert model.model == "unnamed_model" and len(model.find_all("geom")) == 1


def test_text_with_its_files(folder: Path, compiled: Compiled) -> None:
    text = (folder / "arm" / "arm.xml").read_text()
    mesh = (folder / "arm" / "meshes" / "shell.stl").read_bytes()
    for assets in ({"meshes/shell.stl": mesh}, {"shell.stl": mesh}):
        model = mjcf.from_xml_string(text, assets=assets)
        assert compiled(model).nmesh == 1 and list(model.assets.values()) == [mesh]
    assert compiled(mjcf.from_xml_string(text.encode(), base_dir=folder / "arm")).nmesh == 1
    with pytest.raises(mjcf.MjcfError, match="shell.stl` does not exist"):
        _ = mjcf.from_xml_string(text, base_dir=folder).assets


def test_text_may_include_what_is_handed_over() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><include file="a.xml"/></mujoco>',
        assets={"a.xml": b'<mujoco><worldbody><geom name="g" size="1"/></worldbody></mujoco>'},
    )
    assert model.find("geom", "g") is not None


@pytest.mark.parametrize(
    ("text", "codes", "line", "said"),
    [
        ("<mujoco>\n<worldbody>", {"xml-syntax"}, 2, "never closed"),
        ("<robot/>", {"not-mjcf"}, 1, "URDF"),
        ("<mujoco>\n<wordbody/></mujoco>", {"unknown-element"}, 2, "did you mean `<worldbody>`"),
        ("<mujoco><worldbody>\n<geom siez='1'/></worldbody></mujoco>", {"unknown-attribute"}, 2, "`size`"),
        ("<mujoco>\n<include file='no.xml'/></mujoco>", {"file-not-found", "xml-include"}, 2, "no.xml"),
    ],
)
def test_faults_are_told_with_file_and_line(tmp_path: Path, text: str, codes: set[str], line: int, said: str) -> None:
    (tmp_path / "bad.xml").write_text(text)
    with pytest.raises(mjcf.MjcfError) as caught:
        mjcf.from_path(tmp_path / "bad.xml")
    fault = caught.value.diagnostics[0]
    assert fault.code in codes and said in str(caught.value)
    assert fault.span is not None and (fault.span.file, fault.span.line) == (str(tmp_path / "bad.xml"), line)


def test_what_is_no_model_is_told(tmp_path: Path) -> None:
    with pytest.raises(mjcf.MjcfError, match="does not exist"):
        mjcf.from_path(tmp_path / "no.xml")
    with pytest.raises(mjcf.MjcfError, match="`path` expects"):
        mjcf.from_path(3)  # type: ignore[arg-type]
    with pytest.raises(mjcf.MjcfError, match="`xml_string` expects"):
        mjcf.from_xml_string(None)  # type: ignore[arg-type]


def _zip(path: Path, files: dict[str, bytes | str]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def test_a_zip_of_ours_comes_back(folder: Path, tmp_path: Path) -> None:
    arm, gripper = (mjcf.from_path(folder / each / f"{each}.xml") for each in ("arm", "gripper"))
    arm.find("site", "flange").attach(gripper)
    mjcf.export_with_assets_as_zip(arm, tmp_path / "both.zip")
    model = mjcf.from_zip(tmp_path / "both.zip")
    assert model.model == "arm"
    assert sorted(map(len, model.assets.values())) == sorted(map(len, arm.assets.values()))
    assert mujoco.MjModel.from_xml_string(model.to_xml_string(), model.assets).nmesh == 2


def test_a_zip_of_mujocos_comes_back(tmp_path: Path) -> None:
    spec = mujoco.MjSpec.from_string('<mujoco model="m"><worldbody><geom name="g" size="1"/></worldbody></mujoco>')
    spec.compile()
    if not hasattr(spec, "to_zip"):
        pytest.skip("this MuJoCo writes no zips")
    spec.to_zip(str(tmp_path / "m.zip"))
    assert mjcf.from_zip(tmp_path / "m.zip").find("geom", "g") is not None


def test_any_zip_with_one_model(folder: Path, tmp_path: Path) -> None:
    arm = (folder / "arm" / "arm.xml").read_text()
    whole = {
        "robot/arm.xml": arm.replace("<worldbody>", '<include file="parts/more.xml"/><worldbody>'),
        "robot/parts/more.xml": '<mujoco><worldbody><site name="more"/></worldbody></mujoco>',
        "robot/meshes/shell.stl": (folder / "arm" / "meshes" / "shell.stl").read_bytes(),
        "robot/package.xml": "<package/>",
    }
    model = mjcf.from_zip(_zip(tmp_path / "robot.zip", whole))
    assert model.find("site", "more") is not None
    assert model.find("mesh", "shell").file.contents == whole["robot/meshes/shell.stl"]
    assert model.find("site", "flange").origin.file == f"{tmp_path}/robot.zip/robot/arm.xml"


def test_zips_that_cannot_be_read(tmp_path: Path) -> None:
    model = "<mujoco/>"
    for files, message in (
        ({"a.xml": model, "b.xml": model}, "and several other models: `a.xml`, `b.xml`"),
        ({"readme.txt": "hello"}, "has neither `model.xml` nor `z.xml`"),
        ({"../model.xml": model}, "is not a bundle"),
        ({"model.xml": "<mujoco><worldbdy/></mujoco>"}, "`<worldbdy>` cannot be in `<mujoco>`"),
    ):
        with pytest.raises(MjcfError, match=re.escape(message)):
            mjcf.from_zip(_zip(tmp_path / "z.zip", files))
    with pytest.raises(MjcfError, match="the file or folder .* does not exist"):
        mjcf.from_zip(tmp_path / "nowhere.zip")
    with pytest.raises(MjcfError, match="is a folder, not a zip"):
        mjcf.from_zip(tmp_path)
    lost = mjcf.from_zip(
        _zip(tmp_path / "z.zip", {"model.xml": '<mujoco><asset><mesh file="x.stl"/></asset></mujoco>'})
    )
    with pytest.raises(MjcfError, match="z.zip` has no file `x.stl`"):
        lost.assets  # noqa: B018


def test_text_that_is_none() -> None:
    with pytest.raises(MjcfError, match="is not XML"):
        mjcf.from_xml_string("<mujoco model='\ud800'/>")


def test_a_missing_file_is_told_at_the_line_that_asked(tmp_path: Path) -> None:
    with pytest.raises(MjcfError) as caught:
        mjcf.from_path(tmp_path / "arm.xml")
    span = caught.value.diagnostics[0].span
    assert span is not None and span.file == __file__


def test_an_export_replaces_no_file_that_the_model_was_read_from(arm: mjcf.RootElement, tmp_path: Path) -> None:
    mjcf.export_with_assets(arm, tmp_path)
    mjcf.export_with_assets_as_zip(arm, tmp_path / "arm.zip")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    read = mjcf.from_path(tmp_path / "model.xml")
    for name in ("model.xml", "other.xml"):  # `other.xml` has the meshes of `model.xml`
        with pytest.raises(mjcf.MjcfError, match="is one of the files that this model is built from"):
            mjcf.export_with_assets(read, tmp_path, name)
    with pytest.raises(mjcf.MjcfError, match="is one of the files that this model is built from"):
        mjcf.export_with_assets_as_zip(mjcf.from_zip(tmp_path / "arm.zip"), tmp_path / "arm.zip")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == before
