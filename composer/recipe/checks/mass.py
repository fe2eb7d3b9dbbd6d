"""The check `mass`: what the model, a body, or a body with all below it weighs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.reference import reference


@dataclass(frozen=True, slots=True)
class Mass:
    """Kilograms between `low` and `high`: of `body` alone, of `subtree` and all below it, or of everything.

    `value` and `tol` are what is written, where it is not a range.
    """

    word: ClassVar[str] = "mass"
    name: str
    subtree: str | None
    body: str | None
    low: float
    high: float
    value: float | None
    tol: float | None
    at: Path


def read(keys: Keys, at: Path) -> Mass | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known(("subtree", "body", "range", "value", "tol"))
    keys.one_of("subtree", "body")
    subtree, body = keys.text("subtree", "the name of a body"), keys.text("body", "the name of a body")
    how = keys.one_of("range", "value")
    tol = keys.number("tol", least=0)
    low = high = value = None
    if how is None and len(keys.faults) > before:
        pass  # a key that is told may be what says it
    elif how is None:
        message = f"`mass` of {keys.owner} does not say how much"
        keys.add("missing-key", message, key=True, help="write `range: [LOW, HIGH]`, or `value: KILOGRAMS`")
    elif how == "value":
        value = keys.number("value", least=0)
        slack = 1e-9 * max(1.0, value or 0.0) if tol is None else tol
        low, high = (value - slack, value + slack) if value is not None else (None, None)
    else:
        if "tol" in keys.value:
            help = "take `tol` out, or write `value` in place of `range`"
            keys.add("unknown-key", f"`tol` of {keys.owner} belongs to `value`", "tol", key=True, help=help)
        found = keys.numbers("range", 2, "[18, 22]")
        if found is not None:
            low, high = found
            if low > high:
                message = f"`range` of {keys.owner} starts with {low:g}, which is more than {high:g}"
                keys.add("out-of-range", message, "range", help=f"write `range: [{high:g}, {low:g}]`")
    if len(keys.faults) > before or low is None or high is None:
        return None
    return Mass(keys.name, subtree, body, low, high, value, tol, at)


KIND = Kind(
    "mass",
    read,
    mapping_schema(
        "What the model, a body, or a body with all below it weighs.",
        {
            "subtree": {**NAME, "description": "a body: it and all below it"},
            "body": {**NAME, "description": "a body alone; without either, everything"},
            "range": {**reference("number-2"), "description": "the least and the most, in kilograms"},
            "value": {**reference("number"), "description": "kilograms"},
            "tol": {
                **reference("number"),
                "description": "how far from `value` it may be, in kilograms; without it, rounding",
            },
        },
    ),
    "{range: [LOW, HIGH]}",
)
