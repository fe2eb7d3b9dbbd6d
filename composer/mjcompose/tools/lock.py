"""The lock of a recipe: plan all models of the recipe, write their sources to the lock, and report changes."""

from __future__ import annotations

import os
import shlex
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mjcompose.base.access import Door, door_of_named
from mjcompose.base.codes import OF_FILES
from mjcompose.base.diagnostic import Note, Severity
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.bundle.bundle import writing
from mjcompose.bundle.staging import staged_file
from mjcompose.compose.interface import interface_changes, locked_interface
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.cells import cells_of, choices_of
from mjcompose.plan.locked import lock_changes, lock_of, plan_with_intact_store, use_lock
from mjcompose.plan.matrix import filled_from_first_cell
from mjcompose.plan.parts import parameters_choose
from mjcompose.plan.plan import Plan
from mjcompose.plan.planner import make_plan, plan_what_remains
from mjcompose.plan.read import Given, read_recipe
from mjcompose.sides.names import names_of
from mjcompose.sides.operand import Operand, OperandKind
from mjcompose.sides.side import load_cell
from mjcompose.sources.blobs import differences, digest
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import Disputed, Lock, LockedName, kind_of, lock_path, shapes_folder, to_text


def write_lock(
    recipe: Path,
    names: tuple[str, ...] | None,
    context: Context,
    given: Given | None = None,
    *,
    interface: bool = False,
) -> tuple[str, list[str]] | None:
    """Write the lock; return its place and its new entries, or None after errors, which are reported.

    `names` are the sources to upgrade: None for none, `()` for all. Either of these, or `interface`, also upgrades the
    interface.
    """
    if not os.path.isfile(context.folder / recipe):
        make_plan(recipe, context)  # which reports the existing names
        return None
    how = _lock_to_change(recipe, names, context)
    if how is None:
        return None
    assert how.lock_file is not None
    before = how.lock
    given = given or {}
    whole = filled_from_first_cell(recipe, context, given).given
    plan = plan_with_intact_store(lambda: make_plan(recipe, context, whole), context)
    if plan is None:
        return None
    plans = [plan, *_plans_of_cells(recipe, context, given), *_plans_of_variants(recipe, context, whole)]
    shapes = _shapes(plans, context)
    digests = {key: digest(content) for key, content in shapes.items()}
    after = lock_of(plans, how, how.lock_file.parent, context=context, shapes=digests)
    if plan.interface:
        accepts_changes = names == () or interface
        locked = before.interface if before is not None and not accepts_changes else {}
        after = _with_interface(after, locked, recipe, plan, context, given=whole)
    if before is not None and how.fresh is not None:
        _report_changes(before, after, how.fresh, recipe=recipe, context=context)
    if context.sink.has_errors:
        return None
    changes = _write(before, after, shapes, recipe, how.lock_file, context)
    return None if changes is None else (context.shown(how.lock_file), changes)


def _lock_to_change(recipe: Path, names: tuple[str, ...] | None, context: Context) -> Fetching | None:
    """Return the rules for fetching, with the sources to upgrade as fresh; None after reported errors."""
    disputes: Disputed = {}
    how = use_lock(recipe, context, disputes)
    if how is None or how.lock_file is None:
        return None
    if names is not None:
        how.fresh = _wanted(names, how.lock, context)
    if how.fresh is not None:
        _report_disputes({id: pins for id, pins in disputes.items() if id not in how.fresh}, how, context)
    return None if context.sink.error_count else how


def _shapes(plans: Sequence[Plan], context: Context) -> dict[str, bytes]:
    """Return the converted meshes of all plans, by key."""
    if not any(plan.works_on_meshes for plan in plans):
        return {}
    from mjcompose.compose.preview import shapes_for_plans  # few recipes need it

    return shapes_for_plans(plans, context)


def _with_interface(
    lock: Lock, locked: Mapping[str, list[LockedName]], recipe: Path, plan: Plan, context: Context, given: Given
) -> Lock:
    """Return the lock with the interface of the model, and report its differences from the `locked` one, if any."""
    interface = _interface(recipe, plan, context, given)
    if interface is None:
        return lock
    changes = list(interface_changes(locked, interface)) if locked else []
    if changes:
        help = f"to accept the changes, run `mjcompose lock {recipe} --upgrade-interface`"
        message = "the interface differs from the lock"
        context.sink.error("interface-changed", message, notes=list(map(Note, changes)), help=help)
    return lock.model_copy(update={"interface": interface})


def _write(
    before: Lock | None, after: Lock, shapes: dict[str, bytes], recipe: Path, lock_file: Path, context: Context
) -> list[str] | None:
    """Write the lock and converted meshes; return the changes of the lock, or None after reported errors."""
    changes = list(lock_changes(before, after))
    text = to_text(after).encode()
    door = door_of_named(context.folder / recipe)
    if not _may_write(recipe, lock_file, door, context):
        return None
    if not _wrote_shapes(lock_file, shapes, before, context=context):
        return None
    if not os.path.isfile(lock_file) or read_regular(lock_file) != text:
        with context.sink, staged_file(lock_file, rewrites=True, within=door) as stage:
            stage.write_bytes(text)
        if context.sink.errors:
            return None
        changes = changes or [_unseen_change(before, after)]
    return changes


