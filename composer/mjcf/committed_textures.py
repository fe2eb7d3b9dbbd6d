"""Write the textures of a material from its class: several by their roles, or one as an attribute."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.diagnostics.call_site import call_site
from composer.mjcf.model import Model
from composer.tree.attributes import assign
from composer.tree.classes import DefaultClass

_OF_ATTRIBUTE = "rgb"


def commit(model: Model, node: Node, found: DefaultClass) -> None:
    """Write onto a material the textures of its class for the roles that the material itself does not set."""
    own = _by_role(node)
    missing = {role: name for role, name in _given(found).items() if role not in own and name}
    if not missing:
        return
    if not own and missing.keys() == {_OF_ATTRIBUTE}:
        assign(model, node, {"texture": missing[_OF_ATTRIBUTE]})
        return
    if node.get("texture") is not None:  # MuJoCo takes the attribute, or layers
        missing = {_OF_ATTRIBUTE: own[_OF_ATTRIBUTE], **missing}
        assign(model, node, {"texture": None})
    for role, name in missing.items():
        layer = node.makeelement("layer", {"role": role, "texture": name})
        node.append(layer)
        model.unit.origins.own(layer, call_site())
        model.note(layer)


def _given(found: DefaultClass | None) -> dict[str, str]:
    if found is None:
        return {}
    given = _given(found.parent)
    for element in found.elements.get("material", ()):
        given.update(_by_role(element))
    return given


def _by_role(node: Node) -> dict[str, str]:
    named = node.get("texture")  # an empty one takes back what a class gives
    attribute = {} if named is None else {_OF_ATTRIBUTE: str(named)}
    layers = {str(layer.get("role")): str(layer.get("texture")) for layer in node.iterchildren("layer")}
    return {**attribute, **layers}
