from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest

from composer import mjcf

Compiled = Callable[[mjcf.RootElement], mujoco.MjModel]


def test_a_file_reads_as_an_asset(arm: mjcf.RootElement, folder: Path) -> None:
    asset = arm.find("mesh", "shell").file  # type: ignore[union-attr]
    path = folder / "arm" / "meshes" / "shell.stl"
    assert (asset.path, asset.prefix, asset.extension) == (path, "shell", ".stl")
    assert asset.contents == path.read_bytes() and "shell.stl" in repr(asset)
    path.unlink()
    with pytest.raises(mjcf.MjcfError, match="cannot be read"):
        _ = asset.contents


def test_bytes_may_be_a_file(arm: mjcf.RootElement, folder: Path, compiled: Compiled) -> None:
    data = (folder / "gripper" / "shell.stl").read_bytes()
    mesh = arm.asset.add("mesh", name="new", file=mjcf.Asset(data, ".stl", "shell"))
    again = arm.asset.add("mesh", name="again", file=mesh.file)
    arm.asset.add("mesh", name="other", file=mjcf.Asset(data[:-1] + b"\1", ".stl", "shell"))
    assert mesh.file.contents == data and mesh.file.path is None and mesh.file == again.file
    assert repr(mesh).count("shell-2.stl") == repr(again).count("shell-2.stl") == 1, (
        "shell.stl is there on disk"
    )
    assert compiled(arm).nmesh == 4 and len(arm.assets) == 3


def test_a_file_of_another_model_may_be_used(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.asset.add("mesh", name="from_gripper", file=gripper.find("mesh", "shell").file)  # type: ignore[union-attr]
    assert len(set(arm.assets.values())) == 2


def test_names_of_assets_are_told_apart(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    arm.attach(gripper)
    names = list(arm.assets)
    assert names == ["assets/arm/shell.stl", "assets/gripper/shell-2.stl"]
    assert all(f'file="{name}"' in arm.to_xml_string() for name in names)
    assert compiled(arm).nmesh == 2


@pytest.mark.parametrize("arguments", [(), (b"", ""), (b"", "stl"), (b"", ".")])
def test_an_asset_has_contents_and_an_extension(arguments: tuple[bytes, str]) -> None:
    with pytest.raises(mjcf.MjcfError):
        mjcf.Asset(*arguments)


def test_only_a_file_can_be_an_asset(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError, match="expects no file"):
        arm.worldbody.add("geom", name=mjcf.Asset(b"x", ".stl"))


def test_its_path_in_a_bundle(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, folder: Path, tmp_path: Path
) -> None:
    twin = arm.asset.add(
        "mesh", name="twin", file=mjcf.Asset((folder / "arm/meshes/shell.stl").read_bytes(), ".stl")
    )
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    shells = [arm.find("mesh", name).file for name in ("shell", "gripper/shell", "twin")]  # type: ignore[union-attr]
    assert [shell.bundle_path for shell in shells] == [
        "assets/arm/shell.stl",
        "assets/gripper/shell.stl",
        "assets/arm/shell.stl",
    ], "equal bytes are stored once"
    mjcf.export_with_assets(arm, tmp_path / "out")
    for shell in shells:
        assert (tmp_path / "out" / shell.bundle_path).read_bytes() == shell.contents
    assert twin.file.bundle_path is not None and mjcf.Asset(b"x", ".stl").bundle_path is None


def test_paths_are_taken_as_text_or_as_paths(tmp_path: Path) -> None:
    model = mjcf.RootElement()
    mesh = model.asset.add("mesh", file=tmp_path / "box.stl")
    assert mesh.file.path == tmp_path / "box.stl" and mesh.name == "box"
    assert mjcf.Asset(path=str(tmp_path / "box.stl")) == mjcf.Asset(path=tmp_path / "box.stl") == mesh.file


def test_a_file_that_is_given_as_it_was_read_keeps_its_name(arm: mjcf.RootElement) -> None:
    mesh, text = arm.find("mesh", "shell"), arm.to_xml_string()
    mesh.file = mesh.file
    other = arm.asset.add("mesh", name="other", file=mesh.file)
    assert other._node.get("file") == mesh._node.get("file") == "shell.stl"
    other.remove()
    assert arm.to_xml_string() == text


def test_one_file_in_memory_may_be_named_twice() -> None:
    """Below a folder that is called as that of an export."""
    mesh = '<mesh name="{}" file="a.obj" scale="1 {} 1"/>'
    text = f'<mujoco><compiler meshdir="assets"/><asset>{mesh.format("a", 1)}{mesh.format("b", -1)}</asset></mujoco>'
    model = mjcf.from_xml_string(text, assets={"assets/a.obj": b"v 0 0 0"})
    assert model.assets == {"assets/unnamed_model/a.obj": b"v 0 0 0"}
