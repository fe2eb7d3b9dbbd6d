"""Compile a body that was taken from a source as a model of its own, and the whole source to compare it with."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from composer import engine
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.measure import folder_of, measure_with
from composer.link.request import KeyPolicy
from composer.link.subtree import take_subtree
from composer.plan.part_record import PartRecord
from composer.tree.parse import parse_file
from composer.tree.write import write
from composer.verify.source_alone import refused

_NAMELESS = "a body around what was taken, "


class KeptSubtree(NamedTuple):
    """The result of compiling a subtree and its source.

    `above` are the bodies around the subtree in the whole source, the nearest first, and None for the world. The
    subtree's world corresponds to the first of them, or to one further up if `fusestatic` fused them.
    """

    above: tuple[str | None, ...] = (None,)
    fault: str | None = None


def keep_subtree(member: PartRecord, session: engine.Session, taken: str, whole: str) -> KeptSubtree:
    """Compile the subtree and the whole source and keep them under these names.

    If that fails, the result has a message.
    """
    assert member.subtree is not None
    sink = Sink()
    path = member.source.path
    unit = parse_file(path, sink, door=member.source.door)
    if unit is None:
        return KeptSubtree(fault=_said(sink))
    bodies = (each for world in unit.root.iterchildren("worldbody") for each in world.iter("body"))
    body = next((each for each in bodies if each.get("name") == member.subtree), None)
    around = [] if body is None else list(body.iterancestors("body"))
    nameless = [each for each in around if not each.get("name")]
    for number, each in enumerate(nameless):
        each.set("name", f"{_NAMELESS}{number}")
    with folder_of(unit) as folder:
        fault = _keep(session, folder, path, text=write(unit.root) if nameless else None, name=whole)
    if fault is not None:
        return KeptSubtree(fault=fault)
    above = (*(str(each.get("name")) for each in around), None)
    measure = measure_with(Context(sink=sink, environment={}, folder=path.parent), session=session)
    keyframes: KeyPolicy = "none" if member.keys is None else "merge"
    if take_subtree(unit, member.subtree, sink, keyframes=keyframes, measure=measure) is None:
        return KeptSubtree(fault=_said(sink))
    with folder_of(unit) as folder:
        return KeptSubtree(above, _keep(session, folder, path, text=write(unit.root), name=taken))


def _keep(session: engine.Session, folder: Path, path: Path, text: bytes | None, name: str) -> str | None:
    given = None if text is None else text.decode()
    compiled = engine.compile(
        folder if given else path.parent, path.name, text=given, keep=name, session=session
    )
    return None if compiled.ok else refused(compiled.error or compiled.crash)


def _said(sink: Sink) -> str:
    return f"its source cannot be read: {sink.errors[0].message}"
