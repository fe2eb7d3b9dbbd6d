from __future__ import annotations

from composer.cache.entry import Record, from_json, to_json
from composer.diagnostics.diagnostic import Diagnostic, Note, Severity
from composer.diagnostics.span import Span
from composer.verify.outcome import Outcome

SPAN = Span("cell.yaml", 1, 2, 3, 4)
WARNING = Diagnostic(
    "lock-stale", "`tool` is not in the lock", SPAN, Severity.WARNING, (Note("a note", SPAN),), "a help", (Note("more"),),
    subjects=frozenset({"tool", "arm"}),
)  # fmt: skip
RECORD = Record(
    name="cell", model="model.xml", sha256="0" * 64, sizes=None, merged={}, files=(), text=None, mujoco=None, licences=(),
    diagnostics=(WARNING,), checks=(Outcome("upright", "stable", SPAN, (WARNING,), {}),), draws=None, recipes=(),
    places="", names_places=False, cells=0, cells_at=None,
)  # fmt: skip


def test_what_is_kept_of_a_build_is_read_as_it_was_written() -> None:
    read = from_json(to_json(RECORD))
    assert read == RECORD
    assert read.diagnostics[0].subjects == WARNING.subjects
