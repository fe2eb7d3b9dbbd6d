from __future__ import annotations

import contextlib
import os
import stat
import zipfile
from pathlib import Path
from random import Random

import pytest
from mjcompose.base.limits import allow
from mjcompose.bundle.read import ReadError, read

FILES = {"model.xml": b"<mujoco/>", "assets/a.obj": b"v 0 0 0\n" * 50}


def archive(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        made.mkdir("assets")
        for name, content in files.items():
            made.writestr(name, content)
    return path


def folder(path: Path, files: dict[str, bytes]) -> Path:
    for name, content in files.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_bytes(content)
    return path


def refusal(path: Path, **limits: int) -> str:
    with allow(**limits), pytest.raises(ReadError) as caught:
        read(path)
    assert caught.value.code == "file-unreadable"
    return caught.value.message


def test_a_folder_and_an_archive_give_the_same_bundle(tmp_path: Path) -> None:
    one = read(folder(tmp_path / "one", FILES))
    two = read(archive(tmp_path / "two.zip", FILES))
    assert one == two
    assert one.files == FILES


def test_the_model_is_what_the_manifest_says(tmp_path: Path) -> None:
    files = {"arm.xml": b"<mujoco/>", "model.xml": b"<x/>", "manifest.json": b'{"model": "arm.xml"}'}
    assert read(folder(tmp_path / "a", files)).model == "arm.xml"


@pytest.mark.parametrize("manifest", [b'{"model": "gone.xml"}', b'{"model": 3}', b"[]", b"{", b"\xff", b"{}"])
def test_a_manifest_that_does_not_help_is_passed_over(tmp_path: Path, manifest: bytes) -> None:
    assert read(folder(tmp_path / "a", {**FILES, "manifest.json": manifest})).model == "model.xml"


def test_the_stem_of_the_archive_names_the_model(tmp_path: Path) -> None:
    assert read(archive(tmp_path / "arm.mjz", {"arm.xml": b"<mujoco/>", "z.xml": b""})).model == "arm.xml"
    assert "has neither `model.xml` nor `b.xml`" in refusal(archive(tmp_path / "b.mjz", {"arm.xml": b""}))


def test_what_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(ReadError) as caught:
        read(tmp_path / "gone.zip")
    assert caught.value.code == "file-not-found"


def test_binary_is_told_to_be_no_bundle(tmp_path: Path) -> None:
    (tmp_path / "a.mjb").write_bytes(bytes(100))
    with pytest.raises(ReadError, match="is MuJoCo's binary form, not a bundle: load it"):
        read(tmp_path / "a.mjb")


def test_what_is_no_zip_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.zip").write_bytes(b"PK\x03\x04 and then nothing")
    assert "is not a readable zip" in refusal(tmp_path / "a.zip")


@pytest.mark.parametrize("damage", range(4))
def test_damaged_bytes_are_told(tmp_path: Path, damage: int) -> None:
    path = archive(tmp_path / "a.zip", {**FILES, "noise": os.urandom(500)})
    content = bytearray(path.read_bytes())
    at = content.index(b"noise") + 5 + damage * 40
    content[at : at + 8] = bytes(255 - byte for byte in content[at : at + 8])
    path.write_bytes(content)
    assert refusal(path)


@pytest.mark.parametrize("name", ["../escape", "/etc/escape", "a/../../escape", "a\\b", "C:/x"])
def test_a_path_that_leads_out_is_refused(tmp_path: Path, name: str) -> None:
    assert "cannot be a path in a bundle" in refusal(archive(tmp_path / "a.zip", {**FILES, name: b""}))
    assert os.listdir(tmp_path) == ["a.zip"]


def test_a_path_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as made:
        made.writestr("model.xml", "<a/>")
        with pytest.warns(UserWarning, match="Duplicate name"):
            made.writestr("model.xml", "<b/>")
    assert "has `model.xml` twice" in refusal(tmp_path / "a.zip")


def test_a_link_in_an_archive_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as made:
        made.writestr("model.xml", "<mujoco/>")
        link = zipfile.ZipInfo("assets")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        made.writestr(link, "/etc")
    assert "`assets` in" in refusal(tmp_path / "a.zip")


def test_an_encrypted_archive_is_refused(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.zip", FILES)
    content = bytearray(path.read_bytes())
    central = content.rindex(b"PK\x01\x02")
    content[central + 8] |= 1
    path.write_bytes(content)
    assert "is encrypted" in refusal(path)


@pytest.mark.skipif(os.name != "posix", reason="links and pipes are made as POSIX does")
@pytest.mark.parametrize("kind", ["file", "folder", "nowhere", "pipe"])
def test_links_and_pipes_in_a_folder_are_refused(tmp_path: Path, kind: str) -> None:
    root = folder(tmp_path / "a", FILES)
    odd = root / "odd"
    if kind == "pipe":
        os.mkfifo(odd)
    else:
        odd.symlink_to({"file": "model.xml", "folder": tmp_path, "nowhere": "gone"}[kind])
    assert "`odd` in" in refusal(root)


def test_a_bomb_is_not_unpacked(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.zip", {**FILES, "zeros": bytes(10_000_000)})
    assert path.stat().st_size < 20_000
    assert "holds more than 1000000 bytes" in refusal(path, output_size=1_000_000)


def test_a_bomb_that_lies_about_its_size_is_not_unpacked(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.zip", {**FILES, "zeros": bytes(10_000_000)})
    content = path.read_bytes()
    content = content.replace((10_000_000).to_bytes(4, "little"), (10).to_bytes(4, "little"))
    path.write_bytes(content)
    assert "is not a readable zip" in refusal(path, output_size=1_000_000)


@pytest.mark.parametrize("make", [folder, archive])
def test_too_many_files_are_refused(tmp_path: Path, make: object) -> None:
    files = {**FILES, **{f"f{number}": b"" for number in range(10)}}
    path = (folder if make is folder else archive)(tmp_path / "a", files)
    assert "has more than 5 files" in refusal(path, output_files=5)
    with allow(output_files=12):
        assert len(read(path).files) == 12


def test_a_folder_that_is_too_large_is_refused(tmp_path: Path) -> None:
    assert "holds more than 100 bytes" in refusal(folder(tmp_path / "a", FILES), output_size=100)


def test_the_one_model_that_no_other_names(tmp_path: Path) -> None:
    files = {
        "robot/arm.xml": b'<!-- an arm --><mujoco><include file="parts/hand.xml"/></mujoco>',
        "robot/parts/hand.xml": b"<mujoco/>",
        "package.xml": b"<package/>",
    }
    assert read(archive(tmp_path / "a.zip", files)).model == "robot/arm.xml"
    assert "several other models: `a.xml`, `b.xml`" in refusal(
        archive(tmp_path / "c.zip", {"a.xml": b"<mujoco/>", "b.xml": b"<mujoco/>"})
    )


def test_text_is_told_to_be_no_bundle(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("<mujoco/>")
    assert "is text alone" in refusal(tmp_path / "a.xml")


def _zip_with_lzma(path: Path) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_LZMA) as made:
        made.writestr("model.xml", b"<mujoco>" + bytes(range(256)) * 8)
    return path


@pytest.mark.parametrize("seed", range(40))
def test_a_damaged_archive_is_told(tmp_path: Path, seed: int) -> None:
    """Python's reader of zips raises many things: IndexError for a file without a name, LZMAError, …"""
    random = Random(seed)
    path = _zip_with_lzma(tmp_path / "a.zip")
    data = bytearray(path.read_bytes())
    for _ in range(random.randint(1, 6)):
        data[random.randrange(len(data))] = random.randrange(256)
    path.write_bytes(data)
    with contextlib.suppress(ReadError):
        read(path)


def test_a_file_without_a_name_is_told(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.zip", {"q": b""})
    # in the two places where a zip has the length of a name, and the name
    path.write_bytes(path.read_bytes().replace(b"\x01\0\0\0q", b"\0\0\x01\0q").replace(b"PK\1\2", b"PK\1\2"))
    data = bytearray(path.read_bytes())
    at = data.rindex(b"PK\1\2")
    data[at + 28 : at + 30] = b"\0\0"
    data[at + 30 : at + 32] = b"\1\0"
    path.write_bytes(data)
    assert "a.zip` is not a" in refusal(path)


def test_a_model_that_expands_without_end(tmp_path: Path) -> None:
    text = '<mujoco><worldbody><replicate count="2000000000"><geom size=".1"/></replicate></worldbody></mujoco>'
    (tmp_path / "model.xml").write_text(text)
    with pytest.raises(ReadError, match="`<replicate>` makes 1999999999 elements; 20000 are allowed") as caught:
        read(tmp_path)
    assert caught.value.code == "limit-exceeded"
    (tmp_path / "part.xml").write_text(text.replace("mujoco>", "mujocoinclude>"))
    (tmp_path / "model.xml").write_text('<mujoco><include file="part.xml"/></mujoco>')
    with pytest.raises(ReadError, match="elements; 20000 are allowed"):
        read(tmp_path)
