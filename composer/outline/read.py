"""Make the outline of a recipe, a model file, a model reference or a bundle."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.bundle import MANIFEST
from composer.bundle.manifest import from_json
from composer.bundle.read import ReadError, read
from composer.compose.compose import Composer
from composer.compose.load import Loader
from composer.context import Context
from composer.link.measure import measure_with
from composer.outline.of_unit import PartOf, world_of
from composer.outline.outline import Outline, Part
from composer.plan.concrete import Given
from composer.plan.drawn_parameters import check_sample
from composer.plan.plan import BASE
from composer.plan.planner import make_plan
from composer.sources.error import SourceError
from composer.sources.resolve import resolve
from composer.tree.parse import parse_text
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.bundle.manifest import Manifest
    from composer.plan.part_record import PartRecord
    from composer.sources.source import Source

_ARCHIVES = (".zip", ".mjz")


def outline(text: str, context: Context, given: Given | None = None, sample: int = 0) -> Outline | None:
    """Return the outline of `text`, or None if `context.sink` says why not.

    Nothing is compiled except what the linker has to measure. `given` are values of a recipe's parameters and
    variants, `sample` selects its draws.
    """
    path = context.folder / text
    if os.path.isdir(path) or (path.suffix.lower() in _ARCHIVES and "#" not in text):
        return _of_bundle(path, text, context)
    # An existing file is a path, whatever colons it has.
    reference = text if not os.path.exists(path) or path.is_absolute() else os.path.join(".", text)
    try:
        source = resolve(
            reference, relative_to=context.folder, environment=context.environment, fetching=context.fetching
        )
    except SourceError as error:
        context.sink.add(error.diagnostic)
        return None
    if source.format == "recipe":
        return _of_recipe(source.path, text, context, given=given, sample=sample)
    for name, node in (given or {}).items():
        context.sink.error(
            "unknown-name", f"`{text}` is not a recipe and has no parameter `{name}`", node.span
        )
    unit = None if given else Loader(context).unit(source, None, True)
    return None if unit is None else Outline(unit.model or unit.label, text, world_of(unit, lambda _: None))


def _of_recipe(path: Path, text: str, context: Context, given: Given | None, sample: int) -> Outline | None:
    plan = make_plan(path, context, given, sample=sample)
    if plan is None or not check_sample(plan, sample, context.sink):
        return None
    composer = Composer(context, measure_with(context), notes_parts=True)
    composed = composer.compose(plan)
    if composed is None:
        return None
    part_of = _part_of(composed.model, composer.parts, plan.separator)
    parts = tuple(_part(each, context) for each in composed.members)
    return Outline(plan.name, text, world_of(composed.model, part_of), parts=parts)


def _part_of(model: Unit, parts: dict[Node, str], separator: str) -> PartOf:
    """Return a function for the part of an element in a composition: a part, the base, or (None) the recipe itself."""

    def part_of(node: Node) -> str | None:
        if (part := parts.get(node)) is not None:
            return part
        if isinstance(model.origins.owner(node, model.file), str):
            return BASE
        # A part with a joint of its own is in a body that the linker created for it.
        inside = (parts.get(each) for each in node.iter("body"))
        return next((each for each in inside if each and f"{each}{separator}" == node.get("name")), None)

    return part_of


def _part(record: PartRecord, context: Context) -> Part:
    return Part(record.part, _named(record.source, context), record.body)


def _named(source: Source, context: Context) -> str:
    return context.shown(source.path) if source.origin is None else source.reference


def _of_bundle(path: Path, text: str, context: Context) -> Outline | None:
    try:
        bundle = read(path, shown=text)
    except ReadError as error:
        context.sink.add(error.diagnostic)
        return None
    unit = parse_text(
        bundle.files[bundle.model], context.sink, file=bundle.model, directory=path, label=path.stem
    )
    if unit is None:
        return None
    manifest = None
    if MANIFEST in bundle.files:
        try:
            manifest = from_json(bundle.files[MANIFEST])
        except ValueError:
            context.sink.warning(
                "bundle-manifest", f"the manifest of `{text}` cannot be read: parts are not known"
            )
    parts = () if manifest is None else _listed(manifest)
    world = world_of(unit, lambda node: _by_prefix(node, manifest))
    return Outline(unit.model or unit.label, text, world, parts=parts)


def _listed(manifest: Manifest) -> tuple[Part, ...]:
    return tuple(Part(each.part, manifest.inputs[each.input].reference, each.body) for each in manifest.parts)


def _by_prefix(node: Node, manifest: Manifest | None) -> str | None:
    """Return the part with the longest matching prefix; an element without one may belong to the base or the recipe."""
    name = str(node.get("name") or "")
    fitting = [
        each for each in (manifest.parts if manifest else ()) if each.prefix and name.startswith(each.prefix)
    ]
    return max(fitting, key=lambda each: len(each.prefix)).part if fitting else None
