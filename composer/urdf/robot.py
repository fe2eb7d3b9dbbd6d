"""A URDF on its way to MuJoCo: its tree, where each element is written, and the text that MuJoCo is to read."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import field
from functools import partial
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.sources import ros_package
from composer.tree.files import join
from composer.tree.origin import Origins
from composer.tree.unit import Unit

PACKAGE = "package://"
SCHEMES = (PACKAGE, "model://")
_FILE = "file://"


@dataclass(frozen=True, slots=True)
class Look:
    """What a mesh or a material of URDF looks like: a colour, and a picture as PNG, each None where it has none."""

    rgba: tuple[float, ...] | None
    texture: bytes | Path | None = None


@dataclass(slots=True)
class Robot:
    """`unit` has the tree of the URDF, `packages` where the packages are that it names.

    As long as nothing `changed`, MuJoCo reads the file itself. `made` has the meshes that were made for it, by the name
    that the tree has for each, and `looks` what these look like.
    """

    unit: Unit
    path: Path
    packages: Mapping[str, Path]
    changed: bool = False
    made: dict[str, bytes] = field(default_factory=dict)
    looks: dict[str, Look] = field(default_factory=dict)

    @property
    def root(self) -> Node:
        return self.unit.root

    def setting(self, name: str) -> str | None:
        """An attribute of `<mujoco><compiler>`: the last one counts, as for MuJoCo."""
        found = [
            each.get(name) for each in self.root.iterfind("mujoco/compiler") if each.get(name) is not None
        ]
        return None if not found else str(found[-1])

    def set(self, name: str, value: str) -> None:
        """Set an attribute of `<mujoco><compiler>`."""
        if self.setting(name) == value:
            return
        self.changed = True
        holders = self.root.findall("mujoco/compiler")
        if not holders:
            holder = self.root.find("mujoco")
            if holder is None:
                holder = etree.SubElement(self.root, "mujoco")
            holders = [etree.SubElement(holder, "compiler")]
        for each in holders:
            each.set(name, value)

    @property
    def keeps_visuals(self) -> bool:
        return self.setting("discardvisual") == "false"

    def file_of(self, written: str) -> Path | None:
        """The file that a `filename` stands for; None for one in a package that is not known."""
        for scheme in SCHEMES:
            if written.startswith(scheme):
                name, _, inside = written.removeprefix(scheme).lstrip("/").partition("/")
                return self.packages[name] / inside if name in self.packages else None
        if written.startswith(_FILE):
            written = written.removeprefix(_FILE)
        elif self.setting("strippath") == "true":
            written = written.replace("\\", "/").rpartition("/")[2]
        folder = join(str(self.path.parent.absolute()), self.setting("meshdir") or "")
        return Path(join(folder, written))

    def simplified(self) -> None:
        """Let the tree name files as MuJoCo does, which knows `package://` alone."""
        for mesh in self.root.iterfind("link/*/geometry/mesh"):
            written = str(mesh.get("filename") or "")
            if written.startswith(f"{PACKAGE}/"):
                mesh.set("filename", PACKAGE + written.removeprefix(PACKAGE).lstrip("/"))
            elif written.startswith(_FILE):
                mesh.set("filename", written.removeprefix(_FILE))
            elif written.startswith("model://"):
                mesh.set("filename", "package://" + written.removeprefix("model://"))
            else:
                continue
            self.changed = True

    def text(self) -> str | None:
        """What MuJoCo is to read, None for the file itself; the tree is then that of the text, line by line."""
        if not self.changed:
            return None
        etree.cleanup_namespaces(self.root)
        # A line for each element: MuJoCo says where it stumbles by the line alone.
        text = etree.tostring(self.root, encoding="unicode", pretty_print=True)
        parser = etree.XMLParser(
            huge_tree=True, resolve_entities=False, no_network=True, remove_blank_text=True
        )
        new = etree.fromstring(text, parser)
        origins = Origins(texts=self.unit.origins.texts)
        for old, element in zip(self.root.iter("*"), new.iter("*"), strict=True):
            origins.own(element, partial(_written, self.unit.origins, old, self.unit.file))
        self.unit.root, self.unit.origins = new, origins
        return text

    def copied(self, element: Node) -> Node:
        """A copy that stands right before an element, and at its place."""
        new = copy.deepcopy(element)
        for old, each in zip(element.iter("*"), new.iter("*"), strict=True):
            owner = self.unit.origins.owner(old, self.unit.file)
            if owner is not self.unit.file:
                self.unit.origins.own(each, owner)
        element.addprevious(new)
        return new


def _written(origins: Origins, element: Node, file: str, attribute: str | None) -> Span:
    return origins.span(element, file, attribute)


def known_packages(text: str, path: Path, given: Mapping[str, Path]) -> dict[str, Path]:
    """The folders of the packages that a text names."""
    return ros_package.folders(ros_package.packages_in(text), path, given)
