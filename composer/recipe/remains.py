"""What remains of a recipe without what is wrong in it, so that one run also tells the faults of later stages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from composer.diagnostics.suggest import closest
from composer.document.node import Key, Mapping, Node, texts
from composer.document.node import Sequence as List
from composer.recipe.fault import Fault, Path
from composer.recipe.recipe import Recipe

# Without these nothing else in the recipe can be judged.
_INDISPENSABLE = ("recipe", "separator", "base")
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
        for path in _outermost(_way(node, fault.at) for fault in faults):
            if not path or (len(path) == 1 and _is_indispensable(path[0])):
                return None
            lost.update(_texts(node, path))
            node = _without(node, path)
        recipe, faults = judge(node)
        if recipe is not None:
            return Remains(recipe, node, frozenset(lost))
    return None


def _is_indispensable(key: str | int) -> bool:
    """Whether a key at the top, or what was meant by it, is one without which nothing else can be judged."""
    if key in Recipe.model_fields:
        return key in _INDISPENSABLE
    return any(meant in _INDISPENSABLE for meant in closest(str(key), Recipe.model_fields))


def _way(node: Node, path: Path) -> Path:
    """The steps of a validator's path that lead somewhere."""
    way: list[str | int] = []
    for step in path:
        if isinstance(node, Mapping) and isinstance(step, str) and step in node.entries:
            node = node.entries[step][1]
        elif isinstance(node, List) and isinstance(step, int) and 0 <= step < len(node.items):
            node = node.items[step]
        else:
            continue
        way.append(step)
    return tuple(way)


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
