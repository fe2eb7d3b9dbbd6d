"""Repositories and archives that unpack to far more than they are: refused, or unpacked piece by piece."""

from __future__ import annotations

import hashlib
import io
import json
import os
import struct
import subprocess
import sys
import time
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.limits import MIB, allow
from mjcompose.sources.reference import SourceError

PEAK = 512 * MIB
TAKES = """
import json, resource, sys
from pathlib import Path
from mjcompose.base.limits import allow
from mjcompose.sources.reference import SourceError
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve

reference, store, limits = sys.argv[1:]
said = "taken"
try:
    with allow(**json.loads(limits)):
        resolve(reference, relative_to=Path(), environment={"MJCOMPOSE_CACHE": store}, fetching=Fetching())
except SourceError as error:
    said = f"{error.code}: {error.message}"
own = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
peaks = [int(own.split()[1]), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss]
print(json.dumps([said, 1024 * max(peaks)]))
"""


def take_apart(reference: str, store: Path, **limits: int) -> tuple[str, int]:
    """What becomes of a reference in a process of its own, and the most memory of it and its children, in bytes."""
    command = [sys.executable, "-c", TAKES, reference, str(store), json.dumps(limits)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    said, peak = json.loads(done.stdout)
    return said, peak


def with_zeros(robots: Any, sizes: list[int]) -> str:
    for number, size in enumerate(sizes):
        (robots.folder / f"zeros{number}").touch()
        os.truncate(robots.folder / f"zeros{number}", size)
    robots.git("-c", "core.bigFileThreshold=1g", "add", "--all")
    robots.git("commit", "-q", "-m", "a bomb")
    robots.git("tag", "bomb")
    return str(robots.reference("bomb"))


def test_zeros_in_a_repository_are_a_bomb(robots: Any, refused: Callable[..., SourceError], tmp_path: Path) -> None:
    error = refused(with_zeros(robots, [70 * MIB]))
    assert error.code == "archive-refused" and "more than 300 times its size" in error.message
    assert error.help is not None and "--limit source-ratio=" in error.help
    assert sum(path.stat().st_size for path in (tmp_path / "store").rglob("*") if path.is_file()) < MIB


def test_a_repository_that_unpacks_to_more_than_it_may(robots: Any, refused: Callable[..., SourceError]) -> None:
    reference = with_zeros(robots, [3 * MIB, 3 * MIB])
    with allow(source_size=5 * MIB):
        error = refused(reference)
    assert error.code == "archive-refused" and "it unpacks to more than 5M" in error.message


def test_a_pack_that_is_larger_than_it_may_be(robots: Any, refused: Callable[..., SourceError]) -> None:
    (robots.folder / "noise").write_bytes(os.urandom(3 * MIB))
    robots.git("add", "--all")
    robots.git("commit", "-q", "-m", "noise")
    with allow(source_size=MIB):
        error = refused(robots.reference("main"))
    assert error.code == "archive-refused" and "is larger than 1M" in error.message
    assert error.help == "to allow it, raise the limit: `--limit source-size=2M`"


def test_a_tree_that_holds_itself_many_times(robots: Any, refused: Callable[..., SourceError]) -> None:
    """Ten levels of a folder with ten names for the next: 10,000,000,000 files in a repository of a few kB."""

    def make(kind: str, entries: str) -> str:
        done = subprocess.run(["git", "mktree"], cwd=robots.folder, input=entries, capture_output=True, text=True)
        return done.stdout.strip()

    blob = robots.git("rev-parse", "HEAD:LICENSE")
    tree = make("blob", "".join(f"100644 blob {blob}\tf{number}\n" for number in range(10)))
    for _ in range(9):
        tree = make("tree", "".join(f"040000 tree {tree}\td{number}\n" for number in range(10)))
    robots.git("tag", "tree", robots.git("commit-tree", tree, "-m", "a bomb"))
    begun = time.monotonic()
    with allow(source_files=20_000):
        error = refused(robots.reference("tree"))
    assert error.code == "archive-refused" and "it holds more than 20000 files" in error.message
    assert time.monotonic() - begun < 10


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux counts it")
def test_large_files_of_a_repository_are_never_in_memory_as_a_whole(robots: Any, tmp_path: Path) -> None:
    reference = with_zeros(robots, [600 * MIB, 300 * MIB])
    said, peak = take_apart(reference, tmp_path / "bomb")
    assert said.startswith("archive-refused") and peak < PEAK
    said, peak = take_apart(reference, tmp_path / "meant", source_ratio=10**6)
    assert said == "taken" and peak < PEAK
    sizes = {path.name: path.stat().st_size for path in (tmp_path / "meant").rglob("zeros*")}
    assert sizes == {"zeros0": 600 * MIB, "zeros1": 300 * MIB}


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux counts it")
def test_a_large_zip_is_unpacked_piece_by_piece(web: Any, tmp_path: Path) -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("arm.xml", "<mujoco/>")
        with archive.open("zeros", "w", force_zip64=True) as member:
            for _ in range(600):
                member.write(bytes(MIB))
    web.pages["/a.zip"] = stream.getvalue()
    said, peak = take_apart(f"{web.url}/a.zip#arm.xml", tmp_path / "bomb")
    assert said.startswith("archive-refused") and peak < PEAK
    said, peak = take_apart(f"{web.url}/a.zip#arm.xml", tmp_path / "meant", source_ratio=10**6)
    assert said == "taken" and peak < PEAK


@pytest.mark.parametrize("method", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_member_is_the_fault_of_the_archive(
    web: Any, refused: Callable[..., SourceError], tmp_path: Path, method: int, seed: int
) -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        archive.writestr("arm.xml", b"".join(zlib.crc32(bytes([n % 251])).to_bytes(4, "big") for n in range(9000)))
        start = archive.infolist()[0].header_offset + 30 + len("arm.xml")
        size = archive.infolist()[0].compress_size
    content = bytearray(stream.getvalue())
    at = start + (size * seed) // 4
    content[at : at + 40] = bytes(each ^ 0xA5 for each in content[at : at + 40])
    web.pages["/a.zip"] = bytes(content)
    error = refused(f"{web.url}/a.zip#arm.xml")
    assert error.code == "archive-refused" and "`arm.xml` in it is broken: " in error.message
    assert not list((tmp_path / "store" / "partial").iterdir())


def varint(number: int) -> bytes:
    """A number as packs have it: seven bits a byte, the lowest first."""
    found = bytearray()
    while True:
        low = number & 127
        number = number >> 7
        found.append(low | (128 if number else 0))
        if not number:
            return bytes(found)


def packed(kind: int, content: bytes, before: bytes = b"") -> bytes:
    """An entry of a pack: its kind and size, what it refers to, and its content."""
    size = len(content)
    head = bytearray([kind << 4 | size & 15])
    if size >> 4:
        head[0] |= 128
        head += varint(size >> 4)
    return bytes(head) + before + zlib.compress(content, 9)


def repeated(size: int, times: int) -> bytes:
    """A delta that gives a base of a size so many times; a copy has at most 64 KiB."""
    chunk = 1 << 16
    copies = b"".join(
        bytes([0x80 | 0x01 | 0x02 | 0x04 | 0x08]) + at.to_bytes(4, "little")  # of 64 KiB, where nothing is written
        for at in range(0, size, chunk)
    )
    return varint(size) + varint(size * times) + copies * times


def with_deltas(robots: Any, sizes: tuple[int, ...]) -> str:
    """A repository whose pack has zeros as a chain of deltas, each so many times its base."""
    entries = [packed(3, bytes(1 << 16))]
    size = 1 << 16
    names = []
    for times in sizes:
        back = len(entries[-1])
        offset = bytearray([back & 127])
        while back := back >> 7:
            back -= 1
            offset.insert(0, 128 | back & 127)
        entries.append(packed(6, repeated(size, times), bytes(offset)))
        size *= times
        sha = hashlib.sha1(f"blob {size}\0".encode())
        for _ in range(size >> 16):
            sha.update(bytes(1 << 16))
        names.append(sha.hexdigest())
    pack = b"PACK" + struct.pack(">II", 2, len(entries)) + b"".join(entries)
    pack += hashlib.sha1(pack).digest()
    assert len(pack) < MIB
    path = robots.folder / ".git" / "objects" / "pack" / "pack-bomb.pack"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(pack)
    robots.git("index-pack", str(path))
    tree = "".join(f"100644 blob {name}\tzeros{number}\n" for number, name in enumerate(names))
    done = subprocess.run(["git", "mktree"], cwd=robots.folder, input=tree, capture_output=True, text=True)
    robots.git("tag", "deltas", robots.git("commit-tree", done.stdout.strip(), "-m", "a bomb"))
    return str(robots.reference("deltas"))


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit the data of a process")
def test_git_has_the_memory_that_it_is_given(robots: Any, refused: Callable[..., SourceError]) -> None:
    reference = with_deltas(robots, (200, 4))
    with allow(git_memory=32 * MIB):
        error = refused(reference)
    assert (error.code, error.help) == ("archive-refused", "to allow it, raise the limit: `--limit git-memory=64M`")
    assert "needs more memory than 32M" in error.message


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux counts it")
def test_a_chain_of_deltas_is_stopped_while_it_is_resolved(robots: Any, tmp_path: Path) -> None:
    """A pack of some kB with files of 64 MiB, 640 MiB and 1.2 GiB."""
    reference = with_deltas(robots, (1000, 10, 2))
    said, peak = take_apart(reference, tmp_path / "bomb")
    assert said.startswith("archive-refused") and "needs more memory than 448M" in said, said
    assert peak < PEAK
    assert sum(path.stat().st_size for path in (tmp_path / "bomb").rglob("*") if path.is_file()) < MIB


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as Linux counts it")
def test_many_deltas_that_fit_into_memory_are_a_bomb_too(robots: Any, tmp_path: Path) -> None:
    """A pack of some kB with six files of 128 MiB each, in all far above what it is."""
    reference = with_deltas(robots, (1000, 2, 1, 1, 1, 1))
    said, peak = take_apart(reference, tmp_path / "bomb")
    assert said.startswith("archive-refused") and "more than 300 times its size" in said, said
    assert peak < PEAK
