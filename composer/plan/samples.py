"""Whether a recipe has a sample of a number."""

from __future__ import annotations

from composer.diagnostics.sink import Sink
from composer.document.node import locate
from composer.plan.plan import Plan


def check_sample(plan: Plan, sample: int, sink: Sink) -> bool:
    """Whether the recipe draws this sample; the sink gets an error where it does not. 0 is the model without draws."""
    if sample <= (plan.randomize.samples if plan.randomize else 0):
        return True
    span = None if plan.randomize is None else locate(plan.document, ("randomize", "samples"))
    there = "draws nothing" if plan.randomize is None else f"has the samples 0 to {plan.randomize.samples}"
    sink.error("unknown-name", f"there is no sample {sample}: the recipe {there}", span)
    return False
