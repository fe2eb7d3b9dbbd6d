"""Verify a stored bundle against its manifest and its sources."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from mjcompose.base.access import NOTHING, Door, folder_of_recipe, own_door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause
from mjcompose.base.files import read_regular
from mjcompose.base.rotation import Pose
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import MANIFEST, Bundle, OutputError
from mjcompose.bundle.manifest import Input, Manifest, check_files, check_index, index_of, manifest_of
from mjcompose.bundle.read import ReadError, read
from mjcompose.link.existence import existence_faults
from mjcompose.mujoco.engine import Compiled, Session
from mjcompose.plan.plan import PartRecord
from mjcompose.plan.planner import make_plan
from mjcompose.plan.read import read_source
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import PATH, kind_called
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import CompilerSettings, Source, SourceError
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.parse import all_admitted, parse_text
from mjcompose.tree.values import NOT_XML
from mjcompose.verify.compile import WHOLE, OutsideFilesError, verify
from mjcompose.verify.parts import PartComparer, PartComparison, change_sentence, difference_notes


class InputFinder:
    """The inputs of a bundle, found through its recipe if there is one, else from `context.folder`.

    Without `recipe`, a file with the recipe's name is used if it has the hash in the manifest. Errors of a given recipe
    are reported.
    """

    def __init__(self, manifest: Manifest, recipe: Path | None, context: Context) -> None:
        self.manifest = manifest
        self.context = context
        self.given = recipe is not None
        found = recipe
        named = manifest.recipe
        if found is None and named is not None and Path(named.path).name == named.path:
            path = context.folder / named.path
            found = path if _sha256(path) == named.sha256 else None
        self.folder = context.folder if found is None else (context.folder / found).parent
        # The bundle may come from anyone, so its references may only name files of this project.
        self.door = Door.of([folder_of_recipe(self.folder / "recipe.yaml")])
        self.planned: list[Source] = []
        self.fetching = Fetching()
        self.digests: dict[Path, str | None] = {}
        self.admitted: dict[tuple[Path, Door, CompilerSettings], bool] = {}
        if found is not None:
            aside = Context(context.sink if self.given else Sink(), context.environment, context.folder)
            plan = make_plan(found, aside)
            self.planned = [] if plan is None else list(plan.sources())

    def find(self, number: int) -> Source | str:
        """Return the source of an input, or a sentence with the reason that there is none."""
        if number >= len(self.manifest.inputs):
            return f"the manifest has no input {number}"
        wanted = self.manifest.inputs[number]
        if not all(map(_is_setting, wanted.compiler, wanted.compiler.values())):
            return "the manifest gives settings for its source that `<compiler>` does not have"
        changed: Path | None = None
        for candidate in self._candidates(number, wanted):
            source = replace(candidate, compiler=tuple(sorted(wanted.compiler.items())))
            digest = self._digest(source.path)
            if digest == wanted.sha256:
                # MuJoCo may open the source and its files. URDF is checked when it is converted.
                if source.format not in ("mjcf", "mesh") or self._is_admitted(source):
                    return source
                return "its source names files that it may not read"
            changed = changed or (source.path if digest else None)
        if changed is not None:
            return f"`{self.context.shown(changed)}` is not the file that the bundle was built from"
        return f"its source `{wanted.reference}` is not found"

    def _digest(self, path: Path) -> str | None:
        if path not in self.digests:
            self.digests[path] = _sha256(path)
        return self.digests[path]

    def _is_admitted(self, source: Source) -> bool:
        """Return whether a source may read the files that it names. Many parts may have the same source."""
        key = source.path, source.door, source.compiler
        if key not in self.admitted:
            unit = read_source(source, Sink())
            self.admitted[key] = unit is not None and all_admitted(unit, Sink())
        return self.admitted[key]

    def _candidates(self, number: int, wanted: Input) -> Iterator[Source]:
        if len(self.planned) == len(self.manifest.inputs):
            yield self.planned[number]
        kind = kind_called(wanted.kind)
        # Only the bundle asks for this reference, so nothing is fetched and no code runs.
        if kind is not None and not kind.is_fetched and not kind.runs_code:
            with suppress(SourceError):
                found = resolve(
                    wanted.reference,
                    relative_to=self.folder,
                    environment=self.context.environment,
                    fetching=self.fetching,
                )
                if found.origin is not None or self.door.sees(found.path):
                    yield found
        path = self.folder / wanted.path
        if self.door.sees(path):
            yield Source(path, kind or PATH, wanted.reference, door=own_door(path))


def _is_setting(name: str, value: str) -> bool:
    return name in GRAMMAR.section("compiler").attributes and NOT_XML.search(value) is None


def _sha256(path: Path) -> str | None:
    try:
        return hashlib.sha256(read_regular(path)).hexdigest() if os.path.isfile(path) else None
    except (OSError, ValueError):
        return None


class VerifiedBundle(Struct):
    """A bundle that was read, its compiled model, and its parts in the order of the manifest."""

    bundle: Bundle
    manifest: Manifest | None
    compiled: Compiled | None
    parts: tuple[PartComparison, ...]


def verify_stored(path: Path, context: Context, session: Session, recipe: Path | None = None) -> VerifiedBundle | None:
    """Check a bundle in a folder, a zip or an MJZ, and report errors.

    Return None if it cannot be read. Files are compared with the hashes in the manifest, the compiled model with
    its index, and each part with its source if a file with the hash in the manifest is found: through `recipe`, or
    from the folder of the context. A part without a source is a warning, or with `recipe` an error.
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
        return VerifiedBundle(bundle, manifest, None, parts=())  # it was written for another program
    compiled = _compiled(bundle, shown, context, session=session)
    if manifest is None or compiled is None:
        return VerifiedBundle(bundle, manifest, compiled, parts=())
    if manifest.index is not None and compiled.index is not None:
        check_index(manifest.index, index_of(compiled.index), shown, sink=context.sink)
    inputs = InputFinder(manifest, recipe, context)
    renamed = {part.part: part.renamed for part in manifest.parts}
    parts = tuple(_parts(manifest, inputs, PartComparer(session, manifest.merged, renamed)))
    for compared in parts:
        _report(compared, manifest, inputs, context=context)
    if manifest.union is not None:
        message = f"`{shown}` is the union of {manifest.union} models: its parts are not compared with their sources"
        help = "build the models with `--all`, and verify each of them"
        context.sink.warning("part-not-compared", message, help=help)
    elif manifest.inputs and not parts and manifest.target is None:
        message = f"the manifest of `{shown}` does not say where parts are attached: none is compared with its source"
        context.sink.warning("part-not-compared", message, help="build it again with this version")
    return VerifiedBundle(bundle, manifest, compiled, parts=parts)


