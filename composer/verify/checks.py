"""The checks of a recipe on the model that was built, and of the recipes in it, told where they are written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from composer import engine
from composer.context import Context
from composer.document.node import locate
from composer.link.dedup import Merged
from composer.plan.member import BASE, Member, called, of_part
from composer.plan.plan import Plan
from composer.recipe.check import Unchanged, attributes
from composer.verify.difference import EXTRA, MISSING, Difference
from composer.verify.excuses import arrays_of
from composer.verify.parts import Compared, Judge
from composer.verify.report import causes, changed, notes


def run_checks(
    plan: Plan, members: Sequence[Member], session: engine.Session, context: Context, merged: Merged
) -> None:
    """Run every check on the model that the session keeps; what does not hold goes to the sink."""
    judge = Judge(session, merged)
    for inner, check, part in _checks(plan, ""):
        excused = [array for name in check.excepted for array in arrays_of(name)]
        for member in of_part(members, part, plan.separator):
            compared = judge.compare(member, excused)
            if not compared.ok:
                _tell(compared, inner, check, context)


def _checks(plan: Plan, outer: str) -> Iterator[tuple[Plan, Unchanged, str | None]]:
    """Each check with its recipe and the part it is about as the outermost recipe calls it."""
    for check in plan.checks:
        yield plan, check, outer + check.part if check.part else outer.removesuffix(plan.separator) or None
    pieces = [(BASE, plan.base.model), *((called(part, plan.separator), part.model) for part in plan.parts)]
    for name, model in pieces:
        if isinstance(model, Plan):
            yield from _checks(model, f"{outer}{name}{plan.separator}")


def _tell(compared: Compared, plan: Plan, check: Unchanged, context: Context) -> None:
    path = (*check.at, "unchanged")
    span = locate(plan.document, (*path, "part") if check.part else path, key=check.part is None)
    about = f"check `{check.name}`"
    if compared.obscure is not None:
        message = (
            f"{about}: `{compared.member.called}` cannot be compared with its source: {compared.obscure}"
        )
        context.sink.error("part-not-compared", message, span)
        return
    message = f"{about}: {changed(compared)}"
    context.sink.error(
        "part-changed", message, span, notes=notes(compared.differences), help=_excepting(compared, check)
    )


def _excepting(compared: Compared, check: Unchanged) -> str | None:
    """The line to write if all of that is meant; None where no attribute can be named for it."""
    names = list(check.excepted)
    for each in causes(compared.differences):
        if each.field in (MISSING, EXTRA):
            return None
        if (name := _attribute(each)) is None:
            return None
        names.append(name)
    listed = ", ".join(dict.fromkeys(names))
    return f"if that is meant, write `except: [{listed}]`"


def _attribute(difference: Difference) -> str | None:
    """An attribute of MJCF from which the array follows."""
    end = difference.array.partition("_")[2]
    known = attributes()
    if end in known:
        return end
    return next(
        (name for name in known if end in arrays_of(name) or difference.array in arrays_of(name)), None
    )
