"""A recipe to a plan: references resolved, nested recipes planned, every step in its order."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from composer.context import Context
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import closest, exists_note
from composer.document import load
from composer.document.decode import MAX_SIZE
from composer.document.node import Mapping, locate
from composer.plan.copies import copies
from composer.plan.order import in_order
from composer.plan.parts import called, parts_of
from composer.plan.plan import (
    AddElement,
    AppendElement,
    AttachPart,
    LoadBase,
    Plan,
    SetDefault,
    SetSingleton,
    Step,
    WriteKeyframe,
)
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.element import Element
from composer.recipe.keyframe import FROM
from composer.recipe.recipe import Recipe
from composer.recipe.validate import validate_what_remains
from composer.sources.error import SourceError
from composer.sources.nearby import model_files, nearest
from composer.sources.resolve import resolve
from composer.sources.source import Source


def make_plan(recipe: Path, context: Context) -> Plan | None:
    """What a build of the recipe will do; None where it or what it refers to is at fault."""
    before = context.sink.error_count
    plan = plan_what_remains(recipe, context)
    return plan if context.sink.error_count == before else None


def plan_what_remains(recipe: Path, context: Context) -> Plan | None:
    """The plan without what is at fault, in which later stages can look for more; None without a base."""
    return _Planner(context).plan(context.folder / recipe, ())


class _Planner:
    def __init__(self, context: Context) -> None:
        self.context = context
        self.sink = context.sink

    def plan(
        self, path: Path, outer: tuple[tuple[Path, Span | None], ...], span: Span | None = None
    ) -> Plan | None:
        """The plan of one recipe; `outer` are the recipes it is nested in, outermost first."""
        key = Path(os.path.realpath(path))
        if any(each == key for each, _ in outer):
            ring = [each.name for each, _ in outer[[each for each, _ in outer].index(key) :]]
            self.sink.error(
                "source-cycle",
                "recipes contain one another: " + " → ".join([*ring, path.name]),
                span,
                help="a recipe cannot be a part of itself: take one of these references out",
            )
            return None
        read = self._read(path)
        if read is None:
            return None
        recipe, document = read
        inside = (*outer, (key, span))
        base = self._base(recipe, document, path, inside)
        parts = self._without_rings(tuple(self._parts(recipe, document, path, inside)), recipe.separator)
        if base is None:
            return None
        steps = tuple(_steps(recipe, document))
        plan = Plan(
            name=recipe.name or path.stem,
            description=recipe.description,
            path=path,
            file=self.context.shown(path),
            document=document,
            separator=recipe.separator,
            conflict=recipe.conflict,
            angle=recipe.angle,
            eulerseq=recipe.eulerseq,
            base=base,
            parts=parts,
            steps=steps,
            settled=frozenset(_settled(steps)),
        )
        _check_sources(plan, self.sink)
        return plan

    def _read(self, path: Path) -> tuple[Recipe, Mapping] | None:
        shown = self.context.shown(path)
        try:
            with path.open("rb") as stream:
                text = stream.read(MAX_SIZE + 1)
        except OSError as error:
            self._unreadable(path, shown, error)
            return None
        if text.lstrip().startswith(b"<"):
            self.sink.error(
                "source-kind",
                f"`{shown}` is XML and no recipe",
                Span(shown, 1, 1),
                help=f"a recipe names its models: `base: ./{path.with_suffix('.xml').name}`",
            )
            return None
        before = self.sink.error_count
        node = load(text, shown, self.sink)
        if node is None or self.sink.error_count > before:
            return None
        found = validate_what_remains(node, self.sink)
        if found is None:
            return None
        self.sink.forgive(found.lost)
        return found.recipe, found.document

    def _unreadable(self, path: Path, shown: str, error: OSError) -> None:
        folder = path if path.is_dir() else path.parent
        recipes = [each for each in model_files(folder, 1) if each.endswith((".yaml", ".yml"))]
        if path.is_dir():
            notes = [exists_note("recipe", recipes)]
            self.sink.error("file-unreadable", f"`{shown}` is a folder, not a recipe", notes=notes)
        elif isinstance(error, FileNotFoundError):
            near = nearest(path.name, recipes)
            help = f"did you mean `{self.context.shown(folder / near)}`?" if near else None
            notes = [exists_note("recipe", recipes)] if recipes else []
            self.sink.error("file-not-found", f"there is no recipe `{shown}`", notes=notes, help=help)
        else:
            reason = (error.strerror or str(error)).lower()
            self.sink.error("file-unreadable", f"`{shown}` cannot be read: {reason}")

    def _base(
        self, recipe: Recipe, document: Mapping, path: Path, inside: tuple[tuple[Path, Span | None], ...]
    ) -> LoadBase | None:
        if recipe.base is None:
            return LoadBase(None, "merge", None)
        span = locate(document, ("base", "model"))
        model = self._model(recipe.base.model, span, path, inside)
        model = self._with_packages(model, recipe.base, ("base",), document, path)
        return None if model is None else LoadBase(model, recipe.base.keyframes, span, recipe.base.subtree)

    def _parts(
        self, recipe: Recipe, document: Mapping, path: Path, inside: tuple[tuple[Path, Span | None], ...]
    ) -> Iterator[AttachPart]:
        taken: dict[str, Span] = {}
        for key in in_order(recipe.attach, document, self.sink):
            attachment = recipe.attach[key]
            at = ("attach", key)
            span = locate(document, at, key=True)
            name = key if attachment.prefix is None else attachment.prefix
            numbered = [(name + suffix, copy) for suffix, copy in copies(attachment.replicate)]
            prefixes = {own + recipe.separator if own else "": copy for own, copy in numbered}
            clash = next((prefix for prefix in prefixes if prefix and prefix in taken), None)
            if clash is not None:
                self.sink.error(
                    "name-clash",
                    f"two parts have the prefix `{clash}`",
                    span if attachment.prefix is None else locate(document, (*at, "prefix")),
                    notes=(Note("the other part", taken[clash]),),
                    help="give one of them another key, or another `prefix`",
                )
                continue
            taken.update(dict.fromkeys(prefixes, span))
            model = self._model(attachment.model, locate(document, (*at, "model")), path, inside, recipe)
            model = self._with_packages(model, attachment, at, document, path)
            if model is None:
                self.sink.forgive(own for own, _ in numbered)
            else:
                for prefix, copy in prefixes.items():
                    yield AttachPart(prefix, model, attachment, at, span, copy)

    def _model(
        self,
        reference: str,
        span: Span,
        path: Path,
        inside: tuple[tuple[Path, Span | None], ...],
        outer: Recipe | None = None,
    ) -> Source | Plan | None:
        try:
            source = resolve(reference, relative_to=path.parent, environment=self.context.environment)
        except SourceError as error:
            notes = tuple(Note(note) for note in error.notes)
            self.sink.error(error.code, error.message, span, notes=notes, help=error.help)
            return None
        if source.format != "recipe":
            return source
        plan = self.plan(source.path, inside, span)
        if plan is not None and outer is not None and plan.separator != outer.separator:
            self.sink.error(
                "separator-mismatch",
                f"`{reference}` separates names with `{plan.separator}`, this recipe with `{outer.separator}`",
                span,
                help=f'give both the same: `separator: "{plan.separator}"`',
            )
        return plan

    def _with_packages(
        self,
        model: Source | Plan | None,
        asked: Base | Attachment,
        at: tuple[str | int, ...],
        document: Mapping,
        path: Path,
    ) -> Source | Plan | None:
        """The model with the folders of the packages that its URDF refers to."""
        if not asked.packages or model is None:
            return model
        if not isinstance(model, Source) or model.format != "urdf":
            self.sink.error(
                "unknown-key",
                f"`packages` is for URDF, and `{asked.model}` is none",
                locate(document, (*at, "packages"), key=True),
                help="take `packages` out",
            )
            return model
        found = {name: path.parent / folder for name, folder in asked.packages.items()}
        for name, folder in found.items():
            if not folder.is_dir():
                self.sink.error(
                    "file-not-found",
                    f"the folder of the package `{name}` is not there: `{self.context.shown(folder)}`",
                    locate(document, (*at, "packages", name)),
                    help="the path is relative to the recipe, and leads to the folder that `package://"
                    f"{name}` stands for",
                )
        return replace(model, packages=tuple(found.items()))

    def _without_rings(self, parts: tuple[AttachPart, ...], separator: str) -> tuple[AttachPart, ...]:
        """Tell parts that hang on one another in a ring, which hang on nothing; the others remain."""
        hangs_on = {part.prefix: _mount_of(part, parts) for part in parts}
        told: set[str] = set()
        for part in parts:
            ring = [part.prefix]
            while (mount := hangs_on.get(ring[-1])) is not None and mount not in ring:
                ring.append(mount)
            if mount == part.prefix and part.prefix not in told:
                told.update(ring)
                names = ", which hangs on ".join(f"`{prefix}`" for prefix in [*ring[1:], mount])
                alone = len(ring) == 1
                self.sink.error(
                    "attach-cycle",
                    f"`{part.prefix}` hangs on itself" if alone else f"`{part.prefix}` hangs on {names}",
                    part.span,
                    help=f"{'it' if alone else 'one of them'} must hang on the base or on the world",
                )
        if told:
            self.sink.forgive(called(part, separator) for part in parts if part.prefix in told)
        return tuple(part for part in parts if part.prefix not in told)


def _mount_of(part: AttachPart, parts: tuple[AttachPart, ...]) -> str | None:
    """The prefix of the part that this one hangs on, the longest that fits; None for the base and the world."""
    attachment = part.attachment
    place = attachment.site or attachment.body or attachment.frame or ""
    fitting = [other.prefix for other in parts if other.prefix and place.startswith(other.prefix)]
    return max(fitting, key=len, default=None)


_SINGLETONS = ("compiler", "option", "size", "visual", "statistic")
_SECTIONS = (
    "extension", "asset", "deformable", "contact", "tendon", "equality", "actuator", "sensor", "custom",
)  # fmt: skip


def _steps(recipe: Recipe, document: Mapping) -> Iterator[Step]:
    """`add` first, then the sections: settings, classes, and what may use them."""
    for item in recipe.add:
        path = (*item.at, "to", "frame") if item.to_kind == "frame" else (*item.at, "to")
        span = locate(document, item.element.at)
        yield AddElement(item.to_kind, item.to, item.element, locate(document, path), span)
    for section in _SINGLETONS:
        element: Element | None = getattr(recipe, section)
        if element is not None:
            yield SetSingleton(section, element, locate(document, element.at, key=True))
    for each in recipe.default:
        yield SetDefault(each.name, each.parent, each.element, locate(document, each.element.at, key=True))
    for section in _SECTIONS:
        for element in getattr(recipe, section):
            yield AppendElement(section, element, locate(document, element.at, key=True))
    for key in recipe.keyframe:
        yield WriteKeyframe(key, locate(document, key.at, key=True))


def _check_sources(plan: Plan, sink: Sink) -> None:
    """Tell parts that keys are to be made of and that are not there."""
    parts = list(parts_of(plan))
    for step in plan.keyframes:
        for part in step.key.sources:
            if parts.count(part) > 1:
                sink.error(
                    "name-clash",
                    f"`{part}` may be two parts: one has it as its prefix, and one without a prefix as its key",
                    locate(plan.document, (*step.key.at, FROM, part), key=True),
                    help="give the one without a prefix another key",
                )
            elif part not in parts:
                near = closest(part, parts)
                sink.error(
                    "unknown-name",
                    f"there is no part `{part}` to take a key from",
                    locate(plan.document, (*step.key.at, FROM, part), key=True),
                    notes=(exists_note("part", parts, part),),
                    help=f"did you mean `{near[0]}`?" if near else None,
                )


def _settled(steps: tuple[Step, ...]) -> Iterator[str]:
    """The paths of the values that the recipe sets itself (`option/cone`)."""

    def walk(element: Element, path: str) -> Iterator[str]:
        yield from (f"{path}/{name}" for name in element.attributes)
        for child in element.children:
            yield from walk(child, f"{path}/{child.tag}")

    for step in steps:
        if isinstance(step, SetSingleton):
            yield from walk(step.element, step.section)
