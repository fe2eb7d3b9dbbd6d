"""MJCF text to a unit: lenient where MuJoCo's own reader is lenient, with `<include>` expanded in place."""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.tree.files import join
from composer.tree.unit import Unit

_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
_TOUCHING = re.compile(r"""(<[^<>]*?=\s*(?:"[^"]*"|'[^']*'))(?=[\w:])""")
_MAX_BYTES = 256 * 1024 * 1024


def parse_file(path: Path, sink: Sink, *, file: str | None = None) -> Unit | None:
    """The unit of an MJCF file; faults go to `sink` and give None. `file` is how messages name it."""
    shown = file or str(path)
    data = _read(path, shown, sink, None)
    if data is None:
        return None
    return parse_text(data, sink, file=shown, directory=path.parent, label=path.stem)


def parse_text(
    data: bytes | str,
    sink: Sink,
    *,
    file: str,
    directory: Path,
    label: str,
    contents: Mapping[str, bytes | Path] | None = None,
) -> Unit | None:
    """The unit of MJCF text whose files resolve against `directory`, or against `contents` first."""
    root = _parse_xml(data, file, sink)
    if root is None:
        return None
    if root.tag != "mujoco":
        message = f"this is not an MJCF model: its root is `<{root.tag}>`, not `<mujoco>`"
        sink.error("not-mjcf", message, Span(file, root.sourceline or 1, 1))
        return None
    unit = Unit(root, file, directory, label, contents or {})
    if next(root.iter("include"), None) is not None:
        _Includes(unit, sink).expand(root, file, directory)
    return None if sink.has_errors else unit


class _Includes:
    """Expands `<include>` where it stands; MuJoCo reads each file at most once."""

    def __init__(self, unit: Unit, sink: Sink) -> None:
        self.unit, self.sink = unit, sink
        self.seen: set[str] = set()

    def expand(self, tree: Node, file: str, folder: Path) -> None:
        for element in list(tree.iter("include")):
            self._replace(element, file, folder)

    def _replace(self, element: Node, file: str, folder: Path) -> None:
        span = Span(file, element.sourceline or 1, 1)
        name = str(element.get("file") or "")
        if not name:
            self.sink.error("xml-include", "`<include>` without a `file`", span)
            return
        path = self._find(name, folder)
        key = str(path)
        if key in self.seen:
            self.sink.error("xml-include", f"`{name}` is included twice, which MuJoCo refuses", span)
            return
        self.seen.add(key)
        data = self._content(name, path, span)
        included = None if data is None else _parse_xml(data, str(path), self.sink)
        if included is None:
            return
        if included.tag not in ("mujoco", "mujocoinclude"):
            message = f"`{name}` has the root `<{included.tag}>`, not `<mujocoinclude>` or `<mujoco>`"
            self.sink.error("xml-include", message, span)
            return
        self.expand(included, str(path), path.parent)
        parent = element.getparent()
        assert parent is not None
        at = parent.index(element)
        children = list(included)
        parent[at : at + 1] = children
        for child in children:
            if isinstance(child.tag, str) and child not in self.unit.origins.owners:
                self.unit.origins.own(child, str(path))

    def _find(self, name: str, folder: Path) -> Path:
        """Against the main file's folder, then against that of the file that includes."""
        main = Path(join(str(self.unit.directory), name))
        return main if main.exists() or name in self.unit.contents else Path(join(str(folder), name))

    def _content(self, name: str, path: Path, span: Span) -> bytes | None:
        content = self.unit.contents.get(name)
        if isinstance(content, bytes):
            return content
        return _read(path, f"included file `{name}`", self.sink, span)


def _read(path: Path, what: str, sink: Sink, span: Span | None) -> bytes | None:
    try:
        if path.stat().st_size > _MAX_BYTES:
            sink.error("file-unreadable", f"{what} is larger than 256 MiB", span)
            return None
        return path.read_bytes()
    except FileNotFoundError:
        sink.error("file-not-found", f"{what} does not exist", span)
    except OSError as error:
        sink.error("file-unreadable", f"{what} cannot be read: {error.strerror or error}", span)
    return None


_PARSERS = threading.local()


def _parser() -> etree.XMLParser:
    """One parser for each thread: making one costs as much as parsing a small model."""
    parser = getattr(_PARSERS, "parser", None)
    if parser is None:
        parser = _PARSERS.parser = etree.XMLParser(
            remove_blank_text=True, resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True
        )
    assert isinstance(parser, etree.XMLParser)
    return parser


def _parse_xml(data: bytes | str, file: str, sink: Sink) -> Node | None:
    if isinstance(data, str):
        data = data.encode()
    try:
        return etree.fromstring(data, _parser())
    except etree.XMLSyntaxError as error:
        fault = error
    try:
        return etree.fromstring(_as_mujoco_reads(data), _parser())
    except (etree.XMLSyntaxError, UnicodeDecodeError):
        line, column = fault.position
        message = (fault.msg or "not XML").split(", line ")[0]
        sink.error("xml-syntax", f"not well-formed XML: {message}", Span(file, max(line, 1), max(column, 1)))
        return None


def _as_mujoco_reads(data: bytes) -> bytes:
    """The same text with what MuJoCo's reader tolerates made strict: `--` in comments, attributes that touch."""
    text = data.decode("utf-8-sig").replace("\r\n", "\n").lstrip()
    pieces: list[str] = []
    end = 0
    for comment in _COMMENT.finditer(text):
        pieces.append(_part_attributes(text[end : comment.start()]))
        body = re.sub(r"-(?=-)", "- ", comment.group(1))
        pieces.append(f"<!--{body}{' ' if body.endswith('-') else ''}-->")
        end = comment.end()
    pieces.append(_part_attributes(text[end:]))
    return "".join(pieces).encode()


def _part_attributes(text: str) -> str:
    while True:
        parted = _TOUCHING.sub(r"\1 ", text)
        if parted == text:
            return text
        text = parted
