"""Errors and warnings about a fit, for the terminal and for the page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from mjcompose.base.dataclass import Struct

_FAR = 3.0
"""How many times the error of the fit a held-out recording may have before it is a warning."""
_WORSE = 1.2
"""How many times the error of the recipe a held-out recording may have before it is an error."""
_NO_BETTER = 1.02
"""How many times the squared errors of the recipe a fit may leave before it is an error."""
_CORRELATED = 3.0
"""Over how many samples errors may be correlated before it is a warning."""


class FitFinding(Struct):
    """An error or a warning about a fit."""

    severity: Literal["error", "warning"]
    code: str
    message: str
    help: str


def findings_of(errors: Sequence[Mapping[str, Any]]) -> Iterator[FitFinding]:
    """Yield a finding for held-out recordings that the fit follows badly, and for errors that are not noise."""
    worse = [error for error in errors if _is_worse(error)]
    far = [error for error in errors if error["held_out"] and error["held_out"]["fitted"] > _FAR * error["fitted"]]
    if _is_no_better(errors):
        yield _of_no_better(max(errors, key=lambda error: _ratio(error["fitted"], error["recipe"])))
    elif worse:
        yield _of_worse(max(worse, key=lambda error: error["held_out"]["fitted"] / error["held_out"]["recipe"]))
    elif far:
        yield _of_far(max(far, key=lambda error: error["held_out"]["fitted"] / error["fitted"]))
    most = max(errors, key=lambda error: error["correlated"], default=None)
    if most is not None and most["correlated"] > _CORRELATED:
        yield _of_correlated(most)


def _is_no_better(errors: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether the recipe follows the fitted recordings better, each signal in units of its least error."""
    fitted = sum(_ratio(error["fitted"], min(error["fitted"], error["recipe"])) ** 2 for error in errors)
    recipe = sum(_ratio(error["recipe"], min(error["fitted"], error["recipe"])) ** 2 for error in errors)
    return fitted > _NO_BETTER * recipe


def _ratio(error: float, least: float) -> float:
    return error / max(least, 1e-12)


def _of_no_better(error: Mapping[str, Any]) -> FitFinding:
    message = (
        f"the fitted model follows the recordings worse than the recipe: `{error['signal']}` is off by"
        f" {error['fitted']:.3g}, before {error['recipe']:.3g}"
    )
    help = "the fit found no better numbers: record more seconds of faster motion, or fit fewer fields"
    return FitFinding("error", "worse-than-recipe", message, help)


def _is_worse(error: Mapping[str, Any]) -> bool:
    held = error["held_out"]
    return bool(held) and held["fitted"] > _WORSE * held["recipe"] and held["fitted"] > _FAR * error["fitted"]


def _of_worse(error: Mapping[str, Any]) -> FitFinding:
    held = error["held_out"]
    message = (
        f"the fitted model follows `{error['signal']}` of the held-out recording worse than the recipe:"
        f" {held['fitted']:.3g}, before {held['recipe']:.3g}"
    )
    help = "the recordings differ in something that no field describes: a payload, a delay, a zero, contact"
    return FitFinding("error", "worse-than-recipe", message, help)


def _of_far(error: Mapping[str, Any]) -> FitFinding:
    fitted = error["held_out"]["fitted"]
    message = (
        f"`{error['signal']}` of the held-out recording has an error of {fitted:.3g},"
        f" {fitted / error['fitted']:.1f} times the error of the fit"
    )
    help = "some number fits one recording alone, as friction of contact often does: add recordings, or omit fields"
    return FitFinding("warning", "held-out", message, help)


def _of_correlated(error: Mapping[str, Any]) -> FitFinding:
    message = (
        f"the errors of `{error['signal']}` are not noise: they are correlated over"
        f" {error['correlated']:.0f} samples, so the model lacks something that the robot has"
    )
    help = "the numbers make up for it, and may be wrong for other motions: add a field, such as `delay` or `zero`"
    return FitFinding("warning", "errors-not-noise", message, help)