def _compiled(bundle: Bundle, shown: str, context: Context, session: Session) -> Compiled | None:
    try:
        verified = verify(bundle, session=session, keep=WHOLE, stranger=shown)
    except (OutsideFilesError, OutputError) as error:
        context.sink.extend(error.found if isinstance(error, OutsideFilesError) else (error.diagnostic,))
        return None
    for warning in verified.warnings:
        said = " ".join(warning.message.split())
        context.sink.warning("mujoco-warning", f"MuJoCo warns about `{shown}`: {said}")
    if verified.error is None:
        _check_existence(bundle, shown, verified.compiled, context)
        return verified.compiled
    fault = verified.error
    line = "" if fault.line is None else f", line {fault.line} of `{bundle.model}`"
    place = f" ({fault.element or 'element'} `{fault.name}`{line})" if fault.name else line
    context.sink.error(verified.code, f"`{shown}` does not compile: {' '.join(fault.message.split())}{place}")
    return None


def _check_existence(bundle: Bundle, shown: str, compiled: Compiled, context: Context) -> None:
    """Report elements of the model that MuJoCo drops or multiplies, at their lines in the bundle."""
    text = bundle.files[bundle.model] if bundle.model.endswith(".xml") else None
    if text is None or compiled.names is None:
        return
    file = f"{shown.rstrip('/')}/{bundle.model}"
    model = parse_text(text, Sink(), file=file, directory=context.folder, label="", contents=bundle.files, door=NOTHING)
    if model is not None:
        context.sink.extend(existence_faults(model, compiled.names))


def _parts(manifest: Manifest, inputs: InputFinder, judge: PartComparer) -> Iterator[PartComparison]:
    for part in manifest.parts:
        found = inputs.find(part.input)
        member = PartRecord(
            part.part,
            part.prefix,
            Source(Path(), PATH, "") if isinstance(found, str) else found,
            body=part.body,
            pose=None if part.pos is None or part.quat is None else Pose(part.pos, part.quat),
            keys=part.keys,
            welded=part.welded,
            is_fixed_in_world=part.stands,
            changed=part.changed,
            replaced_keys=part.replaced_keys,
            obscure=part.obscure,
            subtree=part.subtree,
        )
        if isinstance(found, str):
            yield PartComparison(member, obscure=part.obscure or found)
        else:
            yield judge.compare(member, part.changed, part.replaced_keys)


def _report(compared: PartComparison, manifest: Manifest, inputs: InputFinder, context: Context) -> None:
    member = compared.member
    if compared.obscure is None:
        if compared.differences:
            context.sink.error("part-changed", change_sentence(compared), notes=difference_notes(compared.differences))
        return
    message = f"`{member.called}` is not compared with its source: {compared.obscure}"
    name = manifest.recipe.path if manifest.recipe else "the recipe"
    help = None if member.obscure or inputs.given else f"say where the recipe is: `--recipe path/to/{name}`"
    report = context.sink.error if inputs.given and member.obscure is None else context.sink.warning
    report("part-not-compared", message, help=help, cause=Cause(compared.obscure, f"`{member.called}`"))
