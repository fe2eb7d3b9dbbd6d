"""Skin files have names of bodies in them."""

from __future__ import annotations

import copy
import io
import pickle
import struct
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import Element, MjcfError


def _framed() -> mjcf.Element:
    return mjcf.RootElement("parent").attach(mjcf.RootElement("child"))


def test_numpy_numbers_are_positions() -> None:
    world = mjcf.RootElement().worldbody
    later = world.add("geom", size=[1])
    assert [world.insert("geom", np.int64(0), size=[1]), later] == world.all_children()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: mjcf.from_path(3), "`path` expects a path, got `int`"),
        (lambda: mjcf.from_zip(None), "`path` expects a path, got `NoneType`"),
        (lambda: mjcf.from_xml_string("<mujoco/>", base_dir=3), "`base_dir` expects a path"),
        (lambda: mjcf.from_xml_string("<mujoco/>", assets=[1]), "`assets` expects bytes by path, got `list`"),
        (
            lambda: mjcf.from_xml_string("<mujoco/>", assets={"a.stl": "text"}),
            "expects bytes by path, got `str` by `str`",
        ),
        (lambda: mjcf.from_file("robot.xml"), "expects an open file, got `str`"),
        (lambda: mjcf.export_with_assets(mjcf.RootElement(), 3), "`out_dir` expects a path, got `int`"),
        (lambda: mjcf.export_with_assets_as_zip(mjcf.RootElement(), 3), "`zip_path` expects a path"),
        (lambda: mjcf.get_attachment_frame(3), "expects an element, got `int`"),
        (lambda: mjcf.get_frame_joints(None), "expects an element, got `NoneType`"),
        (lambda: mjcf.get_freejoint("body"), "expects an element, got `str`"),
        (lambda: mjcf.commit_defaults(None), "expects an element, got `NoneType`"),
        (lambda: mjcf.from_path("a\0b.xml"), "`path` expects a path, got `a\\0b.xml`"),
        (lambda: mjcf.export_with_assets(mjcf.RootElement(), "a\0b"), "`out_dir` expects a path, got `a\\0b`"),
        (lambda: mjcf.RootElement().enter_scope(3), "`prefix` expects a name, got `3`"),
        (lambda: mjcf.RootElement().get(None), "`attribute` expects a name, got `None`"),
        (lambda: mjcf.RootElement().origin_of(None), "`attribute` expects a name, got `None`"),
        (lambda: mjcf.RootElement().find("geom", 3), "`name` expects a name, got `3`"),
        (lambda: mjcf.RootElement().worldbody.insert("geom", "0"), "`position` expects an integer, got `'0'`"),
        (lambda: mjcf.RootElement().worldbody.insert("geom", True), "`position` expects an integer"),
        (lambda: mjcf.RootElement().worldbody.insert("geom", np.array([1])), "`position` expects an integer"),
        (lambda: mjcf.Asset("text", ".stl"), "`contents` expects bytes, got `str`"),
        (lambda: mjcf.Asset(b"", "stl"), "`extension` expects a suffix such as `.stl`, got `stl`"),
        (lambda: mjcf.Asset(b"", ".stl", "../a"), "`prefix` expects the name of a file without folders"),
        (lambda: mjcf.Asset(path=3), "`path` expects a path, got `int`"),
        (lambda: mjcf.Asset(), "takes either `contents` or a `path`"),
        (lambda: _framed().insert("joint", 0.5), "`position` expects an integer, got `0.5`"),
        (lambda: _framed().root.worldbody.geom.__setitem__(0, None), "a geom of a list cannot be set"),
    ],
)
def test_an_argument_of_the_wrong_type_is_told_at_the_call(call: object, said: str) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        call()  # type: ignore[operator]
    (fault,) = caught.value.diagnostics
    assert fault.code == "wrong-type" and said in fault.message
    assert fault.span is not None and fault.span.file == __file__


