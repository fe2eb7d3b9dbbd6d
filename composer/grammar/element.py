"""One kind of MJCF element, as data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Literal

from composer.dataclass import dataclass
from composer.grammar.attribute import Attribute
from composer.grammar.version import exists_in


@dataclass(frozen=True, slots=True)
class Constraint:
    """A rule about the presence of attributes. A bundle is complete if all its attributes are written.

    `exclusive`: attributes of at most one bundle; `together`: all of them or none; `requires`: the first bundle
    needs the second; `oneof`: at least one bundle is complete.
    """

    kind: Literal["exclusive", "together", "requires", "oneof"]
    bundles: tuple[tuple[str, ...], ...]


class Children(Mapping[str, "ElementType"]):
    """Child elements by tag. An element is created on first use, so that recursion costs nothing."""

    __slots__ = ("_paths", "_resolve")

    def __init__(self, paths: Mapping[str, str], resolve: Callable[[str], ElementType]) -> None:
        self._paths = paths
        self._resolve = resolve

    def __getitem__(self, tag: str) -> ElementType:
        return self._resolve(self._paths[tag])

    def __contains__(self, tag: object) -> bool:
        return tag in self._paths

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    def __repr__(self) -> str:
        return f"Children({', '.join(self._paths)})"


@dataclass(frozen=True, slots=True, eq=False)
class ElementType:
    """MuJoCo's rules for one place of the tree. There is one object for each path: compare with `is`."""

    path: str
    """Bare tag for sections, assets and the body tree; `parent/tag` elsewhere (`equality/joint`)."""
    tag: str
    attributes: Mapping[str, Attribute]
    children: Mapping[str, ElementType]
    min_count: int = 0
    max_count: int | None = None
    """How often it may occur in one parent; `None` is unbounded."""
    constraints: tuple[Constraint, ...] = ()
    since: str | None = None
    until: str | None = None
    family: str | None = None
    """Namespace of its name, which elements of other tags may share."""
    default: str | None = None
    """Path of the element with its defaults in a class (`default/tendon` for `tendon/fixed`)."""
    rows_of: str | None = None
    """For an element inside `default`: the element whose attributes it repeats."""
    doc: str = ""
    ignored: tuple[str, ...] = ()
    """Attributes that occur in models and that MuJoCo accepts, although they have no meaning in any version."""

    @property
    def takes_class(self) -> bool:
        """Whether it takes `class`, so that defaults apply to it."""
        attribute = self.attributes.get("class")
        return attribute is not None and attribute.type == "reference"

    @property
    def takes_childclass(self) -> bool:
        """Whether it takes `childclass`, which sets the class of its contents."""
        return "childclass" in self.attributes

    def exists_in(self, version: str) -> bool:
        """Return whether that MuJoCo version (`"3.12.0"`) reads the element."""
        return exists_in(version, self.since, self.until)

    def __repr__(self) -> str:
        return f"ElementType({self.path})"
