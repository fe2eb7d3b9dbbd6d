"""Migrate a model from one version of MuJoCo to another, and prove that it stays the same."""

from __future__ import annotations

import os
import shutil
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import field
from importlib.metadata import PackageNotFoundError, version
from itertools import chain
from pathlib import Path

import numpy as np
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note
from mjcompose.base.scratch import scratch
from mjcompose.base.words import counted, number_text
from mjcompose.mujoco.arrays import with_trait
from mjcompose.mujoco.environments import CompiledByVersion, Other, kept, open_python, this_python
from mjcompose.mujoco.messages import parse
from mjcompose.mujoco.programs import MissingError, ProgramError
from mjcompose.sources.context import Context
from mjcompose.sources.lock import resolve
from mjcompose.tools.migrate.changes import ORDERED, between
from mjcompose.tools.migrate.compare import ArrayComparison, compare
from mjcompose.tools.migrate.editing import (
    Markup,
    MarkupError,
    Meaning,
    MigratedFile,
    Migration,
    MigrationStep,
    Pieces,
    later,
)
from mjcompose.tree.files import file_attributes, join, written_path
from mjcompose.tree.grammar import version_key
from mjcompose.tree.history import RELEASED, default_of, place, release, unread
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.unit import Unit


def _own() -> str | None:
    with suppress(PackageNotFoundError):
        return version("mujoco")
    return None


def installed() -> str:
    """The release that is installed here, or the last release that the table knows."""
    own = _own()
    return (own and release(".".join(map(str, version_key(own))))) or RELEASED[-1]


def check_installed(context: Context) -> None:
    own = _own()
    if own is not None and version_key(own) > version_key(RELEASED[-1]):
        message = f"MuJoCo {own} is installed, but mjcompose knows the changes only up to {RELEASED[-1]}"
        context.sink.warning("migrate-version", message, help="update mjcompose")


def known(text: str, option: str, context: Context) -> str | None:
    """Return the release that the user names, or None if there is no such release, which is reported."""
    found = release(text)
    if found is None:
        help = f"name a version from {RELEASED[0]} to {RELEASED[-1]}; `{option} 3.1` is the last 3.1"
        context.sink.error("migrate-version", f"mjcompose cannot migrate from or to `{option} {text}`", help=help)
    return found


def written_for(unit: Unit, after: str, others: Collection[str], context: Context) -> str | None:
    """Return the version that a model is written for, or None if it is unknown, which is reported.

    `others` are the versions in the Pythons that the user names.
    """
    different = [version for version in others if version != after]
    if len(different) == 1:
        return known(different[0], "--with-python", context)
    if later(installed(), after):
        return installed()
    first, last = bounds(unit.root)
    if first is None or last is None:
        readers = "no version since 3.0 reads all of it"
    elif last == RELEASED[-1]:
        readers = f"all versions since {first} read it"
    else:
        readers = f"the versions from {first} to {last} read it"
    example = last if last and last != after else "3.3"
    help = f"add `--from`, as in `--from {example}`; look in its README or at the date of its last change"
    message = f"`{unit.file}` does not say which MuJoCo it is written for: {readers}"
    context.sink.error("migrate-version", message, help=help)
    return None


def bounds(root: Node) -> tuple[str | None, str | None]:
    """Return the first and the last version that read everything in a tree."""
    fitting = [version for version in RELEASED if next(unread(root, version), None) is None]
    return (fitting[0], fitting[-1]) if fitting else (None, None)


_MARK = b"\xef\xbb\xbf"


class Migrated(Struct, frozen=False):
    """`files` maps all XML files of the model to their texts before and after; `assets` are its other files.

    `adopted` are the changes whose new behavior the user accepts.
    """

    before: str
    after: str
    files: dict[Path, tuple[bytes, bytes]] = field(default_factory=dict)
    assets: tuple[Path, ...] = ()
    steps: tuple[MigrationStep, ...] = ()
    meanings: tuple[Meaning, ...] = ()
    adopted: tuple[str, ...] = ()

    @property
    def changed(self) -> dict[Path, tuple[bytes, bytes]]:
        return {path: texts for path, texts in self.files.items() if texts[0] != texts[1]}


