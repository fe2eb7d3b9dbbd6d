"""Plan a recipe: resolve references, plan nested recipes, and put every step in its order."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterator, Mapping as Map
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.access import Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Path as KeyPath, Span
from mjcompose.base.extensions import check_rows
from mjcompose.base.files import own_name
from mjcompose.base.limits import advice, in_force
from mjcompose.language.attach import Attachment
from mjcompose.language.check import checks_of
from mjcompose.language.expand import Concrete
from mjcompose.language.placing import with_inherited
from mjcompose.language.recipe import SETTLED, Recipe
from mjcompose.language.validate import validate_what_remains
from mjcompose.plan.locked import use_lock
from mjcompose.plan.matrix import draw_parameters, read_matrix
from mjcompose.plan.parts import check_part_names, check_pieces, copies, inner_recipes, without_rings
from mjcompose.plan.plan import BASE, AttachPart, Drawn, Plan
from mjcompose.plan.read import (
    Given,
    ValidRecipe,
    files_of_recipe,
    folder_of,
    validated_recipe,
    with_replaced_numbers,
)
from mjcompose.plan.steps import (
    AddElement,
    AngleContext,
    AngleSettings,
    AppendElement,
    DrawValues,
    EditElements,
    OrderElements,
    SetCollisions,
    SetDefault,
    SetSingleton,
    Step,
    WriteKeyframe,
    WrittenRecipe,
    angle_context_of,
    check_bare_angles,
)
from mjcompose.sources import ros
from mjcompose.sources.context import Context, as_text
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import CompilerSettings, Source, SourceError
from mjcompose.sources.ros import UrdfChoices
from mjcompose.text.node import Mapping, find, locate
from mjcompose.tree.grammar import GRAMMAR, to_text

if TYPE_CHECKING:
    from mjcompose.language.randomize import Randomize
    from mjcompose.plan.measured import Measurements
    from mjcompose.plan.measured_draws import MeasuredDraws

STEPS: tuple[type[Step], ...] = (
    AddElement,
    SetSingleton,
    SetDefault,
    AppendElement,
    EditElements,
    DrawValues,
    WriteKeyframe,
    SetCollisions,
    OrderElements,
)
"""All types of steps in the order in which they are carried out: settings, classes, and the steps that may use them."""
# Keys that the planner reads itself: settings of the whole recipe, its sources and its checks.
_PLANNED = (
    *"recipe name description angle eulerseq separator conflict allow base attach check datasheets".split(),
    "identify",
    "measured",
)

for _each in STEPS:
    if inspect.isabstract(_each):
        raise TypeError(f"the step {_each.__name__} lacks {', '.join(sorted(_each.__abstractmethods__))}")
check_rows(
    f"the keys of a recipe that {__name__} plans",
    [*_PLANNED, *(section for each in STEPS for section in each.sections)],
    [key for key in Recipe.model_fields if key not in SETTLED],
)

Outer = tuple[tuple[Path, "Span | None"], ...]
"""The recipe files around a nested one, outermost first, each with the place that names it."""


def make_plan(
    recipe: Path, context: Context, given: Given | None = None, *, name: str | None = None, sample: int = 0
) -> Plan | None:
    """Return the plan of a recipe as `plan_what_remains` does, or None if it or something it refers to has errors."""
    before = context.sink.error_count
    plan = plan_what_remains(recipe, context, given, name=name, sample=sample)
    return plan if context.sink.error_count == before else None


def plan_what_remains(
    recipe: Path,
    context: Context,
    given: Given | None = None,
    *,
    name: str | None = None,
    sample: int = 0,
    worlds: bool = False,
) -> Plan | None:
    """Return the plan without its faulty pieces, so later stages can find more errors; None without a base.

    `name` is the name of a cell of the matrix. Without it, the plan has the recipe's name, and the matrix is checked.
    `sample` selects the draws; 0 has none. With `worlds`, all samples become worlds of the model.
    """
    if use_lock(recipe, context) is None:
        return None
    path = context.folder / recipe
    try:
        plan = _Planner(context, name=name, sample=sample, worlds=worlds).plan(path, (), given=given or {})
    except RecursionError:  # if the limit `nesting` was raised
        context.sink.error("not-supported", f"the recipes in `{recipe}` are nested too deeply")
        return None
    if name is None and plan is not None and (matrix := read_matrix(path, context, given)) is not None:
        check_pieces(matrix.document, given or {}, context.sink)
        if matrix.cells:
            plan = replace(plan, cells=len(matrix.cells), cells_at=matrix.cells[0].span)
    return plan


class _LoadedRecipe(Struct):
    """A recipe that was read from a file, or from the path `at` in it, with everything that its plan needs."""

    name: str
    path: Path
    recipe: Recipe
    document: Mapping
    concrete: Concrete | None
    angle_context: AngleContext
    at: KeyPath = ()
    source: Source | None = None
    extended: tuple[tuple[Source, Span], ...] = ()
    randomize: Randomize | None = None
    sample: int = 0
    drawn: tuple[Drawn, ...] = ()
    measured: Measurements | None = None
    measured_draws: MeasuredDraws | None = None


def compiler_settings(attachment: Attachment) -> CompilerSettings:
    """Return the attributes of `compiler` next to a `model`, as the file would write them."""
    element = attachment.compiler
    kinds = GRAMMAR.section("compiler").attributes
    written = {} if element is None else element.attributes
    return tuple(sorted((name, to_text(kinds[name], value)) for name, value in written.items()))


class _Planner:
    """Plans a recipe and those nested in it. `name` and `sample` belong to the outermost recipe."""

    def __init__(self, context: Context, *, name: str | None, sample: int, worlds: bool) -> None:
        self.context = context
        self.name = name
        self.sample = sample
        self.worlds = worlds
        self.sink = context.sink
        self.nested = 0
        self.sources: dict[tuple[str, Path], Source] = {}
        self.inner: dict[Source, tuple[Plan, ...]] = {}
        self.sizes: dict[int, tuple[Plan, int]] = {}
        """Each plan with its number of parts, including parts of nested recipes, by the identity of the plan."""

    def plan(
        self, path: Path, outer: Outer, span: Span | None = None, *, given: Given, source: Source | None = None
    ) -> Plan | None:
        """Return the plan of one recipe; `outer` are the recipes around it, outermost first."""
        key = Path(os.path.realpath(path))
        around = [recipe for recipe, _ in outer]
        if key in around:
            self._report_cycle([*around[around.index(key) :], path], span)
            return None
        valid = self._read(path, given) if self._may_nest(len(outer), span) else None
        if valid is None:
            return None
        recipe = valid.recipe
        document = valid.document
        concrete = valid.concrete
        randomize = recipe.randomize if not outer else None
        drawn: tuple[Drawn, ...] = ()
        if self.worlds and not outer:
            self._check_worlds(path, recipe, document)
        elif randomize is not None and randomize.of_parameters and concrete is not None:
            values, drawn = draw_parameters(randomize, self.sample, concrete, document=document, sink=self.sink)
            if values:
                valid = self._read(path, {**given, **values})
                if valid is None:
                    return None
                recipe = valid.recipe
                document = valid.document
                concrete = valid.concrete
                randomize = recipe.randomize
        measured_draws = self._measured_draws(valid, randomize)
        if measured_draws is not None and self.sample:
            replaced = with_replaced_numbers(valid, measured_draws.replaced(self.sample), self.sink)
            if replaced is None:
                return None
            recipe = replaced.recipe
            document = replaced.document
            drawn += tuple(measured_draws.records(self.sample))
        name, sample = (None, 0) if outer else (self.name, self.sample)
        loaded = _LoadedRecipe(
            name or recipe.name or as_text(own_name(path)),
            path,
            recipe,
            document=document,
            concrete=concrete,
            angle_context=self._angle_context(path, recipe, document, concrete),
            source=source,
            extended=self.context.recipes[path].extended,
            randomize=randomize,
            sample=sample,
            drawn=drawn,
            measured=valid.measured,
            measured_draws=measured_draws,
        )
        return self._assembled(loaded, (*outer, (key, span)))

    def _report_cycle(self, ring: list[Path], span: Span | None) -> None:
        message = "recipes contain one another: " + " → ".join(path.name for path in ring)
        help = "a recipe cannot be a part of itself: remove one of these references"
        self.sink.error("source-cycle", message, span, help=help)

    def _angle_context(self, path: Path, recipe: Recipe, document: Mapping, concrete: Concrete | None) -> AngleContext:
        """Return the units of the recipe's angles: of each file that wrote a part of it, if there are several."""
        whole = AngleSettings(recipe.angle, recipe.eulerseq)
        files = self.context.recipes[path].said
        if concrete is None or len(files) < 2:
            return AngleContext(document, whole)  # a file without a setting allows no bare angles
        angle_context = angle_context_of(concrete, document, whole, files=files, sink=self.sink)
        check_bare_angles(angle_context, self.sink)
        return angle_context

    def _assembled(self, loaded: _LoadedRecipe, inside: Outer) -> Plan | None:
        """Return the plan of a recipe that was read, with its base and parts planned."""
        recipe = loaded.recipe
        document = loaded.document
        concrete = loaded.concrete
        base: AttachPart | None = None
        if recipe.base is not None and (model := self._model(recipe.base, (BASE,), loaded, inside=inside)) is not None:
            span = locate(document, (BASE, "model"))
            base = AttachPart("", model, recipe.base, at=(BASE,), span=span, inner=self._inner(model))
        members = tuple(self._parts(loaded, inside))
        if recipe.base is not None and base is None:
            return None
        if base is not None and base.attachment.is_placed:
            members = (base, *members)
            base = None
        written = self._written(loaded)
        steps = tuple(step for kind in STEPS for step in kind.of(written))
        plan = Plan(
            loaded.name,
            recipe.description,
            loaded.path,
            file=self.context.shown(loaded.path),
            document=document,
            separator=recipe.separator,
            conflict=recipe.conflict,
            angle_context=loaded.angle_context,
            base=base,
            parts=without_rings(members, recipe.separator, self.sink),
            steps=steps,
            settled=frozenset(path for step in steps if isinstance(step, SetSingleton) for path in step.settled),
            scope=concrete.scope if concrete else {},
            variants=concrete.variants if concrete else {},
            checks=tuple(checks_of(recipe.check)),
            datasheets=recipe.datasheets,
            identify=recipe.identify,
            measured=loaded.measured,
            measured_draws=loaded.measured_draws,
            randomize=loaded.randomize,
            sample=loaded.sample,
            worlds=self.worlds,
            drawn=loaded.drawn,
            source=loaded.source,
            extended=loaded.extended,
            at=loaded.at,
        )
        check_part_names(plan, self.sink)
        return plan if self._may_have(plan) else None

    def _written(self, loaded: _LoadedRecipe) -> WrittenRecipe:
        """Return the recipe as its steps read it."""
        draws = loaded.measured_draws
        written = WrittenRecipe(
            loaded.recipe, loaded.document, loaded.randomize, sample=loaded.sample, worlds=self.worlds
        )
        if draws is None:
            return written
        if self.worlds:
            return replace(written, numbers_of_worlds=tuple(draws.for_worlds(loaded.document, self.sink)))
        return replace(written, draw_words=draws.edit_words(loaded.sample) if loaded.sample else {})

    def _measured_draws(self, valid: ValidRecipe, randomize: Randomize | None) -> MeasuredDraws | None:
        """Return the draws of measured numbers, if the recipe has any; None after reported errors."""
        if randomize is None or not randomize.of_measured or self.context.as_designed:
            return None
        if valid.measured is None:
            if valid.recipe.measured is None:  # another error is reported
                drawing = randomize.of_measured[0]
                message = f"field `{drawing.name}` draws measured numbers, and the recipe has no `measured`"
                span = locate(valid.document, drawing.drawn_at)
                help = "name the file of measurements: `measured: robots/A12.yaml`"
                self.sink.error("missing-key", message, span, help=help)
            return None
        from mjcompose.plan.measured_draws import measured_draws  # few recipes draw measured numbers

        document = valid.document
        draws = measured_draws(randomize, valid.measured, document, valid.recipe.separator, self.sink)
        samples = (self.sample,) if self.sample else range(1, randomize.samples + 1)
        return draws if draws is not None and draws.check(samples, document, self.sink) else None

    def _may_nest(self, depth: int, span: Span | None) -> bool:
        """Return whether one more recipe may be planned: nesting two recipes in each level grows exponentially."""
        limits = in_force()
        self.nested += 1
        if depth > limits.nesting:
            message = f"more than {limits.nesting} recipes are nested in one another"
            self.sink.error("limit-exceeded", message, span, help=advice("nesting"))
        elif self.nested == limits.parts + 1:  # reported once
            message = f"more than {limits.parts} recipes are nested"
            self.sink.error("limit-exceeded", message, span, help=advice("parts"))
        return depth <= limits.nesting and self.nested <= limits.parts

    def _may_have(self, plan: Plan) -> bool:
        """Return whether a plan is within the limit of parts, including copies and parts of nested recipes."""
        inner = [1 + self._size_of(part) for part in plan.parts]
        size = sum(inner) + (self._size_of(plan.base) if plan.base else 0)
        self.sizes[id(plan)] = plan, size
        most = in_force().parts
        if size <= most:
            return True
        at = plan.parts[inner.index(max(inner))].span if inner else locate(plan.document, (BASE, "model"))
        message = f"the recipe has {size} parts; {most} are allowed"
        self.sink.error("limit-exceeded", message, at, help=advice("parts", size))
        return False

    def _size_of(self, part: AttachPart) -> int:
        return sum(self.sizes[id(each)][1] for each in (part.model, *part.inner) if isinstance(each, Plan))

    def _check_worlds(self, path: Path, recipe: Recipe, document: Mapping) -> None:
        """Report a recipe whose samples cannot be worlds: it draws nothing, or parameters."""
        if recipe.randomize is None:
            if "randomize" in document.entries:  # its fault is reported
                return
            message = f"`{path.name}` has no `randomize`, so it has no worlds"
            self.sink.error("missing-key", message, document.span, help="build without `--as worlds`")
            return
        for field in recipe.randomize.of_parameters:
            message = f"field `{field.name}` draws a parameter, and a compiled model has no parameters"
            span = locate(document, (*field.at, "param"))
            help = "build without `--as worlds`: `--worlds FILE` makes worlds of any samples"
            self.sink.error("draw-at-run-time", message, span, help=help, subjects=(field.name,))

    def _read(self, path: Path, given: Given) -> ValidRecipe | None:
        valid = validated_recipe(path, given, self.context)
        if valid is not None:
            self.sink.suppress_about(valid.lost)
        return valid

    def _parts(self, loaded: _LoadedRecipe, inside: Outer) -> Iterator[AttachPart]:
        recipe = loaded.recipe
        document = loaded.document
        taken: dict[str, Span] = {}
        for key, attachment in recipe.attach.items():
            at = ("attach", key)
            span = locate(document, at, key=True)
            name = key if attachment.prefix is None else attachment.prefix
            numbered = [(name + suffix, copy) for suffix, copy in copies(attachment.replicate)]
            prefixes = {own + recipe.separator if own else "": copy for own, copy in numbered}
            clash = next((prefix for prefix in prefixes if prefix and prefix in taken), None)
            if clash is not None:
                place = span if attachment.prefix is None else locate(document, (*at, "prefix"))
                notes = (Note("the other part", taken[clash]),)
                help = "give one of them another key, or `prefix`"
                message = f"two parts have the prefix `{clash}`"
                self.sink.error("name-clash", message, place, notes=notes, help=help, subjects=(clash,))
                continue
            taken.update(dict.fromkeys(prefixes, span))
            model = self._model(attachment, at, loaded, inside=inside)
            if model is None:
                self.sink.suppress_about(own for own, _ in numbered)
            else:
                for prefix, copy in prefixes.items():
                    yield AttachPart(prefix, model, attachment, at=at, span=span, copy=copy, inner=self._inner(model))

    def _model(self, attachment: Attachment, at: KeyPath, around: _LoadedRecipe, inside: Outer) -> Source | Plan | None:
        """Return the model for the mapping at `at`: a source, or the plan of a nested recipe."""
        document = around.document
        reference = attachment.model
        if not isinstance(reference, str):
            written = find(document, (*at, "model"))
            assert isinstance(written, Mapping)
            self._no_settings(attachment, "a model that is written in place", document=document, at=at)
            return self._in_place(at, written, around, inside=inside)
        source = self._source(reference, locate(document, (*at, "model")))
        if source is None:
            return None
        if attachment.packages and source.format != "urdf":
            self._only_for("packages", "URDF", f"`{reference}`", document=document, at=at)
        if source.format == "recipe":
            return self._nested(source, attachment, at, around, inside=inside)
        if source.format == "urdf":
            return self._urdf(source, attachment, document, at=at)
        return self._mjcf_or_mesh(source, attachment, document, at=at, inside=inside)

    def _source(self, reference: str, span: Span) -> Source | None:
        """Return the source of a reference, or None after a report. Every reference of a folder is resolved once."""
        folder = folder_of(span, self.context)
        # A recipe that MJCF attaches may run no code, even if the same reference was resolved for another recipe.
        source = None if self.context.attaching else self.sources.get((reference, folder))
        if source is None:
            try:
                source = resolve(
                    reference,
                    relative_to=folder,
                    environment=self.context.environment,
                    fetching=self.context.fetching,
                    runs_code=not self.context.attaching,
                )
            except SourceError as error:
                self.sink.add(error.at(span))
                return None
        self.sources[reference, folder] = source
        return source

    def _nested(
        self, source: Source, attachment: Attachment, at: KeyPath, around: _LoadedRecipe, inside: Outer
    ) -> Plan | None:
        """Return the plan of a recipe in a file of its own."""
        document = around.document
        called = f"`{attachment.model}`"
        span = locate(document, (*at, "model"))
        self._no_settings(attachment, f"the recipe {called}", document=document, at=at)
        given = find(document, (*at, "with"))
        values = {name: value for name, (_, value) in given.entries.items()} if isinstance(given, Mapping) else {}
        plan = self.plan(source.path, inside, span, given=values, source=source)
        if plan is not None:
            self._check_separator(called, plan, around.recipe, span=span)
        return plan

    def _mjcf_or_mesh(
        self, source: Source, attachment: Attachment, document: Mapping, at: KeyPath, inside: Outer
    ) -> Source | None:
        """Return the source with the settings that MJCF and meshes can have; None if MJCF attaches a faulty recipe."""
        called = f"`{attachment.model}`"
        for key, what in (("with", "recipes and xacro templates"), ("urdf", "URDF")):
            if find(document, (*at, key)) is not None:
                self._only_for(key, what, called, document=document, at=at)
        if source.format == "mesh":
            if attachment.compiler is not None:
                self._only_for("compiler", "MJCF and URDF", called, document=document, at=at)
            return source
        source = replace(source, compiler=compiler_settings(attachment))
        return source if self._plan_inner(source, inside) else None

    def _urdf(self, source: Source, attachment: Attachment, document: Mapping, at: KeyPath) -> Source:
        """Return the source with the packages, the arguments and the choices of a URDF."""
        packages = tuple(self._packages(attachment.packages, document, at))
        door = source.door.wider(tuple(folder for _, folder in packages)) if packages else source.door
        arguments = tuple(self._arguments(attachment, document, at))
        keys = attachment.urdf
        choices = UrdfChoices(arguments, keys.visuals, keys.fixed, actuators=keys.actuators, inertia=keys.inertia)
        return replace(source, packages=packages, door=door, urdf=choices, compiler=compiler_settings(attachment))

    def _arguments(self, attachment: Attachment, document: Mapping, at: KeyPath) -> Iterator[tuple[str, str]]:
        """Yield the arguments of a xacro template as text. Report lists and mappings."""
        for name, value in attachment.given.items():
            if isinstance(value, list | dict):
                got = "a list" if isinstance(value, list) else "a mapping"
                message = f"the argument `{name}` of a xacro template is text or a number, got {got}"
                self.sink.error("wrong-type", message, locate(document, (*at, "with", name)))
            else:
                yield name, str(value).lower() if isinstance(value, bool) else str(value)

    def _no_settings(self, attachment: Attachment, model: str, document: Mapping, at: KeyPath) -> None:
        """Report settings of `<compiler>` for a recipe, whose files have their own."""
        if attachment.compiler is not None:
            message = f"`compiler` is for a file of MJCF or URDF, and not for {model}"
            help = "write it next to the `model` of the file that needs it"
            span = locate(document, (*at, "compiler"), key=True)
            self.sink.error("unknown-key", message, span, help=help, subjects=("compiler",))

    def _plan_inner(self, source: Source, inside: Outer) -> bool:
        """Plan the recipes that MJCF attaches itself. Return whether none has errors."""
        before = self.sink.error_count
        context = self.context
        plans = []
        for path, folder, span in inner_recipes(source, context):
            try:
                named = f"./{os.path.relpath(path, folder)}"
                found = resolve(named, relative_to=folder, environment=context.environment, fetching=context.fetching)
            except SourceError as error:
                self.sink.add(error.at(span))
                continue
            self.context = replace(context, attaching=True)
            plan = self.plan(found.path, inside, span, given={}, source=found)
            self.context = context
            if plan is not None and self._may_read(plan, source.door, span):
                plans.append(plan)
        self.inner[source] = tuple(plans)
        return self.sink.error_count == before

    def _may_read(self, plan: Plan, door: Door, span: Span) -> bool:
        """Return whether all local files of a recipe may be read by the MJCF that attaches it."""
        files = [file for inner in plan.plans() for file in (inner.path, *files_of_recipe(inner, self.context))]
        for source in (*plan.sources(), *(source for inner in plan.plans() for source, _ in inner.extended)):
            if source.origin is None:
                files += (source.path, *(folder for _, folder in source.packages))
        fetching = self.context.fetching
        own = [file for file in files if fetching is None or fetching.around(file) is None]
        outside = next((file for file in own if not door.sees(file)), None)
        if outside is not None:
            door.outside(str(outside)).report(self.sink, span, shown=self.context.shown)
        return outside is None

    def _inner(self, model: Source | Plan) -> tuple[Plan, ...]:
        return self.inner.get(model, ()) if isinstance(model, Source) else ()

    def _in_place(self, at: KeyPath, model: Mapping, around: _LoadedRecipe, inside: Outer) -> Plan | None:
        """Return the plan of a recipe that is written instead of a model reference."""
        for key, what in (("with", "recipes in files"), ("packages", "URDF"), ("urdf", "URDF")):
            if find(around.document, (*at, key)) is not None:
                self._only_for(key, what, "a model in place", document=around.document, at=at)
        read = validate_what_remains(with_inherited(model, around.document), self.sink)
        if read is None:
            return None
        recipe = read.recipe
        others = {} if ({"angle", "eulerseq"} & model.entries.keys()) else around.angle_context.others
        angle_context = AngleContext(read.document, AngleSettings(recipe.angle, recipe.eulerseq), others)
        loaded = _LoadedRecipe(
            recipe.name or str(at[-1]),
            around.path,
            recipe,
            document=read.document,
            concrete=around.concrete,
            angle_context=angle_context,
            at=(*around.at, *at, "model"),
        )
        plan = self._assembled(loaded, inside)
        if plan is not None:
            self._check_separator("the model in place", plan, around.recipe, span=model.span)
        return plan

    def _check_separator(self, model: str, inner: Plan, outer: Recipe, span: Span) -> None:
        """Report a nested recipe whose names mix two separators. If it gives no part a prefix, it joins none."""
        if inner.separator == outer.separator or not inner.joins_names:
            return
        message = f"{model} separates names with `{inner.separator}`, this recipe with `{outer.separator}`"
        help = f'give both the same: `separator: "{inner.separator}"`'
        self.sink.error("separator-mismatch", message, span, help=help)

    def _only_for(self, key: str, what: str, model: str, document: Mapping, at: KeyPath) -> None:
        message = f"`{key}` is for {what}, and not for {model}"
        help = f"remove `{key}`"
        self.sink.error("unknown-key", message, locate(document, (*at, key), key=True), help=help, subjects=(key,))

    def _packages(self, packages: Map[str, str], document: Mapping, at: KeyPath) -> Iterator[tuple[str, Path]]:
        # A workspace comes first, so a named package replaces its package of that name.
        for name, written in sorted(packages.items(), key=lambda each: each[0] != "*"):
            span = locate(document, (*at, "packages", name))
            folder = folder_of(span, self.context) / written
            door = self.context.door_of_text(folder_of(span, self.context))
            if not door.sees(folder):
                door.outside(str(folder)).report(self.sink, span)
                continue
            if not os.path.isdir(folder):
                message = f"the folder of the package `{name}` does not exist: `{self.context.shown(folder)}`"
                help = f"write the path of `package://{name}`, relative to the recipe"
                self.sink.error("file-not-found", message, span, help=help)
            if name == "*":
                yield from self._workspace(folder, span)
            else:
                yield name, folder

    def _workspace(self, folder: Path, span: Span) -> Iterator[tuple[str, Path]]:
        found: dict[str, Path] = {}
        for name, at in ros.in_workspace(folder):
            if name in found:
                message = f"two packages of the workspace are called `{name}`"
                notes = (Note(f"`{self.context.shown(found[name])}` and `{self.context.shown(at)}`"),)
                help = f"name its folder: `{name}: …`, and put a file `COLCON_IGNORE` into the other"
                self.sink.error("name-clash", message, span, notes=notes, help=help)
            found.setdefault(name, at)
        if not found and os.path.isdir(folder):
            message = f"the workspace `{self.context.shown(folder)}` has no package"
            help = "name the folder with the packages, each of which has a `package.xml`"
            self.sink.error("file-not-found", message, span, help=help)
        yield from found.items()
