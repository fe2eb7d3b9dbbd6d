"""Expand a xacro template into a URDF whose elements keep their places in the template."""

from __future__ import annotations

import contextlib
import glob
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import MOST_LOOKS, Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.base.files import MODEL_FILES, Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sandbox import call_confined
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, did_you_mean, exists_note
from mjcompose.sources import ros
from mjcompose.tree.parse import parse_xml
from mjcompose.tree.unit import Origins
from mjcompose.tree.xml_text import SourceText

_EXPAND = "mjcompose.urdf.expanding:expand"
_SHARE = 0.2
"""The share of MuJoCo's time limit for a template, which takes seconds at most."""
_PREFIX = "xacro:"
_DECLARED = re.compile(rb"\bxmlns:xacro\s*=")
_OF_XACRO = re.compile(rb"<xacro:|\$[{(]")
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)

_DEFINE = {
    "property": 'define it: `<xacro:property name="{}" value="…"/>`',
    "macro": 'define it, `<xacro:macro name="{}">`, or include the file that does',
}


_CODES = {
    "limit": "limit-exceeded",
    "costly": "limit-exceeded",
    "refused": "source-outside",
    "syntax": "xml-syntax",
}
"""The codes of faults by their reason, if they are not `xacro`."""
_HELP = {
    "environment": "make it an argument of the template: `<xacro:arg>`, and `with` in the recipe",
    "unsafe": "templates may only calculate: remove it",
    "costly": "write the result, or less of it",
    "file": "compare the path with the files on disk",
}


class Expanded(Struct):
    """The text, the places of its elements in the template, the files that were read, and diagnostics.

    Without a text, `found` has an error. `package` is an unknown package, and `at` is its place.
    """

    text: bytes | None
    owners: tuple[Span, ...] = ()
    files: tuple[Path, ...] = ()
    found: tuple[Diagnostic, ...] = ()
    package: str | None = None
    at: Span | None = None


def is_template(path: Path, data: bytes) -> bool:
    """Return whether a file is a xacro template, by its name or its content: many plain files declare the namespace."""
    if path.suffix.lower() == ".xacro":
        return True
    written = _COMMENT.sub(b"", data)
    return b"<xacro:" in written or bool(_DECLARED.search(written) and _OF_XACRO.search(written))


class XacroTemplate(Struct):
    """A xacro template, the values of its arguments, and the files that it may read."""

    path: Path
    door: Door
    packages: Mapping[str, Path]
    arguments: Mapping[str, str]
    shown: Callable[[Path], str]

    def expanded(self) -> Expanded:
        """Expand the template in a confined process of its own."""
        limits = in_force()
        argument = {
            "path": str(self.path.absolute()),
            "roots": list(self.door.roots),
            "sees_all": self.door.sees_all,
            "packages": {name: folder.absolute().as_posix() for name, folder in self.packages.items()},
            "arguments": dict(self.arguments),
            "elements": int(limits.elements),
        }
        readable = (os.sep,) if self.door.sees_all else self.door.roots
        seconds = limits.time * _SHARE
        memory = int(limits.memory)
        answer = call_confined(_EXPAND, argument, readable, seconds=seconds, memory=memory)
        if not answer["ok"]:
            return self._fault("xacro", f"the template cannot be expanded: {answer['error']}")
        value = answer["value"]
        if "other" in value:
            message = f"mjcompose does not know this version of the package `xacro`: it has no `{value['other']}`"
            return self._fault("not-installed", message, help='run `pip install --upgrade "mjcompose[xacro]"`')
        if value.get("missing"):
            message = "this file is a xacro template, but the package `xacro` is not installed"
            return self._fault("not-installed", message, help='run `pip install "mjcompose[xacro]"`')
        files = [Path(path) for path in value["files"]]
        refused = next((file for file in files if not self.door.sees(file)), None)
        if refused:
            outside = self.door.outside(str(refused))  # whatever has happened in the process
            return self._fault("source-outside", outside.message(), help=outside.help)
        if "error" in value:
            return self._failed(value["error"], files)
        places = [self._span(place, files) for place in value["places"]]
        warnings = [
            Diagnostic("xacro", f"xacro warns: {text}", Span(self.shown(Path(file)), 1, 1), severity=Severity.WARNING)
            for text, file in value["warnings"]
        ]
        unused = value["unused"]
        if unused:
            note = exists_note("argument", value["arguments"], unused[0])
            help = did_you_mean(unused[0], value["arguments"]) or f"remove `{unused[0]}` from `with`"
            message = f"the template has no argument `{unused[0]}`"
            return self._fault("unknown-name", message, help=help, notes=(note,), files=files)
        return Expanded(value["text"].encode(), tuple(places), tuple(files), found=tuple(warnings))

    def _fault(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        help: str | None = None,
        notes: Sequence[Note] = (),
        files: Sequence[Path] = (),
    ) -> Expanded:
        found = Diagnostic(code, message, span or Span(self.shown(self.path), 1, 1), notes=tuple(notes), help=help)
        return Expanded(None, files=tuple(files), found=(found,))

    def _span(self, place: tuple[int, int, int, str], files: list[Path]) -> Span:
        number, line, column, tag = place
        end = column + 2 + len(tag)
        return Span(self.shown(files[number]), line, column + 1, end_line=line, end_column=end)

    def _failed(self, error: dict[str, Any], files: list[Path]) -> Expanded:
        at = error["at"]
        message = error["message"]
        subject = error["subject"]
        span = Span(self.shown(self.path), 1, 1) if at is None else self._span(at, files)
        notes = [Note("called from here", self._span(place, files)) for place in error["calls"]]
        reason = error["code"]
        code = _CODES.get(reason, "xacro")
        help = _HELP.get(reason)
        match reason:
            case "package":
                return Expanded(None, files=tuple(files), package=subject, at=span)
            case "argument":
                help = f"add `with: {{{subject}: …}}` next to `model`"
                near = closest(subject, [*self.arguments])
                if near:
                    notes.append(Note(f"`with` gives `{near[0]}`"))
                    help = f"write `{subject}` instead of `{near[0]}`"
            case "property" | "macro" as noun:
                message = f"the {noun} `{subject}` does not exist"
                notes.insert(0, exists_note(noun, error["known"], subject))
                help = did_you_mean(subject, error["known"]) or _DEFINE[noun].format(subject.removeprefix(_PREFIX))
            case "limit":
                help = advice("elements")
            case "file":
                code, message = self._unreadable(Path(subject), message)
            case "refused":
                help = None if self.door.sees(subject) else self.door.outside(subject).help
            case "syntax":
                faults = self._xml_faults(files[at[0]]) if at is not None else ()
                if faults:
                    return Expanded(None, files=tuple(files), found=faults)
        return self._fault(code, message, span, help=help, notes=notes, files=files)

    def _unreadable(self, path: Path, why: str) -> tuple[str, str]:
        """Return code and message for a file that the template names."""
        called = f"the file `{self.shown(path)}`"
        if "no such file" in why:
            return "asset-missing", f"{called} does not exist"
        return "file-unreadable", f"{called} cannot be read: {why}"

    def _xml_faults(self, file: Path) -> tuple[Diagnostic, ...]:
        """Return the faults in the XML of a file, in the words for all models."""
        sink = Sink()
        try:
            parse_xml(self.door.read(file), self.shown(file), sink)
        except OSError:
            return ()
        return tuple(sink.errors)


