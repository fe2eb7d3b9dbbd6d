"""Values that were drawn."""

from __future__ import annotations

from collections.abc import Sequence

from composer.dataclass import dataclass
from composer.expr.value import Value
from composer.recipe.distribution import Operation
from composer.recipe.draw_field import DrawField


@dataclass(frozen=True, slots=True)
class Drawn:
    """A draw for an attribute of an element, or (`element` None) for the parameter `attribute`.

    `element` identifies the draw: a name, or the place of an unnamed element. `shared` says that all elements have
    the same draw. Angles are in radians, those of parameters in the parameter's unit; the first number is component
    `start` of the attribute.
    """

    field: str
    element: str | None
    attribute: str
    operation: Operation
    value: Value
    shared: bool = False
    start: int = 0

    def columns(self) -> list[tuple[str, Value]]:
        """Return the numbers, each with the name of its column in a table of samples.

        >>> Drawn("camera", "top", "pos", "offset", (0.1, 0.2)).columns()
        [('camera[top][0]', 0.1), ('camera[top][1]', 0.2)]
        """
        name = self.field if self.shared or self.element is None else f"{self.field}[{self.element}]"
        if isinstance(self.value, tuple):
            return [(f"{name}[{index}]", each) for index, each in enumerate(self.value)]
        return [(name, self.value)]


@dataclass(frozen=True, slots=True)
class ElementDraws:
    """The draws for one element in all samples from 1, for a table; `first` is that of sample 1.

    `name` is the element's name, if any; `place` is its body, its number among the elements with its tag there, and
    their count. `numbers` are the draws, separately for each number of the attribute. `angles` says which of the
    numbers are angles, `unit` is the unit of bare angles.
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
