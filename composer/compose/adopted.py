"""Find the settings that the model of a plan takes from its parts, without composing the model."""

from __future__ import annotations

from dataclasses import replace

from lxml import etree

from composer.compose.compose import Composer
from composer.compose.elements import ElementBuilder
from composer.compose.load import Library
from composer.compose.section import set_singleton
from composer.compose.subtree import PartRequest, part_requests
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.adopting import common_settings, of_base
from composer.link.linking import Linking
from composer.link.measure import measure_with
from composer.link.written import SINGLETONS, opinions, set_value
from composer.plan.plan import Plan
from composer.plan.steps.set_singleton import SetSingleton
from composer.tree.adopted import Adopted
from composer.tree.unit import Unit


def adopted_settings(plan: Plan, context: Context, library: Library) -> tuple[Adopted, ...]:
    """Return the settings that all parts agree on, among the parts that write them. A faulty model gives none.

    Sources that the library has are not read again.
    """
    if not plan.parts:
        return ()
    aside = replace(context, sink=Sink())
    composer = Composer(aside, measure_with(aside), library=library)
    composer.expect(plan)
    return composer.guarded(plan, True, lambda again: _settings(plan, again, True).adopted) or ()


def _settings(plan: Plan, composer: Composer, stands: bool) -> Unit:
    """Return a unit with only the settings of a plan's model."""
    base, *parts = [_of(each, plan, composer) for each in part_requests(plan, stands)]
    found, _ = common_settings(
        asked := opinions(base),
        [(step.prefix or part.label, opinions(part)) for step, part in zip(plan.parts, parts, strict=True)],
        plan.settled,
    )
    adopted = (*of_base(base.adopted, asked, plan.settled), *found.values())
    unit = Unit(base.root, base.file, base.directory, label=base.label, origins=base.origins, adopted=adopted)
    for each in found.values():
        if each.is_written:
            set_value(unit, each.path, each.value)
    making = ElementBuilder.of(plan, unit, composer.context, model_angle="radian")
    linking = Linking(unit, [], composer.context.sink)
    for step in plan.steps:
        if isinstance(step, SetSingleton) and step.section in SINGLETONS:
            set_singleton(step, linking, making)
    return unit


def _of(each: PartRequest, plan: Plan, composer: Composer) -> Unit:
    if isinstance(each.model, Plan):
        return _settings(each.model, composer, each.stands)
    found = None if each.model is None else composer.unit_of(plan, each)
    return found or Unit(etree.Element("mujoco"), plan.file, plan.path.parent, label=plan.path.stem)
