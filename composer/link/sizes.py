"""Merge the `<size>` settings of the sources. Sizes only reserve room, so the larger of two values serves both."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.grammar.number import parse_int
from composer.link.linking import Linking
from composer.link.room import asked, bytes_of

_LARGEST = ("njmax", "nconmax", "nstack", "nuserdata")
# Older ways to say how much memory there is. MuJoCo 4.0 refuses `<size memory="1M" njmax="5"/>`: "at most one of".
INSTEAD_OF_MEMORY = ("njmax", "nstack")


def merge_sizes(linking: Linking) -> None:
    """Write the larger of each size into the base, wide enough for the user data of every part."""
    linking.notes.memory = asked(linking)
    for part in linking.parts:
        for section in part.unit.root.iterchildren("size"):
            for name, value in section.items():
                _enlarge(linking, str(name), str(value))
    _user_widths(linking)
    _one_memory(linking)


def _one_memory(linking: Linking) -> None:
    sizes = list(linking.base.root.iterchildren("size"))
    memory = any(size.get("memory") for size in sizes)
    for size in sizes if memory else ():
        for name in INSTEAD_OF_MEMORY:
            span = linking.span(linking.base, size, name)
            value = size.get(name)
            if value is None:
                continue
            del size.attrib[name]
            for part in linking.parts:
                for section in part.unit.root.iterchildren("size"):
                    if section.get(name) == value:
                        span = linking.span(part.unit, section, name)
            linking.sink.warning(
                "option-conflict",
                f"`size.{name}` = {value} gives way to `size.memory` of another part: only one may be written",
                span,
            )


def _enlarge(linking: Linking, name: str, value: str) -> None:
    have = [str(size.get(name)) for size in linking.base.root.iterchildren("size") if size.get(name)]
    if name == "memory":
        if not have or bytes_of(value) > bytes_of(have[-1]):
            linking.base.section("size").set(name, value)
    elif name in _LARGEST or name.startswith("nuser_"):
        largest = max(map(_count, (value, *have)))
        if largest >= 0:
            linking.base.section("size").set(name, str(largest))


def _count(value: str) -> int:
    """What MuJoCo reads; what it refuses is reported with the source, or by MuJoCo."""
    number = parse_int(value.strip())
    return -1 if number is None else number


_USERS = {
    "nuser_body": ("body",),
    "nuser_jnt": ("joint", "freejoint"),
    "nuser_geom": ("geom",),
    "nuser_site": ("site",),
    "nuser_cam": ("camera",),
}
_USER_SECTIONS = {"nuser_tendon": "tendon", "nuser_actuator": "actuator", "nuser_sensor": "sensor"}


def _user_widths(linking: Linking) -> None:
    """Make every written `nuser_*` wide enough for the user data of all units."""
    # MuJoCo 4.0 refuses `<size nuser_geom="1"/>` beside `<geom user="1 2"/>` ("more values than nuser_geom"); without
    # a written width it takes the widest.
    for size in linking.base.root.iterchildren("size"):
        for name, value in size.items():
            if not str(name).startswith("nuser_") or _count(str(value)) < 0:
                continue
            widest = _count(str(value))
            for unit in linking.units:
                for element in _with_user(unit.root, str(name)):
                    widest = max(widest, len(str(element.get("user") or "").split()))
            size.set(name, str(widest))


def _with_user(root: Node, name: str) -> Iterator[Node]:
    if name in _USER_SECTIONS:
        for section in root.iterchildren(_USER_SECTIONS[name], "default"):
            yield from section.iter()
    else:
        for section in root.iterchildren("worldbody", "default"):
            yield from section.iter(*_USERS.get(name, ()))
