"""Verb `inertia`: write down the inertia of a body that MuJoCo computes from its geoms."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.second_moments import reshaped
from mjcompose.base.sink import Sink
from mjcompose.compose.editing import Editing
from mjcompose.compose.values import UnusableValue, report_unusable
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.verbs.inertia import Inertia
from mjcompose.link import numbers
from mjcompose.link.inertia import INERTIA_RULES
from mjcompose.link.linking import Linking
from mjcompose.link.measure import BODIES, Survey, Unmeasurable, compile_unaligned
from mjcompose.link.unit_keys import without_keys
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS, own, walk_bodies
from mjcompose.tree.edit import replace

_ROWS = dict(zip(BODIES, (1, 3, 4, 3), strict=True))


def carry_out(verb: Inertia, entry: Entry, at: Path) -> None:
    editing = entry.editing
    found = entry.found
    wanted = {body: _geoms(editing, body, verb, at=at) for body in found}
    for body, geoms in wanted.items():
        _refuse_shells(editing, body, geoms, at=at)
    entry.masses.settle(*INERTIA_RULES)
    survey, there = _measured(editing, wanted, verb.density, at=at)
    for body in found:
        rows = {array: survey.values(there[body], array, width) for array, width in _ROWS.items()}
        mass, pos, quat, moments = rows.values()
        if mass is None or pos is None or quat is None or moments is None:
            message = f"MuJoCo does not say what {editing.called(body)} weighs"
            report_unusable(editing, body, Fault("selector", message, at, key=True), it="it")
        if not mass[0] > 0:
            message = f"the geoms of {editing.called(body)} have no volume"
            help = "write its mass: `set: {mass: …}`"
            report_unusable(editing, body, Fault("wrong-type", message, at, key=True, help=help), it="it")
        _write(editing, body, {"pos": pos, "quat": quat, "mass": mass, "diaginertia": moments}, at=at)


def _write(editing: Editing, body: Node, values: Mapping[str, Sequence[float]], at: Path) -> None:
    """Write the values into the effective `<inertial>`, or a new one. Their place is the whole entry."""
    entry = at[:-1]
    inertials = own(body, "inertial")
    kept = inertials[-1] if inertials else None
    if kept is None or kept.getparent() is not body:  # in a frame the numbers would mean another pose
        kept = body.makeelement("inertial")
        journal.place(body, kept, 0)
        editing.making.origins.own(kept, editing.span(entry))
    for other in inertials:
        if other is not kept:
            journal.remove(other)
    unset = dict.fromkeys(("fullinertia", "diaginertia", *ORIENTATIONS))
    replace(kept, {**unset, **{name: numbers.text(each) for name, each in values.items()}})
    editing.write(kept, dict.fromkeys(values, entry))


def recalibrate(entry: Entry, com: Sequence[float] | None, shape: Sequence[float] | None, at: Path) -> None:
    """Move the center of mass of each body, and reshape its inertia around it. The mass stays."""
    editing = entry.editing
    entry.masses.settle(*INERTIA_RULES)
    unit = editing.linking.flat()
    aside = Sink()
    with without_keys(unit.root):
        survey = compile_unaligned(Linking(unit, [], aside, measure=editing.linking.measure), unit, BODIES)
    editing.sink.extend(aside.diagnostics)
    if isinstance(survey, Unmeasurable) or survey is None:
        why = f": {survey.why}" if isinstance(survey, Unmeasurable) else ""
        editing.sink.error("selector", f"the inertia of the selected element is not known{why}", editing.span(at))
        raise UnusableValue
    for body in entry.found:
        mass, pos, quat, moments = (survey.values(body, array, width) for array, width in _ROWS.items())
        if mass is None or pos is None or quat is None or moments is None or not mass[0] > 0:
            message = f"{editing.called(body)} has no mass of its own, so no inertia"
            report_unusable(editing, body, Fault("selector", message, at, key=True), it="it")
        moved = [place + offset for place, offset in zip(pos, com or (0.0, 0.0, 0.0), strict=True)]
        values: dict[str, Sequence[float]] = {"pos": moved, "mass": mass, "quat": quat, "diaginertia": moments}
        if shape is not None:
            w, x, y, z = quat
            tensor = reshaped(moments, (w, x, y, z), shape)
            full = [tensor[row][column] for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
            values = {"pos": moved, "mass": mass, "fullinertia": full}
        _write(editing, body, values, at=at)


def _geoms(editing: Editing, body: Node, written: Inertia, at: Path) -> list[Node]:
    """Return the geoms of a body to use. Geoms in several groups are usually copies of the same shape."""
    geoms = own(body, "geom")
    if written.source == "mesh":
        geoms = [geom for geom in geoms if editing.effective(geom, "type") == "mesh"]
    groups: dict[int, list[Node]] = {}
    for geom in geoms:
        groups.setdefault(int(editing.effective(geom, "group") or 0), []).append(geom)
    known = ", ".join(map(str, sorted(groups)))
    what = "meshes" if written.source == "mesh" else "geoms"
    if not groups:
        help = "write `from: geoms`" if written.source == "mesh" and own(body, "geom") else "write `set: {mass: …}`"
        message = f"{editing.called(body)} has no {what}"
        report_unusable(editing, body, Fault("selector", message, at, key=True, help=help), it="it")
    if written.group is not None:
        if written.group not in groups:
            message = f"{editing.called(body)} has no {what} in the group {written.group}"
            help = f"it has some in the groups {known}"
            report_unusable(editing, body, Fault("selector", message, (*at, "group"), key=True, help=help), it="it")
        return groups[written.group]
    if len(groups) > 1:
        message = f"{editing.called(body)} has {what} in the groups {known}, which may be the same shape several times"
        help = f"select those that count: `group: {min(groups)}`"
        report_unusable(editing, body, Fault("selector", message, at, key=True, help=help), it="it")
    return geoms


def _refuse_shells(editing: Editing, body: Node, geoms: Collection[Node], at: Path) -> None:
    """Report a geom whose mass follows from its surface: MuJoCo 4.0 reads its density in kg/m²."""
    for geom in geoms:
        name = editing.effective(geom, "mesh")
        mesh = editing.find_node("mesh", str(name)) if editing.effective(geom, "type") == "mesh" and name else None
        if mesh is not None and editing.effective(mesh, "inertia") == "shell":
            called = f"the mesh `{name}`"
            help = f"make it solid first, `{{select: {{mesh: {name}}}, set: {{inertia: convex}}}}`"
        elif editing.effective(geom, "shellinertia") == "true":
            called = editing.called(geom)
            help = "make it solid first, `set: {shellinertia: false}`"
        else:
            continue
        message = f"{called} is a shell, whose mass follows from its surface, not from a density in kg/m³"
        help += ", or write the mass of the body: `set: {mass: …}`"
        report_unusable(editing, body, Fault("wrong-type", message, (*at, "density"), help=help), it="it")


def _measured(
    editing: Editing, wanted: Mapping[Node, Collection[Node]], density: float, at: Path
) -> tuple[Survey, Mapping[Node, Node]]:
    """Return the measurements in a copy of the model in which the bodies have only these geoms, at that density."""
    unit = editing.linking.flat()
    aside = Sink()
    with without_keys(unit.root):
        copy = unit.copied()
    copies = dict(
        zip((node for node, _ in walk_bodies(unit.root)), (node for node, _ in walk_bodies(copy.root)), strict=True)
    )
    for body, geoms in wanted.items():
        _made_of(copies[body], [copies[each] for each in geoms], density)
    # The bodies that `fusestatic` makes part of a body keep their own mass, which MuJoCo adds later.
    copy.forget_settings(*INERTIA_RULES, "fusestatic")
    found = compile_unaligned(Linking(copy, [], aside, measure=editing.linking.measure), copy, BODIES)
    editing.sink.extend(aside.diagnostics)
    if isinstance(found, Unmeasurable) or found is None:
        if isinstance(found, Unmeasurable):
            message = f"the inertia of the selected element is not known: {found.why}"
            editing.sink.error("selector", message, editing.span(at, key=True))
        raise UnusableValue
    return found, copies


def _made_of(body: Node, geoms: Collection[Node], density: float) -> None:
    for inertial in own(body, "inertial"):
        journal.remove(inertial)
    for geom in own(body, "geom"):
        # `mass="nan"` takes back the mass that a class gives: then the density counts.
        counts = geom in geoms
        journal.write(geom, "mass", "nan" if counts else "0")
        if counts:
            journal.write(geom, "density", numbers.text([density]))
