"""Changes of attributes, and removal."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import field
from functools import cache, partial
from itertools import islice
from pathlib import Path
from typing import cast

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, call_site
from mjcompose.base.suggest import did_you_mean
from mjcompose.base.words import tag_text
from mjcompose.mjcf.asset import Asset, Skins, add_files, place_asset, skins_after_renaming
from mjcompose.mjcf.errors import MjcfError, failure, no_attribute
from mjcompose.mjcf.model import AttachedModel, ModelState, ReferencedNode
from mjcompose.mjcf.value import BadValue, describe, encode, is_here, is_reference, name_for, namespace_of, plain_text
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, ORIENTATIONS
from mjcompose.tree.edit import NewName, Removal, Renaming, assign, is_section, replace, unlistable_message
from mjcompose.tree.files import NAMED_AFTER_FILE, stem
from mjcompose.tree.grammar import Attribute, ElementType
from mjcompose.tree.names import MAY_REPEAT
from mjcompose.tree.select import attribute_of, kind_of, naming_attribute, spoken


def remove(model: ModelState, node: Node, cascade: bool) -> None:
    """Remove a node from its model. A top-level section stays and is emptied."""
    if node is model.unit.root:
        help = "`detach()` removes an attached model from the model that it is attached to"
        raise failure("not-supported", "the root of a model cannot be removed", help=help)
    removal = Removal.of([(model, node)]).with_referrers() if cascade else Removal(((model, node),), ())
    removal.drop_references()
    for here, going in removal.going:
        _take_out(here, going)


def discard(model: ModelState, node: Node) -> None:
    """Remove a node and everything below it from the model's indexes, before it is removed from the tree."""
    for each in node.iter("*"):
        model.forget(each)
        view = model.views.pop(each, None)
        if view is not None:
            view._take_out()
        model.unit.origins.owners.pop(each, None)
        model.unit.origins.settings.pop(each, None)


def _take_out(model: ModelState, node: Node) -> None:
    inside = set(node.iter("*"))
    for prefix, attachment in list(model.attachments.items()):
        if attachment.host in inside:
            release(model, prefix)
    if is_section(node):
        model.forget(node)
        node.attrib.clear()
        for child in list(node):
            if isinstance(child.tag, str):
                discard(model, child)
            node.remove(child)
        return
    discard(model, node)
    journal.remove(node)


def release(model: ModelState, prefix: str) -> None:
    """Remove an attachment. The child becomes an independent model again."""
    attachment = model.attachments[prefix]
    discard(model, attachment.frame)
    del model.attachments[prefix]
    attachment.child.hung = None


class AttributeEdit(Struct, frozen=False):
    """The attributes to write, with None for attributes to remove, and the bytes of the files that they name."""

    texts: dict[str, str | None] = field(default_factory=dict)
    contents: dict[str, bytes | Path] = field(default_factory=dict)
    given: dict[ReferencedNode, str] = field(default_factory=dict)
    """Names for unnamed elements that something refers to."""
    awaited: dict[str, tuple[ReferencedNode, str]] = field(default_factory=dict)
    """References to elements of models that are not in one composition with this one yet, by attribute."""
    skins: Skins = field(default_factory=list)
    """Skin files that contain the name of a renamed body."""
    renaming: Renaming[ModelState] | None = None
    """The references that follow a new name."""
    nameless: bool = False
    """Whether no attribute involves names."""


def check(
    model: ModelState,
    kind: ElementType,
    values: Mapping[str, object],
    node: Node | None = None,
    frame: AttachedModel | None = None,
) -> AttributeEdit:
    """Check the values, and return the edit that sets them on `node`, or on a new element if `node` is None.

    `frame` is the attachment that a new joint is for. Elements among the values must have been replaced by
    their targets. Raises `MjcfError` for an invalid value.
    """
    if node is not None and len(values) == 1:
        ((name, value),) = values.items()
        edit = _nameless_edit(kind, name, value)
        if edit is not None:
            return edit
    if frame is None and node is not None and (above := model.frame_above(node)) is not None:
        frame = model.attachment_of(above)
    edit = AttributeEdit()
    _write_texts(model, kind, values, edit=edit, node=node)
    _check_orientation(kind, edit)
    _check_name(model, kind, edit, node=node, frame=frame)
    if node is not None and frame is None:
        _rename_in_skins(model, kind, edit, node=node)
    return edit


def _nameless_edit(kind: ElementType, name: str, value: object) -> AttributeEdit | None:
    """Return the edit of one attribute that involves no names and whose value needs no other check, or None."""
    attribute = attribute_of(kind, name)
    if attribute is None or not is_nameless(kind, attribute):
        return None
    if value is None:
        return AttributeEdit({attribute.name: None}, nameless=True)
    text = plain_text(attribute, value)
    return None if text is None else AttributeEdit({attribute.name: text}, nameless=True)


