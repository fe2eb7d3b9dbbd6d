"""Parse tokens to syntax, and decide which entry each comment belongs to."""

from __future__ import annotations

from composer.document.tokens import Comment, Token, tokens
from composer.formatting.syntax import Collection, Document, Entry, Leaf

_STARTS = {"FlowMappingStart", "FlowSequenceStart"}
_ENDS = {"FlowMappingEnd", "FlowSequenceEnd"}
_PROPERTIES = {"Anchor", "Tag"}


class Unusual(Exception):
    """A form of YAML without a canonical layout; `line` counts from 1."""

    def __init__(self, what: str, line: int) -> None:
        super().__init__(what)
        self.line = line


def read(text: str) -> Document:
    """Return the syntax of a text in which `load` found no fault. Raises `Unusual`. No I/O."""
    return _Reader(tokens(text)).document()


class _Reader:
    def __init__(self, found: list[Token]) -> None:
        self.tokens = found
        self.at = 0
        self.pins = 0

    @property
    def next(self) -> Token:
        return self.tokens[self.at]

    def take(self) -> Token:
        """Return the next token; comments before a token without width move to the following token."""
        token = self.next
        self.at += 1
        if not token.text and self.at < len(self.tokens):
            self.next.comments = token.comments + self.next.comments
            self.next.blank |= token.blank
            token.comments = []
        return token

    def beside(self) -> Comment | None:
        """Return the comment on the line of the last token."""
        waiting = self.next.comments
        return waiting.pop(0) if waiting and not waiting[0].own_line else None

    def rest(self) -> list[Comment]:
        """Return all comments before the next token."""
        waiting, self.next.comments = self.next.comments, []
        return waiting

    def document(self) -> Document:
        self.take()
        preface: list[str] = []
        while self.next.kind in ("Directive", "DocumentStart"):
            preface += [comment.text for comment in self.rest()]
            preface.append(self.take().text)
        root = Entry(0)
        self.value(root, in_mapping=False)
        if not isinstance(root.value, Collection):
            raise Unusual("the file holds a single value", 1)
        tail: list[Comment] = []
        while self.next.kind != "StreamEnd":
            tail += self.rest()
            self.take()
        header: list[Comment] = root.inner
        parted = False
        entries = root.value.entries
        if entries and not root.value.flow:
            header, parted = _header(entries[0])
        return Document(preface, header, parted, head=root.head, root=root.value, tail=[*tail, *self.rest()])

    def value(self, entry: Entry, in_mapping: bool) -> None:
        """Read the value of an entry after its `:` or `-`, and the comments before it."""
        entry.head = self.beside()
        properties = []
        pins = self.pins
        while self.next.kind in _PROPERTIES:
            entry.inner += self.rest()
            self.pins += self.next.kind == "Anchor"
            properties.append(self.take().text)
            beside = self.beside()
            if entry.head is None:
                entry.head = beside
            elif beside is not None:
                entry.inner.append(beside)
        kind = self.next.kind
        shown = " ".join(properties)
        if kind in ("BlockMappingStart", "BlockSequenceStart"):
            entry.value = self.block(kind == "BlockMappingStart")
        elif kind == "BlockEntry" and in_mapping:
            entry.value = self.unindented()
        elif kind in _STARTS or kind in ("Scalar", "Alias"):
            entry.inner += self.rest()
            entry.value = self.flow() if kind in _STARTS else self.leaf()
        elif shown:
            entry.value = Leaf("")
        if entry.value is not None:
            entry.value.properties = shown
        entry.pinned |= self.pins > pins

    def leaf(self) -> Leaf:
        self.pins += self.next.kind == "Alias"
        token = self.take()
        return Leaf(token.text, depth=token.depth, ended=token.ended)

    def key(self, entry: Entry) -> None:
        """Read a key, up to and with its `:`."""
        pins = self.pins
        self.take()
        properties = []
        while self.next.kind in _PROPERTIES:
            entry.lead += self.rest()
            self.pins += self.next.kind == "Anchor"
            properties.append(self.take().text)
        if self.next.kind not in ("Scalar", "Alias") or self.next.line != self.next.end_line:
            raise Unusual("a key here is not a name on one line", self.next.line + 1)
        entry.lead += self.rest()
        entry.key = self.leaf()
        entry.key.properties = " ".join(properties)
        entry.pinned = self.pins > pins

    def entry(self) -> Entry:
        token = self.next
        return Entry(token.column, lead=self.rest(), blank=token.blank)

    def block(self, mapping: bool) -> Collection:
        column = self.next.column
        self.take()
        result = Collection(mapping, flow=False)
        while self.next.kind != "BlockEnd":
            entry = self.entry()
            result.entries.append(entry)
            if not mapping:
                self.item(entry)
                continue
            if self.next.kind != "Key":
                raise Unusual("a value stands without its key", self.next.line + 1)
            self.key(entry)
            if self.next.kind == "Value":
                entry.lead += self.rest()
                self.take()
                self.value(entry, in_mapping=True)
            entry.trail = self.beside()
        result.tail = self.tail(column)
        self.take()
        return result

    def unindented(self) -> Collection:
        """Read a list whose dashes are below the first letter of its key."""
        column = self.next.column
        result = Collection(mapping=False, flow=False)
        while self.next.kind == "BlockEntry":
            entry = self.entry()
            result.entries.append(entry)
            self.item(entry)
        result.tail = self.tail(column + 1)
        return result

    def item(self, entry: Entry) -> None:
        self.take()
        self.value(entry, in_mapping=False)
        entry.trail = self.beside()

    def tail(self, column: int) -> list[Comment]:
        """Return the comments before the next token that are indented like the collection that ends here."""
        following = next(token for token in self.tokens[self.at :] if token.text or token.kind == "StreamEnd")
        deep = following.column if following.kind not in ("StreamEnd", "DocumentEnd") else -1
        waiting = self.next.comments
        count = 0
        while count < len(waiting) and waiting[count].column >= column and waiting[count].column > deep:
            count += 1
        self.next.comments = waiting[count:]
        return waiting[:count]

    def flow(self) -> Collection:
        """Read a collection in brackets."""
        begin = self.take()
        result = Collection(begin.kind == "FlowMappingStart", flow=True)
        result.opening = self.beside()
        line = begin.line
        waiting: list[Comment] = []
        while self.next.kind not in _ENDS:
            token = self.next
            entry = self.entry()
            self.hand_over(entry.lead, result)
            entry.lead = [*waiting, *entry.lead]
            entry.breaks = token.line != line
            result.entries.append(entry)
            self.member(entry, result.mapping)
            line = self.tokens[self.at - 1].end_line
            entry.trail = self.beside()
            waiting = self.rest()
            if self.next.kind == "FlowEntry":
                line = self.take().end_line
        result.tail = [*waiting, *self.rest()]
        self.hand_over(result.tail, result)
        result.broken = self.take().line != begin.line
        return result

    def hand_over(self, comments: list[Comment], result: Collection) -> None:
        """Move a comment after the comma to the entry before it."""
        if comments and not comments[0].own_line and result.entries and result.entries[-1].trail is None:
            result.entries[-1].trail = comments.pop(0)

    def member(self, entry: Entry, mapping: bool) -> None:
        """Read one entry of a collection in brackets, up to its comma."""
        if self.next.kind == "Value":
            raise Unusual("a value stands without its key", self.next.line + 1)
        if self.next.kind == "Key" and not mapping:  # `[a: 1]` is a list of mappings with one key each
            pair = Entry(self.next.column)
            self.member(pair, mapping=True)
            entry.lead += pair.lead
            entry.value = Collection(mapping=True, flow=True, entries=[pair])
            entry.pinned = pair.pinned
        elif self.next.kind == "Key":
            self.key(entry)
            if self.next.kind == "Value":
                entry.lead += self.rest()
                self.take()
                self.value(entry, in_mapping=False)
        elif mapping:
            entry.key = self.leaf()
        else:
            self.value(entry, in_mapping=False)
        entry.lead += [each for each in (entry.head, *entry.inner) if each is not None]
        entry.head, entry.inner = None, []


def _header(first: Entry) -> tuple[list[Comment], bool]:
    """Return the comments before the first key that are about the file, and whether a blank line follows them."""
    lead = first.lead
    if first.blank or not lead:
        split = len(lead)
    else:
        split = max(
            (index for index, each in enumerate(lead) if each.blank_before and index), default=len(lead)
        )
    header, first.lead = lead[:split], lead[split:]
    parted = bool(header) and first.parted
    first.parted = False
    return header, parted
