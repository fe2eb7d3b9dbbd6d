"""A unit: one source model as a tree, with everything needed to keep its meaning when it moves."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.reading.door import NOTHING, Door
from composer.tree.adopted import Adopted
from composer.tree.classes import Classes
from composer.tree.files import join
from composer.tree.key import PartKeys
from composer.tree.order import place_of
from composer.tree.origin import Origins
from composer.tree.read_row import ReadRow
from composer.tree.settings import Settings, read_settings


@dataclass(eq=False)
class Unit:
    """One parsed `<mujoco>` tree, with includes expanded.

    `directory` is the folder of the main file, against which MuJoCo resolves every file of the model; `label` names
    the unit's folder in a bundle; `contents` has, by written path, files that are not found under this path on
    disk: their bytes, or a path that passed a door; `door` limits what else the model may read; `part_keys` has the
    keys of each part of a composition, by path (`left/gripper`); `header` are the comments in the root that
    preceded it; `adopted` are the settings that the parts of a composition agree on; `table` says what was read of a
    source that is not MJCF, and what was not. Edits change a unit in place
    and the linker consumes it: call `copied()` first to keep it.
    """

    root: Node
    file: str
    directory: Path
    label: str
    contents: Mapping[str, bytes | Path] = field(default_factory=dict)
    origins: Origins = field(default_factory=Origins)
    part_keys: Mapping[str, PartKeys] = field(default_factory=dict)
    header: tuple[Node, ...] = ()
    adopted: tuple[Adopted, ...] = ()
    door: Door = NOTHING
    table: tuple[ReadRow, ...] = ()

    @cached_property
    def settings(self) -> Settings:
        return read_settings(self.root)

    @cached_property
    def classes(self) -> Classes:
        """The default classes. Their values are live; call `forget_classes` after classes are added or renamed."""
        return Classes(self.root)

    def forget_classes(self) -> None:
        self.__dict__.pop("classes", None)

    def forget_settings(self, *names: str) -> None:
        """Remove compiler settings from the unit, so that MuJoCo's defaults apply, and read the rest again."""
        for compiler in self.root.iterchildren("compiler"):
            for name in names:
                if name in compiler.attrib:
                    del compiler.attrib[name]
        self.__dict__.pop("settings", None)

    @property
    def model(self) -> str:
        return str(self.root.get("model") or "")

    def copied(self) -> Unit:
        """Return a deep copy that shares only file contents."""
        root = copy.deepcopy(self.root)
        origins = self.origins.carried(self.root, root)
        header = tuple(root[self.root.index(comment)] for comment in self.header)
        unit = replace(self, root=root, origins=origins, header=header)
        if self.part_keys:
            copies = dict(zip(self.root.iter(), root.iter(), strict=True))
            unit.part_keys = {path: keys.carried(copies) for path, keys in self.part_keys.items()}
        return unit

    def source_of(self, path: str) -> bytes | Path:
        """Return the bytes of a file by its written path, or its path on disk."""
        return self.contents.get(path, Path(join(str(self.directory), path)))

    def section(self, tag: str) -> Node:
        """Return the last section of that tag, where new elements go; create it if there is none."""
        found = next(self.root.iterchildren(tag, reversed=True), None)
        if found is None:
            found = self.root.makeelement(tag)
            self.insert(found)
        return found

    def insert(self, section: Node) -> None:
        """Insert a new section in its conventional place, below the header."""
        at = self.root.index(self.header[-1]) + 1 if self.header else 0
        self.root.insert(max(at, place_of(self.root, str(section.tag))), section)
