"""Elements that a recipe adds and that parts are attached to; they are added as soon as their parent exists."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from composer.compose.add import add
from composer.compose.elements import ElementBuilder
from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.bodies import bodies
from composer.link.linking import Linking
from composer.plan.added_places import AddedPlace, makers
from composer.plan.plan import Plan
from composer.plan.steps.add_element import AddElement
from composer.plan.steps.step import Step

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
        """Make a place and what it is added to. Return all that this makes, nothing if it cannot be made yet."""
        steps = makers(self.places, kind, name, done=self.done)
        if not steps or not self._stands(steps[0]):
            return []
        for step in steps:
            # What the pass has done so far is its own, for those who watch.
            self.linking.watch(self.linking.units, bodies)
            add(step, self.linking, self.making)
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
        """Return what has to be in the model before a place can be made, or None if nothing is left to be made."""
        steps = makers(self.places, kind, name, done=self.done)
        return (steps[0].to_kind, steps[0].to) if steps else None

    def stands_on(self, kind: str, name: str) -> tuple[str, Span] | None:
        """Return what a place is added to and where its name is written, or None if no entry adds it."""
        steps = makers(self.places, kind, name)
        return (steps[0].to, self.places[kind, name].span) if steps else None

    def _stands(self, step: AddElement) -> bool:
        if step.to_kind == "world":
            return True
        holder = self.linking.names.find(step.to_kind, step.to)
        return holder is not None and holder.getroottree().getroot() is self.linking.base.root
