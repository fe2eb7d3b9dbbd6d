from __future__ import annotations

import pickle
from pathlib import Path

import pytest
from mjcompose import mjcf
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.report import MjcomposeError
from mjcompose.base.sink import Sink
from mjcompose.mjcf import errors as elsewhere
from mjcompose.mjcf.errors import error_of, raise_errors


def test_a_fault_is_a_value_error_with_diagnostics() -> None:
    error = error_of(Diagnostic("name-clash", "there are two", help="rename one"))
    assert isinstance(error, mjcf.MjcfError) and isinstance(error, ValueError) and isinstance(error, MjcomposeError)
    assert str(error) == "error[name-clash]: there are two\n  = help: rename one"
    assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics


def test_an_unknown_attribute_is_an_attribute_error_too() -> None:
    with pytest.raises(AttributeError) as caught:
        _ = mjcf.RootElement().color
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


@pytest.fixture
def body() -> mjcf.Element:
    return mjcf.RootElement("m").worldbody.add("body", name="b")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pso", "did you mean `pos`"),
        ("geoms", "did you mean `geom`"),
        ("attch", "did you mean `attach`"),
        ("ad", "`add`"),
    ],
)
def test_what_was_probably_meant_is_told(body: mjcf.Element, name: str, said: str) -> None:
    with pytest.raises(mjcf.MjcfError, match=said):
        getattr(body, name)


@pytest.mark.parametrize("name", elsewhere.ATTRIBUTES)
def test_words_of_dm_control_are_told_as_what_they_are_here(body: mjcf.Element, name: str) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        getattr(body, name)
    assert caught.value.diagnostics[0].help == elsewhere.ATTRIBUTES[name]


@pytest.mark.parametrize("tag", elsewhere.TAGS)
def test_so_are_its_namespaces(body: mjcf.Element, tag: str) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        body.root.find(tag, "x")
    assert caught.value.diagnostics[0].help == elsewhere.TAGS[tag]


def test_they_are_no_children(body: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="cannot have a `attachment_frame`"):
        body.add("attachment_frame")
    with pytest.raises(mjcf.MjcfError) as caught:
        body.set_attributes(namescope=1)
    assert caught.value.diagnostics[0].help is None
