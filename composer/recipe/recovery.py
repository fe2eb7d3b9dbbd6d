"""What remains of a recipe without its faults, so that one run also reports the faults of later stages."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest
from composer.document.node import Key, Mapping, Node, Scalar, texts
from composer.document.node import Sequence as List
from composer.recipe.attach import Attachment
from composer.recipe.fault import Fault, Path
from composer.recipe.recipe import Recipe

# Without these, nothing else in the recipe can be judged.
_INDISPENSABLE = ("recipe", "separator", "base")
# Without these, a part is another one, or is attached in another way.
_MAKING = ("subtree", "joint", "sense", "drop", "edit", "prefix", "replicate", "with", "keyframes")
# Sections in which parts may disagree, as `conflict` allows.
_AGREED = ("option", "size", "statistic", "visual")
_ROUNDS = 8

Judge = Callable[[Mapping], tuple[Recipe | None, list[Fault]]]


@dataclass(frozen=True, slots=True)
class Recovered:
    """A recipe without faults, its located tree, and every name and value in what was left out."""

    recipe: Recipe
    document: Mapping
    lost: frozenset[str]


def recover(node: Mapping, faults: Sequence[Fault], judge: Judge) -> Recovered | None:
    """Return the recipe without the smallest pieces that have `faults`, or None if too little would remain.

    It does no I/O.
    """
    lost: set[str] = set()
    for _ in range(_ROUNDS):
        for path in _outermost(_whole(existing_steps(node, fault.at)) for fault in faults):
            if not path or (len(path) == 1 and _means(path[0], _INDISPENSABLE)):
                return None
            lost.update(_texts(node, path))
            if _means(path[0], ("conflict",)):
                lost.update(_AGREED)
            unit = _means(path[0], ("angle",)) and len(path) == 1
            node = _in_some_unit(_without(node, path)) if unit else _without(node, path)
        recipe, faults = judge(node)
        if recipe is not None:
            return Recovered(recipe, node, frozenset(lost))
    return None


def _whole(path: Path) -> Path:
    """Return the path of what is left out. With a fault in an essential key, it is the whole part."""
    is_made = len(path) == 3 and path[0] == "attach" and _means(path[2], _MAKING, Attachment.model_fields)
    return path[:2] if is_made else path


def _means(
    key: str | int, keys: Collection[str], known: Collection[str] = tuple(Recipe.model_fields)
) -> bool:
    """Return whether a key, or what it was probably meant to be, is one of `keys`."""
    near = [str(key)] if key in known else closest(str(key), known)
    return any(meant in keys for meant in near)


def existing_steps(node: Node, path: Path) -> Path:
    """Return the steps of a validator's path that exist in the data."""
    found: list[str | int] = []
    for step in path:
        if isinstance(node, Mapping) and isinstance(step, str) and step in node.entries:
            node = node.entries[step][1]
        elif isinstance(node, List) and isinstance(step, int) and 0 <= step < len(node.items):
            node = node.items[step]
        else:
            continue
        found.append(step)
    return tuple(found)


def _in_some_unit(node: Mapping) -> Mapping:
    """Return the recipe with a unit of angles, so that no missing unit is reported."""
    key, unit = Key("angle", node.span), Scalar("radian", node.span, "radian", plain=True)
    return Mapping({**node.entries, key.name: (key, unit)}, node.span)


def _outermost(paths: Iterator[Path]) -> list[Path]:
    """Return the paths that are not inside another one, last in the file first.

    Removing one does not move the others then.
    """
    kept: list[Path] = []
    for path in sorted(set(paths), key=len):
        if not any(path[: len(each)] == each for each in kept):
            kept.append(path)
    return sorted(
        kept, key=lambda path: [step if isinstance(step, int) else -1 for step in path], reverse=True
    )


def _without(node: Mapping, path: Path) -> Mapping:
    found = _cut(node, path)
    assert isinstance(found, Mapping)
    return found


def _cut(node: Node, path: Path) -> Node:
    step, *rest = path
    if isinstance(node, Mapping):
        entries: dict[str, tuple[Key, Node]] = dict(node.entries)
        assert isinstance(step, str)
        key, value = entries.pop(step)
        if rest:
            entries = {**node.entries, step: (key, _cut(value, tuple(rest)))}
        return Mapping(entries, node.span)
    assert isinstance(node, List) and isinstance(step, int)
    items = list(node.items)
    items[step : step + 1] = [_cut(items[step], tuple(rest))] if rest else []
    return List(tuple(items), node.span)


def _texts(node: Node, path: Path) -> Iterator[str]:
    """Yield the key at the end of a path, and every key and value below it."""
    for step in path:
        if isinstance(node, Mapping):
            node = node.entries[str(step)][1]
        elif isinstance(node, List) and isinstance(step, int):
            node = node.items[step]
    if isinstance(path[-1], str):
        yield path[-1]
    yield from texts(node)
