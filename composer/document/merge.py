"""One located tree over another: `extends` and `variants`. Every value keeps the place where it is written."""

from __future__ import annotations

from collections.abc import Collection

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.document.node import Key, Mapping, Node, Scalar, Sequence, locate
from composer.document.piece import in_own_model, is_appended

Path = tuple[str, ...]

# Mappings that may be written shorter as one value: as which key's.
_SHORT = {("base",): "model", ("params", "*"): "default"}
# Where another `type` makes it another element.
_TYPED = frozenset({("sensor", "*"), ("actuator", "*"), ("equality", "*"), ("tendon", "*")})
# What belongs to one model and not to the next.
_OF_MODEL = ("with", "subtree", "drop", "edit", "mate")
_ORIENTATIONS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
# Alternatives: of the keys in these bundles, those of one bundle stand together and those of two do not.
_ALTERNATIVES: dict[Path, tuple[tuple[tuple[str, ...], ...], ...]] = {
    ("attach", "*"): ((("site",), ("body",), ("frame",)),),
    ("actuator", "*"): (
        (("joint",), ("jointinparent",), ("tendon",), ("site", "refsite"), ("body",), ("cranksite", "slidersite")),
    ),
    ("equality", "*"): ((("body1", "body2", "anchor", "relpose"), ("site1", "site2")),),
    ("randomize", "fields", "*"): (
        (("select", "attr"), ("param",)),
        (
            ("uniform",), ("loguniform",), ("normal",), ("truncnormal",), ("lognormal",), ("choice",), ("integers",),
            ("scale",), ("offset",),
        ),
    ),
}  # fmt: skip


def merge(lower: Mapping, upper: Mapping, sink: Sink) -> Mapping:
    """`upper` over `lower`, by the rules of pieces of recipe; a `null` that deletes nothing goes to the sink. No I/O.

    Mappings merge by key; scalars and lists replace, but `add` and `edit` append, and there an item whose `id` is
    known replaces that one in its place. `null` deletes.
    """
    return _Merge(sink).mappings(lower, upper, ())


class _Merge:
    def __init__(self, sink: Sink) -> None:
        self.sink = sink

    def mappings(self, lower: Mapping, upper: Mapping, path: Path) -> Mapping:
        entries = dict(lower.entries)
        replaced = _replaced(lower, upper, path)
        for name in replaced:
            entries.pop(name, None)
        for name, (key, value) in upper.entries.items():
            below = (*path, name)
            if isinstance(value, Scalar) and value.value is None and value.plain:
                if entries.pop(name, None) is None and name not in replaced:
                    self._nothing_to_delete(key, lower)
            elif name in entries:
                there = entries[name]
                merged = self.values(there[1], value, below)
                # The place of the key that stands is where the entry begins; what is inside has its own.
                entries[name] = (key if merged is value else there[0], merged)
            else:
                entries[name] = (key, value)
        return Mapping(entries, upper.span)

    def values(self, lower: Node, upper: Node, path: Path) -> Node:
        kind = _pattern(path)
        short = _SHORT.get(kind)
        if short is not None and isinstance(lower, Mapping) != isinstance(upper, Mapping):
            lower, upper = _long(lower, short), _long(upper, short)
        if isinstance(lower, Mapping) and isinstance(upper, Mapping):
            if kind in _TYPED and _differ(lower, upper, "type"):
                return upper
            return self.mappings(lower, upper, path)
        if isinstance(lower, Sequence) and isinstance(upper, Sequence) and is_appended(kind):
            return self._appended(lower, upper)
        return upper

    def _appended(self, lower: Sequence, upper: Sequence) -> Sequence:
        items = list(lower.items)
        places = {_id(item): index for index, item in enumerate(items) if _id(item) is not None}
        self._only_once(lower)
        self._only_once(upper)
        for item in upper.items:
            place = places.get(_id(item))
            if place is None:
                items.append(item)
            else:
                items[place] = item
        return Sequence(tuple(items), upper.span)

    def _only_once(self, written: Sequence) -> None:
        """Report an `id` that two items of a list have, of which only one could be meant."""
        seen: dict[str, Node] = {}
        for item in written.items:
            name = _id(item)
            if name is None:
                continue
            if name in seen:
                notes = (Note("the other one", locate(seen[name], ("id",))),)
                self.sink.error("name-clash", f"two items have the `id` `{name}`", locate(item, ("id",)), notes=notes,
                                help="give one of them another `id`")  # fmt: skip
            seen[name] = item

    def _nothing_to_delete(self, key: Key, lower: Mapping) -> None:
        self.sink.error(
            "unknown-key",
            f"`{key.name}` does not exist and cannot be taken out",
            key.span,
            notes=(exists_note("key", list(lower.entries), key.name),),
            help=did_you_mean(key.name, lower.entries, "{}: null"),
        )


def _pattern(path: Path) -> Path:
    """A path as the tables above have it: the piece that it stands in left out, names as `*`.

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
    """Whether the upper one says something else than the lower one does."""
    if key not in lower.entries or key not in upper.entries:
        return False
    a, b = lower.entries[key][1], upper.entries[key][1]
    return not (isinstance(a, Scalar) and isinstance(b, Scalar) and a.value == b.value)


def _replaced(lower: Mapping, upper: Mapping, path: Path) -> Collection[str]:
    """The keys of `lower` that another choice in `upper` makes void."""
    kind = _pattern(path)
    void: set[str] = set()
    if kind in (("base",), ("attach", "*")) and _differ(lower, upper, "model"):
        void.update(key for key in _OF_MODEL if key in lower.entries)
    for bundles in (*_ALTERNATIVES.get(kind, ()), tuple((name,) for name in _ORIENTATIONS)):
        chosen = [bundle for bundle in bundles if any(_given(upper, name) for name in bundle)]
        if chosen:
            void.update(name for bundle in bundles if bundle not in chosen for name in bundle)
    return void & lower.entries.keys()


def _given(node: Mapping, name: str) -> bool:
    """Whether a key exists and does not delete."""
    found = node.entries.get(name)
    return found is not None and not (isinstance(found[1], Scalar) and found[1].value is None)


def without_ids(document: Mapping, sink: Sink) -> Mapping:
    """The recipe without the `id`s of items, which are for merging alone; those that are not text are reported."""
    return _bare(document, (), sink)


def _bare(node: Mapping, path: Path, sink: Sink) -> Mapping:
    entries = dict(node.entries)
    for name, (key, value) in node.entries.items():
        below = (*path, name)
        if is_appended(below) and isinstance(value, Sequence):
            entries[name] = (key, Sequence(tuple(_no_id(item, sink) for item in value.items), value.span))
        elif isinstance(value, Mapping) and (below in (("base",), ("attach",)) or path == ("attach",)):
            entries[name] = (key, _bare(value, below, sink))
    return Mapping(entries, node.span)


def _no_id(item: Node, sink: Sink) -> Node:
    if not isinstance(item, Mapping):
        return item
    name = item.entries["id"][1] if "id" in item.entries else None
    if name is not None and not (isinstance(name, Scalar) and name.value and isinstance(name.value, str)):
        help = (
            f"quote it: `id: '{name.text}'`" if isinstance(name, Scalar) and name.text else "write `id: NAME`"
        )
        sink.error("wrong-type", "`id` is a name for merging, which is text", name.span, help=help)
    return Mapping({name: entry for name, entry in item.entries.items() if name != "id"}, item.span)


def _id(item: Node) -> str | None:
    found = item.entries.get("id") if isinstance(item, Mapping) else None
    return found[1].text if found is not None and isinstance(found[1], Scalar) else None