def read(model: Path, context: Context) -> Unit | None:
    """Return the tree of a model that the user names, or None if it cannot be read, which is reported."""
    return parse_file(context.folder / model, context.sink, file=context.shown(model))


def migrate(
    unit: Unit,
    before: str,
    after: str,
    context: Context,
    adopt: Collection[str] = (),
    values: Mapping[str, object] | None = None,
) -> Migrated | None:
    """Return the model and the models that it attaches for another version, or None if that fails, which is reported.

    The unit is changed. `values` are the measurements of the MuJoCo of `before`, if known.
    """
    pieces = Pieces.of(unit, context)
    found = [(each.unit, pieces.measured(each, values or {})) for each in pieces.every]
    whole = [Migration(unit, context.sink, before, after=after, values=own) for unit, own in found]
    sources = [_sources(editing.unit, context) for editing in whole]
    if context.sink.errors:
        return None
    assets = tuple(dict.fromkeys(path for editing in whole for path in _assets(editing.unit)))
    adopted = _carried_out(whole, adopt)
    if context.sink.has_errors:
        return None
    result = Migrated(before, after, assets=assets, adopted=tuple(adopted))
    for editing, files in zip(whole, sources, strict=True):
        for path, (source, data) in files.items():
            if not _rewrite(path, source, data, editing=editing, files=result.files, context=context):
                return None
    result.steps = tuple(step for editing in whole for step in editing.steps)
    result.meanings = (*pieces.left, *(each for editing in whole for each in editing.meanings))
    return result


def _carried_out(whole: list[Migration], adopt: Collection[str]) -> list[str]:
    """Change all models, one change after the other; return the changes that the user adopts."""
    acts = [(change, act) for change, act in between(whole[0].before, whole[0].after) if act is not None]
    for change, act in acts:
        if change.name in adopt:
            continue
        for editing in whole:
            editing.change = change
            editing.whole = whole
            editing.unit.forget_classes()
        for editing in whole:
            act(editing)
    for editing in whole:
        editing.change = None
        _leave_out(editing)
    return [change.name for change, _ in acts if change.name in adopt]


def _leave_out(editing: Migration) -> None:
    """Remove attributes that the other version lacks if they change nothing there; report the others as errors."""
    for found in list(unread(editing.root, editing.after)):
        node = found.node
        name = found.attribute
        if node in editing.refused:
            continue
        unread_before = unread(editing.root, editing.before)
        if any(each.node is node and (each.attribute, each.value) == (name, found.value) for each in unread_before):
            continue  # its own version does not read it either
        lacks = f"MuJoCo {editing.after} has no {found.called}: {found.when()}"
        if name is None:
            is_new = found.since and later(found.since, editing.after)
            help = "`mjcompose build --target plain` writes a model without frames and copies"
            editing.refuse(node, lacks, help if is_new and node.tag in ("frame", "replicate", "attach") else None)
            continue
        path = place(node)
        key = f"{place(node)}@{name}"
        neutral = _HARMLESS.get(key, default_of(path, name))
        is_harmless = neutral == node.get(name) or (neutral is None and key in _HARMLESS)
        if found.value is None and is_harmless:
            editing.unset(node, name)
        elif key in _OF_THE_ENGINE:
            words = editing.lacking(path, name, str(node.get(name)))
            editing.warn(node, words, None, attribute=name, arrays=(f"flags.{name}",))
            editing.unset(node, name)
        else:
            editing.refuse(node, lacks, None, attribute=name)


_HARMLESS = {
    "option/flag@nativeccd": "disable",
    "option/flag@multiccd": "disable",
    "option/flag@island": "disable",
    "option@sleep_tolerance": None,
    "visual/global@bvactive": "true",
    "body/light@softness": None,
    "default/light@softness": None,
    "asset/texture@colorspace": "linear",
    "compiler@savecompiled": None,
    "compiler@savecanonical": None,
    "compiler@saveinertial": None,
}
"""Values that mean the same as no attribute; None: any value does."""

_OF_THE_ENGINE = frozenset(
    f"option/flag@{name}" for name in ("nativeccd", "autoreset", "diagexact", "ipc", "speculative", "sleep")
)
"""Ways to simulate that earlier versions lack; the model is the same without them."""


