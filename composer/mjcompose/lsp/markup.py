"""MJCF as the subject of the providers: the place of a cursor in XML, half-written text, and its names."""

from __future__ import annotations

import os
import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.files import MJCF_FILES, read_regular, unsaved
from mjcompose.base.sink import Sink
from mjcompose.lsp.analysis import Analysis, Known, ModelNames, Question, names_in_tree, shown
from mjcompose.lsp.cursor import Cursor, Role
from mjcompose.lsp.places import Wanted
from mjcompose.sources.fetching import model_files
from mjcompose.text.node import lines_of
from mjcompose.tree.classes import MAIN
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.parse import expand_includes, parse_xml, read_from, take_header_in
from mjcompose.tree.unit import Unit, line_of
from mjcompose.tree.xml_layout import outermost, place_of_fragment
from mjcompose.tree.xml_text import Piece, pieces, root_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


def repaired(text: str) -> str:
    """Return a half-written text as well-formed XML, in which everything that is complete keeps its place.

    >>> repaired("<mujoco><worldbody><geom name='a' size=<body")
    "<mujoco><worldbody><geom name='a'/>    <body/></worldbody></mujoco>"
    """
    found: list[str] = []
    waiting: list[str] = []
    for piece in pieces(text):
        part = text[piece.start : piece.end]
        if piece.kind == "start" and piece.tag:
            part = _start_tag(text, piece)
            waiting += [] if piece.closed or not piece.complete else [piece.tag]
        elif piece.kind == "end" and piece.tag in waiting:
            while (tag := waiting.pop()) != piece.tag:
                found.append(f"</{tag}>")
            part = part if part.endswith(">") else f"</{piece.tag}>"
        elif piece.kind != "comment" or not part.endswith("-->"):
            part = part if part.startswith("<?") and part.endswith("?>") else _blank(part)
        found.append(part)
    return "".join([*found, *(f"</{tag}>" for tag in reversed(waiting))])


def _start_tag(text: str, piece: Piece) -> str:
    part = text[piece.start : piece.end]
    names = set()
    for at, each in enumerate(piece.attributes):
        end = piece.attributes[at + 1].at if at + 1 < len(piece.attributes) else piece.end
        is_whole = each.value is not None and text[each.end : each.end + 1] == text[each.start - 1]
        if not is_whole or each.name in names:
            end = end if end < piece.end else max(each.end + is_whole, each.at + len(each.name))
            low = each.at - piece.start
            high = end - piece.start
            part = part[:low] + _blank(part[low:high]) + part[high:]
        names.add(each.name)
    if piece.complete:
        return part
    kept = part.rstrip()
    rest = part[len(kept) :]
    return kept + "/>" + (rest if "\n" in rest[:2] else rest[2:])


def _blank(text: str) -> str:
    return "".join(each if each == "\n" else " " for each in text)


class ModelAnalysis(Analysis, slots=False):
    """The result of reading an MJCF file.

    `unit` is its model; for a file that others include, the model of the first file that includes it. `nodes` are the
    elements of the file in the order of their start tags in the text.
    """

    unit: Unit | None = None
    nodes: tuple[Node, ...] = field(default=(), repr=False)

    @cached_property
    def names(self) -> ModelNames:
        if self.unit is None:
            return ModelNames()
        names = names_in_tree(self.unit)
        names.known.setdefault("default", {}).setdefault(MAIN, Known(MAIN, "default", "default"))
        return names


