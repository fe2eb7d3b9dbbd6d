"""Parse MJCF text to a unit: as lenient as MuJoCo's own reader, with `<include>` expanded in place."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import closest, did_you_mean, exists_note
from composer.grammar import GRAMMAR
from composer.limits import advice, in_force
from composer.reading.door import Door
from composer.reading.foreign import SDF
from composer.reading.project import own_door
from composer.reading.refused import Refused
from composer.reading.regular import TooLarge
from composer.tree import doctype, xml_fault
from composer.tree.cdata import take_cdata_in
from composer.tree.comments import take_header_in
from composer.tree.expansion import CODE, check_size
from composer.tree.file_text import FileText
from composer.tree.files import join
from composer.tree.ignored import note_unread
from composer.tree.unit import Unit
from composer.tree.xml_size import check_attributes, check_text

_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
_DECLARATION = re.compile(r"\A\s*<\?xml\b.*?\?>", re.DOTALL)
_NOT_BREAK = re.compile(r"[^\n]")
_TOUCHING = re.compile(r"""(<[^<>]*?=\s*(?:"[^"]*"|'[^']*'))(?=[\w:])""")
_CDATA = b"<![CDATA["
_DROPPED = ("body", "frame")
_INCLUDED = "refer to the model that includes it"
_NO_MODEL = {
    "mujocoinclude": _INCLUDED,
    "robot": "it looks like URDF: a recipe reads it if its name ends in `.urdf`",
}


def parse_file(
    path: Path, sink: Sink, *, file: str | None = None, span: Span | None = None, door: Door | None = None
) -> Unit | None:
    """Return the unit of an MJCF file, or None after errors, which go to `sink`.

    `file` is its name in messages, `span` where it is requested; `door` limits what it may read, by default its
    project.
    """
    shown, door = file or str(path), door or own_door(path)
    data = read_file(path, sink, door, file=shown, span=span)
    if data is None:
        return None
    unit = parse_text(data, sink, file=shown, directory=path.parent, label=path.stem, door=door)
    if unit is not None:
        unit.origins.texts[shown] = FileText(path)
    return unit


def read_file(path: Path, sink: Sink, door: Door, *, file: str, span: Span | None = None) -> bytes | None:
    """Return the bytes of a model file, or None if it is unreadable, which goes to `sink`."""
    try:
        return door.read(path, in_force().xml_size)
    except Refused as refused:
        refused.report(sink, span)
        return None
    except OSError as error:
        message, help = _unreadable(f"the model `{file}`", Path(file), path, error=error)
        sink.error(_code(error, "file-unreadable"), message, span, help=help)
        return None


def parse_text(
    data: bytes | str,
    sink: Sink,
    *,
    file: str,
    directory: Path,
    label: str,
    contents: Mapping[str, bytes | Path] | None = None,
    door: Door | None = None,
) -> Unit | None:
    """Return the unit of MJCF text whose files are relative to `directory`, or found in `contents` first.

    `door` limits what it may read besides `contents`; by default as for a file in `directory`.
    """
    before = sink.error_count
    root = parse_xml(data, file, sink)
    if root is None:
        return None
    header = take_header_in(root)
    door = door or own_door(directory / "model.xml")
    unit = Unit(root, file, directory, label=label, contents=contents or {}, header=header, door=door)
    unit.origins.texts[file] = FileText(contents=data)
    unit.origins.size = len(data)
    if root.tag != "mujoco":
        help = SDF.help(file) if root.tag == "sdf" else _NO_MODEL.get(str(root.tag))
        message = f"`{file}` is not an MJCF model: its root is `<{root.tag}>`, not `<mujoco>`"
        sink.error("not-mjcf", message, unit.origins.span(root, file), help=help)
        return None
    if next(root.iter("include"), None) is not None:
        from composer.tree.included_files import find_beside  # few models include any

        includes = _Includes(unit, sink)
        includes.expand(root, file, directory)
        find_beside(unit, includes.folders)
    for section in list(root.iterchildren("*")) if sink.error_count == before else ():
        if section.tag not in _sections():
            _unknown_section(section, unit, sink)
    note_unread(unit)
    if sink.error_count == before:
        check_size(unit, sink, opens_files=False)
    return None if sink.error_count > before else unit


@cache
def _sections() -> frozenset[str]:
    return frozenset(GRAMMAR.root.children)


