"""Completion, hover, rename, outline and colors of MJCF files, for the providers that recipes also use."""

from __future__ import annotations

import os
import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Span
from mjcompose.base.files import unsaved
from mjcompose.lsp.analysis import Hover, Item, Known, Symbol
from mjcompose.lsp.markup import ModelAnalysis, ModelQuestion, read_unit
from mjcompose.lsp.places import fitting
from mjcompose.lsp.subject import declared_by, named_at
from mjcompose.text.node import TextChange, changed
from mjcompose.tree.classes import class_in_force, default_text, given, levels, value, written
from mjcompose.tree.edit import is_copy, multiplies
from mjcompose.tree.files import is_absolute
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.names import ALWAYS, NameIndex
from mjcompose.tree.unit import line_of
from mjcompose.tree.values import parse_real
from mjcompose.tree.xml_layout import attribute_order
from mjcompose.tree.xml_text import Piece, as_it_is, pieces

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.tree.unit import Unit

INCLUDE = "puts the children of another file's root here"


def offer_tags(question: ModelQuestion) -> Iterator[Item]:
    """Yield the elements that can be at the cursor; in an end tag, the open element."""
    role = question.cursor.role
    path = question.path
    if role == "end" and path:
        rest = question.text[question.offset :].lstrip("abcdefghijklmnopqrstuvwxyz")
        yield Item(str(path[-1]), "element", insert=str(path[-1]) + ("" if rest.startswith(">") else ">"))
    if role not in ("tag", "content"):
        return
    opening = "<" if role == "content" else ""
    if not path:
        yield from (Item(tag, "element", insert=opening + tag) for tag in ("mujoco", "mujocoinclude"))
        return
    for at, (tag, kind) in enumerate(question.children(path).items()):
        yield Item(tag, "element", _versions(kind), doc=kind.doc, rank=10 + at / 1000, insert=opening + tag)
    yield Item("include", "element", "", doc=INCLUDE, rank=20, insert=f'{opening}include file="$0"/>')


def offer_attributes(question: ModelQuestion) -> Iterator[Item]:
    """Yield the attributes that the element at the cursor does not have yet. Required ones come first."""
    cursor = question.cursor
    kind = question.element
    if cursor.role != "key" or kind is None:
        return
    for name, at in attribute_order(kind).items():
        attribute = kind.attributes[name]
        if name not in cursor.written or name == cursor.whole:
            yield Item(
                name,
                "key",
                _form(attribute),
                doc=attribute.doc,
                rank=(10 if attribute.required else 20) + at / 1000,
                insert=name if cursor.has_colon else f'{name}="$0"',
                again=bool(attribute.keywords or attribute.is_reference),
            )


def offer_values(question: ModelQuestion) -> Iterator[Item]:
    """Yield keywords, names, files, and the default of the attribute at the cursor."""
    cursor = question.cursor
    attribute = question.attribute
    if cursor.role != "value":
        return
    around = "" if cursor.quote else '"'
    words = ("true", "false") if attribute is not None and attribute.type == "bool" else ()
    for at, word in enumerate(words if attribute is None or words else attribute.keywords):
        yield Item(word, "word", rank=10 + at / 1000, insert=f"{around}{word}{around}")
    if question.wanted is not None:
        for at, (rank, known) in enumerate(fitting(question.wanted, question.analysis.names, None)):
            shown = f"{around}{known.name}{around}"
            yield Item(known.name, known.namespace, known.detail, rank=10 + rank + at / 10000, insert=shown)
    for at, name in enumerate(_files(question)):
        yield Item(name, "file", rank=10 + at / 10000, insert=f"{around}{name}{around}")
    default = None if attribute is None else default_text(attribute)
    if default is not None and attribute is not None and not attribute.keywords and not words:
        yield Item(default, "constant", "MuJoCo's default", rank=60, insert=f"{around}{default}{around}")


OFFERS = (offer_tags, offer_attributes, offer_values)
_FILES_MOST = 2000


