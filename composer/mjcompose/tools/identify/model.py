"""The model of a recipe for a fit: composed, compiled and kept in MuJoCo's process, and the elements of its fields."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.bundle.assemble import assemble
from mjcompose.compose.compose import Composed, ComposeOptions, Composer
from mjcompose.compose.editing import Editing, ExpectedCount, select_counted
from mjcompose.compose.elements import ElementBuilder
from mjcompose.language.identify import Identify, IdentifyField
from mjcompose.language.measured import DELAY, KINDS, ZERO
from mjcompose.link.key_layout import joint_type
from mjcompose.link.linking import Linking, LinkRequest
from mjcompose.link.measure import measure_with
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, planned
from mjcompose.plan.plan import Plan
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tree.select import kind_of, name_of
from mjcompose.verify.compile import WHOLE, compile_and_report

_FAMILIES = {ZERO: "joint", DELAY: "actuator"}


class FitModel(Struct):
    """The plan of a recipe whose model the session keeps, the fields as data, and the joints that are hinges."""

    plan: Plan
    identify: Identify
    fields: list[dict[str, Any]]
    hinges: set[str]


def open_model(recipe: Path, given: Given, context: Context, session: Session) -> FitModel | None:
    """Compose and compile the model of a recipe, without its checks; return None after reported errors."""
    plan = planned(ModelRequest(recipe, given), context)
    if plan is None or context.sink.has_errors:
        return None
    if plan.identify is None:
        help = f"write what a recording may change: `identify: {{fields: {{damping: {IdentifyField.example}}}}}`"
        context.sink.error("missing-key", f"`{plan.file}` has no `identify`", plan.document.span, help=help)
        return None
    composer = Composer(
        context, measure_with(context, session=session), session, options=ComposeOptions(notes_parts=True)
    )
    composed = compile_without_checks(plan, composer, context, session, keep=WHOLE)
    if composed is None:
        return None
    linking = Linking(composed.model, [], context.sink, request=LinkRequest(plan.separator))
    making = ElementBuilder.of(plan, composed.model, context, model_angle=composed.model.settings.angle)
    editing = Editing(linking, making, plan.scope, parts=composer.parts, cost=composer.cost)
    fields = list(_fields(plan.identify, plan, editing))
    if context.sink.error_count:
        return None
    hinges = {
        name
        for joint in composed.model.root.iter("joint")
        if (name := name_of(joint)) and joint_type(joint, composed.model.classes) == "hinge"
    }
    return FitModel(plan, plan.identify, fields, hinges)


def compile_without_checks(
    plan: Plan, composer: Composer, context: Context, session: Session, *, keep: str
) -> Composed | None:
    """Compose and compile a plan, and have the session keep the model as `keep`; None after reported errors."""
    composed = composer.compose(plan)
    bundle = None if composed is None else assemble(plan, composed.model, composed.files, context=context)
    if composed is None or bundle is None:
        return None
    compiled = compile_and_report(bundle, composed.model, context, session=session, keep=keep, at=plan.span)
    return None if compiled is None else composed


def _fields(identify: Identify, plan: Plan, editing: Editing) -> Iterator[dict[str, Any]]:
    """Yield each field with its elements as data; report elements that cannot have such a number."""
    for field in identify.fields.values():
        count = ExpectedCount(field.expect, field.optional, at=(*field.at, "expect"))
        found = select_counted(editing, field.select, (*field.at, "select"), count=count)
        elements = [element for node in found if (element := _element(field, node, editing)) is not None]
        if elements:
            for attribute, bounds in field.numbers:
                yield {
                    "name": field.name,
                    "kind": elements[0]["family"],
                    "attribute": attribute,
                    "groups": _groups(field, elements, plan.separator),
                    "bounds": bounds,
                }


def _element(field: IdentifyField, node: Node, editing: Editing) -> dict[str, str] | None:
    kind = kind_of(node)
    family = kind.family or kind.tag
    name = name_of(node)
    wanted = _FAMILIES.get(field.attribute, "body" if field.inertia else family)
    span = editing.span((*field.at, "select"))
    if family != wanted or family not in KINDS:
        message = f"{editing.called(node)} has no `{field.attribute}` that could be fitted"
        editing.sink.error("not-identifiable", message, span, help=f"select `{{{wanted}: NAME}}`")
        return None
    if name is None:
        message = f"{editing.called(node)} has no name, so a file of measurements cannot say its numbers"
        editing.sink.error("not-identifiable", message, span, help="give it a name, or select only elements with names")
        return None
    return {"name": name, "tag": kind.tag, "family": family}


def _groups(field: IdentifyField, elements: list[dict[str, str]], separator: str) -> list[list[dict[str, str]]]:
    """Return the elements that share a number."""
    if field.per == "element":
        return [[element] for element in elements]
    groups: dict[str, list[dict[str, str]]] = {}
    for element in elements:
        part = element["name"].rpartition(separator)[0] if field.per == "part" else ""
        groups.setdefault(part, []).append(element)
    return list(groups.values())


def span_of_field(model: FitModel, name: str) -> Any:
    """Return the place of a field in the recipe."""
    return locate(model.plan.document, ("identify", "fields", name), key=True)
