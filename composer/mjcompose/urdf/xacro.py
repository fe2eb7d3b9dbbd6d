"""A template for xacro becomes the URDF that it stands for, each of whose elements keeps its place in the template."""

from __future__ import annotations

import contextlib
import glob
import os
import re
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import MOST_LOOKS, Door
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sandbox import call_confined
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, did_you_mean, exists_note
from mjcompose.model.parse import parse_xml
from mjcompose.model.unit import Origins
from mjcompose.model.xml_text import SourceText
from mjcompose.sources import ros

_EXPAND = "mjcompose.urdf.expanding:expand"
_SHARE = 0.2
"""The part of the time of MuJoCo that a template has: it takes seconds at most."""
_PREFIX = "xacro:"
_DECLARED = re.compile(rb"\bxmlns:xacro\s*=")
_OF_XACRO = re.compile(rb"<xacro:|\$[{(]")
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)

_DEFINE = {
    "property": 'define it: `<xacro:property name="{}" value="…"/>`',
    "macro": 'define it, `<xacro:macro name="{}">`, or include the file that does',
}


@dataclass(frozen=True, slots=True)
class Expanded:
    """The text, where each of its elements comes from, the files that were read, and what is remarkable.

    Without a text there is an error among the `found`. `package` is one that is not known, and `at` where it is used.
    """

    text: bytes | None
    owners: tuple[Span, ...] = ()
    files: tuple[Path, ...] = ()
    found: tuple[Diagnostic, ...] = ()
    package: str | None = None
    at: Span | None = None


def is_template(path: Path, data: bytes) -> bool:
    """Whether a file is for xacro, by its name or by what it holds: many plain files declare its namespace, too."""
    if path.suffix.lower() == ".xacro":
        return True
    written = _COMMENT.sub(b"", data)
    return b"<xacro:" in written or bool(_DECLARED.search(written) and _OF_XACRO.search(written))


