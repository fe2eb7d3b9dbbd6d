from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mjcompose
import pytest
from mjcompose.bundle.bundle import Bundle, OutputError, OutputForm, form_of
from mjcompose.bundle.read import read
from mjcompose.bundle.write import (
    BackgroundPacker,
    Packed,
    level_of,
    pack,
    packed_from_bytes,
    packed_to_bytes,
    write,
    write_archive,
    write_text,
)
from mjcompose.mujoco import convert, engine
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

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
def test_mujoco_opens_it_from_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
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
def test_source_date_epoch_is_clamped_to_what_a_zip_can_tell(tmp_path: Path, epoch: str, date: tuple[int, ...]) -> None:
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
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.write import write
paths = {f"assets/{name}.obj" for name in "abcdefghij"}  # in the order of this process's hashes
bundle = Bundle({path: path.encode() * 999 for path in paths} | {"model.xml": b"<mujoco/>" * 99})
write(bundle, sys.argv[1], environment={})
"""


def test_its_bytes_do_not_depend_on_where_when_and_how_it_is_written(tmp_path: Path) -> None:
    digests = set()
    root = str(Path(mjcompose.__file__).parents[1])
    for number, (zone, umask, seed) in enumerate(
        [("UTC", "022", "1"), ("Pacific/Auckland", "077", "2"), ("America/New_York", "000", "3")]
    ):
        folder = tmp_path / f"folder{number}"
        folder.mkdir()
        environment = {**os.environ, "TZ": zone, "PYTHONHASHSEED": seed, "PYTHONPATH": root}
        out = f"name{number}.zip" if number else str(tmp_path / "first.mjz")
        subprocess.run([sys.executable, "-c", SCRIPT, out, umask], cwd=folder, env=environment, check=True, timeout=60)
        digests.add(hashlib.sha256((folder / out).read_bytes()).hexdigest())
    assert len(digests) == 1


def test_a_failure_leaves_the_old_archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "a.zip"
    out.write_bytes(b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr("mjcompose.bundle.write._copy", full)
    with pytest.raises(OutputError, match="no space left on device"):
        write_archive(BUNDLE, out, {})
    assert out.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.zip"]


PACKING_BUNDLE = Bundle(
    {"model.xml": b"<mujoco/>" * 99, "assets/a.stl": bytes(range(256)) * 40, "assets/a.png": b"png" * 99}
)


def test_a_zip_of_what_is_packed_is_as_python_makes_it(tmp_path: Path) -> None:
    write_archive(PACKING_BUNDLE, tmp_path / "ours.zip", {})
    with zipfile.ZipFile(tmp_path / "theirs.zip", "w") as archive:
        for path in ("model.xml", "assets/a.png", "assets/a.stl"):
            info = zipfile.ZipInfo(path)
            info.create_system = 3
            info.external_attr = 0o100644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED if level_of(path) else zipfile.ZIP_STORED
            archive.writestr(info, PACKING_BUNDLE.files[path], compresslevel=level_of(path) or None)
    assert (tmp_path / "ours.zip").read_bytes() == (tmp_path / "theirs.zip").read_bytes()


def test_what_was_packed_before_is_copied(tmp_path: Path) -> None:
    kept: dict[str, Packed] = {path: pack(content, level_of(path)) for path, content in PACKING_BUNDLE.files.items()}
    write_archive(PACKING_BUNDLE, tmp_path / "now.zip", {})
    write_archive(PACKING_BUNDLE, tmp_path / "kept.zip", {}, lambda bundle, path: kept[path])
    assert (tmp_path / "now.zip").read_bytes() == (tmp_path / "kept.zip").read_bytes()


def test_wrapping() -> None:
    packed = pack(b"abc" * 50, 6)
    assert packed_from_bytes(packed_to_bytes(packed)) == packed


def test_files_are_packed_ahead_but_for_those_that_are_known_and_those_that_are_packed_already() -> None:
    known = Packed(1, 2, b"known")
    find = {PACKING_BUNDLE.digest("assets/a.stl"): known}.get
    ahead = BackgroundPacker(PACKING_BUNDLE, lambda digest, level: find(digest))
    text = PACKING_BUNDLE.files["model.xml"]
    assert ahead.take(PACKING_BUNDLE.digest("model.xml")) == (pack(text, level_of("model.xml")), True)
    assert ahead.take(PACKING_BUNDLE.digest("assets/a.stl")) == (known, False)
    assert ahead.take(PACKING_BUNDLE.digest("assets/a.png")) is None
    ahead.end()
    assert ahead.take(PACKING_BUNDLE.digest("model.xml")) is None


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


ROOT = Path(__file__).resolve().parents[2]
BALL = Bundle({"model.xml": b'<mujoco model="ball"><worldbody><geom size="1"/><camera/></worldbody></mujoco>'})
needs_converter = pytest.mark.skipif(
    find_spec("mujoco_usd_converter") is None, reason="mujoco-usd-converter (the extra `usd`) is not installed"
)


@pytest.mark.parametrize("name", ["a.usd", "a.usda", "a.USDC", "a.usdz"])
def test_names_of_usd(name: str) -> None:
    assert form_of(name) is OutputForm.USD


def test_without_the_converter_the_line_to_install_it_is_told(tmp_path: Path) -> None:
    def missing(*_: Any) -> convert.Exported:
        return convert.Exported(missing="No module named 'mujoco_usd_converter'")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(convert, "export_usd", missing)
        with pytest.raises(OutputError) as caught:
            write(BALL, tmp_path / "ball.usdz", environment={})
    assert caught.value.code == "usd-missing"
    assert 'pip install "mjcompose[usd]"' in (caught.value.help or "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(find_spec("mujoco_usd_converter") is not None, reason="the converter is installed")
def test_the_child_says_that_it_is_missing(tmp_path: Path) -> None:
    with engine.Session() as session:
        exported = convert.export_usd(tmp_path / "model.xml", tmp_path / "a.usda", session)
    assert exported.missing is not None and exported.error is None


@needs_converter
def test_the_demo_cell_is_exported_with_its_textures(tmp_path: Path) -> None:
    built = build(ModelRequest(ROOT / "recipes" / "demo.yaml"), Context(folder=tmp_path))
    assert built is not None
    heard: list[str] = []
    write(built.bundle, tmp_path / "demo.usdz", environment={}, warn=heard.append)
    with zipfile.ZipFile(tmp_path / "demo.usdz") as package:
        assert {Path(name).suffix for name in package.namelist()} == {".usdc", ".png"}
    assert "cameras are not supported" in heard
    with pytest.raises(OutputError, match="cannot hold the 1 textures"):
        write(built.bundle, tmp_path / "demo.usda", environment={})
    assert not (tmp_path / "demo.usda").exists()


@needs_converter
@pytest.mark.parametrize("name", ["cell.usdz", "cell.usda", "cell.usdc"])
def test_the_same_model_is_the_same_bytes(tmp_path: Path, name: str) -> None:
    """With meshes that are there several times, which USD shares and numbers in an order of its own."""
    built = build(ModelRequest(ROOT / "recipes" / "arm_gripper.yaml"), Context(folder=tmp_path))
    assert built is not None
    for folder in ("one", "two"):
        write(built.bundle, tmp_path / folder / name, environment={"SOURCE_DATE_EPOCH": "1700000000"})
    one = (tmp_path / "one" / name).read_bytes()
    assert one == (tmp_path / "two" / name).read_bytes()
    assert b"/tmp" not in one
    if name == "cell.usdz":
        with zipfile.ZipFile(tmp_path / "one" / name) as package:
            assert {info.date_time[:3] for info in package.infolist()} == {(2023, 11, 14)}
            assert package.testzip() is None


@needs_converter
def test_a_layer_of_its_own(tmp_path: Path) -> None:
    write(BALL, tmp_path / "ball.usda", environment={})
    text = (tmp_path / "ball.usda").read_text()
    assert text.startswith("#usda") and "def Sphere" in text


@needs_converter
@pytest.mark.slow
def test_usd_for_isaac_has_every_mass(tmp_path: Path) -> None:
    """The plain model has an inertia for each body; USD alone has those that are written."""
    from cli.shell import run
    from pxr import Usd, UsdPhysics

    result = run("build", str(ROOT / "recipes" / "demo.yaml"), "--target", "isaac", "-o", str(tmp_path / "demo.usdz"))
    assert result.exit_code == 0, result.output
    bundle = tmp_path / "demo"
    assert run("build", str(ROOT / "recipes" / "demo.yaml"), "-o", str(bundle)).exit_code == 0
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(bundle / "model.xml"))
    stage = Usd.Stage.Open(str(tmp_path / "demo.usdz"))
    masses = [UsdPhysics.MassAPI(prim) for prim in stage.TraverseAll() if prim.HasAPI(UsdPhysics.MassAPI)]
    total = sum(each.GetMassAttr().Get() or 0 for each in masses)
    assert total == pytest.approx(model.body_mass.sum(), rel=1e-5)


WRITE_BUNDLE = Bundle({"model.xml": b'<mujoco><worldbody><body name="b"/></worldbody></mujoco>'})


@pytest.mark.parametrize(
    ("out", "form"),
    [
        ("arm", OutputForm.FOLDER),
        ("a.b/", OutputForm.FOLDER),
        ("arm.zip", OutputForm.ARCHIVE),
        ("arm.MJZ", OutputForm.ARCHIVE),
        ("v1.2.mjz", OutputForm.ARCHIVE),
        ("x/arm.xml", OutputForm.TEXT),
        ("arm.mjb", OutputForm.MJB),
        (".hidden", OutputForm.FOLDER),
    ],
)
def test_the_name_tells_the_form(out: str, form: OutputForm) -> None:
    assert form_of(out) is form


def test_a_folder_that_is_there_is_a_folder_whatever_its_name(tmp_path: Path) -> None:
    (tmp_path / "arm.v2").mkdir()
    assert form_of(tmp_path / "arm.v2") is OutputForm.FOLDER


@pytest.mark.parametrize("out", ["arm.glb", "arm.yaml", "arm.tar.gz", "ur5e.v2"])
def test_other_names_are_refused_with_what_to_write(out: str, tmp_path: Path) -> None:
    with pytest.raises(OutputError) as caught:
        write(WRITE_BUNDLE, tmp_path / out, environment={})
    assert caught.value.code == "output-kind"
    assert caught.value.help is not None and f"{out}/" in caught.value.help
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("out", ["arm/", "arm.zip", "arm.mjz", "arm.xml", "arm.mjb"])
def test_every_form_opens_in_mujoco_from_another_folder(
    out: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mujoco = pytest.importorskip("mujoco")
    form = write(WRITE_BUNDLE, f"{tmp_path}/{out}", environment={})
    monkeypatch.chdir("/")
    path = tmp_path / out
    if form is OutputForm.MJB:
        assert mujoco.MjModel.from_binary_path(str(path)).nbody == 2
    else:
        folder, name = (path, "model.xml") if form is OutputForm.FOLDER else (path.parent, path.name)
        assert engine.compile(folder, name).sizes["nbody"] == 2


@pytest.mark.parametrize("out", ["arm/", "arm.zip", "arm.mjz"])
def test_what_was_written_can_be_read(out: str, tmp_path: Path) -> None:
    write(WRITE_BUNDLE, f"{tmp_path}/{out}", environment={})
    assert read(tmp_path / out) == WRITE_BUNDLE
    assert read(tmp_path / out).sha256 == WRITE_BUNDLE.sha256
