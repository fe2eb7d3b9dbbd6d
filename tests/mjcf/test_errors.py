from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from composer import mjcf
from composer.diagnostics import MjcomposeError, Sink
from composer.mjcf.errors import failure, raise_errors


def test_a_fault_is_a_value_error_with_diagnostics() -> None:
    error = failure("name-clash", "there are two", help="rename one")
    assert (
        isinstance(error, mjcf.MjcfError)
        and isinstance(error, ValueError)
        and isinstance(error, MjcomposeError)
    )
    assert str(error) == "error[name-clash]: there are two\n  = help: rename one"
    assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics


def test_an_unknown_attribute_is_an_attribute_error_too() -> None:
    with pytest.raises(AttributeError) as caught:
        _ = mjcf.RootElement().colour
    assert isinstance(caught.value, mjcf.MjcfError)


def test_a_file_that_does_not_exist_is_a_file_not_found_error_too(tmp_path: Path) -> None:
    mesh = '<mujoco><asset><mesh name="m" file="m.stl"/></asset></mujoco>'
    model = mjcf.from_xml_string(mesh, base_dir=tmp_path)
    for fails in (
        lambda: mjcf.from_path(tmp_path / "none.xml"),
        lambda: mjcf.Physics.from_path(tmp_path / "none.xml"),
        lambda: model.find("mesh", "m").file.contents,
        lambda: mjcf.export_with_assets(model, tmp_path / "out"),
        lambda: model.compile_model(),
    ):
        with pytest.raises(FileNotFoundError) as caught:
            fails()
        error = caught.value
        assert isinstance(error, mjcf.MjcfFileNotFoundError) and "error[" in str(error)
        assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics


def test_a_file_that_cannot_be_read_is_an_os_error_too(tmp_path: Path) -> None:
    with pytest.raises(OSError) as caught:
        mjcf.from_path(tmp_path)
    assert isinstance(caught.value, mjcf.MjcfFileError) and not isinstance(caught.value, FileNotFoundError)
    assert caught.value.diagnostics[0].code == "file-unreadable"


def test_only_errors_are_raised_and_all_of_them() -> None:
    sink = Sink()
    sink.warning("name-clash", "look")
    raise_errors(sink)
    sink.error("name-clash", "one")
    sink.error("unknown-name", "two")
    with pytest.raises(mjcf.MjcfError) as caught:
        raise_errors(sink)
    assert [fault.message for fault in caught.value.diagnostics] == ["one", "two"]
