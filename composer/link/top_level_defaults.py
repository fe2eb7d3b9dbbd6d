"""Pass: actuators whose gain changes when several top-level `<default>` sections become separate classes.

An actuator takes the gain of its class only if that class is for its own kind of actuator. Otherwise MuJoCo 4 looks
in the enclosing classes, and in the top class, which combines all top-level `<default>` sections. After wrapping,
each section is a class of its own, so the gain may come from another class. MuJoCo compiles the unit both ways; if
a gain differs, the original gain is written on the actuator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.link.defaults import defaults
from composer.link.linking import Linking
from composer.link.multiplied import actuators_in_order, element_of
from composer.tree.classes import MAIN, Classes, DefaultClass
from composer.tree.unit import Unit

# All tags of actuators share one row of a class in MuJoCo 4.0: after `<default><position kp="50"/></default>` a
# `<general joint="j"/>` is a servo with a gain of 50, while a `<motor joint="j"/>` has 1 and keeps the range.
_OF_ANY_KIND = ("general", "motor", "plugin")
"""They take what the class has, or nothing of it."""
_OF_NONE = ("motor", "plugin")
_MIXED = ""
"""The kind of a class that itself would find another gain."""
_GAINS = ("gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm")
_ONE_OF = ("kv", "dampratio")
"""Attributes of which MuJoCo takes one."""

_Gains = Mapping[Node, list[list[float]]]


class _Class(NamedTuple):
    """The kind of actuator that a class is for, and the number of the section that declares it."""

    kind: str | None
    section: int


class _Suspect(NamedTuple):
    """An actuator whose gain may change.

    `written` are its attributes, `kind` the kind of its class, and `later` an element that sets actuators in a
    later section.
    """

    actuator: Node
    written: dict[str, str]
    kind: str | None
    later: Node


def top_level_defaults(linking: Linking) -> None:
    """Write the gain that several top-level `<default>` elements set for an actuator, or refuse it if impossible.

    >>> from composer.link.example import after
    >>> part = (
    ...     '<default><position kp="4"/></default><default><velocity kv="9"/></default>'
    ...     '<worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>'
    ...     '<actuator><position joint="j"/></actuator>'
    ... )
    >>> after(top_level_defaults, part)
    part: <actuator><position joint="j" kp="1"/></actuator>
    """
    wrapped = [part.unit for part in linking.parts]
    if linking.base_class is not None:
        wrapped.append(linking.base)
    for unit in wrapped:
        suspects = list(_suspects(unit))
        alone = (_gains(linking, unit) if suspects else None) or {}
        for gain in (_found, _found_in_the_end, _found_nowhere) if alone else ():
            for suspect in suspects:
                _write(unit, suspect.actuator, gain)
            there = _gains(linking, unit, wrap=True)
            moved = [each for each in suspects if not there or alone[each.actuator] != there[each.actuator]]
            for suspect in moved:
                suspect.actuator.attrib.clear()
                suspect.actuator.attrib.update(suspect.written)  # type: ignore[arg-type]  # of the stubs
            suspects = moved
            if not suspects:
                break
        for suspect in suspects:
            _refuse(linking, unit, suspect)


def _suspects(unit: Unit) -> Iterator[_Suspect]:
    """Yield actuators whose class is of another kind, if the top class changes between sections."""
    sections = list(unit.root.iterchildren("default"))
    setting = [at for at, section in enumerate(sections) if _actuators(section)]
    if not setting or setting == [0]:
        return
    classes = _read_all(sections)
    for actuator in unit.root.findall("actuator/*"):
        found = classes.get(str(actuator.get("class") or MAIN))
        if found is None or (len(setting) == 1 and setting[0] <= found.section):
            continue
        fine = _OF_NONE if found.kind == _MIXED else (found.kind, *_OF_ANY_KIND)
        if actuator.tag not in fine:
            later = _actuators(sections[setting[-1]])[0]
            written = {str(name): str(value) for name, value in actuator.items()}
            yield _Suspect(actuator, written, found.kind, later)


def _read_all(sections: Sequence[Node]) -> dict[str, _Class]:
    """Read all classes. Each one begins as a copy of the enclosing class at that point."""
    found: dict[str, _Class] = {}
    earlier = False
    for at, section in enumerate(sections):
        kind = found[MAIN].kind if at else None
        _read(section, MAIN, _Class(kind, at), earlier, found)
        earlier = earlier or bool(_actuators(section))
    return found


def _read(node: Node, name: str, around: _Class, earlier: bool, found: dict[str, _Class]) -> None:
    """Read a class. `earlier` is whether the top class has set actuators in a section before this one."""
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


def _gains(linking: Linking, unit: Unit, *, wrap: bool = False) -> _Gains | None:
    """Return the gains that MuJoCo computes for the unit's actuators, as it is or with its top class wrapped."""
    if linking.measure is None:
        return None
    copy = unit.copied()
    if wrap:
        defaults(Linking(copy, [], Sink(), linking.request, base_class=f"top{linking.request.separator}"))
    arrays = tuple(f"actuator_{name}" for name in _GAINS)
    measured = linking.measure(copy, arrays, attempt=wrap)
    own = unit.root.findall("actuator/*")
    element = dict(zip(copy.root.findall("actuator/*"), own, strict=True))
    rows = [element[element_of(each)] for each in actuators_in_order(copy.root)]
    if not measured or len(measured[arrays[0]]) != len(rows):
        return None
    found: dict[Node, list[list[float]]] = {each: [] for each in own}
    for array in arrays:
        width = len(measured[array]) // len(rows)
        for row, holder in enumerate(rows):
            found[holder].append(measured[array][row * width : (row + 1) * width])
    return found


