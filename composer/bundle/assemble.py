"""A composed model as a bundle: its text, the files it names, the licences of its parts, and the manifest."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.bundle import MODEL, Bundle, BundleError
from composer.bundle.collect import collect
from composer.bundle.licences import licence_files, licence_folder
from composer.bundle.manifest import Draw, Input, Manifest, Part, Recipe, files_of, index_of, with_manifest
from composer.context import Context, as_text
from composer.grammar import GRAMMAR
from composer.link.dedup import Merged
from composer.link.linking import FileUse
from composer.plan.drawn import Drawn
from composer.plan.member import Member
from composer.plan.plan import Plan
from composer.sources.source import Source
from composer.tree.unit import Unit
from composer.tree.write import write

if TYPE_CHECKING:
    from composer.engine import Compiled


def assemble(plan: Plan, model: Unit, uses: Iterable[FileUse], context: Context) -> Bundle | None:
    """The bundle, still without its manifest; None where a file is missing."""
    before = context.sink.error_count
    uses = tuple(uses)
    files = collect(model, uses, context.sink, context.shown)
    licences = {label: source.licences for label, source in sources(plan)}
    try:
        files.update(licence_files(licences))
        if context.sink.error_count > before:
            return None
        return Bundle({**files, MODEL: write(model.root)})
    except (OSError, BundleError) as error:
        context.sink.error("file-unreadable", f"a file of the model cannot be bundled: {error}")
        return None


def described(
    bundle: Bundle,
    plan: Plan,
    members: Iterable[Member],
    compiled: Compiled | None,
    context: Context,
    merged: Merged,
    drawn: Iterable[Drawn] = (),
) -> Bundle:
    """The bundle with its manifest; `compiled` is what MuJoCo made of it, None where nobody asked."""
    folder = plan.path.parent
    manifest = Manifest(
        name=plan.name,
        description=plan.description,
        mujoco=compiled.mujoco_version if compiled else None,
        grammar=GRAMMAR.versions[-1],
        recipe=Recipe(path=as_text(plan.path.name), sha256=_sha256(plan.path)),
        seed=plan.randomize.seed if plan.randomize else None,
        sample=plan.sample if plan.randomize else None,
        draws=tuple(_draw(each) for each in drawn),
        inputs=tuple(_input(label, source, bundle, folder) for label, source in sources(plan)),
        parts=tuple(_part(member, number) for number, member in enumerate(members)),
        files=files_of(bundle),
        merged=merged,
        index=index_of(compiled.index) if compiled and compiled.index else None,
        warnings=tuple(f"{each.code}: {each.message}" for each in context.sink.diagnostics),
    )
    return with_manifest(bundle, manifest)


def sources(plan: Plan, prefix: str = "") -> Iterator[tuple[str, Source]]:
    """Every source file of a plan and of the recipes in it, by the prefix of its part (or the base's name)."""
    for part_prefix, model in [("", plan.base.model), *((part.prefix, part.model) for part in plan.parts)]:
        label = prefix + part_prefix
        if isinstance(model, Plan):
            yield from sources(model, label)
        elif model is not None:
            yield label.strip(plan.separator) or model.path.stem, model


def _input(label: str, source: Source, bundle: Bundle, folder: Path) -> Input:
    start = licence_folder(label) + "/"
    return Input(
        path=as_text(_portable(source, folder)),
        reference=source.reference,
        kind=source.kind,
        sha256=_sha256(source.path),
        licences=tuple(path for path in bundle.files if path.startswith(start)),
        package=source.package,
        version=source.version,
    )


def _part(member: Member, number: int) -> Part:
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
        obscure=member.obscure,
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


def _portable(source: Source, folder: Path) -> str:
    """The path of a source as any machine may say it."""
    if source.origin is not None:
        folder = source.origin.root
    try:
        return source.path.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return source.reference if source.kind == "path" else source.path.name


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
