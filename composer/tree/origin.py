"""Where an element came from: a file and line of a source, or a place in a recipe."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span


@dataclass(slots=True)
class Origins:
    """The file of every subtree whose file is not its parent's, and the recipe place of what a recipe wrote.

    Line numbers need no storage: lxml keeps the line of each element, and they survive moves and copies.
    The mapping holds the elements themselves, so that their identity is stable.
    """

    owners: dict[Node, str | Span] = field(default_factory=dict)

    def own(self, element: Node, owner: str | Span) -> None:
        self.owners[element] = owner

    def span(self, element: Node, default_file: str) -> Span:
        """The place to show for `element`: its own line, in the file of the nearest ancestor that has an owner."""
        node: Node | None = element
        while node is not None:
            owner = self.owners.get(node)
            if isinstance(owner, Span):
                return owner
            if owner is not None:
                return Span(owner, element.sourceline or 1, 1)
            node = node.getparent()
        return Span(default_file, element.sourceline or 1, 1)

    def adopt(self, other: Origins) -> None:
        """Take over what is known of elements that have moved here from another tree."""
        self.owners.update(other.owners)

    def carried(self, old: Node, new: Node) -> Origins:
        """The same knowledge for `new`, a deep copy of `old`."""
        if not self.owners:
            return Origins()
        return Origins(
            {copy: self.owners[node] for node, copy in _side_by_side(old, new) if node in self.owners}
        )


def _side_by_side(old: Node, new: Node) -> Iterator[tuple[Node, Node]]:
    return zip(old.iter(), new.iter(), strict=True)
