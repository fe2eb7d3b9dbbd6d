from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError
from composer.bundle.text import write_text


def test_the_model_alone_is_written(tmp_path: Path) -> None:
    bundle = Bundle({"model.xml": b"<mujoco/>\n", "manifest.json": b"{}", "LICENSES/arm/LICENSE": b"free"})
    write_text(bundle, tmp_path / "arm.xml")
    assert (tmp_path / "arm.xml").read_bytes() == b"<mujoco/>\n"
    assert os.listdir(tmp_path) == ["arm.xml"]


def test_a_model_with_files_is_refused(tmp_path: Path) -> None:
    bundle = Bundle({"model.xml": b"<mujoco/>", "assets/a.obj": b"", "assets/b.obj": b""})
    (tmp_path / "arm.xml").write_text("old")
    with pytest.raises(OutputError) as caught:
        write_text(bundle, tmp_path / "arm.xml")
    assert caught.value.code == "output-kind"
    assert "the 2 files that the model needs, such as `assets/a.obj`" in caught.value.message
    assert caught.value.help is not None and "arm.mjz" in caught.value.help
    assert (tmp_path / "arm.xml").read_text() == "old"
