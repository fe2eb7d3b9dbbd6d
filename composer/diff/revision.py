"""Check out a git revision into a temporary folder. The repository itself stays as it is."""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from composer.dataclass import dataclass
from composer.diagnostics.error import DiagnosticError
from composer.processes.process import Process
from composer.reading.regular import read_regular
from composer.sources.digest import files_below, sha256_of
from composer.sources.error import SourceError
from composer.sources.fetching import quiet
from composer.sources.git_command import CONFINED, NO_SYSTEM, Git, GitFailure
from composer.sources.git_tree import write_tree
from composer.tree import lfs

_SECONDS = 600
_POINTER = 1024
"""Pointers of Git LFS are smaller, in bytes."""
_LINKS = 5000
"""The most entries that are linked, the nearest first."""
_OID = re.compile(rb"^oid sha256:([0-9a-f]{64})$", re.MULTILINE)
# these variables would direct git to another repository or index than that of the folder
_OWN = ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_PREFIX", "GIT_OBJECT_DIRECTORY")


class RevisionError(DiagnosticError):
    """The revision or its files cannot be read."""


@dataclass(frozen=True, slots=True)
class Tree:
    """The files of a revision: `root` is the folder with them, `path` the requested file in it."""

    root: Path
    path: Path


def split(text: str) -> tuple[str, str] | None:
    """Split `REV:path` in two; return None for anything else, including a Windows drive.

    >>> split("main~2:arms/left.yaml"), split("left.yaml"), split("C:/left.yaml")
    (('main~2', 'arms/left.yaml'), None, None)
    """
    revision, colon, path = text.partition(":")
    if not colon or not revision or not path or (re.fullmatch(r"[A-Za-z]", revision) and path[0] in "/\\"):
        return None
    return revision, path


def check_out(revision: str, path: Path, into: Path, environment: Mapping[str, str]) -> Tree:
    """Write all files of a revision of the repository around `path` below the empty folder `into`.

    Links lead to what the repository refers to outside of it, such as `../models/arm.xml`.
    `path` need not exist any more. Raises RevisionError.
    """
    near = next(each for each in path.absolute().parents if os.path.isdir(each))
    git = _Git(near, {name: value for name, value in environment.items() if name not in _OWN})
    top = Path(git.run("rev-parse", "--show-toplevel", fault=f"`{near}` is not in a git repository"))
    commit = git.run(
        "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}",
        fault=f"the revision `{revision}` does not exist in the repository of `{path.name}`",
    )  # fmt: skip
    inside = Path(
        os.path.relpath(os.path.realpath(near), os.path.realpath(top)), path.absolute().relative_to(near)
    )
    repository = Path(
        git.run("rev-parse", "--absolute-git-dir", fault=f"`{near}` is not in a git repository")
    )
    try:  # byte for byte: runs no filters and hooks, which may come from anyone
        root = _beside_the_same(Path(os.path.realpath(top)), into)
        write_tree(Git(git.environment, quiet), repository, commit, target=root)
        from_lfs(root, _lfs_folder(git))
    except (GitFailure, SourceError, OSError) as error:
        fault = f"the files of revision `{revision}` cannot be checked out"
        raise RevisionError("git-revision", f"{fault}: {error}") from error
    return Tree(root, root / inside)


def _beside_the_same(top: Path, into: Path) -> Path:
    """Return an empty folder below `into` that has, by links, what a repository has beside and around it."""
    into.joinpath(*top.parts[1:]).mkdir(parents=True)
    left = _LINKS
    for folder in top.parents:
        with suppress(OSError), os.scandir(folder) as entries:
            for entry in itertools.islice(entries, left):
                link = into.joinpath(*folder.parts[1:], entry.name)
                if not os.path.lexists(link):
                    with suppress(OSError):  # Windows allows links to some users alone
                        link.symlink_to(entry.path, target_is_directory=os.path.isdir(entry.path))
                left -= 1
    return into.joinpath(*top.parts[1:])


def _lfs_folder(git: _Git) -> Path:
    """Return where Git LFS stores fetched files, for all work trees of the repository."""
    common = git.run("rev-parse", "--git-common-dir", fault="it is not in a repository")
    return git.folder / common / "lfs" / "objects"


def from_lfs(folder: Path, objects: Path) -> None:
    """Replace pointers of Git LFS by their files, if LFS has them on this machine."""
    for _, path in files_below(folder):
        if path.stat().st_size > _POINTER:
            continue
        named = _OID.search(content) if lfs.is_pointer(content := read_regular(path)) else None
        if named is None:
            continue
        digest = named[1].decode()
        stored = objects / digest[:2] / digest[2:4] / digest
        if os.path.isfile(stored) and not stored.is_symlink() and sha256_of(stored) == digest:
            path.unlink()
            shutil.copyfile(stored, path)


@dataclass(slots=True)
class _Git:
    folder: Path
    environment: dict[str, str]

    def run(self, *arguments: str, fault: str) -> str:
        settings = (word for name, value in CONFINED.items() for word in ("-c", f"{name}={value}"))
        if shutil.which("git", path=self.environment.get("PATH", os.defpath)) is None:
            raise RevisionError(
                "git-revision", "the git command is not installed: revisions cannot be read", "install git"
            )
        with Process(
            ["git", *settings, "-C", str(self.folder), *arguments],
            env={**self.environment, **NO_SYSTEM},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        ) as process:
            try:
                out, err = process.communicate(timeout=_SECONDS)
            except subprocess.TimeoutExpired as error:
                raise RevisionError("git-revision", f"{fault}: git took longer than {_SECONDS} s") from error
            finally:
                process.end()
        if process.returncode != 0:
            said = err.decode("utf-8", "replace").strip().splitlines()
            why = said[0].removeprefix("fatal: ") if said else ""
            raise RevisionError("git-revision", f"{fault}: {why}" if why else fault)
        return str(out.decode("utf-8", "surrogateescape")).strip("\n")
