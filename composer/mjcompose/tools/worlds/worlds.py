"""The worlds of a bundle: the numbers that differ, and their tables."""

from __future__ import annotations

import copy
import hashlib
import json
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field, replace
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.report import MjcomposeError, short_traceback
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import DRAWS, MANIFEST, WORLDS, Bundle, OutputError, path_of_bundle
from mjcompose.bundle.manifest import Manifest, files_of, from_json, with_manifest
from mjcompose.bundle.read import ReadError, read as read_bundle
from mjcompose.bundle.staging import staged_file
from mjcompose.mujoco.varying import Whose, flat, put, stored, value_of, whose
from mjcompose.text.expression import Value
from mjcompose.tools.worlds.load import Model as LoadModel, load as load_bundle
from mjcompose.tools.worlds.names import Index, failure
from mjcompose.tools.worlds.shares import Weights, shared_out, weights_of, worlds_of_cells

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_TABLES = frozenset({DRAWS, WORLDS, "samples.csv"})


def model_sha256(manifest: Manifest) -> str:
    """Return the identity of a model: a hash of all files in its manifest, except tables of draws and worlds.

    That way a table can be in the bundle of its own model.
    """
    whole = hashlib.sha256()
    for file in sorted(manifest.files, key=lambda each: each.path):
        if file.path not in _TABLES:
            whole.update(f"{file.path}\0{file.sha256}\n".encode())
    return whole.hexdigest()


FORMAT = 1


class Varying(Struct):
    """The numbers of one array that vary.

    `index` are their places in the flattened array, `(numbers,)`. `values` are absolute and in the array's units,
    `(worlds, numbers)`.
    """

    index: NDArray[np.int64]
    values: NDArray[Any]


class Table(Struct):
    """The numbers that differ, by array, in `count` worlds; and the cell and sample of the recipe for each world.

    `cells` are the cells of its matrix, each with its `name` and its values. `cell` has the number of each world's
    cell, `(worlds,)`, and `sample` has the number of its sample. For a union, `parts` are the bodies that not all
    worlds have, and `has` says which worlds have them, `(worlds, parts)`. For cells of one tree with different geoms,
    `present` says which cells have which geoms of the model, `(cells, ngeom)`. `weights` has the weight of each
    cell in the recipe's matrix. `model` is the identity of the model, None in a bundle that contains it.
    """

    arrays: Mapping[str, Varying]
    count: int
    seed: int | None = None
    cells: tuple[Mapping[str, Value | None], ...] = ()
    cell: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    sample: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    model: str | None = None
    mujoco: str | None = None
    parts: tuple[str, ...] = ()
    has: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((0, 0), np.bool_))
    present: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((0, 0), np.bool_))
    weights: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    def about(self) -> dict[str, Any]:
        """Return everything except the arrays, for JSON."""
        return {
            "worlds": FORMAT,
            "samples": self.count,
            "seed": self.seed,
            "mujoco": self.mujoco,
            "model_sha256": self.model,
            "cells": list(map(dict, self.cells)),
            "parts": list(self.parts),
            "has": self.has.astype(int).tolist() if self.parts else [],
            "present": self.present.astype(int).tolist(),
            "weights": self.weights.tolist(),
        }


def of_about(about: Mapping[str, Any], arrays: Mapping[str, Varying], **given: Any) -> Table:
    """Return the table for the data in a file. Raises KeyError, TypeError, ValueError."""
    if about["worlds"] != FORMAT:
        raise ValueError(f"its format is {about['worlds']}, this mjcompose knows {FORMAT}")
    count = int(about["samples"])
    given = {"cell": np.zeros(count, np.int64), "sample": np.arange(1, count + 1), **given}
    parts = tuple(about.get("parts", ()))
    present = about.get("present") or []
    return Table(
        arrays,
        count,
        about["seed"],
        cells=tuple(about.get("cells", ())),
        **given,
        model=about.get("model_sha256"),
        mujoco=about.get("mujoco"),
        parts=parts,
        has=np.array(about.get("has", ()), np.bool_).reshape(count if parts else 0, len(parts)),
        weights=np.array(about.get("weights", ()), float),
        present=np.array(present, np.bool_).reshape(len(present), len(present[0]) if present else 0),
    )


_PARQUET_ABOUT = b"mjcompose"
_ARRAY = b"array"
_INDEX = b"index"


