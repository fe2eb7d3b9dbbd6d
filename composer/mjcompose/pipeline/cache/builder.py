"""Build the models of a recipe, unless the cache has them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from mjcompose.base.diagnostic import Severity, log
from mjcompose.base.files import STDIN
from mjcompose.bundle.bundle import MANIFEST, Bundle, CheckOutcome, LicenseRow, Location, license_rows
from mjcompose.pipeline.cache.cache import LOST, Cache, CacheAnswer, Facts, KeptFile, KeptRecipe, Record
from mjcompose.pipeline.cache.cache_key import BuildOptions, CacheKey, now
from mjcompose.sources.blobs import key_of
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.bundle.write import BackgroundPacker, Packed
    from mjcompose.compose.load import Library
    from mjcompose.link.linking import FileUse
    from mjcompose.mujoco.engine import Session
    from mjcompose.pipeline.cache.inputs import Inputs
    from mjcompose.pipeline.stages import Built
    from mjcompose.plan.plan import Plan
    from mjcompose.text.node import Node
    from mjcompose.tree.unit import Unit


class BuildResult(Facts, kw_only=True):
    """A built model.

    `built` is set for a model that was built now, `record` for one from the cache, which has only the data that its
    output needs: `packed` for archives, `text`, `bundle` for folders and MuJoCo's binary form, nothing if it
    `is_written`. `why` is the reason that the cache did not have it, and `replaced` says how the origin of the previous
    output differs.
    """

    built: Built | None = None
    record: Record | None = None
    bundle: Bundle | None = None
    packed: Mapping[str, Packed] = field(default_factory=dict)
    text: bytes | None = None
    is_written: bool = False
    why: tuple[str, ...] = ()
    key: CacheKey | None = None
    inputs: tuple[str, ...] = ()
    replaced: Mapping[str, Any] = field(default_factory=dict)
    is_new: bool = False

    def summary(self) -> BuildResult:
        """Return the model without the data for writing it, small enough to pickle."""
        return replace(self, built=None, record=None, bundle=None, packed={}, text=None, key=None, inputs=())


def result_of_build(
    built: Built, licenses: Iterable[LicenseRow], why: tuple[str, ...], key: CacheKey | None
) -> BuildResult:
    from mjcompose.plan.describe import allowed_everywhere

    plan = built.plan
    composed = built.composed
    compiled = built.compiled
    draws = None
    if plan.randomize is not None and not plan.worlds:
        draws = dict(column for each in composed.drawn for column in each.columns())
    return BuildResult(
        name=plan.name,
        sha256=built.bundle.sha256,
        sizes=compiled.sizes if compiled else None,
        merged=composed.merged,
        mujoco=compiled.mujoco_version if compiled else None,
        licenses=tuple(licenses),
        draws=draws,
        cells=plan.cells,
        cells_at=plan.cells_at,
        adopted=tuple(each.located() for each in composed.model.adopted),
        allowed=allowed_everywhere(plan),
        excluded=len(composed.excluded),
        built=built,
        bundle=built.bundle,
        why=why,
        key=key,
        is_new=True,
    )


def result_from_cache(record: Record, inputs: tuple[str, ...]) -> BuildResult:
    return BuildResult(**record.facts(), record=record, inputs=inputs)


def shown_input_files(result: BuildResult | None, context: Context) -> set[str]:
    """Return the input files of a model, as messages name them."""
    read = set() if result is None else set(map(Path, result.inputs)) or set(input_files(result))
    return {context.shown(path) for path in read if os.path.isfile(context.folder / path)}


def input_files(result: BuildResult) -> Iterator[Path]:
    if result.built is None:
        yield from map(Path, result.inputs)
    else:
        composed = result.built.composed
        yield from source_files(result.built.plan, composed.model, composed.files)


def source_files(plan: Plan, model: Unit, uses: Iterable[FileUse]) -> Iterator[Path]:
    yield from (each.path for each in plan.plans())
    yield from (source.path for source in plan.sources())
    yield from (text.path for text in model.origins.texts.values() if text.path is not None)
    yield from (Path(use.source) for use in uses if use.content is None)


_File = TypeVar("_File")


def load_files(record: Record, load: Callable[[KeptFile], _File | None]) -> dict[str, _File] | None:
    """Return the files of a bundle, each as `load` returns it, or None if one of them is lost or changed."""
    files: dict[str, _File] = {}
    for file in record.files:
        loaded = load(file)
        if loaded is None:
            return None
        files[file.path] = loaded
    return files


def load_packed(file: KeptFile, cache: Cache) -> Packed | None:
    """Return a file of a bundle in compressed form, or None if it is lost."""
    from mjcompose.bundle.write import level_of, pack

    level = level_of(file.path)
    packed = cache.packed(file.sha256, level) if level else None
    if packed is None and (content := cache.raw(file)) is not None:
        packed = pack(content, level)
        if level:
            cache.keep_packed(file.sha256, level, packed)
    return packed


OutputLocator = Callable[[str, "str | None"], "Location | None"]
"""Returns the output's place by the model's name and its version of MuJoCo; None to write nothing."""


def no_output(name: str, mujoco: str | None) -> None:
    """Return None: a model that is not written. Workers get this function by its name."""


_SETTLED = "the recipe changed, but nothing that this model uses"


class ModelChoice(NamedTuple):
    """One model of a recipe: the values of parameters and variants, the name of a cell, and the sample."""

    given: Mapping[str, Node]
    name: str | None = None
    sample: int = 0


class Maker:
    """Makes the models of a recipe in a `form` of output; `place` returns the output's path, if any."""

    def __init__(
        self,
        recipe: Path,
        options: BuildOptions,
        cache: Cache | None,
        context: Context,
        form: str | None = None,
        place: OutputLocator = no_output,
    ) -> None:
        is_piped = recipe.name == STDIN  # the cache compares files
        self.recipe = recipe
        self.options = options
        self.context = context
        self.cache = None if is_piped else cache
        self.form = form
        self.place = place
        self.library: Library = {}
        self._key: CacheKey | None = None
        self._ahead: BackgroundPacker | None = None
        self._since = now()

    def key(self, cell: str | None = None, values: Mapping[str, str] | None = None) -> CacheKey | None:
        """Return the cache key of the recipe's model or of one of its cells."""
        if self.cache is None:
            return None
        if self._key is None:
            context = self.context
            store = self.cache.store.folder
            self._key = self.options.key(self.recipe, context.folder, context.environment, store=store)
        return self._key if cell is None else self._key.of_cell(cell, values or {})

    def recall(
        self, key: CacheKey | None, context: Context, outcomes: list[CheckOutcome] | None = None
    ) -> tuple[BuildResult | None, tuple[str, ...]]:
        """Return the model with its diagnostics and outcomes if the cache has it, or why it does not."""
        if self.cache is None or key is None:
            return None, ("the cache is not used",)
        found = self.cache.find(key)
        if found.record is None:
            return None, found.why
        if context.strict and _warns(found.record):
            return None, ("it has warnings, which are errors now",)
        made = self._with_files(found.record, found.answer)
        if made is None:
            return None, (LOST,)
        _report(found.record, context, outcomes)
        return made, ()

    def make(
        self,
        context: Context,
        session: Session,
        choice: ModelChoice,
        *,
        key: CacheKey | None = None,
        why: tuple[str, ...] = (),
        outcomes: list[CheckOutcome] | None = None,
    ) -> BuildResult | None:
        """Plan the model, and build it unless the cache has the plan; report errors."""
        from mjcompose.pipeline import stages

        outcomes = [] if outcomes is None else outcomes
        options = self.options
        request = stages.ModelRequest(
            self.recipe,
            choice.given,
            choice.name,
            sample=choice.sample,
            verified=options.verified,
            deduplicated=options.deduplicated,
            pictured=options.pictured,
            target=options.target,
            worlds=options.worlds,
        )
        plan = stages.planned(request, context)
        if plan is None:
            return None
        if key is not None and self.options.text_beside is None and not context.sink.has_errors:
            known = self._recall_planned(plan, choice.name, context, key=key, outcomes=outcomes)
            if known is not None:
                return known
        if self._ahead is not None:  # from the previous model
            self._ahead.end()
            self._ahead = None
        built = stages.Build(
            plan, request, context, session=session, library=self.library, outcomes=outcomes, on_bundle=self._pack_ahead
        ).run()
        if built is None:
            return None
        made = result_of_build(built, license_rows(plan, context), why, key=key)
        made = replace(made, inputs=(*self._inputs.recipes(plan), *self._inputs.others(built, context)))
        if self.options.text_beside is None:
            self._keep(made, outcomes, context, cell=choice.name)
        return made

    def with_text(self, result: BuildResult, text: bytes, context: Context) -> BuildResult:
        """Return the model with its text, which is written for this output and stored in the cache."""
        self._keep(result, (), context, cell=None, text=text)
        return replace(result, text=text)

    def content(self, result: BuildResult) -> str:
        if result.text is not None:
            return sha256(result.text).hexdigest()
        return key_of([result.sha256, self.form, self.context.environment.get("SOURCE_DATE_EPOCH")])

    def note_written(self, result: BuildResult, beside: Iterable[Path] = ()) -> None:
        target = self.place(result.name, result.mujoco)
        if self.cache is not None and target is not None and not result.is_written:
            self.cache.note_written(target, self.content(result), beside)

    def packing(self, bundle: Bundle, path: str) -> Packed:
        """Return a compressed file, compressed once for all models that have it."""
        from mjcompose.bundle.write import level_of, pack

        level = level_of(path)
        digest = bundle.digest(path)
        ahead = self._ahead.take(digest) if self._ahead is not None else None
        packed = self._packed(digest, level) if ahead is None and level else None
        is_new = ahead[1] if ahead is not None else packed is None
        packed = ahead[0] if ahead is not None else packed or pack(bundle.files[path], level)
        if is_new and self.cache is not None and level:
            self.cache.keep_packed(digest, level, packed)
        return packed

    def _packed(self, digest: str, level: int) -> Packed | None:
        return None if self.cache is None else self.cache.packed(digest, level)

    def _pack_ahead(self, bundle: Bundle) -> None:
        from mjcompose.bundle.write import BackgroundPacker

        if self.form == "archive":
            self._ahead = BackgroundPacker(bundle, self._packed)

    def _with_files(self, record: Record, answer: CacheAnswer | None) -> BuildResult | None:
        """Return a stored model with the data that its output needs, or None if that is damaged."""
        assert self.cache is not None
        made = result_from_cache(record, tuple(each.path for each in answer.inputs) if answer else ())
        target = self.place(record.name, record.mujoco)
        if record.text is not None:
            text = self.cache.raw(KeptFile("", record.text, 0, source=None))
            if text is None:
                return None
            made = replace(made, text=text)
        if target is not None and self.form != "usd" and self.cache.is_written(target, self.content(made)):
            return replace(made, is_written=True)
        if target is None or made.text is not None:
            return made
        if self.form == "archive":
            packed = load_files(record, partial(load_packed, cache=self.cache))
            return None if packed is None else replace(made, packed=packed)
        files = load_files(record, self.cache.raw)
        return None if files is None else replace(made, bundle=Bundle(files, record.model))

    def _planned(self, plan: Plan, cell: str | None) -> CacheKey:
        """Return the key of a plan, independent of the recipe file."""
        key = self.key()
        assert key is not None
        return key.of_plan(plan, cell, self.options.choices)

    def _recall_planned(
        self, plan: Plan, cell: str | None, context: Context, key: CacheKey, outcomes: list[CheckOutcome]
    ) -> BuildResult | None:
        """Return a model that was built from another state of the recipe file, with the diagnostics of this state."""
        from mjcompose.pipeline.cache.inputs import hash_of_positions, may_move
        from mjcompose.verify.run_checks import check_spans

        assert self.cache is not None
        found = self.cache.find(self._planned(plan, cell))
        record = found.record
        answer = found.answer
        if record is None or answer is None or (context.strict and _warns(record)):
            return None
        if record.mentions_positions and record.places != hash_of_positions(plan):
            return None
        written = check_spans(plan)
        checks = tuple(replace(each, span=written[each.name]) for each in record.checks)
        record = replace(record, checks=checks, cells=plan.cells, cells_at=plan.cells_at)
        recipes = [self.cache.files.look(path) for path in self._inputs.recipes(plan)]
        record = self._of_recipes(record, {each.path: each.state for each in recipes})
        made = None if record is None else self._with_files(record, answer)
        if record is None or made is None:
            return None
        _report(record, context, outcomes)
        if not may_move(context):
            self.cache.keep(key, record, [*recipes, *answer.inputs], packages=answer.packages)
        return replace(made, why=(_SETTLED,))

    def _of_recipes(self, record: Record, states: Mapping[str, str]) -> Record | None:
        """Return the record of the same model from recipes with other bytes, whose hashes are in its manifest."""
        from mjcompose.bundle.manifest import with_read

        assert self.cache is not None
        recipes = tuple(replace(each, sha256=states.get(each.path, "")) for each in record.recipes)
        if recipes == record.recipes:
            return record
        files = load_files(record, self.cache.raw)
        if files is None or len(recipes) != len(states) or not all(each.sha256 for each in recipes):
            return None
        hashes = {each.name: each.sha256 for each in recipes}
        bundle = Bundle({**files, MANIFEST: with_read(files[MANIFEST], recipes[0].sha256, hashes)}, record.model)
        known = {file.sha256: file.source for file in record.files if file.source is not None}
        return replace(record, sha256=bundle.sha256, files=self._kept(bundle, known), recipes=recipes)

    def _keep(
        self,
        result: BuildResult,
        outcomes: Sequence[CheckOutcome],
        context: Context,
        cell: str | None,
        text: bytes | None = None,
    ) -> None:
        """Store a model that was built now, unless one of its inputs has changed meanwhile."""
        from mjcompose.bundle.assemble import portable
        from mjcompose.pipeline.cache.inputs import hash_of_positions, may_move, mentions_positions

        cache = self.cache
        built = result.built
        key = result.key
        if cache is None or built is None or key is None:
            return
        names = self._inputs
        files = cache.files
        files.forget()
        paths = names.recipes(built.plan), names.others(built, context)
        own = os.fspath(cache.store.folder) + os.sep
        if any(files.changed_since(path, self._since) and not path.startswith(own) for each in paths for path in each):
            return
        recipes, others = ([files.look(path) for path in each] for each in paths)
        known = {each.state: each.path for each in others if not os.path.isdir(each.path)}
        digest = None
        if text is not None:
            digest = sha256(text).hexdigest()
            cache.keep_raw(digest, text)
        name = portable(built.plan, built.composed.model, context).name
        record = Record(
            **result.facts(),
            model=built.bundle.model,
            files=self._kept(built.bundle, known) if text is None else (),
            text=digest,
            diagnostics=tuple(context.sink.diagnostics),
            checks=tuple(outcomes),
            recipes=tuple(KeptRecipe(each.path, name(Path(each.path)), each.state) for each in recipes),
            places=hash_of_positions(built.plan),
        )
        mentions = mentions_positions(built.plan, record, built.bundle.files[MANIFEST])
        record = replace(record, mentions_positions=mentions)
        packages = list(names.packages(built.plan))
        if not may_move(context):
            cache.keep(key, record, [*recipes, *others], packages=packages)
        if text is None:
            cache.keep(self._planned(built.plan, cell), record, others, packages=packages)

    def _kept(self, bundle: Bundle, known: Mapping[str, str]) -> tuple[KeptFile, ...]:
        """Return the files of a bundle; those that equal no input file (`known`, by hash) go to the store."""
        assert self.cache is not None
        found = []
        for path, content in bundle.files.items():
            digest = bundle.digest(path)
            if digest not in known:
                self.cache.keep_raw(digest, content)
            found.append(KeptFile(path, digest, len(content), source=known.get(digest)))
        return tuple(found)

    @cached_property
    def _inputs(self) -> Inputs:
        from mjcompose.pipeline.cache.inputs import Inputs

        return Inputs()


def _warns(record: Record) -> bool:
    return any(each.severity is Severity.WARNING for each in record.diagnostics)


def _report(record: Record, context: Context, outcomes: list[CheckOutcome] | None) -> None:
    log("`%s` is unchanged and comes from the cache", record.name)
    context.sink.extend(record.diagnostics)
    if outcomes is not None:
        outcomes.extend(record.checks)
