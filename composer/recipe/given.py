"""`with`: values for the parameters and variants of a nested recipe."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.recipe.fault import Fault
from composer.recipe.form import Form
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Given(Form):
    """Form of the field `with`, a mapping from names to values. The nested recipe checks these."""

    def schema(self) -> Schema:
        value = {"type": ["number", "boolean", "string", "array"]}
        return {"type": "object", "additionalProperties": value}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> dict[str, Any]:
        if not isinstance(value, dict):
            message = f"`with` expects a mapping from names to values, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message, help="write `with: {reach: 0.5}`"))
            return {}
        for name, each in value.items():
            if each is None or isinstance(each, dict):
                message = (
                    f"`with.{name}` expects a number, a text, true, false or a list, got {kind_of(each)}"
                )
                faults.append(Fault("wrong-type", message, (name,)))
        return dict(value)