def check_installed() -> Any:
    """Return `pyarrow`. Raises OutputError without it."""
    try:
        import pyarrow.parquet
    except ImportError:
        help = "`pip install pyarrow`, or end its name in `.npz`"
        raise OutputError("output-kind", "a Parquet table needs the package `pyarrow`", help) from None
    return pyarrow


def write_parquet(path: Path, model: MjModel, table: Table) -> None:
    """Write a table with columns such as `geom_friction pads/left friction[0]`.

    The schema has the array and index of each column.
    """
    arrow = check_installed()
    fields = []
    columns = []
    for name in ("cell", "sample"):
        fields.append(arrow.field(name, arrow.int64()))
        columns.append(getattr(table, name))
    for name, varying in sorted(table.arrays.items()):
        for column, (at, of) in enumerate(zip(varying.index, whose(model, name, varying.index), strict=True)):
            called = " ".join(word for word in (name, of.element, of.attribute) if word)
            place = {_ARRAY: name.encode(), _INDEX: str(at).encode()}
            fields.append(arrow.field(called, arrow.from_numpy_dtype(varying.values.dtype), metadata=place))
            columns.append(np.ascontiguousarray(varying.values[:, column]))
    schema = arrow.schema(fields, metadata={_PARQUET_ABOUT: json.dumps(table.about()).encode()})
    arrow.parquet.write_table(arrow.table(columns, schema=schema), path)


