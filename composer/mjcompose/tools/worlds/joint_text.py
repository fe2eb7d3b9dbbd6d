"""The text of the joint model of cells of one tree: the first cell's, with the geoms and assets of all others."""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.sink import Sink
from mjcompose.mujoco.arrays import words
from mjcompose.mujoco.attributes import NameTable
from mjcompose.targets.plain import without_classes
from mjcompose.tools.worlds.cell_numbers import APART
from mjcompose.tools.worlds.contents import AssetContents
from mjcompose.tools.worlds.names import LoadError, failure
from mjcompose.tools.worlds.same_tree import ASSETS, CODE
from mjcompose.tools.worlds.slots import GeomSlot
from mjcompose.tree.classes import own
from mjcompose.tree.names import own_name
from mjcompose.tree.parse import parse_xml
from mjcompose.tree.xml_text import write

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

MODEL = "model.xml"
_SHAPES = words(mujoco, "geom_type")
_MULTIPLIED = ("replicate", "flexcomp", "composite", "attach")


def _bodies(root: Node) -> list[Node]:
    """Return the world and the bodies, in the order of their numbers."""
    return [*root.findall("worldbody"), *root.iterfind("worldbody//body")]


class CellText:
    """The text of a cell: its bodies and its assets by number."""

    def __init__(self, folder: Path, name: str, model: MjModel) -> None:
        self.folder = folder
        self.name = name
        self.model = model
        self.table = NameTable(model)
        sink = Sink()
        root = parse_xml((folder / MODEL).read_bytes(), MODEL, sink)
        if root is None:
            raise LoadError(sink.errors)
        self.root = root
        without_classes(root)
        self.bodies = _bodies(root)
        self.assets = {kind: list(root.iterfind(f"asset/{kind}")) for kind in ASSETS}
        self._check()
        self.contents = AssetContents(model)

    def _check(self) -> None:
        for tag in _MULTIPLIED:
            if self.root.find(f"worldbody//{tag}") is not None:
                help = "write its bodies one by one, or build these cells separately with `--pick`"
                raise failure(CODE, f"`{self.name}` has a `<{tag}>`, and a joint model needs each body by itself", help)
        counts = {"body": len(self.bodies), **{kind: len(nodes) for kind, nodes in self.assets.items()}}
        for kind, count in counts.items():
            if count != self.table.count(kind):
                message = (
                    f"the text of `{self.name}` has {count} elements of the kind {kind}, and its model another number"
                )
                raise failure(CODE, message, "build these cells separately with `--pick`")


