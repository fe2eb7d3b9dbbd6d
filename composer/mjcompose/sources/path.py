"""Model references that are paths, relative to the file that holds them."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path, PurePath

from mjcompose.base.files import CODE
from mjcompose.base.suggest import exists_note
from mjcompose.sources import fetching as nearby
from mjcompose.sources import license
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.reference import Form, Reference, Source, SourceError, SourceKind, has_format, never, no_host


def _parse(text: str) -> Reference:
    return Reference(text, KIND, "", path=text)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    fetching = lookup.fetching
    if (left_out := _left_out(reference, lookup.folder, fetching)) is not None:
        raise left_out
    door, wanted = fetching.door_of_text(lookup.folder), os.path.join(lookup.folder, reference.path)
    if not door.sees(wanted):  # before any message lists existing files
        refused = door.outside(wanted)
        raise SourceError(CODE, refused.message(), refused.help)
    return _with_origin(_file(reference, lookup.folder), fetching, lookup.folder)


def _file(reference: Reference, relative_to: Path) -> Source:
    wanted = relative_to / reference.path
    if os.path.isdir(wanted):
        raise _is_folder(reference.text, wanted)
    if not has_format(wanted):
        raise nearby.without_suffix(reference.text, _existing(reference.path, wanted, relative_to))
    if not os.path.isfile(wanted):
        if os.path.exists(wanted):
            message = f"the model reference `{reference.text}` is neither a file nor a folder"
            raise SourceError("source-kind", message, help="name a model file")
        hint = "`~` is not expanded: write the whole path" if reference.path.startswith("~") else None
        if reference.path.startswith("menagerie/"):
            hint = f"write `menagerie:{PurePath(reference.path).relative_to('menagerie').with_suffix('')}`"
        raise nearby.not_found(reference.text, wanted, _existing(reference.path, wanted, relative_to), hint=hint)
    return Source(wanted, reference.kind, reference.text, licenses=license.find(wanted))


def _existing(written: str, wanted: Path, relative_to: Path) -> list[str]:
    folder = PurePath(written).parent.as_posix()
    start = "./" if folder == "." else f"{folder}/" if folder.startswith((".", "/", "~")) else f"./{folder}/"
    beside = [start + each for each in nearby.model_files(wanted.parent, depth=0)]
    below = [f"./{each}" for each in nearby.model_files(relative_to)]
    return list(dict.fromkeys(beside + below))


def _is_folder(text: str, folder: Path) -> SourceError:
    inside = [f"{text.rstrip('/')}/{each}" for each in nearby.model_files(folder)]
    message = f"the model reference `{text}` is a folder, not a model file"
    help = f"write `{inside[0]}`" if len(inside) == 1 else "name a model file in it"
    return SourceError("source-kind", message, notes=(exists_note("model file", inside).message,), help=help)


def _left_out(reference: Reference, relative_to: Path, fetching: Fetching) -> SourceError | None:
    origin = fetching.around(relative_to)
    if origin is None:
        return None
    inside = Path(os.path.relpath(os.path.realpath(relative_to / reference.path), os.path.realpath(origin.root)))
    for name, why in origin.without:
        if inside.is_relative_to(name):
            return SourceError(
                "source-not-found", f"the model `{reference.text}` does not exist: `{name}` of `{origin.id}` is {why}"
            )
    return None


def _with_origin(source: Source, fetching: Fetching, folder: Path) -> Source:
    origin = fetching.around(folder)
    if origin is None or fetching.around(source.path) != origin:
        return source
    asked = fetching.first.get(origin.id, source)
    own = license.find(source.path, origin.root)
    of_the_whole = tuple(each for each in asked.licenses if not each.is_relative_to(origin.root))
    return replace(
        source, package=asked.package, version=asked.version, license=asked.license,
        licenses=own or of_the_whole, origin=origin,
    )  # fmt: skip


KIND = SourceKind(
    name="path", forms=(Form("./path/to/model.xml", "a file, relative to the recipe that names it"),),
    local_schemes=(), separator="/", is_local=True, is_fetched=False, runs_code=False, pins=frozenset(),
    variables=(), libraries=(), parse=_parse, resolve=_resolve, host=no_host, is_of_this_machine=never,
)  # fmt: skip
