"""A model from the cache or a new build, ready to be written."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer.dataclass import dataclass
from composer.tree.adopted import Adopted

if TYPE_CHECKING:
    from composer.bundle.bundle import Bundle
    from composer.bundle.licence_table import Row
    from composer.bundle.packing import Packed
    from composer.cache.cache import Cache
    from composer.cache.cache_key import CacheKey
    from composer.cache.entry import Record
    from composer.context import Context
    from composer.diagnostics.span import Span
    from composer.expr.value import Value
    from composer.link.linking import FileUse
    from composer.plan.plan import Plan
    from composer.stages import Built
    from composer.tree.unit import Unit


@dataclass(frozen=True, slots=True)
class Made:
    """A built model.

    `built` is set for a model that was built now, `record` for one from the cache. A model from the cache has only
    what the form of its output needs: `packed` for archives, `text` for text, `bundle` for folders and MuJoCo's
    binary form, and nothing if the output `is_written` already. `inputs` are its input files. `why` says why the
    cache did not have it. `replaced` is what the previous output was made from, as far as that differs. `allowed`
    are the codes of warnings that the recipe allows at its top. `draws` are the numbers drawn for a sample, by
    table column; None if it is not a sample. `cells` and `cells_at` are as in a plan, `adopted` are the settings
    that the model takes from its parts. `excluded` is how many pairs of bodies the recipe's `exclude: auto` or
    `touching` keeps from colliding.
    """

    name: str
    sha256: str
    sizes: Mapping[str, int] | None
    merged: Mapping[str, Mapping[str, str]]
    built: Built | None = None
    record: Record | None = None
    bundle: Bundle | None = None
    packed: Mapping[str, Packed] = field(default_factory=dict)
    text: bytes | None = None
    is_written: bool = False
    why: tuple[str, ...] = ()
    mujoco: str | None = None
    licences: tuple[Row, ...] = ()
    key: CacheKey | None = None
    inputs: tuple[str, ...] = ()
    draws: Mapping[str, Value] | None = None
    cells: int = 0
    cells_at: Span | None = None
    replaced: Mapping[str, Any] = field(default_factory=dict)
    adopted: tuple[Adopted, ...] = ()
    allowed: tuple[str, ...] = ()
    excluded: int = 0
    is_new: bool = False

    def summary(self) -> Made:
        """Return the model without the data for writing it, small enough to pickle."""
        return replace(self, built=None, record=None, bundle=None, packed={}, text=None, key=None, inputs=())


def fresh(built: Built, licences: Iterable[Row], why: tuple[str, ...], key: CacheKey | None) -> Made:
    """Return a model that was built now."""
    from composer.plan.allowed import allowed_everywhere

    sizes = built.compiled.sizes if built.compiled else None
    mujoco = built.compiled.mujoco_version if built.compiled else None
    adopted = tuple(each.located() for each in built.composed.model.adopted)
    return Made(
        built.plan.name, built.bundle.sha256, sizes, merged=built.merged, built=built, bundle=built.bundle, why=why,
        mujoco=mujoco, licences=tuple(licences), key=key, draws=_draws(built),
        cells=built.plan.cells, cells_at=built.plan.cells_at, adopted=adopted,
        allowed=allowed_everywhere(built.plan), excluded=len(built.composed.excluded), is_new=True,
    )  # fmt: skip


def _draws(built: Built) -> dict[str, Value] | None:
    wanted = built.plan.randomize
    if wanted is None or wanted.at_run_time:
        return None
    return dict(column for each in built.composed.drawn for column in each.columns())


def recalled(record: Record, inputs: tuple[str, ...]) -> Made:
    """Return a model from the cache, without its files."""
    return Made(record.name, record.sha256, record.sizes, merged=record.merged, record=record, inputs=inputs,
                mujoco=record.mujoco, licences=record.licences, draws=record.draws,
                cells=record.cells, cells_at=record.cells_at, adopted=record.adopted,
                allowed=record.allowed, excluded=record.excluded)  # fmt: skip


def files_of(made: Made | None, context: Context) -> set[str]:
    """Return the input files of a model, as messages name them."""
    read = () if made is None else set(inputs_of(made))
    return {context.shown(path) for path in read if os.path.isfile(context.folder / path)}


def inputs_of(made: Made) -> Iterator[Path]:
    """Yield the files that a model is made from."""
    if made.built is None:
        yield from map(Path, made.inputs)
        return
    built = made.built
    yield from files_read(built.plan, built.composed.model, built.composed.files)


def files_read(plan: Plan, model: Unit, uses: Iterable[FileUse]) -> Iterator[Path]:
    """Yield the recipes, models and assets that a model is made from."""
    yield from (each.path for each in plan.plans())
    yield from (source.path for source in plan.sources())
    yield from (text.path for text in model.origins.texts.values() if text.path is not None)
    yield from (Path(use.source) for use in uses if use.content is None)


def load_files(record: Record, cache: Cache) -> dict[str, bytes] | None:
    """Return the files of a bundle, or None if one of them is lost or changed."""
    found = {file.path: cache.raw(file) for file in record.files}
    whole = {path: content for path, content in found.items() if content is not None}
    return whole if len(whole) == len(found) else None


def load_packed(record: Record, cache: Cache) -> dict[str, Packed] | None:
    """Return the compressed files of a bundle, or None if one of them is lost."""
    from composer.bundle.packing import level_of, pack

    whole: dict[str, Packed] = {}
    for file in record.files:
        level = level_of(file.path)
        packed = cache.packed(file.sha256, level) if level else None
        if packed is None:
            content = cache.raw(file)
            if content is None:
                return None
            packed = pack(content, level)
            if level:
                cache.keep_packed(file.sha256, level, packed)
        whole[file.path] = packed
    return whole
