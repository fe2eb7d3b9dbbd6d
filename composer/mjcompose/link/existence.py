"""The net of existence: the elements that a model writes, against the elements that MuJoCo compiled.

MuJoCo (3.12 to 4.0) drops some elements without an error, and multiplies others. `link/expansion.py` lists the known
cases. The net compares names by kind, in both directions. The written names, with every `<replicate>` carried out, come
from the tree alone, and the compiled ones from `mjModel`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Severity
from mjcompose.base.report import with_rest
from mjcompose.base.words import plural
from mjcompose.link import numbers
from mjcompose.link.boundaries import CODE
from mjcompose.link.expansion import SECTIONS, Expansion, suffixes
from mjcompose.link.linking import shown_name
from mjcompose.tree.names import own_name
from mjcompose.tree.unit import Unit

_ON_BODIES = {
    "body": "body",
    "joint": "joint",
    "freejoint": "joint",
    "geom": "geom",
    "site": "site",
    "camera": "camera",
    "light": "light",
    "flexcomp": "flex",
}
_OF_SECTIONS = {
    "asset": dict.fromkeys(("mesh", "hfield", "texture", "material", "skin")),
    "deformable": dict.fromkeys(("flex", "skin")),
    "contact": dict.fromkeys(("pair", "exclude")),
    "custom": dict.fromkeys(("numeric", "text", "tuple")),
    "keyframe": {"key": None},
}
_ONE_KIND = frozenset({"tendon", "equality", "actuator", "sensor"})
"""Sections whose elements are all of one kind, whatever their tags."""

_DROPPED_BY = {"discardvisual": ("geom", "mesh", "material", "texture"), "fusestatic": ("body",)}
"""Settings by which MuJoCo leaves out elements on purpose. Only models whose settings a composition keeps have them."""

_HOLDERS = frozenset({"worldbody", "body", "frame", "replicate"})
"""The elements in which MuJoCo reads those of `_ON_BODIES`. It ignores them elsewhere, which a build reports."""

_GENERATORS = ("flexcomp", "composite", "attach")


class ExistenceFault(NamedTuple):
    """An element that is compiled less or more often than it is written, or a kind of elements without names.

    `names` are the missing names, or the names that are too many. `element` is None if no element has such a name.
    """

    kind: str
    element: Node | None
    names: tuple[str, ...]
    number: int
    is_missing: bool


class WrittenElements(Struct):
    """The elements of a model by kind, each with its name in MuJoCo; `""` for none."""

    elements: Mapping[str, Sequence[tuple[str, Node]]]
    generated: tuple[str, ...] = ()
    """The beginnings of the names that MuJoCo gives to generated elements; an empty one begins every name."""
    dropped: frozenset[str] = frozenset()
    """The kinds of which MuJoCo leaves out elements on purpose."""
    least_keys: int = 0
    """The number of keys that `<size>` requests. MuJoCo adds keys without a name."""
    replicated: bool = False
    attached: bool = False
    """Whether MuJoCo attaches other models, whose keys it names by the prefix of their own `<attach>` alone."""

    @classmethod
    def of(cls, root: Node) -> WrittenElements:
        """Return the elements of a model. It reads the tree only."""
        replicated = next(root.iter("replicate"), None) is not None
        elements: dict[str, list[tuple[str, Node]]] = {}
        for worldbody in root.iterchildren("worldbody"):
            _add_bodies(worldbody, elements, replicated=replicated)
        for section in root.iterchildren("*"):
            _add_section(section, elements, replicated=replicated)
        if replicated:
            _add_expanded(root, elements)
        elements["plugin"] = list(_plugins(root, replicated))
        return cls(
            elements,
            tuple(_generated(root)),
            _dropped(root),
            least_keys=_least_keys(root),
            replicated=replicated,
            attached=next(root.iter("attach"), None) is not None,
        )

    @staticmethod
    def dropped_by(root: Node, kind: str) -> tuple[Node, str] | None:
        """Return the `<compiler>` by which MuJoCo leaves out elements of a kind, and the name of its setting."""
        settings = (name for name, kinds in _DROPPED_BY.items() if kind in kinds)
        compilers = list(root.iterchildren("compiler"))
        return next(((each, name) for name in settings for each in compilers if each.get(name) == "true"), None)

    def faults(self, compiled: Mapping[str, Sequence[str]]) -> Iterator[ExistenceFault]:
        """Yield the differences from the names in a compiled model, which are by kind."""
        for kind, names in compiled.items():
            elements = self.elements.get(kind, ())
            written = [name for name, _ in elements]
            found = list(names[1:]) if kind == "body" else list(names)
            if sorted(written) != sorted(found):
                yield from self._differences(kind, Counter(written), Counter(found))

    def _differences(self, kind: str, written: Counter[str], found: Counter[str]) -> Iterator[ExistenceFault]:
        missing = written - found
        extra = found - written
        if kind in self.dropped:
            missing.clear()
        if kind == "key":
            extra[""] = min(extra[""], sum(found.values()) - self.least_keys)
        by_element: dict[Node, list[str]] = {}
        for name, element in self.elements.get(kind, ()):
            if missing[name] > 0:
                missing[name] -= 1
                if not _is_ignored(element):
                    by_element.setdefault(element, []).append(name)
        for element, names in by_element.items():
            yield ExistenceFault(kind, element, tuple(names), len(names), is_missing=True)
        yield from self._extra(kind, extra)

    def _extra(self, kind: str, extra: Counter[str]) -> Iterator[ExistenceFault]:
        by_element: dict[Node | None, list[str]] = {}
        for name in extra.elements():
            if not self._is_generated(kind, name):
                by_element.setdefault(self._origin(kind, name), []).append(name)
        for element, names in by_element.items():
            yield ExistenceFault(kind, element, tuple(dict.fromkeys(names)), len(names), is_missing=False)

    def _is_generated(self, kind: str, name: str) -> bool:
        # MuJoCo 4.0 warns of "pending keyframes" if an attached model attaches another one: in a model with `<attach …
        # prefix="i_"/>` of a model with `<attach … prefix="e_"/>`, the key `home` of the innermost is `e_home`.
        if kind == "key" and self.attached:
            return True
        return bool(self.generated) and (not name or name.startswith(self.generated))

    def _origin(self, kind: str, name: str) -> Node | None:
        """Return the element whose name MuJoCo has extended, or the first one without a name."""
        elements = self.elements.get(kind, ())
        if not name:
            return next((element for own, element in elements if not own), None)
        longest = max((own for own, _ in elements if own and name.startswith(own)), key=len, default=None)
        return next((element for own, element in elements if own == longest), None)


def _is_ignored(element: Node) -> bool:
    parent = element.getparent()
    on_body = element.tag in _ON_BODIES and next(element.iterancestors("worldbody"), None) is not None
    return on_body and parent is not None and parent.tag not in _HOLDERS


def _add_bodies(worldbody: Node, elements: dict[str, list[tuple[str, Node]]], *, replicated: bool) -> None:
    for tag, kind in _ON_BODIES.items():
        rows = elements.setdefault(kind, [])
        for node in worldbody.iter(tag):
            name = node.get("name") or ""
            if not replicated:
                rows.append((name, node))
            else:
                rows.extend((name and name + end, node) for end in _ends(node))


def _ends(node: Node) -> Iterator[str]:
    """Yield the end of the name of each copy of an element of the body tree; one empty end without replicates."""
    around = [suffixes(replicate) for replicate in node.iterancestors("replicate")]
    for ends in product(*around):
        yield "".join(ends)


def _add_section(section: Node, elements: dict[str, list[tuple[str, Node]]], *, replicated: bool) -> None:
    tag = str(section.tag)
    if tag in _ONE_KIND:
        if not replicated:
            rows = elements.setdefault(tag, [])
            rows.extend((node.get("name") or "", node) for node in section.iterchildren("*"))
        return
    for child, kind in _OF_SECTIONS.get(tag, {}).items():
        if replicated and tag in SECTIONS:
            continue
        rows = elements.setdefault(kind or child, [])
        rows.extend((own_name(node, "name") or "", node) for node in section.iterchildren(child))


def _add_expanded(root: Node, elements: dict[str, list[tuple[str, Node]]]) -> None:
    for section, rows in Expansion.of(root).rows.items():
        for row in rows:
            tag = str(row.element.tag)
            kind = section if section in _ONE_KIND else tag
            name = row.name or own_name(row.element, "name") or ""
            elements.setdefault(kind, []).append((name, row.element))


def _plugins(root: Node, replicated: bool) -> Iterator[tuple[str, Node]]:
    """Yield each plugin instance with its name; without one if it is written where it is used.

    MuJoCo 4.0 copies the instance of a copied actuator or sensor: `pid` becomes `pid0` and `pid1`.
    """
    ends: dict[str, dict[str, None]] = {}
    for node, end in _users_of_plugins(root, replicated):
        used = node.get("instance")
        if used:
            ends.setdefault(used, {})[end] = None
        else:
            yield "", node
    for instance in root.iterfind("extension/plugin/instance"):
        name = str(instance.get("name") or "")
        for end in ends.get(name) or ("",):
            yield name + end, instance


def _users_of_plugins(root: Node, replicated: bool) -> Iterator[tuple[Node, str]]:
    """Yield each element that uses a plugin, once for each copy, with the end of the copy's name."""
    for top in root.iterchildren("worldbody", "asset"):
        for node in top.iter("plugin"):
            if replicated:
                yield from ((node, end) for end in _ends(node))
            else:
                yield node, ""
    if not replicated:
        yield from ((node, "") for section in ("actuator", "sensor") for node in root.iterfind(f"{section}/plugin"))
        return
    rows = Expansion.of(root, ("actuator", "sensor")).rows
    for section in ("actuator", "sensor"):
        for row in rows[section]:
            if row.element.tag == "plugin":
                yield row.element, "".join(suffixes(replicate)[number] for replicate, number in row.within)


