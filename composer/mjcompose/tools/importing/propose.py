"""The recipe that makes a merged model from its parts, as text."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import field, replace
from itertools import count
from pathlib import Path
from xml.sax.saxutils import quoteattr

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Severity, Span
from mjcompose.base.rotation import IDENTITY_QUAT, Pose
from mjcompose.base.sink import Sink
from mjcompose.language.recipe import SETTABLE
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import Source, SourceError
from mjcompose.sources.ros import UrdfChoices
from mjcompose.text.faults import quoted, word
from mjcompose.tools.importing import elements
from mjcompose.tools.importing.compare import ChangeFinder
from mjcompose.tools.importing.elements import ChangedAttribute, Likeness, ModelElement, Names, SectionEntry
from mjcompose.tools.importing.search import Instance, parent_body
from mjcompose.tree.classes import childclass_of
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.merged_settings import ReadRow
from mjcompose.tree.unit import Unit
from mjcompose.urdf.actuators import CODE as UNREAD
from mjcompose.urdf.inertia import CODE as INERTIA
from mjcompose.urdf.read import UrdfReader

_CLOSE = 1e-9  # meters, and quaternion components


class Proposal(Struct, frozen=False):
    """The recipe; `renamed` maps names of the merged model, by kind, to names in the recipe."""

    head: list[str]
    entries: list[SectionEntry]
    found: list[Instance]
    renamed: dict[str, dict[str, str]] = field(default_factory=dict)
    alike: dict[str, tuple[object, ...]] = field(default_factory=dict)
    """The contents of each asset of a part, by its name in the recipe."""
    nameless_keys: tuple[int, ...] = ()
    """The numbers of the merged model's keys without a name."""
    keys: dict[str, list[str]] = field(default_factory=dict)
    """By name of a key: the parts in the recipe that have one."""
    changed: tuple[ChangedAttribute, ...] = ()
    """The values that the merged model and the recipe set differently from the parts."""


def propose(
    merged: Unit,
    parts: list[Unit],
    references: list[str],
    relative: Callable[[Path], str],
    likeness: Callable[[Instance, Names], Likeness] = lambda _, __: Likeness(),
) -> Proposal:
    """Return the recipe that makes `merged` from `parts`, which `references` name; `relative` writes file paths.

    `likeness` returns the elements of a part that compile to the same result; without it, any difference in writing
    counts.
    """
    return _Proposer(merged, parts, references, relative=relative, likeness=likeness).proposal()


