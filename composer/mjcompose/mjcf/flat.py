"""Turn a composition into one flat model; its models do not change."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import cast, get_args

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Diagnostic, Note, warn
from mjcompose.base.naming import is_portable
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.link.boundaries import has_crossings
from mjcompose.link.collect import collect, read
from mjcompose.link.files import ASSETS, is_settled
from mjcompose.link.link import finish, link, link_alone
from mjcompose.link.linking import FileUse, Linking, LinkRequest, ModelMeasure, Policy
from mjcompose.link.measure import measure_with
from mjcompose.link.settings import FOLDERS
from mjcompose.link.unit_keys import layouts
from mjcompose.mjcf.errors import MjcfError, MjcfWarning, failure, raise_errors
from mjcompose.mjcf.model import UNNAMED, ModelState
from mjcompose.mjcf.mounting import Mounting, without_outward
from mjcompose.mjcf.value import describe, describe_target
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tree.classes import says_something
from mjcompose.tree.edit import resolves, unresolved
from mjcompose.tree.files import CUBE, NAMED_AFTER_FILE, file_attributes, is_plain, stem
from mjcompose.tree.names import UP, Use, word
from mjcompose.tree.select import HOLDS_ONE_OF_EACH, section_of, spoken
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import as_it_is, to_text, write


def prune(unit: Unit) -> None:
    """Remove the empty elements from the tree of a model."""
    for node in list(empty_elements(unit)):
        while _is_empty(node) and (parent := node.getparent()) is not None:
            parent.remove(node)
            node = parent


def empty_elements(unit: Unit) -> Iterator[Node]:
    """Yield the empty sections and, in sections that hold one child of each tag, the empty elements below them."""
    for section in unit.root.iterchildren("*"):
        if section.tag in HOLDS_ONE_OF_EACH:
            for node in filter(_is_empty, section.iter("*")):
                # Elements without a line and an owner were created on access.
                is_written = cast(int | None, node.sourceline) is not None or node in unit.origins.owners
                if section.tag != "default" or not (says_something(node) and is_written):
                    yield node
        elif _is_empty(section):
            yield section


def _is_empty(node: Node) -> bool:
    return not len(node) and not node.keys()


def with_unique_names(files: Sequence[FileUse]) -> list[tuple[FileUse, str]]:
    """Return each file with a path. No two paths end in the same file name. Sub-models use these paths too."""
    taken: dict[str, str] = {}
    names: dict[str, str] = {}
    for path in dict.fromkeys(use.path for use in files):
        folder, _, base = path.rpartition("/")
        start, suffix = posixpath.splitext(base)
        number = 1
        name = base
        while taken.setdefault(name.lower(), path) != path:
            number += 1
            name = f"{start}-{number}{suffix}"
        names[path] = f"{folder}/{name}"
    return [(_with_file_names(use, names) if _is_model(use) else use, names[use.path]) for use in files]


def is_inner(use: FileUse, files: Iterable[FileUse]) -> bool:
    """Return whether a file is used by a sub-model and not by the model itself."""
    folders = tuple(f"{each.path.removesuffix('.xml')}/" for each in files if _is_model(each))
    return not use.shared and use.path.startswith(folders)


def rename_file(element: Node, attribute: str, file: str) -> None:
    """Set the file path of an element. If the element is named after its file, it keeps that name."""
    if attribute == "file" and element.tag in NAMED_AFTER_FILE and not element.get("name"):
        element.set("name", stem(str(element.get("file"))))
    element.set(attribute, file)


def _is_model(use: FileUse) -> bool:
    return not use.shared and use.path.endswith(".xml")


def _with_file_names(model: FileUse, names: Mapping[str, str]) -> FileUse:
    """Return the sub-model with the new names of its files, which are relative to its own folder."""
    start = f"{posixpath.dirname(model.path)}/"
    folder = f"{model.path.removesuffix('.xml')}/"
    changed = {
        path.removeprefix(start): name.removeprefix(start)
        for path, name in names.items()
        if path != name and path.startswith(folder)
    }
    if not changed or model.content is None:
        return model
    root = etree.fromstring(model.content)
    for element in root.iter("*"):
        for attribute in ("file", *CUBE):
            new = changed.get(str(element.get(attribute)))
            if new is not None:
                rename_file(element, attribute, new)
    return model._replace(content=write(root))


_FILE = ' file="'
_COMPILER = "<compiler"


def relocated_text(model: ModelState, label: str) -> str | None:
    """Return the text that the linker would give for the model alone, or None if more than folders would change.

    Text is only replaced if it occurs as often in the text as in the tree, so a comment that looks like an attribute is
    never replaced by mistake.
    """
    unit = model.unit
    if model.attachments or unit.contents or has_crossings(unit):
        return None
    if not re.fullmatch(r"[\w.-]+", label) or not is_portable(label):
        return None
    files = _plain_files(unit)
    if files is None or next(empty_elements(unit), None) is not None:
        return None
    text = to_text(unit.root)
    moving, staying = files
    if moving and (staying or text.count(_FILE) != moving):
        return None
    return _without_folders(unit, text.replace(_FILE, f"{_FILE}{ASSETS}/{label}/") if moving else text)


def _plain_files(unit: Unit) -> tuple[int, int] | None:
    """Return the numbers of files that move to the label's folder and that stay, or None if they are unknown."""
    files = list(file_attributes(unit.root))
    odd = any(attribute != "file" or each.tag == "skin" or not is_plain(name) for each, attribute, name in files)
    names = {name[name.rfind("/") + 1 :].lower() for _, _, name in files}
    if odd or len(names) < len(files) or unit.root.find("asset/model") is not None:
        return None
    staying = sum(name.startswith(ASSETS) and is_settled(unit, each.tag, name) for each, _, name in files)
    return len(files) - staying, staying


