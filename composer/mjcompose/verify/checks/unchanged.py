"""The check `unchanged`: a part is the same as its source alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mjcompose.language.checks.unchanged import Unchanged, attributes
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.text.node import locate

if TYPE_CHECKING:
    from mjcompose.mujoco.match import Difference
    from mjcompose.sources.context import Context
    from mjcompose.verify.parts import PartComparison
    from mjcompose.verify.run_checks import Checks, NestedRecipe


def run(checks: Checks, check: Unchanged, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Compare each source of the part, by its name in the outermost recipe, and return the number of sources."""
    from mjcompose.plan.plan import of_part

    excused = [*checks.drawn, *(array for name in check.excepted for array in arrays_of(name))]
    if check.part:
        sources = of_part(checks.members, recipe.part + check.part, recipe.plan.separator)
    else:
        sources = [member for member in checks.members if member.part.startswith(recipe.part)]
    for source in sources:
        compared = checks.comparer.compare(source, excused)
        if not compared.ok:
            _report(compared, recipe, check, context=context)
    return {"parts": len(sources)}


def _report(compared: PartComparison, recipe: NestedRecipe, check: Unchanged, context: Context) -> None:
    from mjcompose.verify.parts import change_sentence, difference_notes

    path = check.at
    span = locate(recipe.plan.document, (*path, "part") if check.part else path, key=check.part is None)
    about = f"check `{recipe.part}{check.name}`"
    if compared.obscure is not None:
        message = f"{about}: `{compared.member.called}` cannot be compared with its source: {compared.obscure}"
        context.sink.error("part-not-compared", message, span)
        return
    message = f"{about}: {change_sentence(compared)}"
    context.sink.error(
        "part-changed", message, span, notes=difference_notes(compared.differences), help=_excepting(compared, check)
    )


def _excepting(compared: PartComparison, check: Unchanged) -> str | None:
    """Return the line that accepts all differences, or None if one of them belongs to no attribute."""
    from mjcompose.mujoco.match import EXTRA, MISSING
    from mjcompose.verify.parts import causes

    found = [None if each.field in (MISSING, EXTRA) else _attribute(each) for each in causes(compared.differences)]
    names = [name for name in (*check.excepted, *found) if name is not None]
    return None if None in found else f"to accept it, write `except: [{', '.join(dict.fromkeys(names))}]`"


def _attribute(difference: Difference) -> str | None:
    end = difference.array.partition("_")[2]
    known = attributes()
    if end in known:
        return end
    return next((name for name in known if end in arrays_of(name) or difference.array in arrays_of(name)), None)
