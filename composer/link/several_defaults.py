"""Pass: actuators that find their gain in another place once several top-level `<default>` are wrapped.

An actuator takes the gain of its class only where that class is of its own kind; else MuJoCo 4 asks the classes
around it, and of the top class it asks what all top-level `<default>` together leave there. Wrapped, each of these
is a class of its own, so that another one would answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.grammar import GRAMMAR
from composer.link.linking import Linking
from composer.tree.classes import MAIN
from composer.tree.unit import Unit

_OF_ANY_KIND = ("general", "motor", "plugin")
"""They take what the class has, or nothing of it."""
_OF_NONE = ("motor", "plugin")
_MIXED = ""
"""The kind of a class that itself would find another gain."""


class _Class(NamedTuple):
    """The kind of actuator that a class is, and the number of the section that declares it."""

    kind: str | None
    section: int


def several_defaults(linking: Linking) -> None:
    """Refuse an actuator whose class is of another kind, where the top class is not the same throughout."""
    wrapped = [part.unit for part in linking.parts]
    if linking.base_class is not None:
        wrapped.append(linking.base)
    for unit in wrapped:
        sections = list(unit.root.iterchildren("default"))
        setting = [at for at, section in enumerate(sections) if _actuators(section)]
        if not setting or setting == [0]:
            continue
        classes = _read_all(sections)
        for section in unit.root.iterchildren("actuator"):
            for actuator in section.iterchildren("*"):
                found = classes.get(str(actuator.get("class") or MAIN))
                if found is None or (len(setting) == 1 and setting[0] <= found.section):
                    continue
                fine = _OF_NONE if found.kind == _MIXED else (found.kind, *_OF_ANY_KIND)
                if actuator.tag not in fine:
                    _refuse(linking, unit, actuator, found.kind, _actuators(sections[setting[-1]])[0])


def _read_all(sections: Sequence[Node]) -> dict[str, _Class]:
    """Every class; each is a copy of the one around it, as it stood there."""
    found: dict[str, _Class] = {}
    earlier = False
    for at, section in enumerate(sections):
        kind = found[MAIN].kind if at else None
        _read(section, MAIN, _Class(kind, at), earlier, found)
        earlier = earlier or bool(_actuators(section))
    return found


def _read(node: Node, name: str, around: _Class, earlier: bool, found: dict[str, _Class]) -> None:
    """`earlier` is whether the top class has set actuators in a section before this one."""
    kind = around.kind
    for actuator in _actuators(node):
        tag = str(actuator.tag)
        if kind != _MIXED:
            kind = _MIXED if earlier and tag not in (kind, *_OF_ANY_KIND) else tag
    found[name] = _Class(kind, around.section)
    for nested in node.iterchildren("default"):
        _read(nested, str(nested.get("class", "")), found[name], earlier, found)


def _actuators(node: Node) -> list[Node]:
    return list(node.iterchildren(*_tags()))


@cache
def _tags() -> tuple[str, ...]:
    return tuple(GRAMMAR.section("actuator").children)


def _refuse(linking: Linking, unit: Unit, actuator: Node, kind: str | None, later: Node) -> None:
    called = f"`{actuator.get('name')}`" if actuator.get("name") else "without a name"
    own = f"is of another kind, `<{kind}>`" if kind else "is of no kind of its own"
    linking.sink.error(
        "not-supported",
        f"the `<{actuator.tag}>` {called} would take another gain in the composition: its class {own}, "
        "and the top class of its file is written in several `<default>`",
        linking.span(unit, actuator),
        notes=(Note("one of them sets actuators here", linking.span(unit, later)),),
        help="join the top-level `<default>` sections of the file into one",
    )
