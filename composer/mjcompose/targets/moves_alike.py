"""The check `moves_alike`: the model moves in another program, or in another version of MuJoCo, as it does here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.report import with_rest
from mjcompose.base.scratch import scratch
from mjcompose.language.checks.moves_alike import MUJOCO, MovesAlike
from mjcompose.tree.history import release
from mjcompose.verify.checks.check import SOLVED, failed

if TYPE_CHECKING:
    from mjcompose.mujoco.environments import Moved
    from mjcompose.sources.context import Context
    from mjcompose.verify.run_checks import Checks, NestedRecipe


def run(checks: Checks, check: MovesAlike, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Simulate the model here and there; report joints and bodies that move differently to the context."""
    from mjcompose.verify.run_checks import report

    is_mujoco = check.program.startswith(MUJOCO)
    found, values = _in_mujoco(checks, check, context) if is_mujoco else _there(checks, check)
    for finding in found:
        report(finding, check, recipe, context=context)
    return values


def _in_mujoco(checks: Checks, check: MovesAlike, context: Context) -> tuple[list[Fault], dict[str, Any]]:
    from mjcompose.mujoco.environments import TRIALS, Motion, Other, UnknownKeyError, differences, kept, this_python
    from mjcompose.mujoco.programs import MissingError, ProgramError

    version = release(check.program.removeprefix(MUJOCO)) or ""
    question = {"seconds": check.seconds, "trials": TRIALS, "key": check.key}
    try:
        own = Other(this_python(), checks.session.mujoco_version or "")
        other = own if version == own.version else kept(version, context.environment)
        with scratch("moves") as folder:
            for name, content in checks.bundle.files.items():
                (folder / "model" / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / "model" / name).write_bytes(content)
            model = folder / "model" / checks.bundle.model
            there, here = (
                Motion.of(program, model, folder / f"{n}.npz", asked=question) for n, program in enumerate((other, own))
            )
            moved = differences(there, here, signal=check.signal, tolerance=check.tol)
    except UnknownKeyError as error:
        return [Fault("unknown-name", str(error), ("key",), help=error.help)], {}
    except MissingError as error:
        return [Fault("consumer-missing", str(error), ("as",), help=error.help)], {}
    except ProgramError as error:
        return [Fault("check-failed", str(error), ("as",), help=error.help)], {}
    wild = sorted({*there.answer["diverged"], *here.answer["diverged"]})
    if wild:
        return [
            failed(f"the simulation diverges in `{wild[0]}`", "a simulation without NaN", f"{len(wild)} diverge")
        ], {}
    faults = [_apart(check, f"MuJoCo {other.version}", moved)] if moved else []
    return faults, {"apart": round(moved[0].amount, SOLVED) if moved else 0.0}


def _there(checks: Checks, check: MovesAlike) -> tuple[list[Fault], dict[str, Any]]:
    from mjcompose.mujoco.environments import Moved
    from mjcompose.targets.read_back import Work, motion_in
    from mjcompose.verify.compile import WHOLE

    if check.signal != "qpos":
        return [Fault("wrong-keyword", f"only `qpos` can be compared with {check.program}", ("signal",))], {}
    work = Work(checks.bundle, WHOLE, checks.session, environment=checks.context.environment)
    ends = motion_in(work, check.program, check.seconds)
    if isinstance(ends, Fault):
        return [ends], {}
    here, there = ends
    if here.keys().isdisjoint(there):
        message = f"no hinge or slide with a name moves both here and in {check.program}: nothing can be compared"
        return [Fault("check-failed", message, ("as",))], {}
    moved = [
        Moved("joint", name, abs(there[name] - end), unit="m or rad", trial="motion without forces", time=check.seconds)
        for name, end in here.items()
        if name in there and abs(there[name] - end) > check.tol
    ]
    moved.sort(key=lambda each: -each.amount)
    found = [_apart(check, check.program, moved)] if moved else []
    return found, {"apart": round(moved[0].amount, SOLVED) if moved else 0.0}


def _apart(check: MovesAlike, program: str, moved: Sequence[Moved]) -> Fault:
    first, *more = with_rest([each.words for each in moved])
    message = f"the model moves differently in {program}: {first}"
    unit = moved[0].unit
    found = failed(message, f"at most {check.tol:g} {unit}", f"{moved[0].amount:.4g} {unit}", more=more)
    return replace(found, at=("tol",))
