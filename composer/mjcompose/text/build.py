"""Build the located tree from YAML events, without recursion and within limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Span
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.text.faults import MAX_KEY, for_lone_key, quoted
from mjcompose.text.node import Key, Mapping, Marks, Node, Scalar, Sequence, is_template, resolve

FREE_EXPANSION = 10_000  # nodes that aliases may add, in addition to one for each character of the text

_STANDARD = "tag:yaml.org,2002:"
_SCALAR_TAGS: dict[str, tuple[type, ...]] = {
    _STANDARD + "null": (type(None),),
    _STANDARD + "bool": (bool,),
    _STANDARD + "int": (int,),
    _STANDARD + "float": (int, float),
}
# Replaces a key whose value is read only to report its faults, and then dropped.
_DROPPED = Key("", Span("", 0, 0))


class _Frame(Struct, frozen=False):
    """A collection that is being read. Lines and columns count from 1."""

    entries: dict[str, tuple[Key, Node]] | None
    items: list[Node] | None
    flow: bool
    line: int
    column: int
    total: int  # the number of nodes in the tree when it began
    first_end: int  # where the last token on its first line ends
    anchor: str | None = None
    tag: tuple[str, Span] | None = None
    is_key: bool = False
    key: Key | None = None
    key_end: int | None = None  # the end of that key in the text, if it is written there
    is_quoted: bool = False  # whether the key is quoted
    has_lone: bool = False  # whether it contains an entry without a colon; the following ones may not be keys then
    height: int = 1  # the nesting depth of collections, including this one


class _Anchored(Struct):
    node: Node
    size: int
    height: int


# Not `yaml.compose`: the loader of PyYAML 6.0 that uses libyaml is recursive, and a million nested brackets end Python.
class Builder:
    """Builds one tree. `text` is the text that the events' marks refer to; faults go to `sink`.

    `restore` turns a scalar's text into the original text of the file; it may raise `UnicodeDecodeError`. `empty`
    is the help for an empty file.
    """

    def __init__(
        self, text: str, file: str, sink: Sink, restore: Callable[[str], str] | None = None, empty: str | None = None
    ) -> None:
        self._text = text
        self._file = file
        self._marks = Marks(text, file)
        self._sink = sink
        self._restore = restore
        self._empty = empty
        self._stack: list[_Frame] = []
        self._anchors: dict[str, _Anchored] = {}
        self._total = 0
        self._expanded = 0
        self._root: Node | None = None
        self._lone: list[Diagnostic] = []
        self._most = in_force().yaml_values
        self._deepest = in_force().yaml_depth

    @property
    def in_flow(self) -> bool:
        return bool(self._stack) and self._stack[-1].flow

    def build(self, events: Iterable[Any]) -> Node | None:
        """Return the tree, or None if a value is missing or a limit is exceeded. Raises the reader's exceptions."""
        most = self._most
        for event in events:
            kind = type(event)
            if kind is ScalarEvent:
                self._scalar(event)
            elif kind is DocumentStartEvent and self._root is not None:
                self._refuse_document(event)
                return self._root
            elif not self._structure(event, kind):
                return None
            if self._total > most:
                message = f"more than {most} values in one file"
                self._sink.error("yaml-too-large", message, self._marks.span(event), help=advice("yaml-values"))
                return None
        for lone in self._lone:  # if reading stops, this is the reason
            self._sink.add(lone)
        root = self._root
        if root is None or (isinstance(root, Scalar) and root.plain and not root.text):
            self._refuse_empty()
            return None
        return root

    def _scalar(self, event: Any) -> None:
        """Add a scalar, which is a key or a value."""
        start = event.start_mark
        end = event.end_mark
        line = start.line + 1
        # Nearly every event is a scalar on one line without properties: this path is kept short.
        is_simple = end.line + 1 == line and event.anchor is None and event.tag is None
        if is_simple:
            span = Span(self._file, line, start.column + 1, end_line=line, end_column=end.column + 1)
        else:
            span = self._marks.span(event)
        text = event.value if self._restore is None else self._restored(event.value, span)
        if is_template(text):
            span = replace(span, template=text)
        stack = self._stack
        frame = stack[-1] if stack else None
        if frame is not None and frame.entries is not None:
            if frame.key is None:
                self._key(event, text, span, frame=frame)
                return
            if not text and frame.flow:
                self._check_colon(event, frame)
        self._total += 1
        if not is_simple:
            self._add(self._scalar_with_properties(event, text, span), 0)
        elif event.style:
            self._add(Scalar(text, span, text, plain=False), 0)
        else:
            self._add(Scalar(self._resolved(text, span), span, text, plain=True), 0)

    def _structure(self, event: Any, kind: type) -> bool:
        """Begin or end a collection, or add an alias. Return False if a limit is exceeded."""
        if kind is MappingStartEvent or kind is SequenceStartEvent:
            return self._begin(event, kind is MappingStartEvent)
        if kind is MappingEndEvent or kind is SequenceEndEvent:
            self._end(event)
        elif kind is AliasEvent:
            return self._alias(event)
        return True

    def _refuse_document(self, event: Any) -> None:
        message = "a second YAML document begins here; a file holds one"
        help = "move the text after `---` into a file of its own, or remove the `---`"
        self._sink.error("yaml-documents", message, self._marks.span(event), help=help)

    def _refuse_empty(self) -> None:
        content = "only comments" if self._text.lstrip().startswith("#") else "nothing"
        self._sink.error("yaml-empty", f"`{self._file}` contains {content}", Span(self._file, 1, 1), help=self._empty)

    def _add(self, node: Node, height: int) -> None:
        if not self._stack:
            self._root = node
            return
        frame = self._stack[-1]
        span = node.span
        if span.line == frame.line and span.end_column is not None:
            frame.first_end = span.end_column
        if height >= frame.height:
            frame.height = height + 1
        if frame.items is not None:
            frame.items.append(node)
        elif frame.entries is not None and frame.key is not None:
            if frame.key is not _DROPPED:
                frame.entries[frame.key.name] = (frame.key, node)
            frame.key = None

    def _begin(self, event: Any, mapping: bool) -> bool:
        parent = self._stack[-1] if self._stack else None
        is_key = parent is not None and parent.entries is not None and parent.key is None
        if parent is not None and is_key:
            self._refuse_key(event, "a mapping" if mapping else "a list", parent)
        if len(self._stack) >= self._deepest:
            message = f"more than {self._deepest} lists and mappings within each other"
            self._sink.error("yaml-too-deep", message, self._marks.span(event), help=advice("yaml-depth"))
            return False
        line = event.start_mark.line + 1
        column = event.start_mark.column + 1
        if event.anchor is not None or event.tag is not None:
            column += self._marks.properties(event)
        tag = None if event.tag is None else (event.tag, self._marks.tag(event))
        entries: dict[str, tuple[Key, Node]] | None = {} if mapping else None
        self._stack.append(
            _Frame(
                entries,
                None if mapping else [],
                bool(event.flow_style),
                line=line,
                column=column,
                total=self._total,
                first_end=column + 1,
                anchor=event.anchor,
                tag=tag,
                is_key=is_key,
            )
        )
        self._total += 1
        return True

    def _end(self, event: Any) -> None:
        frame = self._stack.pop()
        end = frame.first_end
        if frame.flow and event.end_mark.line + 1 == frame.line:
            end = event.end_mark.column + 1
        span = Span(self._file, frame.line, frame.column, end_line=frame.line, end_column=max(end, frame.column + 1))
        node: Node
        if frame.entries is not None:
            node = Mapping(frame.entries, span)
            standard = _STANDARD + "map"
        else:
            items = tuple(frame.items or ())
            template = next((item.span.template for item in items if item.span.template is not None), None)
            node = Sequence(items, replace(span, template=template))
            standard = _STANDARD + "seq"
        if frame.tag is not None and frame.tag[0] not in ("!", standard):
            self._refuse_tag(*frame.tag)
        if frame.anchor is not None:
            self._anchors[frame.anchor] = _Anchored(node, self._total - frame.total, frame.height)
        if not frame.is_key:
            self._add(node, frame.height)

    def _restored(self, text: str, span: Span) -> str:
        try:
            return text if self._restore is None else self._restore(text)
        except UnicodeDecodeError:
            help = "write both halves, as in `\\ud83d\\ude00`, or the character itself"
            message = "an escape here is half of a surrogate pair, which is not a character"
            self._sink.error("yaml-syntax", message, span, help=help)
            return text.encode("utf-8", "replace").decode("utf-8")

    def _resolved(self, text: str, span: Span) -> bool | int | float | str | None:
        try:
            return resolve(text)
        except OverflowError:
            shown = text if len(text) <= 40 else f"{text[:40]}…"
            self._sink.error("out-of-range", f"the number `{shown}` is too large", span)
            return text

    def _scalar_with_properties(self, event: Any, text: str, span: Span) -> Scalar:
        value: bool | int | float | str | None = text
        if event.tag is not None:
            value = self._tagged(event, text, span)
        elif not event.style:
            value = self._resolved(text, span)
        node = Scalar(value, span, text, plain=not event.style, block=self._marks.block(event))
        if event.anchor is not None:
            self._anchors[event.anchor] = _Anchored(node, 1, 0)
        return node

    def _key(self, event: Any, name: str, span: Span, frame: _Frame) -> None:
        if span.line == frame.line and span.end_column is not None:
            frame.first_end = span.end_column
        frame.key = _DROPPED
        frame.key_end = None
        if frame.has_lone:
            return
        if type(event) is ScalarEvent:
            if self._restore is None:
                end: Any = event.end_mark
                frame.key_end = end.index
                frame.is_quoted = bool(event.style)
            if event.tag not in (None, "!", _STANDARD + "str"):
                self._refuse_tag(event.tag, self._marks.tag(event))
            if event.anchor is not None:
                self._anchors[event.anchor] = _Anchored(Scalar(name, span, name, plain=False), 1, 0)
        found = (frame.entries if frame.entries is not None else {}).get(name)
        if name == "<<" and type(event) is ScalarEvent and not event.style:
            help = "write the keys out, or use `extends` or `variants`, which merge recipes"
            self._sink.error("yaml-merge-key", "the merge key `<<` is not part of the language", span, help=help)
        elif found is not None:
            message = f"the key `{name}` appears twice in this mapping"
            help = "remove or rename one of the two"
            notes = [Note("it first appears here", found[0].span)]
            self._sink.error("yaml-duplicate-key", message, span, notes=notes, help=help)
        else:
            frame.key = Key(name, span)

    def _check_colon(self, event: Any, frame: _Frame) -> None:
        """Refuse a key in `{ }` that has neither a value nor a colon."""
        key = frame.key
        end = frame.key_end
        if key is None or key is _DROPPED or end is None or frame.is_key or frame.tag is not None:
            return
        if ":" in self._text[end : event.start_mark.index] or len(key.name) > MAX_KEY:
            return
        before = next(reversed(frame.entries or {}), None)
        frame.key = _DROPPED
        frame.has_lone = True
        text = " ".join(key.name.split())  # it may span several lines
        message = f"`{text}` is in `{{ }}` without a colon"
        help = for_lone_key(text, frame.is_quoted, before)
        self._lone.append(Diagnostic("yaml-syntax", message, key.span, help=help))

    def _alias(self, event: Any) -> bool:
        name = event.anchor
        span = self._marks.span(event)
        anchored = self._anchors.get(name)
        if any(frame.anchor == name for frame in self._stack):
            message = f"the alias `*{name}` is inside the value that it names, which would never end"
            self._sink.error("yaml-alias-bomb", message, span)
            return False
        if anchored is None:
            message = f"`*{name}` is an alias in YAML, and no anchor `&{name}` precedes it"
            text = quoted(f"*{name}")
            self._sink.error("yaml-alias", message, span, help=f"if it is text, quote it: {text}", fix=Fix(text))
            anchored = _Anchored(Scalar(f"*{name}", span, f"*{name}", plain=True), 1, 0)
        frame = self._stack[-1] if self._stack else None
        if frame is not None and frame.entries is not None and frame.key is None:
            if isinstance(anchored.node, Scalar):
                self._key(event, anchored.node.text, span, frame=frame)
            else:
                self._refuse_key(event, "an alias of a list or mapping", frame)
            return True
        self._total += anchored.size
        self._expanded += anchored.size
        if self._expanded > FREE_EXPANSION + len(self._text) or self._total > self._most:
            message = f"with `*{name}` the aliases of this file expand to {self._expanded} values, far more than it has"
            self._sink.error("yaml-alias-bomb", message, span)
            return False
        if len(self._stack) + anchored.height > self._deepest:
            message = f"with `*{name}` lists and mappings are nested more than {self._deepest} deep"
            self._sink.error("yaml-too-deep", message, span, help=advice("yaml-depth"))
            return False
        # The contents keep their own place; the value itself is placed at the alias.
        at_alias = replace(span, template=anchored.node.span.template)
        self._add(replace(anchored.node, span=at_alias), anchored.height)
        return True

    def _tagged(self, event: Any, text: str, span: Span) -> bool | int | float | str | None:
        tag = event.tag
        if tag in ("!", _STANDARD + "str"):
            return text
        value = text if event.style and tag not in _SCALAR_TAGS else self._resolved(text, span)
        if tag not in _SCALAR_TAGS:
            self._refuse_tag(tag, self._marks.tag(event))
        elif type(value) not in _SCALAR_TAGS[tag]:
            message = f"`{text}` does not fit its tag `{_shown(tag)}`"
            self._sink.error("yaml-tag", message, span, help=f"remove the tag `{_shown(tag)}`")
        return value

    def _refuse_tag(self, tag: str, span: Span) -> None:
        help = f"remove `{_shown(tag)}`; if it is text, quote the whole value"
        self._sink.error("yaml-tag", f"the tag `{_shown(tag)}` is not part of the language", span, help=help)

    def _refuse_key(self, event: Any, kind: str, holder: _Frame) -> None:
        help = "a key is text; quote it if it begins with `[`, `{` or `*`"
        if kind == "a mapping" and self._text.startswith("{{", event.start_mark.index - 1):
            help = 'quote text with braces; write an expression as "${…}"'
        self._sink.error("yaml-key", f"{kind} cannot be a key", self._marks.span(event), help=help)
        holder.key = _DROPPED


def _shown(tag: str) -> str:
    return "!!" + tag.removeprefix(_STANDARD) if tag.startswith(_STANDARD) else tag