class _Proposer(ChangeFinder):
    def proposal(self) -> Proposal:
        self.match_names()
        self.match_assets()
        for each in self.found:
            self.compare_assets(each)
            self.compare(each)
            self.attach(each, self.compare_world(each))
            self.compare_sections(each)
        self.changed()
        self.remove_keys()
        self.settings()
        self.compiler()
        self.left_over()
        head = self.head()
        renamed = self.rename()
        nameless = tuple(at for at, key in enumerate(self.merged.root.iter("key")) if not key.get("name"))
        keys: dict[str, list[str]] = defaultdict(list)
        for each in self.base_first:
            for key in self.parts[each.part].root.iter("key"):
                keys[str(key.get("name") or "")].append("base" if each.is_base else each.key)
        return Proposal(
            head,
            self.entries,
            self.found,
            renamed=renamed,
            alike=self.alike,
            nameless_keys=nameless,
            keys=keys,
            changed=tuple(self.found_changes),
        )

    def match_names(self) -> None:
        """Map each name of a part in the merged model to its name in the composition."""
        for each in self.found:
            for namespace, name in elements.named(self.parts[each.part]):
                there = (namespace, self.theirs(each, namespace, name))
                if there in self.there:
                    self.names[there] = each.out + name

    def match_assets(self) -> None:
        """Map assets of the merged model to assets of parts; the others become entries of the recipe."""
        assets = elements.assets_of(self.merged)
        for each in self.base_first:
            unit = self.parts[each.part]
            for (tag, name), node in elements.assets_of(unit).items():
                self.alike[each.out + name] = (tag, *sorted(self.values(node, unit).items()))
                keys = (key for key in ((tag, each.prefix + name), (tag, name)) if key in assets)
                there = next(keys, None)
                if there is not None:
                    self.names.setdefault(there, each.out + name)
        for (tag, name), node in assets.items():
            if (tag, name) not in self.names:
                self.names[tag, name] = name
                values = self.values(node, self.merged)
                shown = {k: elements.written_value(GRAMMAR.element(tag).attributes[k], v) for k, v in values.items()}
                note = "it has elements of its own" if len(node) else None
                if not name:
                    shown = {"name": quoted(""), **shown}
                    name = self.label(f"asset/{tag}", shown.get("type", tag).strip('"'))
                self.entries.append(SectionEntry("asset", f"{word(name)}: {elements.flow(shown)}", note, group=tag))

    def remove_keys(self) -> None:
        keys = [{str(key.get("name")) for key in unit.root.iter("key")} for unit in (self.merged, *self.parts)]
        for name in dict.fromkeys(name for each in self.found for name in sorted(keys[each.part + 1] - keys[0])):
            self.edit({"select": f"{{key: {word(name)}}}", "remove": "true"}, elements.REMOVED)

    def head(self) -> list[str]:
        model = self.merged.model
        return [
            "recipe: 1",
            *([f"name: {word(model)}"] if model else []),
            f"angle: {self.merged.settings.angle}",
            *([f"separator: {quoted(self.separator)}"] if self.separator != "/" else []),
            *(f"base: {word(self.references[each.part])}" for each in self.found if each.is_base),
        ]

    def rename(self) -> dict[str, dict[str, str]]:
        """Rename elements whose names differ in the merged model; return the names that only verification renames."""
        kept: dict[str, dict[str, str]] = defaultdict(dict)
        changed = [(namespace, name, new) for (namespace, name), new in self.names.items() if name != new]
        order = list(dict.fromkeys(namespace for namespace, _, _ in changed))
        for namespace, name, new in sorted(changed, key=lambda change: order.index(change[0])):
            if (namespace, name) in self.there:
                select = elements.selector_of(namespace, self.there[namespace, name].kind.tag, new)
                self.edit({"select": select, "rename": word(name)}, elements.RENAMED)
            else:  # the name of an asset does not matter
                kept[namespace][name] = new
        return dict(kept)

    def label(self, section: str, word: str) -> str:
        """Return an unused key for an unnamed element of a section."""
        kind = section.partition("/")[2] or section
        taken = {name for (namespace, name) in (*self.there, *elements.assets_of(self.merged)) if namespace == kind}
        keys = (word if number == 1 and section.startswith("asset/") else f"{word}_{number}" for number in count(1))
        key = next(key for key in keys if key not in taken | self.labels)
        self.labels.add(key)
        return key

    def attach(self, each: Instance, dropped: list[str]) -> None:
        """Write the attachment of the part; `dropped` are selectors of omitted elements."""
        if each.is_base:
            return
        values = {"model": word(self.references[each.part])}
        parent = parent_body(each.body)
        pose = self.pose(each.body, self.merged) @ self.pose(each.root, self.parts[each.part]).inverse()
        if parent is not None:
            name = self.names.get(("body", str(parent.get("name"))))
            if name is None:
                note = f"no part has the body `{parent.get('name')}` that it is attached to"
                self.entries.append(SectionEntry("attach", f"{each.key}: {elements.flow(values)}", note))
                return
            site = self.site(parent, pose)
            values |= {"site": word(site)} if site is not None else {"body": word(name)}
            pose = Pose() if site is not None else pose
        if pose.quat[0] < 0:
            w, x, y, z = pose.quat
            pose = Pose(pose.pos, (-w, -x, -y, -z))
        if any(abs(value) > _CLOSE for value in pose.pos):
            values["pos"] = elements.numbers(pose.pos)
        if any(abs(a - b) > _CLOSE for a, b in zip(pose.quat, IDENTITY_QUAT, strict=True)):
            values["quat"] = elements.numbers(pose.quat)
        if dropped:
            values["drop"] = f"[{', '.join(dropped)}]"
        self.entries.append(SectionEntry("attach", f"{word(each.key)}: {elements.flow(values)}"))

    def site(self, parent: Node, pose: Pose) -> str | None:
        """Return a part's site in this body with that pose."""
        for each in self.found:
            part = self.parts[each.part]
            body = elements.named(part).get(("body", str(parent.get("name")).removeprefix(each.prefix)))
            if body is not None:
                for site in body.node.iterchildren("site"):
                    if not site.get("name"):
                        continue
                    own = elements.pose_in(
                        elements.effective(elements.named(part)["site", str(site.get("name"))], part), part.settings
                    )
                    near = zip((*own.pos, *own.quat), (*pose.pos, *pose.quat), strict=True)
                    if all(abs(a - b) < 1e-5 for a, b in near):
                        return f"{each.out}{site.get('name')}"
        return None

    def compiler(self) -> None:
        """Write the compiler settings of the whole model that differ from the base."""
        base = [self.parts[each.part] for each in self.found if each.is_base]
        ours, theirs = (
            {str(k): str(v) for unit in units for node in unit.root.iterchildren("compiler") for k, v in node.items()}
            for units in ([self.merged], base)
        )
        attributes = GRAMMAR.section("compiler").attributes
        values = {
            name: elements.written_value(attributes[name], ours[name])
            for name in sorted(SETTABLE & attributes.keys() & ours.keys())
            if ours[name] != theirs.get(name, elements.default_text(attributes[name]))
        }
        if values:
            self.entries.append(SectionEntry("compiler", elements.flow(values)))

    def settings(self) -> None:
        """Write settings of the whole model that differ from the base or from another part."""
        wanted = elements.settings_of(self.merged)
        base = next((elements.settings_of(self.parts[each.part]) for each in self.found if each.is_base), {})
        others = [elements.settings_of(self.parts[each.part]) for each in self.found if not each.is_base]
        settled: dict[str, dict[str, object]] = {}
        for path in dict.fromkeys([*wanted, *base, *(path for other in others for path in other)]):
            section, *inner, name = path
            attribute = GRAMMAR.element("/".join([section, *inner])).attributes.get(name)
            if attribute is None or path == ("size", "nkey"):
                continue  # MuJoCo writes the number of keys, and adds empty ones
            value = wanted.get(path, elements.default_text(attribute))
            said = {each.get(path, value) for each in others} | {base.get(path, elements.default_text(attribute))}
            if value is not None and said != {value}:
                into = settled.setdefault(section, {})
                for tag in inner:
                    into = into.setdefault(tag, {})  # type: ignore[assignment]
                into[name] = elements.written_value(attribute, value)
        self.entries += [SectionEntry(section, elements.nested(values)) for section, values in settled.items()]

    def left_over(self) -> None:
        """Write the elements of the merged model that no part has."""
        named = ((each.out, key) for each in self.found for key in elements.named(self.parts[each.part]))
        brought = {(namespace, out + name) for out, (namespace, name) in named}
        for item in elements.items(self.merged):
            if item.node in self.covered or (item.kind.tag == "frame" and self.is_empty(item.node)):
                continue
            if item.section == "worldbody":
                self._left_in_world(item)
            elif item.section == "contact":
                values = elements.flow({k: word(self.name(a, v)) for k, a, v in self.written(item)})
                self.entries.append(SectionEntry("contact", values, group=item.kind.tag))
            elif item.name:
                self._left_named(item, is_taken=(item.namespace, item.name) in brought)
            else:
                key = self.label(item.section, item.kind.tag)
                text = f"{word(key)}: {{name: {quoted('')}, xml: {quoted(self.fragment(item.node))}}}"
                self.entries.append(SectionEntry(item.section, text))

    def _left_in_world(self, item: ModelElement) -> None:
        parent = item.node.getparent()
        if parent is None or (parent.tag != "worldbody" and parent not in self.covered):
            return  # it comes with its parent
        name = "world" if parent.tag == "worldbody" else self.names.get(("body", str(parent.get("name"))))
        note = None if name else "it is in a body without a name"
        text = f"{{to: {word(name or '?')}, xml: {quoted(self.fragment(item.node))}}}"
        self.entries.append(SectionEntry("add", text, note))

    def _left_named(self, item: ModelElement, is_taken: bool) -> None:
        """Write an element with a name. If a part brings that name, it is taken until the part's element is removed."""
        key = item.name
        if is_taken:
            key = self.label(item.section, f"{item.name}_new")
            select = elements.selector_of(item.namespace, item.kind.tag, key)
            self.edit({"select": select, "rename": word(item.name)}, elements.RENAMED)
        self.entries.append(
            SectionEntry(item.section, f"{word(key)}: {{xml: {quoted(self.fragment(item.node, key))}}}")
        )

    def is_empty(self, frame: Node) -> bool:
        """Return whether an unnamed frame holds only elements of the parts."""
        others = (child for child in frame.iterchildren("*") if child not in self.covered)
        return not frame.get("name") and all(child.tag == "frame" and self.is_empty(child) for child in others)

    def fragment(self, node: Node, called: str | None = None) -> str:
        """Return an element of the merged model as text, with the values from its classes; `called` is its name."""
        section = [node, *node.iterancestors()][-2]  # below the root
        tag = str(node.tag)
        kind = GRAMMAR.within(str(section.tag)).get(str(node.tag))
        around = childclass_of(node)
        text = f"<{tag}"
        names = kind.attributes if kind is not None else map(str, node.keys())
        for name in (each for each in names if each not in ("class", "childclass")):
            value = node.get(name) or self.merged.classes.effective(node, around, name)
            if value is not None:
                shown = self.name(kind.attributes[name], str(value)) if kind is not None else str(value)
                shown = called if called is not None and name == "name" else shown
                text += f" {name}={quoteattr(' '.join(shown.split()))}"
        # Elements of a part exist already, and are moved.
        inside = "".join(self.fragment(child) for child in node.iterchildren("*") if child not in self.covered)
        return f"{text}>{inside}</{tag}>" if inside else f"{text}/>"


