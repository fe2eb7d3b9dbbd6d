"""MJCF as data: every element and attribute, with its declarations, references and meaning."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import field
from functools import cached_property
from itertools import chain, takewhile
from pathlib import Path
from typing import Any, Literal

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.words import number_text


def exists_in(version: str, since: str | None, until: str | None) -> bool:
    """Return whether `version` is between the first and the last version, both included; `None` is open.

    >>> exists_in("3.17.0", "3.13.0", None), exists_in("4.0.0", None, "3.17.0")
    (True, False)
    """
    key = version_key(version)
    return (since is None or version_key(since) <= key) and (until is None or key <= version_key(until))


def version_key(version: str) -> tuple[int, ...]:
    """Return the numbers of a dotted version, for comparison, without a suffix such as `rc1`.

    >>> version_key("3.12.0") < version_key("4.0.0rc1")
    True
    """
    digits = (part[: len(part) - len(part.lstrip("0123456789"))] for part in version.split("."))
    return tuple(map(int, takewhile(bool, digits)))


class NotMjcf(ValueError):
    """A source has something that MJCF does not have. MuJoCo refuses the model, and `check_source` says why."""


class UnknownElement(NotMjcf, KeyError):
    """An element at a place where MJCF has none of that name."""


AttributeType = Literal[
    "real", "int", "bool", "keyword", "keywords", "string", "chars", "file", "name", "reference", "references"
]

Angle = Literal["orientation-euler", "orientation-axisangle", "joint", "replicate"]

Default = bool | int | float | str | tuple[int | float | str, ...] | None

NUMERIC = frozenset({"real", "int"})


@dataclass(frozen=True, slots=True, eq=False)
class Attribute:
    """MuJoCo's rules for one attribute.

    Lengths count numbers, keywords, names or (for `chars`) characters. `None` is unbounded. `default` is the value,
    in the last version covered, of an attribute that is not written: a scalar if `max_length` is 1, else a tuple.
    `None` if there is none (names, lists without bound), or if MuJoCo computes it.
    """

    name: str
    type: AttributeType
    min_length: int | None = 1
    max_length: int | None = 1
    lengths: tuple[int, ...] | None = None
    """The only allowed lengths, if the two bounds are not enough (`scale` of a frame: one or three)."""
    keywords: tuple[str, ...] = ()
    keyword_versions: Mapping[str, tuple[str | None, str | None]] = field(default_factory=dict)
    """First and last version of keywords that are not in all versions."""
    ordered: bool = False
    """Several keywords must be in the order of `keywords`."""
    default: Default = None
    required: bool = False
    declares: str | None = None
    """Namespace in which this attribute declares a name."""
    refers: str | None = None
    """Namespace of the name in this attribute; `attached:…` is a namespace of the attached model."""
    refers_by: str | None = None
    """Sibling attribute whose keyword selects the namespace, through `Grammar.objtypes`."""
    folder: Literal["mesh", "texture", "model"] | None = None
    """The folder that a file is relative to: meshdir, texturedir, or the folder of the model's own file."""
    angle: Angle | None = None
    """The rule of `compiler/angle` for the value; `joint` is an angle for a hinge only (`range` and `springyield`
    also for a ball), `orientation-axisangle` only in the fourth number.
    """
    since: str | None = None
    until: str | None = None
    """First and last MuJoCo version with it; `None`: all versions that the grammar covers."""
    in_default: bool = False
    """It may be set in a default class."""
    doc: str = ""

    @property
    def is_number(self) -> bool:
        """Whether the value is one number or several."""
        return self.type in NUMERIC

    @property
    def is_interval(self) -> bool:
        """Whether the value is a lower and an upper end: MJCF calls every such pair a range (`ctrlrange`)."""
        return self.type == "real" and self.min_length == self.max_length == 2 and self.name.endswith("range")

    @property
    def is_reference(self) -> bool:
        """Whether the value names one other element or several."""
        return self.type in ("reference", "references")

    @property
    def separated(self) -> bool:
        """Whether the value is a list of items separated by white space."""
        return self.type in ("keywords", "references") or (self.type in NUMERIC and self.max_length != 1)

    def exists_in(self, version: str) -> bool:
        """Return whether that MuJoCo version (`"3.12.0"`) reads the attribute."""
        return exists_in(version, self.since, self.until)

    def versions(self) -> Iterator[str]:
        """Yield the first and the last MuJoCo version with it, in words."""
        if self.since is not None:
            yield f"since MuJoCo {self.since}"
        if self.until is not None:
            yield f"up to MuJoCo {self.until}"


