"""Models at addresses: whole, refused where others' files are, loaded again, and listed."""

from __future__ import annotations

import json
import shutil
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mjcompose
import pytest
from click.testing import CliRunner, Result
from mjcompose.bundle.bundle import MANIFEST, Bundle, OutputError
from mjcompose.bundle.manifest import Manifest, files_of, from_json, with_manifest
from mjcompose.bundle.read import read
from mjcompose.bundle.remote import split_shared_assets, write_shared
from mjcompose.cli.main import main
from mjcompose.tools.worlds.names import LoadError

fsspec = pytest.importorskip("fsspec", reason="needs `mjcompose[remote]`")

MODEL = (
    '<mujoco><asset><mesh name="m" file="m.obj"/></asset><worldbody><body name="b"><freejoint/>'
    '<geom name="g" type="mesh" mesh="m"/></body></worldbody></mujoco>'
)
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
RECIPE = """\
recipe: 1
name: ball
base: ./model.xml
params: {mass: 1}
edit: [{select: {geom: g}, set: {mass: "${mass}"}}]
matrix: {axes: {mass: [1, 2]}}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    (tmp_path / "model.xml").write_text(MODEL)
    (tmp_path / "m.obj").write_text(MESH)
    (tmp_path / "r.yaml").write_text(RECIPE)
    return tmp_path


@pytest.fixture
def address() -> Iterator[str]:
    found = f"memory://{uuid.uuid4().hex}"
    yield found
    fs = fsspec.filesystem("memory")
    if fs.exists(found):
        fs.rm(found, recursive=True)


def run(*words: str) -> Result:
    return CliRunner().invoke(main, words, prog_name="mjcompose")


def build(out: str, *words: str) -> Result:
    return run("build", "r.yaml", "--all", "--jobs", "1", "-o", out, *words)


def files(address: str) -> dict[str, bytes]:
    fs: Any = fsspec.filesystem("memory")
    top = address.removeprefix("memory:/")
    return {path.removeprefix(f"{top}/"): fs.cat_file(path) for path in fs.find(address)}


@pytest.mark.parametrize(
    ("pattern", "words"),
    [
        ("{name}.zip", ()),
        ("{name}/", ()),
        ("{name}/", ("--shared-assets",)),
        ("{hash}/{name}/", ("--shared-assets",)),
        ("{hash}/{name}.mjb", ()),
    ],
)
def test_an_address_has_what_a_folder_has(folder: Path, address: str, pattern: str, words: tuple[str, ...]) -> None:
    here = build(f"here/{pattern}", *words)
    there = build(f"{address}/{pattern}", *words)
    assert here.exit_code == there.exit_code == 0, there.output
    *said_here, count_here = here.stdout.replace("here/", f"{address}/").splitlines()
    *said_there, count_there = there.stdout.splitlines()
    assert said_there == said_here
    assert count_here == "r.yaml: 2 models built"
    assert count_there in (count_here, f"{count_here}, 2 from the cache")  # which is shared
    written = {
        path.relative_to("here").as_posix(): path.read_bytes() for path in Path("here").rglob("*") if path.is_file()
    }
    assert files(address) == written


def test_what_is_there_is_not_written_again(folder: Path, address: str) -> None:
    build(f"{address}/{{name}}/")
    assert build(f"{address}/{{name}}/").stdout.count("is up to date") == 2
    fsspec.filesystem("memory").rm_file(f"{address}/ball-1/model.xml")
    assert build(f"{address}/{{name}}/").stdout.count("is up to date") == 1
    assert "ball-1/model.xml" in files(address)


def test_what_is_replaced_is_said_and_leaves_nothing(folder: Path, address: str) -> None:
    assert run("build", "r.yaml", "--set", "mass=3", "-o", f"{address}/one/").exit_code == 0
    (folder / "model.xml").write_text(MODEL.replace('file="m.obj"', 'file="n.obj"'))
    (folder / "n.obj").write_text(MESH)
    again = run("build", "r.yaml", "--set", "mass=4", "-o", f"{address}/one/")
    assert "replaced the model with mass = 3" in again.stdout
    assert sorted(files(address)) == ["one/assets/model/n.obj", "one/manifest.json", "one/model.xml"]


def test_files_of_others_are_not_replaced(folder: Path, address: str) -> None:
    fsspec.filesystem("memory").pipe_file(f"{address}/one/notes.txt", b"mine")
    result = run("build", "r.yaml", "-o", f"{address}/one/")
    assert result.exit_code == 1 and "would delete files that mjcompose did not write: `notes.txt`" in result.stderr
    assert sorted(files(address)) == ["one/notes.txt"]


@pytest.mark.parametrize(
    ("out", "code", "said"),
    [
        ("nothing://a/{name}.zip", 1, "error[output-unwritable]: cannot write `nothing://a`: Protocol not known"),
        ("memory://a/{name}.xml", 2, "text alone names files of this machine"),
        ("memory://a/{name}.usdz", 2, "USD is written by MuJoCo's converter"),
    ],
)
def test_what_cannot_be_is_one_error(folder: Path, out: str, code: int, said: str) -> None:
    result = build(out)
    assert result.exit_code == code and result.stderr.count("error[") == 1 and said in result.stderr


@pytest.mark.parametrize("pattern", ["{name}.zip", "{name}/", "{hash}/{name}/"])
def test_models_are_listed_and_loaded(folder: Path, address: str, pattern: str) -> None:
    assert build(f"{address}/{pattern}", *(("--shared-assets",) if "zip" not in pattern else ())).exit_code == 0
    listed = run("list", address, "--where", "mass > 1", "--output-format", "json")
    assert [json.loads(line)["model"] for line in listed.stdout.splitlines()] == ["ball-2"], listed.output
    (found,) = mjcompose.load_many(address, where="mass > 1")
    model, manifest, _ = found.load()
    assert model.nmesh == 1 and manifest.name == "ball-2"
    with pytest.raises(LoadError, match="cannot read `memory://"):
        mjcompose.load(f"{address}/nothing.zip")


def test_parquet_says_the_same(folder: Path, address: str) -> None:
    pytest.importorskip("pyarrow", reason="needs `mjcompose[parquet]`")
    assert build("here/{name}.zip", "--parquet").exit_code == 0
    assert build(f"{address}/{{name}}.zip", "--parquet").exit_code == 0
    rows = [list(mjcompose.load_many(path)) for path in ("here/models.csv", "here/models.parquet")]
    assert rows[0] == rows[1] and len(rows[0]) == 2
    Path("here/models.csv").unlink()
    assert run("list", "here").stdout.count("here/ball-") == 2
    assert run("list", f"{address}/models.parquet").stdout.count(f"{address}/ball-") == 2


SHARED_MODEL = b"""<mujoco>
  <asset>
    <mesh file="assets/arm/base.obj"/>
    <mesh name="other" file="assets/hand/base.obj"/>
    <texture name="sky" type="cube" fileright="assets/r &amp; l.png" fileleft="assets/r &amp; l.png"/>
  </asset>
  <worldbody><geom type="mesh" mesh="base"/><geom type="mesh" mesh="other"/></worldbody>