class ModelQuestion(Question, slots=False):
    analysis: ModelAnalysis

    @cached_property
    def text(self) -> str:
        return "\n".join(self.lines)

    @cached_property
    def parts(self) -> list[Piece]:
        return list(pieces(self.text))

    @cached_property
    def _starts(self) -> list[int]:
        return list(accumulate((len(each) + 1 for each in self.lines), initial=0))

    @cached_property
    def _there(self) -> tuple[Cursor, Piece | None, int]:
        return place(self)

    @property
    def offset(self) -> int:
        line = min(self.line, len(self.lines) - 1)
        return self._starts[line] + min(self.column, len(self.lines[line]))

    def at_offset(self, offset: int) -> tuple[int, int]:
        """Return line and column, counted from 0."""
        line = bisect_right(self._starts, offset) - 1
        return line, offset - self._starts[line]

    @property
    def cursor(self) -> Cursor:
        return self._there[0]

    @property
    def piece(self) -> Piece | None:
        return self._there[1]

    @property
    def tree(self) -> None:
        return None

    @cached_property
    def node(self) -> Node | None:
        """The element whose start tag the cursor is in, as the analysis has it."""
        at = self._there[2]
        nodes = self.analysis.nodes
        is_there = self.piece is not None and at < len(nodes) and nodes[at].tag == self.piece.tag
        return nodes[at] if is_there else None

    def children(self, tags: Sequence[object]) -> Mapping[str, ElementType]:
        """Return the elements that can be in the element to which a path of tags leads."""
        found: Mapping[str, ElementType] = {"mujoco": GRAMMAR.root}
        for at, tag in enumerate(map(str, tags)):
            if at == 0 and tag == "mujocoinclude":
                found = place_of_fragment(outermost([each for each in self.parts if each.complete]))
            else:
                found = found[tag].children if tag in found else {}
        return found

    def kind(self, tags: Sequence[object]) -> ElementType | None:
        return self.children(tags[:-1]).get(str(tags[-1])) if tags else None

    @property
    def element(self) -> ElementType | None:
        tags = self.path[:-1] if self.cursor.role == "value" else self.path
        return self.kind(tags) if self.cursor.role in ("key", "value") else None

    @cached_property
    def attribute(self) -> Attribute | None:
        name = self.path[-1] if self.cursor.role == "value" else self.cursor.whole
        return None if self.element is None else self.element.attributes.get(str(name))

    @property
    def wanted(self) -> Wanted | None:
        """The names that the value at the cursor can refer to."""
        attribute = self.attribute if self.cursor.role == "value" else None
        if attribute is None or (attribute.refers or "").startswith("attached:"):
            return None
        if attribute.refers_by and self.piece is not None:
            written = {each.name: each.value for each in self.piece.attributes}
            family = GRAMMAR.objtypes.get(written.get(attribute.refers_by) or "")
            return Wanted((family,) if family else tuple(dict.fromkeys(GRAMMAR.objtypes.values())))
        return Wanted((attribute.refers,)) if attribute.refers else None

    @property
    def named(self) -> Wanted | None:
        """The names that the value at the cursor can declare or refer to."""
        attribute = self.attribute if self.cursor.role == "value" else None
        return Wanted((attribute.declares,)) if attribute is not None and attribute.declares else self.wanted


def place(question: ModelQuestion) -> tuple[Cursor, Piece | None, int]:
    """Return the cursor, the start tag that it is in, and the number of earlier start tags."""
    offset = question.offset
    tags: list[str] = []
    count = 0
    for piece in pieces(question.text):
        if _is_in(piece, offset, len(question.text)):
            return (*_in_piece(question, piece, tags), count)
        if piece.start >= offset:
            break
        if piece.kind == "start" and piece.tag:
            count += 1
            tags += [] if piece.closed or not piece.complete else [piece.tag]
        elif piece.kind == "end" and piece.tag in tags:
            while tags.pop() != piece.tag:
                pass
    return _cursor(question, tags, "content", start=offset, end=offset), None, count


def _is_in(piece: Piece, offset: int, length: int) -> bool:
    """Return whether an offset of a text with a length is in a piece: at its end only if the piece can go on there."""
    if piece.kind == "text":
        return piece.start <= offset <= piece.end
    is_unfinished = piece.kind == "start" and not piece.complete
    return piece.start < offset < piece.end or (offset == piece.end and (is_unfinished or offset == length))


def _in_piece(question: ModelQuestion, piece: Piece, tags: list[str]) -> tuple[Cursor, Piece | None]:
    """Return the cursor in a piece below the elements `tags`, and the piece if it is a start tag."""
    offset = question.offset
    if piece.kind == "start":
        return _in_tag(question, piece, tags)
    if piece.kind == "text":
        before = question.text[piece.start : offset]
        start = piece.start + len(before.rstrip("abcdefghijklmnopqrstuvwxyz"))
        return _cursor(question, tags, "content", start=start, end=offset), None
    if piece.kind == "end":
        start = piece.start + len("</")
        return _cursor(question, tags, "end", start=start, end=start + len(piece.tag)), None
    return _cursor(question, tags, "text", start=offset, end=offset), None


