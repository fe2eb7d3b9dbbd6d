"""A plan as text and as data, and the warnings that it allows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Path, Severity, Span
from mjcompose.base.report import as_lines
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.language.edit import Edit
from mjcompose.language.forms.scalars import ALLOW
from mjcompose.plan.plan import AttachPart, EditOutcome, Gains, Plan, PlanPreview
from mjcompose.plan.steps import EditElements, Step, steps_adding
from mjcompose.sources.reference import Source
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, find, locate, spans
from mjcompose.tree.merged_settings import in_words

if TYPE_CHECKING:
    from mjcompose.link.subtree import DroppedElement

Shown = Callable[[File], str]
_BEYOND = ("license-missing", "usd-loss", "target-loss", "store-unusable", "lock-stale")
"""Warnings that do not depend on a single build, so their absence in a build proves nothing."""


class Allowance(Struct):
    """A code allowed at `span`, `everywhere` from the top of the recipe, or in these files or on these lines."""

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
    """Drop the warnings that the recipes allow; with `whole`, warn of allowed codes that do not occur. Errors stay."""
    allowances = list(_allowances(plan, shown))
    if not allowances:
        return
    used = set()
    for diagnostic in sink.diagnostics:
        covering = [allowance for allowance in allowances if allowance.covers(diagnostic)]
        used.update(covering)
        if covering:
            sink.drop(diagnostic)
    if whole and not sink.has_errors:
        for allowance in allowances:
            if allowance not in used and (code := allowance.code) not in _BEYOND:
                sink.warning(
                    "unused-allow", f"there is no warning `{code}` here", allowance.span, help=f"remove `{code}`"
                )


def allowed_everywhere(plan: Plan) -> tuple[str, ...]:
    """Return the codes at the top of the built recipe."""
    return tuple(code for code, _ in _codes(find(plan.document, (ALLOW,))))


def _allowances(plan: Plan, shown: Shown) -> Iterator[Allowance]:
    for inner in plan.plans():
        everywhere = inner is plan
        files = frozenset() if everywhere else frozenset(_files(inner, shown))
        for code, span in _codes(find(inner.document, (ALLOW,))):
            yield Allowance(code, span, everywhere, files=files)
        for edit in inner.edits:
            yield from _of_item(inner, edit.edit.at)
        for part in inner.members:  # an entry of the base or a part is about the entry and the files
            files = frozenset(_files(part.model, shown) if isinstance(part.model, Plan) else [shown(part.model.path)])
            yield from _of_item(inner, part.at, files)
            edits = find(inner.document, (*part.at, "edit"))
            if isinstance(edits, Sequence):
                for index in range(len(edits.items)):
                    yield from _of_item(inner, (*part.at, "edit", index))


def _of_item(plan: Plan, at: Path, files: frozenset[str] = frozenset()) -> Iterator[Allowance]:
    codes = list(_codes(find(plan.document, (*at, ALLOW))))
    node = find(plan.document, at) if codes else None
    if node is not None:
        places = [*spans(node), locate(plan.document, at, key=True)]
        lines = frozenset(
            (span.file, line) for span in places for line in range(span.line, (span.end_line or span.line) + 1)
        )
        yield from (Allowance(code, span, False, files=files, lines=lines) for code, span in codes)


def _files(plan: Plan, shown: Shown) -> list[str]:
    return [*(inner.file for inner in plan.plans()), *(shown(source.path) for source in plan.sources())]


def _codes(node: Node | None) -> Iterator[tuple[str, Span]]:
    if isinstance(node, Sequence):
        for item in node.items:
            if isinstance(item, Scalar):
                yield item.text, item.span


def describe(plan: Plan, preview: PlanPreview | None = None) -> str:
    """Return one line for each step, in their order, with nested recipes indented."""
    preview = preview or PlanPreview()
    adopted = [f"  adopt {words}" for words in in_words(preview.adopted)]
    excluded = []
    for pair in preview.excluded:
        why = f"will not collide: {pair.why}" if pair.why else "touch, and will not collide"
        excluded.append(f"  {pair.one} and {pair.other} {why}")
    if preview.unsearched:
        pairs = counted(preview.unsearched, "pair")
        excluded.append(
            f"  {pairs} of bodies still collide: the search for poses in which they touch ended before them"
        )
    return as_lines([*_lines(plan, preview), *_gain_lines(preview.gains), *adopted, *excluded])


def _gain_lines(gains: Iterable[Gains]) -> Iterator[str]:
    """Yield one line for all servos with equal gains."""
    alike: dict[str, list[str]] = {}
    for each in gains:
        per = {"N": "N/m", "N·m": "N·m/rad"}.get(each.unit, "")
        kp = f"kp {each.kp:.6g} {per}".rstrip()
        kv = f"kv {each.kv:.6g} {per.replace('/', '·s/')}".rstrip()
        gear = "" if abs(each.gear) == 1 else f" through a gear of {each.gear:g}"
        alike.setdefault(f"{', '.join([kp] * bool(each.kp) + [kv])}{gear}", []).append(each.actuator)
    yield from (f"  {', '.join(names)}: {words}" for words, names in alike.items())


def _lines(plan: Plan, preview: PlanPreview, indent: str = "") -> Iterator[str]:
    yield f"{indent}{plan.name}: {'written in' if plan.at else 'the model of'} {plan.file}"
    inner = indent + "  "
    yield f"{inner}start from {'an empty model' if plan.base is None else _model(plan.base)}"
    if plan.base is not None:
        yield from _own_lines(plan, plan.base, preview=preview, indent=inner + "  ")
    early: list[Step] = []
    last = {part.at: part.prefix for part in plan.parts}
    places = plan.added_places
    for part in plan.parts:
        if any(part.copy):  # all copies have one line
            continue
        for maker in steps_adding(places, *part.attachment.place):  # the steps that add its place
            if maker not in early:
                early.append(maker)
                yield inner + maker.words
        yield f"{inner}attach {_name(part, last[part.at])}: {_model(part)}, {_place_words(part)}"
        yield from _own_lines(plan, part, preview=preview, indent=inner + "  ")
    yield from (inner + field.words for field in (plan.randomize.of_parameters if plan.randomize else ()))
    yield from (inner + words for words in _measured_draws(plan))
    for step in plan.steps:
        if isinstance(step, EditElements):
            yield from _edit_lines(step.edit, preview.edits.get(plan.place_of(step.edit.at)), inner)
        elif step not in early:
            yield inner + step.words
    yield from (inner + words for words in checks_of(plan))


def _measured_draws(plan: Plan) -> Iterator[str]:
    """Yield a line for each field that draws measured numbers, and below it one for each number."""
    if plan.measured_draws is None:
        return
    lines = list(plan.measured_draws.lines)
    for field in plan.measured_draws.randomize.of_measured:
        yield field.words
        yield from (f"  {words}" for drawing, words in lines if drawing is field)


def _name(part: AttachPart, last: str) -> str:
    """Return the prefix of a part, or of its first and last copy."""
    if not part.copy:
        return part.prefix or "(no prefix)"
    axes = " × ".join(str(axis.copies) for axis in part.attachment.replicate)
    scatter = part.attachment.scatter
    if scatter is not None:
        axes += f" scattered over {scatter.over.named[1]}"
    return f"{part.prefix} … {last} ({axes})"


def _model(part: AttachPart) -> str:
    model = part.model
    body = part.attachment.subtree
    alone = "" if body is None else f", only its body {body}"
    if isinstance(model, Plan):
        return f"{'the model written here' if model.at else f'the recipe {model.file}'}{alone}"
    release = f" ({model.package} {model.version})" if model.package and model.version else ""
    converted = {"urdf": ", URDF that MuJoCo converts", "mesh": ", a mesh as a body"}.get(model.format, "")
    settings = f", read with {_compiler(model)}" if model.compiler else ""
    return f"{model.reference}{release}{converted}{settings}{alone}"


def _compiler(source: Source) -> str:
    return f"<compiler {' '.join(f'{name}={value!r}' for name, value in source.compiler)}/>".replace("'", '"')


def _own_lines(plan: Plan, part: AttachPart, preview: PlanPreview, indent: str) -> Iterator[str]:
    """Yield the recipes, drops and edits of a base or a part, each element that would be split, and its plan."""
    attachment = part.attachment
    for recipe in part.inner:
        yield f"{indent}attaches the recipe {recipe.file}"
        yield from _lines(recipe, preview, indent + "  ")
    if attachment.drop:
        yield f"{indent}drop {', '.join(map(str, attachment.drop))}"
    subtree = preview.subtrees.get(plan.place_of(part.at))
    dropped = [each for each in subtree.dropped if each.lacks is None] if subtree else []
    yield from _by_kind(dropped, f"{indent}drops")
    if subtree:
        for element in subtree.cut:
            yield f"{indent}drops the {element.called}, which needs {element.lacks}"
    for edit in attachment.edit:
        yield from _edit_lines(edit, preview.edits.get(plan.place_of(edit.at)), indent)
    if isinstance(part.model, Plan):
        yield from _lines(part.model, preview, indent)


def _edit_lines(edit: Edit, outcome: EditOutcome | None, indent: str) -> Iterator[str]:
    """Yield an entry of `edit` with the number of its elements, and a line for each kind that it removes."""
    if outcome is None:
        yield indent + edit.words
        return
    counts = ", ".join(counted(count, kind) for kind, count in outcome.selected.items())
    yield f"{indent}{edit.words} ({counts or 'nothing'})"
    yield from _by_kind(outcome.removed, f"{indent}  removes")
    yield from (f"{indent}  {each.words}" for each in outcome.shapes)


def _by_kind(elements: Iterable[DroppedElement], start: str) -> Iterator[str]:
    kinds: dict[str, list[str]] = {}
    for element in elements:
        kinds.setdefault(element.what, []).append(element.name)
    for kind, names in kinds.items():
        known = ", ".join(filter(None, names))
        yield f"{start} {counted(len(names), kind)}{f': {known}' if known else ''}"


def _place_words(part: AttachPart) -> str:
    attachment = part.attachment
    named = {kind: getattr(attachment, kind) for kind in ("site", "body", "frame")}
    places = [f"on the {kind} {name}" for kind, name in named.items() if name is not None]
    place = places[0] if places else "in the world"
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
    preview = preview or PlanPreview()
    randomize = plan.randomize
    draws = randomize and {
        "seed": randomize.seed,
        "samples": randomize.samples,
        "fields": {field.name: field.words for field in randomize.fields},
    }
    adopted = [each for each in preview.adopted if each.is_written]
    return {
        "name": plan.name,
        "recipe": plan.file,
        "base": _model_data(plan.base.model if plan.base else None, preview),
        **(_own_data(plan, plan.base, preview) if plan.base else {}),
        "parts": [
            {
                "prefix": part.prefix,
                "model": _model_data(part.model, preview),
                **_own_data(plan, part, preview),
                "place": _place_words(part),
            }
            for part in plan.parts
        ],
        "steps": [step.words for step in plan.steps],
        **_some(edited=_edited(plan, [step.edit for step in plan.edits], preview)),
        "checks": list(checks_of(plan)),
        **_some(
            randomize=draws,
            adopted=[{"setting": each.setting, "value": each.value, "parts": each.parts} for each in adopted],
            touching=[[each.one, each.other] for each in preview.excluded if not each.why],
            excluded=[asdict(each) for each in preview.excluded if each.why],
            unsearched=preview.unsearched,
            gains=[asdict(each) for each in preview.gains],
        ),
    }


def _some(**entries: Any) -> dict[str, Any]:
    return {name: value for name, value in entries.items() if value}


def _own_data(plan: Plan, part: AttachPart, preview: PlanPreview) -> dict[str, Any]:
    edits = part.attachment.edit
    subtree = preview.subtrees.get(plan.place_of(part.at))
    data = _some(
        edits=[edit.words for edit in edits],
        edited=_edited(plan, edits, preview),
        attaches=[as_data(inner, preview) for inner in part.inner],
    )
    if subtree is not None:
        left = [{"kind": each.what, "name": each.name, "lacks": each.lacks} for each in subtree.dropped]
        data |= {"subtree": {"body": subtree.body, "left": left}} if subtree.body else {"dropped": left}
    return data


def _edited(plan: Plan, edits: Iterable[Edit], preview: PlanPreview) -> list[dict[str, Any]]:
    """Return the selected and removed elements, and the generated shapes, of each entry of `edit` that succeeded."""
    outcomes = []
    for edit in edits:
        outcome = preview.edits.get(plan.place_of(edit.at))
        if outcome is not None:
            removed = [{"kind": element.what, "name": element.name} for element in outcome.removed]
            made = [
                {"mesh": it.mesh, "geom": it.of, "how": it.how, "shapes": list(it.shapes), "error": dict(it.error)}
                for it in outcome.shapes
            ]
            about = {"words": edit.words, "selected": dict(outcome.selected), "removed": removed}
            outcomes.append({**about, **_some(made=made)})
    return outcomes


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
        **_some(compiler=dict(model.compiler)),
    }


def checks_of(plan: Plan) -> Iterator[str]:
    for check in plan.checks:
        node = find(plan.document, check.at)
        assert node is not None
        yield f"check {check.name}: {check.word} {_flow(node)}"


def _flow(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {_flow(value)}' for name, (_, value) in node.entries.items())}}}"
    return f"[{', '.join(map(_flow, node.items))}]"