def _write_texts(
    model: ModelState, kind: ElementType, values: Mapping[str, object], edit: AttributeEdit, node: Node | None
) -> None:
    """Write the texts of the values into an edit, in the order of the values. Raises `MjcfError` for an invalid one."""
    attributes: dict[str, Attribute] = {}
    for name in values:
        attribute = attribute_of(kind, name)
        if attribute is None:
            raise no_attribute(kind, name)
        attributes[name] = attribute
    written = {} if node is None else {str(name): str(value) for name, value in node.items()}
    # References come last: their namespace may follow from another attribute.
    for name, attribute in sorted(attributes.items(), key=lambda item: is_reference(item[1])):
        try:
            text = _text(model, kind, attribute, value=values[name], written=written, edit=edit)
        except BadValue as fault:
            raise _bad_value(kind, attribute, fault, model=model, name=values.get("name"), node=node) from None
        edit.texts[attribute.name] = text
        written.pop(attribute.name, None)
        if text is not None:
            written[attribute.name] = text
    edit.texts = {attribute.name: edit.texts[attribute.name] for attribute in attributes.values()}


def _check_orientation(kind: ElementType, edit: AttributeEdit) -> None:
    """Raise `MjcfError` if an edit sets several orientations."""
    orientations = [name for name in ORIENTATIONS if edit.texts.get(name)]
    if len(orientations) > 1:
        both = " and ".join(f"`{name}`" for name in orientations)
        raise failure("wrong-type", f"`<{kind.tag}>` can have one orientation, got {both}")


def _rename_in_skins(model: ModelState, kind: ElementType, edit: AttributeEdit, node: Node) -> None:
    """Give an edit that renames a body the skin files that contain the body's name."""
    naming = naming_attribute(kind)
    if naming is None or naming.declares != "body":
        return
    before = model.declared(node)
    name = edit.texts.get(naming.name)
    if before and name and before[1] != name:
        edit.skins = skins_after_renaming(model, before[1], name)


def _text(
    model: ModelState,
    kind: ElementType,
    attribute: Attribute,
    value: object,
    written: Mapping[str, str],
    edit: AttributeEdit,
) -> str | None:
    if value is None:
        return None
    if isinstance(value, Asset):
        if attribute.type != "file":
            raise BadValue("expects no file, got an `Asset`")
        return place_asset(model, kind.tag, value, contents=edit.contents)
    is_list = isinstance(value, list | tuple) and any(isinstance(item, ReferencedNode) for item in value)
    if not isinstance(value, ReferencedNode) and not is_list:
        return encode(attribute, value)
    if not is_reference(attribute):
        raise BadValue("expects no element, got one")
    if is_list and attribute.type != "references":
        raise BadValue("expects one element, got a list")
    namespace = namespace_of(attribute, written)
    name_of = partial(name_for, model, attribute, namespace=namespace, given=edit.given)
    if isinstance(value, ReferencedNode):
        name = name_of(value)
        if model.prefix_of(value.model) is None:
            edit.awaited[attribute.name] = value, name
        return name
    items: list[object] = list(value)  # type: ignore[call-overload]
    return " ".join(name_of(item) if isinstance(item, ReferencedNode) else encode(attribute, item) for item in items)


def write(model: ModelState, node: Node, edit: AttributeEdit) -> None:
    """Carry out an edit that has been checked."""
    _prepare(model, edit)
    for changed, files in edit.skins:
        add_files(changed, files)
    if edit.texts:
        model.unit.origins.settings.setdefault(node, {}).update(dict.fromkeys(edit.texts, call_site()))
    if edit.nameless:
        replace(node, edit.texts)
    else:
        assign(model, node, edit.texts)
    model.awaited.update(((node, name), awaited) for name, awaited in edit.awaited.items())
    is_from_file = cast(int | None, node.sourceline) is not None
    if not is_from_file and node not in model.unit.origins.owners:  # it was created on access
        model.unit.origins.own(node, call_site())
    if edit.renaming is not None:
        edit.renaming.carry_out()


@cache
def is_nameless(kind: ElementType, attribute: Attribute) -> bool:
    """Return whether an attribute is neither a name nor determines the target of a name."""
    if attribute.type == "keyword":
        return all(each.refers_by != attribute.name for each in kind.attributes.values())
    return attribute.is_number or attribute.type == "bool"


