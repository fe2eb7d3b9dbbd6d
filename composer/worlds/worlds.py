"""The worlds of a bundle: the numbers of mjModel that differ, and their values in each world."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.bundle.bundle import WORLDS
from composer.bundle.manifest import Manifest
from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, read
from composer.compiled.varying import flat, put, value_of
from composer.compiled.whose import Whose, whose
from composer.dataclass import dataclass
from composer.diagnostics.failure import MjcomposeError
from composer.loading.index import Index
from composer.loading.load import Model
from composer.loading.load import load as load_bundle
from composer.reading.regular import read_regular
from composer.worlds import table_file
from composer.worlds.errors import failure
from composer.worlds.identity import model_sha256
from composer.worlds.table import Table, Varying


@dataclass(frozen=True, slots=True)
class Worlds:
    """The `nominal` model, and by array of mjModel the numbers that differ between worlds.

    `table` says which cell of the recipe's matrix and which sample a world is; without a matrix world `n` is sample
    `n + 1`. What follows from what is drawn is among the arrays: `body_subtreemass`,
    `dof_invweight0`, `qpos0` and others, so that nothing is to be computed again. `stat.meaninertia` is a
    number of `model.stat`.
    """

    nominal: Model
    manifest: Manifest
    index: Index
    table: Table

    @property
    def arrays(self) -> Mapping[str, Varying]:
        """The numbers that differ, by array."""
        return self.table.arrays

    @property
    def count(self) -> int:
        """The number of worlds."""
        return self.table.count

    def __len__(self) -> int:
        return self.count

    def model(self, world: int) -> Model:
        """Return one world as a `mujoco.MjModel` of its own. Raises IndexError."""
        if not -self.count <= world < self.count:
            raise IndexError(f"world {world} does not exist: there are {self.count}")
        model = copy.copy(self.nominal)
        for name, varying in self.arrays.items():
            numbers = flat(model, name).copy()
            numbers[varying.index] = varying.values[world]
            put(model, name, numbers)
        return model

    def models(self, worlds: Iterable[int] | None = None) -> Iterator[Model]:
        """Yield the models of these worlds, or of all, one after another."""
        for world in range(self.count) if worlds is None else worlds:
            yield self.model(world)

    def take(self, worlds: Iterable[int]) -> Worlds:
        """Return some of the worlds, in this order: `study.take(range(2000))`. Raises IndexError."""
        chosen = np.fromiter(worlds, np.int64)
        if chosen.size and not -self.count <= chosen.min() <= chosen.max() < self.count:
            raise IndexError(f"world {chosen.max()} does not exist: there are {self.count}")
        arrays = {name: Varying(each.index, each.values[chosen]) for name, each in self.arrays.items()}
        table = replace(self.table, arrays=arrays, count=chosen.size, cell=self.table.cell[chosen],
                        sample=self.table.sample[chosen],
                        has=self.table.has[chosen] if self.table.parts else self.table.has)  # fmt: skip
        return replace(self, table=table)

    def values(self, name: str) -> NDArray[Any]:
        """Return an array in all worlds, `(worlds, *shape)`, including equal numbers.

        Raises AttributeError if there is none. This is the form for batched simulators: `values("geom_friction")`
        has the shape `(worlds, ngeom, 3)`.
        """
        shape = np.shape(value_of(self.nominal, name))
        whole = np.repeat(flat(self.nominal, name)[None], self.count, axis=0)
        if name in self.arrays:
            whole[:, self.arrays[name].index] = self.arrays[name].values
        return whole.reshape(self.count, *shape)

    def whose(self, name: str) -> list[Whose]:
        """Return kind, name and attribute for each differing number of an array.

            study.whose("geom_friction")[0]   # Whose(kind="geom", element="pads/left", attribute="friction[0]")

        Raises KeyError.
        """
        return whose(self.nominal, name, self.arrays[name].index)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the numbers to an `.npz` or a `.parquet` for `load(bundle, path)`, completely or not at all.

        Raises MjcomposeError.
        """
        try:
            table_file.write(path, self.nominal, self.table)
        except OutputError as error:
            raise MjcomposeError([error.diagnostic]) from error


def load(bundle: str | PathLike[str], file: str | PathLike[str] | None = None) -> Worlds:
    """Load the worlds of a bundle, a folder or an archive, that was built from a recipe with `emit: worlds`.

    With a `file`, the worlds are those that `mjcompose build --worlds` or `Worlds.save` wrote there. Files are
    checked against the manifest and arrays against the model, as in `composer.load`. Raises LoadError; warns with
    BundleWarning.
    """
    shown = os.fspath(bundle)
    loaded = load_bundle(bundle)
    try:
        content = read(Path(bundle)).files.get(WORLDS) if file is None else read_regular(file)
    except ReadError as error:
        raise failure(error.code, error.message) from error
    except OSError as error:
        raise failure("file-unreadable", f"`{file}` cannot be read: {error.strerror or error}") from error
    if content is None:
        help = "write `randomize: {emit: worlds}` in its recipe, and build it"
        raise failure("file-not-found", f"`{shown}` has no worlds: the file `{WORLDS}` does not exist", help)
    called = file or WORLDS
    try:
        table = table_file.read(content)
    except (ValueError, KeyError, TypeError, OSError) as error:
        raise failure("file-unreadable", f"`{called}` of `{shown}` cannot be read: {error}") from error
    if table.model not in (None, model_sha256(loaded.manifest)):
        raise failure(
            "bundle-changed",
            f"the worlds in `{called}` are of another model than `{shown}`",
            "load them with the bundle that was built beside them, or build both again",
            notes=[f"expected the model {table.model}", f"found the model {model_sha256(loaded.manifest)}"],
        )
    for name, varying in table.arrays.items():
        _check(loaded.model, name, varying, count=table.count, shown=shown)
    return Worlds(loaded.model, loaded.manifest, loaded.index, table=table)


def _check(model: Model, name: str, varying: Varying, count: int, shown: str) -> None:
    """Check that the numbers fit the model."""
    try:
        size = flat(model, name).size
    except AttributeError:
        size = -1
    index, shape = varying.index, varying.values.shape
    fits = index.dtype.kind == "i" and index.ndim == 1 and shape == (count, index.size)
    if size < 0 or not fits or (index.size and not 0 <= int(index.min()) <= int(index.max()) < size):
        message = f"the worlds of `{shown}` are not of its model: `{name}` has no such numbers in this MuJoCo"
        raise failure("bundle-changed", message, "build it again with the MuJoCo that runs here")
