"""A plan in words, and as data for other programs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.plan.plan import AddElement, AppendElement, AttachPart, Plan, SetDefault, SetSingleton, Step
from composer.recipe.element import Element
from composer.sources.source import Source


def describe(plan: Plan) -> str:
    """One line a step, in the order in which they are done; nested recipes indented."""
    return "\n".join(_lines(plan))


def _lines(plan: Plan, indent: str = "") -> Iterator[str]:
    yield f"{indent}{plan.name}: the model of {plan.file}"
    inner = indent + "  "
    if plan.base.model is None:
        yield f"{inner}start from an empty model"
    else:
        yield f"{inner}start from {_model(plan.base.model)}"
        if isinstance(plan.base.model, Plan):
            yield from _lines(plan.base.model, inner + "  ")
    for part in plan.parts:
        yield f"{inner}attach {part.prefix or '(no prefix)'}: {_model(part.model)}, {_place(part)}"
        if isinstance(part.model, Plan):
            yield from _lines(part.model, inner + "  ")
    for step in plan.steps:
        yield inner + _step(step)


def _model(model: Source | Plan) -> str:
    if isinstance(model, Plan):
        return f"the recipe {model.file}"
    release = f" ({model.package} {model.version})" if model.package and model.version else ""
    converted = ", URDF that MuJoCo converts" if model.format == "urdf" else ""
    return f"{model.reference}{release}{converted}"


def _place(part: AttachPart) -> str:
    attachment = part.attachment
    for kind in ("site", "body", "frame"):
        name = getattr(attachment, kind)
        if name is not None:
            place = f"on the {kind} {name}"
            break
    else:
        place = "in the world"
    joint = attachment.joint
    if joint is None:
        return place
    if isinstance(joint, str):
        return f"{place}, {'welded' if joint == 'weld' else f'with a {joint} joint' if joint != 'mocap' else 'mocap'}"
    return f"{place}, with {len(joint) if isinstance(joint, tuple) else 1} joint(s)"


def _step(step: Step) -> str:
    if isinstance(step, AddElement):
        where = "the world" if step.to_kind == "world" else f"the {step.to_kind} {step.to}"
        return f"add {_element(step.element)} to {where}"
    if isinstance(step, SetSingleton):
        return f"set {step.section}: {', '.join(_settings(step.element))}"
    if isinstance(step, SetDefault):
        return f"set the default class {step.name}: {', '.join(child.tag for child in step.element.children)}"
    assert isinstance(step, AppendElement)
    return f"add {_element(step.element)} to {step.section}"


def _element(element: Element) -> str:
    name = element.attributes.get("name")
    return f"{element.tag} {name}" if name is not None else f"a {element.tag}"


def _settings(element: Element, path: str = "") -> Iterator[str]:
    yield from (f"{path}{name} = {value}" for name, value in element.attributes.items())
    for child in element.children:
        yield from _settings(child, f"{path}{child.tag}.")


def as_data(plan: Plan) -> dict[str, Any]:
    """The plan as JSON takes it: name, sources with their references, steps in words."""
    return {
        "name": plan.name,
        "recipe": plan.file,
        "base": _model_data(plan.base.model),
        "parts": [
            {"prefix": part.prefix, "model": _model_data(part.model), "place": _place(part)}
            for part in plan.parts
        ],
        "steps": [_step(step) for step in plan.steps],
    }


def _model_data(model: Source | Plan | None) -> Any:
    if model is None:
        return None
    if isinstance(model, Plan):
        return as_data(model)
    return {
        "reference": model.reference,
        "kind": model.kind,
        "format": model.format,
        "package": model.package,
        "version": model.version,
        "licences": [path.name for path in model.licences],
    }
