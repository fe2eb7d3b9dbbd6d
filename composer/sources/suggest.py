"""Suggest existing model files for one that does not exist."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePath, PureWindowsPath

from composer.diagnostics.suggest import closest, exists_note
from composer.reading.foreign import foreign_format
from composer.sources.error import SourceError
from composer.sources.source import has_format

_DEPTH = 3
_ENTRIES = 2000


def model_files(folder: Path, depth: int = _DEPTH) -> list[str]:
    """Return the model files in `folder` and up to `depth` levels below, as relative paths, the nearest first.

    Hidden files are left out, and the search ends after 2000 entries. Empty if the folder does not exist.
    """
    found: list[str] = []
    seen = 0
    level = [""]
    for _ in range(depth + 1):
        below: list[str] = []
        for inner in level:
            try:
                entries = sorted(os.scandir(folder / inner), key=lambda entry: entry.name)
            except OSError:
                continue
            for entry in entries:
                seen += 1
                if seen > _ENTRIES:
                    return found
                relative = f"{inner}/{entry.name}" if inner else entry.name
                if entry.name.startswith("."):
                    continue
                if entry.is_dir(follow_symlinks=False):
                    if not entry.name.startswith("__"):
                        below.append(relative)
                elif has_format(PurePath(entry.name)):
                    found.append(relative)
        level = below
    return found


def not_found(text: str, wanted: Path, existing: Iterable[str], *, hint: str | None = None) -> SourceError:
    """Return the error for a reference whose file does not exist; `existing` are references to existing files."""
    suffix = PurePath(text).suffix.lower()
    # Files with the same suffix first: recipes are no use to somebody who looks for an XML file.
    known = sorted(existing, key=lambda each: PurePath(each).suffix.lower() != suffix)
    near = nearest(text, known)
    shown = [near, *(each for each in known if each != near)] if near else known
    message = f"the model `{text}` does not exist"
    note = exists_note("model file", shown).message
    if "\\" in text:
        hint, near = _with_slashes(text, near), None
    elif not os.path.isdir(wanted.parent):  # `Path.is_dir` raises for a path that is too long
        message, note, corrected = _without_folder(text, wanted)
        near = corrected or near
    return SourceError(
        "source-not-found",
        message,
        notes=(f"looked for `{wanted}`", note),
        help=f"write `{near}`" if near else hint,
    )


def _with_slashes(text: str, near: str | None) -> str:
    """Return what to write instead of a path with backslashes, which are part of a name outside of Windows."""
    if near is None and PureWindowsPath(text).drive:
        return "paths are written with `/` and are best relative to the recipe: `./models/arm.xml`"
    return f"paths are written with `/`: write `{near or text.replace(chr(92), '/')}`"


def _without_folder(text: str, wanted: Path) -> tuple[str, str, str | None]:
    """For a file in a missing folder, return the message, the existing folders, and the path with the nearest."""
    missing = next(
        each
        for each in (wanted.parent, *wanted.parent.parents)
        if os.path.isdir(each.parent) or each == each.parent
    )
    depth = len(wanted.parts) - len(missing.parts)
    written = text.removesuffix("".join(f"/{part}" for part in wanted.parts[-depth:]))
    try:
        folders = sorted(
            each.name for each in os.scandir(missing.parent) if each.is_dir() and each.name[0] != "."
        )
    except OSError:
        folders = []
    near = closest(missing.name, folders)
    inside = written.removesuffix(missing.name)
    message = f"the model `{text}` does not exist, nor does the folder `{written}`"
    listed = sorted(folders, key=lambda each: each not in near)
    note = (
        exists_note("folder", [f"{inside}{each}" for each in listed]).message
        if listed
        else f"`{missing.parent}` contains no folders"
    )
    corrected = missing.with_name(near[0]).joinpath(*wanted.parts[-depth:]) if near else None
    exists = corrected is not None and os.path.isfile(corrected)
    return message, note, f"{inside}{near[0]}{text.removeprefix(written)}" if exists else None


def nearest(text: str, existing: Iterable[str]) -> str | None:
    """Return the existing reference that was probably meant."""
    # Otherwise a dot would count as the end of a prefix, and all `.xml` files as one name with different prefixes.
    flat = {each.removeprefix("./").replace(".", "_"): each for each in existing}
    near = closest(text.replace("\\", "/").removeprefix("./").replace(".", "_"), flat)
    return flat[near[0]] if near else None


def without_suffix(text: str, existing: Iterable[str]) -> SourceError:
    """Return the error for a reference whose suffix is missing or unknown."""
    known = list(existing)
    suffix = PurePath(text.rpartition("#")[2]).suffix
    same = [each for each in known if os.path.splitext(each)[0].removeprefix("./") == text.removeprefix("./")]
    same = same or [each for each in known if PurePath(each).stem == text]
    near = same[0] if same else nearest(text, known)
    if (foreign := foreign_format(PurePath(text))) is not None:
        stem = text.removesuffix(suffix)
        beside = next((each for each in known if os.path.splitext(each)[0] == stem), None)
        help = f"write `{beside}`" if beside else foreign.help(text)
        return SourceError("source-kind", foreign.message(text), help=help)
    if suffix.lower() in (".zip", ".mjz", ".mjb"):
        problem, fix = (
            "is a bundle, which cannot be a part",
            "refer to the recipe or the XML that it was built from",
        )
    else:
        problem = f"ends in `{suffix}`, which is not a model file" if suffix else "has no file suffix"
        fix = "end it in `.yaml` for a recipe, `.xml` for MJCF, `.urdf` for URDF, or write `menagerie:ROBOT`"
    return SourceError(
        "source-kind",
        f"the model reference `{text}` {problem}",
        notes=(exists_note("model file", known).message,) if known else (),
        help=f"write `{near}`" if near else fix,
    )
