"""The definition of a verb of `edit`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeAlias

from composer.dataclass import dataclass
from composer.grammar.element import ElementType
from composer.recipe.fault import Fault, Path
from composer.recipe.reference import Schema
from composer.recipe.select import kinds_of
from composer.recipe.shown import kind_of, shown
from composer.recipe.verbs.values import Checker
from composer.tree.selector import Selector

Changed: TypeAlias = Iterable[tuple[str | None, str]]
"""Attributes, each with its tag, or None where the selector does not say the tag."""


@dataclass(frozen=True, slots=True)
class Selected:
    """What a verb is applied to: the selector, or None if it has a fault, and the verb's path in the recipe."""

    selector: Selector | None
    at: Path
    checker: Checker

    @property
    def tag(self) -> str:
        return self.selector.tag if self.selector else ""

    @property
    def kinds(self) -> tuple[ElementType, ...]:
        """Return the elements that the selector's tag means, or none if it does not say."""
        return kinds_of(self.selector.tag) if self.selector else ()

    def add(self, fault: Fault) -> None:
        self.checker.faults.append(fault)


@dataclass(frozen=True, slots=True)
class Verb:
    """A verb, as a recipe writes it. What carries it out is in `composer/compose/verbs`.

    `description` is for editors and the reference page. `read` returns the value as `Edit` keeps it, and reports
    faults. `words` returns the value on one line, for `plan` and `explain`. `changes` returns which attributes
    follow from the value, if the selector has a tag. It is None for a verb that makes or removes elements, after
    which a part cannot be compared with its source. `schema` is the JSON Schema of the value; `schema_of_tag` has
    further conditions if the selector has a tag, and `schema_of_classes` if it selects default classes. A verb that
    is `alone` cannot be combined with others.
    """

    name: str
    description: str
    read: Callable[[Any, Selected], Any]
    words: Callable[[Any], str]
    changes: Callable[[str | None, Any], Changed] | None
    schema: Callable[[], Schema]
    schema_of_tag: Callable[[str], Schema] | None = None
    schema_of_classes: Callable[[], Schema] | None = None
    alone: bool = False


def read_mapping(name: str, value: Any, example: str, selected: Selected) -> dict[str, Any] | None:
    """Return the value of a verb that must be a mapping with entries, or None after a reported fault."""
    if isinstance(value, dict) and value:
        return value
    message = f"`{name}` expects a mapping, got {kind_of(value) if value != {} else 'an empty one'}"
    selected.add(Fault("wrong-type", message, selected.at, help=f"write `{name}: {example}`"))
    return None


def with_values(value: Mapping[str, Any], but: str) -> str:
    """Return all entries of a mapping but one, as the end of a line.

    >>> with_values({"to": "motor", "gear": [2]}, "to")
    ' with gear = [2]'
    """
    given = [f"{name} = {shown(each)}" for name, each in value.items() if name != but]
    return f" with {', '.join(given)}" if given else ""


def flat(written: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Yield the values of a mapping and of mappings inside it, by their paths."""
    for name, value in written.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{above}{name}.")
        else:
            yield above + name, shown(value)