def create(model: ModelState, parent: Node, tag: str, edit: AttributeEdit, position: int | None) -> Node:
    """Create an element below `parent`, at the end or before the child at `position`, and return it."""
    _prepare(model, edit)
    node = parent.makeelement(tag, {name: text for name, text in edit.texts.items() if text is not None})
    later = None if position is None else _child_at(parent, position)
    if later is None:
        parent.append(node)
    else:
        later.addprevious(node)
    model.unit.origins.own(node, call_site())
    model.note(node)
    model.awaited.update(((node, name), awaited) for name, awaited in edit.awaited.items())
    return node


def _child_at(parent: Node, position: int) -> Node | None:
    """Return the child before which `list.insert` would insert, or None if it would append."""
    position = max(-sys.maxsize, min(position, sys.maxsize - 1))
    if position >= 0:
        return next(islice(parent.iterchildren("*"), position, None), None)
    from_the_end = islice(parent.iterchildren("*", reversed=True), -position - 1, None)
    return next(from_the_end, next(parent.iterchildren("*"), None))


def _prepare(model: ModelState, edit: AttributeEdit) -> None:
    """Add the files of an edit, and give names to the referenced elements that have none."""
    if edit.contents:
        add_files(model, edit.contents)
    for (target, node), name in edit.given.items():
        attribute = naming_attribute(kind_of(node))
        assert attribute is not None
        node.set(attribute.name, name)
        target.unit.origins.settings.setdefault(node, {})[attribute.name] = call_site()
        target.note(node)


def _check_name(
    model: ModelState, kind: ElementType, edit: AttributeEdit, node: Node | None, frame: AttachedModel | None
) -> None:
    """Raise `MjcfError` if the name that an edit sets is already used in the composition."""
    attribute = naming_attribute(kind)
    if attribute is None or attribute.declares is None:
        return
    namespace = attribute.declares
    naming = {attribute.name, "file"} if kind.path in NAMED_AFTER_FILE else {attribute.name}
    if node is not None and edit.texts.keys().isdisjoint(naming):
        return
    name = _name_after(kind, attribute, edit, node=node)
    if frame is not None:
        name = frame.child.prefix + (name or "")
    if not name:
        return
    if node is not None:
        _follow_name(model, namespace, name, edit=edit, node=node)
    if namespace not in MAY_REPEAT:
        _check_unique(model, namespace, name, node=node)


def _name_after(kind: ElementType, attribute: Attribute, edit: AttributeEdit, node: Node | None) -> str | None:
    """Return the name that an element has after an edit, which may come from its file."""
    texts: dict[str, str | None] = {} if node is None else {str(key): str(text) for key, text in node.items()}
    texts.update(edit.texts)
    name = texts.get(attribute.name)
    file = texts.get("file")
    if not name and file and kind.path in NAMED_AFTER_FILE:
        return stem(file)
    return name


def _follow_name(model: ModelState, namespace: str, name: str, edit: AttributeEdit, node: Node) -> None:
    """Let references follow the new name of an element. Raises `MjcfError` if it cannot have this name."""
    if namespace == "default" and node.getparent() is model.unit.root and name != MAIN:
        raise failure("wrong-type", f"the top default class is called `{MAIN}`, and cannot be `{name}`")
    before = model.declared(node)
    if before is not None and before[1] != name:
        edit.renaming = Renaming.of([NewName(model, namespace, before[1], new=name)])
        check_lists(edit.renaming)


def _check_unique(model: ModelState, namespace: str, name: str, node: Node | None) -> None:
    """Raise `MjcfError` if another element of the composition has the name."""
    taken = model.top.lookup(namespace, model.full_prefix + name)
    if taken is None or (taken.model is model and taken.node is node):
        return
    code, called = ("class-clash", "default class") if namespace == "default" else ("name-clash", namespace)
    message = f"another {called} is already called `{model.full_prefix + name}`"
    raise failure(code, message, notes=(is_here(taken),), help="give one of the two another name")


def check_lists(renaming: Renaming[ModelState]) -> None:
    """Raise `MjcfError` if a new name contains a space and would have to be in a list of names."""
    for reference, new in renaming.unlistable():
        here = reference.model
        user = reference.node
        notes = (Note("the list is here", here.span(user)),)
        raise failure("wrong-type", unlistable_message(reference, new, describe(here, user)), notes=notes)


def _bad_value(
    kind: ElementType, attribute: Attribute, fault: BadValue, model: ModelState, name: object, node: Node | None
) -> MjcfError:
    what = tag_text(kind.tag, name if isinstance(name, str) else None)
    what = what if node is None else describe(model, node)
    refusal = fault.refusal
    help = None
    code = "wrong-length" if refusal.is_length else "wrong-type"
    if attribute.type in ("keyword", "keywords"):
        code = "wrong-keyword"
        if refusal.unknown is not None and refusal.advice is None:
            help = did_you_mean(refusal.unknown, attribute.keywords)
    return failure(code, f"`{spoken(attribute.name)}` of {what} {refusal}", help=help)
