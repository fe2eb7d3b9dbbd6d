"""One source as a tree, with the origin of each element and the data that keeps its meaning when it moves."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from functools import cached_property, partial
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import NOTHING, Door
from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import TooLarge, read_regular
from mjcompose.tree import journal
from mjcompose.tree.classes import Classes
from mjcompose.tree.files import SourceSettings, join, read_settings
from mjcompose.tree.merged_settings import Adopted, ReadRow
from mjcompose.tree.xml_text import SourceText

_LAST_LINE = 65535


def line_of(element: Node) -> int | None:
    """Return the line on which the element's start tag ends in its file, or None if it was not read from a file."""
    line: Any = element.sourceline  # in lxml 6.1 not the first line of a start tag that is on several
    return line if isinstance(line, int) else None


def set_line(element: Node, line: int | None) -> None:
    """Set the line of a created element, as far as lxml allows."""
    if line is not None and line <= _LAST_LINE:
        element.sourceline = line  # type: ignore[assignment]  # the stubs know it as read alone


def element_at(root: Node, text: bytes, line: int) -> Node | None:
    """Return the element of `root` whose start tag is on that line of `text`, which was written from `root`."""
    read = etree.fromstring(text, etree.XMLParser(remove_blank_text=True, huge_tree=True))
    pairs = zip(read.iter("*"), root.iter("*"), strict=False)
    return next((element for written, element in pairs if written.sourceline == line), None)


class FileText(Struct, frozen=False, eq=False):
    """A file's text, for the places of its elements. Copies of a model share it and split it into lines once.

    `path` is None for text that is in no file. Without `contents`, the first use reads the file.
    """

    path: Path | None = None
    contents: bytes | str | None = None
    _split: SourceText | None = None

    def split(self) -> SourceText:
        """Return the text in lines, without any if the file cannot be read."""
        if self._split is None:
            contents = self.contents
            if contents is None and self.path is not None:
                with suppress(OSError):
                    contents = read_regular(self.path)
            self._split = SourceText(contents or b"")
        return self._split


Kind = Literal["key", "edited", "entry", "reference", "zero", "mujoco"]


class KeySource(Struct):
    """The origin of numbers of a key.

    - `key`: the attribute `vector` of the `<key>` element `key`, as it was read.
    - `edited`: the same attribute, changed by an edit after the row was cut.
    - `entry`: the entry at `span` of the recipe's section `keyframe`.
    - `reference`: no key: a number of the reference configuration (`qpos`, `mpos`, `mquat`).
    - `zero`: no key: the number is 0 (`qvel`, `act`, `ctrl`).
    - `mujoco`: the row of `key` ends in the middle of a joint, and MuJoCo completes it.

    `taken` are the `from` entries of recipes that passed the number on. `moved` are the parts whose place changed it,
    each with the place of its attachment. Both are in order. `lost` is the first number of a key that an edit has made
    meaningless here. `joint` is the joint from whose number a control follows. `hold` is the way in which a control or
    activation holds the pose of its key, `positions` or `forces`; the forces follow from the whole model, so each
    composition computes them again.
    """

    kind: Kind
    vector: str
    key: Node | None = None
    span: Span | None = None
    taken: tuple[Span, ...] = ()
    moved: tuple[tuple[str, Span | None], ...] = ()
    lost: Number | None = None
    joint: str | None = None
    hold: str = ""


class Number(NamedTuple):
    """A number as text. It is number `at`, counted from 0, of its `source`."""

    text: str
    source: KeySource
    at: int = 0


class KeyRecord(Struct):
    """The layout of a `<key>`: the elements that it replaces, and its numbers by attribute, including `time`.

    `void` are the joints and actuators whose numbers in those elements no longer have a meaning. The record is valid
    until the attribute changes, which `numbers_of` checks.
    """

    keys: tuple[Node, ...] = ()
    numbers: dict[str, list[Number]] = field(default_factory=dict)
    void: frozenset[Node] = frozenset()


