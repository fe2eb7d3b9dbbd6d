"""What the linker works on: a base, the parts that are attached to it, and the model that comes out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, Protocol

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.key_table import KeyTable
from composer.link.notes import Notes
from composer.link.part import Part
from composer.link.request import Request
from composer.tree.names import Names
from composer.tree.unit import Unit
from composer.tree.watch import Watch, nobody


class Measure(Protocol):
    """MuJoCo at work on a unit alone: arrays of `mjModel` by name; none if it refuses the unit.

    A refusal is reported, unless this is an `attempt`.
    """

    def __call__(
        self, unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False
    ) -> Mapping[str, list[float]]: ...


class FileUse(NamedTuple):
    """An attribute of the model that names a file of the bundle, and where that file's bytes are.

    A file that is not `shared` must stand under its own path, whatever other file has the same bytes.
    """

    element: Node
    attribute: str
    path: str
    source: str
    content: bytes | None
    shared: bool = True


@dataclass(eq=False)
class Linking:
    """What the passes share, from separate units to one flat model.

    `names` and `files` describe the model: every declared name, and every attribute that names a file. `base_class` is
    the class that the base's top class becomes, None if it stays `main`.
    """

    base: Unit
    parts: list[Part]
    sink: Sink
    request: Request = field(default_factory=Request)
    measure: Measure | None = None
    watch: Watch = nobody
    names: Names = field(default_factory=Names)
    base_class: str | None = None
    files: list[FileUse] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)
    keys: KeyTable = field(default_factory=KeyTable)

    @property
    def composed(self) -> bool:
        """Whether there is more in the model than the base: its rules for a whole model are for the base alone."""
        return bool(self.parts) or self.request.adds_mass

    @property
    def units(self) -> list[Unit]:
        return [self.base, *[part.unit for part in self.parts]]

    @cached_property
    def angle(self) -> str:
        """The model's unit of angle: `degree` only if it is every unit's."""
        return "degree" if all(unit.settings.angle == "degree" for unit in self.units) else "radian"

    def flat(self) -> Unit:
        """The model as it stands, with its files; it holds nothing of parts that are not joined yet."""
        base = self.base
        contents = {
            use.path: use.content if use.content is not None else Path(use.source) for use in self.files
        }
        return Unit(
            base.root,
            base.file,
            base.directory,
            base.label,
            contents or base.contents,
            base.origins,
            base.part_keys,
            base.header,
        )

    def span(self, unit: Unit, element: Node, attribute: str | None = None) -> Span:
        """Where an element of a unit, or the value of its attribute, is written."""
        return unit.origins.span(element, unit.file, attribute)
