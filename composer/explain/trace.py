"""Record what happens to every element during composition.

Elements are compared by identity after each pass and step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import field
from types import FunctionType
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.linking import Linking
from composer.link.part import Part
from composer.tree.line import line_of
from composer.tree.origin import Origins, Place
from composer.tree.unit import Unit
from composer.tree.write import as_it_is

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

Owner = str | Span | Place
Function = Callable[..., object]
TAG = "<tag>"


@dataclass(frozen=True, slots=True)
class Cause:
    """What was done, as reported to the `Watch`, and the tree and part in which it changed something."""

    done: object
    unit: Unit
    part: Part | None = None
    linking: Linking | None = None

    @property
    def function(self) -> Function | None:
        """The pass or other function that ran; None for a step, a source or a plan."""
        return self.done if isinstance(self.done, FunctionType) else None

    @property
    def is_pass(self) -> bool:
        return callable(self.done)


@dataclass(frozen=True, slots=True)
class Change:
    """A new value of an attribute or of `TAG`; None if it is not written.

    `owner` knows where the new value is written.
    """

    attribute: str
    before: str | None
    after: str | None
    cause: Cause
    owner: Owner


@dataclass(frozen=True, slots=True)
class Move:
    """A new parent."""

    before: Node | None
    after: Node | None
    cause: Cause


@dataclass(eq=False, slots=True)
class Life:
    """Everything known of one element: its first state, its changes, and its end.

    `born` is the cause after which it was first seen; `made_by` is the same cause, or None for an element that was
    read from a file. `home` is the root of the tree that it was last seen in. `parts` are the parts that it belongs
    to, the innermost first; `sources` are the elements that it replaces.
    """

    node: Node
    root: Node
    owner: Owner
    line: int | None
    tag: str
    attributes: dict[str, str]
    parent: Node | None
    home: Node
    made_by: Cause | None
    born: Cause
    changes: list[Change | Move] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    sources: list[Life] = field(default_factory=list)
    gone: Cause | None = None
    items: list[tuple[str, str]] = field(default_factory=list)
    last_tag: str = ""
    last_parent: Node | None = None

    def span(self, origins: Origins, attribute: str | None = None, owner: Owner | None = None) -> Span:
        """Return where the element was first written, or the value of an attribute there."""
        owner = self.owner if owner is None else owner
        if isinstance(owner, Span):
            return owner
        if not isinstance(owner, str):
            return owner(attribute)
        return origins.in_file(owner, self.line, self.tag, written=self.attributes, attribute=attribute)

    @property
    def name(self) -> str | None:
        """Its name when it was first seen."""
        return self.attributes.get("class" if self.tag == "default" else "name")

    def of(self, attribute: str) -> list[Change]:
        """Return the changes of one attribute."""
        return [each for each in self.changes if isinstance(each, Change) and each.attribute == attribute]


class Trace:
    """A `Watch` that records. It holds every node, so that identities stay valid."""

    def __init__(self) -> None:
        self.lives: dict[Node, Life] = {}
        self.gone: list[Life] = []
        self._members: dict[Node, list[Node]] = {}
        self._texts: dict[Node, bytes] = {}
        self._linkings: dict[Node, Linking] = {}
        self._parts: dict[Node, Part] = {}

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        units = list(units)
        if isinstance(done, Linking):
            self._announce(done)
        changed = [unit for unit in units if self._looks_other(unit.root)]
        if not changed:
            return
        linking = self._linkings.get(units[0].root)
        causes = {
            unit.root: Cause(done, unit, self._parts.get(unit.root), linking=linking) for unit in units
        }  # fmt: skip
        before = {node for unit in changed for node in self._members.get(unit.root, ())}
        now: set[Node] = set()
        born: list[Life] = []
        for unit in changed:
            cause = causes[unit.root]
            members = self._members[unit.root] = list(unit.root.iter("*"))
            now.update(members)
            for node in members:
                life = self.lives.get(node)
                if life is None:
                    born.append(self._born(node, cause))
                else:
                    self._compare(life, causes.get(life.home, cause), unit)
                    life.home = unit.root
        lost = [self.lives[node] for node in before - now]
        for life in lost:
            life.gone = causes.get(life.home)
        self.gone += [life for life in lost if life.gone is not None]
        for life in born:
            if life.made_by is not None and life.made_by.is_pass and life.tag != "default":
                self._succeed(life, lost)

    def _looks_other(self, root: Node) -> bool:
        """Return whether a tree is not what it was: to write it takes a tenth of the time to compare its elements."""
        text = as_it_is(root)
        same = self._texts.get(root) == text and self._members[root] == list(root.iter("*"))
        self._texts[root] = text
        return not same

    def life(self, node: Node) -> Life:
        return self.lives[node]

    def written(self, unit: Unit, tag: str, attribute: str) -> Life | None:
        """Return the element with that tag in which a unit, as read, sets an attribute."""
        found = None
        for life in self.lives.values():
            if life.root is unit.root and life.tag == tag and attribute in life.attributes:
                found = life
        return found

    def _announce(self, linking: Linking) -> None:
        self._linkings[linking.base.root] = linking
        for part in linking.parts:
            self._parts[part.unit.root] = part
            for node in part.unit.root.iter("*"):
                self.lives[node].parts.append(part)

    def _born(self, node: Node, cause: Cause) -> Life:
        owner = cause.unit.origins.owner(node, cause.unit.file)
        laid_out = (
            node in cause.unit.origins.keys
        )  # by the edits of a part that is not linked to anything yet
        made = cause if cause.linking is not None or laid_out else None
        items: list[tuple[str, str]] = node.items()  # type: ignore[assignment]  # of a parsed tree
        parent = node.getparent()
        root = cause.unit.root
        life = Life(
            node,
            root,
            owner,
            line=line_of(node),
            tag=str(node.tag),
            attributes=dict(items),
            parent=parent,
            home=root,
            made_by=made,
            born=cause,
            items=items,
            last_tag=str(node.tag),
            last_parent=parent,
        )
        self.lives[node] = life
        part = cause.part or (_carried(life, cause.linking) if cause.linking is not None else None)
        if part is not None and made is not None and made.is_pass:
            life.made_by = Cause(cause.done, part.unit, part, linking=cause.linking)
            life.parts.append(part)
        return life

    def _compare(self, life: Life, cause: Cause, unit: Unit) -> None:
        items: list[tuple[str, str]] = life.node.items()  # type: ignore[assignment]
        tag = life.node.tag
        if items != life.items or tag != life.last_tag:
            owner = unit.origins.owner(life.node, unit.file)
            if tag != life.last_tag:
                life.changes.append(Change(TAG, life.last_tag, str(tag), cause=cause, owner=owner))
                life.last_tag = str(tag)
            life.changes += _differences(dict(life.items), dict(items), cause, owner=owner)
            life.items = items
        parent = life.node.getparent()
        if parent is not life.last_parent:
            life.changes.append(Move(life.last_parent, parent, cause))
            life.last_parent = parent

    def _succeed(self, life: Life, lost: list[Life]) -> None:
        """Link an element that a pass wrote anew to those that it replaces: removed ones with the same tag and name."""
        assert life.made_by is not None
        record = life.made_by.unit.origins.keys.get(life.node)
        if record is not None:
            life.sources += [self.lives[key] for key in record.keys if key in self.lives]
        else:
            for old in lost:
                if old.tag == life.tag and dict(old.items).get("name") == life.name:
                    life.sources.append(old)
        if len(life.sources) == 1:
            life.changes += _differences(
                dict(life.sources[0].items), life.attributes, life.made_by, owner=life.owner
            )


def _differences(
    before: dict[str, str], after: dict[str, str], cause: Cause, owner: Owner
) -> Iterator[Change]:
    for name in {**before, **after}:
        if before.get(name) != after.get(name):
            yield Change(name, before.get(name), after.get(name), cause=cause, owner=owner)


def _carried(life: Life, linking: Linking) -> Part | None:
    """Return the part for which the linker created an element, such as the frame of its attachment."""
    for part in linking.parts:
        carries = {"frame": "childclass", "default": "class"}.get(life.tag, "")
        if part.top_class and life.attributes.get(carries) == part.top_class:
            return part
        if part.span is not None and life.owner in (part.span, part.sense and part.sense.span):
            return part
    return None