def _rewrite(
    path: Path,
    source: MigratedFile,
    data: bytes,
    *,
    editing: Migration,
    files: dict[Path, tuple[bytes, bytes]],
    context: Context,
) -> bool:
    """Note the text of a file before and after, and return whether it can be written; if not, it is reported."""
    try:
        text = source.rewritten(editing.renamed)
    except MarkupError:
        _cannot_edit(path, context)
        return False
    mark = _MARK if data.startswith(_MARK) else b""
    new = mark + text.encode("utf-8", "surrogateescape")
    if files.setdefault(path, (data, new))[1] == new:
        return True
    message = f"two of these models include `{context.shown(path)}`, and each needs a version of its own"
    context.sink.error("migrate-cannot", message, help="make a copy for one of the models")
    return False


def _sources(unit: Unit, context: Context) -> dict[Path, tuple[MigratedFile, bytes]]:
    """Return the files of a unit with their nodes; report a text whose form differs from the tree."""
    nodes: dict[str, list[Node]] = defaultdict(list)
    for node in unit.root.iter("*"):
        nodes[str(unit.origins.owner(node, unit.file))].append(node)
    result: dict[Path, tuple[MigratedFile, bytes]] = {}
    for file in dict.fromkeys((unit.file, *unit.origins.texts)):
        inside = os.path.relpath(file, os.path.dirname(unit.file) or ".")
        path = Path(os.path.normpath(unit.directory / inside))
        data = unit.door.read(path)
        try:
            markup = Markup.read(data.removeprefix(_MARK).decode("utf-8", "surrogateescape"))
            result[path] = MigratedFile(markup, _matched(markup, nodes[file], file != unit.file)), data
        except MarkupError:
            _cannot_edit(path, context)
    return result


def _matched(markup: Markup, nodes: list[Node], is_included: bool) -> list[Node | None]:
    """Return the node of each element of a text; `<include>` and the root of an included file have none."""
    tags = [each.head.tag for each in markup.elements]
    with_node = [at for at, tag in enumerate(tags) if tag != "include" and not (is_included and not at)]
    if [tags[at] for at in with_node] != [node.tag for node in nodes]:
        raise MarkupError("the elements")
    matched = dict(zip(with_node, nodes, strict=True))
    return [matched.get(at) for at in range(len(tags))]


def _cannot_edit(path: Path, context: Context) -> None:
    help = "build a recipe with this model as its `base`, and migrate the result"
    message = f"mjcompose cannot edit the text of `{context.shown(path)}`"
    context.sink.error("migrate-cannot", message, help=help, cause=Cause("form", str(path)))


def _assets(unit: Unit) -> Iterator[Path]:
    names = [written_path(unit.settings, element, name) for element, _, name in file_attributes(unit.root)]
    models = (element.get("file") for element in unit.root.iterfind("asset/model"))
    yield from (Path(join(str(unit.directory), str(name))) for name in (*names, *filter(None, models)))


class Proof(Struct, frozen=False):
    """`before` and `after` are the compiled models, or None without that version of MuJoCo."""

    before: CompiledByVersion | None = None
    after: CompiledByVersion | None = None
    outcome: ArrayComparison | None = None


class Prover(Struct, frozen=False):
    """Compiles in `folder`. `others` are the available MuJoCos by version."""

    folder: Path
    others: Mapping[str, Other]
    progress: Callable[[str], None]
    known: dict[str, CompiledByVersion] = field(default_factory=dict)

    def original(self, migrated_from: str, model: Path) -> CompiledByVersion | None:
        """Compile the model in its place with the MuJoCo of its own version. Raises ProgramError."""
        if migrated_from in self.others and migrated_from not in self.known:
            self.progress(f"compiling {model.name} with MuJoCo {migrated_from}")
            self.known[migrated_from] = self.others[migrated_from].compile(model, self.folder / "before.npz")
        return self.known.get(migrated_from)

    def prove(self, migrated: Migrated, model: Path) -> Proof:
        """Compile the migrated model with the other MuJoCo, and compare. Raises ProgramError, and OSError."""
        proof = Proof(self.original(migrated.before, model))
        other = self.others.get(migrated.after)
        if other is not None:
            self.progress(f"compiling the migrated {model.name} with MuJoCo {migrated.after}")
            stage = self.folder / "stage"
            stage.mkdir()
            proof.after = other.compile(lay_out(migrated, stage, link=True)[model], self.folder / "after.npz")
        if proof.before and proof.after and proof.before.error is None and proof.after.error is None:
            proof.outcome = compare(proof.before, proof.after)
        return proof


