"""The files of a commit, byte for byte: no filter, attribute or line ending of this machine touches them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from composer.sources.error import SourceError
from composer.sources.git_command import Git
from composer.sources.unpack import Unsafe, check_name, limits

_LINK, _MODULE = "120000", "160000"
_BATCH = 500
_PATH_MAX = 4096
_NOTHING = "a link to what is not in the commit, `{}`"


@dataclass(frozen=True, slots=True)
class _Blob:
    mode: str
    name: str
    hash: str
    size: int


def write_tree(git: Git, repository: Path, commit: str, target: Path) -> dict[str, str]:
    """Write the files of a commit below `target`, an empty folder. What was left out, by its path, in words.

    A link to a file or folder of the same commit becomes that; other links and submodules are left out. Raises
    SourceError for a tree whose names lead out of the folder, GitFailure, and OSError.
    """
    blobs = _listed(git.run("ls-tree", "-r", "-z", "-l", "--full-tree", commit, folder=repository))
    left_out = {blob.name: "a submodule, which is not fetched" for blob in blobs if blob.mode == _MODULE}
    contents = _Contents(git, repository)
    files = {blob.name: blob for blob in blobs if blob.mode not in (_MODULE, _LINK)}
    try:
        _check(blob for blob in blobs if blob.mode != _MODULE)
        links = [blob for blob in blobs if blob.mode == _LINK and blob.size < _PATH_MAX]
        written = dict(files)
        _follow(links, contents, files, written, left_out)
        _check(written.values())
    except Unsafe as fault:
        raise SourceError("archive-refused", f"the commit `{commit[:12]}` is refused: {fault}") from None
    pairs = list(written.items())
    for start in range(0, len(pairs), _BATCH):
        batch = pairs[start : start + _BATCH]
        for (name, _), content in zip(batch, contents.read([blob for _, blob in batch]), strict=True):
            path = target / name
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as stream:
                stream.write(content)
    return left_out


def _check(blobs: Iterable[_Blob]) -> None:
    known = list(blobs)
    limits.check(len(known), sum(blob.size for blob in known))
    for blob in known:
        check_name(blob.name)


def _follow(
    links: list[_Blob],
    contents: _Contents,
    files: dict[str, _Blob],
    written: dict[str, _Blob],
    left_out: dict[str, str],
) -> None:
    """Put what links lead to into `written`, under their names; or the links into `left_out`."""
    targets = {
        link.name: content.decode("utf-8", "surrogateescape")
        for link, content in zip(links, contents.read(links), strict=True)
    }
    real = {name: _real(name, targets) for name in targets}
    for name, leads_to in real.items():
        if leads_to is None:
            left_out[name] = _NOTHING.format(targets[name])
        elif leads_to in files:
            written[name] = files[leads_to]
        elif f"{name}/".startswith(f"{leads_to}/") or not leads_to:
            left_out[name] = "a link to a folder that it is in"
        else:
            inside = f"{leads_to}/"
            found = {each: each for each in files if each.startswith(inside)}
            found |= {each: to for each, to in real.items() if to in files and each.startswith(inside)}
            for each, to in found.items():
                written[f"{name}/{each.removeprefix(inside)}"] = files[to]
                limits.check(len(written), 0)
            if not found:
                left_out[name] = _NOTHING.format(targets[name])


def _real(path: str, targets: Mapping[str, str], patience: int = 16) -> str | None:
    """The path of what is there, without links on the way; None where that is no path of the commit. No I/O.

    >>> _real("a/b/c.xml", {"a/b": "../d"})
    'd/c.xml'
    """
    parts = path.split("/")
    done: list[str] = []
    for at, part in enumerate(parts, 1):
        if part in ("", "."):
            continue
        if part == "..":
            if not done:
                return None
            done.pop()
            continue
        target = targets.get("/".join([*done, part]))
        if target is None:
            done.append(part)
        elif target.startswith("/") or not patience:
            return None
        else:
            return _real("/".join([*done, target, *parts[at:]]), targets, patience - 1)
    return "/".join(done)


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
