"""Compare parts with their state in a merged model, and write the `edit` entries that turn one into the other."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from itertools import takewhile
from pathlib import Path, PurePosixPath

from lxml.etree import _Element as Node

from mjcompose.base.rotation import Pose
from mjcompose.mujoco.arrays import ANGULAR, unit
from mjcompose.text.faults import quoted, word
from mjcompose.tools.importing import elements
from mjcompose.tools.importing.elements import ChangedAttribute, ModelElement, Names, Pair, SectionEntry
from mjcompose.tools.importing.search import Instance, find, name_in_recipe, paired, parent_body, separator_of
from mjcompose.tree.classes import MAIN, childclass_of, default_tag
from mjcompose.tree.files import NAMED_AFTER_FILE
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.select import numbered, parent_of
from mjcompose.tree.unit import Unit

_SEVERAL = 2  # if as many elements change alike, their class changed
_ASSETS = frozenset(("material", *NAMED_AFTER_FILE))
_IN_WORLD = "{body: world}"
_IN_BODIES = ("geom", "site", "joint", "freejoint", "inertial", "light", "camera")
_SORTED = frozenset({"pair", "exclude"})  # MuJoCo orders these in its own way


class ChangeFinder:
    """Compares the parts with their state in the merged model, and writes the edits for the differences."""

    def __init__(
        self,
        merged: Unit,
        parts: list[Unit],
        references: list[str],
        *,
        relative: Callable[[Path], str],
        likeness: Callable[[Instance, Names], elements.Likeness],
    ) -> None:
        self.merged = merged
        self.parts = parts
        self.references = references
        self.relative = relative
        self.found = find(merged, parts)
        self.separator = separator_of(self.found)
        name_in_recipe(self.found, [part.label for part in parts], self.separator)
        self.base_first = sorted(self.found, key=lambda each: not each.is_base)
        self.alike: dict[str, tuple[object, ...]] = {}
        self.there = elements.named(merged)
        self.names: dict[tuple[str, str], str] = {}
        """Names of the merged model to names in the recipe, before it renames anything."""
        self.covered: set[Node] = {each.body for each in self.found}
        self.entries: list[SectionEntry] = []
        self.pairs: list[Pair] = []
        self.labels: set[str] = set()
        self.found_changes: list[ChangedAttribute] = []
        self.places = {unit: elements.places(unit) for unit in (merged, *parts)}
        self.counts = {unit: Counter(kind for kind, _ in found.values()) for unit, found in self.places.items()}
        self.likeness: dict[int, elements.Likeness] = {}
        self.new_names: dict[tuple[int, str, str], str] = {}
        """New names of a part's elements in the merged model, by instance, namespace and name."""
        for each in self.found:
            self.find_renamed(each)
        self.likeness = {id(each): likeness(each, self.names_in_merged(each)) for each in self.found}

    def pair(self, select: str, item: ModelElement, there: ModelElement, each: Instance) -> None:
        """Note an element of a part with its counterpart in the merged model."""
        self.covered.add(there.node)
        self.pairs.append(Pair(select, item, each, changes=self.changes(item, there, each), moved={}))

    def theirs(self, each: Instance, namespace: str | None, name: str) -> str:
        """Return the name in the merged model of an element of a part; without a namespace, of any element."""
        if namespace is not None:
            return self.new_names.get((id(each), namespace, name), each.prefix + name)
        found = (new for (part, _, old), new in self.new_names.items() if part == id(each) and old == name)
        return next(found, each.prefix + name)

    def find_renamed(self, each: Instance) -> None:
        """Find renamed elements: the only new one with that tag in its body, or one with the same references."""
        part = self.parts[each.part]
        names = ((one.prefix, each) for one in self.found for each in elements.named(self.parts[one.part]))
        known = {(namespace, prefix + name) for prefix, (namespace, name) in names}
        new = [item for key, item in self.there.items() if key not in known]
        for (namespace, name), item in elements.named(part).items():
            if (namespace, each.prefix + name) in self.there:
                continue
            alike = [other for other in new if other.namespace == namespace and self.renamed(item, other, each)]
            if len(alike) == 1:
                self.new_names[id(each), namespace, name] = alike[0].name
                new.remove(alike[0])

    def renamed(self, item: ModelElement, other: ModelElement, each: Instance) -> bool:
        if item.section != "worldbody" or other.section != "worldbody":
            return item.section == other.section and self.meant(item, each) == self.meant(other, None)
        if item.kind.tag != other.kind.tag or self.changes(item, other, each):
            return False
        before = parent_body(item.node)
        after = parent_body(other.node)
        if before is None or after is None:
            return before is after and each.is_base
        return self.theirs(each, "body", str(before.get("name"))) == after.get("name")

    def names_in_merged(self, each: Instance) -> Names:
        found: Names = defaultdict(dict)
        for (part, namespace, name), new in self.new_names.items():
            if part == id(each):
                found[namespace][name] = new
        assets = elements.assets_of(self.merged)
        for tag, name in elements.assets_of(self.parts[each.part]):
            if (tag, each.prefix + name) not in assets and (tag, name) in assets:
                found[tag][name] = name
        return dict(found)

    def values(self, node: Node, unit: Unit) -> dict[str, str]:
        """Return the values that an asset writes or gets from its class, with file paths as the recipe needs them."""
        kind = GRAMMAR.element(str(node.tag))
        found = {}
        for name, attribute in kind.attributes.items():
            value = unit.classes.effective(node, None, name)
            if value is not None and name not in ("name", "class"):
                found[name] = " ".join(value.split())
                if attribute.type == "file":
                    settings = unit.settings
                    folder = settings.texture_folder if attribute.folder == "texture" else settings.mesh_folder
                    found[name] = self.relative(unit.directory / folder / value)
        return found

    def edit(self, verbs: dict[str, str], rank: int = 0) -> None:
        self.entries.append(SectionEntry("edit", elements.flow(verbs), rank=rank))

    def pose(self, body: Node, unit: Unit) -> Pose:
        """Return the pose of a body in the body around it, including its frames."""
        pose = elements.pose_in(body, unit.settings)
        for frame in takewhile(lambda above: above.tag == "frame", body.iterancestors()):
            pose = elements.pose_in(frame, unit.settings) @ pose
        return pose

    def compare(self, each: Instance) -> None:
        """Write the edits that turn the part into its state in the merged model."""
        part = self.parts[each.part]
        gone: set[Node] = set()
        for (namespace, name), item in elements.named(part).items():
            there = self.there.get((namespace, self.theirs(each, namespace, name)))
            select = elements.selector_of(namespace, item.kind.tag, each.out + name)
            if there is None or (there.kind.tag != item.kind.tag and not self.same(item.node, there.node, each)):
                if gone.isdisjoint(item.node.iterancestors()):  # others are removed together with their parent
                    gone.add(item.node)
                    self.edit({"select": select, "remove": "true"}, elements.REMOVED + (item.section == "worldbody"))
                continue
            self.covered.add(there.node)
            moved = self.moved(item, there, each)
            changes = self.changes(item, there, each)
            if moved or item.node is each.root:  # the attachment determines its pose
                changes = {k: v for k, v in changes.items() if (each.is_base and not moved) or k not in elements.POSE}
            self.pairs.append(Pair(select, item, each, changes=changes, moved=moved))
            if item.kind.tag == "body":
                self.unnamed(item.node, there.node, elements.selector_of("body", "body", each.out + name), each=each)

    def changes(self, before: ModelElement, after: ModelElement, each: Instance) -> dict[str, str | None]:
        """Return the values that differ between an element of the part and the merged model.

        The result is empty if both mean the same.
        """
        if self.same(before.node, after.node, each):
            return {}
        part = self.parts[each.part]
        degrees = self.merged.settings.angle == "degree"
        one = elements.plain(elements.effective(before, part), before.kind.tag, part.settings, degrees=degrees)
        other = elements.plain(
            elements.effective(after, self.merged), after.kind.tag, self.merged.settings, degrees=degrees
        )
        ends = elements.placed(one, part.settings), elements.placed(other, self.merged.settings)
        if elements.POSE & (one.keys() | other.keys()) and elements.at_the_same_place(*ends):
            for name in (*elements.POSE, "size"):
                one.pop(name, None)
                other.pop(name, None)
        for name, attribute in before.kind.attributes.items():
            if name not in one or name not in other:
                continue
            if attribute.is_reference and self._refer_alike(attribute, one[name], other[name], each):
                del one[name], other[name]
        return elements.differing(one, other, before.kind, prefix=each.prefix)

    def _refer_alike(self, attribute: Attribute, ours: str, theirs: str, each: Instance) -> bool:
        """Return whether references of the part and of the merged model mean the same elements."""
        if theirs.split() == [self.theirs(each, attribute.refers, name) for name in ours.split()]:
            return True
        if attribute.refers not in _ASSETS:
            return False
        # The part may have an equal asset of its own.
        own = self.alike.get(each.out + ours)
        there = self.names.get((attribute.refers, theirs))
        return theirs in (ours, each.prefix + ours) or bool(own and own == self.alike.get(there or ""))

    def same(self, before: Node, after: Node, each: Instance) -> bool:
        """Return whether MuJoCo compiles both to the same result."""
        part = self.parts[each.part]
        likeness = self.likeness.get(id(each), elements.Likeness())
        of_body = before.tag == after.tag == "inertial"
        here, there = (parent_body(node) if of_body else node for node in (before, after))
        if here is None or there is None:
            return False
        one = self.places[part].get(here)
        other = self.places[self.merged].get(there)
        if one is None or other is None or one[0] != other[0] or one[0] in _SORTED:
            return False
        kind = one[0]
        counts = (self.counts[part][one[0]], self.counts[self.merged][one[0]])
        return likeness.counts.get(kind) == counts and (one[1], other[1]) in likeness.same.get(kind, ())

    def changed(self) -> None:
        """Write the entries for all differences; one entry for a class if all values that it sets changed alike."""
        settled: dict[str, dict[str, dict[str, object]]] = {}
        for (_, owner, tag, name), pairs in self.groups().items():
            if not _belongs_to_class(name, pairs):
                continue
            pair = pairs[0]
            value = pair.changes.get(name)
            attribute = pair.item.kind.attributes[name]
            called = owner if pair.each.is_base else pair.each.out + (owner if owner != MAIN else "")
            text = "null" if value is None else elements.written_value(attribute, self.name(attribute, value))
            settled.setdefault(called, {}).setdefault(tag, {})[name] = text
            change = ChangedAttribute(
                "default class", called, f"{tag} {name}", *self.ends(pair, name, value), count=len(pairs)
            )
            self.found_changes.append(change)
            for changed in pairs:
                del changed.changes[name]
        for owner, tags in settled.items():
            self.edit({"select": f"{{default: {word(owner)}}}", "set": elements.nested(dict(tags))}, elements.CLASSES)
        for pair in self.pairs:
            self.change(pair)

    def groups(self) -> dict[tuple[int, str, str, str], list[Pair]]:
        """Return the pairs by instance, class, tag and attribute; only attributes that differ somewhere."""
        groups: dict[tuple[int, str, str, str], list[Pair]] = {}
        different = {name for pair in self.pairs for name in pair.changes}
        for pair in self.pairs:
            for name in pair.item.kind.attributes:
                owner = self.owner(pair, name)
                if owner is not None and name in different:
                    groups.setdefault((id(pair.each), owner, default_tag(pair.item.node), name), []).append(pair)
        return groups

    def ends(self, pair: Pair, name: str, after: str | None) -> tuple[str | None, str | None, str]:
        """Return an attribute's value in the part, its new value, and its unit."""
        return elements.effective(pair.item, self.parts[pair.each.part]).get(name), after, self.unit(pair, name)

    def owner(self, pair: Pair, name: str) -> str | None:
        """Return the class that sets an element's value, or None if the element itself or nothing sets it."""
        node = pair.item.node
        unit = self.parts[pair.each.part]
        if node.get(name) is not None or not pair.item.kind.takes_class:
            return None
        found = unit.classes.get(str(node.get("class") or childclass_of(node) or MAIN))
        given = found.lookup(default_tag(node), name)
        above = None if given is None else given[1].getparent()
        return None if above is None else str(above.get("class") or MAIN)

    def change(self, pair: Pair) -> None:
        attributes = pair.item.kind.attributes
        written = {name: "null" for name, value in pair.changes.items() if value is None}
        for name, value in pair.changes.items():
            if value is not None:
                written[name] = elements.written_value(attributes[name], self.name(attributes[name], value))
        for name, value in pair.changes.items():
            ends = self.ends(pair, name, value)
            if ends[:2] != (None, None):
                self.found_changes.append(ChangedAttribute(pair.item.kind.tag, self.called(pair), name, *ends))
        if pair.changes or pair.moved:
            verbs = {"select": pair.select} | ({"set": elements.flow(written)} if written else {})
            self.edit(verbs | ({"move": elements.flow(pair.moved)} if pair.moved else {}))

    def called(self, pair: Pair) -> str:
        item = pair.item
        name = item.name or (PurePosixPath(str(item.node.get("file") or "")).stem if item.section == "asset" else "")
        if name:
            return pair.each.out + name
        body = parent_body(item.node) if item.section == "worldbody" else None
        is_named = body is not None and body.get("name")
        holder = body if body is not None and is_named else item.node.getparent()
        assert holder is not None
        number = list(holder.iterchildren(item.kind.tag)).index(item.node)
        return f"#{number} of body `{pair.each.out}{holder.get('name')}`" if is_named else f"#{number}"

    def unit(self, pair: Pair, name: str) -> str:
        """Return the unit in which the merged model writes an attribute."""
        kind = pair.item.kind
        attribute = pair.item.kind.attributes[name]
        form = ""
        if kind.tag == "joint" and pair.item.section == "worldbody":
            form = elements.effective(pair.item, self.parts[pair.each.part]).get("type", "hinge")
        if attribute.angle is not None and form in ("", *ANGULAR):
            angle = "deg" if self.merged.settings.angle == "degree" else "rad"
            return angle if attribute.angle == "joint" or form else ""
        arrays = {"joint": ("jnt", "dof"), "camera": ("cam",), "material": ("mat",), "texture": ("tex",)}
        units = (unit(f"{array}_{name}", form) for array in arrays.get(kind.tag, (kind.tag,)))
        return next(filter(None, units), "")

    def compare_assets(self, each: Instance) -> None:
        """Write the edits of the part's own assets; their files remain the part's."""
        part = self.parts[each.part]
        assets = elements.assets_of(self.merged)
        for (tag, name), node in elements.assets_of(part).items():
            there = assets.get((tag, each.prefix + name), assets.get((tag, name)))
            if there is not None:
                kind = GRAMMAR.element(tag)
                select = elements.selector_of(tag, tag, each.out + name)
                item, other = (ModelElement(one, kind, "asset", namespace=tag) for one in (node, there))
                self.pair(select, item, other, each=each)

    def compare_sections(self, each: Instance) -> None:
        """Compare unnamed elements of sections, paired by their references."""
        there: dict[tuple[object, ...], ModelElement] = {}
        for item in elements.items(self.merged):
            if not item.name and item.section != "worldbody":
                there.setdefault(self.meant(item, None), item)
        for item in elements.items(self.parts[each.part]):
            if item.name or item.section == "worldbody":
                continue
            meant = self.meant(item, each)
            references = {k: word(each.out + v) for k, a, v in self.written(item) if a.is_reference}
            select = elements.flow({f"{item.section}/{item.kind.tag}": '"**"', "where": elements.flow(references)})
            found = there.pop(meant, None)
            if found is None or (found.kind != item.kind and not self.same(item.node, found.node, each)):
                self.edit({"select": select, "remove": "true"}, elements.REMOVED)
            else:
                self.pair(select, item, found, each=each)

    def compare_world(self, each: Instance) -> list[str]:
        """Return selectors of unnamed elements in the part's world that the merged model lacks."""
        here, there = (next(unit.root.iterchildren("worldbody"), None) for unit in (self.parts[each.part], self.merged))
        if here is None or there is None:
            return []
        if each.is_base:
            self.unnamed(here, there, _IN_WORLD, each=each)
            return []
        where = {"parent": _IN_WORLD, "where": quoted("${name == ''}")}
        tags = (tag for tag in _IN_BODIES if _without_name(here, tag))
        return [*self.beside(here, each), *(elements.flow({tag: '"**"', **where}) for tag in tags)]

    def beside(self, here: Node, each: Instance) -> list[str]:
        """Compare the bodies without a name next to the part's root; return selectors of the bodies to drop."""
        around = each.body.getparent()
        one, other = (_unnamed(holder, "body") for holder in (here, each.body if around is None else around))
        other = [item for item in other if item.node not in self.covered]
        dropped = []
        for a, b in paired(one, other, lambda a, b: not self.changes(a, b, each)):
            select = _numbered(a.node, _IN_WORLD)
            if b is None or self.changes(a, b, each):
                dropped.append(select)
            else:
                self.covered.add(b.node)
                self.unnamed(a.node, b.node, select, each=each)
        return dropped[::-1]  # a removal must not renumber the following ones

    def meant(self, item: ModelElement, each: Instance | None) -> tuple[object, ...]:
        """Return the identity of an unnamed element: its tag, and its references by their names in the merged model."""
        kind = item.section if item.section == "actuator" else item.kind.path  # MuJoCo writes all of them as `general`
        found = [(k, a, v) for k, a, v in self.written(item) if a.is_reference]
        return (kind, *((k, v if each is None else self.theirs(each, a.refers, v)) for k, a, v in found))

    def moved(self, item: ModelElement, there: ModelElement, each: Instance) -> dict[str, str]:
        """Return the new parent of a body of a part, if it changed."""
        if item.kind.tag != "body" or item.node is each.root:
            return {}
        before = parent_body(item.node)
        after = parent_body(there.node)
        if before is not None and after is not None and not before.get("name") and after in self.covered:
            return {}  # bodies without a name come before their content
        was = "world" if before is None else self.theirs(each, "body", str(before.get("name")))
        name = "world" if after is None else str(after.get("name"))
        if was == name:
            return {}
        pose = self.pose(there.node, self.merged)
        to = {"to": word(self.names.get(("body", name), name))}
        return to | {"pos": elements.numbers(pose.pos), "quat": elements.numbers(pose.quat)}

    def unnamed(self, before: Node, after: Node, parent: str, each: Instance) -> None:
        """Compare unnamed elements, paired by their order; `parent` is the selector of their parent."""
        for tag in (*_IN_BODIES, "body"):
            one = _unnamed(before, tag)
            other = _unnamed(after, tag)
            for a, b in paired(one, other, lambda a, b: not self.changes(a, b, each)):
                select = _numbered(a.node, parent)
                if b is None:
                    self.edit({"select": select, "remove": "true"}, elements.REMOVED - one.index(a))
                else:
                    self.pair(select, a, b, each=each)
                    if tag == "body":
                        self.unnamed(a.node, b.node, select, each=each)

    def written(self, item: ModelElement) -> Iterator[tuple[str, Attribute, str]]:
        for name, attribute in item.kind.attributes.items():
            if item.node.get(name) is not None and name != "class":
                yield name, attribute, str(item.node.get(name))

    def name(self, attribute: Attribute, value: str) -> str:
        """Return a value with the names that the recipe uses."""
        if not attribute.is_reference or attribute.refers is None:
            return value
        return " ".join(self.names.get((attribute.refers, each), each) for each in value.split())


def _belongs_to_class(name: str, pairs: list[Pair]) -> bool:
    """Return whether the value of a class changed, because the values of all its elements changed alike."""
    values = {pair.changes.get(name) for pair in pairs}
    if len(values) > 1:
        return False
    if values == {None}:  # an element cannot remove a value of its class: only the class can
        return all(name in pair.changes for pair in pairs)
    return len(pairs) >= _SEVERAL


def _numbered(node: Node, parent: str) -> str:
    """Return the selector of an element without a name, by the selector of its parent and its number there."""
    tag = str(node.tag)
    around = parent_of(node)
    assert around is not None
    number = numbered(around, tag)[node]
    where = {} if tag == "inertial" else {"where": quoted(f"${{index == {number}}}")}
    return elements.flow({tag: '"**"', "parent": parent, **where})


def _without_name(body: Node, tag: str) -> list[Node]:
    return [node for node in body.iterchildren(tag) if not node.get("name")]


def _unnamed(body: Node, tag: str) -> list[ModelElement]:
    kind = GRAMMAR.within("worldbody")[tag]
    return [ModelElement(node, kind, "worldbody", namespace=tag) for node in _without_name(body, tag)]
