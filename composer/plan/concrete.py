"""Expand and validate a recipe file with given values, once for each pair in a run.

A plan, the matrix, its samples and a recipe that is nested twice request the same pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, TypeVar

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping as Located
from composer.document.node import Node
from composer.expand.expand import Concrete, expand
from composer.plan.read import read_recipe
from composer.recipe.recipe import Recipe
from composer.recipe.validate import validate_what_remains

Given = Mapping[str, Node]
"""Values of parameters and variants by name, each with the place that sets it."""

Result = TypeVar("Result")
_KEPT = 256
"""How many results a run keeps: a matrix may have many more cells."""


class ValidRecipe(NamedTuple):
    """A recipe without its faulty pieces, the tree that it was read from, and its expansion.

    `concrete` is None if the file is not a mapping. `lost` has the names of the pieces that were left out.
    """

    recipe: Recipe
    document: Located
    concrete: Concrete | None
    lost: frozenset[str]


def expanded(path: Path, given: Given, context: Context) -> Concrete | None:
    """Return the concrete recipe, or None if the file is not a mapping.

    Errors go to the context's sink on each call.
    """

    def work(own: Context) -> Concrete | None:
        node = read_recipe(path, own)
        return expand(node, given, own.sink) if isinstance(node, Located) else None

    return _once(("expanded", path, _values(given)), context, work)


def validated(path: Path, given: Given, context: Context) -> ValidRecipe | None:
    """Return the valid recipe, or None if the file is unreadable. Errors go to the context's sink on each call."""

    def work(own: Context) -> ValidRecipe | None:
        concrete = expanded(path, given, own)
        node = read_recipe(path, replace(own, sink=Sink())) if concrete is None else concrete.document
        gone = frozenset() if concrete is None else concrete.gone
        found = None if node is None else validate_what_remains(node, own.sink, gone)
        if found is None:
            return None
        lost = found.lost | (concrete.lost if concrete else frozenset())
        return ValidRecipe(found.recipe, found.document, concrete, lost=lost)

    return _once(("validated", path, _values(given)), context, work)


def _values(given: Given) -> tuple[tuple[str, str], ...]:
    return tuple(sorted((name, repr(node)) for name, node in given.items()))


def _once(key: tuple[object, ...], context: Context, work: Callable[[Context], Result]) -> Result:
    """Return the result of the work, computed only if it is not kept; its diagnostics go to the context's sink."""
    known = context.concrete.pop(key, None)
    if known is None:
        own = replace(context, sink=Sink())
        result = work(own)
        known = result, tuple(own.sink.diagnostics)
        while len(context.concrete) >= _KEPT:
            del context.concrete[next(iter(context.concrete))]
    context.concrete[key] = known
    for diagnostic in known[1]:
        context.sink.add(diagnostic)
    value: Result = known[0]
    return value
