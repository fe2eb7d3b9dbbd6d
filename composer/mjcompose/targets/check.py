"""The check `targets`: other programs support everything in the model, and read it correctly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mjcompose.language.checks.targets import Targets

if TYPE_CHECKING:
    from mjcompose.sources.context import Context
    from mjcompose.verify.run_checks import Checks, NestedRecipe


def run(checks: Checks, check: Targets, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Write the model for each target and have it read there; report losses and differences to the context."""
    from mjcompose.targets.read_back import Work, carry_out
    from mjcompose.verify.compile import WHOLE
    from mjcompose.verify.run_checks import report

    work = Work(checks.bundle, WHOLE, checks.session, environment=context.environment)
    findings, values = carry_out(work, check)
    for finding in findings:
        report(finding, check, recipe, context=context)
    return values