def _write(
    unit: Unit, actuator: Node, gain: Callable[[Classes, DefaultClass, str], DefaultClass | None]
) -> None:
    """Write the values of the class that `gain` finds, if the composition has other values."""
    from composer.tree.effective import default_text  # few models need it

    tag = str(actuator.tag)
    own = unit.classes.get(actuator.get("class"))
    alone, there = gain(unit.classes, own, tag), _found(unit.classes, own, tag)
    common = GRAMMAR.element("actuator/motor").attributes
    # A `kv` beside the actuator's own `dampratio` would be an error: "kv and dampratio cannot both be defined" in
    # MuJoCo 4.0.
    settled = _ONE_OF if any(actuator.get(name) is not None for name in _ONE_OF) else ()
    for name, attribute in GRAMMAR.element(f"actuator/{tag}").attributes.items():
        if name in common or name in settled or not attribute.in_default or actuator.get(name) is not None:
            continue
        default = default_text(attribute)
        value, other = (_value(asked, tag, name, default) for asked in (alone, there))
        if value is not None and value != other:
            actuator.set(name, value)


def _value(asked: DefaultClass | None, tag: str, name: str, default: str | None) -> str | None:
    found = asked.lookup(tag, name) if asked is not None else None
    return default if found is None else found[0]


def _found(classes: Classes, own: DefaultClass, tag: str) -> DefaultClass | None:
    """Return the nearest class of an actuator's kind after the sections are wrapped."""
    found: DefaultClass | None = own
    while found is not None and not _is_of(found, tag):
        found = found.parent
    return found


def _found_in_the_end(classes: Classes, own: DefaultClass, tag: str) -> DefaultClass | None:
    """Return the nearest class of an actuator's kind if the top class is the result of all sections."""
    found: DefaultClass | None = own
    while found is not None and found.name != MAIN:
        if _is_of(found, tag):
            return found
        found = found.parent
    return _found(classes, classes.get(MAIN), tag)


def _found_nowhere(classes: Classes, own: DefaultClass, tag: str) -> DefaultClass | None:
    """Return None, for MuJoCo's own values without a class."""
    return None


def _is_of(found: DefaultClass, tag: str) -> bool:
    """Return whether the last actuator settings of a class are for this tag."""
    own = found.elements.get(tag)
    section = own[0].getparent() if own else None
    return section is not None and _actuators(section)[-1].tag == tag


def _refuse(linking: Linking, unit: Unit, suspect: _Suspect) -> None:
    actuator, _, kind, later = suspect
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