class UrdfProposal(Struct):
    """The text of the recipe, and a row for each kind of element with its place."""

    text: str
    rows: tuple[ReadRow, ...]


def _read_urdf(source: Source, context: Context) -> tuple[Unit | None, UrdfChoices]:
    """Return the model of a URDF, or report its faults. If its inertias are the only fault, they are repaired."""
    with Session() as session:
        for choices in (UrdfChoices(visuals="keep"), UrdfChoices(visuals="keep", inertia="repair")):
            reader = UrdfReader(replace(source, urdf=choices), Sink(), session, shown=context.shown)
            unit = reader.unit()
            if unit is not None or {error.code for error in reader.sink.errors} != {INERTIA}:
                break
    for diagnostic in reader.sink.diagnostics:
        if diagnostic.code != UNREAD or diagnostic.severity is Severity.ERROR:
            context.sink.add(diagnostic)
    return unit, choices


def of_urdf(path: Path, target: Path, context: Context) -> UrdfProposal | None:
    """Return a recipe for a URDF that builds, or None if the URDF has faults, which are reported."""
    try:
        source = resolve(str(path.absolute()), relative_to=target.parent, environment=context.environment)
    except SourceError as error:
        context.sink.add(error.at(Span(context.shown(path), 1, 1)))
        return None
    unit, choices = _read_urdf(source, context)
    if unit is None:
        return None
    file = Path(os.path.relpath(path.absolute(), target.absolute().parent)).as_posix()
    file = file if file.startswith(".") else f"./{file}"
    keys = {"visuals": choices.visuals, "inertia": choices.inertia}
    lines = [
        "recipe: 1",
        f"name: {path.name.partition('.')[0]}",
        "",
        "base:",
        f"  model: {file}",
        f"  urdf: {{{', '.join(f'{name}: {value}' for name, value in keys.items() if value)}}}",
    ]
    if any(row.why and not row.is_minor for row in unit.table):
        lines.append(f"  allow: [{UNREAD}]")
    if unit.root.find("actuator") is None and any(each.get("name") for each in unit.root.iter("joint")):
        lines += ["", "# The file commands no joint: `actuators: all` in `urdf` gives each of them a motor."]
    return UrdfProposal("\n".join(lines) + "\n", unit.table)


