"""Archives that lie, and what becomes of them."""

from __future__ import annotations

import io
import stat
import tarfile
import zipfile
from pathlib import Path

import pytest
from mjcompose.base.limits import allow
from mjcompose.sources import web_archive as module
from mjcompose.sources.web_archive import Unsafe, check_name, unpack


def tar(*members: tuple[str, bytes, bytes], mode: str = "w") -> bytes:
    """Members are name, type and content; the content of a link is what it leads to."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode=mode) as archive:  # type: ignore[call-overload]
        for name, type, content in members:
            member = tarfile.TarInfo(name)
            member.type = type
            if type in (tarfile.SYMTYPE, tarfile.LNKTYPE):
                member.linkname = content.decode()
                archive.addfile(member)
            else:
                member.size = len(content)
                archive.addfile(member, io.BytesIO(content))
    return stream.getvalue()


def zipped(*members: tuple[str, int, bytes], deflated: bool = False) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, mode, content in members:
            info = zipfile.ZipInfo(name)
            info.external_attr = mode << 16
            info.compress_type = zipfile.ZIP_DEFLATED if deflated else zipfile.ZIP_STORED
            archive.writestr(info, content)
    return stream.getvalue()


FILE = stat.S_IFREG | 0o644
WRONG = {
    "tar that escapes": (tar(("../out", tarfile.REGTYPE, b"x")), "leads out"),
    "tar with an absolute path": (tar(("/tmp/out", tarfile.REGTYPE, b"x")), "leads out"),
    "tar with a symbolic link": (tar(("a", tarfile.SYMTYPE, b"/etc/passwd")), "is a link"),
    "tar with a hard link": (tar(("a", tarfile.LNKTYPE, b"/etc/passwd")), "is a link"),
    "tar with a device": (tar(("a", tarfile.CHRTYPE, b"")), "is a device"),
    "tar with a block device": (tar(("a", tarfile.BLKTYPE, b"")), "is a device"),
    "tar with a pipe": (tar(("a", tarfile.FIFOTYPE, b"")), "is a pipe"),
    "tar with a name twice": (tar(("a", tarfile.REGTYPE, b"x"), ("a", tarfile.REGTYPE, b"y")), "twice"),
    "tar with a file as folder": (tar(("a", tarfile.REGTYPE, b"x"), ("a/b", tarfile.REGTYPE, b"y")), "twice"),
    "tar cut off": (tar(("a", tarfile.REGTYPE, b"x" * 5000), mode="w:gz")[:-30], "broken"),
    "zip that escapes": (zipped(("../out", FILE, b"x")), "leads out"),
    "zip that escapes on Windows": (zipped(("..\\out", FILE, b"x")), "leads out"),
    "zip with a drive": (zipped(("C:/out", FILE, b"x")), "leads out"),
    "zip with a link": (zipped(("a", stat.S_IFLNK | 0o777, b"/etc/passwd")), "is a link"),
    "zip with a device": (zipped(("a", stat.S_IFCHR | 0o644, b"")), "is a device"),
    "zip with a file as folder": (zipped(("a", FILE, b"x"), ("a/b", FILE, b"y")), "twice"),
    "zip cut off": (zipped(("a", FILE, b"x" * 500))[:-40], "broken"),
    "neither": (b"hello", "neither a zip nor a tar"),
    "empty": (b"", "neither a zip nor a tar"),
}


@pytest.mark.parametrize("case", WRONG)
def test_refused(tmp_path: Path, case: str) -> None:
    content, problem = WRONG[case]
    target = tmp_path / "deep" / "target"
    target.mkdir(parents=True)
    (tmp_path / "archive").write_bytes(content)
    with pytest.raises(Unsafe, match=problem):
        unpack(tmp_path / "archive", target)
    outside = [path for path in tmp_path.rglob("*") if path.is_file() and target not in path.parents]
    assert outside == [tmp_path / "archive"]


@pytest.mark.parametrize("kind", ["zip", "tar"])
def test_a_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    monkeypatch.setattr(module, "SMALL", 1024 * 1024)
    zeros = bytes(16 * 1024 * 1024)
    content = (
        zipped(("a", FILE, zeros), deflated=True) if kind == "zip" else tar(("a", tarfile.REGTYPE, zeros), mode="w:gz")
    )
    (tmp_path / "archive").write_bytes(content)
    (tmp_path / "target").mkdir()
    with pytest.raises(Unsafe, match="bomb"):
        unpack(tmp_path / "archive", tmp_path / "target")
    assert sum(path.stat().st_size for path in (tmp_path / "target").iterdir()) <= 8 * 1024 * 1024


@allow(source_files=3)
def test_too_many_files(tmp_path: Path) -> None:
    (tmp_path / "archive").write_bytes(tar(*((f"f{i}", tarfile.REGTYPE, b"") for i in range(4))))
    (tmp_path / "target").mkdir()
    with pytest.raises(Unsafe, match="more than 3 files"):
        unpack(tmp_path / "archive", tmp_path / "target")


def test_a_forged_header_does_not_fill_the_memory(tmp_path: Path) -> None:
    member = tarfile.TarInfo("././@LongLink")
    member.type = tarfile.GNUTYPE_LONGNAME
    member.size = 1 << 32
    (tmp_path / "archive").write_bytes(member.tobuf(tarfile.GNU_FORMAT))
    (tmp_path / "target").mkdir()
    with pytest.raises(Unsafe, match="absurd|broken"):
        unpack(tmp_path / "archive", tmp_path / "target")


def test_a_zip_that_is_damaged(tmp_path: Path) -> None:
    content = bytearray(zipped(("a", FILE, b"hello world")))
    at = content.index(b"hello")
    content[at] ^= 1
    (tmp_path / "archive").write_bytes(content)
    (tmp_path / "target").mkdir()
    with pytest.raises(Unsafe, match="broken"):
        unpack(tmp_path / "archive", tmp_path / "target")


@pytest.mark.parametrize(
    "name", ["", "/a", "a/../b", "..", "a\\b", "c:a", "a\nb", "ä" * 128, "/".join(["a" * 99] * 30)]
)
def test_names_that_are_none(name: str) -> None:
    with pytest.raises(Unsafe):
        check_name(name)


def test_names_of_any_length_that_files_have() -> None:
    check_name("a" * 255)
    check_name("/".join(["ä" * 99] * 10))
