"""The positions of everything in the recipes of a plan, and whether a stored record depends on them."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection

from composer.cache.entry import Record
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.node import spans
from composer.plan.plan import Plan


def places(plan: Plan) -> str:
    """Return a hash of all positions in the recipes of a plan. No I/O."""
    whole = hashlib.sha256()
    for each in plan.plans():
        for span in spans(each.document):
            place = f"{span.file}:{span.line}:{span.column}:{span.end_line}:{span.end_column}\n"
            whole.update(place.encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def names_places(plan: Plan, record: Record, manifest: bytes) -> bool:
    """Return whether diagnostics or a manifest contain lines of the plan's recipes. No I/O."""
    files = {span.file for each in plan.plans() for span in spans(each.document)}
    files |= {each.file for each in plan.plans()}
    reported = [span for each in record.diagnostics for span in _spans_of(each)]
    reported += [span for check in record.checks for each in check.diagnostics for span in _spans_of(each)]
    if any(span.file in files for span in reported):
        return True
    names = "|".join(re.escape(name.replace("\\", "/").rpartition("/")[2]) for name in files)
    return re.search(rf"(?:{names}):\d".encode("utf-8", "surrogateescape"), manifest) is not None


def _spans_of(diagnostic: Diagnostic) -> Collection[Span]:
    found = [diagnostic.span, *(note.span for note in diagnostic.notes)]
    return [span for span in found if span is not None]
