"""Parse MJCF text into a unit, as leniently as MuJoCo's own reader.

XML that MuJoCo parses differently from an XML parser is refused. MuJoCo 4.0 reads bytes as UTF-8 whatever the
declaration says, and ends a `<!DOCTYPE` at the first `>`: a comment in a DTD can be a model for MuJoCo.
"""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

from lxml import etree
from lxml.etree import _Comment as Comment, _Element as Node

from mjcompose.base.access import Door, own_door
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.files import SDF, Refused, TooLarge, files_among
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, did_you_mean, exists_note
from mjcompose.tree import xml_faults
from mjcompose.tree.cost import CODE, check_attributes, check_size, check_text
from mjcompose.tree.files import file_attributes, is_absolute, join, written_path
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.mesh_cost import check_meshes
from mjcompose.tree.unit import FileText, Unit
from mjcompose.tree.xml_faults import note_unread
from mjcompose.tree.xml_text import take_cdata_in


def take_header_in(root: Node) -> tuple[Node, ...]:
    """Move the comments before a root, such as a license, inside it: they would be lost when the tree moves."""
    found = [each for each in root.itersiblings(preceding=True) if isinstance(each, Comment)]
    for comment in found:
        comment.tail = None
        root.insert(0, comment)
    return tuple(reversed(found))


def above(section: Node, header: Container[Node]) -> list[Node]:
    """Return the comments directly above a section, without the header's."""
    before = section.itersiblings(preceding=True)
    return list(takewhile(lambda each: isinstance(each, Comment) and each not in header, before))[::-1]


_DECLARED = re.compile(rb"""\A(?:\xef\xbb\xbf)?\s*<\?xml\b[^>]*?\bencoding\s*=\s*["']([^"']*)["']""")
_ASCII = re.compile(r"utf-?8|(us-)?ascii|iso-?8859-?\d+|latin-?\d|windows-125\d|cp125\d", re.IGNORECASE)
"""Encodings with the same bytes as ASCII for tags."""
_WIDE = (b"\xff\xfe", b"\xfe\xff", b"\x00\x00\xfe\xff", b"<\x00", b"\x00<")
_PLAIN = re.compile(rb"<!DOCTYPE\s+[\w:.-]+\s*>")
"""A doctype that ends at its first `>`, and neither declares anything nor names another file."""


def refused(data: bytes, file: str, sink: Sink) -> bool:
    """Return whether the text is refused, which is reported.

    >>> refused(b'<!DOCTYPE mujoco [<!-- > <mujoco model="other"/> -->]><mujoco/>', "a.xml", Sink())
    True
    """
    declared = _DECLARED.match(data)
    named = declared[1].decode("ascii", "replace") if declared is not None else "UTF-8"
    if data.startswith(_WIDE):
        named = "UTF-16"
    if not _ASCII.fullmatch(named):
        message = f"`{file}` is in the encoding `{named}`, but MuJoCo reads only UTF-8"
        sink.error("xml-syntax", message, Span(file, 1, 1), help="save it as UTF-8")
        return True
    at = data.find(b"<!DOCTYPE")
    while at >= 0 and _PLAIN.match(data, at):
        at = data.find(b"<!DOCTYPE", at + 1)
    if at >= 0:
        *above, before = data[:at].split(b"\n")
        span = Span(file, len(above) + 1, len(before.decode("utf-8", "replace")) + 1)
        message = f"`{file}` has a DTD, which MuJoCo does not read"
        sink.error("xml-syntax", message, span, help="remove the `<!DOCTYPE …>`")
    return at >= 0


def _files_named(unit: Unit) -> Iterator[tuple[Node, str, str, str]]:
    """Yield element, attribute, file name and written path of the files that a model names, and of attached models."""
    for element, attribute, name in file_attributes(unit.root):
        yield element, attribute, name, written_path(unit.settings, element, name)
    for element in unit.root.iterfind("asset/model"):
        name = str(element.get("file") or "")
        yield element, "file", name, name


_BESIDE_FIRST = ("flexcomp", "model")


