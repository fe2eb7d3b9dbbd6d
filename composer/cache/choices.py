"""The combinations of variants that `--variant` can select, independent of the matrix."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, Scalar
from composer.expand.variants import read_axes
from composer.plan.read import read_recipe

MANY = 64


def choices_of(recipe: Path, context: Context) -> Iterator[dict[str, Node]]:
    """Yield all combinations; if there are more than `MANY`, every value once with the other axes at their default."""
    node = read_recipe(context.folder / recipe, context)
    axes = read_axes(node, Sink()) if isinstance(node, Mapping) else {}
    values: dict[str, list[Node]] = {
        axis: [Scalar(key.name, key.span, key.name, plain=True) for key, _ in pieces.entries.values()]
        for axis, pieces in axes.items()
    }
    if not values:
        return
    if math.prod(map(len, values.values())) <= MANY:
        for chosen in itertools.product(*values.values()):
            yield dict(zip(values, chosen, strict=True))
    else:
        yield from ({axis: value} for axis, every in values.items() for value in every)
