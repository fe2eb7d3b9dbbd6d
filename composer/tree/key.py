"""A key independent of any layout: its numbers by their joints, actuators and bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
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

    def carried(self, copies: Mapping[Node, Node]) -> PartKeys:
        """Return the same numbers for a copy of the model; `copies` has its elements."""

        def holder(old: Any) -> Any:
            if isinstance(old, tuple):  # a copy of an element that MuJoCo multiplies
                return old._replace(element=holder(old.element))  # type: ignore[attr-defined]
            return copies.get(old, old)

        return self._replace(
            keys=tuple(
                replace(
                    key,
                    values={
                        vector: {holder(old): list(numbers) for old, numbers in by_holder.items()}
                        for vector, by_holder in key.values.items()
                    },
                )
                for key in self.keys
            )
        )

    @property
    def names(self) -> list[str]:
        return [key.name for key in self.keys if key.name]
