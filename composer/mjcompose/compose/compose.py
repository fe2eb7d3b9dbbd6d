"""Carrying out a plan: sources become units, the linker joins the parts, and steps act on the result."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, TypeVar

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.access import NOTHING
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Path as KeyPath
from mjcompose.base.extensions import check_rows
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import LaterName, Sink
from mjcompose.compose.attach import (
    UnplacedRecord,
    add_element,
    check_hung,
    check_joints,
    early_additions,
    hang_up,
    later_places,
    parts_of,
    placed_records,
    unplaced_records,
)
from mjcompose.compose.checks import (
    check_angles_of_targets,
    check_class_angles,
    check_intervals,
    check_mass,
    check_names,
    check_names_of_keys,
)
from mjcompose.compose.collisions import Exclusions, set_collisions
from mjcompose.compose.compiler import check_assumed, note_rules_of_base
from mjcompose.compose.editing import EditCost
from mjcompose.compose.effects import report_without_effect
from mjcompose.compose.elements import ElementBuilder, append_element, set_default, set_singleton, settle_joints
from mjcompose.compose.interface import order_elements
from mjcompose.compose.keyframe import hold_poses, write_keyframes
from mjcompose.compose.load import InnerModels, Key, Library, Loader, PartSource, part_sources, source_key
from mjcompose.compose.placing import mirror_keys, scattered, with_free_copies
from mjcompose.link.agreement import SINGLETONS, common_settings, of_base, requested_settings, set_value
from mjcompose.link.boundaries import crossings
from mjcompose.link.collect import check_files
from mjcompose.link.delays import delays
from mjcompose.link.excerpt import Excerpt
from mjcompose.link.files import IN_BUNDLE, SHARED, Merged, add_file, dedup, share_in_copies
from mjcompose.link.key_layout import joint_type
from mjcompose.link.link import finish, link
from mjcompose.link.linking import AddedElement, FileUse, Linking, LinkRequest, ModelMeasure, common_angle
from mjcompose.link.measure import measure_with
from mjcompose.link.replicates import spare_added
from mjcompose.link.source_check import check_source, repair
from mjcompose.link.submodels import add_named_file, attached_size
from mjcompose.link.subtree import DroppedElement, Subtree
from mjcompose.link.unit_keys import KeyNotes, remove_keys
from mjcompose.mujoco.engine import Session
from mjcompose.plan.plan import (
    BASE,
    Drawn,
    EditOutcome,
    ElementDraws,
    ExcludedPair,
    GeneratedShapes,
    PartRecord,
    Plan,
    Tables,
    part_name,
)
from mjcompose.plan.planner import STEPS
from mjcompose.plan.read import read_source
from mjcompose.plan.steps import AddElement, AppendElement, SetDefault, SetSingleton, Step
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN
from mjcompose.tree.cost import check_size, written
from mjcompose.tree.grammar import NotMjcf
from mjcompose.tree.journal import explained
from mjcompose.tree.merged_settings import Adopted
from mjcompose.tree.unit import Unit, Watch, nobody

if TYPE_CHECKING:
    from mjcompose.compose.edits import ModelEdits
    from mjcompose.compose.mesh_jobs import MeshWorkshop
    from mjcompose.compose.terrain import MadeTerrain

Result = TypeVar("Result")
# Other additions would change the mass that `settotalmass` of the base gives each body: MuJoCo scales the whole model
# to it.
_WEIGHTLESS = ("site", "camera", "light")
# These functions write a step into the joined model. Steps that wait for the whole model are in other modules.
_WRITE: Mapping[type[Step], Callable[[Any, Linking, ElementBuilder], None]] = {
    AddElement: add_element,
    SetSingleton: set_singleton,
    SetDefault: set_default,
    AppendElement: append_element,
}
check_rows(f"the steps that {__name__} carries out", _WRITE, [each for each in STEPS if not each.waits])


class Composed(Struct):
    """One flat model and the contents of its manifest; `tables` has elements of sources that are not MJCF.

    `merged` has the names of assets that were merged into equal ones, by kind, each with the name of the other one.
    `terrain` is the file about the terrains that mjcompose made, if there are any.
    """

    model: Unit
    files: tuple[FileUse, ...]
    members: tuple[PartRecord, ...] = ()
    drawn: tuple[Drawn, ...] = ()
    tabled: tuple[ElementDraws, ...] = ()
    shapes: tuple[GeneratedShapes, ...] = ()
    excluded: tuple[ExcludedPair, ...] = ()
    unsearched: int = 0
    keys: KeyNotes = field(default_factory=KeyNotes)
    tables: Tables = field(default_factory=dict)
    merged: Merged = field(default_factory=dict)
    terrain: bytes | None = None


class ComposeOptions(Struct):
    """Options of composing.

    With `checks_sources`, every element of a source must be valid MJCF. With `notes_parts`, the composer records the
    part of each element. Without `makes_shapes`, it uses only stored results of work on meshes, which may take minutes.
    Copies of a part share its meshes, textures and height fields with `shares_assets`; with `deduplicates`, all equal
    assets become one.
    """

    checks_sources: bool = False
    notes_parts: bool = False
    makes_shapes: bool = True
    shares_assets: bool = True
    deduplicates: bool = False


class Composer:
    """Composes plans. The keys of `subtrees` and `edits` are recipe and path, and the keys of `parts` are elements."""

    def __init__(
        self,
        context: Context,
        measure: ModelMeasure | None,
        session: Session | None = None,
        *,
        watch: Watch = nobody,
        library: Library | None = None,
        options: ComposeOptions | None = None,
    ) -> None:
        self.context = context
        self.measure = measure
        self.watch = watch
        self.options = options or ComposeOptions()
        self.notes_parts = self.options.notes_parts
        self.workshop: MeshWorkshop | None = None
        self.exclusions = Exclusions()
        self.loader = Loader(context, session, watch, library=library, checks=self.options.checks_sources)
        self.subtrees: dict[tuple[str, KeyPath], Subtree] = {}
        self.edits: dict[tuple[str, KeyPath], EditOutcome] = {}
        self.cost = EditCost()
        self.unplaced: dict[Node, list[UnplacedRecord]] = {}
        self.parts: dict[Node, str] = {}
        self.keys = KeyNotes()
        self.inner: list[Composed] = []
        self.terrains: list[MadeTerrain] = []
        self.nested = 0

    def compose(self, plan: Plan) -> Composed | None:
        """Return the model of a plan, or None if there were errors, including those of earlier stages."""
        self.expect(plan)
        self.notes_parts = self.notes_parts or plan.selects_parts
        if (composed := self._compose(plan, True)) is None or self.context.sink.has_errors:
            return None
        report_without_effect(composed.model, self.context.sink)
        shapes = () if self.workshop is None else tuple(self.workshop.shapes_in(composed.model.root))
        shapes += tuple(shape for each in self.inner for shape in each.shapes)
        members = placed_records(self.unplaced[composed.model.root], composed.model.root)
        excluded = tuple(
            ExcludedPair(str(node.get("body1")), str(node.get("body2")), why) for node, why in self.exclusions.written
        )
        tables = dict(self.loader.tables())
        for each in self.inner:
            tables.update(each.tables)
        merged, files = self._merged_assets(plan, composed)
        return replace(
            composed,
            files=files,
            merged=merged,
            members=members,
            shapes=shapes,
            excluded=excluded,
            unsearched=self.exclusions.unsearched,
            keys=self.keys,
            tables=tables,
            terrain=self._about_terrains(composed.model.root),
        )

    def _about_terrains(self, root: Node) -> bytes | None:
        if not self.terrains:
            return None
        from mjcompose.compose.terrain import about  # few recipes need it

        return about(each for each in self.terrains if each.node.getroottree().getroot() is root)

    def _merged_assets(self, plan: Plan, composed: Composed) -> tuple[Merged, tuple[FileUse, ...]]:
        """Merge equal assets as the options say. Return the merged names and the remaining files."""
        model = composed.model
        files = composed.files
        if self.options.deduplicates:
            merged, files = dedup(model, files, plan.prefixes)
            self.watch([model], dedup)
            return merged, files
        copies = plan.copies if self.options.shares_assets else {}
        kinds = [kind for kind in SHARED if not plan.draws_assets(kind)]
        if not copies or not kinds:
            return {}, files
        merged, files = share_in_copies(model, files, plan.prefixes, kinds, copies)
        self.watch([model], share_in_copies)
        return merged, files

    def unit_of(self, plan: Plan, source: PartSource) -> Unit | None:
        """Return the base or a part of a plan alone, reduced to the requested subtree, or None if it has faults."""
        return self.guarded(plan, source.is_fixed_in_world, lambda again: again._unit(plan, source))

    def read_subtrees(self, plan: Plan, is_fixed: bool = True) -> None:
        """Take the subtrees of a plan, whose sources are expected, and compose only these."""
        for each in part_sources(plan, is_fixed):
            if each.body is not None or each.drop:
                self.unit_of(plan, replace(each, edit=()))
            elif isinstance(each.model, Plan):
                self.read_subtrees(each.model, each.is_fixed_in_world)

    def expect(self, plan: Plan, is_fixed: bool = True) -> None:
        """Record the sources that the plan needs, and how often it needs them."""
        for place in plan.walk(is_fixed):
            if isinstance(place.model, Source):
                request = place.request
                is_edited = request is not None and bool(request.edit or request.drop)
                self.loader.expect(place.model, place.is_fixed_in_world, is_edited=is_edited)
        inner = {
            os.path.realpath(each.path): each for outer in plan.plans() for step in outer.members for each in step.inner
        }
        if inner:
            self.loader.embed = InnerModels(
                inner, self._composed_alone, self.context.sink, shown=self.context.shown
            ).embed

    def _composed_alone(self, plan: Plan) -> Unit | None:
        # The manifest has no names of the inside of models that MuJoCo attaches.
        options = replace(self.options, shares_assets=False, deduplicates=False)
        composer = Composer(
            self.context, self.measure, self.loader.session, library=self.loader.library, options=options
        )
        if (composed := composer.compose(plan)) is None:
            return None
        self.inner.append(composed)
        return replace(composed.model, label=plan.path.stem)

    def _compose(self, plan: Plan, is_fixed: bool) -> Composed | None:
        """Return the model of a plan. With `is_fixed`, it is fixed in the world of the final model."""
        return self.guarded(plan, is_fixed, lambda again: again._composed(plan, is_fixed))

    def guarded(self, plan: Plan, is_fixed: bool, work: Callable[[Composer], Result | None]) -> Result | None:
        """Return the result of the work, or None if it fails because of a source that is not valid MJCF.

        Any other exception is a bug, and goes on: it says nothing about the sources.
        """
        try:
            return work(self)
        except NotMjcf:
            library = dict(self._reread_sources(plan, is_fixed))
            faulty = [unit for unit in library.values() if not check_source(unit, self.context.sink)]
            if not faulty:
                raise
            # The work is repeated with corrected sources: an exception that still occurs is a bug.
            for unit in library.values():
                repair(unit)
            context = replace(self.context, sink=Sink())
            options = ComposeOptions(notes_parts=self.notes_parts)
            again = Composer(context, self.measure, self.loader.session, library=library, options=options)
            again.expect(plan, is_fixed)
            with suppress(RecursionError):
                work(again)
        except RecursionError:
            self.context.sink.error("not-supported", f"elements of a model in `{plan.file}` are nested too deeply")
        return None

    def _composed(self, plan: Plan, is_fixed: bool) -> Composed | None:
        base, *units = self._units(plan, is_fixed) or [None]
        if base is None:
            return None
        if any(step.attachment.mirror is not None for step in plan.parts):
            mirror_keys(plan, units, self.context, session=self.loader.session, notes=self.keys)
        read = [unit for unit in units if unit is not None]
        if len(read) == len(units):
            placed = self._with_places(plan, base, read, is_fixed=is_fixed)
            if placed is None:
                return None
            with self.context.sink.naming_later(_later_names(plan)):
                return self._joined(placed, base, read, is_fixed=is_fixed)
        # A model without some of its parts is only good for finding more errors.
        kept = [step for step, unit in zip(plan.parts, units, strict=True) if unit is not None]
        self.context.sink.suppress_about(part_name(step, plan.separator) for step in plan.parts if step not in kept)
        plan = with_free_copies(plan)
        with self.context.sink.naming_later(_later_names(plan)):
            self._joined(replace(plan, parts=tuple(kept)), base, read, is_fixed=is_fixed)
        return None

    def _with_places(self, plan: Plan, base: Unit, units: list[Unit], is_fixed: bool) -> Plan | None:
        """Return the plan with a place for each scattered copy, or None after a reported error."""
        if not any(step.waits for step in plan.parts):
            return plan

        def preview(free: Plan) -> Unit | None:
            return self._preview(free, base, units, is_fixed=is_fixed)

        return scattered(plan, preview, context=self.context, session=self.loader.session)

    def _preview(self, plan: Plan, base: Unit, units: list[Unit], is_fixed: bool) -> Unit | None:
        """Join copies of the units, with a composer of its own, which nobody watches. Report only errors."""
        context = replace(self.context, sink=Sink(), timings=[])
        options = replace(self.options, notes_parts=self.notes_parts)
        aside = Composer(context, self.measure, self.loader.session, library=self.loader.library, options=options)
        copies: list[Unit] = []
        for unit in (base, *units):
            copied = unit.copied()
            copies.append(copied)
            if self.parts:
                pairs = zip(unit.root.iter(), copied.root.iter(), strict=True)
                aside.parts |= {copy: self.parts[node] for node, copy in pairs if node in self.parts}
        with journal.unrecorded(), context.sink.naming_later(_later_names(plan)):
            composed = aside._joined(plan, copies[0], copies[1:], is_fixed=is_fixed)
        self.context.sink.extend(context.sink.errors)
        return None if composed is None or context.sink.has_errors else composed.model

    def _units(self, plan: Plan, is_fixed: bool) -> list[Unit | None] | None:
        """Return the base and the parts, or None after a reported error if they have too many elements together."""
        units: list[Unit | None] = []
        elements = 0
        text = 0
        limits = in_force()
        for each in part_sources(plan, is_fixed):
            if (unit := self._unit(plan, each)) is not None:
                check_size(unit, self.context.sink, attached_size(unit))
                elements += written(unit.root)
                text += unit.origins.size
            for limit, name, count, most in (
                ("elements", "elements", elements, limits.elements),
                ("xml-size", "bytes of XML", text, limits.xml_size),
            ):
                if count > most:
                    message = f"the parts up to here have {count} {name}; {most} are allowed"
                    span = locate(plan.document, (*each.at, "model"))
                    self.context.sink.error("limit-exceeded", message, span, help=advice(limit))
                    return None
            units.append(unit)
        return units

    def _joined(self, plan: Plan, base: Unit, units: list[Unit], is_fixed: bool) -> Composed | None:
        """Attach the parts to the base, add the recipe's own elements, and return the result."""
        # Each call needs those before it: steps name joined elements, edits also select elements that steps add,
        # `finish` lays out keys after edits have reshaped elements, MuJoCo measures poses and contacts on the finished
        # model, and edits of keys act on their final rows.
        before = self.context.sink.error_count
        journal.write(base.root, "model", plan.name)
        if plan.base_keys == "none" and BASE not in plan.key_sources:
            remove_keys(base.root)
        self.watch([base, *units], plan)
        making = ElementBuilder.of(plan, base, self.context, model_angle=common_angle([base, *units]))
        linking = self._linking(plan, base, units, making=making)
        early = early_additions(plan, linking.parts, making)
        linking.additions = tuple(early.values())
        linking.later_places = later_places(plan)
        is_linked = link(linking)
        for addition in linking.additions:
            if addition.is_hung and isinstance(addition.step, AddElement):
                check_hung(addition.step, addition.node, linking, making)
        if not is_linked:
            return None
        self.keys.note_joined(linking)
        _carry_out(plan, linking, making, early=early)
        if any(element.terrain for element in making.made.values()):
            from mjcompose.compose.terrain import write_terrains  # few recipes need it

            self.terrains += write_terrains(linking, making)
            linking.watch(linking.units, write_terrains)
        changes: ModelEdits | None = None
        if plan.edits or plan.draws:
            from mjcompose.compose.edits import ModelEdits  # few recipes need it

            changes = ModelEdits(plan, linking, making, composer=self)
        self._edit(plan, changes, linking, making=making)
        if self.context.sink.error_count > before:
            return None
        finish(linking)
        spare_added(linking)
        delays(linking)
        linking.watch(linking.units, delays)
        hold_poses(plan, linking, making, context=self.context, session=self.loader.session, is_whole=not self.nested)
        linking.watch(linking.units, hold_poses)
        samples = self.options.makes_shapes
        self.exclusions += set_collisions(
            plan, linking, making, context=self.context, session=self.loader.session, samples=samples
        )
        check_names_of_keys(linking, making)
        if changes:
            changes.of_keys()
        order_elements(plan, linking, keys=True)
        self.keys.note_written(linking)
        roots = [base.root, *(unit.root for unit in units)]
        inner = [self.unplaced.get(root, []) for root in roots]
        self.unplaced[base.root] = unplaced_records(plan, part_sources(plan, is_fixed), linking, inner=inner)
        if self.context.sink.error_count > before:
            return None
        drawn, tabled = (changes.drawn, changes.tabled) if changes else ([], [])
        return Composed(linking.flat(), tuple(linking.files), drawn=(*plan.drawn, *drawn), tabled=tuple(tabled))

    def _linking(self, plan: Plan, base: Unit, units: list[Unit], making: ElementBuilder) -> Linking:
        """Return the base and its parts, with the joints between them, ready to be linked."""
        parts = parts_of(plan, units, making)
        top = [step.element for step in plan.steps if isinstance(step, SetDefault) and step.name == MAIN]
        request = LinkRequest(
            plan.separator,
            plan.conflict,
            plan.settled,
            base_keyframes=plan.base_keys,
            requested_keys=plan.key_sources if plan.keyframes else None,
            isolated_tags=frozenset(child.tag for element in top for child in element.children),
            adds_mass=_adds_mass(plan),
        )
        linking = Linking(base, parts, self.context.sink, request=request, measure=self.measure, watch=self.watch)
        self.watch(linking.units, linking)
        # Before the units are joined. A nested recipe has already recorded its own parts.
        if self.notes_parts:
            for step, unit in zip(plan.parts, units, strict=True):
                name = part_name(step, plan.separator)
                for node in unit.root.iter("*"):
                    inner = self.parts.get(node)
                    self.parts[node] = f"{name}/{inner}" if inner else name
        note_rules_of_base(plan, linking)
        return linking

    def _edit(self, plan: Plan, changes: ModelEdits | None, linking: Linking, making: ElementBuilder) -> None:
        """Carry out the edits, lay out the keys, and report faults of the model before it is finished."""
        sink = self.context.sink
        are_named = True
        if changes and sink.has_errors:  # in a model that lacks something, a selector selects other elements
            are_named = changes.in_doubt()
        else:
            if changes:
                changes.edit()
            crossings(linking)
            linking.watch(linking.units, crossings)
            order_elements(plan, linking)  # before draws, which count elements without a name
            if changes:
                changes.draw()
        check_intervals(making)
        if are_named:
            write_keyframes(plan, linking, making)
        if sink.has_errors:
            # A missing file is reported next to other errors. The mass that a joint moves is then unknown.
            check_files(linking.base, linking.files, sink, shown=self.context.shown)
        elif are_named:
            for step, part in zip(plan.parts, linking.parts, strict=True):
                if not step.floats:
                    check_mass(step, part, linking, making=making)
        check_size(linking.base, sink, attached_size(linking.base))

    def mesh_workshop(self) -> MeshWorkshop:
        """Return the workshop for meshes, the same for the whole composition."""
        if self.workshop is None:
            from mjcompose.compose.mesh_jobs import MeshWorkshop  # few recipes need it

            self.workshop = MeshWorkshop(self.context, self.options.makes_shapes)
        return self.workshop

    def _reread_sources(self, plan: Plan, is_fixed: bool) -> Iterator[tuple[Key, Unit]]:
        """Yield the sources of a plan as they are in their files."""
        for place in plan.walk(is_fixed):
            if isinstance(place.model, Source) and place.model.format != "urdf":
                unit = read_source(place.model, Sink(), file=self.context.shown(place.model.path))
                if unit is not None and (self.loader.embed is None or self.loader.embed(unit)):
                    yield source_key(place.model, place.is_fixed_in_world), unit

    def _unit(self, plan: Plan, source: PartSource) -> Unit | None:
        """Return the base or a part of a plan, reduced to the requested subtree, or None if it has faults."""
        if source.model is None:
            return Unit(etree.Element("mujoco"), plan.file, plan.path.parent, label=plan.path.stem, door=NOTHING)
        unit: Unit | None
        excerpt: Excerpt | None = None
        if isinstance(source.model, Plan):
            self.nested += 1
            try:
                composed = self._compose(source.model, source.is_fixed_in_world)
            finally:
                self.nested -= 1
            unit = composed.model if composed else None
        else:
            span = locate(plan.document, (*source.at, "model"))
            if source.body is not None:
                excerpt = self.loader.excerpt(source.model, source.body, span, source.is_fixed_in_world)
            unit = self.loader.unit(source.model, span, source.is_fixed_in_world) if excerpt is None else excerpt.unit
        if unit is None:
            return None
        if isinstance(source.model, Source):
            check_assumed(source.model.compiler, unit, plan, source.at, sink=self.context.sink)
            self.keys.note_source(unit)
        if not source.check_dropped_keys(unit, plan.document, self.context.sink):
            return None
        if source.body is not None:
            if (subtree := source.take(unit, excerpt, self.context.sink, self.measure)) is None:
                return None
            self.watch([unit], subtree)
            self.subtrees[plan.place_of(source.at)] = subtree
        return self._edited(plan, source, unit)

    def _edited(self, plan: Plan, source: PartSource, unit: Unit) -> Unit | None:
        """Carry out the drops and edits of a part, and return it, or None if it has faults."""
        dropped: tuple[DroppedElement, ...] | None = ()
        if source.drops_elements or source.edit:
            from mjcompose.compose.edits import PartEdits  # few recipes need it

            dropped = PartEdits(plan, source, unit, composer=self).carry_out()
        is_sound = not isinstance(source.model, Source) or self.loader.is_sound(
            unit, source.model, source.is_fixed_in_world
        )
        if dropped is None or not is_sound:
            return None
        if source.drops_elements:
            known = self.subtrees.get(plan.place_of(source.at), Subtree.of(None, ()))
            self.subtrees[plan.place_of(source.at)] = known.with_dropped(dropped)
        return unit


