"""Frictions that the recipe draws or sets, and the contacts in which they have no effect.

MuJoCo 4.0 uses the parameters of the geom with the higher `priority` in a contact; if the priorities are equal, it uses
the larger friction and the larger `condim`. The second number of `friction` needs contacts with a `condim` of 4,
and the third with 6.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import field

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.words import element_text
from mjcompose.compose.effects import CODE
from mjcompose.link import numbers
from mjcompose.mujoco import engine
from mjcompose.mujoco.frictions import LEAST_CONDIM, thresholds
from mjcompose.tree.classes import own
from mjcompose.tree.select import name_of, section_of
from mjcompose.tree.unit import RecipeValue, Unit
from mjcompose.verify.compile import WHOLE

_FRICTION = "friction"
_SHOWN = 3
_MOST = 50
"""The number of geoms of a draw that are compared. An edit of more geoms is not compared: it rarely affects none."""
_NOTE = "of two geoms in contact, MuJoCo uses the friction of the higher `priority`, or else the larger friction"


class Threshold(Struct):
    """The values of a geom's friction that act on contacts with a partner: those above `least`, which may be inf."""

    partner: str
    least: float
    priority: int
    needs_condim: bool = False


def check_frictions(model: Unit, session: engine.Session, sink: Sink) -> None:
    """Warn about draws that have no effect on some contacts, and about edits that have none on any contact."""
    entries = _entries(model)
    if not entries:
        return
    places = _Places()
    drawn = [places.of(geom) for values in entries.values() for geom, value in values if value.way == "draw"]
    entries = {
        span: values[:_MOST] for span, values in entries.items() if len(values) <= _MOST or values[0][1].way == "draw"
    }
    numbers = [
        [{"place": places.of(geom), "number": value.start} for geom, value in values] for values in entries.values()
    ]
    question = {"entries": numbers, "drawn": drawn}
    answer = engine.call(session, thresholds, [WHOLE], argument=question)
    if not answer.ok:
        return
    for (span, values), per_geom in zip(entries.items(), answer.value, strict=True):
        partners = [[Threshold(**partner) for partner in row] for row in per_geom]
        if values[0][1].way == "draw":
            _check_draw(values, partners, span, sink)
        else:
            _check_edit(values, partners, span, sink)


def _entries(model: Unit) -> dict[Span, list[tuple[Node, RecipeValue]]]:
    """Return the frictions that the recipe sets or draws, with their geoms, by the place in the recipe."""
    entries: dict[Span, list[tuple[Node, RecipeValue]]] = {}
    for node, values in model.origins.values.items():
        # The origins also know elements that were removed.
        if node.getroottree().getroot() is model.root and node.tag == "geom" and section_of(node) != "default":
            for value in values:
                if value.attribute == _FRICTION and value.way != "add":
                    entries.setdefault(value.span, []).append((node, value))
    return entries


class _Places(Struct):
    """Finds geoms in the compiled model: by name, or by body and number there."""

    numbers: dict[Node, dict[Node, int]] = field(default_factory=dict)

    def of(self, geom: Node) -> tuple[str, str, int]:
        """Return the name of a geom, the name of its body, and its number there."""
        body = next(geom.iterancestors("body", "worldbody"))
        if body not in self.numbers:
            self.numbers[body] = {each: at for at, each in enumerate(own(body, "geom"))}
        called = "world" if body.tag == "worldbody" else str(name_of(body) or "")
        return str(name_of(geom) or ""), called, self.numbers[body][geom]


def _check_draw(
    found: Sequence[tuple[Node, RecipeValue]], partners: Sequence[list[Threshold]], span: Span, sink: Sink
) -> None:
    value = found[0][1]
    dead: dict[tuple[float, bool], dict[str, None]] = {}
    for (_, each), thresholds_of_geom in zip(found, partners, strict=True):
        for threshold in thresholds_of_geom:
            if each.low < threshold.least and math.isfinite(each.low):
                dead.setdefault((threshold.least, threshold.needs_condim), {})[threshold.partner] = None
    if not dead:
        return
    called = f"`friction[{value.start}]`"
    parts = [_phrase(least, needs, list(who), value) for (least, needs), who in sorted(dead.items())]
    ends = f"from {value.low:.6g} to {value.high:.6g}"
    message = f"the draw of {called} {ends} does not act everywhere: {'; '.join(parts)}"
    highest = max((each.priority for row in partners for each in row), default=0)
    sink.warning(CODE, message, span, notes=[Note(_NOTE)], help=_help(value, highest, dead))


def _phrase(least: float, needs_condim: bool, partners: list[str], value: RecipeValue) -> str:
    listed = ", ".join(partners[:_SHOWN]) + (f" and {len(partners) - _SHOWN} more" if len(partners) > _SHOWN else "")
    if needs_condim:
        return f"it has no effect on contacts with {listed}, whose `condim` is less than {LEAST_CONDIM[value.start]}"
    if math.isinf(least) or least >= value.high:
        return f"it has no effect on contacts with {listed}"
    return f"below {least:.6g} it has no effect on contacts with {listed}"


def _help(value: RecipeValue, highest: int, dead: Iterable[tuple[float, bool]]) -> str:
    if any(needs for _, needs in dead):
        return f"write `condim: {LEAST_CONDIM[value.start]}` on the drawn geoms"
    edit = f"`edit: [{{select: …, set: {{priority: {highest + 1}}}}}]`"
    return f"let their own friction count, by a higher priority: {edit}; or draw larger numbers"


def _check_edit(
    found: Sequence[tuple[Node, RecipeValue]], partners: Sequence[list[Threshold]], span: Span, sink: Sink
) -> None:
    touched = [(node, value, row) for (node, value), row in zip(found, partners, strict=True) if row]
    if not touched or len(touched) < len(found):
        return
    for node, value, row in touched:
        now = numbers.read(str(node.get(_FRICTION) or "0"))
        before = numbers.read(value.before or "0")
        changed = [at for at in range(len(now)) if at >= len(before) or now[at] != before[at]]
        if changed != [0] or any(max(now[0], before[0]) > each.least for each in row):
            return
    partner = touched[0][2][0]
    name = name_of(touched[0][0])
    called = element_text("geom", name)
    message = f"`friction` of {called} has no effect on any contact, such as with {partner.partner}"
    help = f"write `priority: {max(each.priority for each in touched[0][2]) + 1}` next to it"
    sink.warning(CODE, message, span, notes=[Note(_NOTE)], help=help)
