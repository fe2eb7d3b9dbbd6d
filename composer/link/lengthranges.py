"""Pass: the length ranges of muscles, which MuJoCo finds by moving the model, become explicit.

Each unit keeps the ranges that MuJoCo finds in it alone. This is needed if a `<lengthrange>` changes how MuJoCo
finds them, or if a part is attached to something that moves, because then MuJoCo would move the part as well.
"""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link import numbers
from composer.link.linking import Linking
from composer.link.measured_unit import cannot_be_kept, survey
from composer.tree.unit import Unit

_ARRAYS = ("actuator_lengthrange",)


def lengthranges(linking: Linking) -> None:
    """Measure the actuators of each unit that has rules of its own; the model keeps MuJoCo's rules.

    >>> from composer.link.example import after
    >>> part = (
    ...     '<compiler><lengthrange mode="all"/></compiler>'
    ...     '<worldbody><body><joint name="j" type="slide" range="0 1"/><geom size=".1"/></body></worldbody>'
    ...     '<actuator><motor joint="j"/></actuator>'
    ... )
    >>> after(lengthranges, part)  # doctest: +ELLIPSIS
    part: <compiler/>
    part: <actuator><motor joint="j" lengthrange="-0.000...
    """
    # What hangs on a unit would be moved with it, and may stop it earlier.
    hanging = any(part.joints or part.place.kind != "world" for part in linking.parts)
    for unit in linking.units if linking.parts else ():
        rules = list(unit.root.iter("lengthrange"))
        if not rules:
            if hanging and linking.measure is not None and _has_muscles(unit):
                _write_found(unit, linking.measure(unit, _ARRAYS).get(_ARRAYS[0], []))
            continue
        actuators = unit.root.findall("actuator/*")
        if actuators:
            found = survey(linking, unit, ("lengthrange",), _ARRAYS)
            if found is None:
                continue
            measured = found.arrays["actuator_lengthrange"]
            if len(measured) != 2 * len(actuators):
                cannot_be_kept(linking, unit, ("lengthrange",), "MuJoCo makes copies of actuators")
                continue
            for at, actuator in enumerate(actuators):
                low, high = measured[2 * at : 2 * at + 2]
                # `0 0` is to MuJoCo a range that is not written: of `<muscle lengthrange="0 0"/>` it computes one.
                if (low, high) != (0.0, 0.0):
                    actuator.set("lengthrange", numbers.text([low, high]))
                elif _is_muscle(actuator):
                    _no_range(linking, unit, rules[-1], actuator)
                    break
        for rule in rules:
            compiler = rule.getparent()
            assert compiler is not None
            compiler.remove(rule)


def _has_muscles(unit: Unit) -> bool:
    sections = unit.root.iterchildren("actuator", "default")
    return any(_is_muscle(each) for section in sections for each in section.iter("muscle", "general"))


def _write_found(unit: Unit, measured: list[float]) -> None:
    """Write the ranges that MuJoCo computed, unless it made copies of actuators."""
    actuators = unit.root.findall("actuator/*")
    if len(measured) != 2 * len(actuators):
        return
    for at, actuator in enumerate(actuators):
        found = measured[2 * at : 2 * at + 2]
        if any(found):
            actuator.set("lengthrange", numbers.text(found))


def _is_muscle(actuator: Node) -> bool:
    return actuator.tag == "muscle" or "muscle" in (actuator.get("gaintype"), actuator.get("biastype"))


def _no_range(linking: Linking, unit: Unit, rule: Node, actuator: Node) -> None:
    """Report a range that MuJoCo would read as not written, and would compute by the model's rules."""
    linking.sink.error(
        "compiler-setting",
        f"`lengthrange` of `{unit.label}` cannot be kept in a composition: it leaves a muscle without a range",
        linking.span(unit, rule),
        notes=(Note("the muscle", linking.span(unit, actuator)),),
        help="write the `lengthrange` of the muscle",
    )
