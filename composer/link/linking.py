"""The data that the linker works on: a base, the parts attached to it, and the resulting model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import NamedTuple, Protocol

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.link.key_table import KeyTable
from composer.link.notes import Notes
from composer.link.part import Part
from composer.link.request import Request
from composer.reading.door import Passed
from composer.tree.names import Names, may_be_generated
from composer.tree.unit import Unit
from composer.tree.watch import Watch, nobody


class Measure(Protocol):
    """Compiles a unit alone with MuJoCo and returns arrays of `mjModel` by name.

    There are none if MuJoCo refuses the unit. A refusal is reported, unless `attempt` is set.
    """

    def __call__(
        self, unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False
    ) -> Mapping[str, list[float]]: ...


class LaterPlaces(Protocol):
    """Places that the recipe adds and that parts may be attached to."""

    def make(self, kind: str, name: str) -> Iterable[tuple[str, str]]:
        """Add a place now. Return what now exists: nothing if the recipe does not add it, or not yet."""
        ...

    def waits_for(self, kind: str, name: str) -> tuple[str, str] | None:
        """Return what has to be in the model before a place can be added, or None if the recipe does not add it."""
        ...

    def names(self) -> list[tuple[str, str]]:
        """Return the kind and the name of each place that does not exist yet."""
        ...

    def stands_on(self, kind: str, name: str) -> tuple[str, Span] | None:
        """Return what a place is added to and where its name is written, or None if the recipe does not add it."""
        ...


class FileUse(NamedTuple):
    """An attribute of the model that names a file of the bundle, with the source of the file's bytes.

    A file that is not `shared` must keep its own path, even if another file has the same bytes.
    """

    element: Node
    attribute: str
    path: str
    source: Passed
    content: bytes | None
    shared: bool = True


_path = lru_cache(maxsize=4096)(Path)  # a model has the same files in each of its samples


@dataclass(eq=False)
class Linking:
    """The state that the passes share, from separate units to one flat model.

    `names` and `files` describe the model: every declared name, and every attribute that names a file. `base_class`
    is the class that the base's top class becomes, None if it stays `main`.
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
    submodels: int = 0
    notes: Notes = field(default_factory=Notes)
    keys: KeyTable = field(default_factory=KeyTable)
    later_places: LaterPlaces | None = None

    @property
    def composed(self) -> bool:
        """Whether the model has more than the base, so that the base's rules for a whole model apply only to it."""
        return bool(self.parts) or self.request.adds_mass

    @property
    def units(self) -> list[Unit]:
        return [self.base, *[part.unit for part in self.parts]]

    @cached_property
    def angle(self) -> str:
        """The model's unit of angle: `degree` if all units use degrees, else `radian`."""
        return "degree" if all(unit.settings.angle == "degree" for unit in self.units) else "radian"

    def find_node(self, namespace: str, name: str) -> Node | None:
        """Return the element of the model with this name, or None."""
        return self.names.find(namespace, name)

    def known_names(self, namespace: str) -> list[str]:
        """Return the names in a namespace."""
        return self.names.of(namespace)

    def kinds_of(self, name: str) -> list[str]:
        """Return the namespaces in which the name exists."""
        return self.names.kinds_of(name)

    def may_generate(self, name: str) -> bool:
        """Return whether MuJoCo may generate the name itself."""
        return may_be_generated(name, self.base.root)

    def flat(self) -> Unit:
        """Return the current model with its files, without the parts that are not joined yet."""
        contents = {
            use.path: use.content if use.content is not None else _path(use.source) for use in self.files
        }
        return replace(self.base, contents=contents or self.base.contents)

    def span(self, unit: Unit, element: Node, attribute: str | None = None) -> Span:
        """Return where an element of a unit, or the value of its attribute, is written."""
        return unit.origins.span(element, unit.file, attribute)
