"""Hover for `model:`: the file that the reference leads to, its licence and size, and where parts can be attached."""

from __future__ import annotations

import os
from collections.abc import Iterator

from composer.lsp.answers import Hover
from composer.lsp.parameters import of_nested
from composer.lsp.places import part_of_reference
from composer.lsp.question import Question
from composer.outline.of_unit import world_of
from composer.plan.plan import Place, Plan
from composer.plan.used_files import files_of_source
from composer.sources.source import Source
from composer.tree.unit import Unit

_MOST = 24


def show(question: Question) -> Hover | None:
    """Return information about the model reference at the cursor, or None."""
    plan = question.analysis.plan
    if question.cursor.role == "key" or plan is None:
        return None
    name = part_of_reference(question.path, plan)
    place = next((each for each in plan.walk() if each.part == name), None)
    if place is None or place.model is None:
        return None
    return Hover("\n".join(_lines(place, question)), question.word)


def _lines(place: Place, question: Question) -> Iterator[str]:
    model = place.model
    source = model.source if isinstance(model, Plan) else model
    if source is not None:
        yield f"**`{source.reference}`**"
        yield ""
        version = f", version {source.version}" if source.version else ""
        yield f"- {source.kind.name}, {'recipe' if isinstance(model, Plan) else source.format.upper()}{version}"
        yield f"- file: `{question.analysis.path.parent.joinpath(source.path)}`"
        texts = ", ".join(f"`{each.name}`" for each in source.licences)
        yield f"- licence: {source.licence or ''}{' ' if source.licence else ''}{texts or 'no text was found'}"
    if isinstance(model, Plan):
        yield from _of_recipe(model, question)
        return
    unit = question.analysis.names.sources.get(place.part)
    if isinstance(model, Source) and unit is not None:
        yield from _of_model(model, unit)


def _of_recipe(plan: Plan, question: Question) -> Iterator[str]:
    if plan.description:
        yield f"- {plan.description}"
    yield f"- parts: {', '.join(f'`{part}`' for part in plan.part_names) or 'none'}"
    for each in of_nested(
        question.path[:-1] if question.path != ("base",) else question.path, question
    ).values():
        yield f"- `{each.name}`: {each.detail}{'; ' if each.doc else ''}{each.doc}"


def _of_model(source: Source, unit: Unit) -> Iterator[str]:
    world = world_of(unit, lambda node: None)
    bodies = list(world.walk())[1:]
    joints = sum(len(body.joints) for body in (world, *bodies))
    counts = {"body": len(bodies), "joint": joints}
    for section in ("actuator", "sensor", "keyframe"):
        found = sum(len(list(each.iterchildren("*"))) for each in unit.root.iterchildren(section))
        counts[{"keyframe": "key"}.get(section, section)] = found
    yield "- " + ", ".join(_count(count, word) for word, count in counts.items() if count)
    files = list(files_of_source(source))
    size = sum(os.path.getsize(each) for each in files)
    yield f"- {len(files)} files, {size / 1e6:.2f} MB"
    places = [place for body in (world, *bodies) for place in body.places if place.kind != "body"]
    if places:
        yield ""
        yield "places to attach to:"
        for place in places[:_MOST]:
            pos = ", ".join(f"{float(each):.4g}" for each in place.world.pos)
            yield f"- {place.kind} `{place.name}` at [{pos}] m"
    named = [f"`{body.name}`" for body in bodies if body.name]
    more = f" and {len(named) - _MOST} more" if len(named) > _MOST else ""
    yield f"\nbodies: {', '.join(named[:_MOST])}{more}"


def _count(count: int, word: str) -> str:
    plural = {"body": "bodies"}.get(word, f"{word}s")
    return f"{count} {word if count == 1 else plural}"