def numbers_of(record: KeyRecord | None, key: Node, vector: str) -> list[Number]:
    """Return the numbers of a `<key>` in an attribute, each with its origin."""
    text = str(key.get(vector) or "").split()
    known = None if record is None else record.numbers.get(vector)
    if known is not None and texts(known) == text:
        return known
    source = KeySource("key" if known is None else "edited", vector, key)
    return [Number(each, source, at) for at, each in enumerate(text)]


def texts(numbers: Iterable[Number]) -> list[str]:
    return [number.text for number in numbers]


def moved(numbers: list[Number], now: Sequence[str], part: tuple[str, Span | None]) -> list[Number]:
    """Return a pose or velocity changed by the place of a part."""
    if texts(numbers) == list(now):
        return numbers
    changed = _with_sources(numbers, lambda source: replace(source, moved=(*source.moved, part)))
    return [number._replace(text=text) for number, text in zip(changed, now, strict=True)]


def taken(numbers: Iterable[Number], span: Span) -> list[Number]:
    """Return the numbers passed on by a `from` entry of a recipe."""
    return _with_sources(numbers, lambda source: replace(source, taken=(*source.taken, span)))


def _with_sources(numbers: Iterable[Number], change: Callable[[KeySource], KeySource]) -> list[Number]:
    """Return the numbers with changed sources; numbers that shared a source still share it."""
    numbers = list(numbers)
    sources = {id(number.source): number.source for number in numbers}
    changed = {key: change(source) for key, source in sources.items()}
    return [number._replace(source=changed[id(number.source)]) for number in numbers]


class RecipeValue(Struct):
    """A value that a recipe gives an element: by an edit, a draw or an addition.

    `before` is the text that was in effect. A draw is of the numbers from `start` on, between `low` and `high`.
    """

    attribute: str
    span: Span
    way: Literal["edit", "draw", "add"]
    before: str | None = None
    start: int = 0
    low: float = 0.0
    high: float = 0.0


Place = Callable[[str | None], Span]
"""Returns the place of an element in a recipe, or with an attribute's name the place of its value."""


_BY_ELEMENT = ("owners", "updates", "settings", "renamed", "keys", "delays", "values")
"""The tables of `Origins` whose keys are elements."""