def _unknown_section(section: Node, unit: Unit, sink: Sink) -> None:
    """Report an unknown section.

    MuJoCo refuses it too, except bodies and frames, which it (3.2 to 4.0) drops silently. If nothing else were
    left, the file is meant to be included, and that is an error.
    """
    tag, known = str(section.tag), list(GRAMMAR.root.children)
    if tag in _DROPPED and any(len(world) for world in unit.root.iterchildren("worldbody")):
        if _has_unknown(section, unit, sink):
            return
        message = f"MuJoCo ignores a `<{tag}>` in `<mujoco>`, which is not part of the model"
        span = unit.origins.span(section, unit.file)
        sink.warning("unknown-element", message, span, help="put it into `<worldbody>`, or remove it")
        unit.root.remove(section)
        return
    sink.error(
        "unknown-element",
        f"`<{tag}>` cannot stand in `<mujoco>`",
        unit.origins.span(section, unit.file),
        notes=(exists_note("section", known, tag),),
        help=f"put it into `<worldbody>`; of a file that is there to be included, {_INCLUDED}"
        if tag in GRAMMAR.section("worldbody").children
        else did_you_mean(tag, known, "<{}>"),
    )


def _has_unknown(dropped: Node, unit: Unit, sink: Sink) -> bool:
    """Return whether MuJoCo refuses something in a dropped element: it checks names there, but no values."""
    waiting = [(dropped, GRAMMAR.section("worldbody").children[str(dropped.tag)])]
    while waiting:
        node, kind = waiting.pop()
        for name in map(str, node.keys()):
            if name not in kind.attributes and name not in kind.ignored:
                message, span = (
                    f"`{name}` is not an attribute of `<{node.tag}>`",
                    unit.origins.span(node, unit.file, name),
                )
                sink.error("unknown-attribute", message, span, help=f"remove the `<{dropped.tag}>` it is in")
                return True
        for child in node.iterchildren("*"):
            if child.tag not in kind.children:
                message = f"`<{child.tag}>` cannot stand in `<{node.tag}>`"
                span = unit.origins.span(child, unit.file)
                sink.error("unknown-element", message, span, help=f"remove the `<{dropped.tag}>` it is in")
                return True
            waiting.append((child, kind.children[str(child.tag)]))
    return False


class _Includes:
    """Expands each `<include>` in place; MuJoCo reads each file at most once."""

    def __init__(self, unit: Unit, sink: Sink) -> None:
        self.unit, self.sink = unit, sink
        self.seen: dict[str, tuple[Node, str]] = {}
        self.folders: dict[Node, Path] = {}

    def expand(self, tree: Node, file: str, folder: Path, depth: int = 0) -> None:
        for element in list(tree.iter("include")):
            self._replace(element, file, folder, depth=depth + 1)

    def _replace(self, element: Node, file: str, folder: Path, depth: int) -> None:
        origins = self.unit.origins

        def refuse(
            message: str, help: str | None = None, notes: tuple[Note, ...] = (), code: str = "xml-include"
        ) -> None:
            span = origins.span(element, file, "file")
            self.sink.error(code, message, span, notes=notes, help=help)

        if len(element) or (element.text or "").strip():  # MuJoCo does not even allow a comment
            refuse("`<include>` has something inside, which MuJoCo refuses", 'write `<include file="…"/>`')
            return
        if depth > in_force().nesting:
            allowed = f"{in_force().nesting} files in one another are allowed"
            refuse(f"files include one another too deep; {allowed}", advice("nesting"), code=CODE)
            return
        name = str(element.get("file") or "")
        if not name:
            refuse("`<include>` does not say which `file`", 'write `<include file="…"/>`')
            return
        path = self._find(name, folder)
        shown = self._shown(path)
        if shown in (file, self.unit.file):
            refuse(f"`{shown}` includes itself", "take this `<include>` out")
            return
        if shown in self.seen:
            first = Note("it is included here first", origins.span(*self.seen[shown], "file"))
            refuse(f"`{name}` is included twice, which MuJoCo refuses", "take one of the two out", (first,))
            return
        self.seen[shown] = element, file
        try:
            content = self.unit.contents.get(name)
            data = content if isinstance(content, bytes) else self.unit.door.read(path, in_force().xml_size)
            origins.count(len(data), in_force().xml_size)
        except Refused as refused:
            refused.report(self.sink, origins.span(element, file, "file"))
            return
        except OSError as error:
            message, help = _unreadable(f"the included file `{name}`", Path(name), path, error=error)
            refuse(message, help, code=CODE if isinstance(error, TooLarge) else "xml-include")
            return
        included = parse_xml(data, shown, self.sink)
        if included is None:
            return
        origins.texts[shown] = FileText(None if isinstance(content, bytes) else path, data)
        if included.tag not in ("mujoco", "mujocoinclude"):
            refuse(f"`{name}` has the root `<{included.tag}>`, not `<mujocoinclude>` or `<mujoco>`")
            return
        take_header_in(included)
        self.expand(included, shown, path.parent, depth=depth)
        beside = path.parent
        for each in included.iter("*"):
            self.folders.setdefault(each, beside)
        parent = element.getparent()
        assert parent is not None
        at = parent.index(element)
        children = list(included)
        parent[at : at + 1] = children
        for child in children:
            if isinstance(child.tag, str) and child not in origins.owners:
                origins.own(child, shown)

    def _find(self, name: str, folder: Path) -> Path:
        """Look in the main file's folder, then in that of the including file."""
        main = Path(join(str(self.unit.directory), name))
        if name in self.unit.contents or os.path.lexists(main):
            return main
        beside = Path(join(str(folder), name))
        return beside if os.path.lexists(beside) else main

    def _shown(self, path: Path) -> str:
        """Return the file's name in messages: relative to the model's own file."""
        inside = os.path.relpath(path, self.unit.directory)
        return os.path.normpath(os.path.join(os.path.dirname(self.unit.file), inside))


