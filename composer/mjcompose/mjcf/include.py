"""The contents of one model in another, without a prefix."""

from __future__ import annotations

import copy
import os
import posixpath
from collections.abc import Callable, Iterator, Mapping
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span, call_site, warn
from mjcompose.base.sink import Sink
from mjcompose.mjcf.asset import Asset, add_files, asset_of, place_asset
from mjcompose.mjcf.attributed import Attributed, view
from mjcompose.mjcf.errors import MjcfWarning, raise_errors
from mjcompose.mjcf.model import AttachedModel, ModelState
from mjcompose.mjcf.value import describe
from mjcompose.tree.files import NAMED_AFTER_FILE, SourceSettings, file_attributes, join
from mjcompose.tree.names import own_name, word
from mjcompose.tree.unit import FileText, Origins, Unit, counterpart
from mjcompose.tree.values import items, parse_real


def duplicate(model: ModelState, memo: dict[int, Any] | None = None) -> ModelState:
    """Return an unattached copy of a model with everything attached to it; `memo` gets the copy of each root."""
    twin = ModelState(model.unit.copied())
    if memo is not None:
        memo[id(view(model, model.unit.root))] = view(twin, twin.unit.root)
    for (node, attribute), awaited in model.awaited.items():
        if model.has(node) and model.frame_above(node) is None:
            twin.awaited[counterpart(node, model.unit.root, twin.unit.root), attribute] = awaited
    for attachment in model.attachments.values():
        child = duplicate(attachment.child, memo)
        frame = copy.deepcopy(attachment.frame)
        host = counterpart(attachment.host, model.unit.root, twin.unit.root)
        child.hung = twin.attachments[child.prefix] = AttachedModel(twin, child, host, frame=frame)
        twin.unit.origins.owners.update(model.unit.origins.carried(attachment.frame, frame).owners)
        for joint in frame:
            twin.note(joint)
    return twin


def copied(element: Attributed, memo: dict[int, Any]) -> Any:
    """Return the element's counterpart in the copy of its model. The model is copied unless `memo` has the copy."""
    model = element._alive()._model
    twin = copy.deepcopy(view(model, model.unit.root), memo)._model
    frame = model.frame_above(element._node)
    if frame is None:
        return view(twin, counterpart(element._node, model.unit.root, twin.unit.root))
    there = twin.attachments[model.attachment_of(frame).child.prefix].frame
    return view(twin, counterpart(element._node, frame, there))


Reduced = tuple[Callable[..., Attributed], tuple[Any, ...]]


class _Tree(Struct):
    """A node with its subtree: its text and, for each node, its line and its origin."""

    text: bytes
    lines: list[int]
    owners: dict[int, str | Span]

    @classmethod
    def of(cls, node: Node, origins: Origins) -> _Tree:
        nodes = list(node.iter())
        owners: dict[int, str | Span] = {}
        for at, each in enumerate(nodes):
            owner = origins.owners.get(each)
            if owner is not None:
                owners[at] = owner if isinstance(owner, str | Span) else owner(None)
        lines: list[Any] = [each.sourceline for each in nodes]
        return cls(etree.tostring(node, with_tail=False), [line or 0 for line in lines], owners)

    def restored(self, origins: Origins) -> Node:
        node = etree.fromstring(self.text, etree.XMLParser(huge_tree=True, remove_blank_text=False))
        nodes = list(node.iter())
        for each, line in zip(nodes, self.lines, strict=True):
            each.sourceline = line
        for at, owner in self.owners.items():
            origins.own(nodes[at], owner)
        return node


class _Attached(Struct):
    """An attachment: the attached model, its frame, and the index of its host among all nodes of the parent."""

    child: _Composition
    frame: _Tree
    host: int


