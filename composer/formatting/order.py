"""The order of keys: that of the language if the order has no meaning, the author's otherwise."""

from __future__ import annotations

import json
from pathlib import Path as File

from composer.document.piece import in_own_model
from composer.formatting.syntax import Collection, Entry, Leaf

Path = tuple[str, ...]


def _read() -> dict[str, dict[Path, tuple[str, ...]]]:
    """Return the tables that `composer/recipe/key_order.py` writes, by paths."""
    tables = json.loads(File(__file__).with_name("key_order.json").read_text(encoding="utf-8"))
    return {
        name: {tuple(path.split(".")) if path else (): tuple(keys) for path, keys in table.items()}
        for name, table in tables.items()
    }


_TABLES = _read()
# Mappings in which all keys have a place; an unknown key stays behind its predecessor.
WHOLE = _TABLES["whole"]
# Mappings in which some keys come first; the others keep their order.
FIRST = _TABLES["first"]


def is_free(path: Path) -> bool:
    """Return whether the order of the keys in the mapping at `path` has no meaning. Indices of lists are `*`.

    >>> is_free(("attach",)), is_free(("attach", "arm")), is_free(("variants", "hand", "left", "attach", "arm"))
    (False, True, True)
    """
    return _table(path)[0] != ()


def put_in_order(root: Collection) -> None:
    """Sort the keys in place, each with its comments.

    A mapping with an anchor keeps its order, because it may be repeated where the order has a meaning.
    """
    _walk(root, ())


def _walk(node: Leaf | Collection | None, path: Path) -> None:
    if not isinstance(node, Collection) or "&" in node.properties:
        return
    if node.mapping:
        _sort(node, path)
    for entry in node.entries:
        _walk(entry.value, (*path, _name(entry)))


def _sort(node: Collection, path: Path) -> None:
    order, whole = _table(path)
    if not order:
        return
    rank = {name: index for index, name in enumerate(order)}
    ranks: list[int] = []
    for entry in node.entries:
        unknown = (ranks[-1] if ranks else -1) if whole else len(order)
        ranks.append(rank.get(_name(entry), unknown))
    before = node.entries
    after = [before[index] for index in sorted(range(len(before)), key=lambda index: (ranks[index], index))]
    if after == before or [e for e in before if e.pinned] != [e for e in after if e.pinned]:
        return
    if node.flow:
        for entry, breaks in zip(after, [entry.breaks for entry in before], strict=True):
            entry.breaks = breaks
    else:
        after[0].parted, before[0].parted = before[0].parted, after[0].parted
    node.entries = after


def _name(entry: Entry) -> str:
    return "*" if entry.key is None else entry.key.text.strip("\"'")


def _table(path: Path) -> tuple[tuple[str, ...], bool]:
    """Return the ordered keys, and whether these are all keys."""
    if path[:1] == ("variants",):
        path = path[3:] if len(path) >= 3 else ("",)
    path = tuple(map(str, in_own_model(path)))
    for known, order in WHOLE.items():
        if _fits(path, known):
            return order, True
    for known, order in FIRST.items():
        if _fits(path, known):
            return order, False
    return (), False


def _fits(path: Path, known: Path) -> bool:
    return len(path) == len(known) and all(
        wanted in ("*", name) for wanted, name in zip(known, path, strict=True)
    )
