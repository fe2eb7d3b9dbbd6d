"""Go to definition: from a name to the place where it is written, in a model or a recipe."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File

from composer.diagnostics.span import Span
from composer.document.node import Mapping, find, locate
from composer.lsp.parameters import nested_document, parameter_at
from composer.lsp.places import part_of_reference
from composer.lsp.question import Question
from composer.lsp.subject import declared_at, in_model, named_at, part_named_at
from composer.plan.plan import Plan


def definition(question: Question) -> list[Span]:
    """Return the places where what is at the cursor is defined."""
    return list(
        dict.fromkeys([*_elements(question), *_part(question), *_parameter(question), *_model(question)])
    )


def _elements(question: Question) -> Iterator[Span]:
    for known in named_at(question):
        yield from declared_at(in_model(known, question.analysis), question.analysis)


def _part(question: Question) -> Iterator[Span]:
    at, tree = part_named_at(question), question.analysis.mapping
    if at is not None and tree is not None and find(tree, at) is not None:
        span = question.analysis.now(locate(tree, at, key=True), question.analysis.tree_of)
        yield from () if span is None else (span,)


def _parameter(question: Question) -> Iterator[Span]:
    found = parameter_at(question)
    if found is None:
        return
    name, nested = found
    tree = question.analysis.mapping if nested is None else nested_document(nested, question)
    for section in ("params", "variants"):
        if isinstance(tree, Mapping) and find(tree, (section, name)) is not None:
            span = question.analysis.now(locate(tree, (section, name), key=True), question.analysis.tree_of)
            yield from () if span is None else (span,)


def _model(question: Question) -> Iterator[Span]:
    """Yield the start of the file that a model reference leads to."""
    plan = question.analysis.plan
    if question.cursor.role == "key" or plan is None:
        return
    if question.path == ("extends",):
        yield from (Span(str(source.path), 1, 1, 1, 1) for source, _ in plan.extended[:1])
    name = part_of_reference(question.path, plan)
    for place in plan.walk():
        if place.part == name and place.model is not None:
            file: File = place.model.path
            if not (isinstance(place.model, Plan) and place.model.at):
                yield Span(str(file), 1, 1, 1, 1)
            return
