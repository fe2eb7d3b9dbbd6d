"""From the text of a recipe to a verified bundle. Each stage takes what the one before it gives:

    read       text of the recipe → located tree                 plan/read.py, document/load.py
    merge      trees of it and of what it extends → one tree     plan/read.py, document/merge.py
    expand     parameters, variants, `when`, `${…}` → concrete   plan/concrete.py, expand/expand.py
    validate   concrete tree → `Recipe`                          plan/concrete.py, recipe/validate.py
    resolve    model references → files                          plan/planner.py, sources/resolve.py
    plan       `Recipe` → `Plan`                                 plan/planner.py
    compose    plan → units, on which the recipe's steps act     compose/compose.py
    link       units → one flat tree                             link/link.py, called by compose
    bundle     tree and files → `Bundle`                         bundle/assemble.py
    verify     bundle → MuJoCo's verdict, the recipe's checks    verify/compile_report.py, verify/checks.py
    aim        bundle → what another program reads               targets/aim.py, where a target is asked for

`planned` is the first six, which a recipe that is nested in another goes through too; `built` is the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer import engine
from composer.bundle.assemble import Checked, Making, assemble, described
from composer.bundle.bundle import Bundle
from composer.bundle.renamed import renamed_in
from composer.compose.compose import Composed, Composer
from composer.compose.load import Library
from composer.context import Context
from composer.dataclass import dataclass
from composer.document.node import locate
from composer.link.measure import measure_with
from composer.plan.allowed import acknowledge
from composer.plan.concrete import Given
from composer.plan.locked import check_lock, planned_whole
from composer.plan.plan import Plan
from composer.plan.planner import plan_what_remains

if TYPE_CHECKING:
    from composer.engine import Compiled, Limits, Session
    from composer.link.dedup import Merged
    from composer.link.linking import FileUse
    from composer.verify.outcome import Hear, Outcome


Ahead = Callable[[Bundle], None]


@dataclass(frozen=True, slots=True)
class Built:
    """The result of a build; `compiled` is None if it was not verified, `merged` is empty if no assets were merged."""

    plan: Plan
    composed: Composed
    bundle: Bundle
    compiled: Compiled | None
    merged: Merged


@dataclass(frozen=True, slots=True)
class Request:
    """A request for one model.

    `given` are values of parameters and variants; `name` is that of a cell of the matrix or of a `sample`, whose
    draws the model has. `verified` says whether MuJoCo compiles it, `deduplicated` whether equal assets are merged,
    `pictured` whether the manifest names a picture next to the bundle. `target` is the program that it is written
    for, None for MuJoCo.
    """

    recipe: Path
    given: Given = field(default_factory=dict)
    name: str | None = None
    sample: int = 0
    verified: bool = True
    deduplicated: bool = False
    pictured: bool = False
    target: str | None = None


def build(
    request: Request,
    context: Context,
    *,
    session: Session | None = None,
    limits: Limits | None = None,
    library: Library | None = None,
    hear: Hear | None = None,
) -> Built | None:
    """Return the bundle of a recipe, without writing it, or None if `context.sink` has errors.

    MuJoCo runs in one process: that of `session`, or one with `limits` that ends with the build. `library` has
    source files that were read before; `hear` is called with the outcome of each check.
    """
    plan = planned(request, context)
    if plan is None:
        return None
    with ExitStack() as stack:
        session = session or stack.enter_context(engine.Session(limits))
        return built(plan, request, context, session, library, hear)


def planned(request: Request, context: Context) -> Plan | None:
    """Read, merge, expand, validate, resolve and plan a recipe; return what can be built of it, or None."""
    with context.timed("plan"):
        asked = request.recipe, context, request.given, request.name, request.sample
        return planned_whole(lambda: plan_what_remains(*asked), context)


def built(
    plan: Plan,
    request: Request,
    context: Context,
    session: Session,
    library: Library | None = None,
    hear: Hear | None = None,
    ahead: Ahead | None = None,
) -> Built | None:
    """Compose, link, bundle and verify the model of a plan; return None if `context.sink` has errors.

    `ahead` gets the bundle before MuJoCo does, so that it can process its files in parallel. Warnings that the
    recipes allow are removed from the sink; with `context.strict` the others become errors.
    """
    made = _built(plan, request, context, session, library, hear, ahead)
    alone = request.name is None and request.sample == 0 and not plan.cells
    acknowledge(plan, context.sink, context.shown, whole=request.verified and alone)
    if context.strict:
        context.sink.promote()
    return None if context.sink.has_errors else made


def _built(
    plan: Plan,
    request: Request,
    context: Context,
    session: Session,
    library: Library | None,
    hear: Hear | None,
    ahead: Ahead | None,
) -> Built | None:
    checks: list[Checked] = []

    def note(outcome: Outcome) -> None:
        checks.append(Checked(outcome.name, outcome.kind, outcome.span, outcome.values))
        if hear is not None:
            hear(outcome)

    check_lock(plan, context)
    composer = Composer(
        context, measure_with(context, session=session), session,
        library=library, checks_sources=request.verified,
    )  # fmt: skip
    with context.timed("compose"):
        composed = composer.compose(plan)
    if composed is None:
        return None
    merged: Merged = {}
    if request.deduplicated:
        merged, files = _deduplicated(plan, composed)
        composed = replace(composed, files=files)
    with context.timed("bundle"):
        bundle = assemble(plan, composed.model, composed.files, context)
    if bundle is None:
        return None
    compiled = None
    if request.verified:
        if ahead is not None:
            ahead(bundle)
        compiled = _verified(plan, composed, bundle, context, session, merged, note)
    if composed.tabled and not context.sink.has_errors:
        bundle = _with_worlds(plan, composed, bundle, compiled, context, session, request.deduplicated)
    if context.sink.has_errors:
        return None
    making = Making(
        plan, composed.model, composed.files, composed.members, compiled, merged, tuple(checks), request.name,
        composed.drawn, request.pictured, composed.shapes, composed.tables,
    )  # fmt: skip
    bundle = described(bundle, making, context)
    if request.target is not None:
        aimed = _aimed(bundle, request.target, plan, composed, context, session)
        if aimed is None:
            return None
        bundle = aimed
    return Built(plan, composed, bundle, compiled, merged)


def _aimed(
    bundle: Bundle, target: str, plan: Plan, composed: Composed, context: Context, session: Session
) -> Bundle | None:
    from composer.targets.aim import aimed  # few builds need it

    with context.timed("target"):
        return aimed(bundle, target, composed.model, plan.span, context, session)


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
    """Return MuJoCo's verdict, after running the recipe's checks."""
    from composer.verify.compile_report import judge  # a build without verification has no use for that room
    from composer.verify.compiles import WHOLE
    from composer.verify.kept_keys import check_kept_keys
    from composer.verify.key_ranges import check_key_ranges, check_stiffness
    from composer.verify.nested import checks_in

    with context.timed("compile"):
        compiled = judge(bundle, composed.model, context, session, keep=WHOLE, at=plan.span)
    if compiled is not None:
        if compiled.index is not None:
            check_key_ranges(plan, composed.model, compiled.index, context.sink)
            check_stiffness(composed.model, compiled.index, plan.span, context.sink)
        with context.timed("keys"):
            check_kept_keys(composed.model, composed.keys, session, context.sink)
        with context.timed("check"):
            if next(checks_in(plan), None) is not None:
                from composer.verify.checks import run_checks  # numpy comes along, and every kind of check

                renamed = renamed_in(composed.model, composed.members)
                elsewhere = _of_targets(bundle, plan, session, context)
                size = sum(map(len, bundle.files.values()))
                run_checks(
                    plan,
                    composed.members,
                    session,
                    context,
                    merged,
                    renamed,
                    hear,
                    size=size,
                    elsewhere=elsewhere,
                    made=composed.shapes,
                )
    return compiled


def _of_targets(
    bundle: Bundle, plan: Plan, session: Session, context: Context
) -> Mapping[str, Callable[[dict[str, Any]], Any]]:
    """What carries out the checks about targets, if there is one."""
    from composer.recipe.check import KINDS
    from composer.verify.compiles import WHOLE
    from composer.verify.nested import checks_in

    if not any(KINDS[check.word].of_target for _, check in checks_in(plan)):
        return {}
    from composer.targets.checks import CHECKS, Work  # few recipes have such checks

    work = Work(bundle, WHOLE, session, context.environment)
    return {word: partial(check, work) for word, check in CHECKS.items()}


def _with_worlds(
    plan: Plan,
    composed: Composed,
    bundle: Bundle,
    compiled: Compiled | None,
    context: Context,
    session: Session,
    deduplicated: bool,
) -> Bundle:
    """Return the bundle with the draws of `randomize` and its worlds; some are compared with samples that are built."""
    from composer.verify.compile_report import judge
    from composer.verify.draw_table import CODE, SAMPLE, DrawTable
    from composer.verify.world_table import with_worlds

    if compiled is None:
        help = "build without `--no-verify`, or write `emit: models`"
        span = locate(plan.document, ("randomize", "emit"))
        context.sink.error(
            CODE, "only MuJoCo knows where in the model the draws of worlds go", span, help=help
        )
        return bundle
    table = DrawTable(plan, composed.tabled, session, context)
    if not table.fill():
        return bundle

    def build_sample(number: int) -> bool:
        composer = Composer(context, measure_with(context, session=session), session)
        sample = composer.compose(plan.of_sample(number))
        if sample is None:
            return False
        files = _deduplicated(plan, sample)[1] if deduplicated else sample.files
        made = assemble(plan, sample.model, files, context)
        return (
            made is not None
            and judge(made, sample.model, context, session, keep=SAMPLE, at=plan.span) is not None
        )

    return table.added(with_worlds(table, bundle, build_sample))