def _may_write(recipe: Path, lock_file: Path, door: Door, context: Context) -> bool:
    """Return whether the lock and the converted meshes may be written, and report the first one that may not."""
    for place in (lock_path(context.folder / recipe), shapes_folder(lock_file)):
        if not door.sees(place):
            message = f"{door.outside(str(place)).message(context.shown)}: nothing is written"
            context.sink.error("output-unwritable", message, help="remove the link, and run the command again")
            return False
    return True


def _unseen_change(before: Lock | None, after: Lock) -> str:
    """Say why the text of the lock changes although its sources do not."""
    if before is None:
        return "no sources to pin"
    return "made with other versions" if before != after else "the same, written again"


def _interface(recipe: Path, plan: Plan, context: Context, given: Given) -> dict[str, list[LockedName]] | None:
    """Return the interface of the compiled model, or None after reported errors."""
    own = replace(context, sink=Sink())
    with Session() as session:
        operand = Operand(str(recipe), OperandKind.RECIPE, context.folder / recipe, context=own)
        side = load_cell(operand, "lock", session, given=given, cell=None)
        found = None if side is None else names_of(side, session, own)
    context.sink.extend(own.sink.errors)
    return None if found is None else locked_interface(plan.interface, found.index)


def _wrote_shapes(lock_file: Path, shapes: dict[str, bytes], before: Lock | None, context: Context) -> bool:
    """Write converted meshes next to the recipe, before the lock lists them; False if that fails."""
    if not shapes and not (before is not None and before.shapes):
        return True
    with context.sink:
        _write_beside(shapes_folder(lock_file), shapes)
        return True
    return False


def _plans_of_cells(recipe: Path, context: Context, given: Given) -> Iterator[Plan]:
    """Yield the plans of cells: the matrix may select sources that the recipe alone does not name."""
    drawn = parameters_choose(read_recipe(context.folder / recipe, context))  # each sample takes time
    for cell in cells_of(recipe, context, dict(given)):
        if cell.sample and not drawn:
            continue  # the nominal model has the same sources
        plan = plan_what_remains(recipe, context, {**given, **cell.given}, name=cell.name, sample=cell.sample)
        if plan is not None:
            yield plan


def _plans_of_variants(recipe: Path, context: Context, given: Given) -> Iterator[Plan]:
    """Yield the plans of all choices of variants, and warn about sources that are out of reach."""
    for choice in choices_of(recipe, context):
        own = replace(context, sink=Sink())
        plan = make_plan(recipe, own, {**given, **choice})
        if plan is not None:
            yield plan
        for each in own.sink.errors:
            if each.code.startswith(OF_FILES):  # out of reach
                context.sink.add(replace(each, severity=Severity.WARNING))


def _wanted(names: tuple[str, ...], lock: Lock | None, context: Context) -> frozenset[str] | None:
    """Return the sources for some names, or None for all."""
    if not names or lock is None:
        return None
    known: dict[str, set[str]] = defaultdict(set)
    for id, locked in lock.sources.items():
        for name in (id, *locked.used_by):
            known[name].add(id)
    for name in (each for each in names if each not in known):
        help = did_you_mean(name, known) or "run `mjcompose lock` for a new part"
        notes = [exists_note("source", known, name)]
        context.sink.error("unknown-name", f"the lock has no source `{name}`", notes=notes, help=help)
    return frozenset(id for name in names if name in known for id in known[name])


def _report_disputes(disputes: Disputed, how: Fetching, context: Context) -> None:
    """Report sources that the two sides of a merge pin differently, for the user to decide."""
    assert how.lock_file is not None
    shown = context.shown(how.lock_file)
    for id, pins in disputes.items():
        message = f"the two sides of the merge in `{shown}` pin `{id}` differently"
        notes = [Note(f"{side}: {pin}") for side, pin in zip(("ours", "theirs"), pins, strict=True)]
        help = f"run `mjcompose lock {how.recipe} --upgrade-source {shlex.quote(id)}`, or choose one side of the merge"
        context.sink.error("lock-invalid", message, notes=notes, help=help)


def _report_changes(before: Lock, after: Lock, fresh: frozenset[str], recipe: Path, context: Context) -> None:
    """Report upstream changes, which are not locked without an explicit request."""
    for id, now in after.sources.items():
        was = before.sources.get(id)
        if was is None or kind_of(was).is_local or id in fresh:
            continue
        there = {name: digest for name, digest in now.files.items() if name in was.files}
        changes = differences({name: digest for name, digest in was.files.items() if name in there}, there)
        if changes:
            help = (
                f"to accept the changes, run `mjcompose lock {recipe} --upgrade-source {shlex.quote(now.used_by[0])}`"
            )
            message = f"`{id}` has other files than the lock pins"
            context.sink.error("source-changed", message, notes=[Note(change) for change in changes[:8]], help=help)


def _write_beside(folder: Path, shapes: Mapping[str, bytes]) -> None:
    """Write these results into a folder next to a recipe, and remove all others. Raises OutputError."""
    from mjcompose.compose.mesh_jobs import shapes_beside  # few recipes need it

    before = shapes_beside(folder)
    if not shapes and not before:
        return
    with writing(folder):
        folder.mkdir(exist_ok=True)
        for key, content in shapes.items():
            path = folder / f"{key}.json"
            if key not in before or read_regular(path) != content:
                with staged_file(path, rewrites=True) as stage:
                    stage.write_bytes(content)
        for key in before.keys() - shapes.keys():
            before[key].unlink(missing_ok=True)
        if not shapes and not any(folder.iterdir()):
            folder.rmdir()
