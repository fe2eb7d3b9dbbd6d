"""What a kind of check is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

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
    """What stands behind the word of a kind: a `Keyed` mapping, or a list."""

    def read(self, keys: Keys) -> Any:
        """What `make` gets; what is wrong goes to the faults of `keys`."""

    def schema(self) -> Schema:
        """The JSON Schema of it."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of check. `example` is what messages advise to write.

    `make` gives the check of what `form` has read, also where there were faults: these are reported, and the check is
    not used. It may find more that is wrong. A check that `needs_world` is about points in the world of its recipe, and
    cannot be run where it is not known where that is. One `of_target` is about what other programs make of the model:
    `composer/targets` carries it out.
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