def to_text(attribute: Attribute, value: object) -> str:
    """Return the text of a value that `check_python` accepts; text is unchanged, arrays are allowed.

    >>> from mjcompose.tree.grammar import GRAMMAR
    >>> to_text(GRAMMAR.element("geom").attributes["size"], [0.1, 2.0, -0.0])
    '0.1 2 -0'
    """
    convert = getattr(value, "tolist", None)
    if callable(convert):
        value = convert()
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        # MuJoCo refuses an integer with `.0`.
        return number_text(int(value) if attribute.type == "int" and float(value).is_integer() else value)
    if isinstance(value, Iterable):
        return " ".join(to_text(attribute, item) for item in value)
    raise TypeError(f"{attribute.name} cannot hold {type(value).__name__}")


class Constraint(Struct):
    """A rule about the presence of attributes. A bundle is complete if all its attributes are written.

    `exclusive`: attributes of at most one bundle. `together`: all of them or none. `requires`: the first bundle
    needs the second. `oneof`: at least one bundle is complete.
    """

    kind: Literal["exclusive", "together", "requires", "oneof"]
    bundles: tuple[tuple[str, ...], ...]


class Children(Mapping[str, "ElementType"]):
    """Child elements by tag. An element is created on first use, so recursion costs nothing."""

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


