"""The files of a commit, byte for byte: no filter, attribute or line ending of this machine touches them."""

from __future__ import annotations

import posixpath
from dataclasses import dataclass
from pathlib import Path

from composer.sources.error import SourceError
from composer.sources.git_command import Git
from composer.sources.unpack import Unsafe, check_name, limits

_LINK, _MODULE = "120000", "160000"


@dataclass(frozen=True, slots=True)
class _Blob:
    mode: str
    name: str
    hash: str
    size: int


def write_tree(git: Git, repository: Path, commit: str, target: Path) -> None:
    """Write the files of a commit below `target`, an empty folder.

    A link to a file of the same commit becomes that file; other links and submodules are left out. Raises
    SourceError for a tree whose names lead out of the folder, GitFailure, and OSError.
    """
    blobs = _listed(git.run("ls-tree", "-r", "-z", "-l", "--full-tree", commit, folder=repository))
    files = [blob for blob in blobs if blob.mode != _MODULE]
    try:
        limits.check(len(files), sum(blob.size for blob in files))
        for blob in files:
            check_name(blob.name)
    except Unsafe as fault:
        raise SourceError("archive-refused", f"the commit `{commit[:12]}` is refused: {fault}") from None
    by_name = {blob.name: blob for blob in files}
    contents = _Contents(git, repository)
    for start in range(0, len(files), 500):
        batch = files[start : start + 500]
        for blob, content in zip(batch, contents.read(batch), strict=True):
            found: bytes | None = content
            if blob.mode == _LINK:
                found = _behind(blob, content, by_name, contents)
            if found is not None:
                path = target / blob.name
                path.parent.mkdir(parents=True, exist_ok=True)
                with path.open("xb") as stream:
                    stream.write(found)


def submodules(git: Git, repository: Path, commit: str) -> list[str]:
    """The paths of the submodules of a commit, which are not fetched."""
    listed = _listed(git.run("ls-tree", "-r", "-z", "-l", "--full-tree", commit, folder=repository))
    return [blob.name for blob in listed if blob.mode == _MODULE]


def _listed(out: bytes) -> list[_Blob]:
    found = []
    for line in out.split(b"\0"):
        if line:
            facts, name = line.split(b"\t", 1)
            mode, _, hash, size = facts.decode().split()
            found.append(
                _Blob(mode, name.decode("utf-8", "surrogateescape"), hash, 0 if size == "-" else int(size))
            )
    return found


@dataclass(frozen=True, slots=True)
class _Contents:
    git: Git
    repository: Path

    def read(self, blobs: list[_Blob]) -> list[bytes]:
        asked = "".join(f"{blob.hash}\n" for blob in blobs).encode()
        out = self.git.run("cat-file", "--batch", folder=self.repository, stdin=asked)
        found, at = [], 0
        for _ in blobs:
            line, _, _ = out[at : at + 200].partition(b"\n")
            size = int(line.split()[2])
            at += len(line) + 1
            found.append(out[at : at + size])
            at += size + 1
        return found


def _behind(blob: _Blob, content: bytes, by_name: dict[str, _Blob], contents: _Contents) -> bytes | None:
    """The bytes of the file that a link leads to; None where it leads to none of this commit."""
    for _ in range(8):
        target = content.decode("utf-8", "surrogateescape")
        name = posixpath.normpath(posixpath.join(posixpath.dirname(blob.name), target))
        if target.startswith("/") or name not in by_name:
            return None
        blob = by_name[name]
        content = contents.read([blob])[0]
        if blob.mode != _LINK:
            return content
    return None
