"""The recipe that makes a merged model of its parts, as entries that can be left out one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from composer.document.quote import quoted
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.importing.alignment import paired
from composer.importing.elements import (
    Item,
    assets_of,
    default_text,
    differing,
    effective,
    items,
    named,
    settings_of,
)
from composer.importing.flow import flow, flow_list, nested, numbers, word
from composer.importing.match import Instance, find, name_in_recipe, parent_body, separator_of
from composer.link.placing import read_pose
from composer.pose import IDENTITY_QUAT, Pose
from composer.tree.classes import childclass_of
from composer.tree.files import NAMED_AFTER_FILE
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_CLOSE = 1e-9  # metres, and parts of a quaternion


@dataclass(slots=True)
class Entry:
    """One thing that the recipe says, in its section; `note` says why it is only a comment.

    Entries of a section stand in groups, and in these by `rank`: what is removed while it is counted goes last.
    """

    section: str
    text: str
    note: str | None = None
    group: str = ""
    rank: int = 0


@dataclass(slots=True)
class Proposal:
    """The recipe; `renamed` are names of the merged model by kind, and what the recipe calls them."""

    head: list[str]
    entries: list[Entry]
    found: list[Instance]
    renamed: dict[str, dict[str, str]] = field(default_factory=dict)
    alike: dict[str, tuple[object, ...]] = field(default_factory=dict)
    """What each asset of a part is, by its name in the recipe."""
    christened: tuple[str, ...] = ()
    """Assets of the merged model without a name, by tag and number; a recipe gives them one."""


def propose(
    merged: Unit, parts: list[Unit], references: list[str], relative: Callable[[Path], str]
) -> Proposal:
    """What makes `merged` of `parts`, called by `references`; `relative` writes the path of a file. No I/O."""
    found = find(merged, parts)
    separator = separator_of(found)
    name_in_recipe(found, [part.label for part in parts], separator)
    return _Proposer(merged, parts, references, found, separator, relative).proposal()


class _Proposer:
    def __init__(
        self,
        merged: Unit,
        parts: list[Unit],
        references: list[str],
        found: list[Instance],
        separator: str,
        relative: Callable[[Path], str],
    ) -> None:
        self.merged, self.parts, self.references, self.found = merged, parts, references, found
        self.relative = relative
        self.alike: dict[str, tuple[object, ...]] = {}
        self.separator = separator
        self.there = named(merged)
        self.names: dict[tuple[str, str], str] = {}
        """Names of the merged model to names in the recipe, before it renames anything."""
        self.covered: set[Node] = {each.body for each in found}
        self.christened: list[str] = []
        self.entries: list[Entry] = []

    def proposal(self) -> Proposal:
        assets = assets_of(self.merged)
        for each in self.found:
            part = named(self.parts[each.part])
            for (namespace, name), _ in part.items():
                if (namespace, each.prefix + name) in self.there:
                    self.names[namespace, each.prefix + name] = each.out + name
        for each in sorted(self.found, key=lambda each: not each.is_base):
            unit = self.parts[each.part]
            for (tag, name), node in assets_of(unit).items():
                self.alike[each.out + name] = (tag, *sorted(self.values(node, unit).items()))
                for there in (each.prefix + name, name):
                    if (tag, there) in assets:
                        self.names.setdefault((tag, there), each.out + name)
                        break
        for (tag, name), node in assets.items():
            if (tag, name) not in self.names:
                self.names[tag, name] = name
                values = self.values(node, self.merged)
                shown = {k: _value(GRAMMAR.element(tag).attributes[k], v) for k, v in values.items()}
                nested = "it has elements of its own" if len(node) else None
                if not name:  # a recipe has names for all assets
                    number = list(self.merged.root.iterfind(f"asset/{tag}")).index(node)
                    self.christened.append(f"{tag} #{number}")
                    name = shown.get("type", tag).strip('"')
                self.entries.append(Entry("asset", f"{word(name)}: {flow(shown)}", nested, tag))
        for each in self.found:
            self.compare_assets(each)
            self.compare(each)
            self.attach(each, self.compare_world(each))
            self.compare_sections(each)
        keys = [
            {str(key.get("name")) for key in unit.root.iter("key")} for unit in (self.merged, *self.parts)
        ]
        for name in dict.fromkeys(
            name for each in self.found for name in sorted(keys[each.part + 1] - keys[0])
        ):
            self.edit({"select": f"{{key: {word(name)}}}", "remove": "true"}, _REMOVED)
        self.settings()
        self.left_over()
        model = self.merged.model
        head = ["recipe: 1", *([f"name: {word(model)}"] if model else [])]
        head += [f"angle: {self.merged.settings.angle}"]
        if self.separator != "/":
            head.append(f"separator: {quoted(self.separator)}")
        head += [f"base: {word(self.references[each.part])}" for each in self.found if each.is_base]
        renamed: dict[str, dict[str, str]] = {}
        for (namespace, name), new in self.names.items():
            if name != new:
                renamed.setdefault(namespace, {})[name] = new
        for namespace, pairs in renamed.items():
            for name, new in pairs.items():
                if (namespace, name) not in self.there:
                    continue  # an asset is what it is under any name
                tag = self.there[namespace, name].kind.tag
                select = _selector(namespace, tag, new)
                self.edit({"select": select, "rename": word(name)}, _RENAMED)
        renamed = {  # the others have their names again at the end
            namespace: {name: new for name, new in pairs.items() if (namespace, name) not in self.there}
            for namespace, pairs in renamed.items()
        }
        return Proposal(head, self.entries, self.found, renamed, self.alike, tuple(self.christened))

    def values(self, node: Node, unit: Unit) -> dict[str, str]:
        """What is written of an asset, or comes from its class; files as the recipe finds them."""
        kind = GRAMMAR.element(str(node.tag))
        found = {}
        for name, attribute in kind.attributes.items():
            value = unit.classes.effective(node, None, name)
            if value is None or name in ("name", "class"):
                continue
            found[name] = " ".join(value.split())
            if attribute.type == "file":
                settings = unit.settings
                folder = settings.texture_folder if attribute.folder == "texture" else settings.mesh_folder
                found[name] = self.relative(unit.directory / folder / value)
        return found

    def edit(self, verbs: dict[str, str], rank: int = 0) -> None:
        self.entries.append(Entry("edit", flow(verbs), rank=rank))

    def attach(self, each: Instance, dropped: list[str]) -> None:
        """How the part hangs; `dropped` are selectors of what is left out of it."""
        if each.is_base:
            return
        values = {"model": word(self.references[each.part])}
        parent = parent_body(each.body)
        pose = self.pose(each.body, self.merged) @ self.pose(each.root, self.parts[each.part]).inverse()
        if parent is not None:
            name = self.names.get(("body", str(parent.get("name"))))
            if name is None:
                note = f"the body `{parent.get('name')}` that it hangs on is in none of the parts"
                self.entries.append(Entry("attach", f"{each.key}: {flow(values)}", note))
                return
            site = self.site(parent, pose)
            values |= {"site": word(site)} if site is not None else {"body": word(name)}
            pose = Pose() if site is not None else pose
        if pose.quat[0] < 0:
            w, x, y, z = pose.quat
            pose = Pose(pose.pos, (-w, -x, -y, -z))
        if any(abs(value) > _CLOSE for value in pose.pos):
            values["pos"] = numbers(pose.pos)
        if any(abs(a - b) > _CLOSE for a, b in zip(pose.quat, IDENTITY_QUAT, strict=True)):
            values["quat"] = numbers(pose.quat)
        if dropped:
            values["drop"] = f"[{', '.join(dropped)}]"
        self.entries.append(Entry("attach", f"{word(each.key)}: {flow(values)}"))

    def site(self, parent: Node, pose: Pose) -> str | None:
        """The site of a part that stands in the body and has that pose."""
        for each in self.found:
            part = self.parts[each.part]
            name = str(parent.get("name")).removeprefix(each.prefix)
            body = named(part).get(("body", name))
            for site in body.node.iterchildren("site") if body is not None else ():
                own = read_pose(
                    effective(named(part)["site", str(site.get("name"))], part) if site.get("name") else site,
                    part.settings.angle == "degree",
                    part.settings.eulerseq,
                )
                near = zip((*own.pos, *own.quat), (*pose.pos, *pose.quat), strict=True)
                if site.get("name") and all(abs(a - b) < 1e-5 for a, b in near):
                    return f"{each.out}{site.get('name')}"
        return None

    def pose(self, body: Node, unit: Unit) -> Pose:
        """The pose of a body in the body around it, through its frames."""
        pose = read_pose(body, unit.settings.angle == "degree", unit.settings.eulerseq)
        parent = body.getparent()
        while parent is not None and parent.tag == "frame":
            pose = read_pose(parent, unit.settings.angle == "degree", unit.settings.eulerseq) @ pose
            parent = parent.getparent()
        return pose

    def compare(self, each: Instance) -> None:
        """The edits that make of the part what it is in the merged model."""
        part = self.parts[each.part]
        gone: set[Node] = set()
        for (namespace, name), item in named(part).items():
            there = self.there.get((namespace, each.prefix + name))
            select = _selector(namespace, item.kind.tag, each.out + name)
            if there is None or there.kind.tag != item.kind.tag:
                if not gone.isdisjoint(item.node.iterancestors()):
                    continue  # it goes with what it stands in
                gone.add(item.node)
                self.edit({"select": select, "remove": "true"}, _REMOVED + (item.section == "worldbody"))
                continue
            self.covered.add(there.node)
            moved = self.moved(item, there, each)
            changes = self.changes(item, there, each)
            if moved or item.node is each.root:  # its place is said by the attachment
                changes = {k: v for k, v in changes.items() if (each.is_base and not moved) or k not in _POSE}
            self.change(select, item, changes, moved)
            if item.kind.tag == "body":
                self.unnamed(item.node, there.node, f'//body[@name="{each.out}{name}"]', each)

    def changes(self, before: Item, after: Item, each: Instance) -> dict[str, str | None]:
        """What an element of the part is otherwise in the merged model."""
        one, other = effective(before, self.parts[each.part]), effective(after, self.merged)
        for name, attribute in before.kind.attributes.items():
            if attribute.refers in _ASSETS and name in one and name in other:
                own, there = (
                    self.alike.get(each.out + one[name]),
                    self.names.get((attribute.refers, other[name])),
                )
                if other[name] in (one[name], each.prefix + one[name]) or (
                    own and own == self.alike.get(there or "")
                ):
                    del one[name], other[name]  # the part has its own that is the same
        return differing(one, other, before.kind, each.prefix)

    def change(self, select: str, item: Item, changes: dict[str, str | None], moved: dict[str, str]) -> None:
        attributes = item.kind.attributes
        written = {
            k: _value(attributes[k], self.name(attributes[k], v)) for k, v in changes.items() if v is not None
        }
        unset = [k for k, v in changes.items() if v is None]
        if changes or moved:
            verbs = {"select": select} | ({"unset": flow_list(unset)} if unset else {})
            verbs |= {"set": flow(written)} if written else {}
            self.edit(verbs | ({"move": flow(moved)} if moved else {}))

    def compare_assets(self, each: Instance) -> None:
        """The edits of the part's own assets; those of meshes and textures from files stay its own."""
        part, assets = self.parts[each.part], assets_of(self.merged)
        for (tag, name), node in assets_of(part).items():
            there = assets.get((tag, each.prefix + name), assets.get((tag, name)))
            if there is None or tag in NAMED_AFTER_FILE:
                continue
            kind = GRAMMAR.element(tag)
            item = Item(node, kind, "asset", tag)
            changes = self.changes(item, Item(there, kind, "asset", tag), each)
            self.change(_selector(tag, tag, each.out + name), item, changes, {})

    def compare_sections(self, each: Instance) -> None:
        """What has no name in a section is taken for what refers to the same."""
        there: dict[tuple[object, ...], Item] = {}
        for item in items(self.merged):
            if not item.name and item.section != "worldbody":
                there.setdefault(self.meant(item, ""), item)
        for item in items(self.parts[each.part]):
            if item.name or item.section == "worldbody":
                continue
            meant = self.meant(item, each.prefix)
            references = {k: word(each.out + v) for k, a, v in self.written(item) if a.is_reference}
            select = flow({f"{item.section}/{item.kind.tag}": '"**"', "where": flow(references)})
            found = there.pop(meant, None)
            if found is None:
                self.edit({"select": select, "remove": "true"}, _REMOVED)
            else:
                self.covered.add(found.node)
                self.change(select, item, self.changes(item, found, each), {})

    def meant(self, item: Item, prefix: str) -> tuple[object, ...]:
        """What an element is about: its tag, and what it refers to as the merged model calls it."""
        return (item.kind.path, *((k, prefix + v) for k, a, v in self.written(item) if a.is_reference))

    def compare_world(self, each: Instance) -> list[str]:
        """Selectors of what has no name in the part's own world and is not in the merged model's."""
        here, there = (
            next(unit.root.iterchildren("worldbody"), None) for unit in (self.parts[each.part], self.merged)
        )
        if here is None or there is None:
            return []
        if each.is_base:
            self.unnamed(here, there, "worldbody", each)
            return []
        return [
            flow({"xpath": quoted(f"worldbody/{tag}[not(@name)][{number}]")})
            for tag in _IN_BODIES
            for number, _ in enumerate(_without_name(here, tag), 1)
        ]

    def moved(self, item: Item, there: Item, each: Instance) -> dict[str, str]:
        """Where a body of a part went, if it stands in another one than it did."""
        if item.kind.tag != "body" or item.node is each.root:
            return {}
        before, after = parent_body(item.node), parent_body(there.node)
        was = "world" if before is None else each.prefix + str(before.get("name"))
        name = "world" if after is None else str(after.get("name"))
        if was == name:
            return {}
        pose = self.pose(there.node, self.merged)
        to = {"to": word(self.names.get(("body", name), name))}
        return to | {"pos": numbers(pose.pos), "quat": numbers(pose.quat)}

    def unnamed(self, before: Node, after: Node, path: str, each: Instance) -> None:
        """What has no name is taken for what stands in its order; `path` is the XPath of what it stands in."""
        for tag in _IN_BODIES:
            kind = GRAMMAR.within("worldbody")[tag]
            one, other = (
                [Item(node, kind, "worldbody", tag) for node in _without_name(body, tag)]
                for body in (before, after)
            )
            for a, b in paired(one, other, lambda a, b: not self.changes(a, b, each)):
                which = "" if tag == "inertial" else f"[not(@name)][{one.index(a) + 1}]"
                select = flow({"xpath": quoted(f"{path}/{tag}{which}")})
                if b is None:
                    self.edit({"select": select, "remove": "true"}, _REMOVED - one.index(a))
                else:
                    self.covered.add(b.node)
                    self.change(select, a, self.changes(a, b, each), {})

    def settings(self) -> None:
        """Settings of the whole model that are not what the base says, or that a part says otherwise."""
        wanted = settings_of(self.merged)
        base = next((settings_of(self.parts[each.part]) for each in self.found if each.is_base), {})
        others = [settings_of(self.parts[each.part]) for each in self.found if not each.is_base]
        settled: dict[str, dict[str, object]] = {}
        for path in dict.fromkeys([*wanted, *base, *(path for other in others for path in other)]):
            section, *inner, name = path
            attribute = GRAMMAR.element("/".join([section, *inner])).attributes.get(name)
            if attribute is None:
                continue
            value = wanted.get(path, default_text(attribute))
            said = {each.get(path, value) for each in others}
            if value is not None and (
                base.get(path, default_text(attribute)) != value or (said and said != {value})
            ):
                into = settled.setdefault(section, {})
                for tag in inner:
                    into = into.setdefault(tag, {})  # type: ignore[assignment]
                into[name] = _value(attribute, value)
        for section, values in settled.items():
            self.entries.append(Entry(section, nested(values)))

    def left_over(self) -> None:
        """What the merged model has and no part."""
        for item in items(self.merged):
            node = item.node
            if node in self.covered:
                continue
            if item.section == "worldbody":
                parent = node.getparent()
                if parent is None or (parent.tag != "worldbody" and parent not in self.covered):
                    continue  # it comes with what it stands in
                name = (
                    "world"
                    if parent.tag == "worldbody"
                    else self.names.get(("body", str(parent.get("name"))))
                )
                text = self.fragment(node)
                note = None if name else "it stands in a body without a name"
                self.entries.append(Entry("add", f"{{to: {word(name or '?')}, xml: {quoted(text)}}}", note))
            elif item.section == "contact":
                values = flow({k: word(self.name(a, v)) for k, a, v in self.written(item)})
                self.entries.append(Entry("contact", values, group=item.kind.tag))
            elif item.name:
                text = f"{word(item.name)}: {{xml: {quoted(self.fragment(node))}}}"
                self.entries.append(Entry(item.section, text))
            else:
                count = 1 + sum(entry.section == item.section for entry in self.entries)
                text = f"{item.kind.tag}_{count}: {{xml: {quoted(self.fragment(node))}}}"
                self.entries.append(Entry(item.section, text))

    def written(self, item: Item) -> Iterator[tuple[str, Attribute, str]]:
        for name, attribute in item.kind.attributes.items():
            if item.node.get(name) is not None and name != "class":
                yield name, attribute, str(item.node.get(name))

    def name(self, attribute: Attribute, value: str) -> str:
        """A value with its names as the recipe has them."""
        if not attribute.is_reference or attribute.refers is None:
            return value
        return " ".join(self.names.get((attribute.refers, each), each) for each in value.split())

    def fragment(self, node: Node) -> str:
        """An element of the merged model as text, with the values that its classes give it."""
        kind = GRAMMAR.within(str(_section(node).tag)).get(str(node.tag))
        around = childclass_of(node)
        tag = str(node.tag)
        text = f"<{tag}"
        for name in kind.attributes if kind is not None else map(str, node.keys()):
            if name in ("class", "childclass"):
                continue
            value = node.get(name) or self.merged.classes.effective(node, around, name)
            if value is not None:
                shown = self.name(kind.attributes[name], str(value)) if kind is not None else str(value)
                text += f" {name}={quoteattr(' '.join(shown.split()))}"
        # What a part has stands there already, and is moved.
        inside = "".join(
            self.fragment(child) for child in node.iterchildren("*") if child not in self.covered
        )
        return f"{text}>{inside}</{tag}>" if inside else f"{text}/>"


# Before what is removed by its number all is changed, and what refers to something goes before it does; names are
# as the parts have them until the end.
_REMOVED, _RENAMED = 10_000, 20_000
_ASSETS = frozenset(("material", *NAMED_AFTER_FILE))
_IN_BODIES = ("geom", "site", "joint", "freejoint", "inertial", "light", "camera")
_POSE = frozenset({"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"})


def _without_name(body: Node, tag: str) -> list[Node]:
    return [node for node in body.iterchildren(tag) if not node.get("name")]


def _section(node: Node) -> Node:
    parent = node.getparent()
    while parent is not None and parent.tag != "mujoco":
        node, parent = parent, parent.getparent()
    return node


def _selector(namespace: str, tag: str, name: str) -> str:
    kind = namespace if namespace in ("actuator", "sensor", "equality", "tendon") else tag
    return f"{{{kind}: {word(name)}}}"


def _value(attribute: Attribute, text: str) -> str:
    parts = text.split()
    if attribute.separated and (attribute.max_length != 1):
        return flow_list(parts)
    if attribute.type == "bool" or attribute.is_number:
        return text
    return word(text)
