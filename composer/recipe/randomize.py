"""The section `randomize`: seeded draws."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from composer.dataclass import dataclass
from composer.limits import advice, in_force
from composer.recipe.draw_field import DrawField, read_field
from composer.recipe.fault import Fault
from composer.recipe.form import Form
from composer.recipe.model import Model
from composer.recipe.randomize_schema import fields
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.text import Choice

MAX_SEED = 2**64 - 1
_FORMER = (("table", "worlds"),)


@dataclass(frozen=True, slots=True)
class Whole(Form):
    """Form of a whole number from `least` to `most`, or to the limit with the name `most`.

    `key` is its name in messages.
    """

    key: str
    least: int
    most: int | str

    def schema(self) -> Schema:
        number: dict[str, Any] = {"type": "integer", "minimum": self.least}
        if isinstance(self.most, int):
            number["maximum"] = self.most
        return {"anyOf": [number, {"type": "string", "pattern": r"\$\{"}]}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> int | None:
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # what an expression makes
        if isinstance(value, bool) or not isinstance(value, int):
            message = f"`{self.key}` expects a whole number, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message))
            return None
        most = self.most if isinstance(self.most, int) else getattr(in_force(), self.most)
        if not self.least <= value <= most:
            message = f"`{self.key}` is from {self.least} to {most}, got {value}"
            limited = isinstance(self.most, str) and value > most
            code, help = ("limit-exceeded", advice(self.key, value)) if limited else ("out-of-range", None)
            faults.append(Fault(code, message, help=help))
        return value


@dataclass(frozen=True, slots=True)
class Fields(Form):
    """Form of the field `fields`: a mapping from names to what is drawn, read as a tuple of `DrawField`."""

    def schema(self) -> Schema:
        return fields()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[DrawField, ...]:
        found: list[DrawField | None] = []
        if isinstance(value, dict) and value:
            found = [
                read_field(name, item, settings.bare_angles, faults=faults) for name, item in value.items()
            ]
        else:
            got = "an empty one" if value == {} else kind_of(value)
            message = f"`fields` is a mapping from names to what is drawn, got {got}"
            help = (
                'write `fields: {friction: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.5, 1]}}`'
            )
            faults.append(Fault("wrong-type", message, help=help))
        return tuple(each for each in found if each is not None)


class Randomize(Model):
    """Seeded draws of parameters, and of attributes of the finished model."""

    seed: Annotated[int, Whole("seed", 0, MAX_SEED)]
    """What makes these draws differ from those of another seed: a whole number below 2**64."""
    samples: Annotated[int, Whole("samples", 1, "samples")]
    """How many samples there are, besides sample 0, the model without any draw."""
    emit: Annotated[Literal["models", "worlds", "union"], Choice("emit", chosen=True, former=_FORMER)] = (
        "models"
    )
    """What `build --all` writes: a model for each sample, or with `worlds` one and a table of all numbers of mjModel
    that differ between the samples. With `union` it writes models, and `build --worlds`
    makes one with the parts of all where these draw different ones."""
    fields: Annotated[tuple[DrawField, ...], Fields()]
    """What is drawn: a mapping from a name, which is part of the seed, to a distribution and what it is for."""

    @property
    def at_run_time(self) -> bool:
        """Return whether only one model is built, and its draws are used at run time."""
        return self.emit == "worlds"

    @property
    def of_parameters(self) -> tuple[DrawField, ...]:
        """Return the fields that draw parameters."""
        return tuple(each for each in self.fields if each.param is not None)