def find_beside(unit: Unit, included: Mapping[Node, Path]) -> None:
    """Rewrite file names in included elements, each given with the folder of its file, if MuJoCo finds them there.

    MuJoCo does so if the path of the main file is absolute; with a relative path it does not find them.
    """
    if unit.settings.strippath == "true":
        return
    rivals = list(_rivals(unit, included))
    existing = {path for _, paths in files_among(rival.usual for rival in rivals) for path in paths}
    inner = {"model": "", "texture": unit.settings.texture_folder}
    for element, attribute, usual, beside in rivals:
        wins = element.tag in _BESIDE_FIRST or not (usual in existing or os.path.exists(usual))
        if wins and os.path.exists(beside):
            start = join(str(unit.directory), inner.get(str(element.tag), unit.settings.mesh_folder) or ".")
            with suppress(ValueError):  # on another drive
                beside = Path(os.path.relpath(beside, start)).as_posix()
            element.set(attribute, beside)


class _Rival(NamedTuple):
    """Two paths that a file name in an included element can mean: in the usual folder, and next to its own file."""

    element: Node
    attribute: str
    usual: str
    beside: str


def _rivals(unit: Unit, included: Mapping[Node, Path]) -> Iterator[_Rival]:
    for element, attribute, name, written in _files_named(unit):
        folder = included.get(element)
        if folder is None or not name or is_absolute(name) or name in unit.contents:
            continue
        usual = join(str(unit.directory), written)
        beside = join(str(folder), name)
        if usual != beside and written not in unit.contents:
            yield _Rival(element, attribute, usual, beside)


_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
_DECLARATION = re.compile(r"\A\s*<\?xml\b.*?\?>", re.DOTALL)
_NOT_BREAK = re.compile(r"[^\n]")
_TOUCHING = re.compile(r"""(<[^<>]*?=\s*(?:"[^"]*"|'[^']*'))(?=[\w:])""")
_CDATA = b"<![CDATA["
_DROPPED = ("body", "frame")
_INCLUDED = "refer to the model that includes it"
_NO_MODEL = {"mujocoinclude": _INCLUDED, "robot": "it looks like URDF: a recipe reads it if its name ends in `.urdf`"}


Assumed = Sequence[tuple[str, str, Span]]
"""Attributes of a `<compiler>` that a recipe gives for a file, as text, each with its place in the recipe."""


def parse_file(
    path: Path,
    sink: Sink,
    *,
    file: str | None = None,
    span: Span | None = None,
    door: Door | None = None,
    assumed: Assumed = (),
) -> Unit | None:
    """Return the unit of an MJCF file, or None after errors, which go to `sink`.

    `file` is its name in messages, and `span` is the place where it is requested; `door` limits the files that it may
    read, by default to its project. The file is read as if it began with a `<compiler>` with the `assumed` attributes.
    """
    shown = file or str(path)
    door = door or own_door(path)
    data = read_file(path, sink, door, file=shown, span=span)
    if data is None:
        return None
    unit = parse_text(data, sink, file=shown, directory=path.parent, label=path.stem, door=door, assumed=assumed)
    if unit is not None:
        unit.origins.texts[shown] = FileText(path)
    return unit


def model_of_mesh(path: Path) -> bytes:
    """Return MJCF with a body with a geom of a mesh, all with the name of the mesh file, which is next to the MJCF."""
    model = etree.Element("mujoco", {"model": path.stem})
    etree.SubElement(etree.SubElement(model, "asset"), "mesh", {"name": path.stem, "file": path.name})
    body = etree.SubElement(etree.SubElement(model, "worldbody"), "body", {"name": path.stem})
    etree.SubElement(body, "geom", {"name": path.stem, "type": "mesh", "mesh": path.stem})
    return etree.tostring(model)


