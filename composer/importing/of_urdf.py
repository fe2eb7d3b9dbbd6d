"""A recipe that starts from a URDF or a template for xacro, and the table of what is read of it."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Severity
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.engine import Session
from composer.sources.error import SourceError
from composer.sources.resolve import resolve
from composer.sources.urdf_choices import UrdfChoices
from composer.tree.read_row import ReadRow
from composer.tree.unit import Unit
from composer.urdf.inertia import CODE as INERTIA
from composer.urdf.read import UrdfReader
from composer.urdf.report import CODE as UNREAD

SUFFIXES = (".urdf", ".xacro")


@dataclass(frozen=True, slots=True)
class OfUrdf:
    """The text of the recipe; the rows of what was read and what was not, each with its place."""

    text: str
    rows: tuple[ReadRow, ...]


def of_urdf(path: Path, target: Path, context: Context) -> OfUrdf | None:
    """The recipe for a URDF, with all that it needs to build; None where it has faults, which go to the sink."""
    try:
        source = resolve(str(path.absolute()), relative_to=target.parent, environment=context.environment)
    except SourceError as error:
        context.sink.add(error.at(Span(context.shown(path), 1, 1)))
        return None
    choices = UrdfChoices(visuals="keep")
    with Session() as session:
        reader = UrdfReader(replace(source, urdf=choices), Sink(), session, shown=context.shown)
        unit = reader.unit()
        if unit is None and {each.code for each in reader.sink.errors} == {INERTIA}:
            choices = replace(choices, inertia="mend")
            reader = UrdfReader(replace(source, urdf=choices), Sink(), session, shown=context.shown)
            unit = reader.unit()
    for each in reader.sink.diagnostics:
        if each.code != UNREAD or each.severity is Severity.ERROR:
            context.sink.add(each)
    if unit is None:
        return None
    has_unread = any(row.why and not row.is_minor for row in unit.table)
    return OfUrdf(_text(path, target, unit, choices=choices, has_unread=has_unread), unit.table)


def _text(path: Path, target: Path, unit: Unit, choices: UrdfChoices, has_unread: bool) -> str:
    file = Path(os.path.relpath(path.absolute(), target.absolute().parent)).as_posix()
    file = file if file.startswith(".") else f"./{file}"
    keys = {"visuals": choices.visuals, "inertia": choices.inertia}
    lines = [
        "recipe: 1",
        f"name: {path.name.partition('.')[0]}",
        "",
        "base:",
        f"  model: {file}",
        f"  urdf: {{{', '.join(f'{name}: {value}' for name, value in keys.items() if value)}}}",
    ]
    if has_unread:
        lines.append(f"  allow: [{UNREAD}]")
    moving = [each for each in unit.root.iter("joint") if each.get("name")]
    if unit.root.find("actuator") is None and moving:
        lines += ["", "# The file commands no joint: `actuators: all` in `urdf` gives each of them a motor."]
    return "\n".join(lines) + "\n"


def table(rows: tuple[ReadRow, ...]) -> list[str]:
    """The rows as text: first what was read, then what was not."""
    found = []
    for heading, chosen in (
        ("read", [row for row in rows if not row.why]),
        ("not in the model", [row for row in rows if row.why]),
    ):
        if chosen:
            found.append(f"{heading}:")
        width = max((len(row.called) for row in chosen), default=0)
        found += [f"  {row.called:{width}}  {row.why or row.became}  ({row.span})" for row in chosen]
    return found
