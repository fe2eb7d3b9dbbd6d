"""Compose one model with the parts of several: shared bodies once, and every part that only some of them have."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from composer.bundle.bundle import Bundle
from composer.bundle.read import read
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.engine import Session
from composer.loading.errors import LoadError
from composer.stages import Request, build
from composer.worlds.parts import Part, Tree, common, parts
from composer.worlds.union_manifest import of_sources


@dataclass(frozen=True, slots=True)
class Placed:
    """A part of a union: its prefix there, and the number of the model that it comes from."""

    part: Part
    prefix: str
    source: int


@dataclass(frozen=True, slots=True)
class Plan:
    """The contents of a union: bodies that all models share, all parts, and the parts of each model."""

    shared: set[str]
    placed: list[Placed]
    active: list[list[Placed]]


def plan_union(trees: Sequence[Tree], labels: Sequence[str]) -> Plan:
    """Plan a union: the first model keeps its names, parts of others get prefixes from their labels.

    Raises LoadError for elements that are not parts.
    """
    shared = common(trees)
    placed: list[Placed] = []
    active: list[list[Placed]] = []
    for number, tree in enumerate(trees):
        own = []
        for each in parts(tree, shared):
            known = next((other for other in placed if other.part == each), None)
            if known is None:
                known = Placed(each, _prefix(labels[number], placed) if number else "", number)
                placed.append(known)
            own.append(known)
        active.append(own)
    return Plan(shared, placed, active)


def _prefix(label: str, placed: Sequence[Placed]) -> str:
    """Return an unused prefix.

    >>> _prefix("./props/can.xml", [])
    'can/'
    """
    stem = "".join(each if each.isalnum() else "_" for each in Path(label).stem) or "part"
    taken = {each.prefix for each in placed}
    names = (f"{stem}{number}/" if number else f"{stem}/" for number in range(len(placed) + 1))
    return next(name for name in names if name not in taken)


def compose_union(
    plan: Plan, name: str, folders: Sequence[Path], separator: str, context: Context, session: Session
) -> Bundle:
    """Return the bundle of a union of the bundles in folders. Raises LoadError if it cannot be composed."""
    attach = {}
    for each in plan.placed:
        if not each.source:
            continue
        place = {} if each.part.parent == "world" else {"body": each.part.parent}
        model = f"./{folders[each.source].name}/model.xml"
        part = {"model": model, "subtree": each.part.body, "keyframes": "none", **place}
        attach[each.prefix.rstrip("/")] = part
    recipe = {
        "recipe": 1, "name": name, "separator": separator, "base": f"./{folders[0].name}/model.xml",
        "attach": attach, "conflict": "warning",
    }  # fmt: skip
    path = folders[0].parent / "union.yaml"
    path.write_text(json.dumps(recipe))
    own = replace(context, sink=Sink(), timings=[], folder=path.parent)
    made = build(Request(path), own, session=session)
    if made is None:
        raise LoadError(own.sink.errors)
    return of_sources(made.bundle, [read(folder) for folder in folders])


def bodies_of(trees: Sequence[Tree], each: Placed) -> Iterator[str]:
    """Yield the names in a union of the bodies of a part."""
    for body in trees[each.source].below(each.part.body):
        yield each.prefix + body
