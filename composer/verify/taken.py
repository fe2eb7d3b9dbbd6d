"""A source of which one body was taken: that body as a model of its own, and the whole source to hold it against."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from composer import engine
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.linking import KeyPolicy
from composer.link.subtree import take_subtree
from composer.plan.member import Member
from composer.steps.measure import folder_of, measure_with
from composer.tree.parse import parse_file
from composer.tree.write import write
from composer.verify.parts import refused

_NAMELESS = "the body above what was taken"


class Taken(NamedTuple):
    """`parent` is the body of the whole that stands for the world of what was taken; None for the world."""

    parent: str | None = None
    fault: str | None = None


def keep_taken(member: Member, session: engine.Session, taken: str, whole: str) -> Taken:
    """Compile both and keep them in the session under these names; a sentence where that cannot be."""
    assert member.subtree is not None
    sink = Sink()
    path = member.source.path
    unit = parse_file(path, sink)
    if unit is None:
        return Taken(fault=_said(sink))
    bodies = (each for world in unit.root.iterchildren("worldbody") for each in world.iter("body"))
    body = next((each for each in bodies if each.get("name") == member.subtree), None)
    above = None if body is None else next(body.iterancestors("body"), None)
    nameless = above is not None and not above.get("name")
    if above is not None and nameless:
        above.set("name", _NAMELESS)
    with folder_of(unit) as folder:
        fault = _keep(session, folder, path, write(unit.root) if nameless else None, whole)
    if fault is not None:
        return Taken(fault=fault)
    parent = None if above is None else str(above.get("name"))
    measure = measure_with(Context(sink=sink, environment={}, folder=path.parent), session=session)
    keyframes: KeyPolicy = "none" if member.keys is None else "merge"
    if take_subtree(unit, member.subtree, sink, keyframes=keyframes, measure=measure) is None:
        return Taken(fault=_said(sink))
    with folder_of(unit) as folder:
        return Taken(parent, _keep(session, folder, path, write(unit.root), taken))


def _keep(session: engine.Session, folder: Path, path: Path, text: bytes | None, name: str) -> str | None:
    given = None if text is None else text.decode()
    compiled = engine.compile(
        folder if given else path.parent, path.name, text=given, keep=name, session=session
    )
    return None if compiled.ok else refused(compiled.error or compiled.crash)


def _said(sink: Sink) -> str:
    return f"its source cannot be read: {sink.errors[0].message}"
