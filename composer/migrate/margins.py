"""`margin` and `gap` of what collides: MuJoCo 3.5 adds those of two geoms, and 3.9 counts the gap beyond the margin."""

from __future__ import annotations

from typing import TYPE_CHECKING

from composer.grammar.format import number_text
from composer.grammar.number import parse_real
from composer.migrate.editing import Editing, called
from composer.tree.classes import default_tag

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_GEOMS = ("body/geom", "default/geom")
_HAVE_BOTH = (*_GEOMS, "contact/pair", "default/pair", "body/flexcomp/contact", "deformable/flex/contact")


def _number(editing: Editing, node: Node, name: str) -> float:
    text = editing.value(node, name)
    found = None if text is None else parse_real(text.split()[0]) if text.split() else None
    return 0.0 if found is None else found


def gap_inside(editing: Editing) -> None:
    """From 3.9 on the force begins at the margin and not at the margin less the gap."""
    _shift(editing, -1.0)


def gap_outside(editing: Editing) -> None:
    """Before 3.9."""
    _shift(editing, 1.0)


def _shift(editing: Editing, sign: float) -> None:
    had = {
        node: (_number(editing, node, "margin"), _number(editing, node, "gap"))
        for node in editing.at(*_HAVE_BOTH)
    }
    of_classes = {default_tag(node) for node, (_, gap) in had.items() if gap and _is_of_class(node)}
    for node, (margin, gap) in had.items():
        writes = node.get("margin") is not None or node.get("gap") is not None
        if not writes or not (gap or (default_tag(node) in of_classes and node.get("gap") is not None)):
            continue
        new = margin + sign * gap
        if sign > 0 and new < 0:
            editing.refuse(
                node, f"{called(node)} would have a negative margin, which MuJoCo {editing.after} refuses"
            )
            continue
        editing.set(node, "margin", number_text(round(new, 15)))


def _is_of_class(node: Node) -> bool:
    parent = node.getparent()
    return parent is not None and parent.tag == "default"


def larger_of_two(editing: Editing) -> None:
    """Before 3.5 a contact had the larger margin of its two geoms, since then their sum."""
    _combine(editing, 0.5, "the larger", now="the sum")


def sum_of_two(editing: Editing) -> None:
    """The same for a model that goes back."""
    _combine(editing, 2.0, "the sum", now="the larger")


def _combine(editing: Editing, factor: float, was: str, now: str) -> None:
    if editing is not editing.whole[0]:
        return  # a geom touches those of all models that are attached
    for name in ("margin", "gap"):
        geoms = [
            (each, node) for each in editing.whole for node in each.at("body/geom") if _collides(each, node)
        ]
        values = [_number(each, node, name) for each, node in geoms]
        having = [pair for pair, value in zip(geoms, values, strict=True) if value]
        if not having or (len(having) == 1 and not _is_copied(*having[0])):
            continue
        if len(set(values)) == 1:  # any two have the same: half of it each
            for each in editing.whole:
                for node in each.at(*_GEOMS):
                    if node.get(name) is not None:
                        each.set(node, name, number_text(_number(each, node, name) * factor))
            continue
        first, node = having[0]
        several = "copies of one geom" if len(having) == 1 else f"{len(having)} geoms"
        first.warn(
            node,
            f"{several} have a `{name}`, and a contact of two of them has {was} in MuJoCo {editing.before}"
            f" and {now} in {editing.after}",
            f"write the `{name}` of such contacts as `<pair>`, or give it to one of the two geoms alone",
        )


def _collides(editing: Editing, node: Node) -> bool:
    return any(editing.value(node, name) != "0" for name in ("contype", "conaffinity"))


def _is_copied(editing: Editing, node: Node) -> bool:
    """Whether the model may have several of it: a model may be attached more than once."""
    return editing is not editing.whole[0] or any(above.tag == "replicate" for above in node.iterancestors())
