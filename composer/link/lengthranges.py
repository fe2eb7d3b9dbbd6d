"""Pass: `<lengthrange>` says how MuJoCo computes the length range of actuators: what it gives becomes explicit."""

from __future__ import annotations

from composer.link import numbers
from composer.link.inertia import measure_alone
from composer.link.linking import Linking

_ARRAYS = ("actuator_lengthrange",)


def lengthranges(linking: Linking) -> None:
    """Measure the actuators of each unit that has rules of its own; the model keeps MuJoCo's rules."""
    for unit in linking.units if linking.parts else ():
        rules = list(unit.root.iter("lengthrange"))
        if not rules:
            continue
        actuators = [each for section in unit.root.iterchildren("actuator") for each in section.iterchildren("*")]
        if actuators:
            arrays = measure_alone(linking, unit, "`lengthrange`", _ARRAYS)
            if arrays is None:
                continue
            measured = arrays["actuator_lengthrange"]
            for at, actuator in enumerate(actuators):
                low, high = measured[2 * at : 2 * at + 2]
                if (low, high) != (0.0, 0.0):
                    actuator.set("lengthrange", numbers.text([low, high]))
        for rule in rules:
            compiler = rule.getparent()
            assert compiler is not None
            compiler.remove(rule)
