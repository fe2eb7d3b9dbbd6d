"""A model during its migration: its tree, its text, and the reason of each edit."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from html import unescape
from itertools import islice
from pathlib import Path
from typing import TypeAlias
from xml.sax.saxutils import quoteattr

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Cause, Span
from mjcompose.base.sink import Sink
from mjcompose.base.words import tag_text
from mjcompose.sources.context import Context
from mjcompose.tree.classes import childclass_of
from mjcompose.tree.files import join
from mjcompose.tree.grammar import exists_in, version_key
from mjcompose.tree.history import RELEASED, place, spans
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit, line_of
from mjcompose.tree.xml_text import Piece as Tag, pieces


def later(version: str, than: str) -> bool:
    return version_key(version) > version_key(than)


class MarkupError(Exception):
    """The form of the text differs from the tree that was read from it."""


class _Written(Struct, frozen=False):
    """An element in its text: its start tag, where its end tag begins (0: it has none), and where it ends."""

    head: Tag
    close: int = 0
    end: int = 0


class Markup(Struct, frozen=False):
    """The text of one file and its elements, in the order in which they begin."""

    text: str
    elements: list[_Written] = field(default_factory=list)

    @classmethod
    def read(cls, text: str) -> Markup:
        """Raises MarkupError if tags do not close each other."""
        found = cls(text)
        open_: list[_Written] = []
        for piece in pieces(text):
            if piece.kind == "start":
                element = _Written(piece, end=piece.end)
                found.elements.append(element)
                if not piece.closed:
                    open_.append(element)
            elif piece.kind == "end":
                element = open_.pop() if open_ else _Written(piece)
                if element.head.tag != piece.tag or element.head is piece:
                    raise MarkupError(piece.tag)
                element.close = piece.start
                element.end = piece.end
        if open_ or not all(each.head.complete for each in found.elements):
            raise MarkupError("")
        return found


class MigratedFile(Struct, frozen=False):
    """A file of a model: its markup, and the nodes of its elements (None: an `<include>` or a root)."""

    markup: Markup
    nodes: Sequence[Node | None]

    def rewritten(self, renamed: Mapping[Node, Mapping[str, str]]) -> str:
        """Return the text with the attributes, tags and new children that the nodes have now.

        `renamed` maps new names of attributes to old names, by node. Raises MarkupError for changes that overlap.
        """
        edits: list[tuple[int, int, str]] = []
        text = self.markup.text
        place = {node: each for node, each in zip(self.nodes, self.markup.elements, strict=True) if node is not None}
        for node, written in place.items():
            edits += _changes(node, written.head, written.close, renamed=renamed.get(node, {}), text=text)
            edits += _additions(node, written, place, text=text)
        result = []
        done = 0
        for start, end, new in sorted(edits, key=lambda edit: edit[:2]):
            if start < done:
                raise MarkupError(text[start:end])
            result += [text[done:start], new.replace("\n", "\r\n") if "\r\n" in text else new]
            done = end
        return "".join((*result, text[done:]))


def _changes(
    node: Node, head: Tag, close: int, renamed: Mapping[str, str], text: str
) -> Iterator[tuple[int, int, str]]:
    """Yield the changes of the tags and attributes of an element: places in the text, and their new text."""
    tag = str(node.tag)
    if tag != head.tag:
        starts = (head.start + 1, close + 2) if close else (head.start + 1,)
        for at in starts:
            yield at, at + len(head.tag), tag
    yield from _changed_attributes({str(name): str(value) for name, value in node.items()}, head, renamed, text)


def _changed_attributes(
    now: Mapping[str, str], head: Tag, renamed: Mapping[str, str], text: str
) -> Iterator[tuple[int, int, str]]:
    known = {attribute.name: attribute for attribute in head.attributes}
    kept = _kept(now, known, renamed)
    places = set(kept.values())
    for name, before in kept.items():
        attribute = known[before]
        if before != name:
            yield attribute.at, attribute.at + len(before), name
        if now[name] != unescape(attribute.value or ""):
            yield attribute.start - 1, attribute.end + 1, quoteattr(now[name])
    for name, attribute in known.items():
        if name not in places and name not in now:
            yield head.start + len(text[head.start : attribute.at].rstrip()), attribute.end + 1, ""
    new = [name for name in now if name not in known and renamed.get(name, name) not in places]
    if new:
        last = max((attribute.end + 1 for attribute in head.attributes), default=head.start + 1 + len(head.tag))
        yield last, last, "".join(f" {name}={quoteattr(now[name])}" for name in new)


def _kept(now: Mapping[str, str], known: Collection[str], renamed: Mapping[str, str]) -> dict[str, str]:
    """Return the names that stay in their place in the text, with their names before."""
    kept = {}
    for name in now:
        before = renamed.get(name, name)
        if before in known and (before == name or name not in known):
            kept[name] = before
    return kept


def _starts(children: Iterable[Node], written: _Written, place: Mapping[Node, _Written]) -> Iterator[int]:
    """Yield where the children of an element begin that are written inside it."""
    for child in children:
        if child in place and _inside(place[child], written):
            yield place[child].head.start


def _additions(
    node: Node, written: _Written, place: Mapping[Node, _Written], text: str
) -> Iterator[tuple[int, int, str]]:
    """Yield new children, each on a line of its own: before the next known child, or last."""
    fresh = [child for child in node.iterchildren("*") if child not in place and is_made(child)]
    if not fresh:
        return
    indent = _indent(text, written.head.start)
    texts: dict[int, str] = {}
    known = list(_starts(node.iterchildren("*"), written, place))
    step = "\t" if "\n\t" in text else "  "
    inner = _indent(text, known[0]) if known and _begins_line(text, known[0]) else indent + step
    for child in fresh:
        following = next(_starts(child.itersiblings("*"), written, place), None)
        markup = _markup(child, inner, step)
        at, added = (-1, f"\n{inner}{markup}") if following is None else (following, f"{markup}\n{inner}")
        texts[at] = texts.get(at, "") + added
    for at, added in texts.items():
        if at >= 0:
            yield at, at, added
        elif not written.close:
            start = len(text[: text.rindex("/", written.head.start, written.end)].rstrip())
            yield start, written.end, f">{added}\n{indent}</{node.tag!s}>"
        else:
            before = text[: written.close].rstrip(" \t\r\n")
            at = max(len(before), written.head.end)
            ends_line = "\n" in text[at : written.close]
            yield at, at, added if ends_line else f"{added}\n{indent}"


def _inside(child: _Written, parent: _Written) -> bool:
    return parent.head.start < child.head.start and child.end <= parent.end


def _markup(node: Node, indent: str, step: str) -> str:
    start = f"<{node.tag!s}" + "".join(f" {name!s}={quoteattr(str(value))}" for name, value in node.items())
    children = list(node.iterchildren("*"))
    if not children:
        return f"{start}/>"
    inner = "".join(f"\n{indent}{step}{_markup(each, indent + step, step)}" for each in children)
    return f"{start}>{inner}\n{indent}</{node.tag!s}>"


def _indent(text: str, at: int) -> str:
    line = text[text.rfind("\n", 0, at) + 1 : at]
    return line[: len(line) - len(line.lstrip(" \t"))]


def _begins_line(text: str, at: int) -> bool:
    return not text[text.rfind("\n", 0, at) + 1 : at].strip()


def is_made(node: Node) -> bool:
    """Return whether the migration made an element, which no file has yet."""
    return line_of(node) is None


@dataclass(frozen=True, slots=True)
class MigrationStep:
    """One edit: its change, its place, and its words."""

    change: str
    span: Span | None
    words: str


class Meaning(Struct):
    """A changed meaning; `arrays` are the arrays of `mjModel` that show it, if any."""

    change: str
    message: str
    span: Span | None
    help: str | None
    arrays: tuple[str, ...] = ()


Act: TypeAlias = "Callable[[Migration], None]"


class Change(Struct):
    """`version` is the first version with the new behavior, and `since` is the first version with the old behavior.

    `acts` edit a model so it keeps its meaning: forward from an earlier version, and backward to an earlier version.
    `arrays` are the fields of `mjModel` that show the change; without any, only a simulation shows it.
    """

    name: str
    version: str
    acts: tuple[Act | None, Act | None]
    arrays: tuple[str, ...] = ()
    since: str = "3.0.0"


class Migration(Struct, frozen=False):
    """`before` and `after` are the versions of the model before and after the migration.

    `whole` has the model and the models that it attaches, each with its own tree; it may be only the model itself.
    """

    unit: Unit
    sink: Sink
    before: str
    after: str
    change: Change | None = None
    steps: list[MigrationStep] = field(default_factory=list)
    meanings: list[Meaning] = field(default_factory=list)
    renamed: dict[Node, dict[str, str]] = field(default_factory=dict)
    values: dict[str, object] = field(default_factory=dict)
    refused: set[Node] = field(default_factory=set)
    whole: list[Migration] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.whole = self.whole or [self]

    @property
    def root(self) -> Node:
        return self.unit.root

    @property
    def name(self) -> str:
        return "" if self.change is None else self.change.name

    def at(self, *places: str) -> list[Node]:
        """Return the elements in these places, in the order of the file."""
        last = {each.rpartition("/")[2] for each in places}
        return [node for node in self.root.iter(*last) if place(node) in places]

    @property
    def stage(self) -> str:
        """The version that the model is for after the change: later changes may rename again."""
        if self.change is None:
            return self.after
        if version_key(self.before) <= version_key(self.after):
            return self.change.version
        return RELEASED[RELEASED.index(self.change.version) - 1]

    def stage_reads(self, path: str, attribute: str) -> bool:
        known = spans()
        return all(exists_in(self.stage, *known[name]) for name in (path, f"{path}@{attribute}") if name in known)

    def lacking(self, path: str, attribute: str, value: str) -> str:
        tag = path.rpartition("/")[2]
        return f'MuJoCo {self.after} has no `{attribute}` of `<{tag}>`, which is `"{value}"` in {self.before}'

    def value(self, node: Node, attribute: str) -> str | None:
        """Return the value of an attribute: written, or from a class."""
        own = node.get(attribute)
        if node.getroottree().getroot() is not self.root:
            return own
        if not place(node).startswith("default/"):
            return self.unit.classes.effective(node, childclass_of(node), attribute)
        around = islice(node.iterancestors("default"), 1, None)  # the classes around its own
        values = (each.get(attribute) for outer in around for each in outer.iterchildren(str(node.tag)))
        return own if own is not None else next((value for value in values if value is not None), None)

    def span(self, node: Node, attribute: str | None = None, *, key: bool = False) -> Span | None:
        """Return the place of an element or attribute; None for a new section."""
        if is_made(node):
            parent = node.getparent()
            return None if parent is None or parent is self.root else self.span(parent)
        return self.unit.origins.span(node, self.unit.file, attribute, key=key)

    def note(self, node: Node, words: str, attribute: str | None = None) -> None:
        self.steps.append(MigrationStep(self.name, self.span(node, attribute), words))

    def set(self, node: Node, attribute: str, value: str) -> None:
        had = node.get(attribute)
        if had != value:
            words = f'`{attribute}="{value}"`' + ("" if had is None else f' instead of `"{had}"`')
            self.note(node, f"wrote {words} at {called(node)}")
            node.set(attribute, value)

    def unset(self, node: Node, attribute: str) -> None:
        had = node.get(attribute)
        if had is not None:
            self.note(node, f'removed `{attribute}="{had}"` from {called(node)}', attribute)
            del node.attrib[attribute]
            self.renamed.get(node, {}).pop(attribute, None)

    def rename(self, node: Node, attribute: str, new: str, value: str | None = None) -> None:
        """Rename an attribute in place, optionally with a new value."""
        old = str(node.get(attribute))
        value = old if value is None else value
        self.note(node, f'replaced `{attribute}="{old}"` with `{new}="{value}"` at {called(node)}', attribute)
        original = self.renamed.setdefault(node, {}).pop(attribute, attribute)
        pairs = [(new, value) if name == attribute else (str(name), str(was)) for name, was in node.items()]
        node.attrib.clear()
        node.attrib.update(dict(pairs))
        if original != new:
            self.renamed[node][new] = original

    def retag(self, node: Node, tag: str) -> None:
        self.note(node, f"replaced `<{node.tag}>` with `<{tag}>`")
        node.tag = tag

    def insert(self, parent: Node, tag: str, attributes: dict[str, str]) -> None:
        etree.SubElement(parent, tag, attributes)
        written = "".join(f' {name}="{value}"' for name, value in attributes.items())
        self.note(parent, f"wrote `<{tag}{written}/>`")

    def within(self, path: str) -> Node:
        """Return the only element of a section, made if it is missing: `option/flag`, `visual/headlight`."""
        section, _, tag = path.partition("/")
        found = self.at(path)
        if found:
            return found[-1]
        holder = next(reversed(self.at(section)), None)
        if holder is None:
            holder = etree.Element(section)
            first = list(self.root.iterchildren("compiler", "include"))
            self.root.insert(self.root.index(first[-1]) + 1 if first else len(self.unit.header), holder)
        return etree.SubElement(holder, tag) if tag else holder

    def warn(
        self,
        node: Node | None,
        message: str,
        help: str | None = None,
        attribute: str | None = None,
        arrays: tuple[str, ...] | None = None,
    ) -> None:
        """Report an element or attribute whose meaning changes."""
        shown = () if self.change is None else self.change.arrays
        span = None if node is None else self.span(node, attribute)
        self.meanings.append(Meaning(self.name, message, span, help=help, arrays=shown if arrays is None else arrays))

    def refuse(self, node: Node, message: str, help: str | None = None, attribute: str | None = None) -> None:
        if attribute is None and node in self.refused:
            return
        self.refused.add(node)
        cause = Cause(f"{self.name} {message}", called(node))
        self.sink.error("migrate-cannot", message, self.span(node, attribute), help=help, cause=cause)


def called(node: Node) -> str:
    return tag_text(str(node.tag), node.get("name") or node.get("class"))


class NestedModel(Struct, frozen=False, eq=False):
    """A model with its attached models, by the names in its `<attach>` elements."""

    unit: Unit
    attached: dict[str, NestedModel] = field(default_factory=dict)


class Pieces(Struct, frozen=False):
    """A model and all attached models, each once, the model itself first; `left` reports files that stay unchanged."""

    context: Context
    every: list[NestedModel] = field(default_factory=list)
    left: list[Meaning] = field(default_factory=list)
    _known: dict[str, NestedModel] = field(default_factory=dict)

    @classmethod
    def of(cls, unit: Unit, context: Context) -> Pieces:
        """Read the models that a model attaches, and report errors."""
        found = cls(context)
        found._read(unit, (os.path.realpath(unit.directory / os.path.basename(unit.file)),))
        return found

    def _read(self, unit: Unit, above: tuple[str, ...]) -> NestedModel:
        """`above` are the files that lead to it, and its own, because MuJoCo 4.0 crashes if a model attaches itself."""
        piece = NestedModel(unit)
        self.every.append(piece)
        for element in unit.root.iterfind("asset/model"):
            file = str(element.get("file") or "")
            path = Path(os.path.normpath(join(str(unit.directory), file)))
            shown = self.context.shown(path)
            real = os.path.realpath(path)
            span = unit.origins.span(element, unit.file, "file")
            if real in above:
                help = "remove this `<model>`, or name another file"
                self.context.sink.error("source-cycle", f"the model `{file}` attaches itself", span, help=help)
                continue
            if not file or not unit.door.exists(path):
                continue  # MuJoCo reports it
            if "urdf" in f"{element.get('content_type')} {path.suffix}".lower():
                self.left.append(Meaning("attached", f"`{shown}` is URDF, and stays unchanged", span, help=None))
                continue
            if real not in self._known:
                attached = parse_file(path, self.context.sink, file=shown, span=span, door=unit.door)
                if attached is None:
                    continue
                self._known[real] = self._read(attached, (*above, real))
            inner = self._known[real]
            piece.attached[str(element.get("name") or inner.unit.model)] = inner
        return piece

    def measured(self, piece: NestedModel, values: Mapping[str, object]) -> dict[str, object]:
        """Return the measured values by the names that a piece has for its own actuators.

        An actuator that is attached several times has a value if all copies have the same value.
        """
        kv = values.get("kv")
        if piece is self.every[0] or not isinstance(kv, dict):
            return dict(values)
        prefixes = [prefix for each, prefix in _placed(self.every[0], "") if each is piece]
        names = (str(node.get("name") or "") for node in piece.unit.root.iterfind("actuator/*"))
        several = {name: {kv.get(prefix + name) for prefix in prefixes} for name in names if name}
        return {"kv": {name: each.pop() for name, each in several.items() if len(each) == 1 and None not in each}}


def _placed(piece: NestedModel, prefix: str) -> Iterator[tuple[NestedModel, str]]:
    """Yield the pieces as MuJoCo attaches them, with the prefix of their names."""
    yield piece, prefix
    for attach in piece.unit.root.iter("attach"):
        inner = piece.attached.get(str(attach.get("model") or ""))
        if inner is not None:
            yield from _placed(inner, prefix + str(attach.get("prefix") or ""))
