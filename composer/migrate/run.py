"""All that `mjcompose migrate` does but for its options and its words."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection
from contextlib import ExitStack
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.migrate.environments import Other, OtherError, make, open_python, this_python
from composer.migrate.migrate import Migrated, migrate, report
from composer.migrate.proof import Proof, Prover, measured
from composer.migrate.wish import check_installed, installed, known, written_for
from composer.mujoco_errors.message import parse
from composer.scratch import scratch
from composer.sources.error import SourceError
from composer.sources.resolve import resolve
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file

if TYPE_CHECKING:
    from composer.context import Context

_SHOWN = 20
_FOLLOW = frozenset(
    "actuator_acc0 body_invweight0 body_subtreemass cam_poscom0 light_poscom0 dof_M0 dof_invweight0 stat.meaninertia"
    " stat.meanmass stat.meansize stat.center stat.extent tendon_invweight0"
    " geom_rbound".split()
)
"""What MuJoCo computes from masses and places, and is not the same where these are not."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What is asked for. `pythons` have other MuJoCos; with `proves` those that lack are installed."""

    model: str
    before: str | None = None
    after: str | None = None
    adopt: tuple[str, ...] = ()
    pythons: tuple[Path, ...] = ()
    proves: bool = False


@dataclass(slots=True)
class Result:
    """`missing` are the versions that would be needed for a proof; `unexplained` the differences no change tells of."""

    model: Path
    migrated: Migrated
    proof: Proof
    missing: tuple[str, ...] = ()
    explained: list[str] = field(default_factory=list)
    unexplained: list[str] = field(default_factory=list)

    @property
    def is_proved(self) -> bool:
        return self.proof.outcome is not None and self.proof.outcome.same


def run(wish: Wish, context: Context, progress: Callable[[str], None]) -> Result | None:
    """The model as it is to be; None where it cannot be, which is reported. Nothing is written."""
    path = _found(wish.model, context)
    unit = None if path is None else parse_file(path, context.sink, file=context.shown(path))
    if path is None or unit is None or not all_admitted(unit, context.sink, context.shown):
        return None
    check_installed(context)
    after = installed() if wish.after is None else known(wish.after, "--mujoco", context)
    before = None if wish.before is None else known(wish.before, "--from", context)
    others = _opened(wish.pythons, context)
    if context.sink.has_errors or after is None or others is None:
        return None
    before = before or written_for(unit, after, others, context=context)
    if before is None:
        return None
    others.setdefault(installed(), Other(this_python(), installed()))
    if wish.proves and not _installed(others, (before, after), context, progress=progress):
        return None
    with ExitStack() as opened:
        prover = Prover(opened.enter_context(scratch("migrate")), others, progress)
        try:
            values = measured(prover.original(before, path)) if before != after else {}
            migrated = migrate(unit, before, after, context=context, adopt=wish.adopt, values=values)
            if migrated is None:
                return None
            proof = prover.prove(migrated, path) if before != after else Proof()
        except OtherError as error:
            context.sink.error("migrate-python", str(error), help=error.help)
            return None
        missing = tuple(each for each in (before, after) if each not in others)
        result = Result(path, migrated, proof, missing=missing)
        _judge(result, context)
    return None if context.sink.has_errors else result


def _found(model: str, context: Context) -> Path | None:
    """The file that a path or a reference leads to."""
    path = context.folder / model
    if os.path.exists(path):
        return path
    try:
        return resolve(
            model, relative_to=context.folder, environment=context.environment, fetching=context.fetching
        ).path
    except SourceError as error:
        context.sink.add(error.diagnostic)
        return None


def _opened(pythons: Collection[Path], context: Context) -> dict[str, Other] | None:
    found: dict[str, Other] = {}
    for python in pythons:
        try:
            other = open_python(context.folder / python)
        except OtherError as error:
            context.sink.error("migrate-python", str(error), help=error.help)
            return None
        found[other.version] = other
    return found


def _installed(
    others: dict[str, Other], wanted: Collection[str], context: Context, progress: Callable[[str], None]
) -> bool:
    for each in wanted:
        if each in others:
            continue
        try:
            others[each] = make(each, context.environment, progress)
        except (OtherError, OSError) as error:
            context.sink.error("migrate-python", str(error), help=getattr(error, "help", None))
            return False
    return True


def _judge(result: Result, context: Context) -> None:
    """Report what the compilers and the comparison say."""
    migrated, proof = result.migrated, result.proof
    for compiled, whose in ((proof.before, "as it is"), (proof.after, "as it would be migrated")):
        if compiled is not None and compiled.error is not None:
            fault = parse(compiled.error)
            said = " ".join(fault.message.split())
            line = "" if fault.line is None else f" (line {fault.line})"
            named = f" (`{fault.name}`)" if fault.name else ""
            context.sink.error(
                "mujoco-rejects",
                f"MuJoCo {compiled.version} rejects `{context.shown(result.model)}` {whose}: {said}{named}{line}",
                help=_help(compiled is proof.before, migrated),
            )
    outcome = proof.outcome
    report(migrated, context, () if outcome is None else outcome.settled)
    if outcome is None:
        return
    known_arrays = {array for each in migrated.meanings for array in each.arrays} | _of_adopted(migrated)
    if any(each.array in known_arrays for each in outcome.differences):
        known_arrays |= _FOLLOW
    for each in outcome.differences:
        (result.explained if each.array in known_arrays else result.unexplained).append(each.words())
    if result.unexplained:
        several = result.unexplained
        notes = [Note(words) for words in several[:_SHOWN]]
        if len(several) > _SHOWN:
            notes.append(Note(f"and {len(several) - _SHOWN} more"))
        context.sink.warning(
            "migrate-differs",
            f"MuJoCo {migrated.after} does not compile the model that {migrated.before} did:"
            f" {len(several)} array{'s' * (len(several) != 1)} differ{'s' * (len(several) == 1)}",
            notes=notes,
        )


def _of_adopted(migrated: Migrated) -> set[str]:
    from composer.migrate.changes import named

    found = (named(name) for name in migrated.adopted)
    return {array for each in found if each is not None for array in each.arrays}


def _help(is_original: bool, migrated: Migrated) -> str | None:
    if is_original:
        return f"it is not written for {migrated.before}: say another version with `--from`"
    return None