def measured(compiled: CompiledByVersion | None) -> dict[str, object]:
    """Return the damping of each actuator of the original model, which a change needs."""
    if compiled is None or compiled.arrays is None:
        return {}
    with np.load(compiled.arrays, allow_pickle=False) as stored:
        damping = stored["actuator_biasprm"][:, 2]
    names = compiled.names.get("actuator", ())
    return {"kv": {name: number_text(-float(value)) for name, value in zip(names, damping, strict=False) if name}}


def lay_out(migrated: Migrated, folder: Path, *, link: bool = False) -> dict[Path, Path]:
    """Write the migrated files and all other files of the model into a folder; return the place of each.

    `link` makes links to unchanged files. Raises OSError.
    """
    every = [*migrated.files, *migrated.assets]
    top = os.path.commonpath([os.path.abspath(each.parent) for each in every])
    placed: dict[Path, Path] = {}
    for path in every:
        to = folder / os.path.relpath(os.path.abspath(path), top)
        if to in placed.values():
            continue
        to.parent.mkdir(parents=True, exist_ok=True)
        placed[path] = to
        if path in migrated.files:
            to.write_bytes(migrated.files[path][1])
        elif not os.path.exists(path):
            continue  # MuJoCo reports it
        elif link and os.name == "posix":
            to.symlink_to(os.path.abspath(path))
        else:
            shutil.copyfile(path, to)
    return placed


_SHOWN = 20
_FOLLOW = with_trait("tree inertia", "output inertia", "subtree").union(
    "cam_poscom0 light_poscom0 geom_rbound".split(),
    "stat.meaninertia stat.meanmass stat.meansize stat.center stat.extent".split(),
)
"""Values that MuJoCo computes from masses and places."""


class MigrateRequest(Struct):
    """The request. `pythons` have other versions of MuJoCo; with `proves`, both versions must be there."""

    model: str
    before: str | None = None
    after: str | None = None
    adopt: tuple[str, ...] = ()
    pythons: tuple[Path, ...] = ()
    proves: bool = False


class Result(Struct, frozen=False):
    """`missing` are the versions that a proof needs; `unexplained` are differences that no change explains."""

    model: Path
    migrated: Migrated
    proof: Proof
    missing: tuple[str, ...] = ()
    explained: list[str] = field(default_factory=list)
    unexplained: list[str] = field(default_factory=list)


def run(wish: MigrateRequest, context: Context, progress: Callable[[str], None]) -> Result | None:
    """Migrate without writing; return None if it fails, which is reported."""
    path = found_model(wish.model, context)
    unit = None if path is None else read(path, context)
    if path is None or unit is None or not all_admitted(unit, context.sink, context.shown):
        return None
    check_installed(context)
    after = installed() if wish.after is None else known(wish.after, "--mujoco", context)
    before = None if wish.before is None else known(wish.before, "--from", context)
    try:
        others = opened(wish.pythons, context)
        if context.sink.has_errors or after is None:
            return None
        before = before or written_for(unit, after, others, context=context)
        if before is None:
            return None
        gather((before, after) if wish.proves else (), others, context)
        with scratch("migrate") as folder:
            prover = Prover(folder, others, progress)
            result = _migrated_and_proved(unit, path, before, after, prover=prover, wish=wish, context=context)
    except (ProgramError, OSError) as error:
        context.sink.error("migrate-python", str(error), help=getattr(error, "help", None))
        return None
    return None if context.sink.has_errors else result


