"""Work on meshes, as verbs of `edit` ask for it: each result is found where it is kept, or made in a child process."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import field, replace
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import GIB, advice, in_force
from mjcompose.base.scratch import scratch
from mjcompose.build.bundle.collect import read
from mjcompose.build.compose.editing import Editing
from mjcompose.build.compose.shape_store import ShapeStore, parse_shapes, shapes_key
from mjcompose.build.plan.plan import GeneratedShapes
from mjcompose.link import numbers
from mjcompose.link.linking import FileUse
from mjcompose.model.files import written_path
from mjcompose.model.select import name_of
from mjcompose.mujoco import engine
from mjcompose.mujoco.fit import make
from mjcompose.mujoco.shapes import SHAPE, Measured, doubts
from mjcompose.sources.blobs import digest
from mjcompose.sources.context import Context
from mjcompose.text.faults import word

SAID = ("content_type", "vertex", "face", "refpos", "refquat", "scale", "builtin", "params")
"""The attributes of a mesh that decide where its surface is."""
_OPEN = f"look at the pieces, or close the mesh; `allow: [{SHAPE}]` says that you have"


@dataclass(frozen=True, slots=True)
class MeshJob:
    """What is to be made of one mesh. `mesh` are its attributes with the hash of its file, `content` the file."""

    node: Node
    called: str
    mesh: dict[str, str]
    content: bytes | None
    suffix: str
    method: str
    wanted: Any
    span: Span

    @property
    def key(self) -> str:
        return shapes_key(self.mesh, self.method, self.wanted)


@dataclass(slots=True)
class MeshResult:
    """What was made: the geoms, the geom or mesh that they were made for, and all that is known of it."""

    of: Node
    mesh: Node
    made: tuple[Node, ...]
    about: GeneratedShapes


@dataclass(slots=True)
class MeshWorkshop:
    """`makes` says whether what is not kept is made; an editor has no time for that. `records` has all that was made.

    It has `stopped` where nothing can be made here of any mesh.
    """

    context: Context
    makes: bool = True
    store: ShapeStore = field(init=False)
    records: list[MeshResult] = field(default_factory=list)
    stopped: bool = False

    def __post_init__(self) -> None:
        self.store = ShapeStore(self.context)

    def shapes_in(self, root: Node) -> tuple[GeneratedShapes, ...]:
        """All that was made and is in a finished model, by the names that things have there."""
        found = []
        for each in self.records:
            standing = [node for node in each.made if node.getroottree().getroot() is root]
            if not standing and each.made:
                continue
            of = "" if each.of is each.mesh else name_of(each.of) or ""
            shapes = tuple(name_of(node) or "" for node in standing)
            found.append(replace(each.about, of=of, mesh=name_of(each.mesh) or "", shapes=shapes))
        return tuple(found)

    def job_for(self, editing: Editing, mesh: Node, method: str, wanted: Any, span: Span) -> MeshJob | None:
        """What is asked of a mesh of a model; None where its file cannot be had, which is reported."""
        if next(mesh.iterchildren("plugin"), None) is not None:
            self._unusable(editing, mesh, "a plugin makes it", span=span)
            return None
        said = {name: text for name in SAID if (text := editing.classes.effective(mesh, None, name))}
        file = mesh.get("file")
        content, suffix = None, ""
        if file:
            content = _content(editing, mesh, str(file), context=self.context)
            if content is None:
                return None
            suffix = os.path.splitext(str(file))[1]
            said["file"] = digest(content) + suffix.lower()
        return MeshJob(
            mesh, editing.called(mesh), said, content=content, suffix=suffix, method=method, wanted=wanted, span=span
        )

    def results(self, editing: Editing, job: Sequence[MeshJob]) -> dict[str, dict[str, Any]] | None:
        """The results by their keys; None where one cannot be had, which is reported, or may not be made now."""
        errors = editing.sink.error_count
        found: dict[str, dict[str, Any]] = {}
        missing: dict[str, MeshJob] = {}
        for each in job:
            if each.key in found or each.key in missing:
                continue
            result = self.store.find(each.key, each.span)
            if result is None:
                missing[each.key] = each
            else:
                found[each.key] = result
        if editing.sink.error_count > errors or (missing and not self.makes):
            return None
        if missing:
            limits = engine.Limits(seconds=in_force().mesh_time)
            with engine.Session(limits) as session:
                for key, each in missing.items():
                    made = self._make(editing, each, session)
                    if made is not None:
                        self.store.keep(key, made)
                        found[key] = made
                    elif self.stopped:
                        break
        self._doubt(editing, job, found)
        return found if editing.sink.error_count == errors else None

    def _make(self, editing: Editing, job: MeshJob, session: engine.Session) -> dict[str, Any] | None:
        attributes = dict(job.mesh)
        with scratch("mesh") as folder:
            if job.content is not None:
                file = folder / f"mesh{job.suffix}"
                file.write_bytes(job.content)
                attributes["file"] = str(file)
            argument = {
                "mesh": attributes,
                "method": job.method,
                "wanted": job.wanted,
                "most_faces": in_force().mesh_faces,
            }
            answer = engine.call(session, make, (), argument=argument)
        if not answer.ok:
            self._failed(editing, job, answer.crash, error=answer.error)
            return None
        value = answer.value
        if "missing" in value:
            self.stopped = True
            message = f"`{job.method}` needs the Python package `{value['missing']}`, which is not installed"
            help = 'run `pip install "mjcompose[mesh]"`; what is locked needs no package'
            editing.sink.error("mesh-tools-missing", message, job.span, help=help)
            return None
        if "unusable" in value:
            why = value["unusable"].replace(str(attributes.get("file")), "its file")
            self._unusable(editing, job.node, why, span=job.span, limit=value.get("limit"))
            return None
        return parse_shapes(value)

    def _failed(self, editing: Editing, job: MeshJob, crash: str | None, error: str | None) -> None:
        limits = in_force()
        if crash == "timeout":
            message = f"what is made of {job.called} takes longer than {limits.mesh_time:g} s"
            editing.sink.error("limit-exceeded", message, job.span, help=advice("mesh-time"))
        elif crash == "memory":
            message = f"what is made of {job.called} takes more than {limits.memory / GIB:.3g} GiB of memory"
            editing.sink.error("limit-exceeded", message, job.span, help=advice("memory"))
        else:
            self.stopped = crash in ("missing", "start")
            words = " ".join((error or crash or "").split())
            code = "mujoco-missing" if crash == "missing" else "mesh-unusable"
            editing.sink.error(code, f"nothing could be made of {job.called}: {words}", job.span)

    def _unusable(self, editing: Editing, mesh: Node, why: str, span: Span, limit: str | None = None) -> None:
        editing.sink.error(
            "limit-exceeded" if limit else "mesh-unusable",
            f"nothing can be made of {editing.called(mesh)}: {why}",
            span,
            notes=(Note(f"{editing.called(mesh)} is written here", editing.span_of(mesh)),),
            help=advice(limit) if limit else None,
            subjects=editing.subjects(mesh),
        )

    def _doubt(self, editing: Editing, job: Sequence[MeshJob], found: dict[str, dict[str, Any]]) -> None:
        """Warn of meshes that are hardly what was meant. A flat one is an error before: no shape can be made of it."""
        reach = _reach(editing)
        for each in {each.node: each for each in job if each.key in found}.values():
            mesh = found[each.key]["mesh"]
            facts = Measured(float(mesh["size"]), is_closed=mesh["closed"])
            inside = "`decompose` fills its inside as well as it can" if each.method == "decompose" else None
            for doubt in doubts(facts, reach, inside=inside):
                help = _OPEN
                if doubt.kind != "open":
                    scale = numbers.read(each.mesh.get("scale", "1 1 1"))
                    help = doubt.advice(scale, _set_scale(name_of(each.node) or ""), ", ")
                place = editing.span_of(each.node)
                cause = Cause(f"{doubt.kind} meshes of {each.span}", f"{each.called} ({place})")
                message = f"{each.called} {doubt.what}"
                notes = [Note(f"{each.called} is written here", place)]
                editing.sink.warning(doubt.code, message, each.span, help=help, cause=cause, notes=notes)


def _reach(editing: Editing) -> float:
    """The greatest distance of a body from the one that holds it, in metres."""
    places = [numbers.read(body.get("pos") or "0 0 0") for body in editing.root.iter("body")]
    lengths = [math.dist((0, 0, 0), place) for place in places if len(place) == 3]
    return max((each for each in lengths if math.isfinite(each)), default=0.0)


def _set_scale(name: str) -> str:
    # Doubled braces are one in the text.
    return f"{{{{select: {{{{mesh: {word(name)}}}}}, set: {{{{scale: [{{}}]}}}}}}}}"


def _content(editing: Editing, mesh: Node, file: str, context: Context) -> bytes | None:
    """The bytes of a mesh's file; None where they cannot be had, which is reported."""
    linking = editing.linking
    unit = linking.base
    use = next((each for each in linking.files if each.element is mesh and each.attribute == "file"), None)
    if use is None:
        path = written_path(unit.settings, mesh, file)
        source = unit.source_of(path)
        if isinstance(source, bytes):
            return source
        try:
            use = FileUse(mesh, "file", path, source=unit.door.admit(source), content=None)
        except Refused as refused:
            refused.report(editing.sink, editing.span_of(mesh, "file"))
            return None
    return read(unit, use, editing.sink, shown=context.shown)