@dataclass(frozen=True, slots=True)
class Template:
    """A file for xacro, the values of its arguments, and what it may read."""

    path: Path
    door: Door
    packages: Mapping[str, Path]
    arguments: Mapping[str, str]
    shown: object

    def expanded(self) -> Expanded:
        """What it stands for, by a process that has read nothing else and can do nothing else."""
        limits = in_force()
        argument = {
            "path": str(self.path.absolute()), "roots": list(self.door.roots), "sees_all": self.door.sees_all,
            "packages": {name: folder.absolute().as_posix() for name, folder in self.packages.items()},
            "arguments": dict(self.arguments), "elements": int(limits.elements),
        }  # fmt: skip
        readable = (os.sep,) if self.door.sees_all else self.door.roots
        seconds, memory = limits.time * _SHARE, int(limits.memory)
        answer = call_confined(_EXPAND, argument, readable, seconds=seconds, memory=memory)
        here = Span(self._name(self.path), 1, 1)
        if not answer["ok"]:
            message = f"the template cannot be expanded: {answer['error']}"
            return Expanded(None, found=(Diagnostic("xacro", message, here),))
        value = answer["value"]
        if "other" in value:
            message = f"this version of the package `xacro` is not known here: it has no `{value['other']}`"
            other = Diagnostic("not-installed", message, here, help='run `pip install --upgrade "mjcompose[xacro]"`')
            return Expanded(None, found=(other,))
        if value.get("missing"):
            message = "this is a template for xacro, and the package `xacro` is not installed"
            missing = Diagnostic("not-installed", message, here, help='run `pip install "mjcompose[xacro]"`')
            return Expanded(None, found=(missing,))
        files = [Path(each) for each in value["files"]]
        if refused := next((each for each in files if not self.door.sees(each)), None):
            outside = self.door.outside(str(refused))  # whatever has happened in the process
            return Expanded(None, found=(Diagnostic("source-outside", outside.message(), here, help=outside.help),))
        if "error" in value:
            return self._failed(value["error"], files)
        places = [self._span(each, files) for each in value["places"]]
        warnings = [
            Diagnostic("xacro", f"xacro warns: {text}", Span(self._name(Path(file)), 1, 1), severity=Severity.WARNING)
            for text, file in value["warnings"]
        ]
        if value["unused"]:
            return Expanded(None, files=tuple(files), found=(self._unused(value["unused"][0], value["arguments"]),))
        return Expanded(value["text"].encode(), tuple(places), tuple(files), found=tuple(warnings))

    def _name(self, path: Path) -> str:
        assert callable(self.shown)
        return str(self.shown(path))

    def _span(self, place: list[object], files: list[Path]) -> Span:
        number, line, column, tag = place
        assert isinstance(number, int) and isinstance(line, int) and isinstance(column, int)
        length = len(str(tag)) + 1 if tag else 1
        return Span(self._name(files[number]), line, column + 1, end_line=line, end_column=column + 1 + length)

    def _unused(self, name: str, arguments: list[str]) -> Diagnostic:
        message = f"the template has no argument `{name}`"
        note = exists_note("argument", arguments, name)
        help = did_you_mean(name, arguments) or f"take `{name}` out of `with`"
        return Diagnostic("unknown-name", message, Span(self._name(self.path), 1, 1), notes=(note,), help=help)

    def _failed(self, error: dict[str, object], files: list[Path]) -> Expanded:
        at = error["at"]
        span = self._span(at, files) if isinstance(at, list) else Span(self._name(self.path), 1, 1)
        calls = error["calls"]
        assert isinstance(calls, list)
        notes = [Note("called from here", self._span(each, files)) for each in calls]
        message, subject = str(error["message"]), str(error["subject"])
        code, help = "xacro", None
        match error["code"]:
            case "package":
                return Expanded(None, files=tuple(files), package=subject, at=span)
            case "argument":
                help = f"write beside `model`: `with: {{{subject}: …}}`"
                if near := closest(subject, [*self.arguments]):
                    notes.append(Note(f"`with` gives `{near[0]}`"))
                    help = f"write `{subject}` in place of `{near[0]}`"
            case "property" | "macro" as noun:
                known = error["known"]
                assert isinstance(known, list)
                message = f"the {noun} `{subject}` does not exist"
                notes.insert(0, exists_note(noun, known, subject))
                help = did_you_mean(subject, known) or _DEFINE[noun].format(subject.removeprefix(_PREFIX))
            case "environment":
                help = "make it an argument of the template: `<xacro:arg>`, and `with` in the recipe"
            case "unsafe":
                help = "templates may calculate, and nothing else: write it without"
            case "limit":
                code, help = "limit-exceeded", advice("elements")
            case "costly":
                code, help = "limit-exceeded", "write what it gives, or fewer of it"
            case "file":
                code = "asset-missing" if "no such file" in message else "file-unreadable"
                message = f"the file `{self._name(Path(subject))}` does not exist"
                if code == "file-unreadable":
                    message = f"the file `{self._name(Path(subject))}` cannot be read: {error['message']}"
                help = "compare the path with what is on the disk"
            case "refused":
                code = "source-outside"
                help = None if self.door.sees(subject) else self.door.outside(subject).help
            case "syntax":
                code = "xml-syntax"
                if known := self._not_xml(at, files):
                    return Expanded(None, files=tuple(files), found=known)
        return Expanded(
            None, files=tuple(files), found=(Diagnostic(code, message, span, notes=tuple(notes), help=help),)
        )

    def _not_xml(self, at: object, files: list[Path]) -> tuple[Diagnostic, ...]:
        """What is wrong with the XML of a file, in the words that other models have for it."""
        if not isinstance(at, list):
            return ()
        file, sink = files[at[0]], Sink()
        try:
            parse_xml(self.door.read(file), self._name(file), sink)
        except OSError:
            return ()
        return tuple(sink.errors)


def owned(root: Node, owners: tuple[Span, ...], origins: Origins) -> None:
    """Give every element of the expanded tree its place in the template."""
    for element, owner in zip(root.iter("*"), owners, strict=True):
        origins.own(
            element, partial(_place, origins, owner, {str(name): str(value) for name, value in element.items()})
        )


