"""Step: read a URDF source as a unit, and report missing files as for other models."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.collect import collect
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.engine import PACKAGE
from composer.link.linking import FileUse
from composer.reading.door import held
from composer.sources.source import Source
from composer.tree.files import join
from composer.tree.unit import Unit
from composer.tree.urdf import mesh_of
from composer.urdf.read import UrdfReader
from composer.urdf.robot import Robot

if TYPE_CHECKING:
    from composer.engine import Converted, Session


def urdf_unit(
    source: Source, context: Context, session: Session | None, span: Span | None, *, stands: bool = True
) -> Unit | None:
    """Return the unit of a URDF file or xacro template, or None after a reported error.

    `span` is the place in the recipe that refers to it. If the robot `stands` in the world, its root link is merged
    with the world, as MuJoCo does for a URDF alone.
    """
    beside = _Beside(context, span)
    reader = UrdfReader(
        source,
        context.sink,
        session,
        shown=context.shown,
        asked=span,
        stands=stands,
        missing=beside.report_missing,
        relative=beside.relative,
    )
    return reader.unit()


@dataclass(frozen=True, slots=True)
class _Beside:
    """What only the caller knows: where the recipe refers to the file, and how missing files are reported."""

    context: Context
    asked: Span | None

    def relative(self, folder: Path) -> str:
        """Return the path of a folder as the recipe writes it."""
        recipe = self.context.folder / (self.asked.file if self.asked else "")
        return Path(os.path.relpath(folder, recipe.parent)).as_posix()

    def report_missing(self, robot: Robot, converted: Converted) -> None:
        uses = []
        for file in converted.meshes:
            if not file.startswith(PACKAGE) and file not in robot.made and not os.path.isfile(file):
                found = held(join(str(robot.path.parent), join(converted.folder, file)))
                uses.append(
                    FileUse(
                        mesh_of(robot.root, file), "filename", file, source=found, content=None, shared=False
                    )
                )
        sink = Sink()
        collect(robot.unit, uses, sink, shown=self.context.shown)
        asked = () if self.asked is None else (Note("the recipe takes it from here", self.asked),)
        for each in sink.diagnostics:
            help = each.help or "put the file there, or correct `filename`"
            self.context.sink.add(replace(each, notes=(*each.notes, *asked), help=help))
