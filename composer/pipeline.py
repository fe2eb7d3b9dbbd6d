"""From a recipe to a verified bundle: the stages in order. Each takes what the one before it gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from composer.bundle.assemble import assemble
from composer.bundle.bundle import Bundle
from composer.context import Context
from composer.document import load
from composer.document.node import Mapping
from composer.engine import Limits
from composer.plan.make import make_plan
from composer.plan.plan import Plan
from composer.recipe.recipe import Recipe
from composer.recipe.validate import validate
from composer.steps.compose import Composed, Composer
from composer.verify.measured import measure_with
from composer.verify.report import Report, verify


@dataclass(frozen=True, slots=True)
class Built:
    """What a build gives; `report` is None where nothing was verified."""

    plan: Plan
    composed: Composed
    bundle: Bundle
    report: Report | None


def build(recipe: Path, context: Context, *, verified: bool = True, limits: Limits | None = None) -> Built | None:
    """The bundle of a recipe, nothing written yet; None where `context.sink` has errors."""
    plan = plan_recipe(recipe, context)
    if plan is None:
        return None
    composed = Composer(context, measure_with(context, limits)).compose(plan)
    if composed is None:
        return None
    bundle = assemble(plan, composed.model, composed.files, context)
    if bundle is None:
        return None
    report = verify(bundle, composed.model, context, limits) if verified else None
    if context.sink.has_errors:
        return None
    return Built(plan, composed, bundle if report is None else report.bundle, report)


def plan_recipe(recipe: Path, context: Context) -> Plan | None:
    """What a build of the recipe will do, or None where the recipe or what it refers to is at fault."""
    read = read_recipe(recipe, context)
    return None if read is None else make_plan(*read, recipe, context, read_recipe)


def read_recipe(path: Path, context: Context) -> tuple[Recipe, Mapping] | None:
    """The validated recipe, and the located tree that says where everything in it is written."""
    shown = context.shown(path)
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        context.sink.error("file-not-found", f"there is no recipe `{shown}`")
        return None
    except OSError as error:
        context.sink.error("file-unreadable", f"`{shown}` cannot be read: {(error.strerror or '').lower()}")
        return None
    before = len(context.sink.errors)
    node = load(text, shown, context.sink)
    if node is None or len(context.sink.errors) > before:
        return None
    found = validate(node, context.sink)
    return None if found is None or not isinstance(node, Mapping) else (found, node)
