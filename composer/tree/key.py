"""A key independent of any layout: its numbers by their joints, actuators and bodies."""

from __future__ import annotations

from dataclasses import field
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.tree.key_number import Number
from composer.tree.origin import Origins


@dataclass(eq=False, slots=True)
class Key:
    """Numbers by vector (`qpos`, …) and by their owner; `element` is where it is written.

    `others` are the elements of keys that were merged into it.
    """

    name: str
    time: Number | None
    element: Node
    file: str
    origins: Origins
    values: dict[str, dict[Any, list[Number]]] = field(default_factory=dict)
    others: tuple[Node, ...] = ()

    def span(self, attribute: str | None = None) -> Span:
        """Return where the key is written, or the value of its attribute."""
        return self.origins.span(self.element, self.file, attribute)


class PartKeys(NamedTuple):
    """The keys of one part of a model; `depth` is the number of compositions around it."""

    depth: int
    keys: tuple[Key, ...]

    def named(self, name: str) -> Key | None:
        return next((key for key in self.keys if key.name == name), None)

    @property
    def names(self) -> list[str]:
        return [key.name for key in self.keys if key.name]
