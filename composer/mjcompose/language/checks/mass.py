"""The check `mass`: the mass of the model, of a body, or of a body with everything below it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Keys, Kind
from mjcompose.language.forms.adapters import CheckForm, CheckModel
from mjcompose.language.forms.rules import Belongs, Exclusive, OneOf
from mjcompose.language.forms.scalars import Name, NotNegative, Range, Unit


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


class MassForm(CheckModel):
    """What the model, a body, or a body with all below it weighs."""

    rules: ClassVar = (
        Exclusive("subtree", "body"),
        OneOf(
            "range",
            "value",
            lacks="does not say how much",
            advice="write `range: [LOW, HIGH]`, or `value: KILOGRAMS`",
        ),
        Belongs("tol", "value", help="take `tol` out, or write `value` in place of `range`"),
    )
    example: ClassVar = "{range: [LOW, HIGH]}"

    subtree: Annotated[str, Name("body")] | None = None
    """a body: it and all below it"""
    body: Annotated[str, Name("body")] | None = None
    """a body alone; without either, everything"""
    range: Annotated[Range, Unit("kg")] | None = None
    """the least and the most, in kilograms"""
    value: Annotated[NotNegative, Unit("kg")] | None = None
    """kilograms"""
    tol: Annotated[NotNegative, Unit("kg")] | None = None
    """how far from `value` it may be, in kilograms; without it, rounding"""

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the most, in kilograms."""
        if self.range is not None:
            return self.range
        value = self.value or 0.0
        slack = 1e-9 * max(1.0, value) if self.tol is None else self.tol
        return value - slack, value + slack


def make(keys: Keys, form: Any, at: Path) -> Mass | None:
    if form is None:
        return None
    low, high = form.limits
    return Mass(keys.name, form.subtree, form.body, low, high=high, value=form.value, tol=form.tol, at=at)


KIND = Kind("mass", CheckForm(MassForm), make, example=MassForm.example)
