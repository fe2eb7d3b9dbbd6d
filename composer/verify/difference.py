"""One thing that a part is in a composition and is not alone, or the other way round."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Value: TypeAlias = bool | int | float | str | None | tuple["Value", ...]

MISSING = "missing"
EXTRA = "extra"


@dataclass(frozen=True, slots=True)
class Difference:
    """A field of an element that differs.

    ``kind`` is MJCF's word for the element, ``name`` its name in the composition (in the part alone, where the
    composition lacks it), ``field`` the array of `mjModel`, with an index where only one entry is shown.
    ``expected`` is the value in the part alone, ``actual`` the one in the composition; references are names.
    ``field`` is ``missing`` for an element the composition lacks and ``extra`` for one the part lacks.
    """

    kind: str
    name: str
    field: str
    expected: Value
    actual: Value

    def __str__(self) -> str:
        subject = f"{self.kind} {self.name}" if self.name.startswith("#") else f"{self.kind} `{self.name}`"
        if self.field == MISSING:
            return f"{subject} is missing"
        if self.field == EXTRA:
            return f"{subject} is not in the part alone"
        return f"{subject}: `{self.field}` is {_shown(self.actual)}, alone it is {_shown(self.expected)}"


def _shown(value: Value) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_shown(item) for item in value) + "]"
    if isinstance(value, str):
        return f"`{value}`"
    if value is None:
        return "none"
    return repr(value)
