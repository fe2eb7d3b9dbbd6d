"""Inlay hints: the counts of selectors, the values of expressions, and the units of angles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.document.node import Mapping, Node, Scalar, Sequence, find, to_python
from composer.expr.opening import is_template
from composer.lsp.analysis import Analysis
from composer.lsp.answers import Hint
from composer.lsp.cursor import Path
from composer.lsp.hover.expression import values_of
from composer.lsp.language import Form, forms_at, forms_below, kinds_of
from composer.lsp.matches import is_selector, label, matches
from composer.recipe.angles import angle_places

_MOST = 4
_UNITS = {"degree": "deg", "radian": "rad"}


def hints(analysis: Analysis) -> list[Hint]:
    """Return the hints of a recipe whose current text can be read."""
    tree = analysis.mapping
    if tree is None or not analysis.is_current:
        return []
    angle = find(tree, ("angle",))
    unit = _UNITS.get(angle.text, "") if isinstance(angle, Scalar) else ""
    data = to_python(tree)
    return list(_walk(tree, data, (), forms_at((), data), _Around(analysis, tree, unit)))


class _Around:
    def __init__(self, analysis: Analysis, tree: Mapping, unit: str) -> None:
        self.analysis, self.tree, self.unit = analysis, tree, unit


def _walk(node: Node, data: Any, path: Path, forms: list[Form], around: _Around) -> Iterator[Hint]:
    if isinstance(node, Scalar):
        if is_template(node.text) and path[:1] != ("params",):
            yield from _value(node, around.tree)
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            below = forms_below(forms, index, data[index])
            yield from _walk(item, data[index], (*path, index), below, around)
    else:
        if is_selector(path, data):
            yield from _count(node, path, data, around.analysis)
        for name, (_, value) in node.entries.items():
            if around.unit:
                yield from _angles(name, value, data, forms, around.unit)
            below = forms_below(forms, name, data[name])
            yield from _walk(value, data[name], (*path, name), below, around)


def _value(node: Scalar, tree: Mapping) -> Iterator[Hint]:
    values = list(dict.fromkeys(values_of(node.text, tree).values()))
    if values:
        more = f" | … {len(values) - _MOST} more" if len(values) > _MOST else ""
        yield Hint(node.span, f"= {' | '.join(values[:_MOST])}{more}")


def _count(node: Mapping, path: Path, data: dict[str, Any], analysis: Analysis) -> Iterator[Hint]:
    if path[-1] in ("parent", "in") or "where" in data or not analysis.is_composed:
        return
    found = matches(path, data, analysis)
    tag = next(iter(node.entries))
    if found:  # what matches nothing is an error, unless an edit before it renames or removes
        yield Hint(node.entries[tag][1].span, f"× {len(found)}", ", ".join(map(label, found[:20])))


def _angles(name: str, value: Node, data: dict[str, Any], forms: list[Form], unit: str) -> Iterator[Hint]:
    """Yield the unit of each angle that is written without one."""
    items = value.items if isinstance(value, Sequence) else (value,)
    numbers = [item for item in items if isinstance(item, Scalar)]
    if len(numbers) != len(items) or not any(isinstance(each.value, int | float) for each in numbers):
        return
    for kind in kinds_of(forms):
        attribute = kind.attributes.get(name)
        if attribute is None or attribute.angle is None:
            continue
        joint = str(data.get("type", "hinge")) if kind.tag == "joint" else None
        for index in angle_places(attribute, len(items), joint):
            each = numbers[index]
            if isinstance(each.value, int | float) and not isinstance(each.value, bool) and each.value:
                yield Hint(
                    each.span,
                    unit,
                    f"an angle, in the unit of `angle: {'degree' if unit == 'deg' else 'radian'}`",
                )
        return
