"""A model that can be edited, alone or attached to another one, with as little as the engine asks for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.edit import names_in
from mjcompose.tree.names import NameIndex, may_be_generated
from mjcompose.tree.select import section_of


@dataclass(eq=False)
class Tree:
    """`above` is the model it is attached to under `prefix`."""

    text: str
    above: Tree | None = None
    prefix: str = ""
    names: NameIndex = field(init=False)

    def __post_init__(self) -> None:
        self.root = etree.fromstring(self.text)
        self.names = NameIndex.of(self.root)

    def find(self, path: str) -> Node:
        found = self.root.find(path)
        assert found is not None
        return found

    def levels(self) -> Iterator[tuple[Tree, str]]:
        yield self, ""
        if self.above is not None:
            yield from ((tree, prefix + self.prefix) for tree, prefix in self.above.levels())

    def find_node(self, namespace: str, name: str) -> Node | None:
        return self.names.find(namespace, name)

    def known_names(self, namespace: str) -> list[str]:
        return list(self.names.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        return [namespace for namespace, names in self.names.declared.items() if name in names]

    def may_generate(self, name: str) -> bool:
        return may_be_generated(name, self.root)

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        return names_in(node)

    def forget(self, node: Node) -> None:
        self.names.forget(node, section_of(node))

    def note(self, node: Node) -> None:
        self.names.note(node, section_of(node))