def read_parquet(content: bytes) -> Table:
    """Parse a table. Raises ValueError, KeyError, TypeError or OSError for anything else."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise ValueError("a Parquet table needs the package `pyarrow`: `pip install pyarrow`") from None
    found = pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    about = json.loads((found.schema.metadata or {})[_PARQUET_ABOUT])
    numbers: dict[str, tuple[list[int], list[Any]]] = {}
    given: dict[str, Any] = {}
    for each, column in zip(found.schema, found.columns, strict=True):
        place = each.metadata or {}
        if _ARRAY not in place:
            given[each.name] = column.to_numpy()
            continue
        index, values = numbers.setdefault(place[_ARRAY].decode(), ([], []))
        index.append(int(place[_INDEX]))
        values.append(column.to_numpy())
    arrays = {
        name: Varying(np.array(places, np.int64), np.stack(values, axis=1))
        for name, (places, values) in numbers.items()
    }
    return of_about(about, arrays, cell=given["cell"], sample=given["sample"])


_TABLE_FILE_ABOUT = "about.json"


def write(
    path: str | PathLike[str], model: MjModel, table: Table, option: str | None = None, *, inputs: tuple[Path, ...] = ()
) -> None:
    """Write a table completely or not at all: as Parquet if the name says so, else as `.npz`. Raises OutputError."""
    path = Path(path)
    check_name(path)
    with staged_file(path, option, inputs=inputs) as stage:
        if path.suffix.lower() == ".parquet":
            write_parquet(stage, model, table)
            return
        with stage.open("wb") as file:
            _write_npz(file, model, table)


def _write_npz(file: IO[bytes], model: MjModel, table: Table) -> None:
    found = ((name, varying.index, varying.values) for name, varying in sorted(table.arrays.items()))
    about = np.frombuffer(json.dumps(table.about()).encode(), np.uint8)
    arrays: dict[str, Any] = {_TABLE_FILE_ABOUT: about, "cell": table.cell, "sample": table.sample}
    arrays |= stored(model, found)
    np.savez(file, allow_pickle=False, **arrays)


def with_table(bundle: Bundle, model: MjModel, table: Table) -> Bundle:
    """Return a bundle with its table of worlds in it, instead of the draws of a single cell."""
    content = BytesIO()
    _write_npz(content, model, replace(table, model=None))
    kept = {path: data for path, data in bundle.files.items() if path not in _TABLES}
    whole = Bundle({**kept, WORLDS: content.getvalue()}, bundle.model)
    return with_manifest(whole, from_json(bundle.files[MANIFEST]).model_copy(update={"files": files_of(whole)}))


def check_name(path: Path) -> None:
    """Raise OutputError for a name that no table of worlds can have."""
    if path.suffix.lower() not in (".npz", ".parquet"):
        help = f"end it in `.npz`, or in `.parquet` with `pyarrow` installed: `{path.with_suffix('.npz')}`"
        raise OutputError("output-kind", f"no table of worlds is called `*{path.suffix}`: `{path}`", help)
    if path.suffix.lower() == ".parquet":
        check_installed()


def read(content: bytes) -> Table:
    """Parse a table. Raises ValueError, KeyError, TypeError or OSError for anything else."""
    if content.startswith(b"PAR1"):
        return read_parquet(content)
    try:
        with np.load(BytesIO(content), allow_pickle=False) as file:
            about = json.loads(bytes(file[_TABLE_FILE_ABOUT]))  # text next to the arrays, or an array of its bytes
            names = sorted({each.rpartition("/")[0] for each in file.files if "/" in each})
            arrays = {name: Varying(file[f"{name}/index"], file[f"{name}/values"]) for name in names}
            given = {each: file[each] for each in ("cell", "sample") if each in file.files}
    except zipfile.BadZipFile as error:
        raise ValueError(str(error)) from error
    return of_about(about, arrays, **given)


def with_numbers(model: MjModel, numbers: Mapping[str, tuple[NDArray[np.int64], NDArray[Any]]]) -> MjModel:
    """Return a copy of a model with these numbers: by array, their flat indices and values."""
    model = copy.copy(model)
    for name, (index, values) in numbers.items():
        whole = flat(model, name).copy()
        whole[index] = values
        put(model, name, whole)
    return model


def model_of_world(nominal: MjModel, arrays: Mapping[str, Varying], world: int) -> MjModel:
    """Return one world as a model of its own."""
    return with_numbers(nominal, {name: (own.index, own.values[world]) for name, own in arrays.items()})


class Worlds(Struct):
    """The `nominal` model, and by array of mjModel the numbers that differ between worlds.

    `table` has the cell of the recipe's matrix and the sample of each world; without a matrix world `n` is sample
    `n + 1`. The arrays include values that depend on drawn ones: `body_subtreemass`, `dof_invweight0`, `qpos0` and
    others, so you need not compute them again. `stat.meaninertia` is a number of `model.stat`. `assign`
    chose these worlds from those of `pool`.
    """

    nominal: LoadModel
    manifest: Manifest
    index: Index
    table: Table
    sources: tuple[Path, ...] = ()
    pool: Worlds | None = None

    @property
    def arrays(self) -> Mapping[str, Varying]:
        """The numbers that differ, by array."""
        return self.table.arrays

    @property
    def count(self) -> int:
        return self.table.count

    def __len__(self) -> int:
        return self.count

    def model(self, world: int) -> LoadModel:
        """Return one world as a `mujoco.MjModel` of its own. Raises IndexError."""
        if not -self.count <= world < self.count:
            raise IndexError(f"world {world} does not exist: there are {self.count}")
        return model_of_world(self.nominal, self.arrays, world)

    def models(self, worlds: Iterable[int] | None = None) -> Iterator[LoadModel]:
        """Yield the models of these worlds, or of all worlds, one after another."""
        yield from map(self.model, range(self.count) if worlds is None else worlds)

    def summary(self) -> str:
        """Return the worlds in words: `8 cells as one model (nv 15, 52 geoms, 26 meshes), in which …`."""
        model = self.nominal
        present = self.table.present
        largest = f"\n  the largest cell has {present.sum(axis=1).max()} geoms" if present.size else ""
        numbers = sum(varying.index.size for varying in self.arrays.values())
        cells = counted(len(self.table.cells), "cell")
        worlds = "" if self.count == len(self.table.cells) else f", {counted(self.count, 'world')}"
        return (
            f"{cells} as one model (nv {model.nv}, {model.ngeom} geoms, {model.nmesh} meshes){worlds}, in which"
            f" {numbers} numbers of {len(self.arrays)} arrays differ{largest}"
        )

    def take(self, worlds: Iterable[int]) -> Worlds:
        """Return some of the worlds, in this order: `study.take(range(2000))`. Raises IndexError."""
        chosen = np.fromiter(worlds, np.int64)
        if chosen.size and not -self.count <= chosen.min() <= chosen.max() < self.count:
            raise IndexError(f"world {chosen.max()} does not exist: there are {self.count}")
        arrays = {name: Varying(each.index, each.values[chosen]) for name, each in self.arrays.items()}
        table = replace(
            self.table,
            arrays=arrays,
            count=chosen.size,
            cell=self.table.cell[chosen],
            sample=self.table.sample[chosen],
            has=self.table.has[chosen] if self.table.parts else self.table.has,
        )
        return replace(self, table=table)

    def assign(self, count: int, weights: Weights | None = None) -> Worlds:
        """Return `count` worlds, divided among the cells by their weights, and each cell spread over all worlds.

            study = study.assign(4096, weights={"object": {"mug": 3, "can": 0}})

        `weights` are by axis and value: 1 for values without one, and 0 keeps a cell out. Weights of several axes
        multiply. Without them, the recipe's `matrix` has the weights. A cell gets the whole part of its share, and the
        largest remainders get the rest. Samples of a cell follow in turn. Raises LoadError.
        """
        pool = self.pool or self
        shares = pool.table.weights
        if weights is not None or not shares.size:
            shares = weights_of(pool.table.cells, weights or {})
        cells = shared_out(count, shares)
        turns = np.zeros(len(pool.table.cells), np.int64)
        places = []
        for cell in cells.tolist():
            places.append(int(turns[cell]))
            turns[cell] += 1
        return replace(pool.take(worlds_of_cells(pool.table.cell, cells, places).tolist()), pool=pool)

    def with_rows(self, worlds: NDArray[np.int64], pool: Worlds, rows: NDArray[np.int64]) -> Worlds:
        """Return the same worlds, some of which are now these worlds of the pool."""
        table = self.table
        arrays = {}
        for name, own in self.arrays.items():
            values = own.values.copy()
            values[worlds] = pool.arrays[name].values[rows]
            arrays[name] = Varying(own.index, values)
        cell = table.cell.copy()
        sample = table.sample.copy()
        has = table.has.copy()
        cell[worlds] = pool.table.cell[rows]
        sample[worlds] = pool.table.sample[rows]
        if table.parts:
            has[worlds] = pool.table.has[rows]
        return replace(self, table=replace(table, arrays=arrays, cell=cell, sample=sample, has=has), pool=pool)

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

        Raises MjcomposeError, even if `path` is a file that the worlds were loaded from.
        """
        try:
            write(path, self.nominal, self.table, inputs=self.sources)
        except OutputError as error:
            raise MjcomposeError([error.diagnostic]) from error


