"""A model while it is rewritten for a target. Only in MuJoCo's child process."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.targets.loss import Loss, Outcome


@dataclass(slots=True)
class Draft:
    """The plain text of a model with its files, and the compiled model itself.

    `elements` has the elements of the text by kind, in the order of the compiled model. `files` has the content of
    the files that the text names, by path. The limits of a target change `root` and record in `losses` what is
    lost.
    """

    mujoco: Any
    model: Any
    root: Node
    files: dict[str, bytes]
    elements: Mapping[str, Sequence[Node]]
    losses: list[Loss] = field(default_factory=list)
    output: str = "model.xml"
    mujoco_reads: bool = True
    _rows: dict[Node, tuple[str, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._rows = {
            node: (kind, number) for kind, nodes in self.elements.items() for number, node in enumerate(nodes)
        }

    def lose(
        self,
        feature: str,
        node: Node,
        why: str = "",
        *,
        what: str = "",
        outcome: Outcome = Outcome.LEFT_OUT,
        help: str | None = None,
    ) -> None:
        """Record that the target cannot express an element, or `what` it has."""
        kind, number = self._rows.get(node, ("", -1))
        tag, name = str(node.tag), str(node.get("name") or "")
        self.losses.append(
            Loss(feature, kind, number, tag=tag, name=name, why=why, what=what, outcome=outcome, help=help)
        )

    def remove(self, node: Node) -> None:
        """Remove an element, and its section if it becomes empty."""
        holder = node.getparent()
        if holder is not None:
            holder.remove(node)
            if not len(holder) and holder.tag in _SECTIONS and holder.getparent() is not None:
                self.remove(holder)

    def of(self, kind: str) -> Iterator[tuple[int, Node]]:
        """Yield the elements of a kind that are still in the text, with their numbers in the compiled model."""
        for number, node in enumerate(self.elements[kind]):
            if any(above is self.root for above in node.iterancestors()):
                yield number, node


_SECTIONS = (
    "actuator",
    "sensor",
    "equality",
    "tendon",
    "contact",
    "keyframe",
    "asset",
    "custom",
    "deformable",
    "extension",
)
