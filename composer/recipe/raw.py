"""A located tree as plain values, which pydantic can validate."""

from __future__ import annotations

from typing import Any

from composer.document.node import Node, Scalar, Sequence
from composer.document.piece import is_of_elements
from composer.expr.opening import is_template
from composer.recipe.fault import Fault, Path
from composer.recipe.indentation import lost_indentation


class Placed(dict[str, Any]):
    """A mapping that has its path from the top of the recipe."""

    __slots__ = ("at",)

    def __init__(self, at: Path) -> None:
        super().__init__()
        self.at = at


def path_of(value: object) -> Path:
    """Return the path of a mapping from the top of the recipe, empty for a mapping that was made in Python."""
    return value.at if isinstance(value, Placed) else ()


def raw(node: Node, faults: list[Fault]) -> Any:
    """Return the tree as dicts (`Placed`), lists and values, and faults that can occur anywhere.

    A key without a value and an expression without one are reported, and stay in the result, so that they do not
    count as missing.
    """
    return _raw(node, (), faults)


def _raw(node: Node, at: Path, faults: list[Fault]) -> Any:
    if isinstance(node, Scalar):
        if node.value is None:
            faults.append(_nothing(at))
        elif isinstance(node.value, str) and is_template(node.value) and not is_of_elements(at):
            faults.append(Fault("expression", "an expression has no value here", at))
        return node.value
    if isinstance(node, Sequence):
        return [_raw(item, (*at, index), faults) for index, item in enumerate(node.items)]
    mapping = Placed(at)
    fallen = lost_indentation(node, at)
    if fallen is not None:
        faults.append(fallen[0])
    for name, (_, value) in node.entries.items():
        path = (*at, name)
        if fallen is not None and name in fallen[1]:
            continue
        if is_template(name):
            help = "write the name itself; parameters can choose between pieces of recipe, by `when` and `variants`"
            faults.append(Fault("expression", "an expression cannot be a key", path, key=True, help=help))
            continue
        mapping[name] = _raw(value, path, faults)
    return mapping


def _nothing(at: Path) -> Fault:
    if at and isinstance(at[-1], str):
        return Fault(
            "wrong-type",
            f"`{at[-1]}` has no value",
            at,
            key=True,
            help="write a value behind it (`{}` for an element without attributes), or leave the key out",
        )
    return Fault("wrong-type", "a value is missing here", at)