class _Composition(Struct):
    """A model and all its attachments; comments in the model's header are stored by their places below the root.

    `kept` has the fields of its unit that can be pickled directly.
    """

    tree: _Tree
    header: list[int]
    kept: dict[str, Any]
    texts: dict[str, FileText]
    attached: list[_Attached]

    @classmethod
    def of(cls, model: ModelState) -> _Composition:
        unit = model.unit
        places = {node: at for at, node in enumerate(unit.root.iter())} if model.attachments else {}
        attached = [
            _Attached(cls.of(each.child), _Tree.of(each.frame, unit.origins), places[each.host])
            for each in model.attachments.values()
        ]
        kept = {name: getattr(unit, name) for name in ("file", "directory", "label", "contents", "door")}
        header = list(map(unit.root.index, unit.header))
        return cls(_Tree.of(unit.root, unit.origins), header, kept, texts=unit.origins.texts, attached=attached)

    def restored(self) -> ModelState:
        origins = Origins(texts=self.texts)
        root = self.tree.restored(origins)
        header = tuple(root[at] for at in self.header)
        model = ModelState(Unit(root, origins=origins, header=header, **self.kept))
        nodes = list(root.iter()) if self.attached else []
        for each in self.attached:
            child = each.child.restored()
            frame = each.frame.restored(origins)
            child.hung = model.attachments[child.prefix] = AttachedModel(model, child, nodes[each.host], frame=frame)
            for joint in frame:
                model.note(joint)
        return model


def pickled_element(element: Attributed) -> Reduced:
    """Return the pickled form of an element: the whole composition, and the position of the element in it."""
    model = element._alive()._model
    if element._node is model.unit.root:
        if model.hung is None:
            return _root, (_Composition.of(model),)
        return _attached, (view(model.hung.parent, model.hung.parent.unit.root), model.prefix)
    root = view(model, model.unit.root)
    frame = model.frame_above(element._node)
    top = model.unit.root if frame is None else frame
    place = next(at for at, node in enumerate(top.iter()) if node is element._node)
    return _element, (root, None if frame is None else model.attachment_of(frame).child.prefix, place)


def _root(state: _Composition) -> Any:
    model = state.restored()
    return view(model, model.unit.root)


def _attached(parent: Attributed, prefix: str) -> Any:
    child = parent._model.attachments[prefix].child
    return view(child, child.unit.root)


def _element(root: Attributed, prefix: str | None, place: int) -> Any:
    model = root._model
    top = model.unit.root if prefix is None else model.attachments[prefix].frame
    return view(model, next(node for at, node in enumerate(top.iter()) if at == place))


def take_model(model: ModelState, source: Unit, element: Node) -> None:
    """Let a moved `<model>` name the same file. A file in memory is copied with its folder, to which it may refer."""
    file = join("", str(element.get("file")))
    beside = posixpath.dirname(file)
    stem, suffix = posixpath.splitext(file)
    in_memory = isinstance(source.contents.get(file), bytes)
    theirs: dict[str, bytes | Path] = {file: source.source_of(file)}
    if in_memory:
        inside = (path for path in source.contents if not beside or path.startswith(f"{beside}/"))
        theirs = {path: source.contents[path] for path in (*inside, file)}

    def renamed(path: str, number: int) -> str:
        if number == 1:
            return path
        return f"{source.label}-{number}/{path}" if in_memory else f"{stem}-{number}{suffix}"

    tries = ((n, {renamed(path, n): content for path, content in theirs.items()}) for n in count(1))
    number, files = next((n, files) for n, files in tries if _are_free(model, files))
    element.set("file", renamed(file, number))
    add_files(model, files)


def _are_free(model: ModelState, files: dict[str, bytes | Path]) -> bool:
    """Return whether none of these paths is used by a different file."""
    directory = str(model.unit.directory)
    known = dict(model.unit.contents)
    there = {path: Path(join(directory, path)) for path in files}
    held = {path: known.get(path, at if os.path.exists(at) else files[path]) for path, at in there.items()}
    return held == files


_SETTINGS = ("compiler", "option", "size", "visual", "statistic")
# Settings by which MuJoCo reads a model's own elements, so defaults that nobody writes count as well.
_READ_BY = ("compiler", "default")
_OVERRIDE = (
    "make the two agree, pass `override=True`, which takes the other's setting, or `attach` the other: an attached"
    " model keeps its own"
)
_FOLDERS = frozenset({"meshdir", "texturedir", "assetdir", "strippath"})


