"""Models that name others in `<model file="…"/>`, from disk and in memory."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf

OBJ = b"v 0 0 0\nv %d 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
TOOL = b"""
<mujoco model="tool"><asset><mesh file="part.obj"/></asset>
  <worldbody><body name="blade"><geom type="mesh" mesh="part"/></body></worldbody></mujoco>"""
CELL = """
<mujoco model="cell"><compiler meshdir="meshes"/><asset><model name="{0}" file="tool.xml"/></asset>
  <worldbody><body name="{0}"/><attach model="{0}" body="blade" prefix="{0}_"/></worldbody></mujoco>"""


def _files(size: int) -> dict[str, bytes]:
    return {"tool.xml": TOOL, "part.obj": OBJ % size}


def _on_disk(folder: Path, name: str, size: int) -> mjcf.RootElement:
    folder.mkdir()
    for file, content in {**_files(size), "cell.xml": CELL.format(name).encode()}.items():
        (folder / file).write_bytes(content)
    return mjcf.from_path(folder / "cell.xml")


def _in_memory(folder: Path, name: str, size: int) -> mjcf.RootElement:
    return mjcf.from_xml_string(CELL.format(name), assets=_files(size))


def _from_zip(folder: Path, name: str, size: int) -> mjcf.RootElement:
    mjcf.export_with_assets_as_zip(_on_disk(folder, name, size), folder / "cell.zip")
    return mjcf.from_zip(folder / "cell.zip")


Make = Callable[[Path, str, int], mjcf.RootElement]
made = pytest.mark.parametrize("make", [_on_disk, _in_memory, _from_zip])


def _widths(model: mjcf.RootElement) -> list[float]:
    """The largest coordinate of each mesh; the text and the assets say the same."""
    compiled = model.compile_model().model
    assert mujoco.MjModel.from_xml_string(model.to_xml_string(), model.assets).names == compiled.names
    sizes = [compiled.mesh(number).vertnum[0] for number in range(compiled.nmesh)]
    starts = [sum(sizes[:number]) for number in range(compiled.nmesh)]
    vertices = compiled.mesh_vert
    return [float(round(vertices[at : at + 4].max() - vertices[at : at + 4].min(), 3)) for at in starts]


@made
def test_it_comes_with_its_files(make: Make, tmp_path: Path) -> None:
    model = make(tmp_path / "a", "left", 1)
    assert sorted(name.rpartition("/")[2] for name in model.assets) == ["part.obj", "tool.xml"]
    assert model.asset.model[0].file.contents.strip().startswith(b'<mujoco model="tool"')
    assert mjcf.from_spec(model.to_spec()).compile_model().model.nmesh == len(_widths(model)) == 1


@made
def test_two_that_have_files_of_one_name(make: Make, tmp_path: Path) -> None:
    left = make(tmp_path / "a", "left", 1)
    right = make(tmp_path / "b", "right", 9)
    one = _widths(left)
    other = _widths(right)
    right.model = "other"
    left.attach(right)
    assert one != other and sorted(_widths(left)) == sorted(one + other)


@made
def test_it_is_included_with_its_files(make: Make, tmp_path: Path) -> None:
    left = make(tmp_path / "a", "left", 1)
    right = make(tmp_path / "b", "right", 9)
    both = mjcf.RootElement("both")
    both.include_copy(left)
    assert _widths(both) == _widths(left)
    both.include_copy(right)
    assert sorted(_widths(both)) == sorted(_widths(left) + _widths(right))
    mjcf.export_with_assets(both, tmp_path / "out")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml")).nmesh == 2


def test_it_may_be_an_asset() -> None:
    model = mjcf.RootElement()
    model.asset.add("mesh", name="mine", file=mjcf.Asset(OBJ % 3, ".obj", "part"))
    model.asset.add("model", name="tool", file=mjcf.Asset(TOOL, ".xml", "tool"))
    model.worldbody.add("attach", model="tool", body="blade", prefix="tool_")
    assert len(_widths(model)) == 2


def test_one_that_is_made_of_itself_is_told() -> None:
    again = TOOL.replace(b"<asset>", b'<asset><model name="again" file="tool.xml"/>')
    model = mjcf.from_xml_string(CELL.format("left"), assets={**_files(1), "tool.xml": again})
    with pytest.raises(mjcf.MjcfError, match=r"the model `tool.xml` contains itself"):
        model.compile_model()


def test_a_mesh_without_a_name_keeps_that_of_its_file() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><asset><mesh name="first" file="x/part.obj"/><mesh file="y/part.obj"/></asset>'
        '<worldbody><geom type="mesh" mesh="part"/></worldbody></mujoco>',
        assets={"x/part.obj": OBJ % 1, "y/part.obj": OBJ % 9},
    )
    assert len(_widths(model)) == 2