def _folder(question: ModelQuestion) -> Path | None:
    """Return the folder of the files that the value at the cursor can name, or None if it names no file."""
    attribute = question.attribute
    unit = question.analysis.unit
    path = question.analysis.path
    is_include = question.cursor.role == "value" and question.path[-2:] == ("include", "file")
    if not is_include and (attribute is None or attribute.type != "file"):
        return None
    if unit is None or attribute is None or attribute.folder not in ("mesh", "texture"):
        return path.parent if unit is None or is_include else unit.directory
    is_mesh = attribute.folder == "mesh"
    settings = unit.settings
    return unit.directory / (settings.mesh_folder if is_mesh else settings.texture_folder)


def _files(question: ModelQuestion) -> Iterator[str]:
    folder = _folder(question)
    above = question.cursor.word.rpartition("/")[0]
    if folder is None or question.cursor.role != "value" or is_absolute(above) or not os.path.isdir(folder / above):
        return
    for entry in sorted((folder / above).iterdir())[:_FILES_MOST]:
        if not entry.name.startswith(".") and entry != question.analysis.path:
            yield f"{above}/{entry.name}".lstrip("/") + ("/" if os.path.isdir(entry) else "")


def file_at(question: ModelQuestion) -> Iterator[Span]:
    """Yield the start of the file that the value at the cursor names."""
    folder = _folder(question)
    path = None if folder is None else Path(os.path.normpath(folder / question.cursor.whole))
    if path is not None and question.cursor.whole and os.path.isfile(path):
        yield Span(str(path), 1, 1, end_line=1, end_column=1)


def _form(attribute: Attribute) -> str:
    """Return a line about an attribute: its type, its length, and MuJoCo's default."""
    low = attribute.min_length
    high = attribute.max_length
    between = f"{low}" if low == high else f"{low}…{'' if high is None else high}"
    count = f"({between})" if attribute.is_number and between != "1" else ""
    text = default_text(attribute)
    default = f", default {text}" if text is not None else ""
    required = ", required" if attribute.required else ""
    refers = f" to {attribute.refers}" if attribute.refers else ""
    return f"{attribute.type}{count}{refers}{required}{default}"


def _versions(kind: ElementType | Attribute) -> str:
    since = f"since MuJoCo {kind.since}" if kind.since else ""
    until = f"up to MuJoCo {kind.until}" if kind.until else ""
    return ", ".join(filter(None, (since, until)))


def show_attribute(question: ModelQuestion) -> Hover | None:
    """Return the words of the reference about an attribute, the value in effect, and the class that gives it."""
    attribute = question.attribute
    kind = question.element
    if attribute is None or kind is None or not question.cursor.whole:
        return None
    facts = ", ".join(filter(None, (_form(attribute), _versions(attribute))))
    keywords = f"\n\none of {', '.join(f'`{each}`' for each in attribute.keywords)}" if attribute.keywords else ""
    lines = [f"**`{attribute.name}`** of `<{kind.tag}>`: {facts}", "", f"{attribute.doc}{keywords}", ""]
    node = question.node
    unit = question.analysis.unit
    if node is not None and unit is not None and (kind.takes_class or attribute.name in node.attrib):
        lines += effect(node, kind, attribute, unit=unit)
    return Hover("\n".join(lines), question.word)


def effect(node: Node, kind: ElementType, attribute: Attribute, unit: Unit) -> Iterator[str]:
    """Yield the value of an attribute in effect, and the values from the element, its classes and MuJoCo."""
    steps = levels(node, kind, attribute, classes=unit.classes)
    found = value(steps)
    if found is not None:
        yield from (f"value in effect: **`{found}`**", "")
    for step in steps:
        at = "" if step.writer is None else _place(step.writer, attribute.name, unit)
        name = {"element": "this element", "class": f"class `{step.name}`", "mujoco": "MuJoCo's default"}[step.kind]
        if step.text is not None:
            yield f"- {name}: `{step.text}`{at}"
    if kind.takes_class:
        force = class_in_force(node)
        yield f"\nclass `{force.name}`{f', by `{force.attribute}`' if force.attribute else ''}"


def _place(node: Node, attribute: str, unit: Unit) -> str:
    span = unit.origins.span(node, unit.file, attribute)
    return f" ({os.path.basename(span.file)}:{span.line})"


