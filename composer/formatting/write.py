"""Write syntax as text."""

from __future__ import annotations

from composer.document.tokens import Comment
from composer.formatting.scalar import INDENT, lines_of
from composer.formatting.syntax import Collection, Document, Entry, Leaf

_GAP = 2  # minimum spaces before a comment on the same line


def write(document: Document) -> list[str]:
    """Return the lines of a document."""
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
        """Write comments on their own lines; deeper indentation than that of the first one is kept."""
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

    def entry(self, entry: Entry, indent: int) -> None:
        """Write an entry on its own line, without the comments before it."""
        shift = indent - entry.column
        value = entry.value
        start = " " * indent + ("-" if entry.key is None else f"{_key(entry.key)}:")
        if value is not None and value.properties:
            start += f" {value.properties}"
        self.lines.append(start)
        if isinstance(value, Collection) and not value.flow:
            self.beside(entry.head, shift)
            self.comments(entry.inner, indent + INDENT)
            self.nested(entry, value, indent)
        elif value is not None and (value != Leaf("", value.properties)):
            below = entry.head is not None or bool(entry.inner)
            self.beside(entry.head, shift)
            self.comments(entry.inner, indent + INDENT)
            if below:
                self.lines.append(" " * (indent + INDENT))
            else:
                self.lines[-1] += " "
            self.value(value, indent, INDENT if below else 0)
        else:
            self.beside(entry.head, shift)
            self.comments(entry.inner, indent + INDENT)
        self.beside(entry.trail, shift)

    def nested(self, entry: Entry, value: Collection, indent: int) -> None:
        """Write a block below its key; in a list, beside its dash."""
        compact = (
            entry.key is None
            and not (value.properties or entry.head or entry.inner)
            and not value.entries[0].lead
        )
        if not compact:
            self.block(value, indent + INDENT)
            return
        value.entries[0].blank = False
        dash = self.lines.pop()
        first = len(self.lines)
        self.block(value, indent + INDENT)
        self.lines[first] = f"{dash} {self.lines[first][indent + INDENT :]}"

    def value(self, value: Leaf | Collection, indent: int, deeper: int) -> None:
        """Write a value in brackets, or a single one, on the current line."""
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

    def member(self, entry: Entry, indent: int) -> None:
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


def _start(entry: Entry) -> str:
    """Return the text before the value of an entry in brackets."""
    key = "" if entry.key is None else _key(entry.key) + ": "
    properties = f"{entry.value.properties} " if entry.value is not None and entry.value.properties else ""
    return key + properties


def _inline(node: Collection) -> str | None:
    """Return a collection in brackets on one line, or None if it spans several."""
    if node.broken:
        return None
    texts = [_inline_entry(entry) for entry in node.entries]
    if None in texts:
        return None
    inside = ", ".join(text for text in texts if text is not None)
    return f"{{{inside}}}" if node.mapping else f"[{inside}]"


def _inline_entry(entry: Entry) -> str | None:
    value = entry.value
    text: str | None = ""
    if isinstance(value, Collection):
        text = _inline(value)
    elif value is not None:
        first, *others = lines_of(value, 0)
        text = None if others else first
    if text is None:
        return None
    if value is None:
        return _start(entry)  # the space separates the colon from the following text
    return (_start(entry) + text).rstrip(" ")