def _place(origins: Origins, owner: Span, attributes: dict[str, str], attribute: str | None) -> Span:
    """The element, or its attribute, if that is written there and not only in what a macro is given."""
    text = origins.text(owner.file) if attribute in attributes else None
    found = text and _attribute_from(text, owner, str(attribute))
    return found or owner


def _attribute_from(text: SourceText, owner: Span, attribute: str) -> Span | None:
    lines = text.text.split("\n")[owner.line - 1 :]
    if not lines:
        return None
    lines[0] = " " * (owner.column - 1) + lines[0][owner.column - 1 :]
    tag = re.match(r"""\s*<(?:[^>"']|"[^"]*"|'[^']*')*>""", "\n".join(lines[:100]))
    found = tag and re.search(rf"""[\s]{re.escape(attribute)}\s*=\s*(?:"([^"]*)"|'([^']*)')""", tag.group())
    if not found:
        return None
    start, end = found.span(1 if found.group(1) is not None else 2)
    before = found.string[:start]
    line, column = before.count("\n"), start - (before.rfind("\n") + 1)
    return Span(
        owner.file, owner.line + line, column + 1, end_line=owner.line + line,
        end_column=column + 1 + (end - start),
    )  # fmt: skip


_WRITTEN = re.compile(rb"""(?:filename\s*=\s*["']|load_yaml\(\s*["'])([^"'<>]*)["']""")
_FIND = re.compile(r"\$\(find\s+([^)\s]+)\)")
_VALUE = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")


def files_named(path: Path, data: bytes, door: Door, packages: Mapping[str, Path]) -> Iterator[Path]:
    """The files that a template names, and those that these name; where a value is in a path, all that fit.

    It is for what must be known before the template is expanded. What is expanded says itself what it has read.
    """
    waiting, seen, looks = [(path, data)], {path}, iter(range(MOST_LOOKS))
    while waiting:
        file, content = waiting.pop()
        for each in dict.fromkeys(_WRITTEN.findall(content)):
            for found in _named(each.decode("utf-8", "replace"), file, packages, door=door, looks=looks):
                if found in seen or not door.sees(found) or not os.path.isfile(found):
                    continue
                seen.add(found)
                yield found
                if found.suffix in (".xacro", ".urdf", ".xml", ".yaml", ".yml"):
                    try:
                        waiting.append((found, door.read(found)))
                    except OSError:
                        continue


def _named(written: str, file: Path, packages: Mapping[str, Path], door: Door, looks: Iterator[int]) -> Iterator[Path]:
    """The paths that are meant. Only below the folder of the template and in packages is anything looked for."""
    text = _FIND.sub(lambda found: str(packages.get(found[1], f"/{found[1]}")), written)
    for scheme in ("package://", "model://"):
        if text.startswith(scheme):
            name, _, inside = text.removeprefix(scheme).partition("/")
            text = f"{packages.get(name, '/' + name)}/{inside}"
    text = text.removeprefix("file://")
    path = Path(text) if text.startswith("/") else file.parent / text
    if not _VALUE.search(text):
        yield path
        return
    at = os.path.normpath(str(path))
    folder = _VALUE.split(at)[0].rpartition(os.sep)[0]
    named = [packages[each] for each in ros.packages_in(written + "/") if each in packages]
    own = next((each for each in file.parents if os.path.isfile(each / ros.MANIFEST)), file.parent)
    if not any(Path(folder).is_relative_to(each) for each in (file.parent, own, *named)):
        return
    pattern = "*".join(map(glob.escape, _VALUE.split(at)))
    with contextlib.suppress(Refused):
        yield from map(Path, door.search(pattern, looks))


def parsed(text: bytes) -> Node:
    """The tree of a text that was made here."""
    return etree.fromstring(text, etree.XMLParser(huge_tree=True, resolve_entities=False, no_network=True))
