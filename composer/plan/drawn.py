"""One value that was drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from composer.expr.value import Value
from composer.recipe.distribution import Operation
from composer.recipe.draw_field import DrawField


@dataclass(frozen=True, slots=True)
class Drawn:
    """A draw of a field: of an element's attribute, or (`element` None) of a parameter called `attribute`.

    `element` is what the draw goes by: a name, or for an element without one its place. `shared` says that the same
    draw is that of every element. Angles are in radians, those of parameters in the parameter's unit; the first number
    is component `start` of the attribute.
    """

    field: str
    element: str | None
    attribute: str
    operation: Operation
    value: Value
    shared: bool = False
    start: int = 0

    def columns(self) -> list[tuple[str, Value]]:
        """The numbers, each with the name of its column in a table of samples.

        >>> Drawn("camera", "top", "pos", "offset", (0.1, 0.2)).columns()
        [('camera[top][0]', 0.1), ('camera[top][1]', 0.2)]
        """
        name = self.field if self.shared or self.element is None else f"{self.field}[{self.element}]"
        if isinstance(self.value, tuple):
            return [(f"{name}[{index}]", each) for index, each in enumerate(self.value)]
        return [(name, self.value)]


@dataclass(frozen=True, slots=True)
class Tabled:
    """The draws of one element for all samples from 1, for a table; `first` is that of sample 1.

    `name` is the element's, if it has one; `place` the body that it stands in, which one of those of its tag it is
    there and how many there are. `numbers` are the draws, those of each number of the attribute by themselves. `angles`
    says which of the numbers are angles, `unit` what bare ones are in.
    """

    first: Drawn
    field: DrawField
    name: str | None
    place: tuple[str, int, int] | None
    tag: str
    family: str
    numbers: tuple[Sequence[Value], ...]
    angles: tuple[bool, ...] = ()
    unit: str | None = None
