"""Step: read a URDF source as a unit, and report missing files as for other models."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.access import held
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.collect import collect
from mjcompose.link.linking import FileUse
from mjcompose.mujoco.convert import PACKAGE
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.tree.files import join
from mjcompose.tree.unit import Unit
from mjcompose.urdf.read import UrdfReader
from mjcompose.urdf.robot import Robot, mesh_of

if TYPE_CHECKING:
    from mjcompose.mujoco.convert import Converted
    from mjcompose.mujoco.engine import Session


def urdf_unit(
    source: Source, context: Context, session: Session | None, span: Span | None, *, is_fixed: bool = True
) -> Unit | None:
    """Return the unit of a URDF file or xacro template, or None after a reported error.

    `span` is the place in the recipe that refers to it. If the robot `is_fixed` in the world, its root link is merged
    with the world, as MuJoCo does for a URDF alone.
    """
    own = _RecipeContext(context, span)
    return UrdfReader(
        source, context.sink, session, shown=context.shown, asked=span, is_fixed_in_world=is_fixed,
        missing=own.report_missing, relative=own.relative,
    ).unit()  # fmt: skip


@dataclass(frozen=True, slots=True)
class _RecipeContext:
    """The place where the recipe refers to a URDF, for paths and for reports of missing files."""

    context: Context
    span: Span | None

    def relative(self, folder: Path) -> str:
        """Return the path of a folder as the recipe writes it."""
        recipe = self.context.folder / (self.span.file if self.span else "")
        return Path(os.path.relpath(folder, recipe.parent)).as_posix()

    def report_missing(self, robot: Robot, converted: Converted) -> None:
        uses = []
        for file in converted.meshes:
            if not file.startswith(PACKAGE) and file not in robot.made and not os.path.isfile(file):
                found = held(join(str(robot.path.parent), join(converted.folder, file)))
                element = mesh_of(robot.root, file)
                uses.append(FileUse(element, "filename", file, source=found, content=None, shared=False))
        sink = Sink()
        collect(robot.unit, uses, sink, shown=self.context.shown)
        from_recipe = () if self.span is None else (Note("the recipe names it here", self.span),)
        for each in sink.diagnostics:
            help = each.help or "put the file there, or correct `filename`"
            self.context.sink.add(replace(each, notes=(*each.notes, *from_recipe), help=help))
