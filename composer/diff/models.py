"""Compare two compiled models by the names of their elements. Runs in MuJoCo's child process."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from composer.compiled.correspondence import ABSENT, Correspondence
from composer.compiled.difference import MISSING
from composer.compiled.identity import unequal_arrays
from composer.compiled.joints import JOINT_TYPES
from composer.compiled.keyframes import Keys, Roots, key_differences
from composer.compiled.kinds import KINDS, ON_BODIES, Model, NameTable, holder
from composer.compiled.links import UNORDERED, links
from composer.compiled.mount import Mount
from composer.compiled.quantities import follows
from composer.diff.change import Change, Contrast, Count, Move, Value
from composer.diff.layout import counts, moves
from composer.diff.named import named
from composer.diff.renames import Names, renames
from composer.diff.settings import setting_changes
from composer.diff.values import Values


def contrast(mujoco: Any, a: Model, b: Model, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a `Contrast` as JSON data; runs under `composer.engine.call`. ``given`` has the ``tolerance``.

    It may also have ``names``, which maps A's names to B's by kind if that is known. Unnamed elements may then be
    in another order.
    """
    mine, theirs = NameTable(a), NameTable(b)
    known = given.get("names")
    names = renames(mine, theirs) if known is None else known
    matching = Correspondence(mine, theirs, prefix="", mount=Mount(), renamed=names, by_order=known is None)
    values = Values(mujoco, matching, float(given["tolerance"]))
    changes = [
        *(_renamed(names, matching) if known is None else ()),
        *_presence(matching),
        *references(matching),
        *values.changes(),
        *_keys(matching, float(given["tolerance"])),
        *setting_changes(mujoco, a, b, tolerance=float(given["tolerance"])),
    ]
    arrays = unequal_arrays(a, b)
    contrast = Contrast(
        identical=not arrays,
        changes=tuple(changes),
        moves=tuple(moves(matching)),
        counts=tuple(counts(a, b, float(given["tolerance"]))),
        arrays=() if changes else tuple(arrays),
        elements={kind: (mine.count(kind), theirs.count(kind)) for kind in KINDS},
    )
    return asdict(contrast)


def contrast_of(data: Mapping[str, Any]) -> Contrast:
    """Return the contrast from its JSON data."""
    return Contrast(
        identical=data["identical"],
        changes=tuple(
            Change(**{**each, "before": _frozen(each["before"]), "after": _frozen(each["after"]),
                      "index": tuple(each["index"])})
            for each in data["changes"]
        ),
        moves=tuple(Move(**each) for each in data["moves"]),
        counts=tuple(Count(**each) for each in data["counts"]),
        arrays=tuple(data["arrays"]),
        elements={kind: (a, b) for kind, (a, b) in data["elements"].items()},
    )  # fmt: skip


def _frozen(value: Any) -> Value:
    return tuple(_frozen(each) for each in value) if isinstance(value, list) else value


def _renamed(names: Names, matching: Correspondence) -> Iterator[Change]:
    for kind, by_name in names.items():
        for before, after in by_name.items():
            index = matching.alone.ids[kind][before], matching.composed.ids[kind][after]
            yield Change("renamed", kind, after, before=before, after=after, index=index, name_before=before)


def _presence(matching: Correspondence) -> Iterator[Change]:
    """Yield elements that only one of the two models has; unnamed ones come and go with their body."""
    for kind in KINDS:
        if kind == "key":
            continue
        ids, taken = matching.ids[kind], matching.taken[kind]
        lost = {i for i, j in enumerate(ids) if j == ABSENT}
        new = {j for j in range(matching.composed.count(kind)) if j not in taken} - (
            {0} if kind == "body" else set()
        )
        for index in sorted(lost):
            if not _goes_along(matching.alone, kind, index, ids=matching.ids["body"], taken=None):
                name = named(matching.alone, kind, index)
                yield Change("removed", kind, name, index=(index, ABSENT), name_before=name)
        for index in sorted(new):
            if not _goes_along(matching.composed, kind, index, ids=None, taken=matching.taken["body"]):
                yield Change("added", kind, named(matching.composed, kind, index), index=(ABSENT, index))


def _goes_along(
    roster: NameTable, kind: str, index: int, ids: list[int] | None, taken: set[int] | None
) -> bool:
    if kind not in ON_BODIES or roster.names[kind][index]:
        return False
    body = holder(roster.model, kind, index)
    return body != 0 and (
        (ids is not None and ids[body] == ABSENT) or (taken is not None and body not in taken)
    )


def references(matching: Correspondence) -> Iterator[Change]:
    """Yield references whose target changed."""
    for kind in KINDS:
        if kind == "key":
            continue
        for index, target in matching.pairs(kind):
            yield from _references_of(matching, kind, index, target=target)


def _references_of(matching: Correspondence, kind: str, index: int, target: int) -> Iterator[Change]:
    mine = links(matching.alone.model, kind, index)
    theirs = links(matching.composed.model, kind, target)
    if kind in UNORDERED and len(theirs) == 2 and theirs[1].index in matching.targets(mine[0]):
        theirs = [theirs[1], theirs[0]]
    after = {link.field: link for link in theirs}
    for link in mine:
        other = after.pop(link.field, None)
        same = other is not None and other.kind == link.kind and other.index in matching.targets(link)
        if same:
            continue
        shown = [
            None if each is None or each.index < 0 else side.describe(each.kind, each.index)
            for each, side in ((link, matching.alone), (other, matching.composed))
        ]
        yield _changed(
            matching, kind, index, target=target, field=link.field, before=shown[0], after=shown[1]
        )
    for field, link in after.items():
        named = None if link.index < 0 else matching.composed.describe(link.kind, link.index)
        yield _changed(matching, kind, index, target=target, field=field, before=None, after=named)


def _changed(
    matching: Correspondence, kind: str, index: int, target: int, field: str, before: Value, after: Value
) -> Change:
    return Change(
        "changed", kind, named(matching.composed, kind, target), field=field, before=before, after=after,
        index=(index, target), name_before=named(matching.alone, kind, index), follows=follows(field),
    )  # fmt: skip


def _keys(matching: Correspondence, tolerance: float) -> Iterator[Change]:
    """Yield changes of keyframes by joint, actuator and mocap body."""
    mine, theirs = matching.alone, matching.composed
    types = matching.composed.model.jnt_type.tolist()
    joints = {theirs.describe("joint", j): JOINT_TYPES[types[j]].word for _, j in matching.pairs("joint")}
    for difference in key_differences(matching, None, Keys.MERGE, roots=Roots.KEPT, tolerance=tolerance):
        if difference.field == MISSING:
            index = mine.ids["key"].get(difference.name, ABSENT)
            yield Change(
                "removed", "key", difference.name, index=(index, ABSENT), name_before=difference.name
            )
            continue
        field, _, entry = difference.field.partition(" of ")
        name = entry.strip("`")
        before, after = _alone(difference.expected), _alone(difference.actual)
        both = mine.ids["key"].get(difference.name, ABSENT), theirs.ids["key"].get(difference.name, ABSENT)
        yield Change(
            "changed",
            "key",
            difference.name,
            field=field,
            before=before,
            after=after,
            form=joints.get(name, ""),
            entry=name,
            index=both,
            name_before=difference.name,
        )
    known = set(mine.names["key"])
    for index, name in enumerate(theirs.names["key"]):
        if name not in known:
            yield Change("added", "key", theirs.describe("key", index), index=(ABSENT, index))


def _alone(value: Value) -> Value:
    """Return a list of one number as that number."""
    return value[0] if isinstance(value, tuple) and len(value) == 1 else value
