"""Render an outline as text."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

from composer.diagnostics.paint import Paint
from composer.document.quote import quoted, word
from composer.outline.outline import Body, Joint, Outline, Part, Place
from composer.plan.plan import BASE

_ORDER = ("site", "frame", "body")
_HEAD = ("to write", "", "pos in the world (m)", "quat in the world")
_NUMBER = re.compile(r"[-+.\d][-+.\deE_]*")


def render(outline: Outline, depth: int | None = None, color: bool = False) -> str:
    """Return parts, then bodies with their joints, down to `depth` levels; without a final line break."""
    paint = Paint(color)
    lines = [_head(outline, paint), *_parts(outline.parts, paint), paint("bold", "world")]
    lines += _below(outline.world, depth, paint)
    return "\n".join(lines)


def render_places(outline: Outline, depth: int | None = None, color: bool = False) -> str:
    """Return the places for attaching parts, one on a line, in recipe syntax; bodies down to `depth` levels."""
    paint = Paint(color)
    rows = [_HEAD]
    found = list(_places(outline.world, depth, 0))
    for kind in _ORDER:
        rows += [_place(body, place) for body, place in found if place.kind == kind]
    if len(rows) == 1:
        return f"{outline.label}: nothing with a name; a part without `site`, `body` and `frame` stands in the world"
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    head, *lines = (_row(row, widths) for row in rows)
    marked = (paint("bold", line[: widths[0]]) + line[widths[0] :] for line in lines)
    return "\n".join([paint("dim", head), *marked])


def _place(body: Body, place: Place) -> tuple[str, str, str, str]:
    inside = "" if place.kind == "body" else f"in {body.name or 'a body without a name'}"
    name = quoted(place.name) if _NUMBER.fullmatch(place.name) else word(place.name)
    turned = _numbers(place.world.quat)
    return f"{place.kind}: {name}", inside, _numbers(place.world.pos), "" if turned == "1 0 0 0" else turned


def _head(outline: Outline, paint: Paint) -> str:
    bodies, joints = len(outline.bodies), len(outline.joints)
    counts = [_count(bodies, "body", "bodies"), _count(joints, "joint", "joints")]
    if outline.parts:
        counts.append(_count(len(outline.parts), "part", "parts"))
    return f"{paint('bold', outline.name)}: {', '.join(counts)}"


def _parts(parts: Sequence[Part], paint: Paint) -> Iterator[str]:
    width = max((len(part.name) for part in parts), default=0)
    for part in parts:
        place = f", on {part.body}" if part.body else ""
        yield f"  {paint('help', f'{part.name:{width}}')}  {part.model}{paint('dim', place)}"


def _below(body: Body, depth: int | None, paint: Paint, edge: str = "") -> Iterator[str]:
    """Yield the contents of a body; if it has several joints, each on a line of its own."""
    for number, child in enumerate(body.children):
        last = number == len(body.children) - 1
        yield f"{paint('gutter', edge + ('└ ' if last else '├ '))}{_line(child, body, paint)}"
        inner = edge + ("  " if last else "│ ")
        if depth is not None and depth <= 1:
            if child.children:
                hidden = list(child.walk())[1:]
                joints = sum(len(each.joints) for each in hidden)
                summary = (
                    f"… {_count(len(hidden), 'body', 'bodies')}, {_count(joints, 'joint', 'joints')} below"
                )
                yield paint("dim", f"{inner}└ {summary}")
        else:
            yield from _below(child, None if depth is None else depth - 1, paint, edge=inner)


def _line(body: Body, parent: Body, paint: Paint) -> str:
    name = body.name or "(no name)"
    words = [paint("bold", name) if body.name else paint("dim", name)]
    if body.copies > 1 and body.copies != parent.copies:
        words.append(paint("dim", f"×{body.copies}"))
    if body.part != parent.part and body.part not in (None, BASE):
        words.append(paint("help", f"[{body.part}]"))
    if body.joints:
        words.append("  " + ", ".join(_joint(each, paint) for each in body.joints))
    return " ".join(words)


def _joint(joint: Joint, paint: Paint) -> str:
    name = f"{paint('code', joint.name)} " if joint.name else ""
    return f"{name}{joint.type}{paint('dim', _range(joint))}"


def _range(joint: Joint) -> str:
    if joint.range is None:
        return ""
    unit, values = "m", joint.range
    if joint.type != "slide":
        unit, values = "°", (math.degrees(joint.range[0]), math.degrees(joint.range[1]))
    low, high = (f"{round(each, 1 if unit == '°' else 4):g}" for each in values)
    space = "" if unit == "°" else " "
    return f" ±{high}{space}{unit}" if low == f"-{high}" else f" {low}…{high}{space}{unit}"


def _places(body: Body, depth: int | None, level: int) -> Iterator[tuple[Body, Place]]:
    for place in body.places:
        yield body, place
    if depth is None or level < depth:
        for child in body.children:
            yield from _places(child, depth, level + 1)


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{round(value, 4) + 0.0:g}" for value in values)


def _count(number: int, one: str, several: str) -> str:
    return f"{number} {one if number == 1 else several}"
