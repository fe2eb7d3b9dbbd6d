"""A model while it is migrated: its tree, its files, and what was done to it and why."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Protocol

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Cause
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.grammar.history import place, spans
from composer.grammar.version import exists_in, version_key
from composer.migrate.markup import is_made, made
from composer.migrate.released import RELEASED
from composer.tree.classes import childclass_of
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


@dataclass(frozen=True, slots=True)
class Step:
    """One thing that was done: by which change, where, and what in words."""

    change: str
    span: Span | None
    words: str


@dataclass(frozen=True, slots=True)
class Meaning:
    """Something that is not the same any more; `arrays` are those of `mjModel` in which that would show, if any."""

    change: str
    message: str
    span: Span | None
    help: str | None
    arrays: tuple[str, ...] = ()


class ChangeInProgress(Protocol):
    """What an `Editing` needs of the change that is being carried out."""

    @property
    def name(self) -> str: ...
    @property
    def version(self) -> str: ...
    @property
    def arrays(self) -> tuple[str, ...]: ...


@dataclass(slots=True)
class Editing:
    """`before` and `after` are the versions from which and to which the model goes.

    `whole` are the model and those that it attaches, each with its own tree; a model alone is the whole.
    """

    unit: Unit
    sink: Sink
    before: str
    after: str
    change: ChangeInProgress | None = None
    steps: list[Step] = field(default_factory=list)
    meanings: list[Meaning] = field(default_factory=list)
    renamed: dict[Node, dict[str, str]] = field(default_factory=dict)
    values: dict[str, object] = field(default_factory=dict)
    refused: set[Node] = field(default_factory=set)
    whole: list[Editing] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.whole = self.whole or [self]

    @property
    def root(self) -> Node:
        return self.unit.root

    @property
    def name(self) -> str:
        return "" if self.change is None else self.change.name

    def at(self, *places: str) -> list[Node]:
        """The elements that stand in one of these places, in the order of the file."""
        last = {each.rpartition("/")[2] for each in places}
        return [node for node in self.root.iter(*last) if place(node) in places]

    @property
    def stage(self) -> str:
        """The version that the model is for once the change is made: later ones may give it other names."""
        if self.change is None:
            return self.after
        if version_key(self.before) <= version_key(self.after):
            return self.change.version
        return RELEASED[RELEASED.index(self.change.version) - 1]

    def stage_reads(self, path: str, attribute: str) -> bool:
        """Whether that version knows an attribute."""
        known = spans()
        names = (path, f"{path}@{attribute}")
        return all(exists_in(self.stage, *known[name]) for name in names if name in known)

    def lacking(self, path: str, attribute: str, value: str) -> str:
        """That the other version does not have what is on by default, or is asked for."""
        tag = path.rpartition("/")[2]
        return f'MuJoCo {self.after} has no `{attribute}` of `<{tag}>`, which is `"{value}"` in {self.before}'

    def value(self, node: Node, attribute: str) -> str | None:
        """What an element has of an attribute: written, or from its class."""
        if node.getroottree().getroot() is not self.root:
            return node.get(attribute)
        inherits = place(node).partition("/")[0] != "default"
        if not inherits:
            return self.inherited(node, attribute) if node.get(attribute) is None else node.get(attribute)
        return self.unit.classes.effective(node, childclass_of(node), attribute)

    def inherited(self, node: Node, attribute: str) -> str | None:
        """What an element of a default class has of an attribute from the classes around its own."""
        above = node.getparent()
        if above is None:
            return None
        outer = above.getparent()
        while outer is not None and outer.tag == "default":
            for each in outer.iterchildren(str(node.tag)):
                if each.get(attribute) is not None:
                    return str(each.get(attribute))
            outer = outer.getparent()
        return None

    def span(self, node: Node, attribute: str | None = None, *, key: bool = False) -> Span | None:
        """Where that stands; None for what was made here."""
        origins, file = self.unit.origins, self.unit.file
        if is_made(node):
            parent = node.getparent()
            return None if parent is None or parent is self.root else self.span(parent)
        return origins.span(node, file, attribute, key=key)

    def set(self, node: Node, attribute: str, value: str) -> None:
        """Write an attribute."""
        had = node.get(attribute)
        if had == value:
            return
        words = f'`{attribute}="{value}"`' + ("" if had is None else f' instead of `"{had}"`')
        self.steps.append(Step(self.name, self.span(node), f"wrote {words} at {called(node)}"))
        node.set(attribute, value)

    def unset(self, node: Node, attribute: str) -> None:
        """Take an attribute away."""
        had = node.get(attribute)
        if had is None:
            return
        self.steps.append(
            Step(self.name, self.span(node, attribute), f'took `{attribute}="{had}"` from {called(node)}')
        )
        del node.attrib[attribute]
        self.renamed.get(node, {}).pop(attribute, None)

    def rename(self, node: Node, attribute: str, new: str, value: str | None = None) -> None:
        """Give an attribute another name, in its place, and perhaps another value."""
        old = str(node.get(attribute))
        value = old if value is None else value
        self.steps.append(
            Step(
                self.name,
                self.span(node, attribute),
                f'`{attribute}="{old}"` is `{new}="{value}"` at {called(node)}',
            )
        )
        original = self.renamed.setdefault(node, {}).pop(attribute, attribute)
        pairs = [(new, value) if name == attribute else (str(name), str(was)) for name, was in node.items()]
        node.attrib.clear()
        node.attrib.update(dict(pairs))
        if original != new:
            self.renamed[node][new] = original

    def retag(self, node: Node, tag: str) -> None:
        """Make an element one of another tag."""
        self.steps.append(Step(self.name, self.span(node), f"`<{node.tag}>` is `<{tag}>`"))
        node.tag = tag

    def remove(self, node: Node) -> None:
        """Take an element away."""
        self.steps.append(Step(self.name, self.span(node), f"took {called(node)} away"))
        parent = node.getparent()
        if parent is not None:
            parent.remove(node)

    def insert(self, parent: Node, tag: str, attributes: dict[str, str], index: int | None = None) -> Node:
        """A new element in another one, last if nothing is said."""
        node = made(tag, attributes)
        parent.insert(len(parent) if index is None else index, node)
        written = "".join(f' {name}="{value}"' for name, value in attributes.items())
        self.steps.append(Step(self.name, self.span(parent), f"wrote `<{tag}{written}/>`"))
        return node

    def within(self, path: str) -> Node:
        """The element of a section that is there once, made where there is none: `option/flag`, `visual/headlight`."""
        section, _, tag = path.partition("/")
        found = self.at(path)
        if found:
            return found[-1]
        holder = self.at(section)
        if holder:
            above = holder[-1]
        else:
            above = made(section, {})
            first = list(self.root.iterchildren("compiler", "include"))
            self.root.insert(self.root.index(first[-1]) + 1 if first else len(self.unit.header), above)
        if not tag:
            return above
        node = made(tag, {})
        above.append(node)
        return node

    def warn(
        self,
        node: Node | None,
        message: str,
        help: str | None = None,
        attribute: str | None = None,
        arrays: tuple[str, ...] | None = None,
    ) -> None:
        """Something does not mean the same any more."""
        shown = () if self.change is None else self.change.arrays
        span = None if node is None else self.span(node, attribute)
        self.meanings.append(
            Meaning(self.name, message, span, help=help, arrays=shown if arrays is None else arrays)
        )

    def refuse(self, node: Node, message: str, help: str | None = None, attribute: str | None = None) -> None:
        """Something that cannot be said in the other version."""
        if attribute is None and node in self.refused:
            return
        self.refused.add(node)
        cause = Cause(f"{self.name} {message}", called(node))
        self.sink.error("migrate-cannot", message, self.span(node, attribute), help=help, cause=cause)


def called(node: Node) -> str:
    """An element as messages name it."""
    name = node.get("name") or node.get("class")
    return f"`<{node.tag}>` `{name}`" if name else f"`<{node.tag}>`"
