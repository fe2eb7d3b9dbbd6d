"""Many models that stand in one folder, loaded one by one as they are asked for."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from composer.bundle.listing import ListingError, Row, rows
from composer.bundle.place import Place, is_address
from composer.bundle.where import Condition
from composer.expr.value import Value
from composer.loading.errors import LoadError
from composer.loading.load import Loaded, load


@dataclass(frozen=True, slots=True)
class Listed:
    """A model of an index, which is not loaded yet: its name, where it is, and what sets it apart.

    `values` has what the columns of the index say: what the matrix sets, what was drawn, sizes, the sha256.
    """

    name: str
    path: Place
    values: Mapping[str, Value]

    def load(self, *, allow_changes: bool = False) -> Loaded:
        """The model, as `composer.load` loads it. Raises LoadError."""
        return load(self.path, allow_changes=allow_changes)


def load_many(path: str | PathLike[str], where: str | None = None) -> Iterator[Listed]:
    """The models that `mjcompose build --all` wrote to a folder, one after another; none is loaded before it is asked.

        for each in composer.load_many("build/study", where="payload > 2"):
            model, manifest, index = each.load()

    `path` may be an address, such as `s3://bucket/study`, or the index itself. `where` is an expression as recipes have
    it, of the columns of the index. Raises LoadError, at the first model.
    """
    try:
        condition = None if where is None else Condition(where)
        shown = os.fspath(path)
        for row in rows(shown if is_address(shown) else Path(path), shown):
            if condition is None or condition.holds(row):
                yield _listed(row)
        if condition is not None:
            condition.check()
    except ListingError as error:
        raise LoadError([error.diagnostic]) from error


def _listed(row: Row) -> Listed:
    return Listed(str(row.values.get("model", "")), row.file, row.values)
