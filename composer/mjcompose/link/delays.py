"""Delays of actuators: the number of samples that follows from the time step of the whole model."""

from __future__ import annotations

import math

from lxml.etree import _Element as Node

from mjcompose.link import numbers
from mjcompose.link.linking import Linking
from mjcompose.tree import journal
from mjcompose.tree.journal import because

_STEP = 0.002
"""MuJoCo's default time step, in seconds."""


def time_step(root: Node) -> float:
    """Return the time step that a model says, in seconds. A later `<option>` wins over an earlier one."""
    written = [str(option.get("timestep")) for option in root.iterchildren("option") if option.get("timestep")]
    return numbers.first(written[-1]) if written else _STEP


def samples_in(delay: float, step: float) -> int:
    """Return the number of time steps that a delay spans.

    >>> samples_in(0.004, 0.0005), samples_in(0.005, 0.002)
    (8, 3)
    """
    return math.ceil(round(delay / step, 9))


def delays(linking: Linking) -> None:
    """Write the `nsample` of each delay that a data sheet gives, for the time step of the model as it is now.

    The part of a recipe may have another time step than the whole. An `nsample` that someone wrote later stays.
    """
    unit = linking.base
    step = time_step(unit.root)
    for actuator, text in list(unit.origins.delays.items()):
        delay = actuator.get("delay")
        if actuator.getroottree().getroot() is not unit.root or actuator.get("nsample") != text or not delay:
            continue
        samples = str(samples_in(numbers.first(str(delay)), step)) if step > 0 else text
        journal.write(actuator, "nsample", samples, because("counted in time steps of the whole model"))
        unit.origins.delays[actuator] = samples
