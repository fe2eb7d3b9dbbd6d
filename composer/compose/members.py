"""The sources of a composition and what the composition changes in each: the basis for comparing the two."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from lxml.etree import _Element as Node

from composer.compiled.affected_arrays import arrays_of
from composer.compose.part_provenance import reaches, with_edits
from composer.compose.subtree import PartRequest
from composer.dataclass import dataclass
from composer.link.part import Part
from composer.link.placing import read_pose
from composer.numerics.pose import Pose
from composer.plan.drawn_arrays import arrays_of_draw
from composer.plan.part_record import IN_PLACE, PartRecord, of_part
from composer.plan.plan import BASE, Plan, part_name
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.set_default import SetDefault
from composer.plan.steps.set_singleton import SetSingleton
from composer.recipe.checks.unchanged import Unchanged
from composer.sources.source import Source
from composer.tree.classes import MAIN
from composer.tree.settings import read_settings

# These three reach every body of the model, of whatever part.
_MASSES = frozenset({"boundmass", "boundinertia", "settotalmass"})
# With these a part has fewer bodies or geoms than its source alone, so that there is nothing to compare.
_RESHAPING = frozenset({"fusestatic", "discardvisual"})
# What `drop` leaves out of a part without making it another: settings, of which a model has one, and its keys.
_WITHOUT_ELEMENTS = frozenset({"option", "visual", "statistic", "size", "keyframe"})


@dataclass(frozen=True, slots=True)
class UnplacedRecord:
    """The record of a part whose place is still an element of the tree. `content` is None for the world."""

    member: PartRecord
    content: Node | None


def unplaced_records(
    plan: Plan, wanted: Iterable[PartRequest], parts: Iterable[Part], inner: Sequence[list[UnplacedRecord]]
) -> list[UnplacedRecord]:
    """Return the records of a plan: those of its own sources and of nested recipes, in the manifest's order.

    `wanted` and `inner`, the records of each request that is a nested recipe, have the base first and then the parts.
    """
    base, *others = wanted
    found = [_own(each, base) for each in _of_base(plan, base, inner[0])]
    for step, each, part, below in zip(plan.parts, others, parts, inner[1:], strict=True):
        name = part_name(step, plan.separator)
        if isinstance(each.model, Plan):
            moved = [_moved(member, name, part, separator=plan.separator, cut=_cut(each)) for member in below]
            found += [_own(member, each) for member in moved]
        elif each.model is not None:
            keys = {"merge": "", "prefix": part.prefix, "none": None}[part.keyframes]
            member = PartRecord(
                name, part.prefix, each.model,
                keys=keys, welded=part.weld, stands=each.stands, obscure=_cut_urdf(each), subtree=each.body,
            )  # fmt: skip
            found.append(_own(UnplacedRecord(member, part.content), each))
    return _changed(plan, found)


def _own(each: UnplacedRecord, wanted: PartRequest) -> UnplacedRecord:
    """Return a member with the changes that the edits of its part, and the elements left out, make."""
    member = with_edits(each.member, wanted.edit)
    dropped = {each.section for each in wanted.drop}
    if "keyframe" in dropped:
        member = replace(member, keys=None)
    if not dropped <= _WITHOUT_ELEMENTS:
        member = replace(member, reduced="the recipe leaves out elements")
    return UnplacedRecord(member, each.content)


def _cut(wanted: PartRequest) -> str | None:
    return None if wanted.body is None else f"only its body `{wanted.body}` was taken"


def _cut_urdf(wanted: PartRequest) -> str | None:
    return _cut(wanted) if isinstance(wanted.model, Source) and wanted.model.format == "urdf" else None


def placed_records(found: Iterable[UnplacedRecord], root: Node) -> tuple[PartRecord, ...]:
    """Return the records with the places of the parts, read from the finished model."""
    settings = read_settings(root)
    degrees, sequence = settings.angle == "degree", settings.eulerseq
    return tuple(_place(each, degrees, sequence) for each in found)


def _of_base(plan: Plan, base: PartRequest, inner: list[UnplacedRecord]) -> Iterator[UnplacedRecord]:
    without_keys = base.keyframes == "none"
    if isinstance(base.model, Plan):
        for each in inner:
            member = replace(
                each.member,
                part=f"{BASE}{plan.separator}{each.member.part}",
                keys=None if without_keys else each.member.keys,
                obscure=each.member.obscure or _cut(base),
            )
            yield UnplacedRecord(member, each.content)
    elif base.model is not None:
        keys = None if without_keys else ""
        member = PartRecord(
            BASE, "", base.model, keys=keys, stands=base.stands, obscure=_cut_urdf(base), subtree=base.body
        )
        yield UnplacedRecord(member, None)


def _moved(each: UnplacedRecord, name: str, part: Part, separator: str, cut: str | None) -> UnplacedRecord:
    """Return a member of a nested recipe as a member of the outer recipe."""
    member = each.member
    keys = member.keys
    outer = part.prefix if part.keyframes == "prefix" else ""
    if part.keyframes == "none" or keys is None:
        keys = None
    elif part.keyframes == "prefix":
        keys = outer + keys
    member = replace(
        member,
        part=f"{name}{separator}{member.part}",
        prefix=part.prefix + member.prefix,
        keys=keys,
        replaced_keys=tuple(outer + name for name in member.replaced_keys),
        welded=member.welded or part.weld,
        obscure=member.obscure or cut,
    )
    return UnplacedRecord(member, part.content if each.content is None else each.content)


def _changed(plan: Plan, found: list[UnplacedRecord]) -> list[UnplacedRecord]:
    """Return the members with the changes that the recipe's own settings make."""
    for step in plan.steps:
        if isinstance(step, SetDefault):
            owner = "" if step.name == MAIN else _longest(step.name, [each.member.prefix for each in found])
            rows = [(row.tag, name) for row in step.element.children for name in row.attributes]
            arrays = [array for tag, name in rows for array in arrays_of(name, tag)]
            found = [_with(each, arrays) if each.member.prefix == owner else each for each in found]
        elif isinstance(step, SetSingleton) and step.section == "compiler":
            written = step.element.attributes
            if not _MASSES.isdisjoint(written):
                found = [_with(each, arrays_of("mass")) for each in found]
            if "lengthrange" in {child.tag for child in step.element.children}:
                found = [_with(each, arrays_of("lengthrange")) for each in found]
            for name in sorted(_RESHAPING & written.keys()):
                reason = f"the recipe sets `compiler.{name}`, which takes elements away"
                found = [UnplacedRecord(replace(each.member, obscure=reason), each.content) for each in found]
    drawn = [arrays_of_draw(step) for step in plan.steps if isinstance(step, DrawValues) and step.sample]
    if drawn:
        arrays = sorted(set().union(*drawn))
        found = [_with(each, arrays) for each in found]
    written_keys = tuple(step.key.name for step in plan.keyframes)
    found = [
        UnplacedRecord(
            replace(each.member, replaced_keys=(*each.member.replaced_keys, *written_keys)), each.content
        )
        for each in found
    ]
    prefixes = {each.member.prefix for each in found}
    for each_edit in (step.edit for step in plan.edits):
        found = [
            UnplacedRecord(with_edits(each.member, [each_edit]), each.content)
            if reaches(each_edit.select, each.member.prefix, prefixes)
            else each
            for each in found
        ]
    for check in plan.checks:
        if not isinstance(check, Unchanged):
            continue
        meant = of_part([each.member for each in found], check.part, plan.separator)
        arrays = [array for name in check.excepted for array in arrays_of(name)]
        found = [_with(each, arrays) if each.member in meant else each for each in found]
    return found


def _longest(name: str, prefixes: Iterable[str]) -> str:
    return max((prefix for prefix in prefixes if name.startswith(prefix)), key=len, default="")


def _with(each: UnplacedRecord, arrays: Iterable[str]) -> UnplacedRecord:
    changed = tuple(sorted({*each.member.changed, *arrays}))
    return UnplacedRecord(replace(each.member, changed=changed), each.content)


def _place(each: UnplacedRecord, degrees: bool, sequence: str) -> PartRecord:
    pose: Pose | None = IN_PLACE
    node = each.content
    while node is not None and node.tag in ("frame", "replicate"):
        # A replicate has many poses, and no single one.
        known = pose if node.tag == "frame" else None
        pose = None if known is None else read_pose(node, degrees, sequence) @ known
        node = node.getparent()
    if pose is not None and not pose.is_finite:
        pose = None
    if node is None or node.tag != "body":
        return replace(each.member, pose=pose)
    name = node.get("name")
    if not name:
        return replace(each.member, pose=pose, obscure="it is attached to a body without a name")
    return replace(each.member, body=str(name), pose=pose)
