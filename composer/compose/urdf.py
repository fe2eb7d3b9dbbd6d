"""Convert a URDF file to a unit with MuJoCo, and report errors at their place in the URDF."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer import engine
from composer.bundle.collect import collect
from composer.compose.urdf_fault import explain, named_in
from composer.context import Context
from composer.diagnostics.diagnostic import Note, Severity
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import exists_note
from composer.diagnostics.unknown import unknown_attribute
from composer.engine import PACKAGE
from composer.grammar import GRAMMAR
from composer.link.linking import FileUse
from composer.mujoco_errors.message import CRASHES, parse
from composer.reading.door import held
from composer.reading.refused import Refused
from composer.sources import ros_package
from composer.sources.source import Source
from composer.tree.admitted import includes_admitted
from composer.tree.files import join
from composer.tree.parse import parse_text, parse_xml, read_file
from composer.tree.unit import Unit
from composer.tree.urdf import locate_in_urdf, mesh_of, name_fused_links

if TYPE_CHECKING:
    from composer.engine import Converted, Session

_READ = ("compiler", "option", "size")
"""The sections of `<mujoco>` that MuJoCo reads in URDF."""


def urdf_unit(
    source: Source, context: Context, session: Session | None, span: Span | None, *, stands: bool = True
) -> Unit | None:
    """The unit of a URDF file; faults go to the sink and give None.

    `span` is where the recipe asks for it. What `stands` in the world loses its root link to it, as it does alone.
    """
    shown = context.shown(source.path)
    data = read_file(source.path, context.sink, source.door, file=shown, span=span)
    robot = None if data is None else parse_xml(data, shown, context.sink)
    if data is None or robot is None:
        return None
    written = Unit(robot, shown, source.path.parent, source.path.stem, door=source.door)
    written.origins.texts[shown] = data
    given = dict(source.packages)
    return _Reading(written, data, source.path, given, context, session, span, stands).unit()


@dataclass(frozen=True, slots=True)
class _Reading:
    """One URDF file that is being converted; `written` is the URDF's own tree."""

    written: Unit
    data: bytes
    path: Path
    given: dict[str, Path]
    context: Context
    session: Session | None
    asked: Span | None
    stands: bool

    def unit(self) -> Unit | None:
        if not self._is_urdf():
            return None
        if not includes_admitted(self.written, self.context.sink, self.context.shown):
            return None
        self._report_unread()
        names = ros_package.packages_in(self.data.decode("utf-8", "replace"))
        packages = ros_package.folders(names, self.path, self.given)
        try:
            converted = engine.convert_urdf(
                self.path, packages, door=self.written.door, stands=self.stands, session=self.session
            )
        except Refused as refused:
            span = self._span(mesh_of(self.written.root, refused.path), "filename")
            refused.report(self.context.sink, span, self._asked(), self.context.shown)
            return None
        for warning in converted.warnings:
            self.context.sink.warning(
                "mujoco-warning", f"MuJoCo warns: {warning}", self._span(named_in(warning, self.written.root))
            )
        if converted.text is None:
            self._refused(converted)
            return None
        shown, sink = self.written.file, self.context.sink
        unit = parse_text(
            converted.text, sink, file=shown, directory=self.path.parent, label=self.written.label,
            door=self.written.door,
        )  # fmt: skip
        assert unit is not None, "MuJoCo writes MJCF"
        name_fused_links(unit.root)
        locate_in_urdf(unit, self.written.root, self.data)
        return unit

    def _error(self, code: str, message: str, element: Node | None = None, attribute: str | None = None,
               *, notes: tuple[Note, ...] = (), help: str | None = None) -> None:  # fmt: skip
        span = self._span(self.written.root if element is None else element, attribute)
        self.context.sink.error(code, message, span, notes=(*notes, *self._asked()), help=help)

    def _span(self, element: Node, attribute: str | None = None, *, key: bool = False) -> Span:
        return self.written.origins.span(element, self.written.file, attribute, key=key)

    def _asked(self) -> tuple[Note, ...]:
        return () if self.asked is None else (Note("the recipe takes it from here", self.asked),)

    def _is_urdf(self) -> bool:
        root, shown = self.written.root, self.written.file
        macro = next((each for each in root.iter("*") if "xacro" in str(each.tag)), None)
        if root.tag != "robot":
            help = "end its name in `.xml`" if root.tag == "mujoco" else "a URDF file begins with `<robot>`"
            self._error(
                "not-urdf", f"`{shown}` is not a URDF: its root is `<{root.tag}>`, not `<robot>`", help=help
            )
        elif macro is not None:
            help = f"expand it first: `xacro {Path(shown).name} > robot.urdf`"
            self._error(
                "not-urdf",
                f"`{shown}` is a template for xacro, not yet the URDF it stands for",
                macro,
                help=help,
            )
        return root.tag == "robot" and macro is None

    def _report_unread(self) -> None:
        """Warn of what MuJoCo passes over in `<mujoco>`, typing errors included."""
        for section in self.written.root.iterfind("mujoco/*"):
            tag = str(section.tag)
            if tag not in _READ:
                message = f"MuJoCo does not read `<{tag}>` in the `<mujoco>` of URDF"
                note = exists_note("section", _READ, tag)
                span = self._span(section)
                self.context.sink.warning(
                    "unknown-element", message, span, notes=(note,), help="write it into the recipe"
                )
                continue
            known = list(GRAMMAR.section(tag).attributes)
            for name in map(str, section.keys()):
                if name not in known:
                    span, otherwise = self._span(section, name, key=True), f"take `{name}` out"
                    found = unknown_attribute(name, f"`<{tag}>`", known, span, otherwise=otherwise)
                    self.context.sink.add(replace(found, severity=Severity.WARNING))

    def _refused(self, converted: Converted) -> None:
        """One fault for each mesh that is not to be had; if all are, what MuJoCo says."""
        if converted.crash is not None:
            code = CRASHES.get(converted.crash, "mujoco-crash")
            message = f"`{self.written.file}` by itself: {converted.error or converted.crash}"
            self.context.sink.error(code, message, self.asked)
            return
        before = self.context.sink.error_count
        self._missing(converted)
        if self.context.sink.error_count == before:
            found = explain(parse(converted.error or ""), self.written.root, self._span)
            self.context.sink.add(replace(found, notes=(*found.notes, *self._asked())))

    def _missing(self, converted: Converted) -> None:
        unknown: dict[str, Node] = {}
        uses = []
        for file in converted.meshes:
            mesh = mesh_of(self.written.root, file)
            if file.startswith(PACKAGE):
                unknown.setdefault(file.removeprefix(PACKAGE).partition("/")[0], mesh)
            else:
                found = held(join(str(self.path.parent), join(converted.folder, file)))
                uses.append(FileUse(mesh, "filename", file, found, None, shared=False))
        for name, mesh in unknown.items():
            self._unknown_package(name, mesh)
        sink = Sink()
        collect(self.written, uses, sink, self.context.shown)
        for each in sink.diagnostics:
            help = each.help or "put the file there, or correct `filename`"
            self.context.sink.add(replace(each, notes=(*each.notes, *self._asked()), help=help))

    def _unknown_package(self, name: str, mesh: Node) -> None:
        near = ros_package.beside(name, self.path)
        recipe = self.context.folder / (self.asked.file if self.asked else "")
        folder = "PATH" if near is None else Path(os.path.relpath(near, recipe.parent)).as_posix()
        given = exists_note("package", list(self.given), name)
        note = Note(f"no folder above `{self.written.file}` is called `{name}`")
        self._error(
            "asset-missing",
            f"the package `{name}` is not known",
            mesh,
            "filename",
            notes=(note, given) if self.given else (note,),
            help=f"say beside `model` where it is: `packages: {{{name}: {folder}}}`",
        )
