"""Merge located trees for `extends` and `variants`; every value keeps its place."""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, locate

Path = tuple[str | int, ...]

_EDITS: tuple[Path, ...] = (("edit",), ("base", "edit"), ("attach", "*", "edit"))
# The verbs whose values may refer to the current value.
_OF_ELEMENTS = ("set", "scale", "convert", "move", "rename")
# Paths with selectors, besides edits.
_SELECTING: tuple[Path, ...] = (
    ("base", "drop"),
    ("attach", "*", "drop"),
    ("check", "*", "*"),
    ("randomize", "fields", "*", "select"),
)


def in_own_model(path: Path) -> Path:
    """Return the path within its own model, if that is written in place.

    >>> in_own_model(("attach", "table", "model", "add", 0)), in_own_model(("base", "model", "edit"))
    (('add', 0), ('edit',))
    >>> in_own_model(("attach", "table", "model"))
    ('attach', 'table', 'model')
    """
    while True:
        depth = 2 if path[:2] == ("base", "model") else 3 if path[:1] == ("attach",) else 0
        if not depth or len(path) <= depth or path[depth - 1] != "model":
            return path
        path = path[depth:]


def is_edits(path: Path) -> bool:
    """Return whether there is a list of edits at this path: the recipe's own, the base's or a part's.

    >>> is_edits(("base", "edit")), is_edits(("attach", "arm", "edit")), is_edits(("sensor", "edit"))
    (True, True, False)
    """
    path = in_own_model(path)
    return any(len(path) == len(edits) and _is_below(path, edits) for edits in _EDITS)


def is_appended(path: Path) -> bool:
    """Return whether merging appends to the list at this path, matching items by `id`."""
    return in_own_model(path) == ("add",) or is_edits(path)


@lru_cache(4096)  # each cell and each sample needs the same paths
def is_of_elements(path: Path) -> bool:
    """Return whether `${…}` at this path is evaluated for each element: in edits, and in `where` of selectors.

    >>> is_of_elements(("edit", 0, "set", "mass")), is_of_elements(("base", "drop", 1, "where"))
    (True, True)
    >>> is_of_elements(("edit", 0, "select", "geom")), is_of_elements(("edit", 0, "expect"))
    (False, False)
    >>> is_of_elements(("attach", "where", "pos")), is_of_elements(("sensor", "edit", "noise"))
    (False, False)
    """
    path = in_own_model(path)
    for edits in _EDITS:
        if len(path) > len(edits) + 1 and _is_below(path, edits):
            verb, *inner = path[len(edits) + 1 :]
            if verb == "select":
                return "where" in inner
            return verb in _OF_ELEMENTS and (verb, *inner) != ("convert", "to")
    return any(_is_below(path, place) and "where" in path[len(place) :] for place in _SELECTING)


def is_taken_out(path: Path) -> bool:
    """Return whether null at this path removes an attribute: in `set` of edits.

    >>> is_taken_out(("edit", 0, "set", "mass")), is_taken_out(("edit", 0, "move", "to"))
    (True, False)
    """
    path = in_own_model(path)
    below = [len(edits) for edits in _EDITS if len(path) > len(edits) + 2 and _is_below(path, edits)]
    return any(path[length + 1] == "set" for length in below)


def _is_below(path: Path, place: Path) -> bool:
    return len(path) >= len(place) and all(b in (a, "*") for a, b in zip(path, place, strict=False))


MergePath = tuple[str, ...]

# Mappings that may be abbreviated to the value of this key.
_SHORT = {("base",): "model", ("params", "*"): "default"}
# Another `type` makes these another element.
_TYPED = frozenset({("sensor", "*"), ("actuator", "*"), ("equality", "*"), ("tendon", "*")})
# Keys that belong to one model, and are dropped for another one.
_OF_MODEL = ("with", "compiler", "subtree", "drop", "edit", "mate")
# Keys with data, whose own keys have no meaning here.
_DATA = frozenset({"with", "for"})
_ORIENTATIONS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
# Alternative keys: keys of one group may be combined, keys of different groups may not.
_ALTERNATIVES: dict[MergePath, tuple[tuple[tuple[str, ...], ...], ...]] = {
    ("attach", "*"): ((("site",), ("body",), ("frame",)),),
    ("actuator", "*"): (
        (("joint",), ("jointinparent",), ("tendon",), ("site", "refsite"), ("body",), ("cranksite", "slidersite")),
    ),
    ("equality", "*"): ((("body1", "body2", "anchor", "relpose"), ("site1", "site2")),),
    ("randomize", "fields", "*"): (
        (("select", "attr"), ("param",)),
        (
            ("uniform",),
            ("loguniform",),
            ("normal",),
            ("truncnormal",),
            ("lognormal",),
            ("choice",),
            ("integers",),
            ("scale",),
            ("offset",),
            ("from", "widen"),
        ),
    ),
}


def merge(lower: Mapping, upper: Mapping, sink: Sink, path: MergePath = ()) -> Mapping:
    """Merge `upper` over `lower`; it reports a `null` that deletes nothing. No I/O.

    Mappings merge by key. Scalars and lists are replaced, except that `add` and `edit` append, and an item with a
    known `id` replaces the item with that `id` in its place. `null` deletes.
    """
    entries = dict(lower.entries)
    replaced = _replaced(lower, upper, path)
    for name in replaced:
        entries.pop(name, None)
    for name, (key, value) in upper.entries.items():
        below = (*path, name)
        if isinstance(value, Scalar) and value.value is None and value.plain:
            if entries.pop(name, None) is None and name not in replaced:
                notes = (exists_note("key", list(lower.entries), name),)
                help = did_you_mean(name, lower.entries, "{}: null")
                message = f"`{name}` does not exist and cannot be removed"
                sink.error("unknown-key", message, key.span, notes=notes, help=help)
        elif name in entries:
            existing, old = entries[name]
            merged = _values(old, value, below, sink=sink)
            # The entry keeps the place of the existing key; its contents have their own places.
            entries[name] = (key if merged is value else existing, merged)
        else:
            entries[name] = (key, value)
    return Mapping(entries, upper.span)


