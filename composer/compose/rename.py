"""Verb `rename`: elements get new names, and every reference follows."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.compose.bones import rename_in_skins
from composer.compose.edit_values import Unusable, Values
from composer.compose.editing import Editing
from composer.diagnostics.diagnostic import Note
from composer.document.node import locate
from composer.recipe.fault import Path
from composer.tree.editable import is_copy, multiplies
from composer.tree.kinds import kind_of, naming_attribute, section_of
from composer.tree.name_index import MAY_REPEAT, is_list, own_name
from composer.tree.names import WORLD


def rename(editing: Editing, found: list[Node], written: str, at: Path) -> None:
    """Give each its name. All names are decided before the first is written, so that two can change places."""
    new: dict[Node, str] = {}
    for index, node in enumerate(found):
        new[node] = _new_name(editing, node, index, written, at)
    _check(editing, new, at)
    following: list[tuple[Node, str, str, str]] = []
    for node, name in new.items():
        naming = naming_attribute(kind_of(node))
        assert naming is not None and naming.declares is not None
        old = own_name(node, naming.name)
        if old is None:
            continue
        namespace = naming.declares
        for used in [old, *_copies(editing, node, namespace, old)]:
            meant = name + used[len(old) :]
            following += [(user, key, used, meant) for user, key in editing.names.users(namespace, used)]
    for node in new:
        naming = naming_attribute(kind_of(node))
        assert naming is not None
        editing.forget(node)
        editing.write(node, {naming.name: at})
    bodies = {
        str(node.get("name")): name for node, name in new.items() if node.tag == "body" and node.get("name")
    }
    for node, name in new.items():
        naming = naming_attribute(kind_of(node))
        assert naming is not None
        if old := own_name(node, naming.name):
            editing.making.origins.renamed.setdefault(node, []).append((old, name))
        node.set(naming.name, name)
    _follow(editing, following)
    for node in new:
        editing.note(node)
    if bodies:
        rename_in_skins(editing, bodies, at)


def _new_name(editing: Editing, node: Node, index: int, written: str, at: Path) -> str:
    values = Values(editing, node, index, at)
    naming = naming_attribute(kind_of(node))
    span = locate(editing.making.document, at)
    if naming is None or node.tag == "worldbody":
        editing.sink.error("wrong-type", f"{editing.called(node)} can have no name", span)
        raise Unusable
    now = own_name(node, naming.name)
    if node.tag == "default" and now is None:
        editing.sink.error("wrong-type", "the top class keeps its name", span)
        raise Unusable
    name = values.of(written, at, now)
    name = name if isinstance(name, str) else str(name)
    if not name.strip() or (naming.declares == "body" and name == WORLD):
        message = "a name is empty" if not name.strip() else f"the name `{WORLD}` is taken"
        editing.sink.error("bad-name", message, span, notes=(Note(f"for {editing.called(node)}"),))
        raise Unusable
    return name


def _check(editing: Editing, new: dict[Node, str], at: Path) -> None:
    """A name must be free, but for those that are given up."""
    taken: dict[tuple[str, str], Node] = {}
    for node, name in new.items():
        naming = naming_attribute(kind_of(node))
        assert naming is not None and naming.declares is not None
        if naming.declares in MAY_REPEAT:
            continue
        other = taken.setdefault((naming.declares, name), node)
        help = _advice(editing, node, other, at)
        if other is node:
            there = editing.names.find(naming.declares, name)
            if there is None or there in new:
                continue
            other, help = there, "choose another name"
        editing.sink.error(
            "class-clash" if naming.declares == "default" else "name-clash",
            f"{editing.called(node)} cannot be called `{name}`: {editing.called(other)} is"
            if other not in new
            else f"{editing.called(other)} and {editing.called(node)} would both be called `{name}`",
            editing.span(at),
            notes=(Note("the other one", editing.span_of(other)),),
            help=help,
        )
        raise Unusable


def _advice(editing: Editing, node: Node, other: Node, at: Path) -> str:
    """What tells two elements apart that would get one name."""
    one, two = (Values(editing, each, 0, at) for each in (node, other))
    differ = [name for name in ("name", "parent") if one.scope[name] != two.scope[name]]
    differ += [
        name
        for name, attribute in kind_of(node).attributes.items()
        if attribute.type == "reference"
        and name != "class"
        and len({node.get(name), other.get(name), None}) == 3
    ]
    words = [f"`${{{name}}}`" for name in (*differ, "index")]
    return f"write {' or '.join([', '.join(words[:-1]), words[-1]] if words[1:] else words)} in the new name"


def _copies(editing: Editing, node: Node, namespace: str, name: str) -> list[str]:
    """The names in use that MuJoCo makes of this one."""
    if not multiplies(node):
        return []
    used = editing.names.uses.get(namespace, {})
    return [other for other in used if is_copy(other, name) and editing.names.find(namespace, other) is None]


def _follow(editing: Editing, following: list[tuple[Node, str, str, str]]) -> None:
    """Write the references anew; those in lists all at once, as two names may have changed places."""
    changes: dict[tuple[Node, str], dict[str, str]] = {}
    for user, key, old, new in following:
        changes.setdefault((user, key), {})[old] = new
    for (user, key), names in changes.items():
        editing.forget(user)
        text = str(user.get(key))
        if is_list(user, key, section_of(user)):
            user.set(key, " ".join(names.get(each, each) for each in text.split()))
        else:
            user.set(key, names.get(text, text))
        editing.note(user)
