"""Verify a bundle that was written earlier, by anyone, against its manifest."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.integrity import check_files, check_index, manifest_of
from composer.bundle.manifest import Manifest, Part
from composer.bundle.manifest_index import index_of
from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, read
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Cause
from composer.numerics.pose import Pose
from composer.plan.part_record import PartRecord
from composer.sources.path import KIND as PATH
from composer.sources.source import Source
from composer.verify.compiles import WHOLE, StrangerError, Verified, verify
from composer.verify.inputs import Inputs
from composer.verify.parts import Compared, Judge
from composer.verify.report import changed, notes

if TYPE_CHECKING:
    from composer.engine import Compiled, Session


@dataclass(frozen=True, slots=True)
class Stored:
    """A bundle that was read, its compiled model, and its parts in the order of the manifest."""

    bundle: Bundle
    manifest: Manifest | None
    compiled: Compiled | None
    parts: tuple[Compared, ...]


def verify_stored(
    path: Path, context: Context, session: Session, recipe: Path | None = None
) -> Stored | None:
    """Check a bundle in a folder, a zip or an MJZ, and report errors to the sink.

    Return None if it cannot be read. Files are compared with the hashes in the manifest, the compiled model with
    its index, and each part with its source if a file with the hash in the manifest is found: through `recipe`, or
    from the folder of the context. A part without a source is a warning, and with `recipe` an error.
    """
    shown = context.shown(path)
    try:
        bundle = read(context.folder / path, shown=shown)
    except ReadError as error:
        context.sink.add(error.diagnostic)
        return None
    manifest = manifest_of(bundle.files.get(MANIFEST), shown, context.sink)
    if manifest is not None:
        check_files(bundle, manifest, shown, sink=context.sink)
    if manifest is not None and manifest.target is not None and manifest.index is None:
        return Stored(bundle, manifest, None, parts=())  # it was written for another program
    compiled = _compiled(bundle, shown, context, session=session)
    if manifest is None or compiled is None:
        return Stored(bundle, manifest, compiled, parts=())
    if manifest.index is not None and compiled.index is not None:
        check_index(manifest.index, index_of(compiled.index), shown, sink=context.sink)
    inputs = Inputs(manifest, recipe, context)
    renamed = {part.part: part.renamed for part in manifest.parts}
    parts = tuple(_parts(manifest, inputs, Judge(session, manifest.merged, renamed)))
    for compared in parts:
        _report(compared, manifest, inputs, context=context)
    if manifest.union is not None:
        context.sink.warning(
            "part-not-compared",
            f"`{shown}` is the union of {manifest.union} models: its parts are compared with their sources in each of"
            " these, not in the union",
            help="build the models with `--all`, and verify these",
        )
    elif manifest.inputs and not parts and manifest.target is None:
        context.sink.warning(
            "part-not-compared",
            f"the manifest of `{shown}` does not say where its parts are attached: none was compared with its source",
            help="build it again with this version",
        )
    return Stored(bundle, manifest, compiled, parts=parts)


def _compiled(bundle: Bundle, shown: str, context: Context, session: Session) -> Compiled | None:
    try:
        verified: Verified = verify(bundle, session=session, keep=WHOLE, stranger=shown)
    except StrangerError as error:
        for each in error.found:
            context.sink.add(each)
        return None
    except OutputError as error:
        context.sink.add(error.diagnostic)
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


def _parts(manifest: Manifest, inputs: Inputs, judge: Judge) -> Iterator[Compared]:
    for part in manifest.parts:
        found = inputs.find(part.input)
        if isinstance(found, str):
            nowhere = Source(Path(), PATH, "")
            yield Compared(_member(part, nowhere), obscure=part.obscure or found)
        else:
            yield judge.compare(_member(part, found), part.changed, part.replaced_keys)


def _member(part: Part, source: Source) -> PartRecord:
    pose = None if part.pos is None or part.quat is None else Pose(part.pos, part.quat)
    return PartRecord(
        part.part, part.prefix, source, body=part.body, pose=pose, keys=part.keys, welded=part.welded,
        stands=part.stands, changed=part.changed, replaced_keys=part.replaced_keys, obscure=part.obscure,
        subtree=part.subtree,
    )  # fmt: skip


def _report(compared: Compared, manifest: Manifest, inputs: Inputs, context: Context) -> None:
    member = compared.member
    if compared.obscure is None:
        if compared.differences:
            context.sink.error("part-changed", changed(compared), notes=notes(compared.differences))
        return
    message = f"`{member.called}` is not compared with its source: {compared.obscure}"
    cause = Cause(compared.obscure, f"`{member.called}`")
    if member.obscure is not None:
        context.sink.warning("part-not-compared", message, cause=cause)
    elif inputs.given:
        context.sink.error("part-not-compared", message, cause=cause)
    else:
        name = manifest.recipe.path if manifest.recipe else "the recipe"
        help = f"say where the recipe is: `--recipe path/to/{name}`"
        context.sink.warning("part-not-compared", message, help=help, cause=cause)
