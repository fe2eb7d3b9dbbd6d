"""Find the model file in a fetched source."""

from __future__ import annotations

import os
from pathlib import PurePosixPath

from composer.diagnostics.suggest import exists_note
from composer.sources import licence
from composer.sources import suggest as nearby
from composer.sources.error import SourceError
from composer.sources.fetching import Fetching
from composer.sources.origin import Origin
from composer.sources.reference import Reference
from composer.sources.source import Source, has_format


def source_in(origin: Origin, reference: Reference) -> Source:
    """Return the file that a reference names in `origin`. Raises SourceError."""
    inside = PurePosixPath(reference.path)
    if inside.is_absolute() or ".." in inside.parts or "\\" in reference.path:
        raise SourceError(
            "source-kind", f"the model reference `{reference.text}` leaves what it was fetched with"
        )
    existing = [origin.named(each) for each in nearby.model_files(origin.root, depth=6)]
    for left_out, why in origin.without:
        if inside.is_relative_to(left_out):
            raise SourceError(
                "source-not-found",
                f"the model `{reference.text}` does not exist: `{left_out}` is {why}",
                notes=(exists_note("model file", existing, reference.text).message,),
            )
    if not has_format(inside):
        raise nearby.without_suffix(reference.text, existing)
    path = origin.root / inside
    if not os.path.isfile(path):
        raise nearby.not_found(reference.text, path, existing)
    return Source(
        path,
        reference.kind,
        reference.text,
        version=origin.pin,
        licences=licence.find(path, origin.root),
        origin=origin,
    )


def unlocked(reference: Reference, fetching: Fetching) -> SourceError:
    """Return the error for a source that is not in the lock when only locked sources are allowed."""
    return SourceError(
        "lock-stale",
        f"`{reference.text}` is not in the lock",
        help=f"run `mjcompose lock {fetching.recipe}` and commit the lock",
    )


def not_at_hand(reference: Reference, where: str = "the store") -> SourceError:
    """Return the error for a source that is missing in `where` when nothing may be fetched."""
    return SourceError(
        "source-offline",
        f"`{reference.text}` is not in {where}, and nothing is fetched offline",
        help="run it once without `--offline` or `--frozen`",
    )
