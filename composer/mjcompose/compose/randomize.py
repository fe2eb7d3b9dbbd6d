"""Step: write the draws of one field of `randomize` for a sample into a model."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import field
from itertools import zip_longest
from typing import Any, Literal

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.distribution import CHOICE
from mjcompose.compose.editing import Editing, ExpectedCount, cost_of_draws, select_counted
from mjcompose.compose.lengths import why_a_length
from mjcompose.compose.values import EntryValues, Masses, UnusableValue
from mjcompose.compose.verbs.values import OPERATIONS, ValueChange, report_only_zeros, zero_attributes
from mjcompose.language.assign import MASS
from mjcompose.language.value import attribute_and_index, must_not_be_negative, no_angle
from mjcompose.link import numbers
from mjcompose.plan.plan import BASE, Drawn, ElementDraws
from mjcompose.plan.steps import AngleSettings, DrawValues
from mjcompose.text.expression import Angle, Value
from mjcompose.tree.select import kind_of, name_of, numbered, parent_of
from mjcompose.tree.unit import RecipeValue
from mjcompose.tree.values import is_in_degrees, may_be_angle


def draw_values(step: DrawValues, editing: Editing) -> tuple[list[Drawn], list[ElementDraws]]:
    """Write and return the draws of every selected element, and for a table; for sample 0, check all samples."""
    entry = step.field
    assert entry.select is not None
    count = ExpectedCount(entry.expect, entry.optional, at=(*entry.at, "expect"))
    cost = cost_of_draws(0 if step.sample else step.samples, step.tabled)
    nodes = select_counted(editing, entry.select, (*entry.at, "select"), count=count, values=cost)
    draws = _FieldDraws(step, editing, Masses(editing, nodes))
    drawn: dict[object, Drawn] = {}
    tabled: list[ElementDraws] = []
    zeros = zero_attributes(editing, nodes, (entry.attr,)) if entry.operation == "scale" else []
    try:
        for index, node in enumerate(nodes):
            draws.note(node)
            if step.sample:
                draw = draws.write(node, index)  # elements of a body or part share draws
                shared = (draw.element, draw.attribute, draw.value)
                drawn.setdefault(shared if entry.per in ("body", "part") else index, draw)
                continue
            draws.check(node, range(1, step.samples + 1))
            if step.tabled:
                tabled.append(draws.tabled(node))
    except UnusableValue:
        return [], []
    for key in zeros:
        help = "draw the value itself, or write `offset`, which adds the draw"
        report_only_zeros(editing, nodes, key, at=entry.drawn_at, help=help)
    return list(drawn.values()), tabled


class _FieldDraws(Struct, frozen=False):
    step: DrawValues
    editing: Editing
    masses: Masses
    numbers: dict[tuple[Node, str], dict[Node, int]] = field(default_factory=dict)

    def note(self, node: Node) -> None:
        """Record the draw of an attribute, which may have no effect, with the range of its first number."""
        entry = self.step.field
        name, subscript = attribute_and_index(entry.attr)
        if name not in kind_of(node).attributes:
            return
        at = (*entry.at, "attr")
        before = self.editing.effective(node, name)
        span = self.editing.span(at)
        ends = [each for each in entry.distribution.extremes(0) if math.isfinite(each)]
        start = subscript or 0
        now = numbers.read(before)[start : start + 1] if before and kind_of(node).attributes[name].is_number else []
        if entry.operation != "set" and now:
            ends = [each * now[0] if entry.operation == "scale" else each + now[0] for each in ends]
        low, high = (min(ends), max(ends)) if ends else (-math.inf, math.inf)
        value = RecipeValue(name, span, "draw", before, start=start, low=low, high=high)
        self.editing.note_value(node, name, at, value)

    def write(self, node: Node, index: int) -> Drawn:
        """Write the sample's draw onto an element, and return it as in the manifest."""
        step = self.step
        entry = self.step.field
        self.check(node, (step.sample,))
        drawn = self._drawn(node, step.sample)
        at = (*entry.at, "attr")
        written = self._with_unit(node, drawn)
        self.editing.linking.notes.drawn.setdefault(node, {})[entry.name] = written
        ValueChange(self.editing, OPERATIONS[entry.operation], self.masses).carry_out(
            node, index, {entry.attr: written}, at=at
        )
        return self._stated(node, drawn)

    def _with_unit(self, node: Node, drawn: Any) -> Any:
        """Return the draw as a recipe would write it, with a unit on angles."""
        entry = self.step.field
        unit: str | None = entry.distribution.unit
        items = drawn if isinstance(drawn, list) else [drawn]
        turned = [True] * len(items)
        if unit is None and entry.operation != "scale":
            unit = {"degree": "deg", "radian": "rad"}.get(self._angle_settings.angle or "")
            turned = self._angles(node)
        written = [
            f"{each!r}{unit}" if unit and is_angle and isinstance(each, int | float) else each
            for each, is_angle in zip_longest(items, turned[: len(items)])
        ]
        return written if isinstance(drawn, list) else written[0]

    def tabled(self, node: Node) -> ElementDraws:
        step = self.step
        first = self._stated(node, self._drawn(node, 1))
        angles = tuple(self._angles(node)) if step.field.operation != "scale" else ()
        kind = kind_of(node)
        return ElementDraws(
            first,
            step.field,
            name_of(node),
            place=_place_in_body(node),
            tag=kind.tag,
            family=kind.family or kind.tag,
            numbers=self._numbers(node, len(first.columns())),
            angles=angles,
            unit=self._angle_settings.angle,
        )

    def _numbers(self, node: Node, count: int) -> tuple[Sequence[Value], ...]:
        """Return the draws of all samples for each number of an attribute, in the units of the manifest."""
        samples = range(1, self.step.samples + 1)
        distribution = self.step.field.distribution
        if distribution.is_whole:
            stated = {id(each): self._in_radians(node, each) for each in distribution.values}
            lengths = {len(each) if isinstance(each, tuple) else 1 for each in stated.values()}
            if len(lengths) > 1:
                counts = " and ".join(map(str, sorted(lengths)))
                message = f"the values have {counts} numbers, and in a table all have the same count"
                help = "build without `--as worlds`, so each sample is a model"
                self._fault("wrong-length", message, node, help=help)
            chosen = [stated[id(each)] for each in self._all_drawn(node, samples, 0)]
            return tuple(zip(*chosen, strict=True)) if isinstance(chosen[0], tuple) else (chosen,)
        angles = self._angles(node)
        return tuple(
            self._all_in_radians(node, self._all_drawn(node, samples, place), any(angles[place : place + 1]))
            for place in range(count)
        )

    def _stated(self, node: Node, drawn: Any) -> Drawn:
        entry = self.step.field
        name, subscript = attribute_and_index(entry.attr)
        return Drawn(
            entry.name,
            self.drawn_by(node),
            name,
            operation=entry.operation,
            value=self._in_radians(node, drawn),
            shared=entry.per == "sample",
            start=subscript or 0,
            column=entry.column,
        )

    def drawn_by(self, node: Node) -> str:
        """Return the identity on which the draws of an element depend: of the element, its body or its part."""
        if (per := self.step.field.per) == "part":
            return self.editing.parts.get(node, BASE)
        if per == "body" and node.tag != "body":
            body = next(node.iterancestors("body"), None)
            return "world" if body is None else self.identity(body)
        return self.identity(node)

    def identity(self, node: Node) -> str:
        """Return the name of an element, or the identity of its parent and its number among the unnamed ones there."""
        if name := name_of(node):
            return name
        # The place in the model does not count: an element that is added elsewhere must not change the draws.
        if (parent := parent_of(node)) is None:
            return str(node.tag)
        place = parent, str(node.tag)
        if place not in self.numbers:
            self.numbers[place] = numbered(*place)
        number = self.numbers[place][node]
        return f"{self.identity(parent) if parent.tag != 'worldbody' else 'world'} {node.tag}#{number}"

    @property
    def _angle_settings(self) -> AngleSettings:
        return self.editing.making.angle_context.at(self.step.field.drawn_at)

    def _values(self, node: Node) -> EntryValues:
        return EntryValues(self.editing, node, 0, at=self.step.field.drawn_at)

    def _drawn(self, node: Node, sample: int) -> Any:
        """Return the draw in the recipe's unit: a number, a list with a number for each component, or the choice."""
        entry = self.step.field
        _, subscript = attribute_and_index(entry.attr)
        count = None if entry.distribution.is_whole or subscript is not None else self._count(node)
        draws: list[Any] = []
        for place in range(1 if count is None else count):
            draws += self._all_drawn(node, (sample,), place)
        return draws[0] if count is None else draws

    def _all_drawn(self, node: Node, samples: Sequence[int], place: int) -> Sequence[Any]:
        """Return the number at one place of the draw, for each of the samples."""
        entry = self.step.field
        component, of = self._component(place)
        return entry.distribution.draw_all(
            self.step.seed, samples, entry.stream, element=self._stream(node), component=component, of=of
        )

    def _stream(self, node: Node) -> str:
        return "" if self.step.field.per == "sample" else self.drawn_by(node)

    def _component(self, place: int) -> tuple[int, int]:
        """Return the component to which the random bits and the parameters of the number at a place belong."""
        _, subscript = attribute_and_index(self.step.field.attr)
        if subscript is None:
            return place, place
        # Fields of a group share their draws, even if they are about different numbers of their attributes.
        return (subscript if self.step.field.group is None else 0), 0

    def _count(self, node: Node) -> int | None:
        """Return the number of components of the attribute, or None for a single number."""
        entry = self.step.field
        kind = kind_of(node)
        attribute = kind.attributes.get(entry.attr)
        if attribute is None or not attribute.is_number or attribute.max_length == 1:
            return None  # an unknown attribute is reported where it is written
        now = self._values(node).now(attribute)
        wanted = entry.distribution.components
        have = len(now) if isinstance(now, tuple) else None
        if now is None:
            have = wanted or (attribute.max_length if attribute.max_length == attribute.min_length else None)
        if have is None and now is None:
            message = f"{self.editing.called(node)} has no `{entry.attr}`, so the number of draws is unknown"
            help = f'draw one number, `attr: "{entry.attr}[0]"`, or write a list of bounds'
            self._fault("wrong-length", message, node, help=help)
        if wanted is not None and wanted != have:
            numbers = "1 number" if have is None else f"{have} numbers"
            expected = f"`{entry.distribution.kind}` {wanted}"
            message = f"`{entry.attr}` of {self.editing.called(node)} has {numbers}, {expected}"
            self._fault("wrong-length", message, node)
        return have

    def check(self, node: Node, samples: Sequence[int]) -> None:
        """Report the first sample whose draw makes a number that has no meaning. Raises `UnusableValue`."""
        entry = self.step.field
        name, subscript = attribute_and_index(entry.attr)
        kind = kind_of(node)
        attribute = kind.attributes.get(name)
        is_mass = kind.path == "body" and name == MASS
        self._check_unit(node)
        now = self._values(node).now(attribute, subscript) if attribute is not None and not is_mass else None
        if attribute is not None and now is None and entry.operation != "set" and not is_mass:
            message = f"{self.editing.called(node)} has no `{entry.attr}` that `{entry.operation}` could start from"
            self._fault("wrong-type", message, node)
        distribution = entry.distribution
        if distribution.is_whole or (not is_mass and (attribute is None or not attribute.is_number)):
            return
        count = None if is_mass or subscript is not None else self._count(node)
        bases = now if isinstance(now, tuple) else (now,)
        for component in range(count or 1):
            if self._may_be_refused(name, component, subscript):
                base = self.masses.of(node, entry.drawn_at) if is_mass else bases[component]
                self._check_numbers(node, samples, component, base=base)

    def _may_be_refused(self, name: str, component: int, subscript: int | None) -> bool:
        """Return whether a draw may make a number negative that must not be."""
        if not must_not_be_negative(name, component if subscript is None else subscript):
            return False
        entry = self.step.field
        return entry.operation == "offset" or min(entry.distribution.extremes(component), default=0.0) < 0

    def _check_numbers(self, node: Node, samples: Sequence[int], component: int, base: Any) -> None:
        entry = self.step.field
        for sample, one in zip(samples, self._all_drawn(node, samples, component), strict=True):
            number = one if entry.operation == "set" else one * base if entry.operation == "scale" else one + base
            # MuJoCo 4.0 refuses a negative mass or size, but takes a negative damping, armature, stiffness or friction
            # silently.
            if number < 0:
                called = self.editing.called(node)
                message = f"sample {sample} of field `{entry.name}` gives {called} the {entry.attr} {number:.6g}"
                help = "draw from a distribution with bounds: `truncnormal: {mean: …, std: …, min: 0, max: …}`"
                self._fault("out-of-range", message, node, help=help)

    def _check_unit(self, node: Node) -> None:
        entry = self.step.field
        distribution = entry.distribution
        if entry.operation != "scale" and (angle := self._first_angle) is not None and not self._takes_angles(node):
            fault = no_angle(f"`{entry.attr}` of {self.editing.called(node)}", angle, ())
            self._fault(fault.code, fault.message, node, help=fault.help)
        if entry.operation == "scale" or distribution.unit is not None or self._angle_settings.angle is not None:
            return
        if not any(self._angles(node)) or distribution.is_whole:
            return
        numbers = [each for items in distribution.parameters.values() for each in items]
        drawn = distribution.values if distribution.kind == CHOICE else numbers
        if any(not isinstance(each, str) and each != 0 for each in drawn):
            called = self.editing.called(node)
            kind = distribution.kind
            message = f"`{entry.attr}` of {called} is an angle, and `{kind}` has no unit"
            help = "write the unit after the numbers (`5deg`, `0.1rad`), or `angle: degree` at the top of the recipe"
            self._fault("bare-angle", message, node, help=help)

    @property
    def _first_angle(self) -> Angle | None:
        """The first angle with a unit that the distribution has."""
        distribution = self.step.field.distribution
        if distribution.kind == CHOICE:
            chosen = (each for value in distribution.values for each in (value if isinstance(value, list) else [value]))
            return next(filter(None, (Angle.read(each) for each in chosen if isinstance(each, str))), None)
        if distribution.unit is None:
            return None
        numbers = [each for items in distribution.parameters.values() for each in items]
        return Angle(next((each for each in numbers if each), 0.0), distribution.unit)

    def _takes_angles(self, node: Node) -> bool:
        """Return whether the attribute of an element is an angle, or may be one by its joint or tendon."""
        name, _ = attribute_and_index(self.step.field.attr)
        attribute = kind_of(node).attributes.get(name)
        if attribute is None or not attribute.is_number:
            return True  # an unknown attribute, or a text, is reported where it is written
        if attribute.angle is not None:
            return any(self._angles(node))
        return may_be_angle(str(node.tag), attribute) and why_a_length(node, self.editing.linking) is None

    def _angles(self, node: Node) -> list[bool]:
        name, subscript = attribute_and_index(self.step.field.attr)
        if (attribute := kind_of(node).attributes.get(name)) is None or attribute.angle is None:
            return []
        count = max(attribute.max_length or 4, 1 + (subscript or 0))
        angles = set(self._values(node).angles(attribute, count))
        return [n in angles for n in (range(count) if subscript is None else (subscript,))]

    def _in_radians(self, node: Node, drawn: Any) -> Value:
        """Return the draw as in the manifest: angles are in radians, unless MuJoCo stores them in degrees."""
        if not isinstance(drawn, list):
            return self._one_in_radians(node, drawn, any(self._angles(node)[:1]))
        turned = [*self._angles(node), *[False] * len(drawn)]
        return tuple(self._one_in_radians(node, each, turned[n]) for n, each in enumerate(drawn))

    def _one_in_radians(self, node: Node, drawn: Value, is_angle: bool) -> Value:
        unit, own = self._units(node, is_angle)
        if isinstance(drawn, str):
            angle = Angle.read(drawn)
            return drawn if angle is None else angle.in_unit(own)
        if unit is None or not isinstance(drawn, int | float):
            return drawn
        return Angle(drawn, unit).in_unit(own)

    def _all_in_radians(self, node: Node, drawn: Sequence[Any], is_angle: bool) -> Sequence[Value]:
        unit, own = self._units(node, is_angle)
        if unit is None or unit == own:
            return drawn
        return array("d", (Angle(each, unit).in_unit(own) for each in drawn))

    def _units(self, node: Node, is_angle: bool) -> tuple[Literal["deg", "rad"] | None, Literal["deg", "rad"]]:
        """Return the unit of a drawn number, None if it has none, and the unit of the same number in the manifest."""
        entry = self.step.field
        if (unit := entry.distribution.unit) is None and is_angle and entry.operation != "scale":
            unit = "deg" if self._angle_settings.angle == "degree" else "rad"
        name, _ = attribute_and_index(entry.attr)
        return unit, "deg" if is_in_degrees(str(node.tag), name) else "rad"

    def _fault(self, code: str, message: str, node: Node, help: str | None = None) -> None:
        editing = self.editing
        notes = (Note(f"{editing.called(node)} is written here", editing.span_of(node)),)
        span = editing.span(self.step.field.drawn_at)
        subjects = editing.subjects(node)
        editing.sink.error(code, message, span, notes=notes, help=help, subjects=subjects)
        raise UnusableValue


def _place_in_body(node: Node) -> tuple[str, int, int] | None:
    """Return the name of an element's body, its index within its tag there, and their number; None outside."""
    if (body := parent_of(node)) is None or body.tag not in ("body", "worldbody"):
        return None
    name = "world" if body.tag == "worldbody" else name_of(body)
    if name is None:
        return None
    tags = ("joint", "freejoint") if node.tag in ("joint", "freejoint") else (str(node.tag),)
    alike = [each for each in body.iterdescendants(*tags) if parent_of(each) is body]
    return name, alike.index(node), len(alike)