def _later_names(plan: Plan) -> Iterator[LaterName]:
    """Yield the names that the edits of a plan give."""
    if plan.edits:
        from mjcompose.compose.edits import later_names  # few recipes need it

        yield from later_names(plan.edits)


def _adds_mass(plan: Plan) -> bool:
    """Return whether the recipe adds bodies, geoms or assets, and leaves the rules for the whole model to the base."""
    if any(isinstance(step, SetSingleton) and step.section == "compiler" for step in plan.steps):
        return False
    assets = any(isinstance(step, AppendElement) and step.section == "asset" for step in plan.steps)
    return assets or any(isinstance(step, AddElement) and step.element.tag not in _WEIGHTLESS for step in plan.steps)


def _carry_out(plan: Plan, linking: Linking, making: ElementBuilder, early: Mapping[int, AddedElement]) -> None:
    for step in plan.steps:
        addition = early.get(id(step))
        write = _WRITE.get(type(step))
        if write is None or (addition is not None and addition.is_hung):
            continue
        if addition is not None and isinstance(step, AddElement):
            hang_up(step, addition, linking, making)
        else:
            write(step, linking, making)
        linking.watch(linking.units, step)
    if making.pending:
        settle_joints(making, lambda joint: joint_type(joint, linking.base.classes))
        check_class_angles(linking, making)
        linking.watch(linking.units, settle_joints)
    check_names(linking, making)
    check_angles_of_targets(linking, making)
    linking.watch(linking.units, check_names)
    for part in plan.parts:
        check_joints(part, linking, making)
    with explained(IN_BUNDLE):
        for node, attribute, name in making.files:
            add_named_file(linking, making.named_file(node, attribute, name))
    if making.files:
        linking.watch(linking.units, add_file)
    making.files.clear()


