"""Compile a bundle in MuJoCo, and report the verdict at places in the recipe and its sources."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from itertools import takewhile
from pathlib import Path
from posixpath import basename

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Diagnostic, Span
from mjcompose.base.scratch import scratch
from mjcompose.base.words import tag_text
from mjcompose.bundle.bundle import MANIFEST, Bundle, OutputError, writing
from mjcompose.bundle.read import files_outside
from mjcompose.bundle.staging import write_files
from mjcompose.link.existence import existence_faults
from mjcompose.mujoco import engine, messages
from mjcompose.mujoco.engine import Compiled, Session
from mjcompose.sources.context import Context
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.files import NAMED_AFTER_FILE
from mjcompose.tree.grammar import GRAMMAR, version_key
from mjcompose.tree.unit import Unit, element_at
from mjcompose.tree.xml_faults import ignored, is_unread_alone, unread

_MOVING = frozenset({"pos", *ORIENTATIONS})


def unmoved_flexes(root: Node, mujoco: str | None) -> Iterator[Node]:
    """Yield the flexes inside posed frames if this version of MuJoCo ignores these poses. No I/O."""
    if mujoco is None or version_key(mujoco) >= (4,):
        return
    for flex in root.iter("flexcomp"):
        around = takewhile(lambda each: each.tag in ("frame", "replicate"), flex.iterancestors())
        if any(each.tag == "frame" and not _MOVING.isdisjoint(each.keys()) for each in around):
            yield flex


def compile_and_report(
    bundle: Bundle, model: Unit, context: Context, *, session: Session, keep: str | None = None, at: Span | None = None
) -> Compiled | None:
    """Compile the bundle, keep it as `keep`, and report faults, by default at `at`. Return None without a verdict."""
    try:
        verified = verify(bundle, session=session, keep=keep)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    for warning in verified.warnings:
        element = _element(warning, bundle, model)
        attribute = None if element is None else messages.translate(warning.message, element).attribute
        span = None if element is None else model.origins.span(element, model.file, attribute)
        said = _with_sources(warning.message, model, context)
        context.sink.warning("mujoco-warning", f"MuJoCo warns: {said}", span, cause=Cause(said, _words_for(element)))
    if verified.error is not None:
        fault = verified.error
        message = _with_sources(fault.message, model, context)
        if verified.crash:
            context.sink.error(verified.code, message, at, help=messages.CRASH_HELP.get(verified.code))
        else:
            element = _element(fault, bundle, model)
            messages.report(messages.translate(message, element), element, model, context=context, at=at)
        return None
    if verified.compiled.names is not None:
        context.sink.extend(existence_faults(model, verified.compiled.names))
    version = verified.compiled.mujoco_version
    # A newer version may have more attributes.
    if version is None or version_key(version) <= version_key(GRAMMAR.versions[-1]):
        for element, name in unread(model.root, version):
            _report_unread(element, name, model, context=context)
    for flex in unmoved_flexes(model.root, version):
        message = f"MuJoCo {version} ignores the frame around the flex `{flex.get('name')}`"
        help = "build with MuJoCo 4.0, which moves it, or put it into a body"
        span = model.origins.span(flex, model.file)
        cause = Cause("left behind", _words_for(flex))
        context.sink.warning("not-supported", message, span, help=help, cause=cause)
    return verified.compiled


def _words_for(element: Node | None) -> str:
    if element is None:
        return "the model"
    return tag_text(str(element.tag), element.get("name"))


def _report_unread(element: Node, name: str | None, model: Unit, context: Context) -> None:
    """Warn if MuJoCo ignores it in the source too; else report an error, because MuJoCo refuses the source alone."""
    if is_unread_alone(element, name, model):
        context.sink.add(ignored(element, name, model))
        return
    file = model.origins.span(element, model.file).file
    found = messages.unknown_element(element, file) if name is None else messages.unknown_attribute(element, name, file)
    cause = Cause(f"{element.tag} {name or ''}", _words_for(element))
    messages.report(found, element, model, context=context, cause=cause)


def _element(fault: messages.EngineMessage, bundle: Bundle, model: Unit) -> Node | None:
    """Return the element that a message is about: by the line, a plugin instance, a unique name or a setting."""
    if fault.line is not None:
        found = element_at(model.root, bundle.files[bundle.model], fault.line)
        return _attaching(fault, model.root) if _is_another(found, fault) else found
    sentence = messages.read_sentence(fault.message)
    if sentence.plugin is not None:
        instances = model.root.findall("extension/plugin/instance")  # the first ones; others have no name
        return instances[sentence.plugin] if sentence.plugin < len(instances) else None
    elements = _with_name(model.root, fault.name or "") or _with_file(model.root, sentence.names)
    if not elements and sentence.array is not None:
        elements = list(model.root.iter(sentence.array.partition("_")[0]))
    if not elements and sentence.section is not None:
        elements = model.root.findall(sentence.section)
    return elements[0] if len(elements) == 1 else None


def _with_name(root: Node, name: str) -> list[Node]:
    """Return the elements with a name that a message has, or else those whose copies can have it."""
    if not name:
        return []
    named = [element for element in root.iter("*") if element.get("name") == name]
    if named:
        return named
    # MuJoCo numbers the names of copies.
    copied = [(element, str(element.get("name") or name)) for element in root.iterfind(".//replicate//*")]
    return [element for element, own in copied if name.startswith(own) and name.removeprefix(own)[-1:].isdigit()]


def _with_file(root: Node, names: Collection[str]) -> list[Node]:
    return [
        element for element in root.iter("*") if element.get("file") and basename(str(element.get("file"))) in names
    ]


def _is_another(found: Node | None, fault: messages.EngineMessage) -> bool:
    """Return whether the message is about an element with a different name: its line then belongs to another file."""
    if found is None or not fault.name:
        return False
    if found.get("name"):
        return not fault.name.startswith(str(found.get("name")))
    around = [str(each.get("name")) for each in found.iterancestors() if each.get("name")]
    if any(map(fault.name.startswith, around)) or found.tag in NAMED_AFTER_FILE:
        return False
    return _attaching(fault, found.getroottree().getroot()) is not None


def _attaching(fault: messages.EngineMessage, root: Node) -> Node | None:
    """Return the `<attach>` that brings in the element of the message, by its prefix."""
    prefixes = {each: str(each.get("prefix") or "") for each in root.iter("attach")}
    fitting = [each for each, prefix in prefixes.items() if str(fault.name).startswith(prefix)]
    return max(fitting, key=lambda each: len(prefixes[each]), default=None)


def _with_sources(message: str, model: Unit, context: Context) -> str:
    """Return the message on one line, with the file names that the user knows."""
    for path, where in model.contents.items():
        if path in message:
            message = message.replace(path, context.shown(where) if isinstance(where, Path) else path)
    return " ".join(" ".join(dict.fromkeys(message.splitlines())).split()).removesuffix(".")


WHOLE = "whole"
"""The name under which the session keeps the composition."""
# Greedy: the match may include text between two sections of one name, but it never misses anything.
_OF_FILES = [
    re.compile(rb"<%b\b[^>]*>(?:.*</%b>)?" % (tag, tag), re.DOTALL) for tag in (b"asset", b"default", b"compiler")
]
_MATERIAL = re.compile(rb"<material\b[^>]*>")
"""Materials are the assets that are drawn most often, and MuJoCo reads no file for them."""


class Verified(Struct):
    """MuJoCo's verdict on a bundle. `error` is the reason for a refusal or, with `crash`, for having no verdict."""

    compiled: engine.Compiled
    error: messages.EngineMessage | None = None
    crash: str | None = None
    warnings: tuple[messages.EngineMessage, ...] = ()

    @property
    def ok(self) -> bool:
        return self.error is None

    @property
    def code(self) -> str:
        """The code of the diagnostic that reports `error`."""
        return "mujoco-rejects" if self.crash is None else messages.CRASHES.get(self.crash, "mujoco-crash")


