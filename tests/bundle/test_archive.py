from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from composer import engine
from composer.bundle.archive import write_archive
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MODEL = """<mujoco><compiler meshdir="assets"/>
  <asset>
    <mesh name="a" file="left/t.obj"/><mesh name="b" file="right/t.obj"/><mesh name="c" file="ü ß/t.obj"/>
  </asset>
  <worldbody>
    <geom type="mesh" mesh="a"/><geom type="mesh" mesh="b"/><geom type="mesh" mesh="c"/>
  </worldbody>
</mujoco>
"""
BUNDLE = Bundle(
    {
        "model.xml": MODEL.encode(),
        "assets/left/t.obj": TETRAHEDRON.encode(),
        "assets/right/t.obj": TETRAHEDRON.replace("1 0 0", "3 0 0").encode(),
        "assets/ü ß/t.obj": TETRAHEDRON.encode(),
        "assets/t.png": bytes(range(256)) * 8,
        "LICENSES/left/LICENSE": b"free\n" * 100,
        "manifest.json": b"{}\n",
    }
)


def test_files_stand_in_order_with_fixed_attributes(tmp_path: Path) -> None:
    write_archive(BUNDLE, tmp_path / "a.zip", {})
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        entries = archive.infolist()
        assert {entry.filename: archive.read(entry) for entry in entries} == BUNDLE.files
    others = sorted(path for path in BUNDLE.files if path != "model.xml")
    assert [entry.filename for entry in entries] == ["model.xml", *others]
    assert {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}
    assert {entry.external_attr >> 16 for entry in entries} == {0o100644}
    assert {entry.create_system for entry in entries} == {3}
    assert {entry.extra for entry in entries} == {b""}
    assert {entry.filename for entry in entries if entry.flag_bits} == {"assets/ü ß/t.obj"}
    stored = {entry.filename for entry in entries if entry.compress_type == zipfile.ZIP_STORED}
    assert stored == {"assets/t.png"}


@pytest.mark.parametrize("name", ["a.mjz", "odd name.zip"])
def test_mujoco_opens_it_from_another_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    mujoco = pytest.importorskip("mujoco")
    write_archive(BUNDLE, tmp_path / name, {})
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert engine.compile(tmp_path, name).sizes["nmesh"] == 3
    model = mujoco.MjSpec.from_zip(str(tmp_path / name)).compile()
    assert model.nmesh == 3
    assert model.body_inertia.shape == (1, 3)
    left, right, umlaut = (model.mesh_vert[start : start + 4].tolist() for start in model.mesh_vertadr)
    assert left == umlaut != right
    if tuple(map(int, mujoco.__version__.split(".")[:1])) >= (4,):
        assert mujoco.MjSpec.from_file(str(tmp_path / name)).compile().nmesh == 3


def test_other_xml_files_do_not_hide_the_model(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    bundle = Bundle({"model.xml": b'<mujoco model="right"/>', "z.xml": b"<x/>", "a.xml": b"<x/>"})
    write_archive(bundle, tmp_path / "a.mjz", {})
    assert mujoco.MjSpec.from_zip(str(tmp_path / "a.mjz")).modelname == "right"


def test_a_model_mujoco_would_not_find_is_refused(tmp_path: Path) -> None:
    bundle = Bundle({"arm.xml": b"<mujoco/>"}, "arm.xml")
    with pytest.raises(OutputError) as caught:
        write_archive(bundle, tmp_path / "robot.mjz", {})
    assert caught.value.code == "output-kind"
    assert caught.value.help == "name the archive `arm.mjz`"
    assert os.listdir(tmp_path) == []
    write_archive(bundle, tmp_path / "arm.mjz", {})
    assert engine.compile(tmp_path, "arm.mjz").ok


@pytest.mark.parametrize(
    ("epoch", "date"),
    [
        ("1700000000", (2023, 11, 14, 22, 13, 20)),
        ("1700000001", (2023, 11, 14, 22, 13, 20)),
        ("0", (1980, 1, 1, 0, 0, 0)),
        ("-5", (1980, 1, 1, 0, 0, 0)),
        ("99999999999999999999999999", (2107, 12, 31, 23, 59, 58)),
        ("", (1980, 1, 1, 0, 0, 0)),
    ],
)
def test_source_date_epoch_is_clamped_to_what_a_zip_can_tell(
    tmp_path: Path, epoch: str, date: tuple[int, ...]
) -> None:
    write_archive(BUNDLE, tmp_path / "a.zip", {"SOURCE_DATE_EPOCH": epoch})
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {date}


@pytest.mark.parametrize("epoch", ["now", "1.5", "-", "١"])
def test_a_source_date_epoch_that_is_no_number_is_told(tmp_path: Path, epoch: str) -> None:
    with pytest.raises(OutputError, match="SOURCE_DATE_EPOCH"):
        write_archive(BUNDLE, tmp_path / "a.zip", {"SOURCE_DATE_EPOCH": epoch})
    assert os.listdir(tmp_path) == []


SCRIPT = """
import os, sys
from pathlib import Path
os.umask(int(sys.argv[2], 8))
from composer.bundle import Bundle
from composer.bundle.write import write
paths = {f"assets/{name}.obj" for name in "abcdefghij"}  # in the order of this process's hashes
bundle = Bundle({path: path.encode() * 999 for path in paths} | {"model.xml": b"<mujoco/>" * 99})
write(bundle, sys.argv[1], environment={})
"""


def test_its_bytes_do_not_depend_on_where_when_and_how_it_is_written(tmp_path: Path) -> None:
    digests = set()
    root = str(Path(engine.__file__).parents[2])
    for number, (zone, umask, seed) in enumerate(
        [("UTC", "022", "1"), ("Pacific/Auckland", "077", "2"), ("America/New_York", "000", "3")]
    ):
        folder = tmp_path / f"folder{number}"
        folder.mkdir()
        environment = {**os.environ, "TZ": zone, "PYTHONHASHSEED": seed, "PYTHONPATH": root}
        out = f"name{number}.zip" if number else str(tmp_path / "first.mjz")
        subprocess.run(
            [sys.executable, "-c", SCRIPT, out, umask], cwd=folder, env=environment, check=True, timeout=60
        )
        digests.add(hashlib.sha256((folder / out).read_bytes()).hexdigest())
    assert len(digests) == 1


def test_a_failure_leaves_the_old_archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "a.zip"
    out.write_bytes(b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr("composer.bundle.archive._copy", full)
    with pytest.raises(OutputError, match="no space left on device"):
        write_archive(BUNDLE, out, {})
    assert out.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.zip"]
