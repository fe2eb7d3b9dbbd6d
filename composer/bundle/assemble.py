"""Assemble a bundle from a composed model: its text, its files, the licences of its parts, and the manifest."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.beside import picture_of
from composer.bundle.bundle import MODEL, Bundle, BundleError
from composer.bundle.collect import collect
from composer.bundle.element_places import written_in
from composer.bundle.licences import Licences, licence_files
from composer.bundle.manifest import (
    Adopted,
    Check,
    Draw,
    Input,
    Made,
    Manifest,
    OfUrdf,
    Origin,
    Part,
    Read,
    Recipe,
    files_of,
    with_manifest,
)
from composer.bundle.manifest_index import index_of
from composer.bundle.portable import Portable
from composer.bundle.renamed import Renamed, renamed_in
from composer.context import Context, as_text
from composer.dataclass import dataclass
from composer.document.node import spans
from composer.grammar import GRAMMAR
from composer.link.dedup import Merged
from composer.link.linking import FileUse
from composer.plan.drawn import Drawn
from composer.plan.made_shapes import MadeShapes
from composer.plan.part_record import PartRecord, Tables
from composer.plan.plan import Plan
from composer.reading.folders import real_path
from composer.reading.refused import Refused
from composer.sources.digest import remembered_sha256
from composer.sources.origin import Origin as Fetched
from composer.sources.source import Source
from composer.sources.spdx import UNKNOWN, licence_of
from composer.tree.read_row import ReadRow
from composer.tree.unit import Unit
from composer.tree.write import write

if TYPE_CHECKING:
    from composer.engine import Compiled
    from composer.verify.outcome import Outcome


_OF_THE_LOCK = ("lock-stale", "source-changed")
"""Warnings that do not affect the model: it is the same with an old lock and without one."""


def assemble(plan: Plan, model: Unit, uses: Iterable[FileUse], context: Context) -> Bundle | None:
    """Return the bundle without its manifest, or None if a file is missing."""
    before = context.sink.error_count
    uses = tuple(uses)
    files = collect(model, uses, context.sink, shown=context.shown)
    try:
        files.update(_licences(sources(plan)).files)
        if context.sink.error_count > before:
            return None
        return Bundle({**files, MODEL: write(model.root)})
    except Refused as refused:
        refused.report(context.sink, None, shown=context.shown)
        return None
    except (OSError, BundleError) as error:
        file = getattr(error, "filename", None) or getattr(error, "path", None)
        what = "a file of the model" if file is None else f"`{context.shown(Path(file))}`"
        why = getattr(error, "strerror", None)
        context.sink.error("file-unreadable", f"{what} cannot be bundled: {why.lower() if why else error}")
        return None


@dataclass(frozen=True, slots=True)
class Making:
    """What a manifest says about how a model was made.

    `compiled` is the result of MuJoCo, None if the model was not compiled; `cell` the name of its cell; `pictured`
    says that a picture will be next to it.
    """

    plan: Plan
    model: Unit
    uses: tuple[FileUse, ...]
    members: tuple[PartRecord, ...]
    compiled: Compiled | None
    merged: Merged
    checks: tuple[Outcome, ...] = ()
    cell: str | None = None
    drawn: tuple[Drawn, ...] = ()
    pictured: bool = False
    made: tuple[MadeShapes, ...] = ()
    tables: Tables = field(default_factory=dict)


def described(bundle: Bundle, making: Making, context: Context) -> Bundle:
    """Return the bundle with its manifest."""
    plan, compiled, model = making.plan, making.compiled, making.model
    named = list(sources(plan))
    names = portable(plan, model, context)
    licences = _licences(named)
    inputs = tuple(
        _input(source, licences.of[label], names, table=making.tables.get(source.read_as, ()))
        for label, source in named
    )
    renamed = renamed_in(model, making.members)
    index = None
    if compiled is not None and compiled.index is not None:
        index = index_of(compiled.index, written_in(model, compiled.index, names.place))
    manifest = Manifest(
        name=plan.name,
        description=plan.description,
        mujoco=compiled.mujoco_version if compiled else None,
        grammar=GRAMMAR.versions[-1],
        recipe=Recipe(path=as_text(plan.path.name), sha256=remembered_sha256(plan.path)),
        separator=plan.separator,
        cell=making.cell,
        variants=dict(plan.variants),
        params={name: value for name, value in plan.scope.items() if name not in plan.variants},
        seed=plan.randomize.seed if plan.randomize else None,
        sample=plan.sample if plan.randomize else None,
        draws=tuple(_draw(each) for each in making.drawn),
        inputs=inputs,
        parts=tuple(_part(member, number, renamed) for number, member in enumerate(making.members)),
        adopted=tuple(
            Adopted(
                setting=each.setting,
                value=each.value,
                parts=each.parts,
                origin=names.place(each.span),
            )
            for each in model.adopted
            if each.is_written
        ),
        read=tuple(Read(path=path, sha256=digest) for path, digest in _read(bundle, making, names)),
        licences=_by_licence(inputs, making.members),
        files=files_of(bundle),
        merged=making.merged,
        picture=picture_of(plan.name) if making.pictured else None,
        made=tuple(_made(each, names) for each in making.made),
        checks=tuple(
            Check(name=each.name, kind=each.kind, values=dict(each.values), origin=names.place(each.span))
            for each in making.checks
        ),
        index=index,
        warnings=tuple(
            f"{each.code}: {names.text(each.message)}"
            for each in context.sink.diagnostics
            if each.code not in _OF_THE_LOCK
        ),
    )
    return with_manifest(bundle, manifest)


def portable(plan: Plan, model: Unit, context: Context) -> Portable:
    """Return the names of a plan's files for its manifest."""
    return Portable(plan.path, plan.sources(), _origins(plan), model=model, context=context)


