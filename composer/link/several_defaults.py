"""Pass: actuators that find their gain in another place once several top-level `<default>` are wrapped.

An actuator takes the gain of its class only where that class is of its own kind; else MuJoCo 4 asks the classes
around it, and of the top class it asks what all top-level `<default>` together leave there. Wrapped, each of these
is a class of its own, so that another one would answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.grammar import GRAMMAR
from composer.link.linking import Linking
from composer.tree.classes import MAIN
from composer.tree.unit import Unit

_OF_ANY_KIND = ("general", "motor", "plugin")
"""They take what the class has, or nothing of it."""


def several_defaults(linking: Linking) -> None:
    """Refuse an actuator whose class is of another kind, where the top class is not the same throughout."""
    wrapped = [part.unit for part in linking.parts]
    if linking.base_class is not None:
        wrapped.append(linking.base)
    for unit in wrapped:
        sections = list(unit.root.iterchildren("default"))
        setting = [
            at
            for at, section in enumerate(sections)
            if next(section.iterchildren(*_tags()), None) is not None
        ]
        if not setting or setting == [0]:
            continue
        kinds = _kinds(sections)
        for section in unit.root.iterchildren("actuator"):
            for actuator in section.iterchildren("*"):
                kind, at = kinds.get(str(actuator.get("class") or MAIN), (None, 0))
                settled = len(setting) == 1 and setting[0] <= at
                if not settled and actuator.tag not in (kind, *_OF_ANY_KIND):
                    later = next(sections[setting[-1]].iterchildren(*_tags()))
                    _refuse(linking, unit, actuator, kind, later)


def _kinds(sections: Sequence[Node]) -> dict[str, tuple[str | None, int]]:
    """Of every class the kind of actuator that it is, and the number of the section that declares it.

    A class is a copy of the one around it, as it stood there.
    """
    found: dict[str, tuple[str | None, int]] = {}
    for at, section in enumerate(sections):
        kind, _ = found.get(MAIN, (None, 0))
        _read(section, MAIN, kind, at, found)
    return found


def _read(
    section: Node, name: str, kind: str | None, at: int, found: dict[str, tuple[str | None, int]]
) -> None:
    for actuator in section.iterchildren(*_tags()):
        kind = str(actuator.tag)
    found[name] = kind, at
    for nested in section.iterchildren("default"):
        _read(nested, str(nested.get("class", "")), kind, at, found)


@cache
def _tags() -> tuple[str, ...]:
    return tuple(GRAMMAR.section("actuator").children)


def _refuse(linking: Linking, unit: Unit, actuator: Node, kind: str | None, later: Node) -> None:
    called = f"`{actuator.get('name')}`" if actuator.get("name") else "without a name"
    own = "is of no kind of actuator" if kind is None else f"is of another kind, `<{kind}>`"
    linking.sink.error(
        "not-supported",
        f"the `<{actuator.tag}>` {called} would take another gain in the composition: its class {own}, "
        "and the top class of its file is written in several `<default>`",
        linking.span(unit, actuator),
        notes=(Note("one of them sets actuators here", linking.span(unit, later)),),
        help=f"give it a class in which a `<{actuator.tag}>` sets its gain, or join the `<default>`s into one",
    )
