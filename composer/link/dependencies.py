"""The assets, default classes and plugins that the elements of a model need. The others can be removed."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.link.partition import SUPPORTING
from composer.tree.names import declaration, references
from composer.tree.unit import Unit

_SUPPORT = ("default", "asset", "extension")
Name = tuple[str, str]


def drop_unneeded(unit: Unit) -> list[Name]:
    """Remove assets, default classes and plugins that the model does not need. Return namespace and name of each.

    What a class that is needed refers to is needed as well, whether or not an element takes it from there.
    """
    supporting = list(_supporting(unit))
    needed = _needed(unit, dict(reversed(supporting)))
    dropped: list[Name] = []
    for (namespace, name), node in supporting:
        if node in needed:
            continue
        dropped.append((namespace, name))
        parent = node.getparent()
        if parent is not None:  # it may have gone with the class that it stands in
            parent.remove(node)
    for plugin in list(unit.root.iterfind("extension/plugin")):
        if plugin not in needed:
            dropped.append(("plugin", str(plugin.get("plugin") or "")))
            section = plugin.getparent()
            assert section is not None
            section.remove(plugin)
    for section in list(unit.root.iterchildren(*_SUPPORT)):
        if next(section.iterchildren("*"), None) is None:
            unit.root.remove(section)
    return dropped


def _supporting(unit: Unit) -> Iterator[tuple[Name, Node]]:
    for section in unit.root.iterchildren("asset"):
        for element in section.iterchildren("*"):
            declared = declaration(element, "asset")
            if declared is not None and declared[0] in SUPPORTING:
                yield declared, element
            # Nothing refers to a skin: it is drawn because it stands there.
            elif declared is None and element.tag != "skin":
                yield (str(element.tag), ""), element
    for section in unit.root.iterchildren("default"):
        for element in section.iter("default"):
            if element is not section:
                yield ("default", str(element.get("class") or "")), element
    for instance in unit.root.iterfind("extension/plugin/instance"):
        yield ("instance", str(instance.get("name") or "")), instance


def _needed(unit: Unit, supporting: dict[Name, Node]) -> set[Node]:
    """Return every supporting element that is referred to, directly or through other supporting elements."""
    needed: set[Node] = set()
    waiting: list[tuple[Node, str]] = []
    plugins: set[str] = set()

    def need(node: Node, section: str) -> None:
        if node not in needed:
            needed.add(node)
            waiting.append((node, section))

    for section in unit.root.iterchildren("*"):
        if section.tag not in _SUPPORT:
            waiting.append((section, str(section.tag)))
        elif section.tag == "default":
            need(section, "default")
        elif section.tag == "asset":
            waiting.extend((skin, "asset") for skin in section.iterchildren("skin"))
    while waiting:
        node, inside = waiting.pop()
        tops = [node]
        if node.tag == "default":
            tops = [child for child in node.iterchildren("*") if child.tag != "default"]
            parent = node.getparent()
            # A class begins with what its parent sets, so that it needs the parent even where no element names that.
            if parent is not None and parent.tag == "default":
                need(parent, "default")
        for top in tops:
            for name in references(top, inside):
                found = supporting.get(name)
                if found is not None:
                    need(found, _section_of(found))
            plugins.update(str(plugin.get("plugin")) for plugin in top.iter("plugin"))
    for plugin in unit.root.iterfind("extension/plugin"):
        if plugin.get("plugin") in plugins or any(instance in needed for instance in plugin):
            needed.add(plugin)
    return needed


def _section_of(node: Node) -> str:
    while (parent := node.getparent()) is not None and parent.getparent() is not None:
        node = parent
    return str(node.tag)