class JointText:
    """Collects the text and the files of a joint model. `names` are the names of its assets, by kind and content."""

    def __init__(self, cells: Sequence[CellText]) -> None:
        self.cells = cells
        self.root = copy.deepcopy(cells[0].root)
        self.files: dict[str, Path] = {}
        self.names: dict[str, dict[str, str]] = {kind: {} for kind in ASSETS}
        self.numbers: dict[str, dict[str, int]] = {kind: {} for kind in ASSETS}
        self._assets = next(reversed(self.root.findall("asset")), None)
        for cell in cells:
            for kind in ASSETS:  # materials after the textures that they refer to
                for number, element in enumerate(cell.assets[kind]):
                    self._take(cell, kind, number, element)

    def _take(self, cell: CellText, kind: str, number: int, element: Node) -> None:
        names = self.names[kind]
        content = cell.contents.hashes[kind][number]
        if content in names:
            return
        is_first = cell is self.cells[0]
        wanted = cell.table.names[kind][number]
        names[content] = wanted if is_first else _free(wanted or kind, names.values())
        self.numbers[kind][content] = number if is_first else len(self.root.findall(f"asset/{kind}"))
        if is_first:
            made = list(self.root.iterfind(f"asset/{kind}"))[number]
        else:
            made = self._added(cell, kind, element)
            made.set("name", names[content])
        for attribute, value in element.items():
            if str(attribute).startswith("file") and value:
                made.set(attribute, self._file(cell, str(value)))

    def _added(self, cell: CellText, kind: str, element: Node) -> Node:
        made = copy.deepcopy(element)
        if self._assets is None:
            self._assets = etree.SubElement(self.root, "asset")
        self._assets.append(made)
        for node in (made, *made.iterchildren("layer")):
            for attribute, other in (("texture", "texture"), ("material", "material")):
                named = node.get(attribute)
                if named and kind != other:
                    number = cell.table.ids[other][named]
                    node.set(attribute, self.names[other][cell.contents.hashes[other][number]])
        return made

    def _file(self, cell: CellText, path: str) -> str:
        source = cell.folder / path
        taken = self.files.get(path)
        number = 1
        name = PurePosixPath(path)
        free = path
        while taken is not None and taken.read_bytes() != source.read_bytes():
            number += 1
            free = str(name.with_stem(f"{name.stem}~{number}"))
            taken = self.files.get(free)
        self.files[free] = source
        return free

    def name_of(self, cell: int, kind: str, number: int) -> str:
        return self.names[kind][self.cells[cell].contents.hashes[kind][number]]

    def add_geoms(self, bodies: Sequence[Sequence[GeomSlot]]) -> None:
        """Add the geoms that the first cell lacks, each before the next one that it has."""
        taken = set(self.cells[0].table.names["geom"])
        for body, slots in zip(_bodies(self.root), bodies, strict=True):
            present = own(body, "geom")
            for slot in slots:
                if 0 in slot.geoms:
                    del present[0]
                    continue
                slot.name = "" if slot.name in taken else slot.name
                taken.add(slot.name)
                geom = self._absent_geom(slot)
                if present:
                    present[0].addprevious(geom)
                else:
                    body.append(geom)

    def set_inertias(self) -> None:
        """Give each body that is simple in the first cell alone the inertia of a cell in which it is not."""
        models = [cell.model for cell in self.cells]
        simple = np.array([model.body_simple for model in models])
        elements = _bodies(self.root)
        for body in np.flatnonzero(simple[0] > simple.min(axis=0)).tolist():
            model = models[int(simple[:, body].argmin())]
            for element in elements[body].findall("inertial"):
                elements[body].remove(element)
            inertial = etree.Element("inertial")
            inertial.set("mass", numbers_text([model.body_mass[body]]))
            inertial.set("pos", numbers_text(model.body_ipos[body]))
            inertial.set("quat", numbers_text(model.body_iquat[body]))
            inertial.set("diaginertia", numbers_text(model.body_inertia[body]))
            elements[body].insert(0, inertial)

    def _absent_geom(self, slot: GeomSlot) -> Node:
        cell, number = min(slot.geoms.items())
        model = self.cells[cell].model
        geom = etree.Element("geom")
        if slot.name:
            geom.set("name", slot.name)
        shape = _SHAPES[int(model.geom_type[number])]
        geom.set("type", shape)
        for attribute in ("contype", "conaffinity", "condim", "priority", "group"):
            geom.set(attribute, str(int(getattr(model, f"geom_{attribute}")[number])))
        if shape in ("mesh", "hfield"):
            geom.set(shape, self.name_of(cell, shape, int(model.geom_dataid[number])))
        else:
            geom.set("size", numbers_text(model.geom_size[number]))
        for attribute, value in (("mass", "0"), ("margin", str(APART)), ("rgba", "0 0 0 0")):
            geom.set(attribute, value)
        return geom

    def make_convex(self, meshes: Collection[str]) -> None:
        """Let MuJoCo compute the hulls of meshes that no geom of the nominal model touches anything with.

        MuJoCo 4.0 computes a hull only for a mesh that some colliding geom has, or if it has the inertia of its hull.
        """
        for element in self.root.iterfind("asset/mesh"):
            if own_name(element, "name") in meshes:
                element.set("inertia", "convex")

    def write(self, folder: Path, name: str) -> None:
        """Write the model and its files into a folder."""
        self.root.set("model", name)
        for path, source in self.files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(source.read_bytes())
        (folder / MODEL).write_bytes(write(self.root))


def numbers_text(numbers: Iterable[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def _free(wanted: str, taken: Collection[str]) -> str:
    name = wanted
    number = 1
    while name in taken:
        number += 1
        name = f"{wanted}~{number}"
    return name


class Hulls(Struct):
    """The meshes of a joint model that collide in some cell, and those of colliding geoms in its text."""

    needed: frozenset[str]
    given: frozenset[str]

    @property
    def missing(self) -> frozenset[str]:
        return self.needed - self.given


def hulls(text: JointText, bodies: Sequence[Sequence[GeomSlot]]) -> Hulls:
    needed = set()
    given = set()
    for slots in bodies:
        for slot in slots:
            for place, (cell, number) in enumerate(sorted(slot.geoms.items())):
                model = text.cells[cell].model
                mesh = int(model.geom_dataid[number])
                if _SHAPES[int(model.geom_type[number])] != "mesh" or mesh < 0 or model.mesh_graphadr[mesh] < 0:
                    continue
                name = text.name_of(cell, "mesh", mesh)
                needed.add(name)
                if place == 0 and (model.geom_contype[number] or model.geom_conaffinity[number]):
                    given.add(name)
    return Hulls(frozenset(needed), frozenset(given))


def asset_numbers(text: JointText, joint: MjModel) -> list[Mapping[str, list[int]]]:
    """Return the number in a joint model of each asset of each cell, by kind."""
    table = NameTable(joint)
    for kind in ASSETS:
        for content, number in text.numbers[kind].items():
            if table.names[kind][number] != text.names[kind][content]:
                raise AssertionError(f"MuJoCo arranged elements of the kind {kind} in another order")
    return [
        {kind: [text.numbers[kind][content] for content in cell.contents.hashes[kind]] for kind in ASSETS}
        for cell in text.cells
    ]
