"""Load many models of one folder, each on request."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path

from mjcompose.base.dataclass import dataclass
from mjcompose.build.bundle.bundle import Location, is_address
from mjcompose.build.bundle.listing import Condition, ListingError, rows
from mjcompose.text.expression_values import Value
from mjcompose.tools.worlds.load import Loaded, load
from mjcompose.tools.worlds.names import LoadError


@dataclass(frozen=True, slots=True)
class Listed:
    """A model of an index that is not loaded yet: its name, its place, and its values.

    `values` are the columns of the index: values of the matrix and of draws, sizes, the sha256.
    """

    name: str
    path: Location
    values: Mapping[str, Value]

    def load(self, *, allow_changes: bool = False) -> Loaded:
        """Load the model as `mjcompose.load` does. Raises LoadError."""
        return load(self.path, allow_changes=allow_changes)


def load_many(path: str | PathLike[str], where: str | None = None) -> Iterator[Listed]:
    """Yield the models that `mjcompose build --all` wrote to a folder, one after another, without loading them.

        for each in mjcompose.load_many("build/study", where="payload > 2"):
            model, manifest, index = each.load()

    `path` may be an address, such as `s3://bucket/study`, or the index itself. `where` is an expression as in
    recipes, on the columns of the index. Raises LoadError, at the first model.
    """
    try:
        condition = None if where is None else Condition(where)
        shown = os.fspath(path)
        for row in rows(shown if is_address(shown) else Path(path), shown):
            if condition is None or condition.holds(row):
                yield Listed(str(row.values.get("model", "")), row.file, row.values)
        if condition is not None:
            condition.check()
    except ListingError as error:
        raise LoadError([error.diagnostic]) from error
