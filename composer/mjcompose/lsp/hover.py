"""Information about the place at the cursor."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from mjcompose.base.rotation import Pose
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.language.expand import cells
from mjcompose.link import numbers
from mjcompose.lsp import mjcf
from mjcompose.lsp.analysis import Analysis, Hover, Known, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.language import doc_of, words_of
from mjcompose.lsp.markup import ModelQuestion
from mjcompose.lsp.places import label, matches, part_of_reference, selector_around
from mjcompose.lsp.subject import (
    Settable,
    in_model,
    named_at,
    names_in,
    of_nested,
    place_of,
    settables,
    turn_name_at,
    turn_names,
    unit_of,
)
from mjcompose.lsp.turns import readings_in, scopes, values_of as values_of_name
from mjcompose.plan.plan import PlacedModel, Plan
from mjcompose.plan.read import files_of_source
from mjcompose.sources.reference import Source
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError, with_units
from mjcompose.text.node import Mapping as Located, is_template
from mjcompose.tools.outline import Body, world_of
from mjcompose.trace.explanation import render
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.names import WORLD
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as _EtreeElement

    from mjcompose.trace.traced import Traced


def show(question: Question) -> Hover | None:
    analysis = question.analysis
    for known in named_at(question):
        return Hover(describe(in_model(known, analysis), analysis), question.word)
    return None


def describe(known: Known, analysis: Analysis) -> str:
    """Return an element in Markdown: its kind, facts with their units, and its `explain` lines."""
    lines = [f"**{known.tag} `{known.name}`**", ""]
    traced = analysis.traced
    node = known.node
    composed = traced is not None and node is not None and node in traced.watch.lives
    lines += [f"- {fact}" for fact in _facts(known, traced if composed else None)]
    if traced is not None and composed and node is not None:
        lines += ["", "```text", render(traced.element(node)).partition("\n")[2], "```"]
    if traced is None and node is not None and (unit := unit_of(known, analysis)) is not None:
        lines += mjcf.settings(node, unit)
    return "\n".join(lines)


def _facts(known: Known, traced: Traced | None) -> Iterator[str]:
    if known.part:
        yield f"part `{known.part}`"
    if known.holder:
        yield f"in body `{known.holder}`"
    if traced is None or known.node is None:
        return
    if known.namespace in ("site", "body", "frame"):
        yield from _pose(known, traced)
    if known.tag == "body":
        mass = traced.attribute(known.node, "mass").value
        yield f"mass: {mass} kg" if mass is not None else "mass: computed by MuJoCo from its geoms"
    if known.namespace == "joint":
        yield from _joint(known.node, traced)
    for name in ("ctrlrange", "forcerange"):
        if known.namespace == "actuator" and name in known.node.attrib:
            yield f"{name}: {known.node.get(name)}"


def _world(unit: Unit) -> Body:
    """Return the world of a model; an empty world for a model that nests too deep, which the diagnostics say."""
    return world_of(unit, lambda node: None, Sink()) or Body(WORLD, None)


def _pose(known: Known, traced: Traced) -> Iterator[str]:
    """Yield the pose of an element in meters: in its body, and in the world at the reference configuration."""
    for body in _world(traced.model).walk():
        for place in body.places:
            if (place.kind, place.name) == (known.tag, known.name):
                if place.kind != "body":
                    yield f"in its body: {_words(place.pose)}"
                yield f"in the world: {_words(place.world)}"


def _words(pose: Pose) -> str:
    pos = ", ".join(numbers.text([round(float(each), 6) + 0.0]) for each in pose.pos)
    turned = any(abs(float(each)) > 1e-9 for each in pose.quat[1:])
    quat = ", ".join(numbers.text([round(float(each), 4) + 0.0]) for each in pose.quat)
    return f"[{pos}] m" + (f", quat [{quat}]" if turned else "")


def _joint(node: _EtreeElement, traced: Traced) -> Iterator[str]:
    name = node.get("name")
    for joint in (each for body in _world(traced.model).walk() for each in body.joints):
        if joint.name != name:
            continue
        limits = ", no limits" if joint.type != "free" else ""
        if joint.range is not None:
            low, high = joint.range
            limits = f", range [{low:.6g}, {high:.6g}] {'m' if joint.type == 'slide' else 'rad'}"
            if joint.type != "slide":
                limits += f" = [{math.degrees(low):.4g}, {math.degrees(high):.4g}]°"
        yield f"{joint.type} joint{limits}"


_EXPRESSION_MOST = 12


def show_expression(question: Question) -> Hover | None:
    """Return the value of the text with `${…}` at the cursor, or None."""
    text = question.cursor.whole
    path = place_of(question)
    if not is_template(text) or not isinstance(question.tree, Located):
        return None
    values = values_of(text, question.tree, path)
    lines = [f"`{text}`", ""]
    if len(set(values.values())) == 1:
        lines.append(f"= **{next(iter(values.values()))}**")
    elif values:
        head = "for" if any(turn_names(question.tree, path)) else "cell"
        lines += _table(head, values)
    else:
        scope = next(iter(scopes(question.tree, path, {})), {})
        for reading, rows in readings_in(text, scope):
            lines += _table(f"`{reading}`", {name: with_units(value) for name, value in rows.items()})
    if len(lines) == 2:
        return None
    declared = settables(question.data)
    used = dict.fromkeys(name for name, _, _ in names_in(text))
    about = _settable_lines(declared[name] for name in used if name in declared)
    return Hover("\n".join([*lines, "", *about]), question.word)


def _table(head: str, values: Mapping[str, str]) -> Iterator[str]:
    yield from (f"| {head} | value |", "|---|---|")
    yield from (f"| {name} | **{value}** |" for name, value in list(values.items())[:_EXPRESSION_MOST])
    if len(values) > _EXPRESSION_MOST:
        yield f"| … and {len(values) - _EXPRESSION_MOST} more | |"


def show_turn_name(question: Question) -> Hover | None:
    """Return the values of the name of a `for` at the cursor, or None."""
    name = turn_name_at(question, question.tree)
    if name is None or not isinstance(question.tree, Located):
        return None
    values = [with_units(value) for value in values_of_name(name, question.tree)]
    shown = ", ".join(values[:_EXPRESSION_MOST])
    more = f" … and {len(values) - _EXPRESSION_MOST} more" if len(values) > _EXPRESSION_MOST else ""
    about = f"**`{name.key.name}`**, a name of `for` with {counted(len(values), 'value')}: {shown}{more}"
    expression = show_expression(question)
    return Hover(about if expression is None else f"{expression.text}\n\n{about}", question.word)


def values_of(text: str, document: Located, path: Path) -> dict[str, str]:
    """Return the value of a text at a path by cell and turn, or by an empty name if there is only one.

    Nothing if a name has no value yet.
    """
    names = [each.key.name for each in turn_names(document, path)]
    try:
        template = Template.parse(text)
        values: dict[str, str] = {}
        for given in [cell.given for cell in cells(document, "", Sink())] or [{}]:
            cell = [f"{name} {getattr(node, 'text', '…')}" for name, node in given.items()]
            for scope in scopes(document, path, given):
                turn = [f"{name} {with_units(scope[name])}" for name in names]
                values[", ".join([*cell, *turn])] = with_units(template.value(scope))
    except ExpressionError:
        return {}
    return values


def show_key(question: Question) -> Hover | None:
    cursor = question.cursor
    if cursor.role != "value" and cursor.whole:
        text = doc_of((*cursor.path, cursor.whole), question.data)
        return Hover(f"**`{cursor.whole}`**\n\n{text}", question.word) if text else None
    text = words_of(question.forms).get(cursor.whole.strip(), "")
    text = text or (doc_of(cursor.path, question.data) if cursor.path and isinstance(cursor.path[-1], str) else "")
    return Hover(f"**`{cursor.whole.strip()}`**\n\n{text}", question.word) if text else None


_MODEL_MOST = 24


def show_model(question: Question) -> Hover | None:
    plan = question.analysis.plan
    if question.cursor.role == "key" or plan is None:
        return None
    name = part_of_reference(question.path, plan)
    place = next((each for each in plan.walk() if each.part == name and each.model is not None), None)
    return None if place is None else Hover("\n".join(_lines(place, question)), question.word)


def _lines(placed: PlacedModel, question: Question) -> Iterator[str]:
    model = placed.model
    source = model.source if isinstance(model, Plan) else model
    if source is not None:
        form = "recipe" if isinstance(model, Plan) else source.format.upper()
        yield from _of_source(source, form, question)
    if isinstance(model, Plan):
        if model.description:
            yield f"- {model.description}"
        yield f"- parts: {', '.join(f'`{part}`' for part in model.part_names) or 'none'}"
        at = question.path[:-1] if question.path != ("base",) else question.path
        yield from _settable_lines(of_nested(at, question).values())
    elif model is not None:
        unit = question.analysis.names.sources.get(placed.part)
        if unit is not None:
            yield from _of_model(model, unit)


def _of_source(source: Source, form: str, question: Question) -> Iterator[str]:
    yield from (f"**`{source.reference}`**", "")
    version = f", version {source.version}" if source.version else ""
    yield f"- {source.kind.name}, {form}{version}"
    yield f"- file: `{question.analysis.path.parent.joinpath(source.path)}`"
    texts = ", ".join(f"`{text.name}`" for text in source.licenses) or "no text was found"
    yield f"- license: {source.license} {texts}" if source.license else f"- license: {texts}"


def _settable_lines(settables: Iterable[Settable]) -> Iterator[str]:
    for each in settables:
        yield f"- `{each.name}`: {each.detail}{'; ' if each.doc else ''}{each.doc}"


def _of_model(source: Source, unit: Unit) -> Iterator[str]:
    world = _world(unit)
    bodies = list(world.walk())[1:]
    counts = {"body": len(bodies), "joint": sum(len(body.joints) for body in (world, *bodies))}
    for word, section in (("actuator", "actuator"), ("sensor", "sensor"), ("key", "keyframe")):
        counts[word] = sum(len(each.findall("*")) for each in unit.root.iterchildren(section))
    yield "- " + ", ".join(counted(count, word) for word, count in counts.items() if count)
    files = list(files_of_source(source))
    yield f"- {len(files)} files, {sum(os.path.getsize(each) for each in files) / 1e6:.2f} MB"
    places = [place for body in (world, *bodies) for place in body.places if place.kind != "body"]
    if places:
        yield from ("", "places to attach to:")
        for place in places[:_MODEL_MOST]:
            pos = ", ".join(f"{float(each):.4g}" for each in place.world.pos)
            yield f"- {place.kind} `{place.name}` at [{pos}] m"
    named = [f"`{body.name}`" for body in bodies if body.name]
    more = f" and {len(named) - _MODEL_MOST} more" if len(named) > _MODEL_MOST else ""
    yield f"\nbodies: {', '.join(named[:_MODEL_MOST])}{more}"


_SELECTOR_MOST = 20


def show_selector(question: Question) -> Hover | None:
    around = selector_around(question)
    found = None if around is None else matches(*around, question.analysis)
    if around is None or found is None:
        return None
    where = ", of which `where` may exclude some" if "where" in around[1] else ""
    lines = [f"**matches {counted(len(found), 'element')}** of the finished model{where}", ""]
    lines += [f"- {label(node)}" for node in found[:_SELECTOR_MOST]]
    if len(found) > _SELECTOR_MOST:
        lines.append(f"- … and {len(found) - _SELECTOR_MOST} more")
    return Hover("\n".join(lines), question.word)


SECTIONS = ("option", "size", "statistic", "visual")


def show_setting(question: Question) -> Hover | None:
    path = (*question.path, question.cursor.whole) if question.cursor.role == "key" else question.path
    if len(path) < 2 or path[0] not in SECTIONS or not all(isinstance(step, str) for step in path):
        return None
    place = "/".join(map(str, path[:-1]))
    if place not in GRAMMAR.paths or path[-1] not in GRAMMAR.element(place).attributes:
        return None
    lines = [f"**`{'.'.join(map(str, path))}`**", "", doc_of(path, question.data), ""]
    rows = list(_values(tuple(map(str, path)), question))
    if rows:
        lines += ["| part | value |", "|---|---|", *rows]
    return Hover("\n".join(lines), question.word)


def _values(path: tuple[str, ...], question: Question) -> Iterator[str]:
    analysis = question.analysis
    units = [(f"`{part}`", unit) for part, unit in analysis.names.sources.items()]
    units += [("**the model**", analysis.model.unit)] if analysis.model is not None else []
    for name, unit in units:
        for element in unit.root.iterfind("/".join(path[:-1])):
            value = element.get(path[-1])
            if value is not None:
                span = unit.origins.span(element, unit.file, path[-1])
                is_part = name.startswith("`")
                yield f"| {name} | `{value}` ({span.file}:{span.line}) |" if is_part else f"| {name} | **`{value}`** |"


SHOWS = (show_turn_name, show_expression, show, show_model, show_setting, show_selector, show_key)


def hover(question: Question) -> Hover | None:
    if question.cursor.role == "text":
        return None
    if isinstance(question, ModelQuestion):
        texts = [found.text for each in (show, *mjcf.SHOWS) if (found := each(question)) is not None]
        return Hover("\n\n---\n\n".join(texts), question.word) if texts else None
    return next((found for show in SHOWS if (found := show(question)) is not None), None)
