"""What remains of a recipe without what is wrong in it, so that one run also reports the faults of later stages."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from composer.diagnostics.suggest import closest
from composer.document.node import Key, Mapping, Node, Scalar, texts
from composer.document.node import Sequence as List
from composer.recipe.attach import Attachment
from composer.recipe.fault import Fault, Path
from composer.recipe.recipe import Recipe

# Without these nothing else in the recipe can be judged.
_INDISPENSABLE = ("recipe", "separator", "base")
# Without these a part is another one, or hangs in another way.
_MAKING = ("subtree", "joint", "drop", "edit", "prefix", "replicate", "with", "keyframes")
# What may disagree as `conflict` says.
_AGREED = ("option", "size", "statistic", "visual")
_ROUNDS = 8

Judge = Callable[[Mapping], tuple[Recipe | None, list[Fault]]]


@dataclass(frozen=True, slots=True)
class Remains:
    """A recipe that is right, its located tree, and every name and value in what had to be left out."""

    recipe: Recipe
    document: Mapping
    lost: frozenset[str]


def remains(node: Mapping, faults: Sequence[Fault], judge: Judge) -> Remains | None:
    """The recipe without the smallest pieces that have `faults`; None where too little would remain. No I/O."""
    lost: set[str] = set()
    for _ in range(_ROUNDS):
        for path in _outermost(_whole(way(node, fault.at)) for fault in faults):
            if not path or (len(path) == 1 and _means(path[0], _INDISPENSABLE)):
                return None
            lost.update(_texts(node, path))
            if _means(path[0], ("conflict",)):
                lost.update(_AGREED)
            unit = _means(path[0], ("angle",)) and len(path) == 1
            node = _in_some_unit(_without(node, path)) if unit else _without(node, path)
        recipe, faults = judge(node)
        if recipe is not None:
            return Remains(recipe, node, frozenset(lost))
    return None


def _whole(path: Path) -> Path:
    """The path of what goes: a part with a fault in a key that makes it what it is goes whole."""
    is_made = len(path) == 3 and path[0] == "attach" and _means(path[2], _MAKING, Attachment.model_fields)
    return path[:2] if is_made else path


def _means(
    key: str | int, keys: Collection[str], known: Collection[str] = tuple(Recipe.model_fields)
) -> bool:
    """Whether a key, or what was meant by it, is one of `keys`."""
    near = [str(key)] if key in known else closest(str(key), known)
    return any(meant in keys for meant in near)


def way(node: Node, path: Path) -> Path:
    """The steps of a validator's path that lead somewhere."""
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
    """The recipe with a unit of angles, so that none is reported to lack it."""
    key, unit = Key("angle", node.span), Scalar("radian", node.span, "radian", True)
    return Mapping({**node.entries, key.name: (key, unit)}, node.span)


def _outermost(paths: Iterator[Path]) -> list[Path]:
    """Paths of which none is inside another, last in the file first: taking one out moves no other."""
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
    """The key at the end of a path, and every key and value below it."""
    for step in path:
        if isinstance(node, Mapping):
            node = node.entries[str(step)][1]
        elif isinstance(node, List) and isinstance(step, int):
            node = node.items[step]
    if isinstance(path[-1], str):
        yield path[-1]
    yield from texts(node)
