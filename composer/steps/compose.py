"""Carry out a plan: sources become units, parts are linked to a base, and the recipe's own elements are added."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree
from lxml.etree import _Element as Node

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import locate
from composer.link.angles import model_angle
from composer.link.files import add_file
from composer.link.layout import joint_type
from composer.link.link import finish, link
from composer.link.linking import FileUse, Linking, Measure
from composer.link.malformed import STUMBLES, malformed
from composer.plan.member import Member
from composer.plan.plan import AddElement, AppendElement, Plan, SetDefault, SetSingleton
from composer.sources.source import Source
from composer.steps.add import add
from composer.steps.attach import add_joints, check_joints, part_of
from composer.steps.elements import Making, settle_joints
from composer.steps.loose_ends import check_names
from composer.steps.members import Hung, hung, is_fixed, placed
from composer.steps.section import append, set_default, set_singleton
from composer.steps.urdf import urdf_unit
from composer.tree.classes import MAIN
from composer.tree.parse import parse_file
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from composer.engine import Session

_Key = tuple[Path, tuple[tuple[str, Path], ...], bool]


@dataclass(frozen=True, slots=True)
class Composed:
    """One flat model, the files it names, and the sources that are in it."""

    model: Unit
    files: tuple[FileUse, ...]
    members: tuple[Member, ...] = ()


@dataclass(slots=True)
class Composer:
    """Composes plans; each source file is parsed once and copied for every further use."""

    context: Context
    measure: Measure | None
    session: Session | None = None
    parsed: dict[_Key, Unit | None] = field(default_factory=dict)
    uses: Counter[_Key] = field(default_factory=Counter)
    hung: dict[Node, list[Hung]] = field(default_factory=dict)

    def compose(self, plan: Plan) -> Composed | None:
        """The model of a plan, or None where there were errors, those of earlier stages included."""
        self._count(plan, True)
        composed = self._compose(plan, True)
        if composed is None or self.context.sink.has_errors:
            return None
        return replace(composed, members=placed(self.hung[composed.model.root], composed.model.root))

    def _count(self, plan: Plan, stands: bool) -> None:
        for model, inner in _models(plan, stands):
            if isinstance(model, Plan):
                self._count(model, inner)
            else:
                self.uses[_key(model, inner)] += 1

    def _compose(self, plan: Plan, stands: bool) -> Composed | None:
        """The model of a plan; `stands` says that it is fixed in the world of what is made in the end."""
        base: Unit | None = _empty(plan)
        if plan.base.model is not None:
            base = self._unit(plan.base.model, plan.base.span, stands)
        units = [
            self._unit(step.model, locate(plan.document, (*step.at, "model")), stands and is_fixed(step))
            for step in plan.parts
        ]
        if base is None:
            return None
        given = [unit for unit in units if unit is not None]
        whole = len(given) == len(units)
        if not whole:
            plan = self._without_lost(plan, units)
        try:
            composed = self._joined(plan, base, given, stands)
            return composed if whole else None
        except STUMBLES:
            if malformed(self._anew(plan), self.context.sink):
                return None
            raise
        except RecursionError:
            self.context.sink.error(
                "not-supported", f"elements of a model in `{plan.file}` stand too deep inside one another"
            )
            return None

    def _without_lost(self, plan: Plan, units: list[Unit | None]) -> Plan:
        """The plan of the parts that there are, in which more faults can be found."""
        kept = [step for step, unit in zip(plan.parts, units, strict=True) if unit is not None]
        self.context.sink.forgive(
            step.prefix.removesuffix(plan.separator) for step in plan.parts if step not in kept
        )
        return replace(plan, parts=tuple(kept))

    def _joined(self, plan: Plan, base: Unit, units: list[Unit], stands: bool) -> Composed | None:
        """The parts hung on the base, and the recipe's own elements in it."""
        before = self.context.sink.error_count
        base.root.set("model", plan.name)
        if plan.base.keyframes == "none":
            for section in list(base.root.iterchildren("keyframe")):
                base.root.remove(section)
        making = Making(
            plan.document, plan.file, self.context.sink, plan.angle, plan.eulerseq,
            "radian", base.settings.eulerseq, plan.path.parent, base.file, base.origins,
        )  # fmt: skip
        base.origins.texts[plan.file] = plan.path
        parts = [part_of(step, unit, making) for step, unit in zip(plan.parts, units, strict=True)]
        linking = Linking(
            base, parts, self.context.sink, plan.separator, plan.conflict, plan.settled,
            isolate_base=frozenset(_top_tags(plan)),
            measure=self.measure,
        )  # fmt: skip
        making.model_angle = model_angle(linking)
        for step, part in zip(plan.parts, parts, strict=True):
            add_joints(step, part, linking, making)
        if not link(linking):
            return None
        _carry_out(plan, linking, making)
        if self.context.sink.error_count > before:
            return None
        finish(linking)
        roots = [base.root, *(unit.root for unit in units)]
        inner = {number: self.hung[root] for number, root in enumerate(roots) if root in self.hung}
        self.hung[base.root] = hung(plan, parts, inner, stands)
        if self.context.sink.error_count > before:
            return None
        flat = Unit(base.root, base.file, base.directory, base.label, _contents(linking.files), base.origins)
        return Composed(flat, tuple(linking.files))

    def _anew(self, plan: Plan) -> Iterator[Unit]:
        """The sources of a plan as their files have them."""
        for model, _ in _models(plan, True):
            if isinstance(model, Plan):
                yield from self._anew(model)
            elif model.format == "mjcf":
                unit = parse_file(model.path, Sink(), file=self.context.shown(model.path))
                if unit is not None:
                    yield unit

    def _unit(self, model: Source | Plan, span: Span | None, stands: bool) -> Unit | None:
        if isinstance(model, Plan):
            composed = self._compose(model, stands)
            return composed.model if composed else None
        key = _key(model, stands)
        if key not in self.parsed:
            refused = self.parsed.get((*key[:2], not key[2]), ...) is None  # one fault of a file is told once
            self.parsed[key] = None if refused else self._read(model, span, stands)
        unit = self.parsed[key]
        self.uses[key] -= 1
        if unit is None or self.uses[key] <= 0:
            return unit
        return unit.copied()

    def _read(self, model: Source, span: Span | None, stands: bool) -> Unit | None:
        if model.format == "urdf":
            return urdf_unit(model, self.context, self.session, span, stands=stands)
        return parse_file(model.path, self.context.sink, file=self.context.shown(model.path), span=span)


