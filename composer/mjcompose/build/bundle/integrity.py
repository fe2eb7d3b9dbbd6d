"""Compare a bundle with its manifest: its files, and the index of the compiled model."""

from __future__ import annotations

from itertools import zip_longest

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.bundle import MANIFEST, Bundle
from mjcompose.build.bundle.manifest import FORMAT, Index, Manifest, faults_of, from_json, newer_format

_SHOWN = 8


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
            written = f"was written by a newer mjcompose: its format is {newer}, this one knows {FORMAT}"
            sink.error("bundle-manifest", f"the manifest of `{shown}` {written}", help="update mjcompose")
            return None
        faults = faults_of(error)
        more = [Note(f"and {len(faults) - _SHOWN} more")] if len(faults) > _SHOWN else []
        help = "a bundle of another version of mjcompose needs that version"
        notes = [*map(Note, faults[:_SHOWN]), *more]
        sink.error("bundle-manifest", f"the manifest of `{shown}` cannot be read", notes=notes, help=help)
        return None


def check_files(bundle: Bundle, manifest: Manifest, shown: str, sink: Sink) -> None:
    """Report files that are missing, changed, or not listed."""
    listed = {file.path: file for file in manifest.files}
    for path, file in listed.items():
        if path not in bundle.files:
            sink.error("bundle-changed", f"`{path}` is not in `{shown}`, and its manifest lists it")
        elif bundle.digest(path) != file.sha256:
            expected = Note(f"expected sha256 {file.sha256}, {file.size} bytes")
            found = Note(f"found sha256 {bundle.digest(path)}, {len(bundle.files[path])} bytes")
            message = f"`{path}` in `{shown}` is not the file that its manifest lists"
            sink.error("bundle-changed", message, notes=[expected, found])
    for path in bundle.files:
        if path != MANIFEST and path not in listed:
            sink.error("bundle-changed", f"`{path}` is in `{shown}`, and its manifest does not list it")


def check_index(expected: Index, actual: Index, shown: str, sink: Sink) -> None:
    """Report where the compiled model has another order, other addresses or other limits than its manifest."""
    for kind in Index.model_fields:
        how_written = {"origin", "type"} if kind == "actuators" else {"origin"}
        said, found = (
            [each.model_dump_json(exclude=how_written) for each in getattr(index, kind)] for index in (expected, actual)
        )
        notes = [
            Note(f"{kind} {number}: expected {a}, found {b}")
            for number, (a, b) in enumerate(zip_longest(said, found, fillvalue="nothing"))
            if a != b
        ]
        if notes:
            message = f"the {kind} of the compiled `{shown}` are not the {kind} of its manifest"
            sink.error("bundle-manifest", message, notes=notes[:_SHOWN])