def read_file(path: Path, sink: Sink, door: Door, *, file: str, span: Span | None = None) -> bytes | None:
    """Return the bytes of a model file, or None if it is unreadable, which goes to `sink`."""
    try:
        return door.read(path, in_force().xml_size)
    except Refused as refused:
        refused.report(sink, span)
        return None
    except OSError as error:
        message, help = _unreadable(f"the model `{file}`", Path(file), path, error=error)
        code = "file-not-found" if isinstance(error, FileNotFoundError) else "file-unreadable"
        sink.error(CODE if isinstance(error, TooLarge) else code, message, span, help=help)
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
    assumed: Assumed = (),
) -> Unit | None:
    """Return the unit of MJCF text whose files are relative to `directory`, or found in `contents` first.

    `door` limits the files that it may read besides `contents`, by default as for a file in `directory`. `assumed` is
    the same as for `parse_file`.
    """
    before = sink.error_count
    root = parse_xml(data, file, sink)
    if root is None:
        return None
    unit = Unit(root, file, directory, label=label, contents=contents or {}, header=take_header_in(root))
    read_from(unit, data, door)
    if root.tag != "mujoco":
        help = SDF.help(file) if root.tag == "sdf" else _NO_MODEL.get(str(root.tag))
        message = f"`{file}` is not an MJCF model: its root is `<{root.tag}>`, not `<mujoco>`"
        sink.error("not-mjcf", message, unit.origins.span(root, file), help=help)
        return None
    first = assumed_compiler(unit, assumed) if assumed else None
    expand_includes(unit, sink)
    if first is not None:
        join_compiler(unit, first)
    if sink.error_count == before:
        for section in list(root.iterchildren("*")):
            if section.tag not in GRAMMAR.root.children:
                _unknown_section(section, unit, sink)
    note_unread(unit)
    if sink.error_count == before:
        check_size(unit, sink, opens_files=False)
    return None if sink.error_count > before else unit


def assumed_compiler(unit: Unit, assumed: Assumed) -> Node:
    """Put a `<compiler>` before everything that a file writes, and return it."""
    first = etree.Element("compiler")
    for name, value, span in assumed:
        first.set(name, value)
        unit.origins.settings.setdefault(first, {})[name] = span
    unit.origins.own(first, assumed[0][2])
    unit.root.insert(len(unit.header), first)
    return first


def join_compiler(unit: Unit, first: Node) -> None:
    """Move the attributes that the file does not write itself into its own `<compiler>`, if it has one."""
    others = [each for each in unit.root.iterchildren("compiler") if each is not first]
    if not others:
        return
    places = unit.origins.settings.pop(first, {})
    for name, value in first.items():
        if not any(str(each.get(name) or "").strip() for each in others):
            others[0].set(name, value)
            unit.origins.settings.setdefault(others[0], {})[str(name)] = places[str(name)]
    unit.origins.owners.pop(first, None)
    unit.root.remove(first)


def read_from(unit: Unit, data: bytes | str, door: Door | None = None) -> None:
    """Note the text that a unit was read from, with its includes as written, and the files that it may read."""
    unit.door = door or own_door(unit.directory / "model.xml")
    unit.origins.texts[unit.file] = FileText(contents=data)
    unit.origins.size = len(data)


def expand_includes(unit: Unit, sink: Sink) -> None:
    """Replace each `<include>` with the contents of its file."""
    if next(unit.root.iter("include"), None) is not None:
        includes = _Includes(unit, sink)
        includes.expand(unit.root, unit.file, unit.directory)
        find_beside(unit, includes.folders)


def _unknown_section(section: Node, unit: Unit, sink: Sink) -> None:
    """Report an unknown section.

    MuJoCo refuses it too, except bodies and frames, which it (3.2 to 4.0) drops silently. If nothing else is left, the
    file is a fragment for `<include>`, which is an error.
    """
    tag = str(section.tag)
    known = list(GRAMMAR.root.children)
    if tag in _DROPPED and any(len(world) for world in unit.root.iterchildren("worldbody")):
        if _has_unknown(section, unit, sink):
            return
        message = f"MuJoCo ignores a `<{tag}>` in `<mujoco>`, which is not part of the model"
        span = unit.origins.span(section, unit.file)
        sink.warning("unknown-element", message, span, help="put it into `<worldbody>`, or remove it")
        unit.root.remove(section)
        return
    help = did_you_mean(tag, known, "<{}>")
    if tag in GRAMMAR.section("worldbody").children:
        help = f"put it into `<worldbody>`; if other models include this file, {_INCLUDED}"
    message = f"`<{tag}>` cannot be in `<mujoco>`"
    span = unit.origins.span(section, unit.file)
    sink.error("unknown-element", message, span, notes=(exists_note("section", known, tag),), help=help)


