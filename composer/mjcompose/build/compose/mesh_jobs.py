"""Work on meshes for the verbs of `edit`: each result comes from a store or from a child process."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
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
from mjcompose.build.compose.values import UnusableValue
from mjcompose.build.plan.plan import GeneratedShapes
from mjcompose.link import numbers
from mjcompose.link.linking import FileUse
from mjcompose.mujoco import engine
from mjcompose.mujoco.fit import make
from mjcompose.mujoco.shapes import SHAPE, Measured, doubts
from mjcompose.sources.blobs import digest
from mjcompose.sources.context import Context
from mjcompose.text.faults import word
from mjcompose.tree.files import written_path
from mjcompose.tree.select import name_of

SAID = ("content_type", "vertex", "face", "refpos", "refquat", "scale", "builtin", "params")
"""The attributes of a mesh that decide where its surface is."""
_OPEN = f"look at the pieces, or close the mesh; then write `allow: [{SHAPE}]`"


@dataclass(frozen=True, slots=True)
class MeshJob:
    """Work on one mesh. `mesh` has its attributes with the hash of its file, `content` is the file."""

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

    def shapes_of(self, geom: str, result: Mapping[str, Any], shapes: tuple[str, ...], faces: int) -> GeneratedShapes:
        """Return the facts about a result, `shapes` being the names of the new geoms."""
        return GeneratedShapes(
            geom, name_of(self.node) or "", self.method, wanted=self.wanted, shapes=shapes, faces=faces,
            error=result["error"], made_with=result["made_with"], key=self.key, span=self.span,
        )  # fmt: skip


@dataclass(slots=True)
class MeshResult:
    """The new geoms, the geom or mesh that they are for, and the facts about them."""

    of: Node
    mesh: Node
    made: tuple[Node, ...]
    about: GeneratedShapes


@dataclass(slots=True)
class MeshWorkshop:
    """Finds or computes results. Without `makes` it computes none, because an editor has no time for it.

    `records` has all results. `stopped` is set if the tools are missing.
    """

    context: Context
    makes: bool = True
    store: ShapeStore = field(init=False)
    records: list[MeshResult] = field(default_factory=list)
    stopped: bool = False

    def __post_init__(self) -> None:
        self.store = ShapeStore(self.context)

    def shapes_in(self, root: Node) -> tuple[GeneratedShapes, ...]:
        """Return the generated shapes that are in a finished model, with their final names."""
        generated = []
        for record in self.records:
            left = [node for node in record.made if node.getroottree().getroot() is root]
            if left or not record.made:
                of = "" if record.of is record.mesh else name_of(record.of) or ""
                shapes = tuple(name_of(node) or "" for node in left)
                generated.append(replace(record.about, of=of, mesh=name_of(record.mesh) or "", shapes=shapes))
        return tuple(generated)

    def job_for(self, editing: Editing, mesh: Node, method: str, wanted: Any, span: Span) -> MeshJob:
        """Return the work on a mesh of a model. Raises UnusableValue if its file is unreadable, which is reported."""
        if next(mesh.iterchildren("plugin"), None) is not None:
            self._unusable(editing, mesh, "a plugin makes it", span=span)
            raise UnusableValue
        said = {name: text for name in SAID if (text := editing.classes.effective(mesh, None, name))}
        file = mesh.get("file")
        content, suffix = None, ""
        if file:
            content = _content(editing, mesh, str(file), context=self.context)
            suffix = os.path.splitext(str(file))[1]
            said["file"] = digest(content) + suffix.lower()
        called = editing.called(mesh)
        return MeshJob(mesh, called, said, content=content, suffix=suffix, method=method, wanted=wanted, span=span)

    def results(self, editing: Editing, jobs: Sequence[MeshJob]) -> dict[str, dict[str, Any]] | None:
        """Return the results by key; None if the workshop may not work now. Raises UnusableValue for an error."""
        errors = editing.sink.error_count
        by_key = {job.key: job for job in reversed(jobs)}
        stored = {key: self.store.find(key, by_key[key].span) for key in dict.fromkeys(job.key for job in jobs)}
        results = {key: result for key, result in stored.items() if result is not None}
        missing = [key for key in stored if key not in results]
        if editing.sink.error_count > errors:
            raise UnusableValue
        if missing and not self.makes:
            return None
        if missing:
            with engine.Session(engine.Limits(seconds=in_force().mesh_time)) as session:
                for key in missing:
                    result = self._make(editing, by_key[key], session)
                    if result is not None:
                        self.store.keep(key, result)
                        results[key] = result
                    elif self.stopped:
                        break
        self._doubt(editing, jobs, results)
        if editing.sink.error_count > errors:
            raise UnusableValue
        return results

    def _make(self, editing: Editing, job: MeshJob, session: engine.Session) -> dict[str, Any] | None:
        attributes = dict(job.mesh)
        with scratch("mesh") as folder:
            if job.content is not None:
                file = folder / f"mesh{job.suffix}"
                file.write_bytes(job.content)
                attributes["file"] = str(file)
            most = in_force().mesh_faces
            argument = {"mesh": attributes, "method": job.method, "wanted": job.wanted, "most_faces": most}
            answer = engine.call(session, make, (), argument=argument)
        if not answer.ok:
            self._failed(editing, job, answer.crash, error=answer.error)
            return None
        value = answer.value
        if "missing" in value:
            self.stopped = True
            message = f"`{job.method}` needs the Python package `{value['missing']}`, which is not installed"
            help = 'run `pip install "mjcompose[mesh]"`; locked results need no package'
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
            message = f"`{job.method}` of {job.called} takes longer than {limits.mesh_time:g} s"
            editing.sink.error("limit-exceeded", message, job.span, help=advice("mesh-time"))
        elif crash == "memory":
            message = f"`{job.method}` of {job.called} takes more than {limits.memory / GIB:.3g} GiB of memory"
            editing.sink.error("limit-exceeded", message, job.span, help=advice("memory"))
        else:
            self.stopped = crash in ("missing", "start")
            words = " ".join((error or crash or "").split())
            code = "mujoco-missing" if crash == "missing" else "mesh-unusable"
            editing.sink.error(code, f"`{job.method}` of {job.called} failed: {words}", job.span)

    def _unusable(self, editing: Editing, mesh: Node, why: str, span: Span, limit: str | None = None) -> None:
        code, help = ("limit-exceeded", advice(limit)) if limit else ("mesh-unusable", None)
        message = f"{editing.called(mesh)} cannot be used: {why}"
        notes = (Note(f"{editing.called(mesh)} is written here", editing.span_of(mesh)),)
        editing.sink.error(code, message, span, notes=notes, help=help, subjects=editing.subjects(mesh))

    def _doubt(self, editing: Editing, jobs: Sequence[MeshJob], results: dict[str, dict[str, Any]]) -> None:
        """Warn of meshes that are probably wrong. A flat mesh is an error before: it gives no shape."""
        # The greatest distance of a body from its parent, in meters.
        places = [numbers.read(body.get("pos") or "0 0 0") for body in editing.root.iter("body")]
        lengths = [math.dist((0, 0, 0), place) for place in places if len(place) == 3]
        reach = max((length for length in lengths if math.isfinite(length)), default=0.0)
        for each in {job.node: job for job in jobs if job.key in results}.values():
            mesh = results[each.key]["mesh"]
            facts = Measured(float(mesh["size"]), is_closed=mesh["closed"])
            inside = "`decompose` fills its inside as well as it can" if each.method == "decompose" else None
            for doubt in doubts(facts, reach, inside=inside):
                help = _OPEN
                if doubt.kind != "open":
                    scale = numbers.read(each.mesh.get("scale", "1 1 1"))
                    # Doubled braces are single braces in the text.
                    entry = (
                        f"{{{{select: {{{{mesh: {word(name_of(each.node) or '')}}}}}, set: {{{{scale: [{{}}]}}}}}}}}"
                    )
                    help = doubt.advice(scale, entry, ", ")
                place = editing.span_of(each.node)
                cause = Cause(f"{doubt.kind} meshes of {each.span}", f"{each.called} ({place})")
                message = f"{each.called} {doubt.what}"
                notes = [Note(f"{each.called} is written here", place)]
                editing.sink.warning(doubt.code, message, each.span, help=help, cause=cause, notes=notes)


def _content(editing: Editing, mesh: Node, file: str, context: Context) -> bytes:
    """Return the bytes of a mesh's file. Raises UnusableValue if they are unreadable, which is reported."""
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
            raise UnusableValue from None
    content = read(unit, use, editing.sink, shown=context.shown)
    if content is None:
        raise UnusableValue
    return content