def _without_folders(unit: Unit, text: str) -> str | None:
    compilers = list(unit.root.iterchildren("compiler"))
    if not compilers:
        return text
    compiler = compilers[0]
    if len(compilers) > 1 or len(compiler) or compiler.text or text.count(_COMPILER) > 1:
        return None
    if compiler.get("strippath") is not None or next(unit.root.iterchildren("*")) is not compiler:
        return None
    kept = {str(name): str(value) for name, value in compiler.items() if name not in FOLDERS}
    if not kept:
        return None
    start = text.index(_COMPILER)
    end = text.index("/>", start)
    return text[:start] + to_text(compiler.makeelement("compiler", kept)).rstrip()[:-2] + text[end:]


_SHOWN = 20


def check_references(model: ModelState, sink: Sink) -> None:
    """Report each name that is referred to but does not exist, with all elements that refer to it.

    References in default classes are not checked. A name that MuJoCo may generate itself, such as the names of a
    `replicate`'s copies, is accepted.
    """
    for each in model.composition():
        for (node, attribute), (target, text) in each.awaited.items():
            if node.get(attribute) == text and each.has(node):
                refers = f"{describe(each, node)} refers by `{spoken(attribute)}` to {describe_target(target)}"
                message = f"{refers} of the model `{target.model.name}`, which is not attached to `{model.name}`"
                sink.error("unknown-name", message, each.span(node), help="attach it")
        depth = 0 if each is model else 1 + [*each.ancestors()].index(model)
        for namespace, uses in each.names.uses.items():
            declared = each.names.declared.get(namespace, {})  # has most of them, so it comes first
            for name, users in uses.items():
                is_reported = each.awaited and each.awaited.keys() >= users.keys()
                if name in declared or namespace == "key" or is_reported:
                    continue
                # A model that is written without the models above it has none of their elements.
                if not name.startswith(UP * (depth + 1)) and resolves(each, namespace, name):
                    continue
                heeded = [use for use in users if section_of(use[0]) != "default"]
                if heeded:
                    _report(each, namespace, name, users=heeded, sink=sink)


