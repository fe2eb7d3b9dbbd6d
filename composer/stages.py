"""From a recipe to a verified bundle: the stages in order. Each takes what the one before it gives."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer import engine
from composer.bundle.assemble import Checked, Making, assemble, described
from composer.bundle.bundle import Bundle
from composer.bundle.renamed import renamed_in
from composer.compose.compose import Composed, Composer
from composer.compose.load import Library
from composer.context import Context
from composer.document.node import locate
from composer.link.measure import measure_with
from composer.plan.concrete import Given
from composer.plan.locked import check_lock
from composer.plan.plan import Plan
from composer.plan.planner import plan_what_remains

if TYPE_CHECKING:
    from composer.engine import Compiled, Limits, Session
    from composer.link.dedup import Merged
    from composer.link.linking import FileUse
    from composer.verify.outcome import Hear, Outcome


@dataclass(frozen=True, slots=True)
class Built:
    """What a build gives; `compiled` is None where nothing was verified, `merged` empty where nothing was merged."""

    plan: Plan
    composed: Composed
    bundle: Bundle
    compiled: Compiled | None
    merged: Merged


def build(
    recipe: Path,
    context: Context,
    *,
    verified: bool = True,
    deduplicated: bool = False,
    limits: Limits | None = None,
    session: Session | None = None,
    given: Given | None = None,
    name: str | None = None,
    sample: int = 0,
    plan: Plan | None = None,
    library: Library | None = None,
    hear: Hear | None = None,
) -> Built | None:
    """The bundle of a recipe, nothing written yet; None where `context.sink` has errors.

    `given` are values of parameters and variants, `name` that of a cell of the matrix or of a sample, whose draws it
    has; a `plan` was made of them already. `library` has source files that were read before; `hear` is told what came
    of each check. All that MuJoCo does is done in one process: that of `session`, or one with `limits` that ends with
    the build.
    """
    plan = plan or plan_what_remains(recipe, context, given, name, sample)
    if plan is None:
        return None
    checks: list[Checked] = []

    def note(outcome: Outcome) -> None:
        checks.append(Checked(outcome.name, outcome.kind, outcome.span, outcome.values))
        if hear is not None:
            hear(outcome)

    with ExitStack() as stack:
        session = session or stack.enter_context(engine.Session(limits))
        check_lock(plan, context)
        composer = Composer(context, measure_with(context, session=session), session, library=library)
        if (composed := composer.compose(plan)) is None:
            return None
        merged: Merged = {}
        if deduplicated:
            merged, files = _deduplicated(plan, composed)
            composed = replace(composed, files=files)
        if (bundle := assemble(plan, composed.model, composed.files, context)) is None:
            return None
        compiled = _verified(plan, composed, bundle, context, session, merged, note) if verified else None
        if composed.tabled and not context.sink.has_errors:
            bundle = _with_table(plan, composed, bundle, compiled, context, session, deduplicated)
    if context.sink.has_errors:
        return None
    making = Making(
        plan, composed.model, composed.files, composed.members, compiled, merged, tuple(checks), name,
        composed.drawn,
    )  # fmt: skip
    bundle = described(bundle, making, context)
    return Built(plan, composed, bundle, compiled, merged)


def _deduplicated(plan: Plan, composed: Composed) -> tuple[Merged, tuple[FileUse, ...]]:
    from composer.link.dedup import dedup  # few builds need it

    return dedup(composed.model, composed.files, plan.prefixes)


def _verified(
    plan: Plan,
    composed: Composed,
    bundle: Bundle,
    context: Context,
    session: Session,
    merged: Merged,
    hear: Hear,
) -> Compiled | None:
    """MuJoCo's verdict, and the recipe's checks."""
    from composer.verify.checks import run_checks  # a build without verification has no use for that room
    from composer.verify.compile_report import judge
    from composer.verify.key_ranges import check_key_ranges
    from composer.verify.parts import WHOLE

    compiled = judge(bundle, composed.model, context, session, keep=WHOLE)
    if compiled is not None:
        if compiled.index is not None:
            check_key_ranges(plan, composed.model, compiled.index, context.sink)
        renamed = renamed_in(composed.model, composed.members)
        run_checks(plan, composed.members, session, context, merged, renamed, hear)
    return compiled


def _with_table(
    plan: Plan,
    composed: Composed,
    bundle: Bundle,
    compiled: Compiled | None,
    context: Context,
    session: Session,
    deduplicated: bool,
) -> Bundle:
    """The bundle with the table of what `randomize` draws, checked against one sample that is built."""
    from composer.verify.compile_report import judge
    from composer.verify.draw_table import CODE, SAMPLE, DrawTable

    if compiled is None:
        help = "build without `--no-verify`, or write `emit: models`"
        span = locate(plan.document, ("randomize", "emit"))
        context.sink.error(
            CODE, "only MuJoCo knows where in the model the draws of a table go", span, help=help
        )
        return bundle
    table = DrawTable(plan, composed.tabled, session, context)
    if not table.fill():
        return bundle
    sample = Composer(context, measure_with(context, session=session), session).compose(plan.of_sample(1))
    if sample is None:
        return bundle
    files = _deduplicated(plan, sample)[1] if deduplicated else sample.files
    made = assemble(plan, sample.model, files, context)
    if made is not None and judge(made, sample.model, context, session, keep=SAMPLE) is not None:
        table.compare()
    return table.added(bundle)
