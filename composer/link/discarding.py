"""`discardvisual`: the geoms that nothing collides with go, with what only they use, and all that gives colour."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link.measured_unit import Survey
from composer.tree.classes import walk_bodies
from composer.tree.files import stem
from composer.tree.names import LISTS, REFERS, naming_table
from composer.tree.unit import Unit

_ASSETS = ("mesh", "material", "texture")
_COLOURS = ("material", "texture")


def discard(unit: Unit, found: Survey) -> set[Node]:
    """Take out of the unit what MuJoCo has left out; gives the bodies that have lost geoms."""
    changed: set[Node] = set()
    for geom, _ in list(walk_bodies(unit.root)):
        if geom.tag == "geom" and found.is_gone(geom):
            body = next((each for each in geom.iterancestors("body") if not found.is_gone(each)), None)
            if body is not None:
                changed.add(body)
            _remove(geom)
    for section in unit.root.iterchildren("*"):
        _leave_uncoloured(section)
    left = {tag: found.names(tag) for tag in _ASSETS}
    for section in unit.root.iterchildren("asset"):
        for asset in list(section.iterchildren(*_ASSETS)):
            if (asset.get("name") or stem(str(asset.get("file") or ""))) not in left[str(asset.tag)]:
                _remove(asset)
    return changed


def _leave_uncoloured(section: Node) -> None:
    """Take away every reference to a material or texture, but for those that keep it in the model."""
    table = naming_table(str(section.tag))
    for element in list(section.iter("*")):
        for name, (kind, namespace) in table.get(str(element.tag), {}).items():
            if kind in (REFERS, LISTS) and namespace in _COLOURS and name in element.attrib:
                del element.attrib[name]
                if section.tag == "default" and not element.attrib:
                    _remove(element)
    for layer in list(section.iter("layer")):
        _remove(layer)


def _remove(element: Node) -> None:
    holder = element.getparent()
    assert holder is not None
    holder.remove(element)