def adopted_settings(plan: Plan, context: Context, library: Library) -> tuple[Adopted, ...]:
    """Return the settings that the parts which write them agree on; none for a faulty model."""
    if not plan.parts:
        return ()
    aside = replace(context, sink=Sink())
    composer = Composer(aside, measure_with(aside), library=library)
    composer.expect(plan)
    return composer.guarded(plan, True, lambda again: _settings(plan, again, True).adopted) or ()


def _settings(plan: Plan, composer: Composer, is_fixed: bool) -> Unit:
    units: list[Unit] = []
    for source in part_sources(plan, is_fixed):
        if isinstance(source.model, Plan):
            units.append(_settings(source.model, composer, source.is_fixed_in_world))
        else:
            read = None if source.model is None else composer.unit_of(plan, source)
            units.append(read or Unit(etree.Element("mujoco"), plan.file, plan.path.parent, label=plan.path.stem))
    base, *parts = units
    of_parts = zip(plan.parts, parts, strict=True)
    own = requested_settings(base)
    common, _ = common_settings(
        own, [(step.prefix or part.label, requested_settings(part)) for step, part in of_parts], plan.settled
    )
    adopted = (*of_base(base.adopted, own, plan.settled), *common.values())
    unit = Unit(base.root, base.file, base.directory, label=base.label, origins=base.origins, adopted=adopted)
    for setting in common.values():
        if setting.is_written:
            set_value(unit, setting.path, setting.value)
    making = ElementBuilder.of(plan, unit, composer.context, model_angle="radian")
    linking = Linking(unit, [], composer.context.sink)
    for step in plan.steps:
        if isinstance(step, SetSingleton) and step.section in SINGLETONS:
            set_singleton(step, linking, making)
    return unit