def _code(error: OSError, other: str) -> str:
    if isinstance(error, TooLarge):
        return CODE
    return "file-not-found" if isinstance(error, FileNotFoundError) else other


def _unreadable(what: str, name: Path, path: Path, error: OSError) -> tuple[str, str | None]:
    """Return message and help for an unreadable file at `path`, which is written as `name`."""
    if isinstance(error, TooLarge):
        return f"{what} is not read: {error}", advice("xml-size", error.size)
    if not isinstance(error, FileNotFoundError):
        return f"{what} cannot be read: {error.strerror.lower() if error.strerror else error}", None
    near = closest(path.name, _beside(path))
    return f"{what} does not exist", f"did you mean `{(name.parent / near[0]).as_posix()}`?" if near else None


def _beside(path: Path) -> list[str]:
    try:
        return sorted(os.listdir(path.parent))
    except OSError:
        return []


_PARSERS = threading.local()


class _NoFiles(etree.Resolver):
    """Blocks DTDs and entities in other files, which libxml2 2.14 reads even with `load_dtd=False`."""

    def resolve(self, url: Any, id: Any, context: Any) -> Any:  # type: ignore[override]  # the stubs lack `context`
        return self.resolve_empty(context)  # type: ignore[attr-defined]


def _parser() -> etree.XMLParser:
    """Return the parser of this thread: creating one costs as much as parsing a small model."""
    parser = getattr(_PARSERS, "parser", None)
    if parser is None:
        parser = _PARSERS.parser = etree.XMLParser(
            remove_blank_text=True, resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True,
            collect_ids=False,
        )  # fmt: skip
        parser.resolvers.add(_NoFiles())
    assert isinstance(parser, etree.XMLParser)
    return parser


def parse_xml(data: bytes | str, file: str, sink: Sink) -> Node | None:
    """Return the root of XML that may be as lax as MuJoCo's reader allows; errors go to `sink`."""
    if isinstance(data, str):
        data = data.encode(errors="surrogatepass")  # the parser reports invalid text
    if doctype.refused(data, file, sink) or not check_text(data, file, sink):
        return None
    root = _parsed(data, file, sink)
    if root is None or not check_attributes(root, data, file, sink=sink):
        return None
    if _CDATA in data:
        take_cdata_in(root, data)
    return root


def _parsed(data: bytes, file: str, sink: Sink) -> Node | None:
    try:
        return etree.fromstring(data, _parser())
    except etree.XMLSyntaxError as error:
        fault = error
    if (fault.msg or "").startswith("Namespace prefix"):
        root = _with_undefined_prefixes(data)
        if root is not None:
            return root
    try:
        return etree.fromstring(_as_mujoco_reads(data), _parser())
    except (etree.XMLSyntaxError, UnicodeDecodeError):
        line, column = fault.position
        text = data.decode("utf-8", "replace")
        xml_fault.report(
            fault.msg or "it cannot be read", file, max(line, 1), column=max(column, 1), text=text, sink=sink
        )
        return None


def _with_undefined_prefixes(data: bytes) -> Node | None:
    """Parse XML with undeclared prefixes, which MuJoCo ignores; return None for other errors."""
    parser = etree.XMLParser(
        remove_blank_text=True, resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True,
        collect_ids=False, recover=True,
    )  # fmt: skip
    parser.resolvers.add(_NoFiles())
    root = etree.fromstring(data, parser)
    return root if all(each.domain == etree.ErrorDomains.NAMESPACE for each in parser.error_log) else None


def _as_mujoco_reads(data: bytes) -> bytes:
    """Make strict what MuJoCo's reader tolerates: `--` in comments, and attributes without space between them."""
    text = data.decode("utf-8-sig").replace("\r\n", "\n")
    # Nothing may precede an XML declaration; without one, line numbers stay the same.
    text = _DECLARATION.sub(lambda found: _NOT_BREAK.sub(" ", found.group()), text, count=1)
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
