"""Resolve references: from names in attributes to nodes, and back."""

from __future__ import annotations

from collections.abc import Mapping

from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.mjcf.model import Model, Target
from composer.mjcf.value import BadValue
from composer.tree.attributes import assign
from composer.tree.kinds import kind_of
from composer.tree.name_index import UP
from composer.tree.names import WORLD, word


def refers(attribute: Attribute) -> bool:
    """Return whether the attribute refers to elements of the model by name."""
    if attribute.refers_by is not None:
        return True
    return attribute.is_reference and not (attribute.refers or "").startswith("attached:")


def namespace_of(attribute: Attribute, written: Mapping[str, str]) -> str | None:
    """Return the namespace of a reference, given all attributes of its element, or None if it is not known."""
    if attribute.refers_by is not None:
        return GRAMMAR.objtypes.get(written.get(attribute.refers_by, ""))
    return attribute.refers


def name_for(
    model: Model, attribute: Attribute, target: Target, namespace: str | None, given: dict[Target, str]
) -> str:
    """Return the name that refers to `target` in `model`. Raises `BadValue` if there can be none.

    A target without a name gets one in `given`, which the caller must write. The name in a model that is not in the
    same composition yet is provisional, and the caller must note it in `awaited` of the model.
    """
    node = target.node
    if not target.model.has(node):
        raise BadValue(f"got {described(target)}, which was removed")
    declared = target.model.declared(node)
    kind = kind_of(node)
    if namespace is not None and (declared[0] if declared else kind.family) != namespace:
        raise BadValue(f"expects {word(namespace, article=True)}, got {described(target)}")
    if declared is None and kind.family is None:
        raise BadValue(f"got {described(target)}, which nothing can refer to")
    if declared is None:
        own = given.get(target) or _free_name(target, str(kind.family), given)
        given[target] = own
    else:
        own = declared[1]
    way = model.prefix_of(target.model)
    if way is None and attribute.type != "references" and namespace != "default" and own != WORLD:
        return f"{UP}{target.model.full_prefix or target.model.prefix}{own}"
    if way is None:
        raise BadValue(
            f"got {described(target)} of the model `{target.model.name}`, which is not attached to `{model.name}`"
        )
    name = way + own if declared is None else target.model.seen_from(model, node)
    if name is None:
        raise BadValue(
            f"got {described(target)} of the model `{target.model.name}`, which `{model.name}` cannot refer to"
        )
    if attribute.type == "references" and len(name.split()) != 1:
        raise BadValue(f"got {described(target)}, but a list of names cannot hold one with a space")
    return name


def _free_name(target: Target, namespace: str, given: Mapping[Target, str]) -> str:
    """Return an unused name in the style of `dm_control`, such as `unnamed_joint_0`."""
    model = target.model
    number = len(model.names.declared.get(namespace, ()))
    while True:
        name = f"unnamed_{namespace}_{number}"
        if name not in given.values() and model.top.lookup(namespace, model.full_prefix + name) is None:
            return name
        number += 1


def resolved(model: Model, attribute: Attribute, node: Node, text: str) -> list[Target | str]:
    """Return the nodes that an attribute refers to: one, or one for each name in a list.

    A name that does not exist is returned as it is. MuJoCo may still generate it (the copies of a `replicate`); if
    not, it is reported when the model is written.
    """
    awaited = model.awaited.get((node, attribute.name))
    if awaited is not None and awaited[1] == text:
        return [awaited[0]]
    written = {str(key): str(value) for key, value in node.items()}
    namespace = namespace_of(attribute, written)
    names = text.split() if attribute.type == "references" else [text]
    return [(model.lookup(namespace, name) if namespace else None) or name for name in names]


def settle(top: Model) -> None:
    """Give the references to what has been attached since then its names in the models that refer to it."""
    for model in top.composition():
        for (node, attribute), (target, text) in [*model.awaited.items()]:
            if not model.has(node) or node.get(attribute) != text:
                del model.awaited[node, attribute]  # it was removed or written anew
            elif model.prefix_of(target.model) is not None and target.model.has(target.node):
                name = target.model.seen_from(model, target.node)
                if name is not None:
                    del model.awaited[node, attribute]
                    assign(model, node, {attribute: name})


def described(target: Target) -> str:
    """Return the description of an element for messages. See `describe`."""
    return describe(target.model, target.node)


def describe(model: Model, node: Node) -> str:
    """Return the description of an element for messages: its tag, and its name if it has one."""
    if not model.has(node):
        return f"`<{node.tag}>`" + (f" `{node.get('name')}`" if node.get("name") else "")
    declared = model.declared(node)
    named = f" `{declared[1]}`" if declared and declared[1] != WORLD else ""
    return f"`<{node.tag}>`{named}"
