from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest

from composer import mjcf
from composer.mjcf import MjcfError

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
def test_faults_are_told_with_file_and_line(
    tmp_path: Path, text: str, codes: set[str], line: int, said: str
) -> None:
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
    spec = mujoco.MjSpec.from_string(
        '<mujoco model="m"><worldbody><geom name="g" size="1"/></worldbody></mujoco>'
    )
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
        ({"model.xml": "<mujoco><worldbdy/></mujoco>"}, "`<worldbdy>` cannot stand in `<mujoco>`"),
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
