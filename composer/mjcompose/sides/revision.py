"""Checking out the files of a git revision: `REV:path`."""

from __future__ import annotations

import itertools
import os
import re
import shlex
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from mjcompose.base.diagnostic import DiagnosticError
from mjcompose.sources.fetching import quiet
from mjcompose.sources.git_command import Git, GitFailure, GitSilence, objects_around, partial_from, write_tree
from mjcompose.sources.git_repository import replace_by_local
from mjcompose.sources.reference import SourceError

_LINKS = 5000
"""The most entries that are linked, the nearest first."""


class RevisionError(DiagnosticError):
    """The revision or its files cannot be read."""


def split(text: str) -> tuple[str, str] | None:
    """Split `REV:path` in two; return None for anything else, including a Windows drive.

    >>> split("main~2:arms/left.yaml"), split("left.yaml"), split("C:/left.yaml")
    (('main~2', 'arms/left.yaml'), None, None)
    """
    revision, colon, path = text.partition(":")
    if not colon or not revision or not path or (re.fullmatch(r"[A-Za-z]", revision) and path[0] in "/\\"):
        return None
    return revision, path


def check_out(revision: str, path: Path, into: Path, environment: Mapping[str, str]) -> tuple[Path, Path]:
    """Write all files of a revision of the repository around `path` below the empty folder `into`.

    Return the folder with them, and `path` in it. Links lead to the files outside the repository that it refers to,
    such as `../models/arm.xml`. `path` may be missing in the work tree. Raises RevisionError.
    """
    near = next(each for each in path.absolute().parents if os.path.isdir(each))
    git = Git(environment, quiet, limit=600)

    def asked(fault: str, *arguments: str) -> str:
        try:
            return git.around(near, "rev-parse", *arguments)
        except SourceError as error:
            message = "the git command is not installed: revisions cannot be read"
            raise RevisionError("git-revision", message, "install git") from error
        except GitSilence as error:
            help = f"a file of the repository may be a pipe: `find {shlex.quote(str(near))} -type p` lists them"
            raise RevisionError(
                "git-revision", f"the repository around `{near}` cannot be read: {error}", help
            ) from error
        except GitFailure as error:
            why = str(error).partition("\n")[0].removeprefix("fatal: ")
            raise RevisionError("git-revision", f"{fault}: {why}" if why else fault) from error

    outside = f"`{near}` is not in a git repository"
    top = Path(os.path.realpath(asked(outside, "--show-toplevel")))
    missing = f"the revision `{revision}` does not exist in the repository of `{path.name}`"
    if not Path(os.path.realpath(near)).is_relative_to(top):
        message = f"the repository around `{near}` says that its files are in `{top}`"
        help = f"look at the setting `core.worktree` in the `.git` of `{near}`"
        raise RevisionError("git-revision", message, help)
    commit = asked(missing, *"--verify --quiet --end-of-options".split(), f"{revision}^{{commit}}")
    inside = Path(os.path.relpath(os.path.realpath(near), top), path.absolute().relative_to(near))
    try:  # byte for byte: runs no filters and hooks, which may come from anyone
        root = _beside_the_same(top, into)
        with objects_around(git, near) as (reader, repository):
            write_tree(reader, repository, commit, target=root)
        replace_by_local(root, near / asked(outside, "--git-common-dir") / "lfs" / "objects")  # of all work trees
    except (GitFailure, SourceError, OSError) as error:
        fault = f"the files of revision `{revision}` cannot be checked out"
        how = _how_to_complete(git, near, top) if isinstance(error, GitFailure) else None
        raise RevisionError("git-revision", f"{fault}: {error}", how) from error
    return root, root / inside


def _how_to_complete(git: Git, near: Path, top: Path) -> str | None:
    """Return the command that fetches the missing objects of a partial clone; None for other repositories."""
    remote = partial_from(git, near)
    if remote is None:
        return None
    is_here = Path(os.path.realpath(os.curdir)).is_relative_to(top)
    command = ["git", *([] if is_here else ["-C", str(top)]), "fetch", "--refetch", "--no-filter", remote]
    return (
        f"it is a partial clone, and mjcompose fetches nothing for it. If it is your own, run `{shlex.join(command)}`"
    )


def _beside_the_same(top: Path, into: Path) -> Path:
    """Return an empty folder below `into` with links to everything next to and around a repository."""
    into.joinpath(*top.parts[1:]).mkdir(parents=True, exist_ok=True)
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