class ElementType(Struct, eq=False):
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
        """Whether it takes `class`, and defaults apply to it."""
        attribute = self.attributes.get("class")
        return attribute is not None and attribute.type == "reference"

    def exists_in(self, version: str) -> bool:
        """Return whether that MuJoCo version (`"3.12.0"`) reads the element."""
        return exists_in(version, self.since, self.until)

    def __repr__(self) -> str:
        return f"ElementType({self.path})"


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
                raise UnknownElement(path)
            return self.element(places[0])
        kind = self.element(first)
        try:
            for tag in rest.split("/"):
                kind = kind.children[tag]
        except KeyError:
            raise UnknownElement(path) from None
        return kind

    def section(self, tag: str) -> ElementType:
        """Return a child of the root: `worldbody`, `asset`, `option`, … Raises `KeyError` if there is none of that
        name.
        """
        return self.root.children[tag]

    def within(self, section: str) -> Mapping[str, ElementType]:
        """Return every element that can occur inside a section, at any depth, by tag.

        If a tag has several meanings, the one nearest to the section is used: `geom` within `worldbody` is the geom
        of a body, not of a composite.
        """
        known = self._within.get(section)
        if known is None:
            known = {}
            waiting = [self.section(section)]
            for parent in waiting:  # which grows
                for tag, child in parent.children.items():
                    if known.setdefault(tag, child) is child and child not in waiting:
                        waiting.append(child)
            self._within[section] = known
        return known

    @cached_property
    def families(self) -> Mapping[str, tuple[str, ...]]:
        """Paths of the elements that share a namespace: `joint` is `joint` and `freejoint`."""
        members: dict[str, tuple[str, ...]] = {}
        for path, raw in self._data["elements"].items():
            family = self._family(raw)
            if family is not None:
                members[family] = *members.get(family, ()), path
        return members

    @cached_property
    def namespaces(self) -> frozenset[str]:
        """Every namespace in which some element declares a name."""
        return frozenset(self.families)

    @property
    def objtypes(self) -> Mapping[str, str]:
        """Namespace for each keyword of `objtype` and `reftype` (`xbody` is `body`)."""
        objtypes: dict[str, str] = self._data["objtypes"]
        return objtypes

    @cached_property
    def _places(self) -> Mapping[str, tuple[str, ...]]:
        places: dict[str, tuple[str, ...]] = {}
        for path in self._data["elements"]:
            if not path.startswith("default/"):
                tag = path.rpartition("/")[2]
                places[tag] = *places.get(tag, ()), path
        return places

    def _rows(self, path: str, raw: dict[str, Any]) -> Iterable[tuple[str, str, dict[str, Any]]]:
        """Yield the written attributes of an element: (place, name, row), starting with its groups."""
        holders = [(group, self._data["groups"][group]) for group in raw.get("groups", ())]
        for place, holder in (*holders, (path, raw)):
            yield from ((place, name, row) for name, row in holder.get("attributes", {}).items())

    def _family(self, raw: dict[str, Any]) -> str | None:
        return next((row["declares"] for _, _, row in self._rows("", raw) if row["type"] == "name"), None)

    def _build(self, path: str) -> ElementType:
        raw = self._data["elements"][path]
        rows_of = raw.get("rows_of")
        if rows_of is None:
            rows = self._rows(path, raw)
            has_default = "default" in raw
            attributes = {name: self._attribute(place, name, row, has_default=has_default) for place, name, row in rows}
            constraints = self._constraints(raw)
        else:
            attributes = self._default_rows(rows_of)
            rules = self.element(rows_of).constraints
            constraints = tuple(rule for rule in rules if attributes.keys() >= set(chain(*rule.bundles)))
        low, high = COUNTS[raw["occurs"]]
        element = self._elements[path] = ElementType(
            path,
            path.rpartition("/")[2],
            attributes,
            children=Children({child.rpartition("/")[2]: child for child in raw.get("children", ())}, self.element),
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
        return element

    def _constraints(self, raw: dict[str, Any]) -> tuple[Constraint, ...]:
        holders = (*(self._data["groups"][group] for group in raw.get("groups", ())), raw)
        texts = (text.split() for holder in holders for text in holder.get("constraints", ()))
        return tuple(Constraint(kind, tuple(tuple(each.split("+")) for each in bundles)) for kind, *bundles in texts)

    def _default_rows(self, path: str) -> dict[str, Attribute]:
        """Return the attributes of an element that a class may set; `in_default` may be the first version with it."""
        attributes = {}
        for place, name, row in self._rows(path, self._data["elements"][path]):
            allowed = row.get("in_default", True)
            if allowed and allowed is not True:
                place = f"default/{place}"
                row = {**row, "since": allowed}
            if allowed:
                attributes[name] = self._attribute(place, name, row, has_default=True)
        return attributes

    def _attribute(self, place: str, name: str, row: dict[str, Any], has_default: bool) -> Attribute:
        key = (place, name, has_default)
        known = self._attributes.get(key)
        if known is not None:
            return known
        kind = row["type"]
        words, versions, ordered = self._keywords(row.get("keywords"))
        lengths = row.get("lengths")
        unwritten = {
            "keywords": (1, len(words)),
            "references": (1, None),
            **dict.fromkeys(("string", "file", "name", "reference"), (None, None)),
        }
        low, high = unwritten.get(kind, (1, 1))
        if lengths is not None:
            low = min(lengths)
            high = max(lengths)
        elif (length := row.get("length")) is not None:
            low, high = (length, length) if isinstance(length, int) else length
        default = row.get("default")
        docs = self._data.get("docs", {}).get("attributes", {})
        self._attributes[key] = attribute = Attribute(
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
        return attribute

    def _keywords(self, name: str | None) -> tuple[tuple[str, ...], Mapping[str, tuple[str | None, str | None]], bool]:
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
        return (here.parents[2] / "schemas" / "mjcf.json").read_text(encoding="utf-8")


GRAMMAR = Grammar(read_data)