def _report(model: ModelState, namespace: str, name: str, users: list[Use], sink: Sink) -> None:
    notes = [
        Note(f"{describe(model, node)} refers to it by `{spoken(attribute)}`", model.span(node))
        for node, attribute in users[:_SHOWN]
    ]
    if len(users) > _SHOWN:
        notes.append(Note(f"and {len(users) - _SHOWN} more"))
    first = users[0][0]
    outside = model
    inner = name
    while inner.startswith(UP) and outside.hung is not None:
        outside = outside.hung.parent
        inner = inner[len(UP) :]
    help = "`../` is the model that this one is attached to" if name.startswith(UP) else None
    if namespace == "body" and any(not rest for _, rest in outside.split(inner)):
        help = "the attachment frame is a body only once it has a joint"
    message = f"{describe(model, first)} refers to the {word(namespace)} `{name}`, which does not exist"
    several = notes if len(users) > 1 else ()
    sink.add(unresolved(model, namespace, name, span=model.span(first), message=message, help=help, notes=several))


# The linker's advice is for recipes; this is advice for Python.
_HELP = {
    "option-conflict": "make the two agree, or pass `conflict='base'`, which keeps the model's own "
    "value and reports it, or `conflict='mujoco'`",
    "freejoint-on-body": "remove the free joint, or attach the model to the worldbody",
    "mocap-on-body": "attach the model to the worldbody",
    "plane-on-body": "remove the plane, or attach the model to something that does not move",
    **dict.fromkeys(("name-clash", "class-clash"), "rename one of the two, or the attached model: `child.model = '…'`"),
    "keyframe-conflict": "a key has the numbers of its own model; an attached model has its own keys",
    "not-supported": None,
}


class Flat(Struct):
    """One model without attachments, the files it names, and the warnings from linking.

    `is_measured` is set if MuJoCo computed values, which depend on the bytes of files.
    """

    unit: Unit
    files: list[FileUse]
    warnings: list[Diagnostic]
    is_measured: bool


def copy_unit(model: ModelState) -> Unit:
    """Return a copy of the model's unit, which the linker may change."""
    unit = model.unit.copied()
    unit.label = label(model)
    if unit.file == UNNAMED:
        unit.file = model.name
    return unit


def label(model: ModelState) -> str:
    """Return the name of the folder for a model's files."""
    known = model.unit.label
    return re.sub(r"[^\w.-]+", "_", model.name) if known == UNNAMED or not known else known


def flatten(model: ModelState, conflict: Policy, copy: Callable[[ModelState], Unit] = copy_unit) -> Flat:
    """Link a model and everything attached to it, from units of `copy`. Raises `MjcfError` with the faults."""
    _check(model, conflict)
    return link_checked(model, conflict, copy, check_keys=True)


