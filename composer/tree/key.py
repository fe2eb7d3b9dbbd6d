"""A key apart from any layout: its numbers by the joints, actuators and bodies that they belong to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.tree.key_number import Number
from composer.tree.origin import Origins


@dataclass(eq=False, slots=True)
class Key:
    """Numbers by vector (`qpos`, …) and by what they belong to; `element` is where it is written.

    `others` are the elements of keys that have been joined to it.
    """

    name: str
    time: Number | None
    element: Node
    file: str
    origins: Origins
    values: dict[str, dict[Any, list[Number]]] = field(default_factory=dict)
    others: tuple[Node, ...] = ()

    def span(self, attribute: str | None = None) -> Span:
        """Where the key is written, or the value of its attribute."""
        return self.origins.span(self.element, self.file, attribute)


class PartKeys(NamedTuple):
    """The keys of one part of a model; `depth` is how many compositions it is inside of."""

    depth: int
    keys: tuple[Key, ...]

    def named(self, name: str) -> Key | None:
        return next((key for key in self.keys if key.name == name), None)

    @property
    def names(self) -> list[str]:
        return [key.name for key in self.keys if key.name]
