"""The check `mass`: the mass of the model, of a body, or of a body with everything below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name, Number, Numbers


@dataclass(frozen=True, slots=True)
class Mass:
    """The mass is between `low` and `high`, in kg: that of `body`, of `subtree` with all below it, or of the model.

    `value` and `tol` are set if the recipe writes these instead of a range.
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


FORM = Keyed(
    "What the model, a body, or a body with all below it weighs.",
    Key("subtree", Name("the name of a body"), "a body: it and all below it"),
    Key("body", Name("the name of a body"), "a body alone; without either, everything"),
    Key("range", Numbers(2, "[18, 22]"), "the least and the most, in kilograms"),
    Key("value", Number(least=0), "kilograms"),
    Key("tol", Number(least=0), "how far from `value` it may be, in kilograms; without it, rounding"),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Mass | None:
    keys.one_of("subtree", "body")
    how = keys.one_of("range", "value")
    subtree, body, value, tol = (found[name] for name in ("subtree", "body", "value", "tol"))
    if how is None:
        # A key with a fault may be the one that is missing here.
        if not any(each.at[:2] == (keys.name, keys.word) for each in keys.faults):
            message = f"`mass` of {keys.owner} does not say how much"
            help = "write `range: [LOW, HIGH]`, or `value: KILOGRAMS`"
            keys.add("missing-key", message, key=True, help=help)
        return None
    if how == "value":
        slack = 1e-9 * max(1.0, value or 0.0) if tol is None else tol
        limits = None if value is None else (value - slack, value + slack)
    else:
        limits = found["range"]
        _check_range(keys, limits)
    return None if limits is None else Mass(keys.name, subtree, body, *limits, value, tol, at)


def _check_range(keys: Keys, limits: tuple[float, float] | None) -> None:
    if "tol" in keys.value:
        help = "take `tol` out, or write `value` in place of `range`"
        keys.add("unknown-key", f"`tol` of {keys.owner} belongs to `value`", "tol", key=True, help=help)
    if limits is not None and limits[0] > limits[1]:
        low, high = limits
        message = f"`range` of {keys.owner} starts with {low:g}, which is more than {high:g}"
        keys.add("out-of-range", message, "range", help=f"write `range: [{high:g}, {low:g}]`")


KIND = Kind("mass", FORM, make, example="{range: [LOW, HIGH]}")