_Place = tuple[tuple[str, ...], str]  # the path of an element, and an attribute of it


class _Setting(NamedTuple):
    """A setting that a model has only once: its place and its value."""

    path: tuple[str, ...]
    attribute: str
    value: str
    node: Node


def include_copy(model: ModelState, other: ModelState, override: bool) -> None:
    """Copy the contents of `other` into `model`. See `RootElement.include_copy`."""
    source = duplicate(other)
    sink = Sink()
    overridden: list[str] = []
    if override:
        overridden = _overridden(model, other, source)
    else:
        _report_conflicts(model, other, source, sink=sink)
    _check_names(model, source, other, sink=sink)
    raise_errors(sink)
    for message in overridden:
        warn(message, MjcfWarning)
    files = _files(source)
    models = list(source.unit.root.iterfind("asset/model[@file]"))
    _copy_settings(model, source)
    moved = list(_move(model, source))
    contents: dict[str, bytes | Path] = {}
    for node, attribute, asset in files:
        node.set(attribute, place_asset(model, str(node.tag), asset, contents=contents))
    add_files(model, contents)
    for node in models:
        take_model(model, source.unit, node)
    for top in moved:
        for node in top.iter("*"):
            model.note(node)
    model.unit.forget_classes()
    _take_attachments(model, source)


def _report_conflicts(model: ModelState, other: ModelState, source: ModelState, sink: Sink) -> None:
    """Report the settings that differ. `source` is the copy of `other`."""
    for conflict in _conflicts(model, source):
        path = "/".join(conflict.path)
        names = f"`{model.name}` and `{other.name}`"
        message = f"`{path}` has `{conflict.attribute}`, which is not the same in {names}"
        pair = (model, conflict.mine), (source, conflict.theirs)
        shown = [(each.name, its and f"`{its.value}`", its and each.span(its.node)) for each, its in pair]
        notes = [Note(f"`{name}` has {value or 'none'}", span) for name, value, span in shown]
        sink.error("option-conflict", message, call_site(), notes=notes, help=_OVERRIDE)


def _overridden(model: ModelState, other: ModelState, source: ModelState) -> list[str]:
    """Return in words the settings that change the elements of one of the models. `source` is the copy of `other`."""
    messages = []
    for conflict in _conflicts(model, source):
        if conflict.path[0] in _READ_BY:
            path = "/".join(conflict.path)
            winner = model if conflict.theirs is None else other
            why = f"the setting of `{winner.name}` now applies to the elements of both"
            differs = f"`{conflict.attribute}` of `{path}` is not the same in `{model.name}` and `{other.name}`"
            messages.append(f"{differs}: {why}")
    return messages


def _copy_settings(model: ModelState, source: ModelState) -> None:
    for setting in _settings(source.unit.root):
        if setting.attribute in _FOLDERS and setting.path == ("compiler",):
            continue
        place = model.section(setting.path[0])
        for tag in setting.path[1:]:
            place = model.only_child(place, tag)
        place.set(setting.attribute, setting.value)


def _take_attachments(model: ModelState, source: ModelState) -> None:
    for prefix, attachment in source.attachments.items():
        if attachment.host.getparent() is source.unit.root:
            attachment.host = model.section(str(attachment.host.tag))
        attachment.parent = model
        model.attachments[prefix] = attachment
        for node in attachment.frame.iter("*"):
            if node in source.unit.origins.owners:
                model.unit.origins.own(node, source.unit.origins.owners[node])
            model.note(node)


class _Conflict(NamedTuple):
    """A setting that differs between two models, with its place in each, or None if it is not written."""

    path: tuple[str, ...]
    attribute: str
    mine: _Setting | None
    theirs: _Setting | None


