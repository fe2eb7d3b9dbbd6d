"""Words about the numbers and the errors of a fit, for the terminal and for the page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_DEVIATIONS = 1.96
"""Half of a 95 % interval of a normal distribution, in standard deviations."""


def number_words(number: Mapping[str, Any]) -> str:
    """Return the elements and the attribute of a fitted number."""
    return f"{number['kind']} {', '.join(number['names'])}: {number['attribute']}"


def verdict_words(verdict: str) -> str:
    """Return a verdict, which is a key of the file of measurements, in a sentence.

    >>> verdict_words("not_identified")
    'not identified'
    """
    return verdict.replace("_", " ")


def half_interval(number: Mapping[str, Any]) -> float:
    """Return half of the 95 % interval of a fitted number."""
    return _DEVIATIONS * float(number["std"])


def error_words(error: Mapping[str, Any]) -> str:
    """Return the errors of a signal before and after the fit."""
    held = error["held_out"]
    out = f", held out {held['recipe']:.3g} → {held['fitted']:.3g}" if held else ""
    return f"error {error['recipe']:.3g} → {error['fitted']:.3g}{out}"
