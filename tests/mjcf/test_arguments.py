from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from composer import mjcf


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
        (
            lambda: mjcf.export_with_assets(mjcf.RootElement(), "a\0b"),
            "`out_dir` expects a path, got `a\\0b`",
        ),
        (lambda: mjcf.RootElement().enter_scope(3), "`prefix` expects a name, got `3`"),
        (lambda: mjcf.RootElement().get(None), "`attribute` expects a name, got `None`"),
        (lambda: mjcf.RootElement().origin_of(None), "`attribute` expects a name, got `None`"),
        (lambda: mjcf.RootElement().find("geom", 3), "`name` expects a name, got `3`"),
        (
            lambda: mjcf.RootElement().worldbody.insert("geom", "0"),
            "`position` expects an integer, got `'0'`",
        ),
        (lambda: mjcf.RootElement().worldbody.insert("geom", True), "`position` expects an integer"),
        (lambda: mjcf.RootElement().worldbody.insert("geom", np.array([1])), "`position` expects an integer"),
        (lambda: mjcf.Asset("text", ".stl"), "`contents` expects bytes, got `str`"),
        (lambda: mjcf.Asset(b"", "stl"), "`extension` expects a suffix such as `.stl`, got `stl`"),
        (lambda: mjcf.Asset(b"", ".stl", "../a"), "`prefix` expects the name of a file without folders"),
        (lambda: mjcf.Asset(path=3), "`path` expects a path, got `int`"),
        (lambda: mjcf.Asset(), "made of `contents` or of a `path`, one of them"),
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
