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

Place = tuple[str, str]


@dataclass(slots=True)
class EarlyAdditions:
    """Carries out the `add` entries that parts wait for; `done` lists those carried out."""

    plan: Plan
    linking: Linking
    making: ElementBuilder
    places: Mapping[Place, AddedPlace] = field(init=False)
    done: list[AddElement] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.places = self.plan.added_places

    def make(self, kind: str, name: str) -> bool:
        """Make a place. Return False if no entry adds it, or if what it is added to is not in the model yet."""
        steps = makers(self.places, kind, name)
        waiting = [step for step in steps if step not in self.done]
        if not waiting or not self._stands(waiting[0]):
            return False
        for step in waiting:
            # What the pass has done so far is its own, for those who watch.
            self.linking.watch(self.linking.units, bodies)
            add(step, self.linking, self.making)
            self.linking.watch(self.linking.units, step)
            self.done.append(step)
        return True

    def names(self) -> list[Place]:
        """Return the kind and the name of each place that is not made yet."""
        return [key for key, place in self.places.items() if place.step not in self.done]

    def stands_on(self, kind: str, name: str) -> tuple[str, Span] | None:
        """Return what a place is added to and where its name is written, or None if no entry adds it."""
        steps = makers(self.places, kind, name)
        return (steps[0].to, self.places[kind, name].span) if steps else None

    def _stands(self, step: AddElement) -> bool:
        if step.to_kind == "world":
            return True
        holder = self.linking.names.find(step.to_kind, step.to)
        return holder is not None and holder.getroottree().getroot() is self.linking.base.root
