"""Where an actuator's numbers are in an array of mjModel: some have a row for each control, some for each output."""

from __future__ import annotations

from typing import Any

_OF_OUTPUTS = frozenset(("actuator_gear", "actuator_lengthrange", "actuator_length0", "actuator_acc0"))


def first_row(model: Any, array: str, actuator: int) -> int:
    """The first row of an actuator; before MuJoCo counted controls and outputs, every array had one for each."""
    if "ctrl" in array and hasattr(model, "actuator_ctrladr"):
        return int(model.actuator_ctrladr[actuator])
    if array in _OF_OUTPUTS and hasattr(model, "actuator_outadr"):
        return int(model.actuator_outadr[actuator])
    return actuator
