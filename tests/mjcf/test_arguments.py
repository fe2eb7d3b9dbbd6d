from __future__ import annotations

import io
from pathlib import Path

import pytest

from composer import mjcf


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