def _conflicts(model: ModelState, source: ModelState) -> Iterator[_Conflict]:
    """Yield the settings that differ, and the settings that would change the meaning of elements of either model."""
    mine = {(each.path, each.attribute): each for each in _settings(model.unit.root)}
    theirs = {(each.path, each.attribute): each for each in _settings(source.unit.root)}
    both_have_elements = _has_elements(model.unit.root) and _has_elements(source.unit.root)
    for key in {**mine, **theirs}:
        path, attribute = key
        if path == ("compiler",) and attribute in _FOLDERS:
            continue
        # A setting of only one model changes the other if that has elements which read it.
        is_read = both_have_elements and path[0] in _READ_BY
        if not is_read and (key not in mine or key not in theirs):
            continue
        if not _are_same(_meant(mine, key), _meant(theirs, key)):
            yield _Conflict(path, attribute, mine.get(key), theirs=theirs.get(key))


def _meant(written: Mapping[_Place, _Setting], key: _Place) -> str | None:
    """Return the value of a setting, which has a default if it is one of `<compiler>`."""
    if key in written:
        return written[key].value
    path, attribute = key
    return getattr(SourceSettings(), attribute, None) if path == ("compiler",) else None


def _check_names(model: ModelState, source: ModelState, other: ModelState, sink: Sink) -> None:
    top = model.top
    prefix = model.full_prefix
    for namespace, names in source.names.declared.items():
        for name, node in names.items():
            taken = top.lookup(namespace, prefix + name)
            if taken is not None:
                code = "class-clash" if namespace == "default" else "name-clash"
                message = f"both `{model.name}` and `{other.name}` have {word(namespace, article=True)} `{name}`"
                note = Note(f"{describe(taken.model, taken.node)} is here", taken.model.span(taken.node))
                notes = (note, Note("the other is here", source.span(node)))
                sink.error(code, message, call_site(), notes=notes, help="rename one of the two, or `attach` the other")
    for attached in source.attachments.keys() & model.attachments.keys():
        help = "give one of the two another name first: `child.model = '…'`"
        sink.error("name-clash", f"models called `{attached[:-1]}` are attached to both", call_site(), help=help)


def _settings(root: Node) -> Iterator[_Setting]:
    """Yield the settings that a model has only once, including its top class's settings."""
    nodes = [node for section in root.iterchildren(*_SETTINGS) for node in section.iter("*")]
    nodes += [node for node in root.iterfind("default/*") if node.tag != "default"]
    for node in nodes:
        path = tuple(str(each.tag) for each in [node, *node.iterancestors()][-2::-1])
        yield from (_Setting(path, str(name), str(value), node=node) for name, value in node.items())


def _move(model: ModelState, source: ModelState) -> Iterator[Node]:
    """Move everything that is not a setting to `model`, and yield the moved nodes."""
    origins = model.unit.origins
    for section in list(source.unit.root.iterchildren("*")):
        tag = str(section.tag)
        if tag in _SETTINGS:
            continue
        into = model.section(tag)
        for name, value in section.items():
            into.set(name, value)
        for child in list(section.iterchildren(*(["default"] if tag == "default" else ["*"]))):
            owner = source.unit.origins.owner(child, source.unit.file)
            into.append(child)
            origins.own(child, owner)
            yield child
    for node, owner in source.unit.origins.owners.items():
        origins.owners.setdefault(node, owner)
    for file, text in source.unit.origins.texts.items():
        origins.texts.setdefault(file, text)


def _files(source: ModelState) -> list[tuple[Node, str, Asset]]:
    """Return node, attribute and asset of each file; an element named after its file gets that name as `name`."""
    found = []
    for node, attribute, name in file_attributes(source.unit.root):
        found.append((node, attribute, asset_of(source, str(node.tag), name)))
        if attribute == "file" and node.tag in NAMED_AFTER_FILE and not node.get("name"):
            node.set("name", own_name(node, "name") or posixpath.basename(name))
    return found


def _has_elements(root: Node) -> bool:
    return any(len(section) for section in root.iterchildren("*") if section.tag not in (*_SETTINGS, "default"))


def _are_same(a: str | None, b: str | None) -> bool:
    if a is None or b is None:
        return a is b
    numbers = [[parse_real(item) for item in items(text)] for text in (a, b)]
    return numbers[0] == numbers[1] if None not in (*numbers[0], *numbers[1]) else a.split() == b.split()
