"""A revision of a git repository, as files in a temporary folder. The repository itself is left as it is."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from composer.diagnostics.error import DiagnosticError

_SECONDS = 600
# what would send git to another repository or index than that of the folder
_OWN = ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_PREFIX", "GIT_OBJECT_DIRECTORY")


class RevisionError(DiagnosticError):
    """Why there are no such files."""


@dataclass(frozen=True, slots=True)
class Tree:
    """The files of a revision: `root` is the folder that has them, `path` the one that was asked for."""

    root: Path
    path: Path


def split(text: str) -> tuple[str, str] | None:
    """`REV:path` in two; None for anything else, a Windows drive included.

    >>> split("main~2:arms/left.yaml"), split("left.yaml"), split("C:/left.yaml")
    (('main~2', 'arms/left.yaml'), None, None)
    """
    revision, colon, path = text.partition(":")
    if not colon or not revision or not path or (re.fullmatch(r"[A-Za-z]", revision) and path[0] in "/\\"):
        return None
    return revision, path


def check_out(revision: str, path: Path, into: Path, environment: Mapping[str, str]) -> Tree:
    """All files of a revision of the repository that `path` is in, below the empty folder `into`.

    `path` need not exist any more. Raises RevisionError.
    """
    near = next(each for each in path.absolute().parents if each.is_dir())
    git = _Git(near, {name: value for name, value in environment.items() if name not in _OWN})
    top = Path(git.run("rev-parse", "--show-toplevel", fault=f"`{near}` is in no git repository"))
    commit = git.run(
        "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}",
        fault=f"there is no revision `{revision}` in the repository of `{path.name}`",
    )  # fmt: skip
    inside = Path(
        os.path.relpath(os.path.realpath(near), os.path.realpath(top)), path.absolute().relative_to(near)
    )
    with tempfile.TemporaryDirectory(prefix="mjcompose-index-") as folder:
        git.environment["GIT_INDEX_FILE"] = str(Path(folder, "index"))
        fault = f"the files of revision `{revision}` cannot be checked out"
        git.run("read-tree", commit, fault=fault)
        git.folder = top
        git.run("checkout-index", "--all", "--quiet", f"--prefix={into}/", fault=fault)
    return Tree(into, into / inside)


@dataclass(slots=True)
class _Git:
    folder: Path
    environment: dict[str, str]

    def run(self, *arguments: str, fault: str) -> str:
        command = ["git", "-C", str(self.folder), *arguments]
        try:
            done = subprocess.run(
                command, env=self.environment, capture_output=True, timeout=_SECONDS, check=False,
                stdin=subprocess.DEVNULL,
            )  # fmt: skip
        except FileNotFoundError as error:
            raise RevisionError(
                "git-revision", "the git command is not installed: revisions cannot be read", "install git"
            ) from error
        except subprocess.TimeoutExpired as error:
            raise RevisionError("git-revision", f"{fault}: git took longer than {_SECONDS} s") from error
        if done.returncode != 0:
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            why = said[0].removeprefix("fatal: ") if said else ""
            raise RevisionError("git-revision", f"{fault}: {why}" if why else fault)
        return done.stdout.decode("utf-8", "surrogateescape").strip("\n")