def _read(bundle: Bundle, making: Making, portable: Portable) -> list[tuple[str, str]]:
    """Return every file that was read, with its hash; each is hashed once."""
    known = {
        real_path(where): bundle.digest(path)
        for path, where in making.model.contents.items()
        if isinstance(where, Path) and path in bundle.files
    }
    files = {
        *portable.texts_on_disk(),
        *map(portable.path, {*_files_of(making.plan)}),
        *(path for _, source in sources(making.plan) for path in (source.path, *source.licences)),
        *(Path(use.source) for use in making.uses if use.content is None),
    }
    found: dict[str, str] = {}
    for path in files:
        name = portable.name(path)
        if name not in found:
            found[name] = known.get(real_path(path)) or remembered_sha256(path)
    return sorted(found.items())


def _files_of(plan: Plan) -> Iterator[str]:
    """Yield the files of a plan's recipes and of those that they extend, as messages name them."""
    for each in plan.plans():
        yield from (os.fspath(source.path) for source, _ in each.extended)
        yield from (span.file for span in spans(each.document))


def _by_licence(inputs: tuple[Input, ...], members: tuple[PartRecord, ...]) -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for each, member in zip(inputs, members, strict=True):
        found.setdefault(each.licence or UNKNOWN, []).append(member.part)
    return {licence: tuple(parts) for licence, parts in sorted(found.items())}


def _origins(plan: Plan) -> Iterator[Fetched | None]:
    """Yield the origins of the recipes of a plan."""
    for each in plan.plans():
        yield each.source.origin if each.source is not None else None
        yield from (source.origin for source, _ in each.extended)


def sources(plan: Plan) -> Iterator[tuple[str, Source]]:
    """Yield every source file of a plan and its nested recipes, with the prefix of its part (or the base's name)."""
    for place in plan.walk():
        if isinstance(place.model, Source):
            yield place.prefix.strip(plan.separator) or place.model.path.stem, place.model


def _licences(named: Iterable[tuple[str, Source]]) -> Licences:
    """Return the licences by label; a base may have the same label as a part."""
    found: dict[str, list[Path]] = {}
    for label, source in named:
        found.setdefault(label, []).extend(source.licences)
    return licence_files(found)


def _input(
    source: Source, licences: tuple[str, ...], portable: Portable, table: tuple[ReadRow, ...]
) -> Input:
    origin = source.origin
    return Input(
        path=as_text(_path_of(source, portable)),
        reference=source.reference,
        kind=source.kind.name,
        sha256=remembered_sha256(source.path),
        origin=None
        if origin is None
        else Origin(id=origin.id, commit=origin.commit, tree=origin.tree, sha256=origin.sha256),
        licence=licence_of(source),
        licences=licences,
        package=source.package,
        version=source.version,
        urdf=tuple(
            OfUrdf(
                what=row.what,
                count=row.count,
                became=row.became or None,
                why=row.why or None,
                origin=portable.place(row.span),
            )
            for row in table
        ),
    )


def _path_of(source: Source, portable: Portable) -> str:
    """Return a path relative to the source's origin."""
    if source.origin is None:
        return portable.name(source.path)
    return Path(os.path.relpath(real_path(source.path), real_path(source.origin.root))).as_posix()


def _part(member: PartRecord, number: int, renamed: Renamed) -> Part:
    pose = member.pose
    return Part(
        part=member.part,
        input=number,
        prefix=member.prefix,
        body=member.body,
        pos=None if pose is None else pose.pos,
        quat=None if pose is None else pose.quat,
        keys=member.keys,
        welded=member.welded,
        stands=member.stands,
        changed=member.changed,
        replaced_keys=member.replaced_keys,
        obscure=member.obscure or member.reduced,
        subtree=member.subtree,
        renamed={kind: dict(names) for kind, names in renamed.get(member.part, {}).items()},
    )


def _made(made: MadeShapes, names: Portable) -> Made:
    return Made(
        mesh=made.mesh,
        geom=made.of,
        how=made.how,
        shapes=made.shapes,
        **made.error,  # type: ignore[arg-type]  # measured, and checked where it was kept
        made_with=dict(made.made_with),
        key=made.key,
        origin=names.place(made.span),
    )


def _draw(drawn: Drawn) -> Draw:
    return Draw(
        field=drawn.field,
        element=drawn.element,
        attribute=drawn.attribute,
        component=drawn.start,
        operation=drawn.operation,
        value=drawn.value,  # type: ignore[arg-type]  # vectors of vectors are not drawn
    )
