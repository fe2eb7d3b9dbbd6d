"""The definition of a kind of check."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from composer.dataclass import dataclass
from composer.recipe.checks.form import Keyed
from composer.recipe.checks.keys import Keys
from composer.recipe.fault import Path
from composer.recipe.reference import Schema


class Check(Protocol):
    """One check of a recipe: its kind, its name, and its path from the top of the recipe."""

    @property
    def word(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def at(self) -> Path: ...


class Form(Protocol):
    """The form of a check's value: a `Keyed` mapping, or a list."""

    def read(self, keys: Keys) -> Any:
        """Return the argument of `make`. Faults are added to `keys`."""

    def schema(self) -> Schema:
        """Return the JSON Schema of the value."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of check. `example` is what messages recommend to write.

    `make` makes the check from what `form` has read, and may report more faults. After a fault its result is not
    used. A check that `needs_world` is about points in the world of its recipe, and cannot run in a nested recipe
    whose place is unknown. A check `of_target` is about other programs: `composer/targets` carries it out.
    """

    word: str
    form: Form
    make: Callable[[Keys, Any, Path], Check | None]
    example: str
    needs_world: bool = False
    of_target: bool = False

    @property
    def is_list(self) -> bool:
        return not isinstance(self.form, Keyed)
