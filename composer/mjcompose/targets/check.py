"""The check `targets`: other programs support everything in the model, and read it correctly."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.check import Check
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import OWNER
from mjcompose.language.forms.scalars import Items
from mjcompose.targets.names import NAMES, READ_IN

if TYPE_CHECKING:
    from mjcompose.sources.context import Context
    from mjcompose.verify.run_checks import Checks, NestedRecipe

if TYPE_CHECKING:
    Lacking: TypeAlias = str
else:
    Lacking = Literal[NAMES[2:]]  # the targets that lack something of MuJoCo


class Targets(Check):
    """Other programs read the whole model, with the same numbers, poses and motion."""

    word: ClassVar = "targets"
    is_in_mujoco: ClassVar = False
    short: ClassVar = "in"
    short_type: ClassVar = (str, list)
    example: ClassVar = "[mjx, drake]"

    targets: Annotated[tuple[Lacking, ...], Items(1, single=True, unique=True)] = Field(
        alias="in", examples=["[mjx, drake]"]
    )
    """the targets"""
    read: bool = True
    """false only looks for losses; the programs need not be installed"""
    losses: Literal["error", "warning"] = "error"
    """`warning` reports losses as warnings"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        for index, name in enumerate(self.targets if self.read else ()):
            if name not in READ_IN:
                message = f"{OWNER} cannot use `{name}`: no check reads models in it"
                help = f"write `targets: {{in: [{name}], read: false}}`, which checks that nothing is lost"
                yield Fault("wrong-keyword", message, ("in", index), help=help)


KIND = Targets


def run(checks: Checks, check: Targets, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Write the model for each target and have it read there; report losses and differences to the context."""
    from mjcompose.targets.read_back import Work, carry_out
    from mjcompose.verify.compile import WHOLE
    from mjcompose.verify.run_checks import report

    work = Work(checks.bundle, WHOLE, checks.session, environment=context.environment)
    findings, values = carry_out(work, check.asked())
    for finding in findings:
        report(finding, check, recipe, context=context)
    return values