class Origins(Struct, frozen=False):
    """The file of every subtree whose file is not its parent's, and the recipe place of elements that a recipe wrote.

    Line numbers need no storage: lxml keeps the line of each element, and they survive moves and copies. `owners`
    holds the elements themselves, so their identity is stable. `updates` has the places of elements that a recipe has
    changed: unlike an owner, an update says nothing about the elements below. `texts` has the files that the model was
    read from, by name in messages, also those without text, such as meshes. `settings` has the attributes that a
    program or the linker has set, each with its place or a function that returns it. `renamed` has each old and new
    name of an edit. `keys` has the layout of keys that differ from their file. `unread` has faults that MuJoCo ignores
    in the files themselves, by file, line and attribute (None: the element). `delays` has the actuators whose
    `nsample` follows from their `delay` and the time step, with the text of `nsample` at that time. `values` has the
    values of recipes, which may have no effect. `size` is the bytes of all files.
    """

    owners: dict[Node, str | Span | Place] = field(default_factory=dict)
    updates: dict[Node, Place] = field(default_factory=dict)
    texts: dict[str, FileText] = field(default_factory=dict)
    settings: dict[Node, dict[str, Span | Callable[[], Span]]] = field(default_factory=dict)
    renamed: dict[Node, list[tuple[str, str]]] = field(default_factory=dict)
    keys: dict[Node, KeyRecord] = field(default_factory=dict)
    unread: set[tuple[str, int | None, str | None]] = field(default_factory=set)
    delays: dict[Node, str] = field(default_factory=dict)
    values: dict[Node, list[RecipeValue]] = field(default_factory=dict)
    size: int = 0

    def own(self, element: Node, owner: str | Span | Place) -> None:
        self.owners[element] = owner

    def update(self, element: Node, place: Place) -> None:
        """Set the places of the attributes of an element that a recipe changes."""
        self.updates[element] = place

    def own_as(self, element: Node, other: Node) -> None:
        """Give a new element the owner of another one, and the places of its changes; not of elements above it."""
        owner = self.owners.get(other)
        if owner is not None:
            self.owners[element] = owner
        update = self.updates.get(other)
        if update is not None:
            self.updates[element] = update

    def own_all(self, elements: Iterable[Node], owner: str | Span | Place) -> None:
        """Set the owner of all elements that do not have one yet."""
        for element in elements:
            self.owners.setdefault(element, owner)

    def owner(self, element: Node, default_file: str) -> str | Span | Place:
        """Return the place in a recipe that wrote the element, or the file that contains it."""
        update = self.updates.get(element)
        if update is not None:
            return update
        while (owner := self.owners.get(element)) is None and (above := element.getparent()) is not None:
            element = above
        return default_file if owner is None else owner

    def span(self, element: Node, default_file: str, attribute: str | None = None, *, key: bool = False) -> Span:
        """Return the place to show: the start tag, or the value of `attribute`, or its name with `key`, if written."""
        if attribute is not None and (found := self.set_at(element, attribute)) is not None:
            return found
        return self.span_by(self.owner(element, default_file), element, attribute, key=key)

    def lasting_place(
        self, element: Node, default_file: str, attribute: str | None = None
    ) -> Callable[[], Span] | None:
        """Return a function that returns the present place of an element, also after the element has changed.

        None for an element that is in no file.
        """
        if attribute is not None and (found := self.settings.get(element, {}).get(attribute)) is not None:
            return found if callable(found) else lambda: found
        owner = self.owner(element, default_file)
        if isinstance(owner, Span):
            return lambda: owner
        if not isinstance(owner, str):
            return partial(owner, attribute)
        line = line_of(element)
        written = {str(name): str(value) for name, value in element.items()}
        if line is None:
            return None
        return partial(self.in_file, owner, line, str(element.tag), written=written, attribute=attribute)

    def set_at(self, element: Node, attribute: str) -> Span | None:
        """Return where a program, a recipe or the linker has set an attribute; None for an attribute from its file."""
        found = self.settings.get(element, {}).get(attribute)
        return found() if callable(found) else found

    def span_by(
        self, owner: str | Span | Place, element: Node, attribute: str | None = None, key: bool = False
    ) -> Span:
        """Return the place of `element` according to `owner`, which may be an earlier one."""
        if isinstance(owner, Span):
            return owner
        if not isinstance(owner, str):
            return owner(attribute)
        written = {str(name): str(value) for name, value in element.items()}
        return self.in_file(owner, line_of(element), str(element.tag), written=written, attribute=attribute, key=key)

    def in_file(
        self,
        file: str,
        line: int | None,
        tag: str,
        written: Mapping[str, str],
        attribute: str | None = None,
        key: bool = False,
    ) -> Span:
        """Return the start tag of the element that ends on that line of a file, or the place of its attribute."""
        text = self.text(file)
        found = None
        if text is not None and line is not None:
            if attribute is not None:
                found = text.attribute(tag, line, written, name=attribute, key=key)
            found = found or text.element(tag, line, written)
        if found is None:
            return Span(file, line or 1, 1)
        return Span(file, found.line, found.column, end_line=found.line, end_column=found.end_column)

    def adopt(self, other: Origins) -> None:
        """Add the data of elements that have moved here from another tree."""
        for name in ("texts", "unread", *_BY_ELEMENT):
            getattr(self, name).update(getattr(other, name))

    def carried(self, old: Node, new: Node) -> Origins:
        """Return the same data for `new`, a deep copy of `old`."""
        return self.carried_to(zip(old.iter(), new.iter(), strict=True))

    def carried_to(self, pairs: Iterable[tuple[Node, Node]]) -> Origins:
        """Return the same data for copies; `pairs` has each node with its copy."""
        carried = Origins(texts=dict(self.texts), unread=set(self.unread), size=self.size)
        tables = [(getattr(self, name), getattr(carried, name)) for name in _BY_ELEMENT]
        if any(known for known, _ in tables):
            for node, twin in pairs:
                for known, kept in tables:
                    entry = known.get(node)
                    if entry is not None:
                        kept[twin] = entry.copy() if isinstance(entry, dict | list) else entry
        return carried

    def count(self, more: int, most: int) -> None:
        """Count the bytes of a file. Raises TooLarge if all files of the model have more than `most` together."""
        self.size += more
        if self.size > most:
            raise TooLarge(self.size, most, "the files of this model are together")

    def text(self, file: str) -> SourceText | None:
        """Return the text of a file, read on first use, or None if the model was not read from it."""
        known = self.texts.get(file)
        return None if known is None else known.split()


