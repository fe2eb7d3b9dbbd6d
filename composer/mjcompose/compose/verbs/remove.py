"""Verb `remove`: remove elements, alone or with everything that refers to them."""

from __future__ import annotations

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Path
from mjcompose.compose.editing import Editing
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.verbs.remove import Remove
from mjcompose.link.subtree import DroppedElement
from mjcompose.tree import journal
from mjcompose.tree.edit import Removal, is_section, unused_instances, whole
from mjcompose.tree.names import declaration, is_list, word
from mjcompose.tree.select import kind_of, naming_attribute, section_of

_SHOWN = 20


def carry_out(verb: Remove, entry: Entry, at: Path) -> None:
    entry.gone += remove(entry.editing, entry.found, cascade=verb.how == "cascade", at=at)


def remove(editing: Editing, nodes: list[Node], *, cascade: bool, at: Path) -> list[DroppedElement]:
    """Remove nodes, and the plugin instances that only they use. Return all of them.

    Without `cascade`, a reference is an error, and nothing is removed.
    """
    removal = Removal.of((editing, node) for node in nodes)
    if not cascade and removal.references:
        _still_needed(removal, editing, at)
        return []
    removal = removal.with_referrers()
    removal.drop_references()
    gone: list[DroppedElement] = []
    instances: dict[str, None] = {}
    for _, node in removal.going:
        gone += _named(node)
        instances.update((str(each.get("instance")), None) for each in node.iter("*") if each.get("instance"))
        _take_out(editing, node)
    for instance in unused_instances(editing.root, instances):
        gone += _named(instance)
        _take_out(editing, instance)
    linking = editing.linking
    # The bundle omits a file that only removed elements used.
    linking.files = [use for use in linking.files if use.element.getroottree().getroot() is editing.root]
    return gone


def _take_out(editing: Editing, node: Node) -> None:
    for each in node.iter("*"):
        if not is_section(each) and each is not editing.root:
            editing.forget(each)
    # The class may have made slides or balls of joints, which have other numbers in a key.
    if section_of(node) == "default":
        editing.reshaped(node)
    parent = node.getparent()
    assert parent is not None
    journal.remove(node)
    if parent.tag == "flexcomp":  # without its pins or its elasticity it has other joints
        editing.reshaped(parent)
    editing.linking.base.forget_classes()


def _named(node: Node) -> list[DroppedElement]:
    """Return the removed elements, for lists: each element in the body tree, elsewhere the element as a whole."""
    section = section_of(node)
    inside = node.iter("*") if section in ("worldbody", "default") else [node]
    found = []
    for each in inside:
        if each.tag in ("frame", "replicate") or is_section(each):
            continue
        declared = declaration(each, section)
        if declared is not None or naming_attribute(kind_of(each)) is not None or each is node:
            found.append(DroppedElement(listed_kind(each, section), declared[1] if declared else ""))
    return found


def listed_kind(node: Node, section: str) -> str:
    if section in ("tendon", "equality", "actuator", "sensor"):
        return section
    return "joint" if node.tag == "freejoint" else word(str(node.tag))


def _still_needed(removal: Removal[Editing], editing: Editing, at: Path) -> None:
    found: dict[Node, Note] = {}
    for _, node, attribute, namespace, name in removal.references:
        user = whole(node)
        place = None if is_list(node, attribute, section_of(node)) else attribute
        message = f"{editing.called(user)} refers to the {word(namespace)} `{name}` by `{attribute}`"
        found.setdefault(user, Note(message, editing.span_of(node, place)))
    rest = [Note(f"and {len(found) - _SHOWN} more")] if len(found) > _SHOWN else []
    notes = [*[*found.values()][:_SHOWN], *rest]
    alone = len(removal.going) == 1
    what = editing.called(removal.going[0][1]) if alone else f"{len(removal.going)} elements"
    editing.sink.error(
        "still-referred-to",
        f"{what} cannot be removed alone: {'it is' if alone else 'they are'} referred to",
        editing.span(at),
        notes=notes,
        help="write `remove: cascade` to remove the elements that refer to it, too",
        subjects=[name for _, node in removal.going for name in editing.subjects(node)],
    )