def _in_tag(question: ModelQuestion, piece: Piece, tags: list[str]) -> tuple[Cursor, Piece]:
    offset = question.offset
    text = question.text
    name_end = piece.start + 1 + len(piece.tag)
    if offset <= name_end:
        return _cursor(question, tags, "tag", start=piece.start + 1, end=name_end), piece
    inner = [*tags, piece.tag]
    written = tuple(each.name for each in piece.attributes)
    for each in piece.attributes:
        name_end = each.at + len(each.name)
        path = [*inner, each.name]
        if each.at <= offset <= name_end:
            cursor = _cursor(question, inner, "key", start=each.at, end=name_end)
            return replace(cursor, written=written, has_colon=text[name_end:].lstrip().startswith("=")), piece
        if each.value is not None and each.start <= offset <= each.end:
            kind = question.kind(tuple(inner))
            attribute = kind.attributes.get(each.name) if kind is not None else None
            item = r"\S*" if attribute is not None and attribute.separated else r"[^\n]*"
            before = re.search(f"{item}$", text[each.start : offset]), re.match(item, text[offset : each.end])
            start, end = (0 if found is None else len(found.group()) for found in before)
            cursor = _cursor(question, path, "value", start=offset - start, end=offset + end)
            return replace(cursor, quote='"'), piece
        if each.value is None and name_end < offset <= each.end:
            return _cursor(question, path, "value", start=offset, end=offset), piece
    return replace(_cursor(question, inner, "key", start=offset, end=offset), written=written), piece


def _cursor(question: ModelQuestion, path: Sequence[str], role: Role, start: int, end: int) -> Cursor:
    line, first = question.at_offset(start)
    text = question.text
    return Cursor(
        tuple(path),
        role,
        text[start : question.offset],
        line=line,
        start=first,
        end=first + end - start,
        whole=text[start:end],
    )


def read_unit(data: bytes, file: str, folder: Path) -> Unit | None:
    """Read a text in a folder as a model, with its includes; a fragment gets the section that it needs."""
    root = parse_xml(data, file, Sink())
    if root is None:
        return None
    unit = Unit(root, file, folder, label=Path(file).stem, header=take_header_in(root))
    read_from(unit, data)
    unit.origins.texts[file].path = folder / Path(file).name
    if root.tag == "mujocoinclude":
        tags = {str(each.tag) for each in root.iterchildren("*")}
        sections = GRAMMAR.root.children
        root.tag = "mujoco"
        if not tags <= set(sections):
            tag = next((each for each in ("worldbody", *sections) if tags <= set(GRAMMAR.within(each))), "worldbody")
            section = root.makeelement(tag)
            section.extend(list(root))
            root.append(section)
    expand_includes(unit, Sink())
    return unit


def read_model(path: Path, text: str, folder: Path) -> tuple[Unit | None, tuple[Node, ...]]:
    """Return the model of a text that may be half-written, and its elements in the order of their start tags."""
    whole = repaired("\n".join(lines_of(text)))
    data = whole.encode("utf-8", "replace")
    with unsaved({os.path.realpath(path): data}):
        is_piece = root_of(whole) == "mujocoinclude"
        unit = next((unit for unit, _ in including(path, folder)), None) if is_piece else None
        unit = unit or read_unit(data, shown(path, folder), path.parent)
    if unit is None:
        return None, ()
    own = next((name for name, each in unit.origins.texts.items() if each.path == path), unit.file)
    every = (each for each in unit.root.iter("*") if each.tag != "include")  # those that lead nowhere stay
    nodes = [each for each in every if unit.origins.owner(each, unit.file) == own]
    if is_piece and own == unit.file:  # without its root, and the section that it has got
        nodes = [each for each in nodes[1:] if line_of(each) is not None]
    tags = [each.tag for each in pieces(whole) if each.kind == "start" and each.tag not in ("include", "mujocoinclude")]
    return unit, tuple(nodes) if [each.tag for each in nodes] == tags else ()


def including(path: Path, folder: Path) -> Iterator[tuple[Unit, str]]:
    """Yield the models that include or attach a file, each with the prefix that its names have there.

    They are in its folder, in the folder above, or in the workspace.
    """
    files = [*sorted(path.parent.glob("*.xml")), *sorted(path.parent.parent.glob("*.xml"))]
    files += [folder / name for name in model_files(folder) if name.endswith(MJCF_FILES)]
    for other in dict.fromkeys(files):
        try:
            data = b"" if other == path else read_regular(other)
        except OSError:
            continue
        if path.name.encode() not in data or root_of(data.decode("utf-8", "replace")) != "mujoco":
            continue
        unit = read_unit(data, shown(other, folder), other.parent)
        if unit is None:
            continue
        if any(text.path == path for text in unit.origins.texts.values()):
            yield unit, ""
        else:
            for prefix in _prefixes(unit, path):
                yield unit, prefix


def _prefixes(unit: Unit, path: Path) -> Iterator[str]:
    """Yield the prefix of each `<attach>` of a model that attaches a file."""
    files = {model.get("name"): str(model.get("file") or "") for model in unit.root.iterfind("asset/model")}
    for attach in unit.root.iter("attach"):
        file = files.get(attach.get("model"))
        if file and os.path.normpath(unit.directory / file) == str(path):
            yield str(attach.get("prefix") or "")
