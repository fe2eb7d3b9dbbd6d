"""An onlooker that checks that the journal is complete: replayed, it leads to every tree as it is."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from types import FunctionType
from typing import SupportsIndex

from lxml.etree import _Element as Node
from mjcompose.tree import journal
from mjcompose.tree.journal import PARENT, SOURCE, TAG, TreeChange
from mjcompose.tree.unit import Unit


@dataclass
class State:
    """An element as the journal has it."""

    tag: str
    parent: Node | None
    attributes: dict[str, str]

    @classmethod
    def of(cls, node: Node) -> State:
        return cls(str(node.tag), node.getparent(), {str(name): str(text) for name, text in node.items()})


class AuditedRecord(list[TreeChange]):
    """A record that replays each change at once, and notes each that starts from another value than the replay has."""

    def __init__(self) -> None:
        super().__init__()
        self.states: dict[Node, State] = {}
        self.contradictions: list[str] = []

    def append(self, change: TreeChange, /) -> None:
        node = change.node
        if not isinstance(node.tag, str):  # a comment
            return  # type: ignore[unreachable]  # of the stubs
        if change.what == PARENT and change.before is None:
            # An element may be built freely until it is placed.
            for each in node.iter("*"):
                self.states.setdefault(each, State.of(each))
        state = self.states.get(node)
        if state is None or change.what == SOURCE:
            return
        known: object = state.attributes.get(change.what)
        if change.what == TAG:
            known = state.tag
        elif change.what == PARENT:
            known = state.parent
        if known is not change.before and known != change.before:
            self.contradictions.append(f"`{change.what}` of `{state.tag}` was {known}, not {change.before}")
        self._replay(state, change)

    def _replay(self, state: State, change: TreeChange) -> None:
        after = change.after
        if change.what == TAG:
            state.tag = str(after)
        elif change.what == PARENT:
            assert after is None or not isinstance(after, str)
            state.parent = after
        elif after is None:
            state.attributes.pop(change.what, None)
        else:
            state.attributes[change.what] = str(after)

    def insert(self, index: SupportsIndex, change: TreeChange, /) -> None:
        raise AssertionError("changes are recorded in their order")


class Audit:
    """A `Watch`. `unrecorded` has what no record says, with the pass or step that did it."""

    def __init__(self) -> None:
        self.record = AuditedRecord()
        self.unrecorded: list[str] = []
        self.changes = 0
        self.roots: set[Node] = set()

    def recording(self) -> AbstractContextManager[None]:
        return journal.recording(self.record)

    def __call__(self, units: Iterable[Unit], done: object) -> None:
        called = done.__name__ if isinstance(done, FunctionType) else type(done).__name__
        states = self.record.states
        self.unrecorded += (f"{called}: {each}" for each in self.record.contradictions)
        self.record.contradictions.clear()
        self.changes += len(states)
        present: set[Node] = set()
        for unit in units:
            nodes = list(unit.root.iter("*"))
            present.update(nodes)
            if unit.root not in self.roots:
                self.roots.add(unit.root)
                states.update((node, State.of(node)) for node in nodes)
        for node in present:
            now = State.of(node)
            known = states.get(node)
            if known != now:
                self.unrecorded.append(f"{called}: `{now.tag}` is {now}, the record has {known}")
                states[node] = now
        for node, state in states.items():
            if node not in present and state.parent in present:
                self.unrecorded.append(f"{called}: `{state.tag}` {state.attributes} is gone")
                state.parent = None
