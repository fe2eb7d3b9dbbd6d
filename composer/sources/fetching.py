"""The rules for fetching in a run, what it has fetched, and the context for looking up a reference."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.reading.door import ALL, Door
from composer.reading.folders import real_path
from composer.reading.project import folder_of_recipe, own_door
from composer.sources.digest import sha256_of
from composer.sources.origin import Origin
from composer.sources.trust import Trust

if TYPE_CHECKING:
    from composer.sources.lock import Lock
    from composer.sources.source import Source


def quiet(message: str) -> None:
    """Discard progress messages."""


@dataclass(slots=True)
class Fetching:
    """The rules and the memory of one run.

    `offline`: nothing is fetched, and a source that is not in the store is an error. `locked`: a source that the
    lock does not pin is an error. `remakes_shapes`: the lock is being made, and need not have the shapes of meshes.
    `lock` is the lock of the recipe, `lock_file` its path, whether it exists or not,
    `recipe` the recipe's name in messages. `fresh` are the origins whose pin is ignored, None for all of them.
    `origins` are the origins resolved in this run, by id, so that all parts see the same commit of a moving branch.
    `first` has the first file requested from each. `digests` has the sha256 of files, `files` the files of sources,
    computed once for all cells of a matrix. `outer` is the outermost recipe, `trust` what it allows, `doors` what
    models may read.
    """

    offline: bool = False
    locked: bool = False
    remakes_shapes: bool = False
    lock: Lock | None = None
    lock_file: Path | None = None
    recipe: str = "RECIPE"
    fresh: frozenset[str] | None = frozenset()
    progress: Callable[[str], None] = quiet
    origins: dict[str, Origin] = field(default_factory=dict)
    first: dict[str, Source] = field(default_factory=dict)
    digests: dict[Path, str] = field(default_factory=dict)
    files: dict[Source, list[Path]] = field(default_factory=dict)
    outer: Path | None = None
    trust: Trust = field(default_factory=Trust)
    doors: dict[tuple[Path, Path | None, Trust], Door] = field(default_factory=dict)

    def digest(self, path: Path) -> str:
        """Return the sha256 of a file, which is read once. Raises OSError."""
        if path not in self.digests:
            self.digests[path] = sha256_of(path)
        return self.digests[path]

    def forget(self) -> None:
        """Forget what was fetched and read, because it is damaged."""
        self.origins.clear()
        self.first.clear()
        self.digests.clear()
        self.files.clear()
        self.doors.clear()

    def around(self, path: Path) -> Origin | None:
        """Return the origin that a file or folder belongs to; the innermost if origins are nested."""
        if not self.origins:
            return None
        real = Path(real_path(path))
        found = [each for each in self.origins.values() if real.is_relative_to(real_path(each.root))]
        return max(found, key=lambda each: len(real_path(each.root)), default=None)

    def door_of_text(self, folder: Path) -> Door:
        """Return what a recipe in a folder may name by path.

        The user's own recipes may name anything, others only files of their origin.
        """
        origin = self.around(folder)
        return ALL if origin is None else self.door_of_origin(origin)

    def door_of_origin(self, origin: Origin) -> Door:
        """Return what files of an origin may read: all files of the origin."""
        verb = "fetched" if origin.is_fetched else "installed"
        return Door.of(
            (origin.root, *self.trust.folders),
            f"`{origin.id}`, which may read only what was {verb} with it",
            "what is fetched must hold all that it names; if you trust it with that, write in your own recipe"
            ' `trust: {references: ["{absolute}"]}`',
        )

    def door_of_model(self, path: Path) -> Door:
        """Return what the model at a path may read: its project, that of the recipe, and folders the recipe trusts."""
        key = path, self.outer, self.trust
        if key not in self.doors:
            self.doors[key] = self._own_door(path)
        return self.doors[key]

    def _own_door(self, path: Path) -> Door:
        if self.outer is None:
            return own_door(path, self.trust.files)
        recipe = folder_of_recipe(self.outer)
        return own_door(path, (recipe, *self.trust.files), os.path.dirname(os.path.abspath(self.outer)))

    def pin(self, id: str) -> str | None:
        """Return the commit or sha256 that the lock has for an origin."""
        if self.lock is None or self.fresh is None or id in self.fresh or id not in self.lock.sources:
            return None
        return self.lock.sources[id].pin

    def known_files(self, id: str) -> Mapping[str, str]:
        """Return the files of an origin and their sha256 from the lock; empty if the lock does not have it."""
        if self.lock is None or id not in self.lock.sources:
            return {}
        return self.lock.sources[id].files


@dataclass(frozen=True, slots=True)
class Lookup:
    """The context of a reference: the folder of the file that contains it, the environment, and the run.

    `is_confined` says that the reference is in a fetched recipe, which may not reach this machine or its network.
    """

    folder: Path
    environment: Mapping[str, str]
    fetching: Fetching
    is_confined: bool = False
