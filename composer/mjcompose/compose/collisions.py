"""Step: select by part the bodies that must not collide, and the geoms that may collide."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from itertools import product
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.compose.elements import ElementBuilder
from mjcompose.compose.load import FINISHED, keep_finished
from mjcompose.language.contact import BETWEEN
from mjcompose.link import numbers
from mjcompose.link.expansion import names_of_copies
from mjcompose.link.linking import Linking
from mjcompose.mujoco import engine
from mjcompose.plan.plan import PlacedModel, Plan
from mjcompose.plan.steps import SetCollisions
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.classes import childclass_of, own
from mjcompose.tree.pattern import fitter

_MOST = 20_000
_COLLIDING = ("contype", "conaffinity")


class Exclusions(Struct):
    """The excludes that MuJoCo finds, each with the reason, and the number of pairs that were not searched."""

    written: tuple[tuple[Node, str], ...] = ()
    unsearched: int = 0

    def __add__(self, other: Exclusions) -> Exclusions:
        return Exclusions(self.written + other.written, self.unsearched + other.unsearched)


def set_collisions(
    plan: Plan,
    linking: Linking,
    making: ElementBuilder,
    context: Context,
    session: engine.Session | None,
    samples: bool = True,
) -> Exclusions:
    """Write the recipe's excludes and pairs in order. Return the excludes that MuJoCo finds."""
    writer = _CollisionWriter(plan, linking, making, context=context, session=session)
    excluded = Exclusions()
    for step in plan.steps:
        if isinstance(step, SetCollisions) and (samples or step.collisions.samples is None):
            excluded += writer.write(step)
    return excluded