def _models(plan: Plan, stands: bool) -> Iterator[tuple[Source | Plan, bool]]:
    """What a plan is made of, and whether each of them stands in the world."""
    if plan.base.model is not None:
        yield plan.base.model, stands
    for part in plan.parts:
        yield part.model, stands and is_fixed(part)


def _key(model: Source, stands: bool) -> _Key:
    """What sources that read the same have in common; of MJCF it does not matter where it stands."""
    return model.path, model.packages, stands or model.format != "urdf"


def _top_tags(plan: Plan) -> Iterator[str]:
    """The tags for which the recipe sets the top class."""
    for step in plan.steps:
        if isinstance(step, SetDefault) and step.name == MAIN:
            yield from (child.tag for child in step.element.children)


def _empty(plan: Plan) -> Unit:
    return Unit(etree.Element("mujoco"), plan.file, plan.path.parent, plan.path.stem)


def _contents(files: list[FileUse]) -> dict[str, bytes | Path]:
    return {use.path: use.content if use.content is not None else Path(use.source) for use in files}


def _carry_out(plan: Plan, linking: Linking, making: Making) -> None:
    for step in plan.steps:
        if isinstance(step, AddElement):
            add(step, linking, making)
        elif isinstance(step, SetSingleton):
            set_singleton(step, linking, making)
        elif isinstance(step, SetDefault):
            set_default(step, linking, making)
        elif isinstance(step, AppendElement):
            append(step, linking, making)
    if making.pending:
        classes = linking.base.classes

        def kind(joint: Node) -> str:
            return joint_type(joint, classes)

        settle_joints(making, kind)
    check_names(linking, making)
    for part in plan.parts:
        check_joints(part, linking, making)
    for node, attribute, name in making.files:
        add_file(linking, making.directory, node, attribute, name)
