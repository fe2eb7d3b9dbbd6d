"""A recipe in its canonical layout, with its comments."""

from __future__ import annotations

import re

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.text.key_order import Collection, Document, Leaf, Path, TextEntry, is_free, put_in_order
from mjcompose.text.load import Comment, Token, comments, decode, load, tokens
from mjcompose.text.node import LINE_BREAK, Mapping, Node, Scalar, Sequence

_STARTS = {"FlowMappingStart", "FlowSequenceStart"}
_ENDS = {"FlowMappingEnd", "FlowSequenceEnd"}
_PROPERTIES = {"Anchor", "Tag"}


class UnusualYaml(Exception):
    """A form of YAML without a canonical layout; `line` counts from 1."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


class _Reader:
    """Reads the syntax of a text in which `load` found no fault. Raises `UnusualYaml`."""

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
        waiting = self.next.comments
        self.next.comments = []
        return waiting

    def document(self) -> Document:
        self.take()
        preface: list[str] = []
        while self.next.kind in ("Directive", "DocumentStart"):
            preface += [comment.text for comment in self.rest()]
            preface.append(self.take().text)
        root = TextEntry(0)
        self.value(root, in_mapping=False)
        if not isinstance(root.value, Collection):
            raise UnusualYaml("the file contains a single value", 1)
        tail: list[Comment] = []
        while self.next.kind != "StreamEnd":
            tail += self.rest()
            self.take()
        header = root.inner
        parted = False
        entries = root.value.entries
        if entries and not root.value.flow:
            header, parted = _header(entries[0])
        return Document(preface, header, parted, head=root.head, root=root.value, tail=[*tail, *self.rest()])

    def value(self, entry: TextEntry, in_mapping: bool) -> None:
        """Read the value of an entry after its `:` or `-`, and the comments before it."""
        entry.head = self.beside()
        properties = []
        pins = self.pins
        while self.next.kind in _PROPERTIES:
            entry.inner += self.rest()
            properties.append(self.anchor_or_tag())
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
            entry.value = self.block(mapping=False, indented=False)
        elif kind in _STARTS or kind in ("Scalar", "Alias"):
            entry.inner += self.rest()
            entry.value = self.flow() if kind in _STARTS else self.leaf()
        elif shown:
            entry.value = Leaf("")
        if entry.value is not None:
            entry.value.properties = shown
        entry.pinned |= self.pins > pins

    def anchor_or_tag(self) -> str:
        self.pins += self.next.kind == "Anchor"
        return self.take().text

    def leaf(self) -> Leaf:
        self.pins += self.next.kind == "Alias"
        token = self.take()
        return Leaf(token.text, depth=token.depth, ended=token.ended)

    def key(self, entry: TextEntry) -> None:
        pins = self.pins
        self.take()
        properties = []
        while self.next.kind in _PROPERTIES:
            entry.lead += self.rest()
            properties.append(self.anchor_or_tag())
        if self.next.kind not in ("Scalar", "Alias") or self.next.line != self.next.end_line:
            raise UnusualYaml("a key here is not a name on one line", self.next.line + 1)
        entry.lead += self.rest()
        entry.key = self.leaf()
        entry.key.properties = " ".join(properties)
        entry.pinned = self.pins > pins

    def entry(self, result: Collection) -> TextEntry:
        token = self.next
        entry = TextEntry(token.column, lead=self.rest(), blank=token.blank)
        result.entries.append(entry)
        return entry

    def block(self, mapping: bool, indented: bool = True) -> Collection:
        """Read a block. A list that is not `indented` is in the column of its key, without tokens of its own."""
        column = self.next.column + (not indented)
        if indented:
            self.take()
        result = Collection(mapping, flow=False)
        while self.next.kind != "BlockEnd" and (indented or self.next.kind == "BlockEntry"):
            entry = self.entry(result)
            if mapping:
                self.pair(entry, in_mapping=True)
            else:
                self.take()
                self.value(entry, in_mapping=False)
            entry.trail = self.beside()
        result.tail = self.tail(column)
        if indented:
            self.take()
        return result

    def pair(self, entry: TextEntry, in_mapping: bool) -> None:
        if self.next.kind != "Key":
            raise UnusualYaml("a value has no key", self.next.line + 1)
        self.key(entry)
        if self.next.kind == "Value":
            entry.lead += self.rest()
            self.take()
            self.value(entry, in_mapping=in_mapping)

    def tail(self, column: int) -> list[Comment]:
        """Return the comments before the next token that are indented like the collection that ends here."""
        index = self.at
        while not self.tokens[index].text and self.tokens[index].kind != "StreamEnd":
            index += 1
        following = self.tokens[index]
        deep = following.column if following.kind not in ("StreamEnd", "DocumentEnd") else -1
        waiting = self.next.comments
        count = 0
        while count < len(waiting) and waiting[count].column >= column and waiting[count].column > deep:
            count += 1
        self.next.comments = waiting[count:]
        return waiting[:count]

    def flow(self) -> Collection:
        begin = self.take()
        result = Collection(begin.kind == "FlowMappingStart", flow=True)
        result.opening = self.beside()
        line = begin.line
        waiting: list[Comment] = []
        while self.next.kind not in _ENDS:
            token = self.next
            comments = self.rest()
            self.hand_over(comments, result)
            entry = TextEntry(token.column, lead=[*waiting, *comments], blank=token.blank, breaks=token.line != line)
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
        if comments and not comments[0].own_line and result.entries and result.entries[-1].trail is None:
            result.entries[-1].trail = comments.pop(0)

    def member(self, entry: TextEntry, mapping: bool) -> None:
        if self.next.kind == "Key" and not mapping:  # `[a: 1]` is a list of mappings with one key each
            pair = TextEntry(self.next.column)
            self.member(pair, mapping=True)
            entry.lead += pair.lead
            entry.value = Collection(mapping=True, flow=True, entries=[pair])
            entry.pinned = pair.pinned
        elif self.next.kind in ("Key", "Value"):
            self.pair(entry, in_mapping=False)
        elif mapping:
            entry.key = self.leaf()
        else:
            self.value(entry, in_mapping=False)
        entry.lead += [each for each in (entry.head, *entry.inner) if each is not None]
        entry.head = None
        entry.inner = []


def _header(first: TextEntry) -> tuple[list[Comment], bool]:
    """Return the comments before the first key that are about the file, and whether a blank line follows them."""
    lead = first.lead
    if first.blank or not lead:
        split = len(lead)
    else:
        split = max((index for index, each in enumerate(lead) if each.blank_before and index), default=len(lead))
    header = lead[:split]
    first.lead = lead[split:]
    parted = bool(header) and first.parted
    first.parted = False
    return header, parted


INDENT = 2

_HEADER = re.compile(r"([|>])([-+0-9]*)(.*)", re.DOTALL)


def lines_of(leaf: Leaf, indent: int) -> list[str]:
    r"""Return the lines of a value whose collection is at column `indent`; all except the first include their margin.

    Double quotes are used, and single quotes if they save escapes; unquoted text stays unquoted.

    >>> lines_of(Leaf("'a b'"), 0), lines_of(Leaf("'a\\b'"), 0), lines_of(Leaf("|\n     a\n      b", depth=5), 2)
    (['"a b"'], ["'a\\b'"], ['|', '    a', '     b'])
    """
    lines = LINE_BREAK.split(leaf.text)
    if leaf.text[:1] in ("|", ">"):
        return _block(leaf, lines, indent)
    if len(lines) == 1:
        return [_quoted(leaf.text)]
    margin = " " * (indent + INDENT)
    inner = [f"{margin}{_cut(line.lstrip(' '))}" if line.strip(" ") else "" for line in lines[1:-1]]
    return [_cut(lines[0]), *inner, margin + lines[-1].lstrip(" ")]


def _cut(line: str) -> str:
    """Strip spaces at the end of a line of folded text, which have no meaning unless the first one is escaped."""
    bare = line.rstrip(" ")
    return f"{bare} " if bare.endswith("\\") and bare != line else bare


def _quoted(text: str) -> str:
    if text[:1] != "'":
        return text
    content = text[1:-1].replace("''", "'")
    return text if '"' in content or "\\" in content else f'"{content}"'


def _block(leaf: Leaf, lines: list[str], indent: int) -> list[str]:
    found = _HEADER.fullmatch(lines[0])
    assert found is not None
    style, marks, rest = found.groups()
    # A last line without a line break has none in the value either, while the written file ends with one.
    chomping = "-" if not leaf.ended else "".join(set(marks) & set("-+"))
    depth = str(INDENT) if set(marks) - set("-+") else ""
    comment = f"  {rest.strip()}" if rest.strip() else ""
    content = [line[leaf.depth :] for line in lines[1:]]
    if chomping == "+" and content and not content[-1]:
        content.pop()  # the empty text after the last line break
    margin = " " * (indent + INDENT)
    return [f"{style}{depth}{chomping}{comment}", *(margin + line if line else "" for line in content)]


_GAP = 2  # minimum spaces before a comment on the same line


def write(document: Document) -> list[str]:
    writer = _Writer()
    writer.lines += document.preface
    writer.comments(document.header, 0)
    if document.parted:
        writer.lines.append("")
    if document.head is not None:
        writer.lines.append(document.head.text)
    root = document.root
    if root.properties:
        writer.lines.append(root.properties)
    if root.flow:
        writer.lines.append("")
        writer.brackets(root, 0)
    else:
        writer.block(root, 0)
    writer.comments(document.tail, 0)
    return writer.lines


class _Writer:
    def __init__(self) -> None:
        self.lines: list[str] = []
        self.kept = 0
        """How many lines there were behind the last block scalar to which empty lines below it would belong."""

    def comments(self, comments: list[Comment], indent: int) -> None:
        """Write comments on their own lines. Their indentation relative to the first comment is kept."""
        margin = next((comment.column for comment in comments if comment.own_line), 0)
        for comment in comments:
            self.blank(comment.blank_before)
            deeper = max(comment.column - margin, 0) if comment.own_line else 0
            self.lines.append(" " * (indent + deeper) + comment.text)

    def blank(self, wanted: bool) -> None:
        if wanted and self.lines and self.lines[-1] and len(self.lines) != self.kept:
            self.lines.append("")

    def beside(self, comment: Comment | None, shift: int) -> None:
        """Write a comment on the current line, in its original column if there is room."""
        if comment is not None:
            line = self.lines[-1]
            self.lines[-1] = line.ljust(max(len(line) + _GAP, comment.column + shift)) + comment.text

    def block(self, node: Collection, indent: int) -> None:
        for entry in node.entries:
            self.comments(entry.lead, indent)
            self.blank(entry.blank)
            self.entry(entry, indent)
        self.comments(node.tail, indent)

    def entry(self, entry: TextEntry, indent: int) -> None:
        shift = indent - entry.column
        value = entry.value
        start = " " * indent + ("-" if entry.key is None else f"{_key(entry.key)}:")
        if value is not None and value.properties:
            start += f" {value.properties}"
        self.lines.append(start)
        self.beside(entry.head, shift)
        self.comments(entry.inner, indent + INDENT)
        if isinstance(value, Collection) and not value.flow:
            self.nested(entry, value, indent)
        elif value is not None and value != Leaf("", value.properties):
            below = entry.head is not None or bool(entry.inner)
            if below:
                self.lines.append(" " * (indent + INDENT))
            else:
                self.lines[-1] += " "
            self.value(value, indent, INDENT if below else 0)
        self.beside(entry.trail, shift)

    def nested(self, entry: TextEntry, value: Collection, indent: int) -> None:
        """Write a block below its key, or in a list next to its dash."""
        if entry.key is not None or value.properties or entry.head or entry.inner or value.entries[0].lead:
            self.block(value, indent + INDENT)
            return
        value.entries[0].blank = False
        dash = self.lines.pop()
        first = len(self.lines)
        self.block(value, indent + INDENT)
        self.lines[first] = f"{dash} {self.lines[first][indent + INDENT :]}"

    def value(self, value: Leaf | Collection, indent: int, deeper: int) -> None:
        if isinstance(value, Collection):
            self.brackets(value, indent + deeper)
            return
        first, *others = lines_of(value, indent)
        self.lines[-1] += first
        self.lines += others
        if first.startswith(("|", ">")) and "+" in first[:3]:
            self.kept = len(self.lines)

    def brackets(self, node: Collection, indent: int) -> None:
        """Write a collection in brackets on the current line; line breaks stay where they were."""
        line = _inline(node)
        if line is not None:
            self.lines[-1] += line
            return
        self.lines[-1] += "{" if node.mapping else "["
        self.beside(node.opening, 0)
        inner = " " * (indent + INDENT)
        fresh = True  # whether the next entry begins a line
        for entry in node.entries:
            if fresh or entry.lead or entry.breaks:
                self.comments(entry.lead, indent + INDENT)
                self.blank(entry.blank)
                self.lines.append(inner)
            else:
                self.lines[-1] += " "
            self.member(entry, indent + INDENT)
            fresh = entry.trail is not None
            last = entry is node.entries[-1]
            if last and not fresh and not node.tail:
                self.lines[-1] += "}" if node.mapping else "]"
                return
            self.lines[-1] += "" if last else ","
            self.beside(entry.trail, 0)
        self.comments(node.tail, indent + INDENT)
        self.lines.append(inner + ("}" if node.mapping else "]"))

    def member(self, entry: TextEntry, indent: int) -> None:
        text = _inline_entry(entry)
        if text is not None or entry.value is None:
            self.lines[-1] += text or ""
            return
        self.lines[-1] += _start(entry)
        self.value(entry.value, indent, 0)


def _key(key: Leaf) -> str:
    text = lines_of(key, 0)[0]
    if text.startswith("*"):
        text += " "  # the colon is not a part of an alias
    return f"{key.properties} {text}" if key.properties else text


def _start(entry: TextEntry) -> str:
    key = "" if entry.key is None else _key(entry.key) + ": "
    properties = f"{entry.value.properties} " if entry.value is not None and entry.value.properties else ""
    return key + properties


def _inline(node: Collection) -> str | None:
    if node.broken:
        return None
    texts = [text for entry in node.entries if (text := _inline_entry(entry)) is not None]
    if len(texts) < len(node.entries):
        return None
    inside = ", ".join(texts)
    return f"{{{inside}}}" if node.mapping else f"[{inside}]"


def _inline_entry(entry: TextEntry) -> str | None:
    value = entry.value
    if value is None:
        return _start(entry)  # the space separates the colon from the following text
    lines = [_inline(value)] if isinstance(value, Collection) else lines_of(value, 0)
    return None if len(lines) > 1 or lines[0] is None else (_start(entry) + lines[0]).rstrip(" ")


def difference(one: Node, other: Node) -> str | None:
    """Return the path of the first value that differs between two trees, or None. The order of keys may count."""
    waiting: list[tuple[Node, Node, Path, str]] = [(one, other, (), "")]
    while waiting:
        a, b, path, shown = waiting.pop()
        if isinstance(a, Scalar) and isinstance(b, Scalar):
            same = (a.text, a.plain, repr(a.value)) == (b.text, b.plain, repr(b.value))
        elif isinstance(a, Sequence) and isinstance(b, Sequence):
            same = len(a.items) == len(b.items)
            pairs = enumerate(zip(a.items, b.items, strict=False))
            waiting += [(x, y, (*path, "*"), f"{shown}[{index}]") for index, (x, y) in pairs]
        elif isinstance(a, Mapping) and isinstance(b, Mapping):
            same = a.entries.keys() == b.entries.keys() and (is_free(path) or list(a.entries) == list(b.entries))
            if same:
                for name, (_, value) in a.entries.items():
                    waiting.append((value, b.entries[name][1], (*path, name), f"{shown}.{name}".lstrip(".")))
        else:
            same = False
        if not same:
            return shown
    return None


def format_recipe(source: bytes, file: str, sink: Sink) -> bytes | None:
    """Return the text in its canonical layout, or None if it is not YAML or its meaning would change.

    Comments, blank lines between entries, anchors, the choice between lines and brackets, a byte order mark and the
    line breaks (as in the first line) are kept. The result is parsed again and compared: values, the order of
    keys if it has a meaning, comments. No I/O.
    """
    before = sink.error_count
    node = load(source, file, sink)
    if node is None or sink.error_count > before:
        return None
    text = decode(source, file, sink)
    assert text is not None
    try:
        document = _Reader(tokens(text)).document()
    except UnusualYaml as unusual:
        message = f"`{file}` is left unchanged: {unusual}"
        place = Span(file, unusual.line, 1)
        sink.error("cannot-format", message, place, help="write it in the usual form")
        return None
    put_in_order(document.root)
    first = re.search(r"\r\n|\n", text)
    end = first.group() if first else "\n"
    result = end.join([*write(document), ""])
    changed = _changed(node, text, result, file=file)
    if changed is not None:
        message = f"`{file}` is left unchanged: the canonical layout would change its meaning"
        help = "please report it: this is a bug of `mjcompose fmt`, not of the recipe"
        sink.error("cannot-format", message, Span(file, 1, 1), notes=(Note(changed),), help=help)
        return None
    mark = "\ufeff" if source.startswith(b"\xef\xbb\xbf") else ""
    return (mark + result).encode("utf-8")


def _changed(node: Node, text: str, result: str, file: str) -> str | None:
    again = load(result, file, Sink())
    if again is None:
        return "it could not be read again"
    place = difference(node, again)
    if place is not None:
        return f"`{place}` would be another value" if place else "it would be another value"
    if sorted(comments(tokens(text))) != sorted(comments(tokens(result))):
        return "a comment would be lost"
    return None
