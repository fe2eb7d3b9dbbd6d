"""Step: select by part the bodies that must not collide, and the geoms that must."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import product
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.build.compose.elements import ElementBuilder
from mjcompose.build.compose.load import FINISHED, keep_finished
from mjcompose.build.plan.plan import PlacedModel, Plan
from mjcompose.build.plan.steps import SetCollisions
from mjcompose.language.select import BETWEEN
from mjcompose.link.key_layout import names_of_copies
from mjcompose.link.linking import Linking
from mjcompose.model.classes import childclass_of, own
from mjcompose.model.pattern import fitter
from mjcompose.mujoco import engine
from mjcompose.mujoco.facts import touching
from mjcompose.sources.context import Context
from mjcompose.text.node import locate

_MOST = 20_000
_COLLIDING = ("contype", "conaffinity")


def set_collisions(
    plan: Plan,
    linking: Linking,
    making: ElementBuilder,
    context: Context,
    session: engine.Session | None,
    samples: bool = True,
) -> list[tuple[Node, str]]:
    """Write the excludes and pairs that the recipe describes by its parts, in the order of the file.

    Return the excludes that were found, each with the reason; "" for bodies that touch.
    """
    found: list[tuple[Node, str]] = []
    steps = [step for step in plan.steps if isinstance(step, SetCollisions)]
    for step in steps:
        if step.collisions.samples is not None:
            if samples:
                found += _exclude_needless(step, linking, making, context=context, session=session)
            continue
        if not step.collisions.sides:
            found += _exclude_touching(step, plan, linking, making=making, context=context, session=session)
            continue
        sides = [_bodies(step, index, plan, linking=linking, making=making) for index in range(2)]
        if step.collisions.what == "exclude":
            named = [
                (first, second)
                for one in sides[0]
                for other in sides[1]
                for first in _names(one)
                for second in _names(other)
                if first != second
            ]
            _append(linking, making, step, tag="exclude", keys=("body1", "body2"), pairs=named)
        else:
            _write_collisions(step, sides, linking, making=making)
    return found


def _exclude_needless(
    step: SetCollisions, linking: Linking, making: ElementBuilder, context: Context,
    session: engine.Session | None,
) -> list[tuple[Node, str]]:  # fmt: skip
    from mjcompose.mujoco.collision_exclusions import ADJACENT, NEVER, TOUCHING, needless  # imports numpy

    samples, seed = step.collisions.samples, step.collisions.seed
    with ExitStack() as stack:
        session = session or stack.enter_context(engine.Session())
        if not keep_finished(linking, context, session):
            return []
        answer = engine.call(session, needless, [FINISHED], argument={"samples": samples, "seed": seed})
    if not answer.ok:
        making.sink.error("mujoco-crash", f"MuJoCo stumbles over the contacts: {answer.error}", step.span)
        return []
    words = {
        ADJACENT: "a joint connects them",
        TOUCHING: "they touch in {}",
        NEVER: f"they touched in none of {samples} random poses (seed {seed})",
    }
    _refuse_nameless(answer.value, "need not collide", step, making=making)
    reasons = {
        tuple(each["bodies"]): words[each["why"]].format(each["where"]) for each in answer.value if all(each["bodies"])
    }
    written = _append(linking, making, step, tag="exclude", keys=("body1", "body2"), pairs=list(reasons))
    return [(node, reasons[str(node.get("body1")), str(node.get("body2"))]) for node in written]


def _refuse_nameless(
    pairs: Sequence[Mapping[str, Any]], what: str, step: SetCollisions, making: ElementBuilder
) -> None:
    nameless = [pair for pair in pairs if not all(pair["bodies"])]
    if not nameless:
        return
    (one, other), where = nameless[0]["called"], nameless[0]["where"]
    more = f" ({len(nameless) - 1} more such pairs)" if len(nameless) > 1 else ""
    message = f"{one} and {other} {what}{where and f' in {where}'}{more}, and a body without a name cannot be excluded"
    help = 'give it a name: `edit: [{select: {body: "**", where: {name: ""}}, rename: "b${index}"}]` in the part'
    making.sink.error("bad-name", message, step.span, help=help)


def _exclude_touching(
    step: SetCollisions, plan: Plan, linking: Linking, making: ElementBuilder, context: Context,
    session: engine.Session | None,
) -> list[tuple[Node, str]]:  # fmt: skip
    with ExitStack() as stack:
        session = session or stack.enter_context(engine.Session())
        if not keep_finished(linking, context, session):
            return []
        prefixes = sorted({part.prefix for part in plan.parts if part.prefix})
        answer = engine.call(session, touching, [FINISHED], argument=prefixes)
    if not answer.ok:
        making.sink.error("mujoco-crash", f"MuJoCo stumbles over the contacts: {answer.error}", step.span)
        return []
    _refuse_nameless(answer.value, "touch", step, making=making)
    named = [tuple(pair["bodies"]) for pair in answer.value if all(pair["bodies"])]
    return [(each, "") for each in _append(linking, making, step, tag="exclude", keys=("body1", "body2"), pairs=named)]


def _bodies(step: SetCollisions, index: int, plan: Plan, linking: Linking, making: ElementBuilder) -> list[Node]:
    """Return the bodies on one side that have geoms which can collide."""
    places = {place.part: place for place in plan.walk() if place.part}
    everything = [
        body for world in linking.base.root.iterchildren("worldbody") for body in (world, *world.iter("body"))
    ]
    names = [_name(body) for body in everything]
    found: list[Node] = []
    for at, name in enumerate(step.collisions.sides[index]):
        place = places.get(name)
        if place is not None:
            fitting = {each for each in names if _is_of(each, place)}
        else:
            fitting = set(filter(fitter(name, lambda: names, plan.separator), names))
        if not fitting:
            path = (*step.collisions.at, BETWEEN, index)
            known = [*places, *names[1:]]
            span = locate(making.document, path)
            inner = locate(making.document, (*path, at))
            message = f"`{name}` is not a part, and names no body"
            span = inner if len(step.collisions.sides[index]) > 1 else span
            notes = (exists_note("part", list(places), name), exists_note("body", names[1:], name))
            help = did_you_mean(name, known)
            making.sink.error("unknown-name", message, span, notes=notes, help=help, subjects=(name,))
        found += [body for body in everything if _name(body) in fitting and body not in found]
    return [body for body in found if any(_collides(geom, linking) for geom in own(body, "geom"))]


def _is_of(name: str, placed: PlacedModel) -> bool:
    """Return whether a body belongs to a part. The world belongs to the base."""
    if name == "world":
        return not placed.prefix
    return bool(name) and name.startswith(placed.prefix) and not name.startswith(tuple(placed.others))


def _collides(geom: Node, linking: Linking) -> bool:
    """Return whether a geom can touch anything."""
    classes = linking.base.classes
    # The `contype` of one geom and the `conaffinity` of the other are enough for a contact.
    values = [classes.effective(geom, childclass_of(geom), name) for name in _COLLIDING]
    return any(value is None or int(float(value)) != 0 for value in values)


def _write_collisions(
    step: SetCollisions, sides: Sequence[Sequence[Node]], linking: Linking, making: ElementBuilder
) -> None:
    # A pair collides whatever else is written: in MuJoCo 4.0 also if `contype` and `conaffinity` are 0, and where an
    # `<exclude>` names the bodies.
    named: list[tuple[str, str]] = []
    for one, other in ((one, other) for one in sides[0] for other in sides[1] if one is not other):
        for first in _geoms(one, linking):
            for second in _geoms(other, linking):
                if not first.get("name") or not second.get("name"):
                    body = one if not first.get("name") else other
                    making.sink.error(
                        "bad-name",
                        f"a geom of the body `{_name(body)}` has no name, and pairs of geoms go by names",
                        step.span,
                        help="give it a name: "
                        '`edit: [{select: {geom: "**", where: {name: ""}}, rename: "${parent}_g${index}"}]`'
                        " in the part",
                        subjects=(_name(body),),
                    )
                    return
                named += product(names_of_copies(first), names_of_copies(second))
    if len(named) > _MOST:
        message = f"these are {len(named)} pairs of geoms, of which MuJoCo checks each"
        help = "name fewer bodies, or set `contype` and `conaffinity` by `edit`"
        making.sink.error("out-of-range", message, step.span, help=help)
        return
    _append(linking, making, step, tag="pair", keys=("geom1", "geom2"), pairs=named)


def _geoms(body: Node, linking: Linking) -> Iterator[Node]:
    return (geom for geom in own(body, "geom") if _collides(geom, linking))


def _name(body: Node) -> str:
    return "world" if body.tag == "worldbody" else str(body.get("name") or "")


def _names(body: Node) -> list[str]:
    """Return the names of a body in the compiled model: several if it is in a `<replicate>`."""
    return ["world"] if body.tag == "worldbody" else names_of_copies(body)


def _append(
    linking: Linking, making: ElementBuilder, step: SetCollisions, tag: str, keys: tuple[str, str],
    pairs: Sequence[tuple[str, ...]],
) -> list[Node]:  # fmt: skip
    """Write the elements that do not exist yet, and return them."""
    written = []
    # Which of the two is named first does not matter, and MuJoCo 4.0 counts the same pair twice.
    known = {frozenset((each.get(keys[0]), each.get(keys[1]))) for each in linking.base.root.iterfind(f"contact/{tag}")}
    for pair in pairs:
        if frozenset(pair) in known or not all(pair):
            continue
        known.add(frozenset(pair))
        node = etree.SubElement(linking.base.section("contact"), tag, dict(zip(keys, pair, strict=True)))
        making.origins.own(node, step.span)
        written.append(node)
    linking.watch(linking.units, step)
    return written
