"""What makes the parts of a merged model what they are in it: the entries of `edit`, found by comparing the two."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from composer.document.quote import quoted
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.importing.alignment import paired
from composer.importing.elements import (
    Item,
    assets_of,
    differing,
    effective,
    items,
    named,
)
from composer.importing.flow import flow, flow_list, numbers, word
from composer.importing.match import Instance, parent_body
from composer.link.placing import read_pose
from composer.pose import Pose
from composer.tree.files import NAMED_AFTER_FILE
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

# Before what is removed by its number all is changed, and what refers to something goes before it does; names are
# as the parts have them until the end.
REMOVED, RENAMED = 10_000, 20_000
_ASSETS = frozenset(("material", *NAMED_AFTER_FILE))
_IN_BODIES = ("geom", "site", "joint", "freejoint", "inertial", "light", "camera")
_POSE = frozenset({"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"})


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


class Comparison:
    """Compares the parts with what they are in the merged model, and writes down the edits that make up for it."""

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
            select = selector_of(namespace, item.kind.tag, each.out + name)
            if there is None or there.kind.tag != item.kind.tag:
                if not gone.isdisjoint(item.node.iterancestors()):
                    continue  # it goes with what it stands in
                gone.add(item.node)
                self.edit({"select": select, "remove": "true"}, REMOVED + (item.section == "worldbody"))
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
            k: written_value(attributes[k], self.name(attributes[k], v))
            for k, v in changes.items()
            if v is not None
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
            self.change(selector_of(tag, tag, each.out + name), item, changes, {})

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
                self.edit({"select": select, "remove": "true"}, REMOVED)
            else:
                self.covered.add(found.node)
                self.change(select, item, self.changes(item, found, each), {})

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

    def meant(self, item: Item, prefix: str) -> tuple[object, ...]:
        """What an element is about: its tag, and what it refers to as the merged model calls it."""
        return (item.kind.path, *((k, prefix + v) for k, a, v in self.written(item) if a.is_reference))

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
                    self.edit({"select": select, "remove": "true"}, REMOVED - one.index(a))
                else:
                    self.covered.add(b.node)
                    self.change(select, a, self.changes(a, b, each), {})

    def written(self, item: Item) -> Iterator[tuple[str, Attribute, str]]:
        for name, attribute in item.kind.attributes.items():
            if item.node.get(name) is not None and name != "class":
                yield name, attribute, str(item.node.get(name))

    def name(self, attribute: Attribute, value: str) -> str:
        """A value with its names as the recipe has them."""
        if not attribute.is_reference or attribute.refers is None:
            return value
        return " ".join(self.names.get((attribute.refers, each), each) for each in value.split())


def _without_name(body: Node, tag: str) -> list[Node]:
    return [node for node in body.iterchildren(tag) if not node.get("name")]


def selector_of(namespace: str, tag: str, name: str) -> str:
    kind = namespace if namespace in ("actuator", "sensor", "equality", "tendon") else tag
    return f"{{{kind}: {word(name)}}}"


def written_value(attribute: Attribute, text: str) -> str:
    parts = text.split()
    if attribute.separated and (attribute.max_length != 1):
        return flow_list(parts)
    if attribute.type == "bool" or attribute.is_number:
        return text
    return word(text)
