"""A bundle that was written before, by anyone: whether it still is what its manifest says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.manifest import Index, Manifest, Part, from_json, index_of
from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, read
from composer.context import Context
from composer.diagnostics.diagnostic import Note
from composer.plan.member import Member
from composer.pose import Pose
from composer.sources.source import Source
from composer.verify.compiles import Verified, verify
from composer.verify.inputs import Inputs
from composer.verify.parts import WHOLE, Compared, Judge
from composer.verify.report import changed, notes

if TYPE_CHECKING:
    from composer.engine import Compiled, Session

_SHOWN = 8


@dataclass(frozen=True, slots=True)
class Stored:
    """A bundle that was opened, what MuJoCo made of it, and its parts in the order of the manifest."""

    bundle: Bundle
    manifest: Manifest | None
    compiled: Compiled | None
    parts: tuple[Compared, ...]


def verify_stored(
    path: Path, context: Context, session: Session, recipe: Path | None = None
) -> Stored | None:
    """Check a bundle in a folder, a zip or an MJZ; what is wrong goes to the sink. None if it cannot be read.

    Files are held against the hashes of the manifest, the compiled model against its index, and each part
    against its source, where that can be found with the hash that the manifest has: through `recipe`, or
    from the folder of the context. A part without a source is a warning, and with `recipe` an error.
    """
    try:
        bundle = read(context.folder / path)
    except ReadError as error:
        context.sink.error(error.code, error.message)
        return None
    shown = context.shown(path)
    manifest = _manifest(bundle, shown, context)
    if manifest is not None:
        _files(bundle, manifest, shown, context)
    compiled = _compiled(bundle, shown, context, session)
    if manifest is None or compiled is None:
        return Stored(bundle, manifest, compiled, ())
    _index(manifest, compiled, shown, context)
    inputs = Inputs(manifest, recipe, context)
    parts = tuple(_parts(manifest, inputs, Judge(session, manifest.merged)))
    for compared in parts:
        _tell(compared, manifest, inputs, context)
    if manifest.inputs and not parts:
        context.sink.warning(
            "part-not-compared",
            f"the manifest of `{shown}` does not say where its parts hang: none was compared with its source",
            help="build it again with this version",
        )
    return Stored(bundle, manifest, compiled, parts)


def _manifest(bundle: Bundle, shown: str, context: Context) -> Manifest | None:
    if MANIFEST not in bundle.files:
        context.sink.error(
            "bundle-manifest", f"`{shown}` has no `{MANIFEST}`: there is nothing to hold it against"
        )
        return None
    try:
        return from_json(bundle.files[MANIFEST])
    except ValueError as error:
        said = str(error).splitlines()
        context.sink.error(
            "bundle-manifest",
            f"the manifest of `{shown}` cannot be read",
            notes=[Note(" ".join(line.split())) for line in said[:_SHOWN]],
            help="a bundle of a newer mjcompose needs that version",
        )
        return None


def _files(bundle: Bundle, manifest: Manifest, shown: str, context: Context) -> None:
    listed = {file.path: file for file in manifest.files}
    for path, file in listed.items():
        if path not in bundle.files:
            context.sink.error("bundle-changed", f"`{path}` is not in `{shown}`, and its manifest lists it")
        elif bundle.digest(path) != file.sha256:
            context.sink.error(
                "bundle-changed",
                f"`{path}` in `{shown}` is not the file that its manifest lists",
                notes=[
                    Note(f"expected sha256 {file.sha256}, {file.size} bytes"),
                    Note(f"found sha256 {bundle.digest(path)}, {len(bundle.files[path])} bytes"),
                ],
            )
    for path in bundle.files:
        if path != MANIFEST and path not in listed:
            context.sink.error(
                "bundle-changed", f"`{path}` is in `{shown}`, and its manifest does not list it"
            )


def _compiled(bundle: Bundle, shown: str, context: Context, session: Session) -> Compiled | None:
    try:
        verified: Verified = verify(bundle, session=session, keep=WHOLE)
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
        return None
    for warning in verified.warnings:
        said = " ".join(warning.message.split())
        context.sink.warning("mujoco-warning", f"MuJoCo warns about `{shown}`: {said}")
    if verified.error is None or verified.code is None:
        return verified.compiled
    fault = verified.error
    line = "" if fault.line is None else f", line {fault.line} of `{bundle.model}`"
    what = f" ({fault.element or 'element'} `{fault.name}`{line})" if fault.name else line
    message = f"`{shown}` does not compile: {' '.join(fault.message.split())}{what}"
    context.sink.error(verified.code, message)
    return None


def _index(manifest: Manifest, compiled: Compiled, shown: str, context: Context) -> None:
    """The order of joints, actuators, sensors and keys, and their addresses."""
    if manifest.index is None or compiled.index is None:
        return
    actual = index_of(compiled.index)
    for kind in Index.model_fields:
        expected, found = (_plain(kind, getattr(index, kind)) for index in (manifest.index, actual))
        if expected == found:
            continue
        context.sink.error(
            "bundle-manifest",
            f"the {kind} of the compiled `{shown}` are not those of its manifest",
            notes=[
                Note(f"{kind} {number}: expected {a or 'nothing'}, found {b or 'nothing'}")
                for number, (a, b) in enumerate(_both(expected, found))
                if a != b
            ][:_SHOWN],
        )


def _plain(kind: str, entries: Sequence[BaseModel]) -> list[str]:
    """Entries as text, without how and where they are written."""
    return [
        each.model_dump_json(exclude={"origin"} if kind != "actuators" else {"origin", "type"})
        for each in entries
    ]


def _both(first: Sequence[str], second: Sequence[str]) -> Iterator[tuple[str | None, str | None]]:
    for number in range(max(len(first), len(second))):
        yield (
            first[number] if number < len(first) else None,
            second[number] if number < len(second) else None,
        )


def _parts(manifest: Manifest, inputs: Inputs, judge: Judge) -> Iterator[Compared]:
    for part in manifest.parts:
        found = inputs.find(part.input)
        if isinstance(found, str):
            nowhere = Source(Path(), "path", "")
            yield Compared(_member(part, nowhere), obscure=part.obscure or found)
        else:
            yield judge.compare(_member(part, found), part.changed)


def _member(part: Part, source: Source) -> Member:
    pose = None if part.pos is None or part.quat is None else Pose(part.pos, part.quat)
    return Member(
        part.part, part.prefix, source, part.body, pose, part.keys, part.welded, part.stands, part.changed,
        part.obscure,
    )  # fmt: skip


def _tell(compared: Compared, manifest: Manifest, inputs: Inputs, context: Context) -> None:
    member = compared.member
    if compared.obscure is None:
        if compared.differences:
            context.sink.error("part-changed", changed(compared), notes=notes(compared.differences))
        return
    message = f"`{member.called}` is not compared with its source: {compared.obscure}"
    if member.obscure is not None:
        context.sink.warning("part-not-compared", message)
    elif inputs.given:
        context.sink.error("part-not-compared", message)
    else:
        name = manifest.recipe.path if manifest.recipe else "the recipe"
        help = f"say where the recipe is: `--recipe path/to/{name}`"
        context.sink.warning("part-not-compared", message, help=help)
