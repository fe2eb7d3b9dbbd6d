"""Simulate a model in two versions of MuJoCo. Rank the joints that move differently, and find the causing lines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.scratch import scratch
from mjcompose.mujoco.environments import TRIALS, Motion, Moved, Other, RejectedError, differences, other_inertias
from mjcompose.mujoco.programs import ProgramError
from mjcompose.sources.context import Context
from mjcompose.tools.migrate import migrate
from mjcompose.tools.migrate.editing import Meaning, MigrationStep


class UpgradeRequest(Struct):
    """A model and two versions of MuJoCo; `pythons` have some of these versions."""

    model: str
    before: str
    after: str | None
    seconds: float
    tolerance: float
    key: str | None = None
    pythons: tuple[Path, ...] = ()


class Caused(Struct):
    """A joint or body that moves differently, and the edits that would undo it: they remove most of the difference.

    Without `steps`, no edit avoids the difference. Then `suspects` are the meanings that no edit keeps. If there are
    none, solvers or colliders compute differently.
    """

    moved: Moved
    steps: tuple[MigrationStep, ...] = ()
    suspects: tuple[Meaning, ...] = ()

    def data(self) -> dict[str, Any]:
        """Return it for JSON."""
        moved = self.moved
        facts = {name: getattr(moved, name) for name in ("kind", "name", "amount", "unit", "trial", "time")}
        causes = [{**_row(each), "edit": each.words} for each in self.steps]
        suspects = [{**_row(each), "message": each.message} for each in self.suspects]
        return {**facts, "causes": causes, "suspects": suspects}


def _row(each: MigrationStep | Meaning) -> dict[str, str | None]:
    return {"change": each.change, "at": None if each.span is None else str(each.span)}


class Upgrade(Struct):
    """The joints that move differently, the farthest first, and the trials that diverge in either version."""

    before: str
    after: str
    trials: tuple[str, ...]
    moved: tuple[Caused, ...]
    diverged: tuple[str, ...] = ()
    inertias: tuple[str, ...] = ()


def upgrade(request: UpgradeRequest, context: Context, progress: Callable[[str], None]) -> Upgrade | None:
    """Compare the motion of a model in two versions; return None if that fails, which is reported."""
    model = migrate.found_model(request.model, context)
    before = migrate.known(request.before, "--from", context)
    after = migrate.installed() if request.after is None else migrate.known(request.after, "--to", context)
    if model is None or before is None or after is None:
        return None
    try:
        others = migrate.opened(request.pythons, context)
        migrate.gather((before, after), others, context)
        with scratch("upgrade") as folder:
            trials = _Trials(request, model, folder, context=context, others=others, progress=progress)
            one = trials.motion(model, before)
            other = trials.motion(model, after)
            moved = differences(one, other, signal="qpos", tolerance=request.tolerance)
            causes = tuple(trials.causes(one, moved, before, after=after)) if moved else ()
            inertias = tuple(other_inertias(one, other))
    except (ProgramError, OSError) as error:
        help = getattr(error, "help", None)
        if isinstance(error, RejectedError):
            help = f"write the model for it first: `mjcompose migrate {request.model} --from {before} --mujoco {after}`"
        context.sink.error("migrate-python", str(error), help=help)
        return None
    names = tuple(one.answer["trials"])
    diverged = (each for each in names if each in (*one.answer["diverged"], *other.answer["diverged"]))
    return Upgrade(before, after, names, moved=causes, diverged=tuple(diverged), inertias=inertias)


class _Trials:
    """Simulates models in a folder."""

    def __init__(
        self,
        request: UpgradeRequest,
        model: Path,
        folder: Path,
        context: Context,
        *,
        others: Mapping[str, Other],
        progress: Callable[[str], None],
    ) -> None:
        self.request = request
        self.model = model
        self.folder = folder
        self.context = context
        self.others = others
        self.progress = progress
        self.count = 0

    def motion(self, model: Path, version: str) -> Motion:
        """Simulate a model in a version. Raises ProgramError."""
        self.count += 1
        self.progress(f"simulating {model.name} with MuJoCo {version}")
        asked = {"seconds": self.request.seconds, "trials": TRIALS, "key": self.request.key}
        return Motion.of(self.others[version], model, self.folder / f"{self.count}.npz", asked=asked)

    def causes(self, start: Motion, moved: Sequence[Moved], before: str, after: str) -> Iterator[Caused]:
        """Yield each difference with its cause: it undoes each change of MuJoCo alone, and simulates the model."""
        whole = self._migrated(before, after, ())
        steps = () if whole is None else whole.steps
        names = list(dict.fromkeys(step.change for step in steps))
        left: dict[str, dict[tuple[str, str], float]] = {}
        for name in names:
            migrated = self._migrated(before, after, tuple(each for each in names if each != name))
            if migrated is not None:
                folder = self.folder / f"model{self.count}"
                folder.mkdir()
                motion = self.motion(migrate.lay_out(migrated, folder, link=True)[self.model], after)
                found = differences(start, motion, signal="qpos", tolerance=self.request.tolerance)
                left[name] = {(each.name, each.unit): each.amount for each in found}
        for each in moved:
            amounts = {name: found.get((each.name, each.unit), 0.0) for name, found in left.items()}
            best = min(amounts, key=amounts.__getitem__, default=None)
            is_cause = best is not None and amounts[best] < each.amount / 2
            caused = tuple(step for step in steps if is_cause and step.change == best)
            yield Caused(each, caused, () if caused or whole is None else whole.meanings)

    def _migrated(self, before: str, after: str, adopt: tuple[str, ...]) -> migrate.Migrated | None:
        """Return the model for the new version without the adopted changes, or None if there is none."""
        context = Context(environment=self.context.environment, folder=self.context.folder)
        unit = migrate.read(self.model, context)
        return None if unit is None else migrate.migrate(unit, before, after, context=context, adopt=adopt)