class OutsideFilesError(Exception):
    """A bundle names files outside itself; `found` reports each of them."""

    def __init__(self, found: tuple[Diagnostic, ...]) -> None:
        super().__init__(found[0].message)
        self.found = found


def verify(
    bundle: Bundle,
    *,
    limits: engine.RequestLimits | None = None,
    session: engine.Session | None = None,
    keep: str | None = None,
    stranger: str | None = None,
) -> Verified:
    """Compile the bundle in a folder of its own, as a user would, and run one mj_forward.

    If the bundle may come from anyone, `stranger` is its name in messages; it is then compiled only if it names no
    files outside itself. A failing first forward step is an error too. With a `session`, `keep` names the compiled
    model for later calls. Raises OutputError if no temporary folder can be written, and OutsideFilesError.
    """
    with writing(), _written(bundle, session) as (folder, is_reused):
        if stranger is not None and (found := files_outside(folder, bundle.model, stranger)):
            raise OutsideFilesError(found)
        compiled = engine.compile(
            folder,
            bundle.model,
            wants=("index", "names"),
            keep=keep,
            folder_is_reused=is_reused,
            limits=limits,
            session=session,
        )
    warnings = tuple(map(messages.parse, compiled.warnings))
    fault = None
    if compiled.crash is not None:
        fault = messages.EngineMessage(compiled.error or compiled.crash)
    elif compiled.error is not None:
        fault = messages.parse(compiled.error)
    elif compiled.forward is not None:
        fault = messages.EngineMessage(f"the model compiles, but its first forward step fails: {compiled.forward}")
    return Verified(compiled, fault, compiled.crash, warnings=warnings)


@contextmanager
def _written(bundle: Bundle, session: engine.Session | None) -> Iterator[tuple[Path, bool]]:
    """Yield a folder with the bundle, and whether the folder is reused for bundles that differ only in the tree."""
    if session is None or not session.remembers:
        with scratch("bundle") as folder:
            write_files(bundle, folder)
            yield folder, False
        return
    # A hash of the files, their bytes and how the model refers to them. No version of MuJoCo uses more.
    whole = hashlib.sha256(bundle.model.encode())
    for path in bundle.files:
        if path not in (bundle.model, MANIFEST):
            whole.update(f"\0{path}\0{bundle.digest(path)}".encode())
    for section in _OF_FILES:
        whole.update(_MATERIAL.sub(b"", b"\0".join(section.findall(bundle.files[bundle.model]))))
    folder = session.standing(whole.hexdigest())
    if os.path.exists(folder):
        (folder / bundle.model).write_bytes(bundle.files[bundle.model])
    else:
        stage = folder.with_name("stage")
        stage.mkdir()
        write_files(bundle, stage)
        stage.rename(folder)
    yield folder, True
