from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.manifest import Manifest, files_of, from_json, with_manifest
from composer.bundle.output_error import OutputError
from composer.bundle.read import read
from composer.bundle.shared import share, write_shared

MODEL = b"""<mujoco>
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
        "model.xml": MODEL, "assets/arm/base.obj": base, "assets/hand/base.obj": b"second",
        "assets/r & l.png": b"third", "LICENSES/arm/LICENSE": b"free",
    }  # fmt: skip
    plain = Bundle(files)
    return with_manifest(plain, Manifest(name="m", mujoco=None, grammar="4", files=files_of(plain)))


def test_names_tell_content_and_models_keep_the_names_of_their_meshes() -> None:
    own, assets = share(bundle())
    assert sorted(own.files) == ["LICENSES/arm/LICENSE", "manifest.json", "model.xml"]
    assert sorted(name.rpartition("-")[0] for name in assets) == ["base", "base", "r & l"]
    text = own.files["model.xml"].decode()
    assert 'name="base"' in text
    assert text.count("../assets/") == 4
    assert own.files == share(bundle())[0].files
    listed = {file.path: file.sha256 for file in from_json(own.files[MANIFEST]).files}
    assert listed["model.xml"] == own.digest("model.xml")
    assert sum(path.startswith("../assets/base-") for path in listed) == 2


def test_models_share_what_is_equal(tmp_path: Path) -> None:
    write_shared(bundle(), tmp_path / "a")
    write_shared(bundle(b"another"), tmp_path / "b")
    assert len(list((tmp_path / "assets").iterdir())) == 4
    assert not (tmp_path / "a" / "assets").exists()
    write_shared(bundle(), tmp_path / "a")
    with pytest.raises(OutputError, match="is that of the assets"):
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