class _CollisionWriter(Struct):
    plan: Plan
    linking: Linking
    making: ElementBuilder
    context: Context
    session: engine.Session | None

    def write(self, step: SetCollisions) -> Exclusions:
        """Write the elements of a step, and return the excludes that MuJoCo finds."""
        if step.collisions.samples is not None:
            return self._exclude_needless(step)
        if not step.collisions.sides:
            from mjcompose.mujoco.collision_exclusions import touching  # imports numpy

            prefixes = sorted({part.prefix for part in self.plan.parts if part.prefix})
            pairs = self._named_pairs(step, self._call(step, touching, prefixes) or (), verb="touch")
            return Exclusions(self._exclude(step, {tuple(pair["bodies"]): "" for pair in pairs}))
        sides = [self._bodies(step, index) for index in range(2)]
        if step.collisions.what == "exclude":
            names = [[name for body in side for name in _names(body)] for side in sides]
            self._exclude(step, {pair: "" for pair in product(*names) if pair[0] != pair[1]})
        else:
            self._write_pairs(step, sides)
        return Exclusions()

    def _exclude_needless(self, step: SetCollisions) -> Exclusions:
        from mjcompose.mujoco.collision_exclusions import ADJACENT, NEVER, TOUCHING, needless  # imports numpy

        samples = step.collisions.samples
        seed = step.collisions.seed
        words = {
            ADJACENT: "a joint connects them",
            TOUCHING: "they touch in {}",
            NEVER: f"they touched in none of {samples} random poses (seed {seed})",
        }
        answer = self._call(step, needless, {"samples": samples, "seed": seed})
        if answer is None:
            return Exclusions()
        pairs = self._named_pairs(step, answer["pairs"], verb="need not collide")
        reasons = {tuple(pair["bodies"]): words[pair["why"]].format(pair["where"]) for pair in pairs}
        return Exclusions(self._exclude(step, reasons), answer["unsearched"])

    def _call(self, step: SetCollisions, function: Callable[..., Any], argument: Any) -> Any:
        """Return the answer of a function that has the whole model, or None after reporting why there is none."""
        with nullcontext(self.session) if self.session else engine.Session() as own:
            if not keep_finished(self.linking.flat(), self.context, own):
                return None
            answer = engine.call(own, function, [FINISHED], argument=argument)
        if not answer.ok:
            self.making.sink.error("mujoco-crash", f"MuJoCo fails on the contacts: {answer.error}", step.span)
            return None
        return answer.value

    def _named_pairs(
        self, step: SetCollisions, pairs: Iterable[Mapping[str, Any]], verb: str
    ) -> list[Mapping[str, Any]]:
        """Return the pairs of bodies that have names, and report the others."""
        pairs = list(pairs)
        if nameless := [pair for pair in pairs if not all(pair["bodies"])]:
            one, other = nameless[0]["called"]
            where = nameless[0]["where"]
            more = f" ({len(nameless) - 1} more such pairs)" if len(nameless) > 1 else ""
            reason = f"{more}, and a body without a name cannot be excluded"
            message = f"{one} and {other} {verb}{where and f' in {where}'}{reason}"
            edit = '`edit: [{select: {body: "**", where: {name: ""}}, rename: "b${index}"}]`'
            self.making.sink.error("bad-name", message, step.span, help=f"give it a name: {edit} in the part")
        return [pair for pair in pairs if all(pair["bodies"])]

    def _bodies(self, step: SetCollisions, index: int) -> list[Node]:
        places = {place.part: place for place in self.plan.walk() if place.part}
        worlds = self.linking.base.root.iterchildren("worldbody")
        all_bodies = [body for world in worlds for body in (world, *world.iter("body"))]
        names = [_name(body) for body in all_bodies]
        bodies: dict[Node, None] = {}
        for at, name in enumerate(step.collisions.sides[index]):
            if name in places:
                fitting = {each for each in names if _is_of(each, places[name])}
            else:
                fitting = set(filter(fitter(name, lambda: names, self.plan.separator), names))
            if not fitting:
                path = (*step.collisions.at, BETWEEN, index, *([at] if len(step.collisions.sides[index]) > 1 else []))
                message = f"`{name}` is not a part, and names no body"
                notes = (exists_note("part", list(places), name), exists_note("body", names[1:], name))
                span = locate(self.making.document, path)
                help = did_you_mean(name, [*places, *names[1:]])
                self.making.sink.error("unknown-name", message, span, notes=notes, help=help, subjects=(name,))
            bodies.update(dict.fromkeys(body for body in all_bodies if _name(body) in fitting))
        return [body for body in bodies if next(self._geoms(body), None) is not None]

    def _geoms(self, body: Node) -> Iterator[Node]:
        classes = self.linking.base.classes
        for geom in own(body, "geom"):
            # The `contype` of one geom and the `conaffinity` of the other are enough for a contact.
            values = [classes.effective(geom, childclass_of(geom), name) for name in _COLLIDING]
            if any(value is None or numbers.integer(value) != 0 for value in values):
                yield geom

    def _write_pairs(self, step: SetCollisions, sides: Sequence[Sequence[Node]]) -> None:
        # A pair collides in any case: in MuJoCo 4.0 even if `contype` and `conaffinity` are 0, and if an `<exclude>`
        # names the bodies.
        named: list[tuple[str, str]] = []
        sink = self.making.sink
        for one, other in product(*sides):
            if one is not other:
                for first, second in product(self._geoms(one), self._geoms(other)):
                    if not first.get("name") or not second.get("name"):
                        name = _name(one if not first.get("name") else other)
                        message = f"a geom of the body `{name}` has no name, and pairs of geoms need names"
                        edit = '`edit: [{select: {geom: "**", where: {name: ""}}, rename: "${parent}_g${index}"}]`'
                        help = f"give it a name: {edit} in the part"
                        sink.error("bad-name", message, step.span, help=help, subjects=(name,))
                        return
                    named += product(names_of_copies(first), names_of_copies(second))
        if len(named) > _MOST:
            message = f"these are {len(named)} pairs of geoms, and MuJoCo checks each of them"
            help = "name fewer bodies, or set `contype` and `conaffinity` by `edit`"
            sink.error("out-of-range", message, step.span, help=help)
            return
        self._append(step, "pair", ("geom1", "geom2"), pairs=named)

    def _exclude(self, step: SetCollisions, reasons: Mapping[tuple[str, ...], str]) -> tuple[tuple[Node, str], ...]:
        written = self._append(step, "exclude", ("body1", "body2"), pairs=reasons)
        return tuple((node, reasons[str(node.get("body1")), str(node.get("body2"))]) for node in written)

    def _append(
        self, step: SetCollisions, tag: str, keys: tuple[str, str], pairs: Iterable[tuple[str, ...]]
    ) -> list[Node]:
        """Write the elements that do not exist yet, and return them."""
        base = self.linking.base
        written = []
        # The order of the two does not matter, and MuJoCo 4.0 counts the same pair twice.
        known = {frozenset((each.get(keys[0]), each.get(keys[1]))) for each in base.root.iterfind(f"contact/{tag}")}
        for pair in pairs:
            if frozenset(pair) in known or not all(pair):
                continue
            known.add(frozenset(pair))
            section = base.section("contact")
            node = section.makeelement(tag, dict(zip(keys, pair, strict=True)))
            journal.place(section, node)
            self.making.origins.own(node, step.span)
            written.append(node)
        self.linking.watch(self.linking.units, step)
        return written


def _is_of(name: str, placed: PlacedModel) -> bool:
    """Return whether a body belongs to a part. The world belongs to the base."""
    is_below = bool(name) and name.startswith(placed.prefix) and not name.startswith(tuple(placed.others))
    return not placed.prefix if name == "world" else is_below


def _name(body: Node) -> str:
    return "world" if body.tag == "worldbody" else str(body.get("name") or "")


def _names(body: Node) -> list[str]:
    """Return the names of a body in the compiled model: several if it is in a `<replicate>`."""
    return ["world"] if body.tag == "worldbody" else names_of_copies(body)
