"""Seeded draws: the section `randomize`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from composer.recipe.draw_field import DrawField, read_field
from composer.recipe.fault import Fault, refusal
from composer.recipe.model import Model
from composer.recipe.randomize_schema import fields
from composer.recipe.settings import settings
from composer.recipe.shown import kind_of
from composer.recipe.text import Choice

MAX_SAMPLES = 100_000
MAX_SEED = 2**64 - 1


@dataclass(frozen=True, slots=True)
class Whole:
    """Marks a field as a whole number from `least` to `most`; `key` is its name in messages."""

    key: str
    least: int
    most: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        number = {"type": "integer", "minimum": self.least, "maximum": self.most}
        return {"anyOf": [number, {"type": "string", "pattern": r"\$\{"}]}

    def _validate(self, value: Any) -> int:
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # what an expression makes
        if isinstance(value, bool) or not isinstance(value, int):
            message = f"`{self.key}` expects a whole number, got {kind_of(value)}"
            raise refusal([Fault("wrong-type", message)], value)
        if not self.least <= value <= self.most:
            message = f"`{self.key}` is from {self.least} to {self.most}, got {value}"
            raise refusal([Fault("out-of-range", message)], value)
        return value


@dataclass(frozen=True, slots=True)
class Fields:
    """Marks the field `fields`: a mapping from names to what is drawn. Gives a tuple of `DrawField`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return fields()

    def _validate(self, value: Any, info: ValidationInfo) -> tuple[DrawField, ...]:
        faults: list[Fault] = []
        found: list[DrawField | None] = []
        if isinstance(value, dict) and value:
            bare = settings(info.context).bare_angles
            found = [read_field(name, item, bare, faults) for name, item in value.items()]
        else:
            got = "an empty one" if value == {} else kind_of(value)
            message = f"`fields` is a mapping from names to what is drawn, got {got}"
            help = (
                'write `fields: {friction: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.5, 1]}}`'
            )
            faults.append(Fault("wrong-type", message, help=help))
        if faults:
            raise refusal(faults, value)
        return tuple(each for each in found if each is not None)


class Randomize(Model):
    """Seeded draws of parameters, and of attributes of the finished model."""

    seed: Annotated[int, Whole("seed", 0, MAX_SEED)]
    """What makes these draws differ from those of another seed: a whole number below 2**64."""
    samples: Annotated[int, Whole("samples", 1, MAX_SAMPLES)]
    """How many samples there are, besides sample 0, the model without any draw."""
    emit: Annotated[Literal["models", "table"], Choice("emit")] = "models"
    """What `build --all` writes: a model for each sample, or one with a table of the draws for use at run time."""
    fields: Annotated[tuple[DrawField, ...], Fields()]
    """What is drawn: a mapping from a name, which is part of the seed, to a distribution and what it is for."""

    @property
    def of_parameters(self) -> tuple[DrawField, ...]:
        """The fields that draw parameters."""
        return tuple(each for each in self.fields if each.param is not None)