def _migrated_and_proved(
    unit: Unit, path: Path, before: str, after: str, *, prover: Prover, wish: MigrateRequest, context: Context
) -> Result | None:
    values = measured(prover.original(before, path)) if before != after else {}
    migrated = migrate(unit, before, after, context=context, adopt=wish.adopt, values=values)
    if migrated is None:
        return None
    proof = prover.prove(migrated, path) if before != after else Proof()
    missing = tuple(version for version in (before, after) if version not in prover.others)
    result = Result(path, migrated, proof, missing=missing)
    _judge(result, context)
    return result


def opened(pythons: Iterable[Path], context: Context) -> dict[str, Other]:
    """Return the versions of MuJoCo of the Pythons that the user names. Raises ProgramError, and OSError."""
    return {each.version: each for each in (open_python(context.folder / path) for path in pythons)}


def gather(versions: Iterable[str], others: dict[str, Other], context: Context) -> None:
    """Add the MuJoCo of this Python to `others`, and the versions that are installed.

    Raises MissingError for all versions that are not installed, and ProgramError.
    """
    others.setdefault(installed(), Other(this_python(), installed()))
    missing: list[str] = []
    for each in versions:
        try:
            if each not in others:
                others[each] = kept(each, context.environment)
        except MissingError:
            missing.append(each)
    if missing:
        raise MissingError(missing)


def found_model(model: str, context: Context) -> Path | None:
    path = context.folder / model
    folder = context.folder
    if os.path.exists(path):
        return path
    with context.sink:
        return resolve(model, relative_to=folder, environment=context.environment, fetching=context.fetching).path
    return None


def _judge(result: Result, context: Context) -> None:
    """Report the result of the proof: rejected models, changes of meaning that it did not settle, and differences."""
    _report_rejected(result, context)
    _report_meanings(result, context)
    if result.proof.outcome is not None:
        _sort_differences(result, result.proof.outcome)
        _report_unexplained(result, context)


def _report_rejected(result: Result, context: Context) -> None:
    proof = result.proof
    for compiled, whose in ((proof.before, "as it is"), (proof.after, "after the migration")):
        if compiled is not None and compiled.error is not None:
            fault = parse(compiled.error)
            line = "" if fault.line is None else f" (line {fault.line})"
            name = f" (`{fault.name}`)" if fault.name else ""
            reason = f"{' '.join(fault.message.split())}{name}{line}"
            message = f"MuJoCo {compiled.version} rejects `{context.shown(result.model)}` {whose}: {reason}"
            other = f"it is not written for {result.migrated.before}: name another version with `--from`"
            context.sink.error("mujoco-rejects", message, help=other if compiled is proof.before else None)


def _report_meanings(result: Result, context: Context) -> None:
    """Warn of the numbers that mean something else now, except those that the proof found equal."""
    outcome = result.proof.outcome
    settled = frozenset() if outcome is None else outcome.settled
    for meaning in result.migrated.meanings:
        if not meaning.arrays or not settled.issuperset(meaning.arrays):
            cause = Cause(f"{meaning.change} {meaning.help}", meaning.message)
            context.sink.warning("migrate-changed", meaning.message, meaning.span, help=meaning.help, cause=cause)


def _sort_differences(result: Result, outcome: ArrayComparison) -> None:
    """Sort the differences into those that an adopted change or a changed meaning explains, and the others."""
    migrated = result.migrated
    adopted = [change.arrays for change in ORDERED if change.name in migrated.adopted]
    known_arrays = set(chain(*adopted, *(meaning.arrays for meaning in migrated.meanings)))
    if any(difference.array in known_arrays for difference in outcome.differences):
        known_arrays |= _FOLLOW
    for difference in outcome.differences:
        (result.explained if difference.array in known_arrays else result.unexplained).append(difference.words())


def _report_unexplained(result: Result, context: Context) -> None:
    count = len(result.unexplained)
    if count:
        notes = [Note(words) for words in result.unexplained[:_SHOWN]]
        if count > _SHOWN:
            notes.append(Note(f"and {count - _SHOWN} more"))
        differ = f"{counted(count, 'array')} differ{'s' if count == 1 else ''}"
        versions = result.migrated
        message = f"MuJoCo {versions.after} compiles another model than {versions.before}: {differ}"
        context.sink.warning("migrate-differs", message, notes=notes)
