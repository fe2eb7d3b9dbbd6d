"""The elements whose names are at a cursor, and where they are written."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from composer.diagnostics.span import Span
from composer.lsp.analysis import Analysis
from composer.lsp.cursor import Path
from composer.lsp.language import forms_at
from composer.lsp.names import Known
from composer.lsp.places import PART, Wanted, fitting, part_at, wanted_key, wanted_value
from composer.lsp.question import Question
from composer.tree.unit import Unit


def wanted_as_value(question: Question) -> Wanted | None:
    """Return which names the value at the cursor can be."""
    path = question.path
    if question.cursor.role not in ("value", "either") or not path:
        return None
    around = path[:-2] if isinstance(path[-1], int) else path[:-1]
    forms = [
        *forms_at(path[:-1], question.data),
        *(forms_at(around, question.data) if around != path[:-1] else ()),
    ]
    return wanted_value(path, forms, question.at(around))


def wanted_at(question: Question) -> Wanted | None:
    """Return which names can be at the cursor, or None if no names can."""
    found = wanted_as_value(question)
    if found is None and question.cursor.role in ("key", "either"):
        return wanted_key(question.path)
    return found


def named_at(question: Question) -> list[Known]:
    """Return the elements that the name at the cursor means, of the most likely kind. A pattern means none."""
    wanted, name, analysis = wanted_at(question), question.cursor.whole.strip(), question.analysis
    if wanted is None or not name:
        return []
    found = [
        (rank, each) for rank, each in fitting(wanted, analysis.names, analysis.plan) if each.name == name
    ]
    best = min((rank for rank, _ in found), default=0)
    return [each for rank, each in found if rank == best and each.namespace != PART]


def part_named_at(question: Question) -> Path | None:
    """Return the path of the part that the cursor names: at its key, or where another entry refers to it."""
    cursor, plan = question.cursor, question.analysis.plan
    if cursor.role in ("key", "either") and cursor.path == ("attach",) and cursor.whole:
        return ("attach", cursor.whole)
    wanted = wanted_at(question)
    if wanted is None or PART not in wanted.namespaces or plan is None:
        return None
    at: Path = ("base",) if cursor.whole == "base" else ("attach", cursor.whole)
    return at if at == ("base",) or part_at(at, plan) is not None else None


def declared_at(known: Known, analysis: Analysis) -> Iterator[Span]:
    """Yield where an element is written: in a model, in this recipe or in another one."""
    node, traced = known.node, analysis.traced
    if node is None:
        return
    if traced is not None and node in traced.watch.lives:
        life = traced.watch.life(node)
        named = traced.written_at(node, "class" if node.tag == "default" else "name") if known.name else None
        places = [named] if named is not None else [each.span for each in traced.written(life)]
        for span in dict.fromkeys(places):
            if span is not None and (now := analysis.now(span, analysis.model_of)) is not None:
                yield now
        return
    unit = unit_of(known, analysis)
    if unit is not None:
        yield unit.origins.span(node, unit.file, "name")


def unit_of(known: Known, analysis: Analysis) -> Unit | None:
    """Return the source of an element that is not in the composed model, or None."""
    if known.node is None:
        return None
    root = known.node.getroottree().getroot()
    return next((unit for unit in analysis.names.sources.values() if unit.root is root), None)


def in_model(known: Known, analysis: Analysis) -> Known:
    """Return the element in the composed model, given one with a name inside a part."""
    traced = analysis.traced
    if known.node is None or traced is None or known.node in traced.watch.lives:
        return known
    unit = unit_of(known, analysis)
    part = next((part for part, each in analysis.names.sources.items() if each is unit), None)
    prefix = analysis.names.prefixes.get(part or "", "")
    found = analysis.names.find(known.namespace, prefix + known.name)
    return known if found is None else replace(found)
