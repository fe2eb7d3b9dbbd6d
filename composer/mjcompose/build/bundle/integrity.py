"""Compare a bundle with its manifest: its files, and the index of the compiled model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.bundle import MANIFEST, Bundle
from mjcompose.build.bundle.manifest import FORMAT, Index, Manifest, faults_of, from_json, newer_format

_SHOWN = 8
_HOW_WRITTEN = {"origin", "type"}
_KINDS = tuple(Index.model_fields)


def manifest_of(text: bytes | None, shown: str, sink: Sink) -> Manifest | None:
    """Return the manifest of a bundle, or None if it is missing or broken, which is reported."""
    if text is None:
        sink.error("bundle-manifest", f"`{shown}` has no `{MANIFEST}`: there is nothing to hold it against")
        return None
    try:
        return from_json(text)
    except ValueError as error:
        newer = newer_format(error)
        if newer is not None:
            sink.error(
                "bundle-manifest",
                f"the manifest of `{shown}` was written by a newer mjcompose: its format is {newer},"
                f" this one knows {FORMAT}",
                help="update mjcompose",
            )
            return None
        faults = faults_of(error)
        more = [Note(f"and {len(faults) - _SHOWN} more")] if len(faults) > _SHOWN else []
        sink.error(
            "bundle-manifest",
            f"the manifest of `{shown}` cannot be read",
            notes=[*map(Note, faults[:_SHOWN]), *more],
            help="a bundle of another version of mjcompose needs that version",
        )
        return None


def check_files(bundle: Bundle, manifest: Manifest, shown: str, sink: Sink) -> None:
    """Report files that are missing, changed, or not listed."""
    listed = {file.path: file for file in manifest.files}
    for path, file in listed.items():
        if path not in bundle.files:
            sink.error("bundle-changed", f"`{path}` is not in `{shown}`, and its manifest lists it")
        elif bundle.digest(path) != file.sha256:
            sink.error(
                "bundle-changed",
                f"`{path}` in `{shown}` is not the file that its manifest lists",
                notes=[
                    Note(f"expected sha256 {file.sha256}, {file.size} bytes"),
                    Note(f"found sha256 {bundle.digest(path)}, {len(bundle.files[path])} bytes"),
                ],
            )
    for path in bundle.files:
        if path != MANIFEST and path not in listed:
            sink.error("bundle-changed", f"`{path}` is in `{shown}`, and its manifest does not list it")


def check_index(expected: Index, actual: Index, shown: str, sink: Sink) -> None:
    """Report where the compiled model has another order, other addresses or other limits than its manifest."""
    for kind in _KINDS:
        said, found = (_plain(kind, getattr(index, kind)) for index in (expected, actual))
        if said == found:
            continue
        sink.error(
            "bundle-manifest",
            f"the {kind} of the compiled `{shown}` are not those of its manifest",
            notes=[
                Note(f"{kind} {number}: expected {a or 'nothing'}, found {b or 'nothing'}")
                for number, (a, b) in enumerate(_both(said, found))
                if a != b
            ][:_SHOWN],
        )


def _plain(kind: str, entries: Sequence[Any]) -> list[str]:
    """Return entries as text, without their origin and type of writing."""
    return [each.model_dump_json(exclude=_HOW_WRITTEN if kind == "actuators" else {"origin"}) for each in entries]


def _both(first: Sequence[str], second: Sequence[str]) -> Iterator[tuple[str | None, str | None]]:
    for number in range(max(len(first), len(second))):
        yield (first[number] if number < len(first) else None, second[number] if number < len(second) else None)
