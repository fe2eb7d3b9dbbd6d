"""Copies and pickles of compositions."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.mjcf.attributed import Attributed
from mjcompose.mjcf.model import Attachment, Model
from mjcompose.mjcf.views import view
from mjcompose.tree.unit import FileText, Origins, Unit, counterpart


def duplicate(model: Model, memo: dict[int, Any] | None = None) -> Model:
    """Return a copy of a model with copies of everything attached. The copy is not attached to anything.

    `memo` receives the copy of each root, as in `copy.deepcopy`.
    """
    twin = Model(model.unit.copied())
    if memo is not None:
        memo[id(view(model, model.unit.root))] = view(twin, twin.unit.root)
    for (node, attribute), awaited in model.awaited.items():
        if model.has(node) and model.frame_above(node) is None:
            twin.awaited[counterpart(node, model.unit.root, twin.unit.root), attribute] = awaited
    for attachment in model.attachments.values():
        child = duplicate(attachment.child, memo)
        frame = copy.deepcopy(attachment.frame)
        host = counterpart(attachment.host, model.unit.root, twin.unit.root)
        child.hung = twin.attachments[child.prefix] = Attachment(twin, child, host, frame=frame)
        twin.unit.origins.owners.update(model.unit.origins.carried(attachment.frame, frame).owners)
        for joint in frame:
            twin.note(joint)
    return twin


def copied(element: Attributed, memo: dict[int, Any]) -> Any:
    """Return the element's counterpart in the copy of its model. The model is copied unless `memo` has the copy."""
    model = element._alive()._model
    twin = copy.deepcopy(view(model, model.unit.root), memo)._model
    frame = model.frame_above(element._node)
    if frame is None:
        return view(twin, counterpart(element._node, model.unit.root, twin.unit.root))
    there = twin.attachments[model.attachment_of(frame).child.prefix].frame
    return view(twin, counterpart(element._node, frame, there))


Reduced = tuple[Callable[..., Attributed], tuple[Any, ...]]


@dataclass(frozen=True, slots=True)
class _Tree:
    """A node with its subtree: its text and, for each node, its line and its origin."""

    text: bytes
    lines: list[int]
    owners: dict[int, str | Span]

    @classmethod
    def of(cls, node: Node, origins: Origins) -> _Tree:
        nodes = list(node.iter())
        owners: dict[int, str | Span] = {}
        for at, each in enumerate(nodes):
            owner = origins.owners.get(each)
            if owner is not None:
                owners[at] = owner if isinstance(owner, str | Span) else owner(None)
        lines: list[Any] = [each.sourceline for each in nodes]
        return cls(etree.tostring(node, with_tail=False), [line or 0 for line in lines], owners)

    def restored(self, origins: Origins) -> Node:
        node = etree.fromstring(self.text, etree.XMLParser(huge_tree=True, remove_blank_text=False))
        nodes = list(node.iter())
        for each, line in zip(nodes, self.lines, strict=True):
            each.sourceline = line
        for at, owner in self.owners.items():
            origins.own(nodes[at], owner)
        return node


@dataclass(frozen=True, slots=True)
class _Attached:
    """An attachment: the attached model, its frame, and the index of its host among all nodes of the parent."""

    child: _Composition
    frame: _Tree
    host: int


@dataclass(frozen=True, slots=True)
class _Composition:
    """A model and all its attachments; comments of the model's header are stored by their places below the root.

    `kept` has the fields of its unit that pickle as they are.
    """

    tree: _Tree
    header: list[int]
    kept: dict[str, Any]
    texts: dict[str, FileText]
    attached: list[_Attached]

    @classmethod
    def of(cls, model: Model) -> _Composition:
        unit = model.unit
        places = {node: at for at, node in enumerate(unit.root.iter())} if model.attachments else {}
        attached = [
            _Attached(cls.of(each.child), _Tree.of(each.frame, unit.origins), places[each.host])
            for each in model.attachments.values()
        ]
        kept = {name: getattr(unit, name) for name in ("file", "directory", "label", "contents", "door")}
        header = list(map(unit.root.index, unit.header))
        return cls(_Tree.of(unit.root, unit.origins), header, kept, texts=unit.origins.texts, attached=attached)

    def restored(self) -> Model:
        origins = Origins(texts=self.texts)
        root = self.tree.restored(origins)
        header = tuple(root[at] for at in self.header)
        model = Model(Unit(root, origins=origins, header=header, **self.kept))
        nodes = list(root.iter()) if self.attached else []
        for each in self.attached:
            child = each.child.restored()
            frame = each.frame.restored(origins)
            child.hung = model.attachments[child.prefix] = Attachment(model, child, nodes[each.host], frame=frame)
            for joint in frame:
                model.note(joint)
        return model


def pickled_element(element: Attributed) -> Reduced:
    """Return the pickled form of an element: the whole composition, and the position of the element in it."""
    model = element._alive()._model
    if element._node is model.unit.root:
        if model.hung is None:
            return _root, (_Composition.of(model),)
        return _attached, (view(model.hung.parent, model.hung.parent.unit.root), model.prefix)
    root = view(model, model.unit.root)
    frame = model.frame_above(element._node)
    top = model.unit.root if frame is None else frame
    place = next(at for at, node in enumerate(top.iter()) if node is element._node)
    return _element, (root, None if frame is None else model.attachment_of(frame).child.prefix, place)


def _root(state: _Composition) -> Any:
    model = state.restored()
    return view(model, model.unit.root)


def _attached(parent: Attributed, prefix: str) -> Any:
    child = parent._model.attachments[prefix].child
    return view(child, child.unit.root)


def _element(root: Attributed, prefix: str | None, place: int) -> Any:
    model = root._model
    top = model.unit.root if prefix is None else model.attachments[prefix].frame
    return view(model, next(node for at, node in enumerate(top.iter()) if at == place))
