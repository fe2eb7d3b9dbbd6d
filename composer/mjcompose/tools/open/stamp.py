"""The record of a model in a data set, and rebuilding the model from that record."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal

import pydantic
from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

from mjcompose.base import __version__
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.extensions import is_registered
from mjcompose.base.files import read_regular
from mjcompose.base.report import MjcomposeError, short_traceback
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import exists_note
from mjcompose.bundle.bundle import MANIFEST, WORLDS, Bundle, path_of_bundle
from mjcompose.bundle.manifest import FileName, Manifest, Name, Sha256, from_json, in_words
from mjcompose.bundle.read import ReadError, read
from mjcompose.language.target_names import NAMES
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.text.node import locate
from mjcompose.tools.open.recipe import as_yaml, nodes_of


def _known_target(name: str) -> str:
    if name not in NAMES and not is_registered("targets", name):
        raise PydanticCustomError("target", "the target `{name}` does not exist", {"name": name})
    return name


def _parameter(value: Any) -> Any:
    items = value if isinstance(value, list | tuple) else [value]
    if not all(each is None or isinstance(each, bool | int | float | str) for each in items):
        raise PydanticCustomError("value", "a parameter is a number, a text, a boolean or a list of them")
    if not all(math.isfinite(each) for each in items if isinstance(each, float)):
        raise PydanticCustomError("value", "a parameter is a finite number")
    return value


_Value = Annotated[Any, AfterValidator(_parameter)]


class Stamp(BaseModel):
    """The record of a bundle. `read` has the sha256 of every file that the model was made from.

    A stamp may come from anyone, so each field has a form, and no field is a path.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    stamp: Literal[1] = 1
    name: Name
    bundle: Sha256
    recipe: FileName
    cell: Name | None = None
    sample: int = Field(0, ge=0)
    variants: dict[Name, str] = {}
    params: dict[Name, _Value] = {}
    target: Annotated[str, AfterValidator(_known_target)] | None = None
    deduplicated: bool = False
    pictured: bool = False
    worlds: bool = False
    mjcompose: Name
    mujoco: Name | None = None
    read: dict[str, Sha256] = {}


@short_traceback
def stamp(bundle: str | PathLike[str]) -> dict[str, Any]:
    """Return the record of a model for a data set, as data for JSON.

        record = mjcompose.stamp("build/cell.zip")
        json.dump(record, open("episodes/model.json", "w"))

    `mjcompose rebuild episodes/model.json` builds the same bytes again, or says what differs.

    Raises MjcomposeError if the bundle cannot be read, or no recipe made it.
    """
    shown = path_of_bundle(bundle)
    try:
        files = read(Path(bundle))
        manifest = from_json(files.files[MANIFEST])
    except ReadError as error:
        raise MjcomposeError([error.diagnostic]) from None
    except (KeyError, ValueError):
        raise _error("bundle-manifest", f"`{shown}` has no manifest of mjcompose") from None
    if manifest.recipe is None or manifest.union is not None:
        raise _error("bundle-manifest", f"no single recipe made `{shown}`")
    try:
        return _stamp(files, manifest).model_dump()
    except pydantic.ValidationError as error:
        fault = in_words(error.errors(include_url=False)[0], "a stamp")
        raise _error("bundle-manifest", f"the manifest of `{shown}` gives no stamp: {fault}") from None


def _stamp(bundle: Bundle, manifest: Manifest) -> Stamp:
    assert manifest.recipe is not None
    drawn = {each.attribute for each in manifest.draws if each.element is None}  # the recipe draws them again
    return Stamp(
        name=manifest.name,
        bundle=bundle.sha256,
        recipe=manifest.recipe.path,
        cell=manifest.cell,
        sample=manifest.sample or 0,
        variants={name: value for name, value in manifest.variants.items() if name not in drawn},
        params={name: value for name, value in manifest.params.items() if name not in drawn},
        target=None if manifest.target is None else manifest.target.name,
        deduplicated=manifest.deduplicated,
        pictured=manifest.picture is not None,
        worlds=WORLDS in bundle.files,
        mjcompose=manifest.mjcompose,
        mujoco=manifest.mujoco,
        read={manifest.recipe.path: manifest.recipe.sha256, **{each.path: each.sha256 for each in manifest.read}},
    )


def read_stamp(file: Path, shown: str) -> Stamp:
    """Read the file of a stamp, `shown` in messages. Raises MjcomposeError."""
    try:
        text = read_regular(file, 16 << 20)
    except OSError as error:
        raise _error("file-unreadable", f"cannot read `{shown}`: {(error.strerror or str(error)).lower()}") from None
    try:
        return Stamp.model_validate_json(text)
    except pydantic.ValidationError as error:
        raise MjcomposeError([_fault(error, text, shown)]) from None


def _fault(error: pydantic.ValidationError, text: bytes, shown: str) -> Diagnostic:
    """Return the first fault of a stamp with its place."""
    first = error.errors(include_url=False)[0]
    path = tuple(step for step in first["loc"] if not (isinstance(step, str) and step.endswith("]")))
    node = load(text, shown, Sink())
    is_key = first["type"] == "extra_forbidden" or path[-1:] == ("[key]",)
    span = Span(shown, 1, 1) if node is None else locate(node, path, key=is_key)
    message = f"`{shown}` is not a stamp of mjcompose: {in_words(first, 'a stamp')}"
    notes = [exists_note("target", NAMES)] if first["type"] == "target" else ()
    help = "write it again: `json.dump(mjcompose.stamp(BUNDLE), file)`"
    return Diagnostic("bundle-manifest", message, span, notes=tuple(notes), help=help)


def rebuild(record: Stamp, recipe: Path, context: Context) -> Bundle | None:
    """Build the model of a stamp again. None after an error, even if only its bytes would differ."""
    sink = context.sink
    given = nodes_of(as_yaml({**record.params, **record.variants}), context)
    request = ModelRequest(recipe, given, name=record.cell, sample=record.sample, verified=record.mujoco is not None)
    options = {name: getattr(record, name) for name in ("target", "deduplicated", "pictured", "worlds")}
    built = None if sink.has_errors else build(replace(request, **options), context)
    if built is None:
        return None
    if built.bundle.sha256 == record.bundle:
        made = from_json(built.bundle.files[MANIFEST]).name
        if made == record.name:
            return built.bundle
        help = f"write the name of the model, `{made}`, into the stamp"
        sink.error("bundle-changed", f"the stamp is of `{record.name}`, and its recipe builds `{made}`", help=help)
        return None
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
