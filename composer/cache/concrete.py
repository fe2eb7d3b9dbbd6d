"""A plan as text: what is built, without where it is written; and where it is written."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Iterator

from composer.cache.entry import Record
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar, Sequence, spans
from composer.plan.plan import Plan
from composer.sources.source import Source


def concrete(plan: Plan) -> list[object]:
    """All that the outcome of a plan depends on besides the contents of files, as JSON has it. No I/O.

    The lines and columns of recipes are left out, their files are not: paths count from them.
    """
    found: list[object] = []
    for each in plan.plans():
        told = [[name, repr(value)] for name, value in sorted(each.scope.items())]
        values = list(_values(each.document, ""))
        read = [[file, reading.angle, reading.eulerseq] for file, reading in each.readings.others.items()]
        sources = [_source(each.base.model), *(_source(part.model) for part in each.parts)]
        found.append([each.name, str(each.path), told, values, read, sources])
    return found


def _source(model: Plan | Source | None) -> object:
    if not isinstance(model, Source):
        return model is None
    licences, packages = [map(str, model.licences), ((name, str(path)) for name, path in model.packages)]
    about = [str(model.path), model.kind.name, model.reference, model.package, model.version]
    return [*about, list(licences), list(packages), model.origin.id if model.origin else None]


def _values(node: Node, file: str) -> Iterator[object]:
    if node.span.file != file:
        file = node.span.file
        yield ["in", file]
    if isinstance(node, Scalar):
        yield [node.text, node.plain, repr(node.value)]
        return
    yield "{" if isinstance(node, Mapping) else "["
    if isinstance(node, Sequence):
        for item in node.items:
            yield from _values(item, file)
    else:
        for name, (_, value) in node.entries.items():
            yield name
            yield from _values(value, file)
    yield "."


def places(plan: Plan) -> str:
    """A hash of where everything is written in the recipes of a plan. No I/O."""
    whole = hashlib.sha256()
    for each in plan.plans():
        for span in spans(each.document):
            place = f"{span.file}:{span.line}:{span.column}:{span.end_line}:{span.end_column}\n"
            whole.update(place.encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def tells_places(plan: Plan, record: Record, manifest: bytes) -> bool:
    """Whether what was told, or a manifest, names lines of the plan's recipes. No I/O."""
    files = {span.file for each in plan.plans() for span in spans(each.document)}
    files |= {each.file for each in plan.plans()}
    told = [span for each in record.diagnostics for span in _spans_of(each)]
    told += [span for check in record.checks for each in check.told for span in _spans_of(each)]
    if any(span.file in files for span in told):
        return True
    names = "|".join(re.escape(name.replace("\\", "/").rpartition("/")[2]) for name in files)
    return re.search(rf"(?:{names}):\d".encode("utf-8", "surrogateescape"), manifest) is not None


def _spans_of(diagnostic: Diagnostic) -> Collection[Span]:
    found = [diagnostic.span, *(note.span for note in diagnostic.notes)]
    return [span for span in found if span is not None]
