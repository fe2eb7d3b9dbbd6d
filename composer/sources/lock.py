"""The lock of a recipe as data: it records every source, so that later builds use the same."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from composer.sources.kind import PINS

FORMAT = 1
_Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
_GitHash = Annotated[str, StringConstraints(pattern=r"^([0-9a-f]{40}|[0-9a-f]{64})$")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)


class Locked(_Part):
    """One source: a repository, an archive, a robot, a package, a file beside the recipe."""

    kind: str
    commit: _GitHash | None = None
    tree: _GitHash | None = None
    sha256: _Sha256 | None = None
    package: str | None = None
    version: str | None = None
    files: dict[str, _Sha256]
    licences: list[str] = Field(default_factory=list)
    used_by: list[str] = Field(default_factory=list)

    @property
    def pin(self) -> str | None:
        """The commit or sha256 that fetches the same bytes again."""
        return self.commit or self.sha256


if missing := {*PINS} - Locked.model_fields.keys():
    raise TypeError(f"kinds of source pin {sorted(missing)}, and a lock has no such field")


class Lock(_Part):
    """All sources of a recipe and its nested recipes, by id; file names are relative to the source.

    `mjcompose` and `mujoco` are the versions that the lock was made with. `shapes` has the sha256 of what was made of
    each mesh and is kept beside the recipe, by its key.
    """

    lock: Literal[1] = 1
    mjcompose: str
    mujoco: str | None
    sources: dict[str, Locked]
    shapes: dict[_Sha256, _Sha256] = Field(default_factory=dict)


def lock_path(recipe: Path) -> Path:
    """Return the path of a recipe's lock: next to it, `arm.lock` for `arm.yaml`. No I/O.

    >>> lock_path(Path("robots/recipe.yaml")).as_posix()
    'robots/recipe.lock'
    """
    return recipe.with_suffix(".lock")


def shapes_folder(lock: Path) -> Path:
    """Where what is made of meshes is kept for everybody: beside the lock, `arm.shapes` for `arm.lock`. No I/O.

    >>> shapes_folder(Path("robots/recipe.lock")).as_posix()
    'robots/recipe.shapes'
    """
    return lock.with_suffix(".shapes")
