"""One difference between a part in a composition and the part alone."""

from __future__ import annotations

import re
from typing import TypeAlias

from composer.dataclass import dataclass

Value: TypeAlias = bool | int | float | str | tuple["Value", ...] | None

MISSING = "missing"
EXTRA = "extra"


@dataclass(frozen=True, slots=True)
class Difference:
    """A field of an element that differs.

    ``kind`` is MJCF's word for the element, ``name`` its name in the composition; an unnamed one is reported by its
    place. ``field`` is the array of `mjModel`, with an index if only one entry is shown, or ``missing`` for an
    element that the composition lacks, ``extra`` for one that the part lacks. ``expected`` is the value in the part
    alone, ``actual`` the one in the composition; references are names. ``why`` says in words where MuJoCo itself makes
    the difference.
    """

    kind: str
    name: str
    field: str
    expected: Value
    actual: Value
    why: str = ""

    @property
    def array(self) -> str:
        """The array of `mjModel`, without the index or the element of a key's entry."""
        return re.split(r"[\[, ]", self.field, maxsplit=1)[0]

    def __str__(self) -> str:
        subject = f"{self.kind} {self.name}" if self.name.startswith("#") else f"{self.kind} `{self.name}`"
        if self.field == MISSING:
            return f"{subject} is missing"
        if self.field == EXTRA:
            return f"{subject} is not in the part alone"
        why = f" ({self.why})" if self.why else ""
        return f"{subject}: `{self.field}` is {_shown(self.actual)}, alone it is {_shown(self.expected)}{why}"


def _shown(value: Value) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_shown(item) for item in value) + "]"
    if isinstance(value, str):
        return f"`{value}`"
    if value is None:
        return "none"
    return repr(value)
