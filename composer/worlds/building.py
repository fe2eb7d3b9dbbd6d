"""Build all models of a recipe, as `build --all` does, and convert them to worlds of the first one."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

from composer.bundle.bundle import WORLDS, Bundle
from composer.bundle.folder import write_folder
from composer.cache.builder import Maker
from composer.cache.result import Made
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.document.node import Scalar, find
from composer.engine import Session
from composer.expand.matrix import Cell
from composer.loading.load import load
from composer.plan.read import read_recipe
from composer.reading.regular import read_regular
from composer.worlds.joining import Joined
from composer.worlds.table_file import read


@dataclass(frozen=True, slots=True)
class Shelf:
    """A folder for built models until they are converted. Can be pickled."""

    folder: Path

    def place(self, name: str, mujoco: str | None) -> Path:
        """Return the folder of a model, for `Maker`."""
        return self.folder / name.replace("/", "_")

    def put(self, made: Made, maker: Maker, context: Context, session: Session | None) -> Made | None:
        """Write a model, for `CellMaker`."""
        bundle = made.bundle
        assert isinstance(bundle, Bundle)
        write_folder(bundle, self.place(made.name, made.mujoco))
        return made

    def take(self, made: Made, cell: Cell) -> Joined:
        """Load a model, with its worlds if it has some. Raises LoadError."""
        folder = self.place(made.name, made.mujoco)
        loaded, table = load(folder), None
        if os.path.exists(folder / WORLDS):
            table = read(read_regular(folder / WORLDS))
        named = {"name": cell.cell or loaded.manifest.name}
        return Joined(
            loaded, made.name, {**named, **cell.values()}, sample=cell.sample, table=table, folder=folder
        )

    def clear(self, each: Joined) -> None:
        """Remove the files of a model."""
        assert each.folder is not None
        shutil.rmtree(each.folder, ignore_errors=True)


def is_united(recipe: Path, context: Context) -> bool:
    """Return whether a recipe requests one model with the parts of all: `emit: union` in `matrix` or `randomize`."""
    document = read_recipe(context.folder / recipe, replace(context, sink=Sink()))
    found = [find(document, (section, "emit")) for section in ("matrix", "randomize")] if document else []
    return any(isinstance(each, Scalar) and each.value == "union" for each in found)
