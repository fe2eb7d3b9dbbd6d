"""Model references that are paths, relative to the file that holds them."""

from __future__ import annotations

import os
from pathlib import Path, PurePath

from composer.diagnostics.suggest import exists_note
from composer.sources import licence
from composer.sources import suggest as nearby
from composer.sources.error import SourceError
from composer.sources.reference import Reference
from composer.sources.source import Source, has_format


def resolve(reference: Reference, relative_to: Path) -> Source:
    """The file at a path; a relative one starts at the folder `relative_to`. Raises SourceError."""
    wanted = relative_to / reference.path
    if os.path.isdir(wanted):
        raise _is_folder(reference.text, wanted)
    if not has_format(wanted):
        raise nearby.without_suffix(reference.text, _existing(reference.path, wanted, relative_to))
    if not os.path.isfile(wanted):
        if os.path.exists(wanted):
            raise SourceError(
                "source-kind",
                f"the model reference `{reference.text}` is neither a file nor a folder",
                help="name a model file",
            )
        hint = "`~` is not expanded: write the whole path" if reference.path.startswith("~") else None
        if reference.path.startswith("menagerie/"):
            hint = f"write `menagerie:{PurePath(reference.path).relative_to('menagerie').with_suffix('')}`"
        raise nearby.not_found(
            reference.text, wanted, _existing(reference.path, wanted, relative_to), hint=hint
        )
    return Source(wanted, reference.kind, reference.text, licences=licence.find(wanted))


def _existing(written: str, wanted: Path, relative_to: Path) -> list[str]:
    """References to the model files beside the wanted one, then to those below the folder of the recipe."""
    folder = PurePath(written).parent.as_posix()
    start = "./" if folder == "." else f"{folder}/" if folder.startswith((".", "/", "~")) else f"./{folder}/"
    beside = [start + each for each in nearby.model_files(wanted.parent, depth=0)]
    below = [f"./{each}" for each in nearby.model_files(relative_to)]
    return list(dict.fromkeys(beside + below))


def _is_folder(text: str, folder: Path) -> SourceError:
    inside = [f"{text.rstrip('/')}/{each}" for each in nearby.model_files(folder)]
    return SourceError(
        "source-kind",
        f"the model reference `{text}` is a folder, not a model file",
        notes=(exists_note("model file", inside).message,),
        help=f"write `{inside[0]}`" if len(inside) == 1 else "name a model file in it",
    )
