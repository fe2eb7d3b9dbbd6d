"""The check `unchanged`: a part is the same as its source alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import advised
from mjcompose.language.check import Check
from mjcompose.language.forms.scalars import Checked, Expects, Items, Name, Text
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.text.node import locate
from mjcompose.tree.grammar import GRAMMAR

if TYPE_CHECKING:
    from mjcompose.build.verify.checks import Checks, NestedRecipe
    from mjcompose.build.verify.parts import PartComparison
    from mjcompose.mujoco.match import Difference
    from mjcompose.sources.context import Context

OF_THE_WHOLE = frozenset("compiler option size statistic visual extension".split())
"""Sections that are not a part's."""
OWN = frozenset({"class", "childclass", "name", "file"})
"""Attributes that a compiled model does not have as such: they cannot be excepted."""


def attributes() -> list[str]:
    """Return every attribute of MJCF that an element of a model can have, sorted."""
    sections = [tag for tag in GRAMMAR.root.children if tag not in OF_THE_WHOLE]
    kinds = [kind for tag in sections for kind in GRAMMAR.within(tag).values()]
    return sorted({name for kind in kinds for name in kind.attributes} - OWN)


def _known(name: str) -> Fault | None:
    known = attributes()
    if name in known:
        return None
    help, fix = advised(name, known)
    return Fault("unknown-attribute", f"MJCF has no attribute `{name}` that could be excepted", help=help, fix=fix)


_Attribute = Annotated[Text, Checked(_known), Expects("an attribute of MJCF")]


class Unchanged(Check):
    """A part is identical to its source compiled alone."""

    word: ClassVar = "unchanged"
    is_in_mujoco: ClassVar = False
    example: ClassVar = "{}"

    part: Annotated[str, Name("part", what="the prefix of a part")] | None = None
    """the prefix of the part, or `base`; by default all parts"""
    excepted: Annotated[tuple[_Attribute, ...], Items(), Expects("a list of attributes", "[gravcomp]")] = Field(
        (), alias="except"
    )
    """MJCF attributes that you change on purpose"""


KIND = Unchanged


def run(checks: Checks, check: Unchanged, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Compare each source of the part, by its name in the outermost recipe, and return the number of sources."""
    from mjcompose.build.plan.plan import of_part

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
    from mjcompose.build.verify.parts import change_sentence, difference_notes

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
    from mjcompose.build.verify.parts import causes
    from mjcompose.mujoco.match import EXTRA, MISSING

    found = [None if each.field in (MISSING, EXTRA) else _attribute(each) for each in causes(compared.differences)]
    names = [name for name in (*check.excepted, *found) if name is not None]
    return None if None in found else f"to accept it, write `except: [{', '.join(dict.fromkeys(names))}]`"


def _attribute(difference: Difference) -> str | None:
    end = difference.array.partition("_")[2]
    known = attributes()
    if end in known:
        return end
    return next((name for name in known if end in arrays_of(name) or difference.array in arrays_of(name)), None)
