"""Verb `rename`: give elements new names, and update every reference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as PathlibPath

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Path
from mjcompose.base.naming import odd_character
from mjcompose.compose.editing import Editing
from mjcompose.compose.values import EntryValues, UnusableValue
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.verbs.rename import Rename
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.edit import BadBone, NewName, Renaming, is_rod, renamed_skin, skins, twisted_by, unlistable_message
from mjcompose.tree.grammar import Attribute
from mjcompose.tree.names import MAY_REPEAT, WORLD, own_name
from mjcompose.tree.select import kind_of, naming_attribute


def rename_in_skins(editing: Editing, names: Mapping[str, str], at: Path) -> None:
    """Rewrite every skin file in which one of these bodies is a bone."""
    unit = editing.linking.base
    files = editing.linking.files
    for skin in skins(unit.root):
        use = next((each for each in files if each.element is skin.element), None)
        source = unit.source_of(skin.path)
        if use is not None:
            source = PathlibPath(use.source) if use.content is None else use.content
        try:
            content = renamed_skin(source, names.get)
        except BadBone as fault:
            editing.sink.error("bad-name", str(fault), editing.span(at))
            continue
        if content is None:
            continue
        if use is None:
            unit.contents = {**unit.contents, skin.path: content}
        else:
            # Not shared: another part may use the same file with the old name.
            files[files.index(use)] = use._replace(content=content, shared=False)


def carry_out(verb: Rename, entry: Entry, at: Path) -> None:
    # All names are decided before the first is written, so two can change places.
    entry.check()  # messages name the elements as they are written
    editing = entry.editing
    named = enumerate(entry.found)
    new = {node: _new_name(editing, node, index, written=verb.name, at=at) for index, node in named}
    _take_twists_along(editing, new)
    _check_twists(editing, new, at)
    _check(editing, new, at)
    renaming = _renaming(editing, new)
    for reference, name in renaming.unlistable():
        user = reference.node
        message = unlistable_message(reference, name, editing.called(user))
        note = Note("the list is here", editing.span_of(user))
        editing.sink.error("bad-name", message, editing.span(at), notes=(note,))
        raise UnusableValue
    for node in new:
        editing.forget(node)
        editing.write(node, {_naming(node).name: at})
    bodies = {str(node.get("name")): name for node, name in new.items() if node.tag == "body" and node.get("name")}
    for node, name in new.items():
        naming = _naming(node)
        # You ask `explain` for the final name of an element, and it shows how the element got it.
        if old := own_name(node, naming.name):
            editing.making.origins.renamed.setdefault(node, []).append((old, name))
        journal.write(node, naming.name, name)
    for node in new:
        editing.note(node)
    renaming.carry_out()
    if bodies:
        rename_in_skins(editing, bodies, at)


def _naming(node: Node) -> Attribute:
    naming = naming_attribute(kind_of(node))
    assert naming is not None
    return naming


def _new_name(editing: Editing, node: Node, index: int, written: str, at: Path) -> str:
    values = EntryValues(editing, node, index, at=at)
    naming = naming_attribute(kind_of(node))
    span = locate(editing.making.document, at)
    if naming is None or node.tag == "worldbody":
        message = f"{editing.called(node)} can have no name"
        editing.sink.error("wrong-type", message, span, subjects=editing.subjects(node))
        raise UnusableValue
    now = own_name(node, naming.name)
    # MuJoCo 4.0: "top-level default class 'main' cannot be renamed".
    if node.tag == "default" and now is None:
        editing.sink.error("wrong-type", "the top class keeps its name", span)
        raise UnusableValue
    name = values.of(written, at, now)
    name = name if isinstance(name, str) else str(name)
    # The world has its name in every model: `<body name="world"/>` is "repeated name 'world' in body" in MuJoCo 4.0.
    if not name.strip() or (naming.declares == "body" and name == WORLD):
        message = "a name is empty" if not name.strip() else f"the name `{WORLD}` is taken"
        notes = (Note(f"for {editing.called(node)}"),)
        editing.sink.error("bad-name", message, span, notes=notes, subjects=editing.subjects(node))
        raise UnusableValue
    if (character := odd_character(name)) is not None:
        notes = (Note(f"for {editing.called(node)}"),)
        editing.sink.error("bad-name", f"the new name has {character} in it", span, notes=notes)
        raise UnusableValue
    return name


def _take_twists_along(editing: Editing, new: dict[Node, str]) -> None:
    """Rename the joints in which a rod is twisted with it: they belong to it by their names."""
    for rod, name in list(new.items()):
        old = str(rod.get("name") or "")
        if old and is_rod(rod):
            for joint, node in editing.names.declared.get("joint", {}).items():
                if twisted_by(joint) == old:
                    new.setdefault(node, name + joint.removeprefix(old))


def _check_twists(editing: Editing, new: dict[Node, str], at: Path) -> None:
    """Report joints that would no longer belong to their rod."""
    for node, name in new.items():
        rod = twisted_by(str(node.get("name") or "")) if node.tag == "joint" else ""
        flex = editing.find_node("flex", rod) if rod else None
        if flex is None or not is_rod(flex) or twisted_by(name) == new.get(flex, rod):
            continue
        why = f"MuJoCo finds the joints in which the flex `{rod}` is twisted by their names"
        message = f"{editing.called(node)} cannot be called `{name}`: {why}"
        notes = (Note("the flex", editing.span_of(flex)),)
        help = f"rename the flex, which also renames its joints: `select: {{flex: {rod}}}`"
        span = editing.span(at)
        subjects = editing.subjects(node)
        editing.sink.error("bad-name", message, span, notes=notes, help=help, subjects=subjects)
        raise UnusableValue


def _check(editing: Editing, new: dict[Node, str], at: Path) -> None:
    """Report a new name that is already used, unless that name is given up in the same step."""
    taken: dict[tuple[str, str], Node] = {}
    for node, name in new.items():
        naming = _naming(node)
        assert naming.declares is not None
        if naming.declares in MAY_REPEAT:
            continue
        other = taken.setdefault((naming.declares, name), node)
        help = _advice(editing, node, other, at=at)
        if other is node:
            if (there := editing.names.find(naming.declares, name)) is None or there in new:
                continue
            other = there
            help = "choose another name"
        code = "class-clash" if naming.declares == "default" else "name-clash"
        message = f"{editing.called(node)} cannot be called `{name}`: {editing.called(other)} is"
        if other in new:
            message = f"{editing.called(other)} and {editing.called(node)} would both be called `{name}`"
        notes = (Note("the other one", editing.span_of(other)),)
        subjects = (name, *editing.subjects(node), *editing.subjects(other))
        editing.sink.error(code, message, editing.span(at), notes=notes, help=help, subjects=subjects)
        raise UnusableValue


def _advice(editing: Editing, node: Node, other: Node, at: Path) -> str:
    """Return advice on how to distinguish two elements that would get the same name."""
    one, two = (EntryValues(editing, each, 0, at=at) for each in (node, other))
    differ = [name for name in ("name", "parent") if one.called[name] != two.called[name]]
    differ += [
        name
        for name, attribute in kind_of(node).attributes.items()
        if attribute.type == "reference" and name != "class" and len({node.get(name), other.get(name), None}) == 3
    ]
    words = [f"`${{{name}}}`" for name in (*differ, "index")]
    return f"write {' or '.join([', '.join(words[:-1]), words[-1]] if words[1:] else words)} in the new name"


def _renaming(editing: Editing, new: dict[Node, str]) -> Renaming[Editing]:
    names = []
    for node, name in new.items():
        naming = _naming(node)
        assert naming.declares is not None
        if (old := own_name(node, naming.name)) is not None:
            names.append(NewName(editing, naming.declares, old, new=name))
    return Renaming.of(names)
