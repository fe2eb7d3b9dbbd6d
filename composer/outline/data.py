"""An outline as JSON data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from composer.outline.outline import Body, Outline


def as_data(outline: Outline, depth: int | None = None) -> dict[str, Any]:
    """Return parts, and every body after its parent, with its joints and places.

    `depth` limits the levels of bodies. Metres and radians; poses are relative to the body (`pos`, `quat`) and to
    the world at the reference configuration.
    """
    return {
        "name": outline.name,
        "model": outline.label,
        "parts": [asdict(part) for part in outline.parts],
        "bodies": list(_bodies(outline.world, None, depth)),
    }


def _bodies(body: Body, parent: str | None, depth: int | None) -> Iterator[dict[str, Any]]:
    yield {
        "name": body.name,
        "parent": parent,
        "part": body.part,
        "copies": body.copies,
        "joints": [asdict(joint) for joint in body.joints],
        "places": [
            {
                place.kind: place.name,
                "pos": place.pose.pos,
                "quat": place.pose.quat,
                "world_pos": place.world.pos,
                "world_quat": place.world.quat,
            }
            for place in body.places
        ],
    }
    if depth is None or depth > 0:
        for child in body.children:
            yield from _bodies(child, body.name, None if depth is None else depth - 1)
