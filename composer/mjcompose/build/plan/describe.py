"""A plan in words and as data, and the warnings that it allows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Path, Severity, Span
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import BASE, AttachPart, EditOutcome, Gains, Plan, PlanPreview
from mjcompose.build.plan.steps import EditElements, Step, steps_adding
from mjcompose.language.attach import Attachment
from mjcompose.language.codes import ALLOW
from mjcompose.language.edit import Edit
from mjcompose.model.merged_settings import Adopted, in_words
from mjcompose.sources.reference import Source
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, find, locate, spans

if TYPE_CHECKING:
    from mjcompose.build.plan.plan import GeneratedShapes
    from mjcompose.link.subtree import DroppedElement, Subtree

Shown = Callable[[File], str]
_BEYOND = ("license-missing", "usd-loss", "target-loss", "store-unusable", "lock-stale")
"""Warnings from outside of a single build, whose absence in a build proves nothing."""


@dataclass(frozen=True, slots=True)
class Allowance:
    """An allowed code, written at `span`: for warnings without a file, in these files, or on one of these lines.

    `everywhere` is set for codes at the top of the built recipe.
    """

    code: str
    span: Span
    everywhere: bool = False
    files: frozenset[str] = frozenset()
    lines: frozenset[tuple[str, int]] = frozenset()

    def covers(self, diagnostic: Diagnostic) -> bool:
        if diagnostic.code != self.code or diagnostic.severity is Severity.ERROR:
            return False
        span = diagnostic.span
        if self.everywhere or span is None:
            return self.everywhere
        return span.file in self.files or (span.file, span.line) in self.lines


def acknowledge(plan: Plan, sink: Sink, shown: Shown, *, whole: bool) -> None:
    """Drop the warnings that the recipes allow; with `whole`, warn of allowed codes that do not occur.

    `shown` returns a file's name in messages. Errors stay.
    """
    allowances = list(_allowances(plan, shown))
    if not allowances:
        return
    used = set()
    for diagnostic in sink.diagnostics:
        covering = [each for each in allowances if each.covers(diagnostic)]
        used.update(covering)
        if covering:
            sink.drop(diagnostic)
    for each in allowances if whole and not sink.has_errors else ():
        if each not in used and each.code not in _BEYOND:
            sink.warning("unused-allow", f"nothing warns of `{each.code}` here", each.span,
                         help=f"take `{each.code}` out")  # fmt: skip


def allowed_everywhere(plan: Plan) -> tuple[str, ...]:
    """Return the codes at the top of the built recipe."""
    node = find(plan.document, (ALLOW,))
    return tuple(code for code, _ in _codes(node))


def _allowances(plan: Plan, shown: Shown) -> Iterator[Allowance]:
    for inner in plan.plans():
        everywhere = inner is plan
        files = frozenset() if everywhere else frozenset([inner.file, *_files(inner, shown)])
        for code, span in _codes(find(inner.document, (ALLOW,))):
            yield Allowance(code, span, everywhere, files=files)
        for edit in inner.edits:
            yield from _of_item(inner, edit.edit.at)
        for part in inner.members:
            yield from _of_model(inner, part.at, part.model, shown=shown)


def _of_model(plan: Plan, at: Path, model: Source | Plan | None, shown: Shown) -> Iterator[Allowance]:
    """Yield what the base or a part allows: in its entry of the recipe, and in its files."""
    files = [shown(model.path)] if isinstance(model, Source) else []
    if isinstance(model, Plan):
        files = [model.file, *_files(model, shown)]
    yield from _of_item(plan, at, frozenset(files))
    edits = find(plan.document, (*at, "edit"))
    for index in range(len(edits.items)) if isinstance(edits, Sequence) else ():
        yield from _of_item(plan, (*at, "edit", index))


def _of_item(plan: Plan, at: Path, files: frozenset[str] = frozenset()) -> Iterator[Allowance]:
    codes = list(_codes(find(plan.document, (*at, ALLOW))))
    node = find(plan.document, at) if codes else None
    if node is not None:
        places = [*spans(node), locate(plan.document, at, key=True)]
        lines = frozenset(
            (span.file, line) for span in places for line in range(span.line, (span.end_line or span.line) + 1)
        )
        for code, span in codes:
            yield Allowance(code, span, False, files=files, lines=lines)


def _files(plan: Plan, shown: Shown) -> Iterator[str]:
    for inner in plan.plans():
        yield inner.file
    for source in plan.sources():
        yield shown(source.path)


def _codes(node: Node | None) -> Iterator[tuple[str, Span]]:
    for item in node.items if isinstance(node, Sequence) else ():
        if isinstance(item, Scalar):
            yield item.text, item.span


_PLURALS = {"body": "bodies", "mesh": "meshes", "equality": "equalities", "default class": "default classes"}


def describe(plan: Plan, preview: PlanPreview | None = None) -> str:
    """Return one line for each step, in their order, with nested recipes indented."""
    found = preview or PlanPreview()
    adopted = [f"  adopt {words}" for words in in_words(found.adopted)]
    excluded = [
        f"  {each.one} and {each.other} "
        + (f"will not collide: {each.why}" if each.why else "touch, and will not collide")
        for each in found.excluded
    ]
    return "\n".join([*_lines(plan, found), *_gain_lines(found.gains), *adopted, *excluded])


def _gain_lines(found: Iterable[Gains]) -> Iterator[str]:
    """Yield a line for all servos whose joints feel the same."""
    alike: dict[str, list[str]] = {}
    for each in found:
        per = {"N": "N/m", "N·m": "N·m/rad"}.get(each.unit, "")
        kp = f"kp {each.kp:.6g} {per}".rstrip()
        kv = f"kv {each.kv:.6g} {per.replace('/', '·s/')}".rstrip()
        gear = "" if abs(each.gear) == 1 else f" through a gear of {each.gear:g}"
        alike.setdefault(f"{', '.join([kp] * bool(each.kp) + [kv])}{gear}", []).append(each.actuator)
    for words, names in alike.items():
        yield f"  {', '.join(names)}: {words}"


def _lines(plan: Plan, preview: PlanPreview, indent: str = "") -> Iterator[str]:
    yield f"{indent}{plan.name}: {'written in' if plan.at else 'the model of'} {plan.file}"
    inner = indent + "  "
    if plan.base is None:
        yield f"{inner}start from an empty model"
    else:
        yield f"{inner}start from {_model(plan.base.model)}{_body(plan.base.attachment.subtree)}"
        yield from _own_lines(plan, plan.base, preview=preview, indent=inner + "  ")
        if isinstance(plan.base.model, Plan):
            yield from _lines(plan.base.model, preview, inner + "  ")
    early: list[Step] = []
    yield from _part_lines(plan, preview, inner, early=early)
    for field in plan.randomize.of_parameters if plan.randomize else ():
        yield inner + field.words
    for step in plan.steps:
        if step in early:
            continue
        if isinstance(step, EditElements):
            yield from _edit_lines(step.edit, preview.edits.get(plan.place_of(step.edit.at)), inner)
        else:
            yield inner + step.words
    for words in checks_of(plan):
        yield inner + words


def _part_lines(plan: Plan, preview: PlanPreview, indent: str, early: list[Step]) -> Iterator[str]:
    """Yield the parts, copies as one. Before each stand the steps that make its place, which are added to `early`."""
    last = {part.at: part.prefix for part in plan.parts}
    places = plan.added_places
    for part in plan.parts:
        if any(part.copy):
            continue
        for maker in steps_adding(places, *part.attachment.place):
            if maker not in early:
                early.append(maker)
                yield indent + maker.words
        model = f"{_model(part.model)}{_body(part.attachment.subtree)}"
        yield f"{indent}attach {_called(part, last[part.at])}: {model}, {_place_words(part)}"
        yield from _own_lines(plan, part, preview=preview, indent=indent + "  ")
        if isinstance(part.model, Plan):
            yield from _lines(part.model, preview, indent + "  ")


def _called(part: AttachPart, last: str) -> str:
    """Return the name of a part, or of all its copies with their number on each axis."""
    if not part.copy:
        return part.prefix or "(no prefix)"
    axes = " × ".join(str(axis.count) for axis in part.attachment.replicate)
    return f"{part.prefix} … {last} ({axes})"


def _model(model: Source | Plan) -> str:
    if isinstance(model, Plan):
        return "what is written here" if model.at else f"the recipe {model.file}"
    release = f" ({model.package} {model.version})" if model.package and model.version else ""
    converted = ", URDF that MuJoCo converts" if model.format == "urdf" else ""
    return f"{model.reference}{release}{converted}"


def _body(name: str | None) -> str:
    return "" if name is None else f", its body {name} alone"


def _own_lines(plan: Plan, part: AttachPart, preview: PlanPreview, indent: str) -> Iterator[str]:
    """Yield what is done to a base or a part by itself."""
    wanted = part.attachment
    if wanted.drop:
        yield f"{indent}drop {', '.join(map(str, wanted.drop))}"
    yield from _dropped_lines(preview.subtrees.get(plan.place_of(part.at)), indent)
    for each in wanted.edit:
        yield from _edit_lines(each, preview.edits.get(plan.place_of(each.at)), indent)


def _edit_lines(edit: Edit, outcome: EditOutcome | None, indent: str) -> Iterator[str]:
    """Yield an entry of `edit` with the number of its elements, and a line for each kind that it removes."""
    if outcome is None:
        yield indent + edit.words
        return
    counts = ", ".join(_counted(count, kind) for kind, count in outcome.selected.items())
    yield f"{indent}{edit.words} ({counts or 'nothing'})"
    for kind, names in _by_kind(outcome.removed).items():
        yield f"{indent}  removes {_listed(kind, names)}"
    for each in outcome.shapes:
        yield f"{indent}  {each.words}"


def _dropped_lines(subtree: Subtree | None, indent: str) -> Iterator[str]:
    """Yield a line for each kind that is left behind, and one for each element that would be cut in two."""
    left = [each for each in subtree.dropped if each.lacks is None] if subtree else []
    for kind, names in _by_kind(left).items():
        yield f"{indent}leaves {_listed(kind, names)}"
    for each in subtree.cut if subtree else ():
        yield f"{indent}leaves the {each.called}, which needs {each.lacks}"


def _by_kind(gone: Iterable[DroppedElement]) -> dict[str, list[str]]:
    kinds: dict[str, list[str]] = {}
    for each in gone:
        kinds.setdefault(each.what, []).append(each.name)
    return kinds


def _listed(kind: str, names: list[str]) -> str:
    known = ", ".join(name for name in names if name)
    return f"{_counted(len(names), kind)}{f': {known}' if known else ''}"


def _counted(count: int, kind: str) -> str:
    return f"{count} {kind if count == 1 else _PLURALS.get(kind, f'{kind}s')}"


def _place_words(part: AttachPart) -> str:
    attachment = part.attachment
    for kind in ("site", "body", "frame"):
        name = getattr(attachment, kind)
        if name is not None:
            place = f"on the {kind} {name}"
            break
    else:
        place = "in the world"
    if attachment.sensors is not None:
        quantities = attachment.sensors.quantities
        place += f", where {' and '.join(quantities)} {'is' if len(quantities) == 1 else 'are'} measured"
    joint = attachment.joint
    if joint is None:
        return place
    if isinstance(joint, str):
        words = {"none": "without a joint", "mocap": "mocap"}
        return f"{place}, {words.get(joint, f'with a {joint} joint')}"
    return f"{place}, with {len(joint) if isinstance(joint, tuple) else 1} joint(s)"


def as_data(plan: Plan, preview: PlanPreview | None = None) -> dict[str, Any]:
    """Return the plan as JSON data: name, sources with their references, steps in words."""
    found = preview or PlanPreview()
    return {
        "name": plan.name,
        "recipe": plan.file,
        "base": _model_data(plan.base.model if plan.base else None, found),
        **(_own_data(plan, plan.base.attachment, found) if plan.base else {}),
        **_subtree_data(found.subtrees.get(plan.place_of((BASE,)))),
        "parts": [
            {
                "prefix": part.prefix,
                "model": _model_data(part.model, found),
                **_own_data(plan, part.attachment, found),
                **_subtree_data(found.subtrees.get(plan.place_of(part.at))),
                "place": _place_words(part),
            }
            for part in plan.parts
        ],
        "steps": [step.words for step in plan.steps],
        **_edits_data(plan, [step.edit for step in plan.edits], found),
        "checks": list(checks_of(plan)),
        **_draws_data(plan),
        **_adopted_data(found.adopted),
        **(
            {"touching": touching}
            if (touching := [[each.one, each.other] for each in found.excluded if not each.why])
            else {}
        ),
        **({"excluded": excluded} if (excluded := [asdict(each) for each in found.excluded if each.why]) else {}),
        **({"gains": [asdict(each) for each in found.gains]} if found.gains else {}),
    }


def _adopted_data(adopted: Iterable[Adopted]) -> dict[str, Any]:
    found = [{"setting": each.setting, "value": each.value, "parts": each.parts} for each in adopted if each.is_written]
    return {"adopted": found} if found else {}


def _draws_data(plan: Plan) -> dict[str, Any]:
    if plan.randomize is None:
        return {}
    wanted = plan.randomize
    fields = {field.name: field.words for field in wanted.fields}
    return {"randomize": {"seed": wanted.seed, "samples": wanted.samples, "fields": fields}}


def _own_data(plan: Plan, wanted: Attachment, preview: PlanPreview) -> dict[str, Any]:
    edits = [each.words for each in wanted.edit]
    return {"edits": edits, **_edits_data(plan, wanted.edit, preview)} if edits else {}


def _edits_data(plan: Plan, edits: Iterable[Edit], preview: PlanPreview) -> dict[str, Any]:
    """Return what each entry of `edit` selects and removes, for those that succeeded."""
    edited = [
        {
            "words": each.words,
            "selected": dict(outcome.selected),
            "removed": [{"kind": gone.what, "name": gone.name} for gone in outcome.removed],
            **({"made": [_shapes_data(made) for made in outcome.shapes]} if outcome.shapes else {}),
        }
        for each in edits
        if (outcome := preview.edits.get(plan.place_of(each.at))) is not None
    ]
    return {"edited": edited} if edited else {}


def _shapes_data(made: GeneratedShapes) -> dict[str, Any]:
    """Return what was made of a mesh, and how far it is from it."""
    return {"mesh": made.mesh, "geom": made.of, "how": made.how, "shapes": list(made.shapes), "error": dict(made.error)}


def _subtree_data(subtree: Subtree | None) -> dict[str, Any]:
    if subtree is None:
        return {}
    left = [{"kind": each.what, "name": each.name, "lacks": each.lacks} for each in subtree.dropped]
    return {"subtree": {"body": subtree.body, "left": left}} if subtree.body else {"dropped": left}


def _model_data(model: Source | Plan | None, preview: PlanPreview) -> Any:
    if model is None:
        return None
    if isinstance(model, Plan):
        return as_data(model, preview)
    return {
        "reference": model.reference,
        "kind": model.kind.name,
        "format": model.format,
        "package": model.package,
        "version": model.version,
        "licenses": [path.name for path in model.licenses],
    }


def checks_of(plan: Plan) -> Iterator[str]:
    """Yield one line for each check."""
    for check in plan.checks:
        node: Node = plan.document
        for key in check.at:
            assert isinstance(node, Mapping)
            node = node.entries[str(key)][1]
        yield f"check {check.name}: {check.word} {_flow(node)}"


def _flow(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {_flow(value)}' for name, (_, value) in node.entries.items())}}}"
    return f"[{', '.join(map(_flow, node.items))}]"