def owned(root: Node, owners: tuple[Span, ...], origins: Origins) -> None:
    """Give every element of the expanded tree its place in the template."""
    for element, owner in zip(root.iter("*"), owners, strict=True):
        origins.own(element, partial(_place, origins, owner, frozenset(map(str, element.keys()))))


def _place(origins: Origins, owner: Span, attributes: Collection[str], attribute: str | None) -> Span:
    """Return the place of the element, or of its attribute if the template writes it there."""
    text = origins.text(owner.file) if attribute in attributes else None
    return (text and _attribute_from(text, owner, str(attribute))) or owner


def _attribute_from(text: SourceText, owner: Span, attribute: str) -> Span | None:
    lines = text.text.split("\n")[owner.line - 1 :] or [""]
    lines[0] = " " * (owner.column - 1) + lines[0][owner.column - 1 :]
    tag = re.match(r"""\s*<(?:[^>"']|"[^"]*"|'[^']*')*>""", "\n".join(lines[:100]))
    found = tag and re.search(rf"""[\s]{re.escape(attribute)}\s*=\s*(?:"([^"]*)"|'([^']*)')""", tag.group())
    if not found:
        return None
    start, end = found.span(found.lastindex or 1)
    before = found.string[:start]
    line = owner.line + before.count("\n")
    column = start - before.rfind("\n")
    return Span(owner.file, line, column, end_line=line, end_column=column + end - start)


_WRITTEN = re.compile(rb"""(?:filename\s*=\s*["']|load_yaml\(\s*["'])([^"'<>]*)["']""")
_FIND = re.compile(r"\$\(find\s+([^)\s]+)\)")
_VALUE = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")


def files_named(path: Path, data: bytes, door: Door, packages: Mapping[str, Path]) -> Iterator[Path]:
    """Yield the files that a template names or may name, directly or through others; only before its expansion."""
    waiting = [(path, data)]
    seen = {path}
    looks = iter(range(MOST_LOOKS))
    while waiting:
        file, content = waiting.pop()
        for each in dict.fromkeys(_WRITTEN.findall(content)):
            for found in _named(each.decode("utf-8", "replace"), file, packages, door=door, looks=looks):
                if found not in seen and door.sees(found) and os.path.isfile(found):
                    seen.add(found)
                    yield found
                    if found.suffix in MODEL_FILES:
                        with contextlib.suppress(OSError):
                            waiting.append((found, door.read(found)))


def _named(written: str, file: Path, packages: Mapping[str, Path], door: Door, looks: Iterator[int]) -> Iterator[Path]:
    """Yield the paths; patterns search only below the folder of the template and in packages."""
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
    return etree.fromstring(text, etree.XMLParser(huge_tree=True, resolve_entities=False, no_network=True))
