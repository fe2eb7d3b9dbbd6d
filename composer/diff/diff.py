"""Compile A and B in one child process, and compare them there by name."""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer import engine
from composer.context import Context
from composer.diff.cause import Causes
from composer.diff.change import Change, Contrast, Diff
from composer.diff.grouping import grouped
from composer.diff.models import contrast, contrast_of
from composer.diff.operand import Kind, read_operand
from composer.diff.renders import render_views
from composer.diff.side import Side, load
from composer.plan.concrete import Given

if TYPE_CHECKING:
    from composer.engine import Session

ADDRESSES, COUNTS = "address", "count"


def diff(
    a: str,
    b: str,
    context: Context,
    session: Session,
    *,
    tolerance: float = 0.0,
    only: Collection[str] = (),
    everything: bool = False,
    given: Given | None = None,
    pick: str | None = None,
    sample: int | None = None,
    renders: Path | None = None,
    show: Callable[[Side, Side, Diff], object] | None = None,
) -> Diff | None:
    """Return the differences from A to B, or None if one of them is not a model, which goes to `context.sink`.

    `tolerance` is relative. `only` are kinds of element, `option`, `visual`, `statistic`, `count` and `address`;
    empty means all. `everything` also lists changes that follow from others, instead of only counting them. `given`
    are values of parameters and variants for a recipe, `pick` is a cell of its matrix, `sample` one of its samples.
    Pictures of both go to the folder `renders`; the session must be able to render. `show` is called while the
    session keeps both models.
    """
    with ExitStack() as opened:
        operands = [read_operand(text, context, opened) for text in (a, b)]
        known = [operand.kind for operand in operands if operand is not None]
        asked = given or pick is not None or sample is not None
        if asked and len(known) == 2 and Kind.RECIPE not in known:
            what = f"the cell `{pick}`" if pick is not None else f"the sample {sample}"
            what = f"a value for `{next(iter(given))}`" if given else what
            context.sink.error("unknown-name", f"{what} is asked for, and neither `{a}` nor `{b}` is a recipe",
                               help="compare the recipe, or the bundle that it gives with these options")  # fmt: skip
            return None
        sides: list[Side] = []
        for operand, kept in zip(operands, ("diff a", "diff b"), strict=True):
            if operand is None:
                continue
            side = load(operand, kept, session, given=given, pick=pick, sample=sample)
            if side is None or operand.context.sink.has_errors:
                operand.report(context.sink)
            elif side is not None:
                sides.append(side)
        if len(sides) < 2:
            return None
        first, second = sides
        found = between(
            first, second, context, session=session, tolerance=tolerance, only=only, everything=everything
        )
        if found is not None and renders is not None:
            views = render_views(renders, (first.kept, second.kept), context, session=session)
            found = replace(found, views=views)
        if found is not None and show is not None:
            show(first, second, found)
        return None if context.sink.has_errors else found


def between(
    a: Side,
    b: Side,
    context: Context,
    session: Session,
    *,
    tolerance: float = 0.0,
    only: Collection[str] = (),
    everything: bool = False,
) -> Diff | None:
    """Return the differences between two models that the session keeps, or None if MuJoCo crashes.

    A crash is reported.
    """
    answer = engine.call(session, contrast, [a.kept, b.kept], argument={"tolerance": tolerance})
    if not answer.ok:
        said = answer.error or answer.crash
        message = f"`{a.operand.label}` and `{b.operand.label}` cannot be compared: {said}"
        context.sink.error("mujoco-crash", message)
        return None
    return _diff(contrast_of(answer.value), a, b, tolerance=tolerance, only=only, everything=everything)


def _diff(
    found: Contrast, a: Side, b: Side, tolerance: float, only: Collection[str], everything: bool
) -> Diff:
    causes = Causes(a, b, found)
    found = _narrowed(found, tolerance, only)
    follows = [each for each in found.changes if each.follows]
    wanted = [each for each in found.changes if not each.follows]
    if everything or not (wanted or found.moves or found.counts):
        wanted, follows = list(found.changes), []
    groups = grouped(wanted, causes, a, b=b)
    paths = sorted({*a.digests, *b.digests})
    files = tuple(path for path in paths if a.digests.get(path) != b.digests.get(path))
    return Diff(a.end, b.end, found, groups=tuple(groups), files=files, follows=len(follows))


def _narrowed(found: Contrast, tolerance: float, only: Collection[str]) -> Contrast:
    """Return what was asked for. Arrays without a name of their own count only in a comparison to the bit."""
    if not only:
        return found if tolerance == 0 else replace(found, arrays=())

    def fits(change: Change) -> bool:
        return change.kind.partition("/")[0] in only

    return replace(
        found,
        changes=tuple(each for each in found.changes if fits(each)),
        moves=found.moves if ADDRESSES in only else (),
        counts=found.counts if COUNTS in only else (),
        arrays=(),
    )
