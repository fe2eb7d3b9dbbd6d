"""The record of a model in a data set, and rebuilding the model from that record."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import pydantic
from pydantic import BaseModel, ConfigDict

from mjcompose.base import __version__
from mjcompose.base.diagnostic import Diagnostic, Note
from mjcompose.base.files import read_regular
from mjcompose.base.report import MjcomposeError, short_traceback
from mjcompose.build.bundle.bundle import MANIFEST, WORLDS, Bundle
from mjcompose.build.bundle.manifest import Manifest, from_json
from mjcompose.build.bundle.read import ReadError, read
from mjcompose.build.stages import Request, build
from mjcompose.sources.context import Context
from mjcompose.tools.open.recipe import as_json, nodes_of


class Stamp(BaseModel):
    """The record of a bundle. `read` has the sha256 of every file that the model was made from."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    stamp: Literal[1] = 1
    name: str
    bundle: str
    recipe: str
    cell: str | None = None
    sample: int = 0
    variants: dict[str, str] = {}
    params: dict[str, Any] = {}
    target: str | None = None
    deduplicated: bool = False
    pictured: bool = False
    worlds: bool = False
    mjcompose: str
    mujoco: str | None = None
    read: dict[str, str] = {}


@short_traceback
def stamp(bundle: str | PathLike[str]) -> dict[str, Any]:
    """Return the record of a model for a data set, as data for JSON.

        record = mjcompose.stamp("build/cell.zip")
        json.dump(record, open("episodes/model.json", "w"))

    `mjcompose rebuild episodes/model.json` builds the same bytes again, or says what differs.

    Raises MjcomposeError if the bundle cannot be read, or no recipe made it.
    """
    try:
        files = read(Path(bundle))
        manifest = from_json(files.files[MANIFEST])
    except ReadError as error:
        raise MjcomposeError([error.diagnostic]) from None
    except (KeyError, ValueError):
        raise _error("bundle-manifest", f"`{os.fspath(bundle)}` has no manifest of mjcompose") from None
    if manifest.recipe is None or manifest.union is not None:
        raise _error("bundle-manifest", f"no single recipe made `{os.fspath(bundle)}`")
    return _stamp(files, manifest).model_dump()


def _stamp(bundle: Bundle, manifest: Manifest) -> Stamp:
    assert manifest.recipe is not None
    drawn = {each.attribute for each in manifest.draws if each.element is None}  # the recipe draws them again
    return Stamp(
        name=manifest.name, bundle=bundle.sha256, recipe=manifest.recipe.path, cell=manifest.cell,
        sample=manifest.sample or 0,
        variants={name: value for name, value in manifest.variants.items() if name not in drawn},
        params={name: value for name, value in manifest.params.items() if name not in drawn},
        target=None if manifest.target is None else manifest.target.name, deduplicated=bool(manifest.merged),
        pictured=manifest.picture is not None, worlds=WORLDS in bundle.files,
        mjcompose=manifest.mjcompose, mujoco=manifest.mujoco,
        read={manifest.recipe.path: manifest.recipe.sha256, **{each.path: each.sha256 for each in manifest.read}},
    )  # fmt: skip


def read_stamp(file: Path) -> Stamp:
    """Read the file of a stamp. Raises MjcomposeError."""
    try:
        return Stamp.model_validate_json(read_regular(file, 16 << 20))
    except OSError as error:
        raise _error("file-unreadable", f"cannot read `{file}`: {(error.strerror or str(error)).lower()}") from None
    except pydantic.ValidationError as error:
        place = "/".join(map(str, error.errors()[0]["loc"])) or "the text"
        raise _error("bundle-manifest", f"`{file}` is not a stamp of mjcompose: {place} is wrong") from None


def rebuild(record: Stamp, recipe: Path, context: Context) -> Bundle | None:
    """Build the model of a stamp again. None after an error, even if only its bytes would differ."""
    sink = context.sink
    given = nodes_of(as_json({**record.params, **record.variants}), context)
    request = Request(recipe, given, name=record.cell, sample=record.sample, verified=record.mujoco is not None)
    options = {name: getattr(record, name) for name in ("target", "deduplicated", "pictured", "worlds")}
    built = None if sink.has_errors else build(replace(request, **options), context)
    if built is None or built.bundle.sha256 == record.bundle:
        return None if built is None else built.bundle
    now = _stamp(built.bundle, from_json(built.bundle.files[MANIFEST]))
    notes = tuple(map(Note, _differences(record, now))) or (Note("nothing of the stamp explains it"),)
    message = f"`{record.name}` has other bytes than its stamp records"
    help = "use the files and versions of that time: check out that commit of the recipe"
    sink.add(Diagnostic("bundle-changed", message, notes=notes, help=help))
    return None


def _differences(before: Stamp, now: Stamp) -> Iterator[str]:
    versions = (("mjcompose", before.mjcompose, __version__), ("MuJoCo", before.mujoco, now.mujoco))
    for word, old, new in (*versions, ("the name", before.name, now.name)):
        if old != new:
            yield f"{word} was {old}, and is {new}"
    for path in sorted({*before.read, *now.read}):
        if before.read.get(path) != now.read.get(path):
            change = "is new" if path not in before.read else "is not used" if path not in now.read else "changed"
            yield f"`{path}` {change}"


def _error(code: str, message: str) -> MjcomposeError:
    return MjcomposeError([Diagnostic(code, message)])
