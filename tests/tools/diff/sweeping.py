"""Changes one value after the other, and asks `diff` which line is the reason."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from mjcompose.base.sink import Sink
from mjcompose.contrast.changes import Diff, FieldChange
from mjcompose.mujoco.engine import Session
from mjcompose.sides.operand import Operand, OperandKind
from mjcompose.sides.side import Side, load
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import between
from tools.diff.changing import Value

_TRIES = 4
Lines = dict[tuple[str, int] | None, tuple[FieldChange, ...]]
"""The changes by the file and line that `diff` names; None for those without one."""


@dataclass(frozen=True)
class Named:
    """What `diff` says when a value is written in another way."""

    value: Value
    written: str
    lines: Lines
    wanted: tuple[str, int]

    @property
    def is_right(self) -> bool:
        """Whether the line that was changed is named, and no other; a model may differ in its name or a size alone."""
        return set(self.lines) <= {self.wanted}

    def __str__(self) -> str:
        wrong = [(line, changes[:2]) for line, changes in self.lines.items() if line != self.wanted]
        return f"{self.value} -> {self.written}: {wrong}"


class Sweep:
    """A recipe and its models in two folders, `a` and `b`; A is composed once.

    In every file of B another line is new, which makes no difference: so no line is the only one that differs.
    """

    def __init__(self, folder: Path, recipe: Path, session: Session) -> None:
        self.session = session
        self.name = recipe.name
        self.a = folder / "a"
        self.b = folder / "b"
        for end in (self.a, self.b):
            shutil.copytree(recipe.parent / "models", end / "models")
            for file in recipe.parent.glob("*.yaml"):
                shutil.copy(file, end)
        for file in (*self.b.rglob("*.yaml"), *self.b.rglob("*.xml")):
            file.write_text(_with_a_line(file, file.read_text()))
        side = self._side(self.a, "sweep a")
        assert side is not None
        self.side = side

    def of(self, value: Value) -> Named | None:
        """What `diff` says of one change; None where no other value gives another model."""
        file = value.file.relative_to(self.a)
        there = self.b / file
        before = there.read_text()
        try:
            for other in value.others[:_TRIES]:
                there.write_text(_with_a_line(there, value.changed(other)))
                side = self._side(self.b, "sweep b")
                found = None if side is None else between(self.side, side, Context(), self.session)
                if found is not None and not found.same:
                    return Named(value, other, _lines(found), (file.as_posix(), value.line))
        finally:
            there.write_text(before)
        return None

    def _side(self, folder: Path, kept: str) -> Side | None:
        context = Context(folder=folder, sink=Sink())
        path = folder / self.name
        side = load(Operand(self.name, OperandKind.RECIPE, path, context), kept, self.session)
        return None if context.sink.has_errors else side


def _with_a_line(file: Path, text: str) -> str:
    comment = "# another line" if file.suffix == ".yaml" else "<!-- another line -->"
    return f"{text.rstrip()}\n{comment}\n"


def _lines(found: Diff) -> Lines:
    lines: Lines = {}
    for group in found.groups:
        span = None if group.cause is None else group.cause.after or group.cause.before
        place = None if span is None else (Path(span.file).as_posix(), span.line)
        lines[place] = lines.get(place, ()) + group.changes
    return lines