def _has_unknown(dropped: Node, unit: Unit, sink: Sink) -> bool:
    """Return whether MuJoCo refuses something in a dropped element: it checks names there, but not values."""
    waiting = [(dropped, GRAMMAR.section("worldbody").children[str(dropped.tag)])]
    while waiting:
        node, kind = waiting.pop()
        name = next((each for each in map(str, node.keys()) if each not in (*kind.attributes, *kind.ignored)), None)
        child = next((each for each in node.iterchildren("*") if each.tag not in kind.children), None)
        help = f"remove the `<{dropped.tag}>` it is in"
        if name is not None:
            message = f"`{name}` is not an attribute of `<{node.tag}>`"
            span = unit.origins.span(node, unit.file, name)
            sink.error("unknown-attribute", message, span, help=help)
            return True
        if child is not None:
            message = f"`<{child.tag}>` cannot be in `<{node.tag}>`"
            span = unit.origins.span(child, unit.file)
            sink.error("unknown-element", message, span, help=help)
            return True
        waiting += [(each, kind.children[str(each.tag)]) for each in node.iterchildren("*")]
    return False


class _Includes:
    """Expands each `<include>` in place; MuJoCo reads each file at most once."""

    def __init__(self, unit: Unit, sink: Sink) -> None:
        self.unit = unit
        self.sink = sink
        self.seen: dict[str, tuple[Node, str]] = {}
        self.folders: dict[Node, Path] = {}

    def expand(self, tree: Node, file: str, folder: Path, depth: int = 0) -> None:
        for element in list(tree.iter("include")):
            self._replace(element, file, folder, depth=depth + 1)

    def _replace(self, element: Node, file: str, folder: Path, depth: int) -> None:
        name = self._name(element, file, depth)
        if name is None:
            return
        path = self._find(name, folder)
        shown = self._shown(path)
        if not self._is_first(element, file, name, shown=shown):
            return
        included = self._read(element, file, name, path=path, shown=shown)
        if included is None:
            return
        take_header_in(included)
        self.expand(included, shown, path.parent, depth=depth)
        for node in included.iter("*"):
            self.folders.setdefault(node, path.parent)
        parent = element.getparent()
        children = list(included)
        assert parent is not None
        at = parent.index(element)
        parent[at : at + 1] = children
        self.unit.origins.own_all((child for child in children if isinstance(child.tag, str)), shown)

    def _refuse(
        self,
        element: Node,
        file: str,
        message: str,
        help: str | None = None,
        *,
        notes: tuple[Note, ...] = (),
        code: str = "xml-include",
    ) -> None:
        self.sink.error(code, message, self.unit.origins.span(element, file, "file"), notes=notes, help=help)

    def _name(self, element: Node, file: str, depth: int) -> str | None:
        """Return the name of the file that an `<include>` includes, or None after an error."""
        name = str(element.get("file") or "")
        if len(element) or (element.text or "").strip():  # MuJoCo does not even allow a comment
            message = "`<include>` is not empty, which MuJoCo refuses"
            self._refuse(element, file, message, 'write `<include file="…"/>`')
        elif depth > in_force().nesting:
            message = f"files include one another too deeply; {in_force().nesting} files in one another are allowed"
            self._refuse(element, file, message, advice("nesting"), code=CODE)
        elif not name:
            message = "`<include>` does not say which `file`"
            self._refuse(element, file, message, 'write `<include file="…"/>`')
        else:
            return name
        return None

    def _is_first(self, element: Node, file: str, name: str, shown: str) -> bool:
        """Return whether a file is included for the first time, and remember where; if not, report it."""
        if shown in (file, self.unit.file):
            self._refuse(element, file, f"`{shown}` includes itself", "remove this `<include>`")
            return False
        if shown in self.seen:
            first = Note("it is included here first", self.unit.origins.span(*self.seen[shown], "file"))
            message = f"`{name}` is included twice, which MuJoCo refuses"
            self._refuse(element, file, message, "remove one of the two", notes=(first,))
            return False
        self.seen[shown] = element, file
        return True

    def _read(self, element: Node, file: str, name: str, path: Path, shown: str) -> Node | None:
        """Return the root of the included file, or None after an error."""
        origins = self.unit.origins
        content = self.unit.contents.get(name)
        try:
            data = content if isinstance(content, bytes) else self.unit.door.read(path, in_force().xml_size)
            origins.count(len(data), in_force().xml_size)
        except Refused as refused:
            refused.report(self.sink, origins.span(element, file, "file"))
            return None
        except OSError as error:
            message, help = _unreadable(f"the included file `{name}`", Path(name), path, error=error)
            self._refuse(element, file, message, help, code=CODE if isinstance(error, TooLarge) else "xml-include")
            return None
        included = parse_xml(data, shown, self.sink)
        if included is None:
            return None
        origins.texts[shown] = FileText(None if isinstance(content, bytes) else path, data)
        if included.tag not in ("mujoco", "mujocoinclude"):
            message = f"`{name}` has the root `<{included.tag}>`, not `<mujocoinclude>` or `<mujoco>`"
            self._refuse(element, file, message)
            return None
        return included

    def _find(self, name: str, folder: Path) -> Path:
        """Look in the main file's folder, then in the including file's."""
        main = Path(join(str(self.unit.directory), name))
        if name in self.unit.contents or os.path.lexists(main):
            return main
        beside = Path(join(str(folder), name))
        return beside if os.path.lexists(beside) else main

    def _shown(self, path: Path) -> str:
        inside = os.path.relpath(path, self.unit.directory)
        return os.path.normpath(os.path.join(os.path.dirname(self.unit.file), inside))


