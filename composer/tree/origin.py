"""The origin of an element: a place in a source file, or one in a recipe."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import field

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.reading.regular import TooLarge
from composer.tree.file_text import FileText
from composer.tree.key_number import KeyRecord
from composer.tree.line import line_of
from composer.tree.start_tag import SourceText

Place = Callable[[str | None], Span]
"""Returns the place of an element in a recipe, or with an attribute's name the place of its value."""


@dataclass(slots=True)
class Origins:
    """The file of every subtree whose file is not its parent's, and the recipe place of what a recipe wrote.

    Line numbers need no storage: lxml keeps the line of each element, and they survive moves and copies. `owners`
    holds the elements themselves, so that their identity is stable. `texts` has the files that the model was read from,
    by name in messages, also those without text, such as meshes. `settings` has the attributes that a program or
    the linker has set, each with its place or a function that returns it. `renamed` has each old and new name of an
    edit. `keys` has the layout of keys that differ from their file. `unread` is what MuJoCo ignores in the files
    themselves, by file, line and attribute (None: the element). `size` is the bytes of all files.
    """

    owners: dict[Node, str | Span | Place] = field(default_factory=dict)
    texts: dict[str, FileText] = field(default_factory=dict)
    settings: dict[Node, dict[str, Span | Callable[[], Span]]] = field(default_factory=dict)
    renamed: dict[Node, list[tuple[str, str]]] = field(default_factory=dict)
    keys: dict[Node, KeyRecord] = field(default_factory=dict)
    unread: set[tuple[str, int | None, str | None]] = field(default_factory=set)
    size: int = 0

    def own(self, element: Node, owner: str | Span | Place) -> None:
        self.owners[element] = owner

    def own_all(self, elements: Iterable[Node], owner: str | Span | Place) -> None:
        """Set the owner of all elements that do not have one yet."""
        for element in elements:
            self.owners.setdefault(element, owner)

    def owner(self, element: Node, default_file: str) -> str | Span | Place:
        """Return the place in a recipe that wrote the element, or the file that contains it."""
        node: Node | None = element
        while node is not None:
            owner = self.owners.get(node)
            if owner is not None:
                return owner
            node = node.getparent()
        return default_file

    def span(
        self, element: Node, default_file: str, attribute: str | None = None, *, key: bool = False
    ) -> Span:
        """Return the place to show for `element`: its start tag.

        With `attribute` it is the value of that attribute, or with `key` its name, if it is written there.
        """
        if attribute is not None and (found := self.set_at(element, attribute)) is not None:
            return found
        return self.span_by(self.owner(element, default_file), element, attribute, key=key)

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
        return self.in_file(
            owner, line_of(element), str(element.tag), written=written, attribute=attribute, key=key
        )

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
        if line is None:
            return Span(file, 1, 1)
        text = self.text(file)
        found = None
        if text is not None:
            if attribute is not None:
                found = text.attribute(tag, line, written, name=attribute, key=key)
            found = found or text.element(tag, line, written)
        if found is None:
            return Span(file, line, 1)
        return Span(file, found.line, found.column, end_line=found.line, end_column=found.end_column)

    def adopt(self, other: Origins) -> None:
        """Add the data of elements that have moved here from another tree."""
        self.owners.update(other.owners)
        self.texts.update(other.texts)
        self.settings.update(other.settings)
        self.renamed.update(other.renamed)
        self.keys.update(other.keys)
        self.unread |= other.unread

    def carried(self, old: Node, new: Node) -> Origins:
        """Return the same data for `new`, a deep copy of `old`."""
        if not (self.owners or self.settings or self.renamed or self.keys):
            return Origins(texts=dict(self.texts), unread=set(self.unread), size=self.size)
        found = Origins(texts=dict(self.texts), unread=set(self.unread), size=self.size)
        for node, copy in zip(old.iter(), new.iter(), strict=True):
            if node in self.owners:
                found.owners[copy] = self.owners[node]
            if node in self.settings:
                found.settings[copy] = dict(self.settings[node])
            if node in self.renamed:
                found.renamed[copy] = list(self.renamed[node])
            if node in self.keys:
                found.keys[copy] = self.keys[node]
        return found

    def count(self, more: int, most: int) -> None:
        """Count the bytes of a file. Raises TooLarge if all files of the model have more than `most` together."""
        self.size += more
        if self.size > most:
            raise TooLarge(self.size, most, "the files of this model are together")

    def text(self, file: str) -> SourceText | None:
        """Return the text of a file, read on first use, or None if the model was not read from it."""
        known = self.texts.get(file)
        return None if known is None else known.split()
