from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.bundle.bundle import Bundle
from composer.bundle.mjb import write_mjb
from composer.bundle.output_error import OutputError

TETRAHEDRON = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MODEL = b"""<mujoco><asset><mesh name="m" file="assets/t.obj"/></asset>
<worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"""


def test_mujoco_opens_it_from_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mujoco = pytest.importorskip("mujoco")
    write_mjb(Bundle({"model.xml": MODEL, "assets/t.obj": TETRAHEDRON}), tmp_path / "new" / "arm.mjb")
    monkeypatch.chdir(tmp_path)
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "new" / "arm.mjb")).nmesh == 1
    assert os.listdir(tmp_path / "new") == ["arm.mjb"]


def test_the_same_model_is_the_same_bytes(tmp_path: Path) -> None:
    """The paths of assets, which MuJoCo keeps in it, are those in the bundle and not those of a temporary folder."""
    mujoco = pytest.importorskip("mujoco")
    for name in ("one.mjb", "two.mjb"):
        write_mjb(Bundle({"model.xml": MODEL, "assets/t.obj": TETRAHEDRON}), tmp_path / name)
    assert (tmp_path / "one.mjb").read_bytes() == (tmp_path / "two.mjb").read_bytes()
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "one.mjb")).paths == b"assets/t.obj\0"


def test_a_model_that_does_not_compile_leaves_the_old_file(tmp_path: Path) -> None:
    out = tmp_path / "arm.mjb"
    out.write_bytes(b"old")
    with pytest.raises(OutputError, match=r"assets/t\.obj"):
        write_mjb(Bundle({"model.xml": MODEL}), out)
    assert out.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["arm.mjb"]
