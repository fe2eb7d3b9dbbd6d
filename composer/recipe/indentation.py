"""Keys beside the name of an element that should be one level deeper.

gripper:
model: ./gripper.xml
"""

from __future__ import annotations

from collections.abc import Iterable

from composer.document.node import Mapping, Node, Scalar
from composer.recipe.fault import Fault, Path

_NAMES = ("attach", "sensor", "actuator", "equality", "tendon")


def lost_indentation(mapping: Mapping, at: Path) -> tuple[Fault, Iterable[str]] | None:
    """Return the fault of such keys and the entries that it is about, the name first; None without such keys.

    In a mapping from names to elements, every value is a mapping. Therefore, a name without a value that is
    followed by a key with a single value or a list has lost its indentation.
    """
    if not (len(at) == 1 and at[0] in _NAMES) and not (len(at) == 2 and at[0] == "asset"):
        return None
    names = list(mapping.entries)
    for index, name in enumerate(names):
        if not _is_empty(mapping.entries[name][1]):
            continue
        beside: list[str] = []
        for key in names[index + 1 :]:
            value = mapping.entries[key][1]
            if isinstance(value, Mapping) or _is_empty(value):
                break
            beside.append(key)
        if beside:
            keys = " and ".join(f"`{key}`" for key in beside)
            stand = "stands" if len(beside) == 1 else "stand"
            fault = Fault(
                "wrong-type",
                f"{keys} {stand} beside `{name}`, not below it",
                (*at, beside[0]),
                key=True,
                help=f"indent {keys} two spaces deeper than `{name}`",
            )
            return fault, [name, *beside]
    return None


def _is_empty(node: Node) -> bool:
    return isinstance(node, Scalar) and node.value is None