class KeyValues(Struct, frozen=False, eq=False):
    """Numbers by vector (`qpos`, …) and by their owner; `element` is where it is written.

    `others` are the elements of keys that were merged into it.
    """

    name: str
    time: Number | None
    element: Node
    file: str
    origins: Origins
    values: dict[str, dict[Any, list[Number]]] = field(default_factory=dict)
    others: tuple[Node, ...] = ()

    def span(self, attribute: str | None = None) -> Span:
        """Return where the key is written, or the value of its attribute."""
        return self.origins.span(self.element, self.file, attribute)


class PartKeys(NamedTuple):
    """The keys of one part of a model; `depth` is the number of compositions around it."""

    depth: int
    keys: tuple[KeyValues, ...]

    def named(self, name: str) -> KeyValues | None:
        return next((key for key in self.keys if key.name == name), None)

    def carried(self, copies: Mapping[Node, Node]) -> PartKeys:
        """Return the same numbers for a copy of the model; `copies` has its elements."""

        def holder(old: Any) -> Any:
            if isinstance(old, tuple):  # a copy of an element that MuJoCo multiplies
                return old._replace(element=holder(old.element))  # type: ignore[attr-defined]
            return copies.get(old, old)

        def values(key: KeyValues) -> dict[str, dict[Any, list[Number]]]:
            return {vector: {holder(old): [*kept] for old, kept in rows.items()} for vector, rows in key.values.items()}

        return self._replace(keys=tuple(replace(key, values=values(key)) for key in self.keys))

    @property
    def names(self) -> list[str]:
        return [key.name for key in self.keys if key.name]


def counterpart(node: Node, root: Node, copied: Node) -> Node:
    """Return the node of `copied`, a deep copy of `root`, at the position of `node` below `root`."""
    path = [node, *node.iterancestors()]
    for below, above in reversed(list(pairwise(path[: path.index(root) + 1]))):
        copied = copied[above.index(below)]
    return copied


# The order of MuJoCo's XML reference. MuJoCo ignores it, but readers expect it.
_SECTIONS = (
    "compiler option size visual statistic default extension custom asset worldbody deformable contact tendon"
    " equality actuator sensor keyframe"
).split()
_RANK = {tag: rank for rank, tag in enumerate(_SECTIONS)}


def place_of(root: Node, tag: str) -> int:
    """Return the index of a new section among the children of `root`: after the sections that usually precede it."""
    rank = _RANK.get(tag, len(_RANK))
    before = (child for child in root.iterchildren("*", reversed=True) if _RANK.get(str(child.tag), 0) <= rank)
    last = next(before, None)
    return 0 if last is None else root.index(last) + 1