@short_traceback
def load(bundle: str | PathLike[str], file: str | PathLike[str] | None = None) -> Worlds:
    """Load the worlds of a bundle, a folder or an archive, that was built from a recipe with `--as worlds`.

    With a `file`, the worlds are those that `mjcompose build --worlds` or `Worlds.save` wrote there. Files are
    checked against the manifest and arrays against the model, as in `mjcompose.load`. Raises LoadError; warns with
    BundleWarning.
    """
    shown = path_of_bundle(bundle)
    loaded = load_bundle(bundle)
    try:
        content = read_bundle(Path(bundle)).files.get(WORLDS) if file is None else read_regular(file)
    except ReadError as error:
        raise failure(error.code, error.message) from error
    except OSError as error:
        raise failure("file-unreadable", f"`{file}` cannot be read: {error.strerror or error}") from error
    if content is None:
        help = "build its recipe with `--as worlds`"
        raise failure("file-not-found", f"`{shown}` has no worlds: the file `{WORLDS}` does not exist", help)
    called = file or WORLDS
    try:
        table = read(content)
    except (ValueError, KeyError, TypeError, OSError) as error:
        raise failure("file-unreadable", f"`{called}` of `{shown}` cannot be read: {error}") from error
    if table.model not in (None, model_sha256(loaded.manifest)):
        message = f"the worlds in `{called}` belong to another model than `{shown}`"
        help = "load them with the bundle that was built with them, or build both again"
        notes = [f"expected the model {table.model}", f"found the model {model_sha256(loaded.manifest)}"]
        raise failure("bundle-changed", message, help, notes=notes)
    for name, varying in table.arrays.items():
        _check(loaded.model, name, varying, count=table.count, shown=shown)
    sources = (Path(bundle), *([] if file is None else [Path(file)]))
    return Worlds(loaded.model, loaded.manifest, loaded.index, table=table, sources=sources)


def _check(model: LoadModel, name: str, varying: Varying, count: int, shown: str) -> None:
    try:
        size = flat(model, name).size
    except AttributeError:
        size = -1
    index = varying.index
    shape = varying.values.shape
    fits = index.dtype.kind == "i" and index.ndim == 1 and shape == (count, index.size)
    if size < 0 or not fits or (index.size and not 0 <= int(index.min()) <= int(index.max()) < size):
        message = f"the worlds of `{shown}` are not of its model: `{name}` has no such numbers in this MuJoCo"
        raise failure("bundle-changed", message, "build it again with the MuJoCo that runs here")