def _values(lower: Node, upper: Node, path: MergePath, sink: Sink) -> Node:
    kind = _pattern(path)
    short = _SHORT.get(kind)
    if short is not None and isinstance(lower, Mapping) != isinstance(upper, Mapping):
        lower = _long(lower, short)
        upper = _long(upper, short)
    if isinstance(lower, Mapping) and isinstance(upper, Mapping):
        if kind in _TYPED and _differ(lower, upper, "type"):
            return upper
        return merge(lower, upper, sink, path=path)
    if isinstance(lower, Sequence) and isinstance(upper, Sequence) and is_appended(kind):
        return _appended(lower, upper, sink)
    return upper


def _appended(lower: Sequence, upper: Sequence, sink: Sink) -> Sequence:
    items = list(lower.items)
    places = {_id(item): index for index, item in enumerate(items) if _id(item) is not None}
    _check_ids(lower, sink)
    _check_ids(upper, sink)
    for item in upper.items:
        place = places.get(_id(item))
        if place is None:
            items.append(item)
        else:
            items[place] = item
    return Sequence(tuple(items), upper.span)


def _check_ids(written: Sequence, sink: Sink) -> None:
    seen: dict[str, Node] = {}
    for item in written.items:
        name = _id(item)
        if name in seen:
            notes = (Note("the other one", locate(seen[name], ("id",))),)
            help = "give one of them another `id`"
            message = f"two items have the `id` `{name}`"
            sink.error("name-clash", message, locate(item, ("id",)), notes=notes, help=help)
        if name is not None:
            seen[name] = item


def _pattern(path: MergePath) -> MergePath:
    """Return a path in the form of the tables above: without the piece around it, and with `*` for names.

    >>> _pattern(("variants", "gripper", "hand", "attach", "left", "edit"))
    ('attach', '*', 'edit')
    >>> _pattern(("sensor", "edit"))
    ('sensor', '*')
    """
    if len(path) > 3 and path[0] == "variants":
        path = path[3:]
    path = tuple(map(str, in_own_model(path)))
    if path[:2] == ("randomize", "fields"):
        return (*path[:2], "*", *path[3:]) if len(path) > 2 else path
    if len(path) > 1 and path[0] not in ("base", "randomize", "matrix"):
        return (path[0], "*", *path[2:])
    return path


def _long(node: Node, key: str) -> Node:
    return node if isinstance(node, Mapping) else Mapping({key: (Key(key, node.span), node)}, node.span)


def _differ(lower: Mapping, upper: Mapping, key: str) -> bool:
    if key not in lower.entries or key not in upper.entries:
        return False
    a = lower.entries[key][1]
    b = upper.entries[key][1]
    return not (isinstance(a, Scalar) and isinstance(b, Scalar) and a.value == b.value)


def _replaced(lower: Mapping, upper: Mapping, path: MergePath) -> Collection[str]:
    """Return the keys of `lower` that a different choice in `upper` makes void."""
    kind = _pattern(path)
    if kind[:1] == ("params",) or not _DATA.isdisjoint(kind[1:]):
        return ()
    void: set[str] = set()
    if kind in (("base",), ("attach", "*")) and _differ(lower, upper, "model"):
        void.update(key for key in _OF_MODEL if key in lower.entries)
    for bundles in (*_ALTERNATIVES.get(kind, ()), tuple((name,) for name in _ORIENTATIONS)):
        chosen = [bundle for bundle in bundles if any(_given(upper, name) for name in bundle)]
        if chosen:
            void.update(name for bundle in bundles if bundle not in chosen for name in bundle)
    return void & lower.entries.keys()


def _given(node: Mapping, name: str) -> bool:
    found = node.entries.get(name)
    return found is not None and not (isinstance(found[1], Scalar) and found[1].value is None)


def without_ids(node: Mapping, sink: Sink, path: MergePath = ()) -> Mapping:
    """Return the recipe without the `id`s of items, which only serve merging; report an `id` that is not text."""
    entries = dict(node.entries)
    for name, (key, value) in node.entries.items():
        below = (*path, name)
        if is_appended(below) and isinstance(value, Sequence):
            entries[name] = (key, Sequence(tuple(_no_id(item, sink) for item in value.items), value.span))
        elif isinstance(value, Mapping) and (below in (("base",), ("attach",)) or path == ("attach",)):
            entries[name] = (key, without_ids(value, sink, below))
    return Mapping(entries, node.span)


def _no_id(item: Node, sink: Sink) -> Node:
    if not isinstance(item, Mapping):
        return item
    name = item.entries["id"][1] if "id" in item.entries else None
    if name is not None and not (isinstance(name, Scalar) and name.value and isinstance(name.value, str)):
        help = f"quote it: `id: '{name.text}'`" if isinstance(name, Scalar) and name.text else "write `id: NAME`"
        sink.error("wrong-type", "`id` is a name for merging, which is text", name.span, help=help)
    return Mapping({name: entry for name, entry in item.entries.items() if name != "id"}, item.span)


def _id(item: Node) -> str | None:
    found = item.entries.get("id") if isinstance(item, Mapping) else None
    return found[1].text if found is not None and isinstance(found[1], Scalar) else None