def test_a_file_that_is_closed_is_told(tmp_path: Path) -> None:
    file = io.StringIO("<mujoco/>")
    file.close()
    with pytest.raises(mjcf.MjcfError, match="`file_object` cannot be read"):
        mjcf.from_file(file)
    with (tmp_path / "out").open("w") as writing, pytest.raises(mjcf.MjcfError, match="cannot be read"):
        mjcf.from_file(writing)


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
    assert repr(mesh).count("shell-2.stl") == repr(again).count("shell-2.stl") == 1, "shell.stl is there on disk"
    assert compiled(arm).nmesh == 4 and len(arm.assets) == 3


def test_a_file_of_another_model_may_be_used(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.asset.add("mesh", name="from_gripper", file=gripper.find("mesh", "shell").file)  # type: ignore[union-attr]
    assert len(set(arm.assets.values())) == 2


def test_names_of_assets_are_told_apart(arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled) -> None:
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


def test_its_path_in_a_bundle(arm: mjcf.RootElement, gripper: mjcf.RootElement, folder: Path, tmp_path: Path) -> None:
    twin = arm.asset.add("mesh", name="twin", file=mjcf.Asset((folder / "arm/meshes/shell.stl").read_bytes(), ".stl"))
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
    mesh = arm.find("mesh", "shell")
    text = arm.to_xml_string()
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


def _skin(body: str) -> bytes:
    """A triangle on one bone."""
    return b"".join(
        (
            struct.pack("<4i", 3, 0, 1, 1),
            struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0),
            struct.pack("<3i", 0, 1, 2),
            body.encode().ljust(40, b"\0"),
            struct.pack("<7f", 0, 0, 0, 1, 0, 0, 0),
            struct.pack("<i3i3f", 3, 0, 1, 2, 1, 1, 1),
        )
    )


def _model(body: str = "b", name: str = "doll") -> mjcf.RootElement:
    model = mjcf.RootElement(name)
    model.worldbody.add("body", name=body).add("geom", size=[1])
    model.asset.add("skin", name="coat", file=mjcf.Asset(_skin(body), ".skn", "coat"))
    return model


def test_a_bone_follows_its_body() -> None:
    model = _model()
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    assert model.compile_model().model.nskin == 1
    assert model.find("skin", "coat").file.contents == _skin("trunk")  # type: ignore[union-attr]


def test_a_file_on_disk_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(_skin("b"))
    (tmp_path / "doll.xml").write_text(
        '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody>'
        '<deformable><skin file="coat.skn"/></deformable></mujoco>'
    )
    model = mjcf.from_path(tmp_path / "doll.xml")
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    assert model.compile_model().model.skin_bonebodyid.tolist() == [1]
    assert (tmp_path / "coat.skn").read_bytes() == _skin("b")


def test_a_bone_in_an_attached_model_and_in_the_one_above() -> None:
    scene = _model("doll/b", "scene")
    doll = _model()
    with pytest.raises(mjcf.MjcfError, match="which would have two"):
        scene.attach(doll)
    scene.worldbody.body["doll/b"].remove()
    scene.attach(doll)
    doll.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    doll.model = "puppet"
    assert scene.compile_model().model.nskin == 2
    assert scene.find("skin", "coat").file.contents == _skin("puppet/trunk")  # type: ignore[union-attr]


def test_a_name_that_has_no_room_in_the_file_changes_nothing() -> None:
    model = _model()
    before = str(model)
    with pytest.raises(mjcf.MjcfError, match="longer than the 39 bytes of a skin file"):
        model.find("body", "b").name = "b" * 40  # type: ignore[union-attr]
    assert str(model) == before and model.compile_model().model.nskin == 1


def test_a_bone_with_a_separator_is_escaped(tmp_path: Path) -> None:
    mjcf.export_with_assets_as_zip(_model("doll/b"), tmp_path / "doll.zip")
    model = mjcf.from_zip(tmp_path / "doll.zip", escape_separators=True)
    assert model.find("skin", "coat").file.contents == _skin("doll\\b")  # type: ignore[union-attr]