def table(rows: tuple[ReadRow, ...]) -> list[str]:
    """Return the rows as text: elements that were read, then elements that are not in the model."""
    lines = []
    for heading, is_read in (("read", True), ("not in the model", False)):
        chosen = [row for row in rows if bool(row.why) is not is_read]
        width = max((len(row.called) for row in chosen), default=0)
        lines += [f"{heading}:"] if chosen else []
        lines += [f"  {row.called:{width}}  {row.why or row.became}  ({row.span})" for row in chosen]
    return lines


_LISTS = frozenset({"add", "edit"})
_WHOLE = frozenset({"option", "size", "visual", "statistic", "compiler"})
_ORDER = (
    "attach option size visual statistic compiler asset add contact tendon equality actuator sensor edit keyframe"
).split()


def in_order(entries: Iterable[SectionEntry]) -> list[SectionEntry]:
    """Return entries in the order in which the recipe has them."""
    return sorted(entries, key=lambda entry: (_ORDER.index(entry.section), entry.group, entry.rank))


def recipe_text(proposal: Proposal) -> tuple[str, dict[int, SectionEntry]]:
    """Return the text, and the entry on each line (from 1). Entries with a note are comments."""
    lines = list(proposal.head)
    places: dict[int, SectionEntry] = {}
    for section in _ORDER:
        entries = [entry for entry in proposal.entries if entry.section == section]
        if not entries:
            continue
        lines.append("")
        for line, entry in _lines(section, entries):
            lines.append(line)
            if entry is not None:
                places[len(lines)] = entry
    return "\n".join(lines) + "\n", places


def _lines(section: str, entries: Sequence[SectionEntry]) -> Iterator[tuple[str, SectionEntry | None]]:
    """Yield the lines of a section, each with the entry that it holds."""
    if section in _WHOLE:
        yield f"{_comment(entries)}{section}: {entries[0].text}", entries[0]
        return
    yield f"{_comment(entries)}{section}:", None
    group = note = None
    for entry in in_order(entries):
        if entry.group != group and entry.group:
            group = entry.group
            yield f"{_comment([other for other in entries if other.group == group])}  {group}:", None
        if entry.note is not None and entry.note != note:
            yield f"  # not expressed: {entry.note}", None
        note = entry.note
        dash = "- " if section in _LISTS or section == "contact" else ""
        indent = "    " if entry.group else "  "
        yield f"{indent}{_comment([entry])}{dash}{entry.text}", entry


def _comment(entries: Iterable[SectionEntry]) -> str:
    """Return the mark of a comment for a line that is only about entries with a note."""
    return "# " if all(entry.note is not None for entry in entries) else ""