def show_element(question: ModelQuestion) -> Hover | None:
    kind = question.kind((*question.path, question.cursor.whole)) if question.cursor.role == "tag" else None
    if kind is None:
        return None
    about = f"**`<{kind.tag}>`** {_versions(kind)}\n\n{kind.doc}\n"
    unit = question.analysis.unit
    node = question.node
    facts = [] if unit is None or node is None else list(settings(node, unit))
    return Hover("\n".join([about, *facts]), question.word)


def settings(node: Node, unit: Unit) -> Iterator[str]:
    """Yield the values that an element and its classes set, with the class of each."""
    kind = GRAMMAR.root
    for each in (*reversed(list(node.iterancestors())), node)[1:]:
        if str(each.tag) not in kind.children:
            return
        kind = kind.children[str(each.tag)]
    for name in map(str, node.keys()):
        if written(node, name) is not None and len(text := str(node.get(name))) < _LONG:
            yield f"- {name}: `{text}`"
    for attribute, level in given(node, kind, unit.classes):
        where = "" if level.writer is None else _place(level.writer, attribute.name, unit)
        yield f"- {attribute.name}: `{level.text}` from class `{level.name}`{where}"


_LONG = 200
_NAMING = ("name", "key", "file", "joint", "mesh", "site")
SHOWS = (show_attribute, show_element)


def uses(known: Known, unit: Unit) -> Iterator[Span]:
    """Yield the places in the files of a model that refer to a name; in a list, the item."""
    for node, attribute in NameIndex.of(unit.root).users(known.namespace, known.name):
        yield from _items(node, attribute, known.name, unit=unit)


def _items(node: Node, attribute: str, name: str, unit: Unit) -> Iterator[Span]:
    whole = unit.origins.span(node, unit.file, attribute)
    if str(node.get(attribute)) == name:
        yield whole
        return
    file = unit.origins.owner(node, unit.file)
    line = line_of(node)
    text = unit.origins.text(file) if isinstance(file, str) else None
    for at, item in enumerate(str(node.get(attribute)).split()):
        if item == name and text is not None and line is not None:
            of = {str(key): str(each) for key, each in node.items()}
            found = text.items(str(node.tag), line, of, name=attribute, first=at, last=at)
            if found is not None:
                yield Span(
                    str(file), found[0].line, found[0].column, end_line=found[0].line, end_column=found[0].end_column
                )


class RenameRefused(Exception):
    """A reason why a name cannot be changed."""


def renameable(question: ModelQuestion) -> Span | None:
    """Return the name at the cursor, if an element declares or refers to it."""
    fixed = {("body", "world"), ("default", "main")}
    found = [each for each in named_at(question) if (each.namespace, each.name) not in fixed]
    return question.word if found and question.analysis.is_current else None


def rename(question: ModelQuestion, new: str, others: Iterable[tuple[Unit, str]]) -> tuple[Known, list[TextChange]]:
    """Return the changes that a new name needs in the model, and in the `others`, as `including` yields them.

    The changed texts are read again: every other name must mean the same. Raises RenameRefused.
    """
    known = next(iter(named_at(question)), None)
    own = question.analysis.unit
    if renameable(question) is None or known is None or own is None:
        raise RenameRefused("only names of elements can be renamed, if the file has no XML errors")
    if not new or new != new.strip() or re.search(r"""["'<>&\n]""", new) or (known.namespace, new) in ALWAYS:
        raise RenameRefused(f"`{new}` cannot be the name of an element")
    every: dict[TextChange, None] = {}
    for unit, prefix in ((own, ""), *others):
        there = replace(known, name=prefix + known.name)
        now = prefix + new
        changes = _changes(there, now, unit)
        if changes and not _means_the_same(there, now, unit, changes=changes):
            raise RenameRefused(f"`{known.name}` cannot be renamed: other names in `{unit.file}` would change")
        every.update(dict.fromkeys(changes))
    return known, list(every)


