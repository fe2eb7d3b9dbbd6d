"""The bodies that models have in common, and those that only some of them have: the parts of a union."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import field
from hashlib import sha256

import numpy as np

from composer.compiled.kinds import ON_BODIES, Model, NameTable
from composer.dataclass import dataclass
from composer.worlds.errors import failure

CODE = "not-a-world"
_HFIELD, _MESH = 1, 7
_NOT_UNITED = ("flex", "skin", "plugin")


@dataclass(frozen=True, slots=True)
class Part:
    """A body with everything on it that not all models have: its parent, and its contents."""

    parent: str
    body: str
    shape: Hashable


@dataclass(slots=True)
class Tree:
    """A model as named bodies; `own` has the elements on each body, `children` its child bodies."""

    model: Model
    name: str
    table: NameTable = field(init=False)
    own: dict[str, Hashable] = field(init=False, default_factory=dict)
    children: dict[str, list[str]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.table = NameTable(self.model)
        for kind in _NOT_UNITED:
            if self.table.count(kind):
                message = f"`{self.name}` has the {kind} `{self.table.describe(kind, 0)}`, which no union takes over"
                raise failure(CODE, message, "build these cells by themselves with `--pick`")
        bodies = self.table.names["body"]
        if "" in bodies:
            help = "give it a name in its source"
            raise failure(
                CODE, f"`{self.name}` has a body without a name, which a union cannot tell from others", help
            )
        for number, name in enumerate(bodies):
            self.own[name] = tuple(
                (kind, *self._about(kind, each))
                for kind, bodies_of in ON_BODIES.items()
                for each in np.flatnonzero(getattr(self.model, bodies_of) == number).tolist()
            )
            self.children[name] = []
            if number:
                self.children[bodies[self.model.body_parentid[number]]].append(name)

    def _about(self, kind: str, each: int) -> tuple[Hashable, ...]:
        """Return what an element is, without its numbers."""
        model, name = self.model, self.table.names[kind][each]
        if kind == "joint":
            return name, int(model.jnt_type[each])
        if kind == "geom":
            mesh, shape = int(model.geom_dataid[each]), int(model.geom_type[each])
            material = int(model.geom_matid[each])
            looks = self.table.names["material"][material] if material >= 0 else ""
            return name, shape, looks, self._surface(shape, mesh) if mesh >= 0 else ""
        if kind == "camera":
            return name, int(model.cam_mode[each]), int(model.cam_targetbodyid[each]) >= 0
        return (name,)

    def _surface(self, shape: int, asset: int) -> str:
        """Return the data of a mesh or a height field.

        A mesh that a geom of another type was fitted to does not count.
        """
        model = self.model
        if shape == _HFIELD:
            first, count = (
                int(model.hfield_adr[asset]),
                int(model.hfield_nrow[asset] * model.hfield_ncol[asset]),
            )
            return sha256(model.hfield_data[first : first + count].tobytes()).hexdigest()
        if shape != _MESH:
            return ""
        first, count = int(model.mesh_vertadr[asset]), int(model.mesh_vertnum[asset])
        return sha256(model.mesh_vert[first : first + count].tobytes()).hexdigest()

    def shape(self, body: str) -> Hashable:
        """Return a body and all bodies below it, without numbers."""
        return body, self.own[body], tuple(self.shape(each) for each in self.children[body])

    def below(self, body: str) -> Iterator[str]:
        """Yield a body and all bodies below it."""
        yield body
        for each in self.children[body]:
            yield from self.below(each)


def shape_of(model: Model, name: str) -> Hashable:
    """Return all bodies of a model, without numbers. Raises LoadError for an unnamed body."""
    return Tree(model, name).shape("world")


def common(trees: Sequence[Tree]) -> set[str]:
    """Return the bodies that all models have, with the same elements and the same parent, down from the world.

    Raises LoadError if only some models have an element on the world that is not a body.
    """
    first, *others = trees
    for each in others:
        if each.own["world"] != first.own["world"]:
            ours, theirs = set(first.own["world"]), set(each.own["world"])  # type: ignore[call-overload]
            kind, name, *_ = min(ours ^ theirs, key=str)
            message = f"`{each.name}` and `{first.name}` have not both the {kind} `{name}` on the world"
            raise failure(CODE, message, "put it into a body of its own: a union is of whole bodies")
    found: set[str] = set()
    waiting = ["world"]
    while waiting:
        body = waiting.pop()
        found.add(body)
        waiting += [
            child
            for child in first.children[body]
            if all(child in each.children[body] and each.own[child] == first.own[child] for each in others)
        ]
    return found


def parts(tree: Tree, shared: set[str]) -> list[Part]:
    """Return the topmost bodies of a model that are not shared."""
    return [
        Part(parent, child, tree.shape(child))
        for parent in tree.children
        if parent in shared
        for child in tree.children[parent]
        if child not in shared
    ]