def _unreadable(what: str, name: Path, path: Path, error: OSError) -> tuple[str, str | None]:
    """Return message and help for an unreadable file at `path`, which is written as `name`."""
    if isinstance(error, TooLarge):
        return f"{what} is not read: {error}", advice("xml-size", error.size)
    if not isinstance(error, FileNotFoundError):
        return f"{what} cannot be read: {error.strerror.lower() if error.strerror else error}", None
    try:
        near = closest(path.name, sorted(os.listdir(path.parent)))
    except OSError:
        near = []
    return f"{what} does not exist", f"did you mean `{(name.parent / near[0]).as_posix()}`?" if near else None


_PARSERS = threading.local()


class _NoFiles(etree.Resolver):
    """Blocks DTDs and entities in other files, which libxml2 2.14 reads even with `load_dtd=False`."""

    def resolve(self, url: Any, id: Any, context: Any) -> Any:  # type: ignore[override]  # the stubs lack `context`
        return self.resolve_empty(context)  # type: ignore[attr-defined]


def _parser() -> etree.XMLParser:
    """Return the parser of this thread: creating one costs as much as parsing a small model."""
    if not hasattr(_PARSERS, "parser"):
        _PARSERS.parser = _new_parser()
    parser: etree.XMLParser = _PARSERS.parser
    return parser


def _new_parser(*, recover: bool = False) -> etree.XMLParser:
    parser = etree.XMLParser(
        remove_blank_text=True,
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=True,
        collect_ids=False,
        recover=recover,
    )
    parser.resolvers.add(_NoFiles())
    return parser


