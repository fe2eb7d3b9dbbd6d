"""From the text of a recipe to a verified bundle. Each stage takes the result of the stage before it:

    read       text of the recipe → located tree                 plan/read.py, text/load.py
    merge      its tree and the trees that it extends → one      plan/read.py, text/merge.py
    expand     parameters, variants, `when`, `${…}` → concrete   plan/read.py, language/expand.py
    validate   concrete tree → `Recipe`                          plan/read.py, language/validate.py
    resolve    model references → files                          plan/planner.py, sources/lock.py
    plan       `Recipe` → `Plan`                                 plan/planner.py
    compose    plan → units, on which the recipe's steps act     compose/compose.py
    link       units → one flat tree                             link/link.py, called by compose
    bundle     tree and files → `Bundle`                         bundle/assemble.py
    verify     bundle → MuJoCo's verdict, the recipe's checks    verify/compile.py, verify/checks.py
    aim        bundle → files for another program                targets/export.py, if there is a target

`planned` is the first six, which nested recipes go through too; `Build` is the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import field, replace
from functools import partial
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import log
from mjcompose.bundle.assemble import add_manifest, assemble, renamed_in
from mjcompose.bundle.bundle import Bundle, CheckOutcome
from mjcompose.compose.compose import Composed, ComposeOptions, Composer
from mjcompose.compose.interface import check_index, check_locked_interface
from mjcompose.compose.load import Library
from mjcompose.link.measure import measure_with
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Compiled, RequestLimits, Session
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.locked import check_lock, plan_with_intact_store
from mjcompose.plan.plan import Plan
from mjcompose.plan.planner import plan_what_remains
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.text.node import locate


class Built(Struct):
    """The result of a build. `compiled` is None if it was not verified."""

    plan: Plan
    composed: Composed
    bundle: Bundle
    compiled: Compiled | None


class ModelRequest(Struct):
    """A request for one model.

    `given` are values of parameters and variants; `name` is the name of a cell or of a `sample`, whose draws it has.
    MuJoCo compiles it if `verified`. Equal assets are merged if `deduplicated`, the manifest names a picture if
    `pictured`, and samples can become `worlds`. `target` is the program that reads it, or None for MuJoCo.
    """

    recipe: Path
    given: Given = field(default_factory=dict)
    name: str | None = None
    sample: int = 0
    verified: bool = True
    deduplicated: bool = False
    pictured: bool = False
    target: str | None = None
    worlds: bool = False


def build(
    request: ModelRequest,
    context: Context,
    *,
    session: Session | None = None,
    limits: RequestLimits | None = None,
    library: Library | None = None,
    outcomes: list[CheckOutcome] | None = None,
) -> Built | None:
    """Return the bundle of a recipe, unwritten, or None after errors. MuJoCo runs in `session`, or within `limits`."""
    plan = planned(request, context)
    if plan is None:
        return None
    outcomes = [] if outcomes is None else outcomes
    with nullcontext(session) if session else engine.Session(limits) as own:
        return Build(plan, request, context, session=own, library=library, outcomes=outcomes).run()


def planned(request: ModelRequest, context: Context) -> Plan | None:
    """Read, merge, expand, validate, resolve and plan a recipe; return a plan without its faulty pieces, or None."""
    with context.timed("plan"):
        plan = partial(plan_what_remains, name=request.name, sample=request.sample, worlds=request.worlds)
        return plan_with_intact_store(lambda: plan(request.recipe, context, request.given), context)


class _Draft(Struct):
    """A composed model and its bundle, which MuJoCo has not seen."""

    composed: Composed
    bundle: Bundle


class Build(Struct, frozen=False):
    """One build of a planned model; `on_bundle` gets the bundle before MuJoCo gets it, to work in parallel."""

    plan: Plan
    request: ModelRequest
    context: Context
    session: Session
    library: Library | None = None
    outcomes: list[CheckOutcome] = field(default_factory=list)
    on_bundle: Callable[[Bundle], None] | None = None

    def run(self) -> Built | None:
        """Compose, link, bundle and verify the model, without allowed warnings; `strict` makes others errors."""
        plan = self.plan
        request = self.request
        context = self.context
        log("building `%s` from %s", plan.name, plan.file)
        built = self._build()
        alone = request.name is None and request.sample == 0 and not plan.cells
        acknowledge(plan, context.sink, context.shown, whole=request.verified and alone)
        if context.strict:
            context.sink.promote()
        if built is None or context.sink.has_errors:
            log("`%s` has %d errors", plan.name, context.sink.error_count)
            return None
        log("built `%s`: %d files", plan.name, len(built.bundle.files))
        return built

    def _build(self) -> Built | None:
        context = self.context
        request = self.request
        check_lock(self.plan, context)
        measure = measure_with(context, session=self.session)
        options = ComposeOptions(checks_sources=request.verified, deduplicates=request.deduplicated)
        composer = Composer(context, measure, self.session, library=self.library, options=options)
        draft = self._draft(self.plan, composer)
        if draft is None:
            return None
        composed = draft.composed
        bundle = draft.bundle
        compiled = None
        if request.verified:
            if self.on_bundle is not None:
                self.on_bundle(bundle)
            compiled = self._verify(draft)
        if composed.tabled and not context.sink.has_errors:
            bundle = self._with_worlds(draft, compiled)
        if context.sink.has_errors:
            return None
        bundle = add_manifest(
            bundle,
            self.plan,
            composed,
            compiled,
            context,
            checks=self.outcomes,
            cell=request.name,
            has_picture=request.pictured,
            deduplicated=request.deduplicated,
        )
        final = self._exported(bundle, composed)
        return None if final is None else Built(self.plan, composed, final, compiled=compiled)

    def _draft(self, plan: Plan, composer: Composer) -> _Draft | None:
        """Compose, link and bundle a plan: the plan of the model, or of one of its samples."""
        context = composer.context
        with context.timed("compose"):
            composed = composer.compose(plan)
        if composed is None:
            return None
        with context.timed("bundle"):
            bundle = assemble(plan, composed.model, composed.files, context, terrain=composed.terrain)
        return None if bundle is None else _Draft(composed, bundle)

    def _verify(self, draft: _Draft) -> Compiled | None:
        # A build without verification does not need these.
        from mjcompose.verify.compile import WHOLE, compile_and_report
        from mjcompose.verify.kept_keys import check_kept_keys, check_key_ranges, check_stiffness
        from mjcompose.verify.run_checks import Checks, checks_in

        plan = self.plan
        composed = draft.composed
        context = self.context
        session = self.session
        with context.timed("compile"):
            compiled = compile_and_report(
                draft.bundle, composed.model, context, session=session, keep=WHOLE, at=plan.span
            )
        if compiled is None:
            return None
        if compiled.index is not None:
            check_index(plan, compiled.index, sink=context.sink)
            if self.request.name is None and not self.request.sample and not self.request.given:
                check_locked_interface(plan, compiled.index, context)
            check_key_ranges(plan, composed.model, compiled.index, sink=context.sink)
            check_stiffness(composed.model, compiled.index, plan.span, sink=context.sink)
        with context.timed("keys"):
            check_kept_keys(composed.model, composed.keys, session, sink=context.sink)
        if any(source.format == "mesh" for source in plan.sources()):
            from mjcompose.verify.mesh_masses import check_mesh_masses  # few recipes have meshes as parts

            check_mesh_masses(plan, composed.model, session, sink=context.sink)
        if composed.model.origins.values:
            from mjcompose.verify.frictions import check_frictions  # few recipes change frictions

            check_frictions(composed.model, session, sink=context.sink)
        if any(each.measured is not None for each in plan.plans()):
            from mjcompose.verify.measured import check_measured  # few recipes have a file of measurements

            check_measured(plan, session, sink=context.sink)
        with context.timed("check"):
            if next(checks_in(plan), None) is not None:
                Checks(
                    plan=plan,
                    members=composed.members,
                    session=session,
                    context=context,
                    merged=composed.merged,
                    renamed=renamed_in(composed.model, composed.members),
                    bundle=draft.bundle,
                    shapes=composed.shapes,
                ).run(self.outcomes)
        return compiled

    def _with_worlds(self, draft: _Draft, compiled: Compiled | None) -> Bundle:
        """Return the bundle with the draws of `randomize` and its worlds; compare some worlds with samples."""
        from mjcompose.verify.draws import CODE, DrawTable, with_worlds

        plan = self.plan
        context = self.context
        if compiled is None:
            help = "build without `--no-compile`, or without `--as worlds`"
            span = locate(plan.document, ("randomize",), key=True)
            context.sink.error(CODE, "the draws of worlds need the model that MuJoCo compiles", span, help=help)
            return draft.bundle
        table = DrawTable(plan, draft.composed.tabled, self.session, context=context)
        return table.added(with_worlds(table, draft.bundle, self._keep_sample)) if table.fill() else draft.bundle

    def _keep_sample(self, number: int) -> bool:
        """Build a sample, compile it, and have the session keep it. Return whether it has no errors."""
        from mjcompose.verify.compile import compile_and_report
        from mjcompose.verify.draws import SAMPLE

        context = replace(self.context, timings=[])  # the timings of the model do not include samples
        options = ComposeOptions(deduplicates=self.request.deduplicated)
        composer = Composer(context, measure_with(context, session=self.session), self.session, options=options)
        sample = self._draft(self.plan.of_sample(number), composer)
        if sample is None:
            return False
        model = sample.composed.model
        at = self.plan.span
        return compile_and_report(sample.bundle, model, context, session=self.session, keep=SAMPLE, at=at) is not None

    def _exported(self, bundle: Bundle, composed: Composed) -> Bundle | None:
        if self.request.target is None:
            return bundle
        from mjcompose.targets.export import aimed  # few builds need it

        with self.context.timed("target"):
            target = self.request.target
            at = self.plan.span
            return aimed(bundle, target, composed.model, at=at, context=self.context, session=self.session)
