"""Angles that MuJoCo keeps in degrees, whatever the compiler setting, in files and in a compiled model."""

from __future__ import annotations

_NAMES = frozenset({"fovy", "azimuth", "elevation"})


def is_in_degrees(tag: str, attribute: str) -> bool:
    """Return whether an attribute is such an angle; all others are in radians, including the cutoff of a sensor.

    >>> is_in_degrees("light", "cutoff"), is_in_degrees("camera", "fovy"), is_in_degrees("jointpos", "cutoff")
    (True, True, False)
    """
    return attribute in _NAMES or (tag, attribute) == ("light", "cutoff")