def _generated(root: Node) -> Iterator[str]:
    for node in root.iter(*_GENERATORS):
        if node.tag == "flexcomp":
            yield f"{node.get('name')}_"
        else:
            yield str(node.get("prefix") or "")


def _dropped(root: Node) -> frozenset[str]:
    settings = {name for compiler in root.iterchildren("compiler") for name, text in compiler.items() if text == "true"}
    return frozenset(kind for setting, kinds in _DROPPED_BY.items() if setting in settings for kind in kinds)


def _least_keys(root: Node) -> int:
    return max((numbers.integer(str(size.get("nkey") or 0)) for size in root.iterchildren("size")), default=0)


_SHOWN = 8


def existence_faults(model: Unit, compiled: Mapping[str, Sequence[str]]) -> list[Diagnostic]:
    """Return an error for each element that MuJoCo dropped or multiplied, at the line that wrote it."""
    written = WrittenElements.of(model.root)
    return [_diagnostic(fault, written, model) for fault in written.faults(compiled)]


def _diagnostic(fault: ExistenceFault, written: WrittenElements, model: Unit) -> Diagnostic:
    element = fault.element
    notes: list[Note] = []
    if element is None:
        message = f"the compiled model has {_counted(fault)} that nothing in the model writes"
        help = "this is a fault of mjcompose: please report it"
        return Diagnostic(CODE, message, None, severity=Severity.ERROR, help=help)
    called = f"the `<{element.tag}>` {shown_name(element)}"
    if fault.is_missing:
        message = f"MuJoCo drops {called}: the compiled model has no {_counted(fault)}"
        help = "write it for each copy of the `<replicate>`, with the names of the copies"
    else:
        message = f"MuJoCo multiplies {called}: the compiled model also has {_counted(fault, 'the ')}"
        help = "write the copies out instead of `<replicate>`, or give the elements that it refers to other names"
    if not written.replicated:
        help = "this is a fault of MuJoCo or of mjcompose: please report it"
    for replicate in model.root.iter("replicate"):
        notes.append(Note("a `<replicate>` of the model", model.origins.span(replicate, model.file)))
        break
    return Diagnostic(
        CODE,
        message,
        model.origins.span(element, model.file),
        severity=Severity.ERROR,
        help=help,
        notes=tuple(notes),
        subjects=frozenset((str(element.get("name") or ""),)),
    )


def _counted(fault: ExistenceFault, article: str = "") -> str:
    names = [f"`{name}`" for name in fault.names if name]
    nameless = fault.number - sum(1 for name in fault.names if name)
    if not names:
        return f"{fault.kind} without a name" if nameless == 1 else f"{nameless} {plural(fault.kind)} without a name"
    kind = fault.kind if len(names) == 1 else plural(fault.kind)
    return f"{article}{kind} {', '.join(with_rest(names, _SHOWN))}"
