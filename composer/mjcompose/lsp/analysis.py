"""Facts about a recipe, a question about it, and the answers, as data."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping as Entries, Sequence
from dataclasses import field, replace
from functools import cached_property, lru_cache
from pathlib import Path as PathlibPath
from typing import TYPE_CHECKING, Any

from mjcompose.base.alignment import common_ends
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.files import Mark, mark_of, read_regular
from mjcompose.base.sink import Sink
from mjcompose.compose.load import Key, Library, source_key
from mjcompose.lsp.cursor import Cursor, Path, cursor_at
from mjcompose.lsp.language import ValueForm, forms_at
from mjcompose.plan.plan import BASE, PlacedModel, Plan
from mjcompose.sources.reference import Source
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, TextChange, find, lines_of, to_python
from mjcompose.tree.names import WORLD, NameIndex
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element

    from mjcompose.trace.traced import Traced


def marks(files: Iterable[PathlibPath], texts: Entries[str, bytes]) -> dict[PathlibPath, Mark | int]:
    """Return a mark for each file, which changes with its content. `texts` are unsaved texts by real path."""
    return {
        file: hash(text) if texts and (text := texts.get(os.path.realpath(file))) is not None else mark_of(file)
        for file in files
    }


def is_saved(path: str, text: bytes) -> bool:
    try:
        return read_regular(path) == text
    except OSError:
        return False


_MOST = 64  # how many units are kept: a workspace has many recipes, and memory is bounded


class FreshLibrary:
    """A `Library` that drops changed sources."""

    def __init__(self) -> None:
        self.library: Library = {}
        self._marks: dict[Key, dict[PathlibPath, Mark | int]] = {}

    def refresh(self, texts: Entries[str, bytes]) -> None:
        """Drop the units whose files have changed. `texts` are the unsaved texts of editors."""
        for key in [key for key, before in self._marks.items() if marks(before, texts) != before]:
            del self._marks[key]
            self.library.pop(key, None)

    def note(self, texts: Entries[str, bytes]) -> None:
        for key, unit in self.library.items():
            if key not in self._marks:  # texts without a path of their own belong to the file of the unit
                included = (text.path or PathlibPath(name) for name, text in unit.origins.texts.items())
                self._marks[key] = marks({key[0], *included}, texts)
        for key in list(self.library)[: max(0, len(self.library) - _MOST)]:
            del self.library[key]
            self._marks.pop(key, None)


_UNITS: dict[str, Callable[[str], int]] = {
    "utf-8": lambda character: len(character.encode("utf-8", "surrogatepass")),
    "utf-16": lambda character: 2 if ord(character) > 0xFFFF else 1,
    "utf-32": lambda character: 1,
}


def units(line: str, column: int, encoding: str = "utf-16") -> int:
    """Return the number of units of an encoding before a character, counted from 0.

    A place past the end counts as the end.

    >>> units("🤖: x", 1)
    2
    """
    return sum(map(_UNITS[encoding], line[: max(column, 0)]))


def column_of(line: str, count: int, encoding: str = "utf-16") -> int:
    """Return the index of the character after this many units.

    >>> column_of("🤖: x", 2), column_of("ab", 9)
    (1, 2)
    """
    size = _UNITS[encoding]
    passed = 0
    for column, character in enumerate(line):
        if passed >= count:
            return column
        passed += size(character)
    return len(line)


def moved(old: Sequence[str], new: Sequence[str]) -> dict[int, int]:
    """Return the numbers of the lines of a text in a later text, both counted from 0.

    Lines that may have changed are left out.

    >>> moved(["a", "b", "c"], ["a", "x", "y", "c"])
    {0: 0, 2: 3}
    """
    head, tail = common_ends(old, new)
    kept = {at: at for at in range(head)}
    kept |= {at: at + len(new) - len(old) for at in range(len(old) - tail, len(old))}
    return kept


def span_after(span: Span, lines: Entries[int, int]) -> Span | None:
    """Return a place in a later text, given the `lines` from `moved`; None for a line that may have changed."""
    line = lines.get(span.line - 1)
    end = None if span.end_line is None else lines.get(span.end_line - 1)
    if line is None or (span.end_line is not None and end is None):
        return None
    return replace(span, line=line + 1, end_line=None if end is None else end + 1)


class Item(Struct):
    """A completion. `insert` replaces the word, and in an attribute or element of XML, `$0` is the cursor afterwards.

    With `again`, the editor completes again. Small `rank`s come first.
    """

    label: str
    kind: str
    detail: str = ""
    doc: str = ""
    rank: float = 50
    insert: str = ""
    again: bool = False


class Hover(Struct):
    text: str
    span: Span | None = None


class Action(Struct):
    """A change that is offered for a diagnostic or a place. `is_preferred` marks the most likely one."""

    title: str
    changes: tuple[TextChange, ...]
    diagnostic: Diagnostic | None = None
    is_preferred: bool = False
    kind: str = "quickfix"


class Symbol(Struct):
    name: str
    kind: str
    span: Span
    whole: Span
    detail: str = ""
    children: tuple[Symbol, ...] = ()


class Hint(Struct):
    """Text that an editor shows after a place, as if it were written there."""

    span: Span
    text: str
    doc: str = ""


class Lens(Struct):
    """A command that is shown above a line; `arguments` are passed to it."""

    span: Span
    title: str
    command: str
    arguments: tuple[str, ...] = ()


class Fold(Struct):
    """A range of lines that can be folded, counted from 0."""

    first: int
    last: int
    kind: str = "region"


class Completion(Struct):
    """The completions at a place, and the stretch of the line that they replace."""

    items: tuple[Item, ...] = ()
    span: Span | None = None


_DESCRIBING = ("type", "pos", "joint", "tendon", "site", "file", "range")
"""The attributes that a line about an element shows."""


class Known(Struct):
    """A name. `part` is the path of its part, and `holder` the body that contains it."""

    name: str
    namespace: str
    tag: str
    part: str = ""
    holder: str = ""
    words: str = ""
    node: _Element | None = field(default=None, compare=False, repr=False)

    @property
    def detail(self) -> str:
        of = f" of {self.part}" if self.part else ""
        place = f", in {self.holder}" if self.holder else ""
        return f"{self.tag}{of}{place}{', ' + self.words if self.words else ''}"


class ModelNames(Struct, slots=False):
    """The names of a model by namespace, the paths of its parts, and their units and prefixes by path."""

    known: dict[str, dict[str, Known]] = field(default_factory=dict)
    parts: tuple[str, ...] = ()
    sources: dict[str, Unit] = field(default_factory=dict)
    prefixes: dict[str, str] = field(default_factory=dict)

    def find(self, namespace: str, name: str) -> Known | None:
        return self.known.get(namespace, {}).get(name)

    def own(self, part: str) -> ModelNames:
        """Return the names of a part without its prefix, from its source or from the model."""
        own: dict[str, dict[str, Known]] = {}
        unit = self.sources.get(part)
        if unit is not None:
            for each in _of_root(unit.root, "", []):
                own.setdefault(each.namespace, {})[each.name] = each
        elif prefix := self.prefixes.get(part):
            for namespace, names in self.known.items():
                inside = {name[len(prefix) :]: each for name, each in names.items() if name.startswith(prefix)}
                own[namespace] = {name: each for name, each in inside.items() if name}
        return ModelNames(own)


def names_of(plan: Plan, root: _Element | None, composed: Plan | None, library: Library) -> ModelNames:
    """Return the names of a composed model, and the names of the plan's parts that it lacks.

    `root` is the tree of that model and `composed` its plan, which may be older than `plan`.
    """
    places = [place for place in plan.walk() if place.model is not None and place.part]
    parts = sorted(((place.prefix, place.part) for place in places), key=lambda each: -len(each[0]))
    keys = {
        each.part: source_key(each.model, each.is_fixed_in_world) for each in places if isinstance(each.model, Source)
    }
    sources = {part: library[key] for part, key in keys.items() if key in library}
    there = set() if composed is None else set(map(_identity, composed.walk()))
    roots = [] if root is None else [(root, "")]
    roots += [
        (sources[each.part].root, each.prefix)
        for each in places
        if each.part in sources and _identity(each) not in there
    ]
    known = _by_namespace(each for root, prefix in roots for each in _of_root(root, prefix, parts))
    return ModelNames(known, plan.part_names, sources, {place.part: place.prefix for place in places})


def names_in_tree(unit: Unit) -> ModelNames:
    return ModelNames(_by_namespace(_of_root(unit.root, "", [])), sources={"": unit}, prefixes={"": ""})


def _by_namespace(found: Iterable[Known]) -> dict[str, dict[str, Known]]:
    known: dict[str, dict[str, Known]] = {}
    for each in found:
        known.setdefault(each.namespace, {}).setdefault(each.name, each)
    known.setdefault("body", {})[WORLD] = Known(WORLD, "body", "worldbody")
    return known


def _identity(placed: PlacedModel) -> tuple[str, object]:
    """Return a value that changes whenever the names of a part may change."""
    return placed.prefix, placed.model.path if isinstance(placed.model, Source) else None


def _of_root(root: _Element, prefix: str, prefixes: list[tuple[str, str]]) -> Iterator[Known]:
    part_of = dict(reversed(prefixes))  # the first of equal ones
    lengths = sorted({len(start) for start in part_of}, reverse=True)
    for namespace, declared in NameIndex.of(root).declared.items():
        for own, node in declared.items():
            name = prefix + own
            part = next((found for end in lengths if (found := part_of.get(name[:end])) is not None), "")
            body = next(node.iterancestors("body", "worldbody"), None)
            holder = "" if body is None else WORLD if body.tag == "worldbody" else str(body.get("name") or "")
            holder = prefix + holder if holder not in ("", WORLD) else holder
            words = ", ".join(f"{name} {value}" for name in _DESCRIBING if (value := node.get(name)))
            yield Known(name, namespace, str(node.tag), "" if part == BASE else part, holder, words, node)


_CLOSING = {"{": "}", "[": "]"}


def repaired(lines: Sequence[str], cursor: Cursor, last: Node | None) -> Node | None:
    """Return the tree of the text after the smallest change that makes it readable, or the last known tree.

    >>> from mjcompose.lsp.cursor import cursor_at
    >>> lines = ["sensor:", "  push: {type: force, site: "]
    >>> tree = repaired(lines, cursor_at(lines, 1, 28), None)
    >>> isinstance(tree, Mapping) and list(tree.entries)
    ['sensor']
    """
    if not any(line.strip() and not line.lstrip().startswith("#") for line in lines):
        return None
    for text in _candidates(list(lines), cursor):
        tree = _read(text)
        if isinstance(tree, Mapping):
            return tree
    return last


@lru_cache(maxsize=8)
def _read(text: str) -> Node | None:
    """Return the tree of a text, which an editor asks about several times: for a completion, a hover and so on."""
    return load(text, "", Sink())


def _candidates(lines: list[str], cursor: Cursor) -> Iterator[str]:
    yield "\n".join(lines)
    at = cursor.line
    if at >= len(lines):
        return
    line = lines[at]
    before = lines[:at]
    after = lines[at + 1 :]
    if cursor.in_flow:
        for head in (line, line[: cursor.end], line[: cursor.start].rstrip().rstrip(",:")):
            yield "\n".join([*before, head + cursor.quote * (head.count(cursor.quote) % 2) + _closers(head), *after])
            yield "\n".join([*before, head + ": null" + _closers(head), *after])
    elif not cursor.has_colon:
        yield "\n".join([*before, line + ":", *after])
    yield "\n".join([*before, "", *after])
    yield "\n".join(before)


def _closers(line: str) -> str:
    """Return the brackets that close the open brackets of a line."""
    waiting: list[str] = []
    quote = ""
    for character in line:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in _CLOSING:
            waiting.append(_CLOSING[character])
        elif waiting and character == waiting[-1]:
            waiting.pop()
    return "".join(reversed(waiting))


class ComposedModel(Struct, eq=False):
    """A composed model: its tree, the part of each element, the sources of that time and unsaved texts of editors."""

    unit: Unit
    plan: Plan
    parts: Entries[_Element, str]
    library: Library
    texts: Entries[str, bytes]


class Analysis(Struct, slots=False):
    """The result of analyzing a recipe. It never changes.

    `tree`, `plan` and `model` belong to the current text, or to the last text that had one; `is_current` and
    `is_composed` say which. `tree_of`, `plan_of` and `model_of` are the texts in which they were found. `found` has the
    diagnostics, `files` has all files that were read, and `library` has the sources as they were read.

    `traced` says where the elements of the model come from. It takes as long as the rest but no diagnostic needs it, so
    it is None until `Workspace.traced` computes it.
    """

    path: PathlibPath
    folder: PathlibPath
    text: str
    tree: Node | None = None
    plan: Plan | None = None
    model: ComposedModel | None = None
    traced: Traced | None = None
    is_current: bool = False
    is_composed: bool = False
    found: tuple[Diagnostic, ...] = ()
    files: frozenset[PathlibPath] = frozenset()
    library: Library = field(default_factory=dict)
    tree_of: str = ""
    plan_of: str = ""
    model_of: str = ""

    @cached_property
    def lines(self) -> list[str]:
        return lines_of(self.text)

    @cached_property
    def _moved(self) -> dict[str, Entries[int, int]]:
        return {}

    @cached_property
    def file(self) -> str:
        return shown(self.path, self.folder)

    @cached_property
    def names(self) -> ModelNames:
        if self.plan is None:
            return ModelNames()
        root, composed = (self.model.unit.root, self.model.plan) if self.model is not None else (None, None)
        return names_of(self.plan, root, composed, self.library)

    @property
    def mapping(self) -> Mapping | None:
        return self.tree if isinstance(self.tree, Mapping) else None

    @property
    def separator(self) -> str:
        return self.plan.separator if self.plan is not None else "/"

    def now(self, span: Span, of: str) -> Span | None:
        """Return the current place of a span in an earlier text, or None if it may have changed."""
        if span.file != self.file or of == self.text:
            return span
        return span_after(span, self._lines_after(of))

    def _lines_after(self, of: str) -> Entries[int, int]:
        """Return the numbers of the lines of an earlier text in this one; every place of that text needs the same."""
        lines = self._moved.get(of)
        if lines is None:
            lines = moved(lines_of(of), self.lines)
            self._moved[of] = lines
        return lines

    def all_now(self, spans: Iterable[Span | None], of: str) -> Iterator[Span]:
        """Yield the current places, except places that may have changed."""
        for span in spans:
            if span is not None and (now := self.now(span, of)) is not None:
                yield now


def shown(path: PathlibPath, folder: PathlibPath) -> str:
    """Return a path as spans write it in a context with this folder."""
    from mjcompose.sources.context import Context

    return Context(folder=folder, environment={}).shown(path)


class Question(Struct, slots=False):
    """A place in the newest `lines` of a recipe, with `line` and `column` from 0, and the recipe's analysis."""

    analysis: Analysis
    lines: list[str]
    line: int
    column: int

    @cached_property
    def cursor(self) -> Cursor:
        return cursor_at(self.lines, self.line, self.column)

    @cached_property
    def tree(self) -> Node | None:
        return repaired(self.lines, self.cursor, self.analysis.tree)

    @cached_property
    def data(self) -> Any:
        return None if self.tree is None else to_python(self.tree)

    @cached_property
    def forms(self) -> list[ValueForm]:
        return forms_at(self.cursor.path, self.data)

    @property
    def path(self) -> Path:
        return self.cursor.path

    def at(self, path: Path) -> Any:
        found = None if self.tree is None else find(self.tree, path)
        return None if found is None else to_python(found)

    @property
    def word(self) -> Span:
        cursor = self.cursor
        return Span(
            self.analysis.file, cursor.line + 1, cursor.start + 1, end_line=cursor.line + 1, end_column=cursor.end + 1
        )
