"""Pass: append the sections outside the body tree one by one, parts in their order."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link.linking import Linking
from composer.link.part import Part
from composer.tree.comments import above

_APPENDED = ("asset", "deformable", "contact", "tendon", "equality", "actuator", "sensor", "custom")
# Read by passes of their own.
_SETTLED = ("compiler", "option", "size", "statistic", "visual", "default", "worldbody", "keyframe")


def sections(linking: Linking) -> None:
    """Move the remaining sections of every part into the base's.

    >>> from composer.link.example import after
    >>> part = '<worldbody><site name="s"/></worldbody><sensor><gyro site="s"/></sensor>'
    >>> base = '<sensor><clock/></sensor>'
    >>> after(sections, part, base)
    model: <sensor><clock/><gyro site="p/s"/></sensor>
    """
    for part in linking.parts:
        for section in list(part.unit.root):
            tag = section.tag
            if tag == "extension":
                _extension(linking, part, section)
            elif tag in _APPENDED and next(section.iterchildren("*"), None) is not None:
                # MuJoCo reads several sections of one tag as one, so that it does not matter into which it goes.
                target = linking.base.section(tag)
                elements = [*above(section, part.unit.header), *section]
                owner = part.unit.origins.owner(section, part.unit.file)
                linking.base.origins.own_all(elements, owner)
                target.extend(elements)


def _extension(linking: Linking, part: Part, section: Node) -> None:
    """Merge plugins: one that both declare is declared once, with the instances of both."""
    target = linking.base.section("extension")
    known = {element.get("plugin"): element for element in linking.base.root.iterfind("extension/plugin")}
    for plugin in list(section.iterchildren("*")):
        existing = known.get(plugin.get("plugin"))
        if existing is None:
            target.append(plugin)
            linking.base.origins.own(plugin, part.unit.file)
            known[plugin.get("plugin")] = plugin
            continue
        for instance in list(plugin):
            existing.append(instance)
            linking.base.origins.own(instance, part.unit.file)