def link_checked(model: ModelState, conflict: Policy, copy: Callable[[ModelState], Unit], *, check_keys: bool) -> Flat:
    """Link a model whose references have been checked. Raises MjcfError.

    With `check_keys`, it is also raised for keyframes that do not fit.
    """
    sink = _NamesChecked()
    mounting = Mounting(model, copy)
    for unit in mounting.units:
        prune(unit)
    parts = mounting.parts()
    outward = (name for part in parts for name in part.outward.values())
    prefixes = (UP, *(part.prefix for part in parts), *outward)
    started: list[ModelMeasure] = []
    with ExitStack() as ending:

        def measure(unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
            """Measure values of a unit alone in a process of MuJoCo, which starts with the first call."""
            if not started:
                started.append(measure_with(Context(sink), session=ending.enter_context(Session())))
            return started[0](without_outward(unit, prefixes), arrays, attempt=attempt)

        measured = measure if parts else None
        linking = Linking(mounting.base, parts, sink, request=LinkRequest(conflict=conflict), measure=measured)
        if not parts:
            if check_keys:
                layouts(linking)
            link_alone(linking)
            if check_keys:
                finish(linking)
        else:
            linking.notes.nameless.update(mounting.named)
            link(linking)
            if not sink.has_errors:
                finish(linking)
            mounting.clear_up()
            prune(linking.base)
    if sink.has_errors:
        raise MjcfError(map(_for_python, sink.errors))
    return Flat(linking.base, linking.files, list(map(_for_python, sink.diagnostics)), is_measured=bool(started))


def _check(model: ModelState, conflict: Policy) -> None:
    """Raise `MjcfError` if `conflict` is not a policy, or if the target of a reference does not exist."""
    if conflict not in get_args(Policy):
        words = ", ".join(f"`{word}`" for word in get_args(Policy))
        raise failure("wrong-keyword", f"`conflict` is one of {words}, got `{conflict}`")
    names = Sink()
    check_references(model, names)
    raise_errors(names)


def issue_warnings(warnings: list[Diagnostic]) -> None:
    """Issue the warnings from linking as `MjcfWarning`s, at the line of the caller's program."""
    for each in warnings:
        warn(render(each), MjcfWarning)


def text(model: ModelState, conflict: Policy) -> str:
    """Return the composition as MJCF text. See `RootElement.to_xml_string`."""
    state = _state(model, conflict) if model.attachments else None
    if model.written is not None and model.written[0] == state:
        _, found, warnings = model.written
        issue_warnings(warnings)
        return found
    _check(model, conflict)
    known = relocated_text(model, label(model))
    if known is not None:
        return known
    flat = link_checked(model, conflict, copy_unit, check_keys=False)
    name_files(flat)
    issue_warnings(flat.warnings)
    found = to_text(flat.unit.root)
    model.written = None if state is None or flat.is_measured else (state, found, flat.warnings)
    return found


def _state(model: ModelState, conflict: Policy) -> list[object] | None:
    """Return everything that the text of a composition depends on, without linking; None if it has files on disk."""
    state: list[object] = [conflict]
    folders: dict[str, Path] = {}
    for each in model.composition():
        unit = each.unit
        root = each.unit.root
        # Files of one path are the same where links say so, and a skin is read to give its bodies other names.
        if folders.setdefault(label(each), unit.directory) != unit.directory or unit.contents:
            return None
        if next(root.iter("skin", "model", "attach"), None) is not None:
            return None
        hung = [
            (prefix, root.getroottree().getelementpath(to.host), as_it_is(to.frame))
            for prefix, to in each.attachments.items()
        ]
        awaited = [(text, *target) for target, text in each.awaited.values()]
        state.append((as_it_is(root), unit.file, label(each), unit.directory, unit.door, hung, awaited))
    return state


def name_files(flat: Flat) -> None:
    """Write the file names of `contents` into the model. If no file name repeats, keep the linker's paths."""
    bases = {use.path[use.path.rfind("/") :].lower() for use in flat.files}
    if len(bases) == len(flat.files):
        return
    for use, name in with_unique_names(flat.files):
        if name != use.path and not is_inner(use, flat.files):
            rename_file(use.element, use.attribute, name)


def assets(model: ModelState) -> dict[str, bytes]:
    """Return the bytes of the composition's files by name. See `RootElement.assets`."""
    return contents(flatten(model, "base"))


def contents(flat: Flat) -> dict[str, bytes]:
    """Return the bytes of a model's files by the names from `name_files`. Raises `MjcfError` for unreadable files."""
    found: dict[str, bytes] = {}
    sink = Sink()
    for use, name in with_unique_names(flat.files):
        if name not in found:
            found[name] = read(flat.unit, use, sink) or b""
    raise_errors(sink)
    return found


def bundle_paths(model: ModelState) -> dict[bytes | Path, str]:
    """Return the path of each file in an export, by the file's source path or its bytes. Raises `MjcfError`."""
    flat = flatten(model, "base")
    sink = Sink()
    collect(flat.unit, flat.files, sink)
    raise_errors(sink)
    found: dict[bytes | Path, str] = {}
    for use in flat.files:
        path = str(use.element.get(use.attribute))
        found.setdefault(Path(use.source), path)
        if use.content is not None:
            found.setdefault(use.content, path)
    return found


class _NamesChecked(Sink):
    """Drops errors about names, because the linker checks them unit by unit, but here references cross models."""

    def add(self, diagnostic: Diagnostic, cause: Cause | None = None) -> None:
        if diagnostic.code != "unknown-name":
            super().add(diagnostic, cause)


def _for_python(diagnostic: Diagnostic) -> Diagnostic:
    is_error = diagnostic.severity == "error" and diagnostic.help is not None
    return replace(diagnostic, help=_HELP.get(diagnostic.code, diagnostic.help) if is_error else None)