@dataclass(eq=False)
class Unit:
    """One parsed `<mujoco>` tree, with includes expanded.

    `directory` is the folder of the main file, against which MuJoCo resolves every file of the model. `label` names the
    unit's folder in a bundle. `contents` has, by written path, files that are not found under this path on disk: their
    bytes, or a path that a door has admitted. `door` limits the other files that the model may read. `part_keys` has
    the keys of each part of a composition, by path (`left/gripper`). `header` are the comments in the root that
    preceded it. `adopted` are the settings that the parts of a composition agree on. `table` lists the elements of a
    source that is not MJCF: read or not. Edits change a unit in place and the linker consumes it: call `copied()` first
    to keep it.
    """

    root: Node
    file: str
    directory: Path
    label: str
    contents: Mapping[str, bytes | Path] = field(default_factory=dict)
    origins: Origins = field(default_factory=Origins)
    part_keys: Mapping[str, PartKeys] = field(default_factory=dict)
    header: tuple[Node, ...] = ()
    adopted: tuple[Adopted, ...] = ()
    door: Door = NOTHING
    table: tuple[ReadRow, ...] = ()

    @cached_property
    def settings(self) -> SourceSettings:
        return read_settings(self.root)

    @cached_property
    def classes(self) -> Classes:
        """The default classes. Their values are live; call `forget_classes` after classes are added or renamed."""
        return Classes(self.root)

    def forget_classes(self) -> None:
        self.__dict__.pop("classes", None)

    def forget_settings(self, *names: str) -> None:
        """Remove compiler settings from the unit in favor of MuJoCo's defaults, and read the others again."""
        for compiler in self.root.iterchildren("compiler"):
            for name in names:
                journal.drop(compiler, name)
        self.__dict__.pop("settings", None)

    def setting_place(self, name: str) -> Callable[[], Span] | None:
        """Return a function that returns where a compiler setting is written now, or None if it is not written."""
        holders = (each for each in self.root.iterchildren("compiler", reversed=True) if name in each.attrib)
        last = next(holders, None)
        return None if last is None else self.origins.lasting_place(last, self.file, name)

    @property
    def file_name(self) -> str:
        """The name of the file without its folder, in backticks."""
        return f"`{self.file.rpartition('/')[2]}`"

    @property
    def model(self) -> str:
        return str(self.root.get("model") or "")

    def copied(self) -> Unit:
        """Return a deep copy that shares only file contents."""
        root = copy.deepcopy(self.root)
        origins = self.origins.carried(self.root, root)
        header = tuple(root[self.root.index(comment)] for comment in self.header)
        unit = replace(self, root=root, origins=origins, header=header)
        if self.part_keys:
            copies = dict(zip(self.root.iter(), root.iter(), strict=True))
            unit.part_keys = {path: keys.carried(copies) for path, keys in self.part_keys.items()}
        return unit

    def source_of(self, path: str) -> bytes | Path:
        """Return the bytes of a file by its written path, or its path on disk."""
        return self.contents.get(path, Path(join(str(self.directory), path)))

    def section(self, tag: str) -> Node:
        """Return the last section of that tag, where new elements go; create it if there is none."""
        last = next(self.root.iterchildren(tag, reversed=True), None)
        if last is None:
            last = self.root.makeelement(tag)
            self.insert(last)
        return last

    def insert(self, section: Node) -> None:
        """Insert a new section in its conventional place, below the header."""
        at = self.root.index(self.header[-1]) + 1 if self.header else 0
        journal.place(self.root, section, max(at, place_of(self.root, str(section.tag))))


class Watch(Protocol):
    """An observer that is called after everything that may have changed a model. It changes nothing itself."""

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        """Observe that `done` has changed some of the trees in `units`.

        `done` is a source that was read, a plan that is started, a `Linking` whose parts now belong together, a
        pass of the linker, a step of the plan, or another function that has run.
        """


def nobody(units: Iterable[Unit], done: object) -> None:
    """Do nothing: the `Watch` of a build."""
