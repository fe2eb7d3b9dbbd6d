"""Read a URDF file or a xacro template as a unit; faults are reported at their places in the file."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Severity, Span
from mjcompose.base.files import SDF, Refused
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import exists_note, unknown_attribute
from mjcompose.mujoco.convert import PACKAGE, Converted, convert_urdf
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import CRASHES, Topic, parse, read_sentence
from mjcompose.sources import ros
from mjcompose.sources.reference import Source
from mjcompose.tree.files import written_path
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.merged_settings import ReadRow
from mjcompose.tree.parse import includes_admitted, parse_text, parse_xml, read_file
from mjcompose.tree.unit import FileText, Unit
from mjcompose.urdf import inertia
from mjcompose.urdf.actuators import Extras, add_actuators, note_unread, read_rows
from mjcompose.urdf.limits import complete_limits, report_unlimited
from mjcompose.urdf.meshes import Meshes, add_looks
from mjcompose.urdf.mimics import free_lost_mimics
from mjcompose.urdf.robot import Robot, explain, faulty_joints, locate_in_urdf, mesh_of, name_fused_links, named_in
from mjcompose.urdf.xacro import XacroTemplate, is_template, owned, parsed

_READ = ("compiler", "option", "size")
"""The sections of `<mujoco>` that MuJoCo reads in URDF."""
Shown = Callable[[Path], str]


class UrdfReader(Struct, frozen=False):
    """Reads URDF for one caller. Faults go to `sink`, with a note at `asked`, where the recipe names the file.

    `missing` reports missing meshes; it gets the robot and MuJoCo's answer. `relative` returns a folder as the caller
    writes it.
    """

    source: Source
    sink: Sink
    session: Session | None = None
    shown: Shown = str
    asked: Span | None = None
    is_fixed_in_world: bool = True
    missing: Callable[[Robot, Converted], None] | None = None
    relative: Shown = str
    rows: tuple[ReadRow, ...] = ()
    robot: Robot | None = None

    def unit(self) -> Unit | None:
        """Return the unit of the file, or None if it has faults."""
        with ExitStack() as stack:
            if self.session is None:
                self.session = stack.enter_context(Session())
            return self._unit(stack)

    def _unit(self, stack: ExitStack) -> Unit | None:
        robot = self.robot = self._robot()
        if robot is None or not self._is_urdf(robot):
            return None
        written = robot.unit
        before = self.sink.error_count
        if not includes_admitted(written, self.sink, self.shown):
            return None
        self._report_unread(robot)
        self._set_settings(robot)
        robot.simplified()
        free_lost_mimics(robot, self.sink)
        report_unlimited(robot, self.sink)
        complete_limits(robot)
        assert self.session is not None
        inertia.turn(robot, self.session)
        meshes = Meshes(robot, self.session, self.sink, shown=self.shown)
        meshes.prepare()
        meshes.separate()
        if self.sink.error_count > before:
            return None
        converted = self._converted(robot, meshes.shells, stack)
        if converted is not None and self.source.urdf.inertia == "repair" and _is_of_inertia(converted):
            # Only now: inertias that MuJoCo accepts stay unchanged.
            converted = self._converted(robot, meshes.shells, stack, massless=inertia.repair(robot, self.sink))
        if converted is None:
            return None
        self._report_warnings(converted, robot)
        if read_sentence(converted.error or "").topic is not Topic.FLAT:
            meshes.report_flat()
        if converted.text is None:
            self._refused(robot, converted)
            return None
        self._report_roots(robot)
        self._report_joints(robot)
        inertia.note_guessed(robot, self.sink, is_fixed=self.is_fixed_in_world)
        for path in meshes.files:
            robot.unit.origins.texts.setdefault(self.shown(path), FileText(path, b""))
        return self._completed(robot, converted.text)

    def _set_settings(self, robot: Robot) -> None:
        """Write the settings of the recipe into the robot; its own `<compiler>` takes precedence."""
        for setting, value in self.source.compiler:
            own = robot.setting(setting)
            if own is None:
                robot.set(setting, value)
            elif own.split() != value.split():
                message = f'`{setting}` here has no effect: `{robot.unit.file}` writes `{setting}="{own}"` itself'
                self.sink.warning("compiler-unused", message, self.asked, help=f"remove `{setting}` from `compiler`")
        choices = self.source.urdf
        for setting, choice in (("discardvisual", choices.visuals), ("fusestatic", choices.fixed)):
            if choice is not None:
                robot.set(setting, "false" if choice == "keep" else "true")

    def _robot(self) -> Robot | None:
        source = self.source
        sink = self.sink
        shown = self.shown(source.path)
        data = read_file(source.path, sink, source.door, file=shown, span=self.asked)
        if data is None:
            return None
        named_packages = dict(source.packages)
        if not is_template(source.path, data):
            if source.urdf.arguments:
                name = source.urdf.arguments[0][0]
                message = f"`with` gives `{name}`, but `{shown}` is not a xacro template"
                sink.error("unknown-name", message, self.asked, help="remove `with`")
                return None
            root = parse_xml(data, shown, sink)
            if root is None:
                return None
            unit = Unit(root, shown, source.path.parent, label=source.path.stem, door=source.door)
            unit.origins.texts[shown] = FileText(source.path, data)
            packages = ros.folders(ros.packages_in(data.decode("utf-8", "replace")), source.path, named_packages)
            return Robot(unit, source.path, packages)
        packages = ros.all_folders(source.path, named_packages)
        arguments = dict(source.urdf.arguments)
        expanded = XacroTemplate(source.path, source.door, packages, arguments=arguments, shown=self.shown).expanded()
        for diagnostic in expanded.found:
            notes = (*diagnostic.notes, *self._asked()) if diagnostic.severity is Severity.ERROR else diagnostic.notes
            sink.add(replace(diagnostic, notes=notes))
        if expanded.package is not None:
            self._unknown_package(expanded.package, expanded.at)
        if expanded.text is None:
            return None
        root = parsed(expanded.text)
        label = source.path.name.partition(".")[0]
        unit = Unit(root, shown, source.path.parent, label=label, door=source.door)
        for path in (source.path, *expanded.files):
            unit.origins.texts[self.shown(path)] = FileText(path)
        owned(root, expanded.owners, unit.origins)
        packages = ros.folders(ros.packages_in(expanded.text.decode("utf-8", "replace")), source.path, named_packages)
        return Robot(unit, source.path, packages, changed=True)

    def _converted(
        self, robot: Robot, shells: Collection[str], stack: ExitStack, massless: Sequence[str] = ()
    ) -> Converted | None:
        """Return MuJoCo's conversion, or None if a mesh is outside the readable folders."""
        text = robot.text()
        assert self.session is not None
        try:
            return convert_urdf(
                self.source.path,
                robot.packages,
                door=robot.unit.door,
                is_fixed=self.is_fixed_in_world,
                text=text,
                made=self._written(robot, stack),
                massless=massless,
                shells=shells,
                session=self.session,
            )
        except Refused as refused:
            mesh = mesh_of(robot.root, refused.path)
            advised = robot.advised(refused, str(mesh.get("filename") or ""))
            advised.report(self.sink, self._span(mesh, "filename"), self._asked(), shown=self.shown)
            return None

    def _written(self, robot: Robot, stack: ExitStack) -> dict[str, Path]:
        found: dict[str, Path] = {}
        folder = stack.enter_context(scratch("meshes")) if robot.made else Path()
        for name, content in robot.made.items():
            found[name] = folder / name
            found[name].parent.mkdir(parents=True, exist_ok=True)
            found[name].write_bytes(content)
        return found

    def _completed(self, robot: Robot, text: str) -> Unit:
        """Return the unit with the elements that MuJoCo does not read, and with all places."""
        written = robot.unit
        folder = self.source.path.parent
        unit = parse_text(text, self.sink, file=written.file, directory=folder, label=written.label, door=written.door)
        assert unit is not None, "MuJoCo writes MJCF"
        unit.origins.texts.clear()
        name_fused_links(unit.root)
        pairs = locate_in_urdf(unit, robot.root, written.origins)
        named = ((mesh, str(mesh.get("file"))) for mesh in unit.root.iterfind("asset/mesh"))
        of_made = ((written_path(unit.settings, mesh, file), file) for mesh, file in named if file in robot.made)
        unit.contents = {path: robot.made[file] for path, file in of_made}
        made: dict[Node, list[Node]] = defaultdict(list)
        for element, source in pairs:
            made[source].append(element)
            link = source.getparent()
            hides = self.source.urdf.visuals == "keep" and element.tag == "geom" and source.tag == "collision"
            if hides and link is not None and link.find("visual") is not None:
                element.set("group", "3")  # viewers show the visual
        known = Extras(written, unit, made).add()
        known |= add_looks(robot, unit, pairs, sink=self.sink)
        known |= add_actuators(written, unit, self.source.urdf.actuators, sink=self.sink)
        self.rows = unit.table = read_rows(written, robot.keeps_visuals, known)
        note_unread(self.rows, written, self.sink)
        return unit

    def _span(self, element: Node, attribute: str | None = None, *, key: bool = False) -> Span:
        assert self.robot is not None
        return self.robot.unit.origins.span(element, self.robot.unit.file, attribute, key=key)

    def _asked(self) -> tuple[Note, ...]:
        return () if self.asked is None else (Note("the recipe names it here", self.asked),)

    def _is_urdf(self, robot: Robot) -> bool:
        root = robot.root
        shown = robot.unit.file
        if root.tag != "robot":
            help = "end its name in `.xml`" if root.tag == "mujoco" else "a URDF file begins with `<robot>`"
            help = SDF.help(shown) if root.tag == "sdf" else help
            message = f"`{shown}` is not a URDF: its root is `<{root.tag}>`, not `<robot>`"
            self.sink.error("not-urdf", message, self._span(root), notes=self._asked(), help=help)
        return root.tag == "robot"

    def _report_warnings(self, converted: Converted, robot: Robot) -> None:
        for warning in converted.warnings:
            if read_sentence(warning).topic is not Topic.URDF_EQUAL_LIMITS:  # reported with all joints without limits
                element = named_in(warning, robot.root)
                self.sink.warning("mujoco-warning", f"MuJoCo warns: {warning}", self._span(element))

    def _report_joints(self, robot: Robot) -> None:
        """Warn about joints with the name of another joint: MuJoCo drops their names."""
        seen: dict[str, Node] = {}
        for joint in robot.root.iterchildren("joint"):
            name = joint.get("name")
            if name is not None and joint.get("type") != "fixed" and seen.setdefault(name, joint) is not joint:
                message = f"two joints are called `{name}`: this joint has no name in the model"
                notes = (Note(f"the other `{name}` is written here", self._span(seen[name], "name")),)
                span = self._span(joint, "name")
                help = "rename one of them"
                self.sink.warning("name-clash", message, span, notes=notes, help=help)

    def _report_roots(self, robot: Robot) -> None:
        """Warn about several links without a parent: MuJoCo puts each of them in the world."""
        children = {str(each.get("link")) for each in robot.root.iterfind("joint/child")}
        roots = [link for link in robot.root.iterchildren("link") if str(link.get("name")) not in children]
        if len(roots) > 1:
            names = ", ".join(f"`{link.get('name')}`" for link in roots[:8])
            message = f"{len(roots)} links have no parent, but a URDF has one such link: {names}"
            help = "write a `<joint>` to all of them except one; MuJoCo puts all in the world"
            self.sink.warning("urdf-roots", message, self._span(roots[1], "name"), help=help)

    def _report_unread(self, robot: Robot) -> None:
        """Warn about everything that MuJoCo ignores in `<mujoco>`, including typing errors."""
        for section in robot.root.iterfind("mujoco/*"):
            tag = str(section.tag)
            if tag not in _READ:
                message = f"MuJoCo does not read `<{tag}>` in the `<mujoco>` of URDF"
                notes = (exists_note("section", _READ, tag),)
                span = self._span(section)
                help = "write it into the recipe"
                self.sink.warning("unknown-element", message, span, notes=notes, help=help)
                continue
            known = list(GRAMMAR.section(tag).attributes)
            for name in map(str, section.keys()):
                if name not in known:
                    span = self._span(section, name, key=True)
                    otherwise = f"remove `{name}`"
                    found = unknown_attribute(name, f"`<{tag}>`", known, span=span, otherwise=otherwise)
                    self.sink.add(replace(found, severity=Severity.WARNING))

    def _refused(self, robot: Robot, converted: Converted) -> None:
        """Report all faults that can be found here: meshes, joints, inertias; if there are none, MuJoCo's error.

        MuJoCo stops at its first error, and may not have come to the meshes.
        """
        if converted.crash is not None:
            code = CRASHES.get(converted.crash, "mujoco-crash")
            message = f"`{robot.unit.file}` by itself: {converted.error or converted.crash}"
            self.sink.error(code, message, self.asked)
            return
        before = self.sink.error_count
        if not converted.meshes:
            files = (str(mesh.get("filename") or "") for mesh in robot.used_meshes())
            converted = replace(converted, meshes=tuple(filter(None, files)), folder=robot.setting("meshdir") or "")
        self._report_unknown_packages(robot, converted.meshes)
        if self.missing is not None:
            self.missing(robot, converted)
        for fault in faulty_joints(robot.root, self._span):
            self.sink.add(replace(fault, notes=(*fault.notes, *self._asked())))
        is_repaired = self.source.urdf.inertia == "repair" or _accepts_any_inertia(robot)
        is_of_inertia = _is_of_inertia(converted)
        if is_of_inertia or not is_repaired:
            inertia.report(robot, self.sink, self._asked(), is_refused=is_of_inertia)
        if self.sink.error_count == before:
            fault = explain(parse(converted.error or ""), robot.root, self._span)
            self.sink.add(replace(fault, notes=(*fault.notes, *self._asked())))

    def _report_unknown_packages(self, robot: Robot, meshes: Iterable[str]) -> None:
        """Report each package once, at the first mesh that it would have."""
        unknown: dict[str, str] = {}
        for file in meshes:
            if file.startswith(PACKAGE):
                unknown.setdefault(file.removeprefix(PACKAGE).partition("/")[0], file)
        for name, file in unknown.items():
            self._unknown_package(name, self._span(mesh_of(robot.root, file), "filename"))

    def _unknown_package(self, name: str, at: Span | None) -> None:
        near = ros.beside(name, self.source.path)
        folder = "PATH" if near is None else self.relative(near)
        known = [each for each, _ in self.source.packages]
        note = Note(f"no folder above `{self.shown(self.source.path)}` is called `{name}`")
        notes = (note, exists_note("package", known, name)) if known else (note,)
        message = f"the package `{name}` is not known"
        help = f"add its folder next to `model`: `packages: {{{name}: {folder}}}`"
        self.sink.error("asset-missing", message, at, notes=(*notes, *self._asked()), help=help)


def _accepts_any_inertia(robot: Robot) -> bool:
    """Return whether MuJoCo corrects or ignores impossible inertias."""
    return "true" in (robot.setting("balanceinertia"), robot.setting("inertiafromgeom"))


def _is_of_inertia(converted: Converted) -> bool:
    """Return whether MuJoCo refuses the model for its masses or inertias."""
    is_refused = converted.text is None and converted.crash is None
    return is_refused and read_sentence(parse(converted.error or "").message).topic in (Topic.INERTIA, Topic.MASS)
