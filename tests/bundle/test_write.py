from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer import engine
from composer.bundle import Bundle, Form, OutputError, form_of
from composer.bundle.read import read
from composer.bundle.write import write

BUNDLE = Bundle({"model.xml": b'<mujoco><worldbody><body name="b"/></worldbody></mujoco>'})


@pytest.mark.parametrize(
    ("out", "form"),
    [
        ("arm", Form.FOLDER),
        ("a.b/", Form.FOLDER),
        ("arm.zip", Form.ARCHIVE),
        ("arm.MJZ", Form.ARCHIVE),
        ("v1.2.mjz", Form.ARCHIVE),
        ("x/arm.xml", Form.TEXT),
        ("arm.mjb", Form.MJB),
        (".hidden", Form.FOLDER),
    ],
)
def test_the_name_tells_the_form(out: str, form: Form) -> None:
    assert form_of(out) is form


def test_a_folder_that_is_there_is_a_folder_whatever_its_name(tmp_path: Path) -> None:
    (tmp_path / "arm.v2").mkdir()
    assert form_of(tmp_path / "arm.v2") is Form.FOLDER


@pytest.mark.parametrize("out", ["arm.glb", "arm.yaml", "arm.tar.gz", "ur5e.v2"])
def test_other_names_are_refused_with_what_to_write(out: str, tmp_path: Path) -> None:
    with pytest.raises(OutputError) as caught:
        write(BUNDLE, tmp_path / out, environment={})
    assert caught.value.code == "output-kind"
    assert caught.value.help is not None and f"{out}/" in caught.value.help
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("out", ["arm/", "arm.zip", "arm.mjz", "arm.xml", "arm.mjb"])
def test_every_form_opens_in_mujoco_from_another_folder(
    out: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mujoco = pytest.importorskip("mujoco")
    form = write(BUNDLE, f"{tmp_path}/{out}", environment={})
    monkeypatch.chdir("/")
    path = tmp_path / out
    if form is Form.MJB:
        assert mujoco.MjModel.from_binary_path(str(path)).nbody == 2
    else:
        folder, name = (path, "model.xml") if form is Form.FOLDER else (path.parent, path.name)
        assert engine.compile(folder, name).sizes["nbody"] == 2


@pytest.mark.parametrize("out", ["arm/", "arm.zip", "arm.mjz"])
def test_what_was_written_can_be_read(out: str, tmp_path: Path) -> None:
    write(BUNDLE, f"{tmp_path}/{out}", environment={})
    assert read(tmp_path / out) == BUNDLE
    assert read(tmp_path / out).sha256 == BUNDLE.sha256
