"""The names in a model and what they are: from the model that was composed last, and from parts that it lacks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from typing import TYPE_CHECKING

from composer.compose.load import Library, key_of
from composer.dataclass import dataclass
from composer.plan.plan import BASE, Place, Plan
from composer.sources.source import Source
from composer.tree.name_index import NameIndex
from composer.tree.names import WORLD

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.tree.unit import Unit

_TELLING = ("type", "pos", "joint", "tendon", "site", "file", "range")
"""What a line about an element says of its attributes."""


@dataclass(frozen=True, slots=True)
class Known:
    """A name. `part` is the path of its part, and `holder` the body that contains it."""

    name: str
    namespace: str
    tag: str
    part: str = ""
    holder: str = ""
    words: str = ""
    node: Node | None = field(default=None, compare=False, repr=False)

    @property
    def detail(self) -> str:
        """Return in one line what the name is and where.

        >>> Known("tcp", "site", "site", "arm", "wrist", "pos 0 0 0.1").detail
        'site of arm, in wrist, pos 0 0 0.1'
        """
        of = f" of {self.part}" if self.part else ""
        where = f", in {self.holder}" if self.holder else ""
        return f"{self.tag}{of}{where}{', ' + self.words if self.words else ''}"


@dataclass(frozen=True)
class Names:
    """The names of a model by namespace, in the order of the model, and the paths of its parts.

    `sources` has the units of the parts, by their paths, and `prefixes` the prefix of each part.
    """

    known: dict[str, dict[str, Known]] = field(default_factory=dict)
    parts: tuple[str, ...] = ()
    sources: dict[str, Unit] = field(default_factory=dict)
    prefixes: dict[str, str] = field(default_factory=dict)

    def of(self, namespace: str) -> list[Known]:
        return list(self.known.get(namespace, {}).values())

    def find(self, namespace: str, name: str) -> Known | None:
        return self.known.get(namespace, {}).get(name)

    def own(self, part: str) -> Names:
        """Return the names of a part without its prefix.

        They come from its source, or from the model, of which those below the prefix are taken.
        """
        found: dict[str, dict[str, Known]] = {}
        if (unit := self.sources.get(part)) is not None:
            for each in _of_root(unit.root, "", []):
                found.setdefault(each.namespace, {})[each.name] = each
            return Names(found)
        prefix = self.prefixes.get(part)
        for namespace, names in self.known.items() if prefix else ():
            for name, each in names.items():
                if prefix and name.startswith(prefix) and len(name) > len(prefix):
                    found.setdefault(namespace, {})[name[len(prefix) :]] = each
        return Names(found)


def names_of(plan: Plan, root: Node | None, composed: Plan | None, library: Library) -> Names:
    """Return the names of a composed model, and those of the parts of a plan that it lacks.

    `root` is the tree of that model and `composed` its plan, which may be older than `plan`.
    """
    places = [place for place in plan.walk() if place.model is not None and place.part]
    parts = sorted(((place.prefix, place.part) for place in places), key=_longest)
    sources = {place.part: unit for place in places if (unit := _unit(place, library)) is not None}
    known: dict[str, dict[str, Known]] = {}
    if root is not None:
        _take(known, _of_root(root, "", parts))
    there = set() if composed is None else set(map(_identity, composed.walk()))
    for place in places:
        if place.part in sources and _identity(place) not in there:
            _take(known, _of_root(sources[place.part].root, place.prefix, parts))
    known.setdefault("body", {})[WORLD] = Known(WORLD, "body", "worldbody")
    return Names(known, plan.part_names, sources, {place.part: place.prefix for place in places})


def _take(known: dict[str, dict[str, Known]], found: Iterator[Known]) -> None:
    for each in found:
        known.setdefault(each.namespace, {}).setdefault(each.name, each)


def _longest(prefix: tuple[str, str]) -> int:
    return -len(prefix[0])


def _identity(place: Place) -> tuple[str, object]:
    """Return a value that changes whenever the names of a part may change."""
    return place.prefix, place.model.path if isinstance(place.model, Source) else None


def _unit(place: Place, library: Library) -> Unit | None:
    if not isinstance(place.model, Source):
        return None
    return library.get(key_of(place.model, place.stands))


def _of_root(root: Node, prefix: str, prefixes: list[tuple[str, str]]) -> Iterator[Known]:
    """Yield the names of a tree; `prefixes` are those of parts, the longest first."""
    part_of = dict(reversed(prefixes))  # the first of equal ones
    lengths = sorted({len(start) for start in part_of}, reverse=True)
    for namespace, declared in NameIndex.of(root).declared.items():
        for own, node in declared.items():
            name = prefix + own
            part = next((found for end in lengths if (found := part_of.get(name[:end])) is not None), "")
            yield Known(name, namespace, str(node.tag), "" if part == BASE else part,
                        prefix_of(_holder(node), prefix), _words(node), node)  # fmt: skip


def prefix_of(name: str, prefix: str) -> str:
    return prefix + name if name and name != WORLD else name


def _holder(node: Node) -> str:
    for above in node.iterancestors():
        if above.tag == "body":
            return str(above.get("name") or "")
        if above.tag == "worldbody":
            return WORLD
    return ""


def _words(node: Node) -> str:
    return ", ".join(f"{name} {value}" for name in _TELLING if (value := node.get(name)))
