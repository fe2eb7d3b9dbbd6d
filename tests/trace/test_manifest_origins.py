"""The origins in the manifest, for which a build needs no record, are places that the record has, too.

The record says more: an element that an edit changes has the place of the edit in the manifest, and `explain` also has
the line that it was read from.
"""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node
from mjcompose.base.diagnostic import Span
from mjcompose.trace.traced import Traced

_LISTED = "worldbody//joint", "worldbody//freejoint", "worldbody//camera", "actuator/*", "sensor/*", "keyframe/key"


def _recorded(traced: Traced, node: Node) -> Iterator[Span | None]:
    life = traced.watch.life(node)
    yield traced.place_of(life)
    yield from (traced.place_of(source) for source in life.sources)
    yield from (reason.span for reason in traced.written(life))
    yield from (change.reason.span for change in traced.changes(life))


def test_origins_are_in_the_record(traced: Traced) -> None:
    model = traced.model
    listed = [node for path in _LISTED for node in model.root.iterfind(path)]
    unknown = []
    for node in listed:
        origin = model.origins.span(node, model.file)
        places = {(span.file, span.line) for span in _recorded(traced, node) if span is not None}
        if (origin.file, origin.line) not in places:
            unknown.append(f"{traced.labels[node]}: {origin.file}:{origin.line}, recorded {sorted(places)}")
    assert unknown == []


def test_the_origin_of_an_unchanged_element_is_its_first_place(traced: Traced) -> None:
    model = traced.model
    differing = []
    for node in (node for path in _LISTED for node in model.root.iterfind(path)):
        life = traced.watch.life(node)
        first = traced.place_of(life.sources[0] if life.sources else life)
        changed = {change.reason.span for change in traced.changes(life)} - {None}
        origin = model.origins.span(node, model.file)
        if first is not None and not changed and (origin.file, origin.line) != (first.file, first.line):
            differing.append(f"{traced.labels[node]}: {origin.file}:{origin.line}, first {first.file}:{first.line}")
    assert differing == []