</mujoco>
"""


def bundle(base: bytes = b"first") -> Bundle:
    files = {
        "model.xml": SHARED_MODEL,
        "assets/arm/base.obj": base,
        "assets/hand/base.obj": b"second",
        "assets/r & l.png": b"third",
        "LICENSES/arm/LICENSE": b"free",
    }
    plain = Bundle(files)
    return with_manifest(plain, Manifest(name="m", mujoco=None, grammar="4", files=files_of(plain)))


def test_names_tell_content_and_models_keep_the_names_of_their_meshes() -> None:
    own, assets = split_shared_assets(bundle())
    assert sorted(own.files) == ["LICENSES/arm/LICENSE", "manifest.json", "model.xml"]
    assert sorted(name.rpartition("-")[0] for name in assets) == ["base", "base", "r & l"]
    text = own.files["model.xml"].decode()
    assert 'name="base"' in text
    assert text.count("../assets/") == 4
    assert own.files == split_shared_assets(bundle())[0].files
    listed = {file.path: file.sha256 for file in from_json(own.files[MANIFEST]).files}
    assert listed["model.xml"] == own.digest("model.xml")
    assert sum(path.startswith("../assets/base-") for path in listed) == 2


def test_models_share_what_is_equal(tmp_path: Path) -> None:
    write_shared(bundle(), tmp_path / "a")
    write_shared(bundle(b"another"), tmp_path / "b")
    assert len(list((tmp_path / "assets").iterdir())) == 4
    assert not (tmp_path / "a" / "assets").exists()
    write_shared(bundle(), tmp_path / "a")
    with pytest.raises(OutputError, match="is for assets"):
        write_shared(bundle(), tmp_path / "assets")


def test_what_is_read_is_whole(tmp_path: Path) -> None:
    write_shared(bundle(), tmp_path / "a")
    found = read(tmp_path / "a")
    listed = {file.path: file.sha256 for file in from_json(found.files[MANIFEST]).files}
    assert listed == {path: found.digest(path) for path in found.files if path != MANIFEST}
    assert sorted(found.files[path] for path in found.files if path.startswith("assets/")) == [
        b"first",
        b"second",
        b"third",
    ]


def test_what_was_changed_is_seen(tmp_path: Path) -> None:
    write_shared(bundle(), tmp_path / "a")
    model = tmp_path / "a" / "model.xml"
    model.write_bytes(model.read_bytes().replace(b'"other"', b'"2nd"', 1))
    found = read(tmp_path / "a")
    listed = {file.path: file.sha256 for file in from_json(found.files[MANIFEST]).files}
    assert listed["model.xml"] != found.digest("model.xml")
    shutil.rmtree(tmp_path / "assets")
    assert not any(path.startswith("assets/") for path in read(tmp_path / "a").files)
    model.write_text("<mujoco")
    assert read(tmp_path / "a").files["model.xml"] == b"<mujoco"


def test_an_asset_that_was_altered_is_written_again(tmp_path: Path) -> None:
    assets = write_shared(bundle(), tmp_path / "a")
    whole = {path: path.read_bytes() for path in assets}
    for path in assets:
        path.write_bytes(bytes(reversed(path.read_bytes())))
    write_shared(bundle(), tmp_path / "b")
    assert {path: path.read_bytes() for path in assets} == whole


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"path": "../assets/', b'"path": {}, "x": "../assets/'),
        (b'"path": "model.xml"', b'"path": true'),
        (b'"params": {}', b'"params": {"a": NaN}'),
        (b'"name": "m"', b'"name": "\\udc80"'),
        (b'"model": "model.xml"', b'"model": ["model.xml"]'),
    ],
)
def test_a_manifest_of_a_stranger(tmp_path: Path, old: bytes, new: bytes) -> None:
    """Files beside the folder are looked for where the manifest is one; what is wrong with it is told elsewhere."""
    write_shared(bundle(), tmp_path / "cell")
    manifest = tmp_path / "cell" / MANIFEST
    assert old in manifest.read_bytes()
    manifest.write_bytes(manifest.read_bytes().replace(old, new, 1))
    assert sorted(read(tmp_path / "cell").files) == ["LICENSES/arm/LICENSE", "manifest.json", "model.xml"]
