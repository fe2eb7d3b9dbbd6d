from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest

from composer import mjcf

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
    with pytest.raises(mjcf.MjcfError, match="shell.stl` cannot be read"):
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
    with pytest.raises(mjcf.MjcfError, match="not there"):
        mjcf.from_path(tmp_path / "no.xml")
    with pytest.raises(mjcf.MjcfError, match="`path` expects"):
        mjcf.from_path(3)  # type: ignore[arg-type]
    with pytest.raises(mjcf.MjcfError, match="`xml_string` expects"):
        mjcf.from_xml_string(None)  # type: ignore[arg-type]