def _changes(known: Known, new: str, unit: Unit) -> list[TextChange]:
    index = NameIndex.of(unit.root)
    old = known.name
    node = index.find(known.namespace, old)
    if index.find(known.namespace, new) is not None:
        raise RenameRefused(f"there is a {known.namespace} `{new}` already, in `{unit.file}`")
    if node is not None and declared_by(node) == "file":
        raise RenameRefused(f"`{old}` has its name from its file: give it a `name` first")
    others = (each for names in index.uses.values() for each in names if node is not None and multiplies(node))
    copy = next((each for each in others if is_copy(each, old)), None)
    if copy is not None:
        raise RenameRefused(f"`{copy}` refers to a copy that MuJoCo makes of `{old}`: rename it by hand")
    spans = [] if node is None else [unit.origins.span(node, unit.file, declared_by(node))]
    return [TextChange(span, new) for span in (*spans, *uses(known, unit))]


def _means_the_same(known: Known, new: str, unit: Unit, changes: list[TextChange]) -> bool:
    """Return whether the changed texts are the same model with another name, by reading them again."""
    texts: dict[str, bytes] = {}
    for file, source in unit.origins.texts.items():
        own = changed(source.split().text, [each for each in changes if each.span.file == file])
        texts[os.path.realpath(str(source.path))] = own.encode("utf-8", "replace")
    with unsaved(texts):
        main = texts[os.path.realpath(str(unit.origins.texts[unit.file].path))]
        again = read_unit(main, unit.file, unit.directory)
    expected = unit.copied().root
    index = NameIndex.of(expected)
    node = index.find(known.namespace, known.name)
    if node is not None:
        node.set(declared_by(node), new)
    index.follow(known.namespace, {known.name: new})
    return again is not None and as_it_is(expected) == as_it_is(again.root)


def _spans(text: str, file: str) -> Callable[[int, int], Span]:
    """Return a function for the span between two characters of a text."""
    lines = [0, *(found.end() for found in re.finditer("\n", text))]

    def span(start: int, end: int) -> Span:
        first = bisect_right(lines, start)
        last = bisect_right(lines, end)
        return Span(file, first, start - lines[first - 1] + 1, end_line=last, end_column=end - lines[last - 1] + 1)

    return span


def _symbol(
    piece: Piece, end: int, span: Callable[[int, int], Span], is_section: bool, children: tuple[Symbol, ...]
) -> Symbol:
    values = {attribute.name: attribute.value for attribute in piece.attributes if attribute.value}
    keys = ("class",) if piece.tag == "default" else _NAMING
    name = next((values[key] for key in keys if key in values), "")
    return Symbol(
        name or piece.tag,
        "section" if is_section else "element",
        span(piece.start + 1, piece.start + 1 + len(piece.tag)),
        whole=span(piece.start, end),
        detail=piece.tag if name else "",
        children=children,
    )


def symbols(text: str, analysis: ModelAnalysis) -> list[Symbol]:
    """Return the outline: the elements, by name if they have one."""
    span = _spans(text, analysis.file)
    inside: list[list[Symbol]] = [[]]  # of the file, and of each open element
    opened: list[Piece] = []

    def close(end: int) -> None:
        """End the innermost open element at an offset."""
        children = tuple(inside.pop())
        piece = opened.pop()
        inside[-1].append(_symbol(piece, end, span, is_section=len(opened) < 2, children=children))

    for piece in pieces(text):
        if piece.kind == "start" and piece.tag:
            opened.append(piece)
            inside.append([])
            if piece.closed or not piece.complete:
                close(piece.end)
        elif piece.kind == "end" and any(start.tag == piece.tag for start in opened):
            while opened[-1].tag != piece.tag:
                close(piece.end)
            close(piece.end)
    while opened:
        close(opened[-1].end)
    return inside[0]


_COLOR = re.compile(r".*rgba|rgb\d|markrgb|ambient|diffuse|specular")


def colors(text: str, file: str) -> Iterator[tuple[Span, tuple[float, ...]]]:
    """Yield the values that are colors, as red, green, blue and opacity from 0 to 1."""
    span = _spans(text, file)
    for piece in pieces(text):
        for each in piece.attributes:
            words = (each.value or "").split()
            numbers = [parse_real(word) for word in words]
            is_color = piece.tag == "rgba" or _COLOR.fullmatch(each.name) is not None
            if is_color and len(words) in (3, 4) and all(number is not None and 0 <= number <= 1 for number in numbers):
                red, green, blue, *opacity = (number or 0.0 for number in numbers)
                yield span(each.start, each.end), (red, green, blue, *(opacity or (1.0,)))