def test_a_file_that_is_no_skin_is_told_by_mujoco_as_before() -> None:
    model = _model()
    model.find("skin", "coat").file = mjcf.Asset(b"nothing", ".skn", "coat")  # type: ignore[union-attr]
    model.find("body", "b").name = "trunk"  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match="skin"):
        model.compile_model()


@pytest.fixture
def geom() -> Element:
    body = mjcf.RootElement().worldbody.add("body", name="b")
    return body.add("geom", name="g", type="box", size=[1, 2, 3], pos=[1, 2, 3], user=[1, 2])


def test_an_item_that_is_assigned_is_set(geom: Element) -> None:
    geom.pos[2] = 7
    geom.pos[:2] = [5, 6]
    geom.size[0] += 0.5
    assert geom.pos.tolist() == [5, 6, 7] and geom.size[0] == 1.5
    assert 'pos="5 6 7"' in repr(geom)


def test_computing_in_place_sets_too(geom: Element) -> None:
    geom.pos += [1, 1, 1]
    geom.pos *= 2
    geom.pos /= 4
    pos = geom.pos
    pos -= 1
    pos **= 2
    assert pos.tolist() == geom.pos.tolist() == [0, 0.25, 1]


def test_the_line_that_changed_an_item_is_its_origin(geom: Element) -> None:
    geom.pos[0] = 4
    assert geom.origin_of("pos").file == __file__
    assert geom.origin_of("pos").line > geom.origin_of("size").line


def test_what_was_set_elsewhere_in_the_meantime_stays(geom: Element) -> None:
    pos = geom.pos
    geom.pos = [7, 8, 9]
    pos[0] = 0
    assert geom.pos.tolist() == pos.tolist() == [0, 8, 9]


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("geom.pos[0] = float('nan')", "expects numbers, got `nan`"),
        ("geom.pos[0] = 'x'", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos[:2] = [1, 2, 3]", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos += [1, 2]", "`pos` of `<geom>` `g` cannot take this"),
        ("geom.pos /= 'x'", "`pos` of `<geom>` `g` cannot take this"),
        ("part = geom.pos[:2]; part[0] = 1", "a part of an attribute's array"),
    ],
)
def test_what_does_not_fit_changes_nothing(geom: Element, statement: str, message: str) -> None:
    before = repr(geom)
    with pytest.raises(MjcfError, match=message):
        exec(statement, {"geom": geom})
    assert repr(geom) == before


def test_a_fraction_is_no_integer(geom: Element) -> None:
    texture = geom.root.asset.add("texture", name="t", builtin="flat", width=8, height=8, gridsize=[1, 1])
    texture.gridsize[1] = 3
    with pytest.raises(MjcfError, match="expects every item to be an integer"):
        texture.gridsize[0] = 1.5
    assert texture.gridsize.tolist() == [1, 3] and texture.gridsize.dtype == np.int64


def test_a_removed_element_tells(geom: Element) -> None:
    pos = geom.pos
    geom.remove()
    with pytest.raises(MjcfError, match="was removed"):
        pos[0] = 1


def test_nothing_else_writes_to_it(geom: Element) -> None:
    pos = geom.pos
    with pytest.raises(ValueError, match="read-only"):
        np.add(pos, 1, out=pos)
    with pytest.raises(ValueError, match="read-only"):
        pos.sort()
    assert geom.pos.tolist() == pos.tolist() == [1, 2, 3]


def test_what_is_computed_from_it_and_copies_are_plain(geom: Element) -> None:
    pos = geom.pos
    plain = [pos + 1, pos * pos, 2 * pos, -pos, np.cross(pos, pos), pos.copy(), np.array(pos)]
    plain += [copy.copy(pos), copy.deepcopy(pos), pickle.loads(pickle.dumps(pos))]
    for each in plain:
        assert type(each) is np.ndarray
        each[0] = 100
    assert isinstance(pos.sum(), np.float64) and type(pos @ pos) is np.float64
    assert geom.pos.tolist() == [1, 2, 3] and repr(pos) == "array([1., 2., 3.])" and str(pos) == "[1. 2. 3.]"
