"""An entry of `edit` while its verbs are carried out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.compose.editing import Editing
from composer.compose.mass import Masses
from composer.dataclass import dataclass
from composer.link.subtree import Left

if TYPE_CHECKING:
    from composer.compose.workshop import Record, Workshop


@dataclass(slots=True)
class Entry:
    """The elements that an entry selects, and what its verbs leave behind.

    `workshop` is where meshes are worked on. `checks` are the checks that can run only after all values are
    written. `gone` lists the removed elements, and `records` the meshes and shapes that were made.
    """

    editing: Editing
    found: list[Node]
    masses: Masses
    workshop: Workshop
    checks: list[Callable[[], None]] = field(default_factory=list)
    gone: list[Left] = field(default_factory=list)
    records: list[Record] = field(default_factory=list)

    def check(self) -> None:
        """Run the postponed checks. A verb that makes, renames or removes elements calls this first."""
        while self.checks:
            self.checks.pop(0)()