def parse_xml(data: bytes | str, file: str, sink: Sink) -> Node | None:
    """Return the root of XML, with the leniency of MuJoCo's reader; errors go to `sink`."""
    if isinstance(data, str):
        data = data.encode(errors="surrogatepass")  # the parser reports invalid text
    if refused(data, file, sink) or not check_text(data, file, sink):
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
    said = fault.msg or "it cannot be read"
    if said.startswith("Namespace prefix"):  # MuJoCo ignores undeclared ones
        parser = _new_parser(recover=True)
        root = etree.fromstring(data, parser)
        if all(each.domain == etree.ErrorDomains.NAMESPACE for each in parser.error_log):
            return root
    try:
        return etree.fromstring(_as_mujoco_reads(data), _parser())
    except (etree.XMLSyntaxError, UnicodeDecodeError):
        line, column = (max(each, 1) for each in fault.position)
        xml_faults.report(said, file, line, column=column, text=data.decode("utf-8", "replace"), sink=sink)
        return None


def _as_mujoco_reads(data: bytes) -> bytes:
    """Correct faults that MuJoCo's reader tolerates: `--` in comments, and attributes without space between them."""
    text = data.decode("utf-8-sig").replace("\r\n", "\n")
    # Nothing may precede an XML declaration; without one, line numbers stay the same.
    text = _DECLARATION.sub(lambda found: _NOT_BREAK.sub(" ", found.group()), text, count=1)
    pieces = _COMMENT.split(text)  # texts and comments in turns
    for at, piece in enumerate(pieces):
        if at % 2:
            body = re.sub(r"-(?=-)", "- ", piece)
            pieces[at] = f"<!--{body}{' ' if body.endswith('-') else ''}-->"
        else:
            while (parted := _TOUCHING.sub(r"\1 ", piece)) != piece:
                piece = parted
            pieces[at] = piece
    return "".join(pieces).encode()


def all_admitted(unit: Unit, sink: Sink, shown: Callable[[Path], str] | None = None) -> bool:
    """Return whether the door of a model admits all files that it names; report the others at their places.

    Meshes with more points than the limit are reported too. Included files were read with the model. Attached models
    are read here, with all files that they name.
    """
    before = sink.error_count
    _admit(unit, sink, shown, models=set())
    return sink.error_count == before


def _admit(unit: Unit, sink: Sink, shown: Callable[[Path], str] | None, models: set[str]) -> None:
    check_meshes(unit, 0, sink)
    for element, attribute, name, written in _files_named(unit):
        path = join(str(unit.directory), written)
        is_model = element.tag == "model"
        if not name or written in unit.contents or (is_model and path in models):
            continue
        try:
            unit.door.admit(path)
        except Refused as refused:
            refused.report(sink, unit.origins.span(element, unit.file, attribute), shown=shown)
        if is_model:
            models.add(path)
        if is_model and unit.door.exists(path):
            aside = Sink()
            inner = parse_file(Path(path), aside, file=(shown or str)(Path(path)), door=unit.door)
            for each in aside.errors:
                if each.code == "source-outside":
                    sink.add(each)  # an include; other errors are reported when the model is linked
            if inner is not None:
                _admit(inner, sink, shown, models=models)


def includes_admitted(urdf: Unit, sink: Sink, shown: Callable[[Path], str] | None = None) -> bool:
    """Return whether a URDF includes only files that it may read; some versions of MuJoCo read its includes."""
    before = sink.error_count
    waiting = [(urdf.root, urdf.file, urdf.directory)]
    seen: set[Path] = set()
    while waiting:
        root, file, folder = waiting.pop()
        for element in root.iter("include"):
            path = Path(join(str(folder), str(element.get("file") or "")))
            try:
                urdf.door.admit(path)
                data = urdf.door.read(path) if os.path.isfile(path) and path not in seen else b""
            except Refused as refused:
                refused.report(sink, urdf.origins.span(element, file, "file"), shown=shown)
                continue
            except OSError:  # MuJoCo reports it if it reads the file
                continue
            seen.add(path)
            inner = parse_xml(data, str(path), Sink()) if data else None
            if inner is not None:
                urdf.origins.texts[str(path)] = FileText(path, data)
                waiting.append((inner, str(path), path.parent))
    return sink.error_count == before
