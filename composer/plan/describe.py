"""A plan in words, and as data for other programs."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Mapping as Map
from typing import TYPE_CHECKING, Any, TypeAlias

from composer.document.node import Mapping, Node, Scalar
from composer.plan.plan import AttachPart, LoadBase, Plan
from composer.recipe.attach import Attachment
from composer.recipe.fault import Path
from composer.sources.source import Source

if TYPE_CHECKING:
    from composer.link.subtree import Subtree

Subtrees: TypeAlias = "Map[tuple[str, Path], Subtree]"
"""What became of models of which one body is taken, by recipe and path in it."""
_PLURALS = {"body": "bodies", "mesh": "meshes", "equality": "equalities", "default class": "default classes"}


def describe(plan: Plan, subtrees: Subtrees | None = None) -> str:
    """One line a step, in the order in which they are done; nested recipes indented."""
    return "\n".join(_lines(plan, subtrees or {}))


def _lines(plan: Plan, subtrees: Subtrees, indent: str = "") -> Iterator[str]:
    yield f"{indent}{plan.name}: the model of {plan.file}"
    inner = indent + "  "
    if plan.base.model is None:
        yield f"{inner}start from an empty model"
    else:
        yield f"{inner}start from {_model(plan.base.model)}{_body(plan.base.subtree)}"
        yield from _own(plan.base, subtrees.get((plan.file, ("base",))), inner + "  ")
        if isinstance(plan.base.model, Plan):
            yield from _lines(plan.base.model, subtrees, inner + "  ")
    last = {part.at: part.prefix for part in plan.parts}
    for part in plan.parts:
        if any(part.copy):
            continue
        model = f"{_model(part.model)}{_body(part.attachment.subtree)}"
        yield f"{inner}attach {_called(part, last[part.at])}: {model}, {_place(part)}"
        yield from _own(part.attachment, subtrees.get((plan.file, part.at)), inner + "  ")
        if isinstance(part.model, Plan):
            yield from _lines(part.model, subtrees, inner + "  ")
    for field in plan.randomize.of_parameters if plan.randomize else ():
        yield inner + field.words
    for step in plan.steps:
        yield inner + step.words
    for words in checks_of(plan):
        yield inner + words


def _called(part: AttachPart, last: str) -> str:
    """A part, or all its copies with how many there are on each axis."""
    if not part.copy:
        return part.prefix or "(no prefix)"
    axes = " × ".join(str(axis.count) for axis in part.attachment.replicate)
    return f"{part.prefix} … {last} ({axes})"


def _model(model: Source | Plan) -> str:
    if isinstance(model, Plan):
        return f"the recipe {model.file}"
    release = f" ({model.package} {model.version})" if model.package and model.version else ""
    converted = ", URDF that MuJoCo converts" if model.format == "urdf" else ""
    return f"{model.reference}{release}{converted}"


def _body(name: str | None) -> str:
    return "" if name is None else f", its body {name} alone"


def _own(wanted: LoadBase | Attachment, subtree: Subtree | None, indent: str) -> Iterator[str]:
    """What is done to a base or a part by itself."""
    if wanted.drop:
        yield f"{indent}drop {', '.join(map(str, wanted.drop))}"
    yield from _left(subtree, indent)
    for each in wanted.edit:
        yield indent + each.words


def _left(subtree: Subtree | None, indent: str) -> Iterator[str]:
    """A line for each kind of what is left behind, and one for each thing that would have been cut in two."""
    kinds: dict[str, list[str]] = {}
    for each in subtree.left if subtree else ():
        if each.lacks is None:
            kinds.setdefault(each.what, []).append(each.name)
    for kind, names in kinds.items():
        count = f"{len(names)} {kind if len(names) == 1 else _PLURALS.get(kind, f'{kind}s')}"
        known = ", ".join(name for name in names if name)
        yield f"{indent}leaves {count}{f': {known}' if known else ''}"
    for each in subtree.cut if subtree else ():
        yield f"{indent}leaves the {each.called}, which needs {each.lacks}"


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


def as_data(plan: Plan, subtrees: Subtrees | None = None) -> dict[str, Any]:
    """The plan as JSON takes it: name, sources with their references, steps in words."""
    found = subtrees or {}
    return {
        "name": plan.name,
        "recipe": plan.file,
        "base": _model_data(plan.base.model, found),
        **_own_data(plan.base),
        **_subtree_data(found.get((plan.file, ("base",)))),
        "parts": [
            {
                "prefix": part.prefix,
                "model": _model_data(part.model, found),
                **_own_data(part.attachment),
                **_subtree_data(found.get((plan.file, part.at))),
                "place": _place(part),
            }
            for part in plan.parts
        ],
        "steps": [step.words for step in plan.steps],
        "checks": list(checks_of(plan)),
        **_draws_data(plan),
    }


def _draws_data(plan: Plan) -> dict[str, Any]:
    if plan.randomize is None:
        return {}
    wanted = plan.randomize
    fields = {field.name: field.words for field in wanted.fields}
    return {
        "randomize": {"seed": wanted.seed, "samples": wanted.samples, "emit": wanted.emit, "fields": fields}
    }


def _own_data(wanted: LoadBase | Attachment) -> dict[str, Any]:
    edits = [each.words for each in wanted.edit]
    return {"edits": edits} if edits else {}


def _subtree_data(subtree: Subtree | None) -> dict[str, Any]:
    if subtree is None:
        return {}
    left = [{"kind": each.what, "name": each.name, "lacks": each.lacks} for each in subtree.left]
    return {"subtree": {"body": subtree.body, "left": left}} if subtree.body else {"dropped": left}


def _model_data(model: Source | Plan | None, subtrees: Subtrees) -> Any:
    if model is None:
        return None
    if isinstance(model, Plan):
        return as_data(model, subtrees)
    return {
        "reference": model.reference,
        "kind": model.kind.name,
        "format": model.format,
        "package": model.package,
        "version": model.version,
        "licences": [path.name for path in model.licences],
    }


def checks_of(plan: Plan) -> Iterator[str]:
    """What will be checked of the model, a line for each."""
    for check in plan.checks:
        node: Node = plan.document
        for key in (*check.at, check.word):
            assert isinstance(node, Mapping)
            node = node.entries[str(key)][1]
        yield f"check {check.name}: {check.word} {_flow(node)}"


def _flow(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {_flow(value)}' for name, (_, value) in node.entries.items())}}}"
    return f"[{', '.join(map(_flow, node.items))}]"
