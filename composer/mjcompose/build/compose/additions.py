"""Steps: elements that a recipe adds, some of which parts are attached to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.build.compose.elements import ElementBuilder, make_node
from mjcompose.build.plan.plan import Plan
from mjcompose.build.plan.steps import AddedPlace, AddElement, Step, steps_adding
from mjcompose.link.bodies import bodies
from mjcompose.link.inertia import has_mass
from mjcompose.link.linking import Linking
from mjcompose.tree.classes import NESTED, own
from mjcompose.tree.cost import all_scaled_above
from mjcompose.tree.edit import unresolved
from mjcompose.tree.grammar import GRAMMAR


def add_element(step: AddElement, linking: Linking, making: ElementBuilder) -> None:
    """Append the element; in the world it takes the base's top class, as if it were written in the base."""
    in_world = step.to_kind == "world"
    holder = linking.base.section("worldbody") if in_world else linking.names.find(step.to_kind, step.to)
    if holder is None:
        _report_no_target(step, linking, making)
    kind = GRAMMAR.element("worldbody" if step.to_kind == "world" else step.to_kind)
    node = make_node(step.element, kind.children.get(step.element.tag, kind), making)
    making.register(node, "worldbody")
    for place in node.iter("body", "frame", "site"):  # later entries may add to it, and parts may be attached to it
        if name := place.get("name"):
            linking.names.declared.setdefault(str(place.tag), {}).setdefault(str(name), place)
    if holder is None:
        return  # its names count as declared, so references to them are not a second fault
    if step.to_kind == "world" and linking.base_class is not None:
        # Each child has its own class: for `<worldbody childclass="c">` MuJoCo 4.0 says "World body cannot have
        # attributes".
        if node.tag in NESTED:
            if node.get("childclass") is None:
                node.set("childclass", linking.base_class)
        elif node.tag in ("geom", "site", "camera", "light") and node.get("class") is None:
            node.set("class", linking.base_class)
    _check_scale(step, holder, linking, making=making)
    holder.append(node)
    _check_mass(step, node, linking, making=making)


def _check_scale(step: AddElement, holder: Node, linking: Linking, making: ElementBuilder) -> None:
    """Report an element that a frame of a source would scale: the recipe writes meters and kilograms."""
    base = linking.base
    for frame in all_scaled_above(holder):
        if isinstance(base.origins.owner(frame, base.file), str):
            message = f"`{step.to}` is inside a frame that scales: the element would have another size and mass"
            span = linking.span(base, frame, "scale" if frame.get("scale") else "massscale")
            help, notes = "add it outside of the frame, or write the frame without scale", (Note("the frame", span),)
            making.sink.error("not-supported", message, step.to_span, notes=notes, help=help, subjects=(step.to,))
            return


def _check_mass(step: AddElement, node: Node, linking: Linking, making: ElementBuilder) -> None:
    """Report a geom that adds no mass, but would if the inertia rules of its model were not written out."""
    body: Node | None = node.getparent()
    while body is not None and body.tag in ("frame", "replicate"):
        body = body.getparent()
    # An inertial wins over geoms, even over geoms that are added later.
    if body not in linking.notes.inertia_written:
        return
    geoms = [node] if node.tag == "geom" else own(node, "geom") if node.tag in ("frame", "replicate") else []
    if any(has_mass(geom, linking.base.classes) for geom in geoms):
        message = f"the element adds no mass to `{step.to}`: the compiler settings of its model give the inertia"
        help = "put it into a `body` of its own, or write `mass: 0`"
        making.sink.warning("compiler-setting", message, step.span, help=help)


def _report_no_target(step: AddElement, linking: Linking, making: ElementBuilder) -> None:
    written = "to: {frame: {}}" if step.to_kind == "frame" else "to: {}"
    help: str | None = None
    later = linking.later_places.target_of(step.to_kind, step.to) if linking.later_places else None
    if later is not None:
        message = f"the {step.to_kind} `{step.to}` to add to does not exist yet: a later entry adds it"
        notes = (Note("it is added here", later[1]),)
        help = "put that entry above this one"
        making.sink.error("unknown-name", message, step.to_span, notes=notes, help=help, subjects=(step.to,))
        return
    kinds = linking.names.kinds_of(step.to)
    if step.to_kind == "body" and "frame" in kinds:
        help = f"`{step.to}` is a frame: write `to: {{frame: {step.to}}}`"
    elif step.to_kind == "frame" and "body" in kinds:
        help = f"`{step.to}` is a body: write `to: {step.to}`"
    elif "site" in kinds:
        site = linking.names.find("site", step.to)
        holder = site.getparent() if site is not None else None
        if holder is not None and holder.tag == "body" and holder.get("name"):
            help = f"`{step.to}` is a site: write `to: {holder.get('name')}`, the body that contains it"
    making.sink.add(
        unresolved(linking, step.to_kind, step.to, span=step.to_span, written=written, purpose=" to add to", help=help)
    )


Place = tuple[str, str]


@dataclass(slots=True)
class EarlyAdditions:
    """Carries out the `add` entries that parts wait for."""

    plan: Plan
    linking: Linking
    making: ElementBuilder
    places: Mapping[Place, AddedPlace] = field(init=False)
    done: dict[int, AddElement] = field(default_factory=dict)
    """By identity: to compare two entries is to compare all that they say."""
    names_of: dict[int, list[Place]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.places = self.plan.added_places
        for name, place in self.places.items():
            self.names_of.setdefault(id(place.step), []).append(name)

    def make(self, kind: str, name: str) -> list[Place]:
        """Add a place and the elements above it. Return all new places, none if it cannot be added yet."""
        steps = steps_adding(self.places, kind, name, done=self.done)
        if not steps or not self._is_ready(steps[0]):
            return []
        for step in steps:
            # Changes so far belong to the pass.
            self.linking.watch(self.linking.units, bodies)
            add_element(step, self.linking, self.making)
            self.linking.watch(self.linking.units, step)
            self.done[id(step)] = step
        return [name for step in steps for name in self.names_of[id(step)]]

    def has_done(self, step: Step) -> bool:
        """Return whether the step was carried out because a part waited for it."""
        return id(step) in self.done

    def names(self) -> list[Place]:
        """Return the kind and the name of each place that is not made yet."""
        return [key for key, place in self.places.items() if not self.has_done(place.step)]

    def waits_for(self, kind: str, name: str) -> Place | None:
        """Return the place that must exist before this place can be added, or None if it exists."""
        steps = steps_adding(self.places, kind, name, done=self.done)
        return (steps[0].to_kind, steps[0].to) if steps else None

    def target_of(self, kind: str, name: str) -> tuple[str, Span] | None:
        """Return the target of an added place and the span of the place's name, or None if no entry adds it."""
        steps = steps_adding(self.places, kind, name)
        return (steps[0].to, self.places[kind, name].span) if steps else None

    def _is_ready(self, step: AddElement) -> bool:
        if step.to_kind == "world":
            return True
        holder = self.linking.names.find(step.to_kind, step.to)
        return holder is not None and holder.getroottree().getroot() is self.linking.base.root
