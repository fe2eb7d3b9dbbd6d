"""The grammar of MJCF: every element and attribute, with its declarations, references and meaning."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from composer.grammar.attribute import Attribute
from composer.grammar.element import Children, Constraint, ElementType

COUNTS: Mapping[str, tuple[int, int | None]] = {"once": (1, 1), "optional": (0, 1), "any": (0, None)}


class Grammar:
    """MJCF as data. The data file is read on first use, and elements are created on first use."""

    def __init__(self, read: Callable[[], str]) -> None:
        """Create the grammar; `read` returns the text of the data file and is called once."""
        self._read = read
        self._elements: dict[str, ElementType] = {}
        self._attributes: dict[tuple[str, str, bool], Attribute] = {}
        self._within: dict[str, dict[str, ElementType]] = {}

    @cached_property
    def _data(self) -> dict[str, Any]:
        data: dict[str, Any] = json.loads(self._read())
        return data

    # -- contents ----------------------------------------------------------------------------------------------

    @property
    def versions(self) -> tuple[str, str]:
        """First and last MuJoCo version that the data covers."""
        first, last = self._data["mujoco"]
        return first, last

    @property
    def root(self) -> ElementType:
        """The element `mujoco`."""
        return self.element("mujoco")

    @cached_property
    def paths(self) -> tuple[str, ...]:
        """Canonical path of every element, the root first."""
        return tuple(self._data["elements"])

    def element(self, path: str) -> ElementType:
        """Return the element at a path. Raises `KeyError` if there is none.

        The path is canonical (`geom`, `equality/joint`), a walk from parent to child (`asset/mesh`,
        `worldbody/body/geom`, `mujoco/sensor/force`), or a tag with a single place (`framepos`).
        """
        known = self._elements.get(path)
        if known is not None:
            return known
        if path in self._data["elements"]:
            return self._build(path)
        first, _, rest = path.partition("/")
        if not rest:
            places = self._places.get(path, ())
            if len(places) != 1:
                raise KeyError(path)
            return self.element(places[0])
        found = self.element(first)
        for tag in rest.split("/"):
            try:
                found = found.children[tag]
            except KeyError:
                raise KeyError(path) from None
        return found

    def section(self, tag: str) -> ElementType:
        """Return a child of the root: `worldbody`, `asset`, `option`, … Raises `KeyError` if it is none."""
        return self.root.children[tag]

    def within(self, section: str) -> Mapping[str, ElementType]:
        """Return every element that can occur inside a section, at any depth, by tag.

        If a tag has several meanings, the one nearest to the section is used: `geom` within `worldbody` is the geom
        of a body, not that of a composite.
        """
        known = self._within.get(section)
        if known is None:
            known = {}
            level: list[ElementType] = [self.section(section)]
            while level:
                below: list[ElementType] = []
                for parent in level:
                    for tag, child in parent.children.items():
                        if tag not in known:
                            known[tag] = child
                            below.append(child)
                level = below
            self._within[section] = known
        return known

    @cached_property
    def families(self) -> Mapping[str, tuple[str, ...]]:
        """Paths of the elements that share a namespace: `joint` is `joint` and `freejoint`."""
        members: dict[str, list[str]] = {}
        for path, raw in self._data["elements"].items():
            family = self._family(raw)
            if family is not None:
                members.setdefault(family, []).append(path)
        return {family: tuple(paths) for family, paths in members.items()}

    @cached_property
    def namespaces(self) -> frozenset[str]:
        """Every namespace in which some element declares a name."""
        return frozenset(self.families)

    @property
    def objtypes(self) -> Mapping[str, str]:
        """Namespace for each keyword of `objtype` and `reftype` (`xbody` is `body`)."""
        objtypes: dict[str, str] = self._data["objtypes"]
        return objtypes

    @property
    def implicit_names(self) -> Mapping[str, str]:
        """Elements that take a name from their file if they have none, with that attribute."""
        names: dict[str, str] = self._data["implicit_names"]
        return names

    # -- building --------------------------------------------------------------------------------------------

    @cached_property
    def _places(self) -> Mapping[str, tuple[str, ...]]:
        places: dict[str, list[str]] = {}
        for path in self._data["elements"]:
            if not path.startswith("default/"):
                places.setdefault(path.rpartition("/")[2], []).append(path)
        return {tag: tuple(paths) for tag, paths in places.items()}

    def _rows(self, path: str, raw: dict[str, Any]) -> Iterable[tuple[str, str, dict[str, Any]]]:
        """Yield the written attributes of an element: (place, name, row), those of its groups first."""
        for group in raw.get("groups", ()):
            for name, row in self._data["groups"][group]["attributes"].items():
                yield group, name, row
        for name, row in raw.get("attributes", {}).items():
            yield path, name, row

    def _family(self, raw: dict[str, Any]) -> str | None:
        for _, _, row in self._rows("", raw):
            if row["type"] == "name":
                family: str = row["declares"]
                return family
        return None

    def _build(self, path: str) -> ElementType:
        raw = self._data["elements"][path]
        rows_of = raw.get("rows_of")
        if rows_of is None:
            has_default = "default" in raw
            attributes = {
                name: self._attribute(place, name, row, has_default=has_default)
                for place, name, row in self._rows(path, raw)
            }
            constraints = self._constraints(raw)
        else:
            attributes = self._default_rows(rows_of)
            constraints = tuple(
                rule
                for rule in self.element(rows_of).constraints
                if all(name in attributes for bundle in rule.bundles for name in bundle)
            )
        low, high = COUNTS[raw["occurs"]]
        element = ElementType(
            path=path,
            tag=path.rpartition("/")[2],
            attributes=attributes,
            children=Children(
                {child.rpartition("/")[2]: child for child in raw.get("children", ())}, self.element
            ),
            min_count=low,
            max_count=high,
            constraints=constraints,
            since=raw.get("since"),
            until=raw.get("until"),
            family=self._family(raw),
            default=raw.get("default"),
            rows_of=rows_of,
            doc=self._data.get("docs", {}).get("elements", {}).get(path, ""),
            ignored=tuple(raw.get("ignored", ())),
        )
        self._elements[path] = element
        return element

    def _constraints(self, raw: dict[str, Any]) -> tuple[Constraint, ...]:
        groups = self._data["groups"]
        texts = [text for group in raw.get("groups", ()) for text in groups[group].get("constraints", ())]
        rules = []
        for text in (*texts, *raw.get("constraints", ())):
            kind, *bundles = text.split()
            rules.append(Constraint(kind, tuple(tuple(bundle.split("+")) for bundle in bundles)))
        return tuple(rules)

    def _default_rows(self, path: str) -> dict[str, Attribute]:
        """Return the attributes of an element that a class may set; `in_default` may be the first version with it."""
        attributes = {}
        raw = self._data["elements"][path]
        for place, name, row in self._rows(path, raw):
            allowed = row.get("in_default", True)
            if allowed is True:
                attributes[name] = self._attribute(place, name, row, has_default=True)
            elif allowed:
                attributes[name] = self._attribute(
                    f"default/{place}", name, {**row, "since": allowed}, has_default=True
                )
        return attributes

    def _attribute(self, place: str, name: str, row: dict[str, Any], has_default: bool) -> Attribute:
        key = (place, name, has_default)
        known = self._attributes.get(key)
        if known is None:
            known = self._attributes[key] = self._make_attribute(place, name, row, has_default=has_default)
        return known

    def _make_attribute(self, place: str, name: str, row: dict[str, Any], has_default: bool) -> Attribute:
        kind = row["type"]
        words, versions, ordered = self._keywords(row.get("keywords"))
        lengths = row.get("lengths")
        low: int | None
        high: int | None
        if lengths is not None:
            low, high = min(lengths), max(lengths)
        elif "length" in row:
            length = row["length"]
            low, high = (length, length) if isinstance(length, int) else length
        elif kind == "keywords":
            low, high = 1, len(words)
        elif kind == "references":
            low, high = 1, None
        elif kind in ("string", "file", "name", "reference"):
            low = high = None
        else:
            low = high = 1
        default = row.get("default")
        docs = self._data.get("docs", {}).get("attributes", {})
        return Attribute(
            name=name,
            type=kind,
            min_length=low,
            max_length=high,
            lengths=None if lengths is None else tuple(lengths),
            keywords=words,
            keyword_versions=versions,
            ordered=ordered,
            default=tuple(default) if isinstance(default, list) else default,
            required=row.get("required", False),
            declares=row.get("declares"),
            refers=row.get("refers"),
            refers_by=row.get("refers_by"),
            folder=row.get("folder"),
            angle=row.get("angle"),
            since=row.get("since"),
            until=row.get("until"),
            in_default=has_default and bool(row.get("in_default", True)),
            doc=docs.get(f"{place.removeprefix('default/')}/{name}") or docs.get(name, ""),
        )

    def _keywords(
        self, name: str | None
    ) -> tuple[tuple[str, ...], Mapping[str, tuple[str | None, str | None]], bool]:
        if name is None:
            return (), {}, False
        entry = self._data["keywords"][name]
        if isinstance(entry, list):
            return tuple(entry), {}, False
        since = {word: version for version, words in entry.get("since", {}).items() for word in words}
        until = {word: version for version, words in entry.get("until", {}).items() for word in words}
        versions = {word: (since.get(word), until.get(word)) for word in (*since, *until)}
        return tuple(entry["words"]), versions, entry.get("ordered", False)


def read_data() -> str:
    """Return the data as text: the installed copy next to this module, or a source checkout's `schemas/mjcf.json`."""
    here = Path(__file__).parent
    try:
        return (here / "mjcf.json").read_text(encoding="utf-8")
    except FileNotFoundError:
        return (here.parents[1] / "schemas" / "mjcf.json").read_text(encoding="utf-8")


GRAMMAR = Grammar(read_data)
