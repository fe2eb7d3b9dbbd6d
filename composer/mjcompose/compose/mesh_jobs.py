"""Work on meshes for the verbs of `edit`: each result comes from a store or from a child process.

Results are stored by content: next to the recipe for everybody, and in the store of this machine. The key of a result
is the hash of the mesh's bytes and attributes, the method and its settings. CoACD may give different pieces on another
machine or in another version, so a result next to the recipe has priority; the lock pins its bytes.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.access import ALL
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import GIB, MIB, advice, in_force
from mjcompose.base.scratch import scratch
from mjcompose.compose.editing import Editing
from mjcompose.compose.values import UnusableValue
from mjcompose.link import numbers
from mjcompose.link.collect import read
from mjcompose.link.linking import FileUse
from mjcompose.mujoco import engine
from mjcompose.plan.plan import GeneratedShapes
from mjcompose.sources import blobs
from mjcompose.sources.blobs import digest
from mjcompose.sources.context import Context
from mjcompose.sources.lock import shapes_folder
from mjcompose.sources.store import store_folder
from mjcompose.text.faults import word
from mjcompose.tree.files import written_path
from mjcompose.tree.select import name_of

FORMAT = 1
"""It changes if the same input must give a different result."""
_MOST = 256 * MIB
_SHAPES = {
    "mesh": ("vertices", "faces"),
    **dict.fromkeys(("box", "sphere", "capsule", "cylinder"), ("size", "pos", "quat")),
}
_ERRORS = ("hausdorff", "beyond", "short", "uncovered", "volume", "samples")


def shapes_key(mesh: dict[str, str], method: str, wanted: Any) -> str:
    """Return the key of a result; `mesh` has the attributes, with the hash of a file's bytes. No I/O."""
    return blobs.key_of([FORMAT, sorted(mesh.items()), method, wanted])


class ShapeStore(Struct, frozen=False):
    """Finds and keeps results. `used` has the bytes of the requested results, by key."""

    context: Context
    used: dict[str, bytes] = field(default_factory=dict)

    def find(self, key: str, span: Span) -> dict[str, Any] | None:
        """Return the result of a key; None without a result, or if the file is broken, which is reported."""
        content = self._beside(key, span) or blobs.get(store_folder(self.context.environment), "shapes", key)
        if content is None:
            return None
        try:
            result = parse_shapes(json.loads(content))
        except (ValueError, RecursionError):
            path = self.path(key)
            message = f"`{self.context.shown(path) if path else key}` is not a collision shape that mjcompose made"
            help = "take it from version control, or remove it and run `mjcompose lock`"
            self.context.sink.error("lock-invalid", message, span, help=help)
            return None
        self.used[key] = content
        return result

    def keep(self, key: str, result: dict[str, Any]) -> None:
        content = (json.dumps(result, separators=(",", ":"), sort_keys=True, allow_nan=False) + "\n").encode()
        self.used[key] = content
        with suppress(OSError):  # it is computed again the next time
            blobs.put(store_folder(self.context.environment), "shapes", key, content=content)

    def path(self, key: str) -> Path | None:
        if (fetching := self.context.fetching) is None or fetching.lock_file is None:
            return None
        return shapes_folder(fetching.lock_file) / f"{key}.json"

    def _beside(self, key: str, span: Span) -> bytes | None:
        """Return the file next to the recipe, and report if it is not in the lock."""
        path = self.path(key)
        fetching = self.context.fetching
        if path is None or fetching is None:
            return None
        content = None
        try:
            content = ALL.read(path, _MOST)
        except (FileNotFoundError, NotADirectoryError):
            pass
        except Refused as refused:
            refused.report(self.context.sink, span, shown=self.context.shown)
        except OSError as error:
            message = f"`{self.context.shown(path)}` cannot be read: {(error.strerror or str(error)).lower()}"
            self.context.sink.error("file-unreadable", message, span)
        if fetching.lock is not None:
            self._compare(key, path, content, pinned=fetching.lock.shapes.get(key), span=span)
        return content

    def _compare(self, key: str, path: Path, content: bytes | None, pinned: str | None, span: Span) -> None:
        fetching = self.context.fetching
        assert fetching is not None
        shown = self.context.shown(path)
        lock = f"the lock `{self.context.shown(fetching.lock_file or path)}`"
        if pinned is None or content is None:
            if fetching.remakes_shapes:
                return
            message = f"{lock} has no entry for the shapes of the mesh"
            if pinned is not None:
                message = f"`{shown}`, which {lock} pins, does not exist"
            report = self.context.sink.error if fetching.locked else self.context.sink.warning
            help = f"run `mjcompose lock {fetching.recipe}` and commit the files that it writes"
            report("lock-stale", message, span, help=help)
        elif digest(content) != pinned:
            help = "take it from version control, or remove it and run `mjcompose lock`"
            self.context.sink.error("source-changed", f"`{shown}` differs from {lock}", span, help=help)


def parse_shapes(data: Any) -> dict[str, Any]:
    """Return the result if it is valid: somebody may have changed the file. Raises ValueError. No I/O."""
    if not isinstance(data, dict) or {*data} != {"shapes", "error", "mesh", "made_with"}:
        raise ValueError("no result")
    shapes = data["shapes"]
    error = data["error"]
    mesh = data["mesh"]
    if not isinstance(shapes, list) or not shapes or not all(map(_is_shape, shapes)):
        raise ValueError("no shapes")
    are_numbers = isinstance(error, dict) and all(value is None or _is_number(value) for value in error.values())
    if not are_numbers or {*error} != {*_ERRORS}:
        raise ValueError("no errors")
    if not isinstance(mesh, dict) or not isinstance(mesh.get("faces"), int) or not _is_number(mesh.get("size")):
        raise ValueError("no mesh")
    if not isinstance(data["made_with"], dict):
        raise ValueError("no versions")
    return data


def _is_shape(shape: Any) -> bool:
    if not isinstance(shape, dict) or shape.get("type") not in _SHAPES:
        return False
    wanted = _SHAPES[shape["type"]]
    if {*shape} != {"type", *wanted}:
        return False
    if shape["type"] == "mesh":
        return _is_mesh(shape["vertices"], shape["faces"])
    widths = ((1, 3), (3, 3), (4, 4))
    return all(
        isinstance(shape[name], list) and low <= len(shape[name]) <= high and all(map(_is_number, shape[name]))
        for name, (low, high) in zip(wanted, widths, strict=True)
    )


def _is_mesh(vertices: Any, faces: Any) -> bool:
    """Return whether the data are vertices and the corners of faces among them."""
    if not isinstance(vertices, list) or not isinstance(faces, list) or len(vertices) < 4 or len(faces) < 4:
        return False
    if not all(isinstance(each, list) and len(each) == 3 for each in (*vertices, *faces)):
        return False
    corners = (corner for face in faces for corner in face)
    return all(_is_number(value) for vertex in vertices for value in vertex) and all(
        type(corner) is int and 0 <= corner < len(vertices) for corner in corners
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def shapes_beside(folder: Path) -> dict[str, Path]:
    """Return the files of results in a folder next to a recipe, by key."""
    try:
        names = os.listdir(folder)
    except OSError:
        return {}
    return {
        name.removesuffix(".json"): folder / name
        for name in sorted(names)
        if name.endswith(".json") and len(name) == 69 and not name.strip("0123456789abcdef.json")
    }


SAID = ("content_type", "vertex", "face", "refpos", "refquat", "scale", "builtin", "params")
"""The attributes of a mesh that decide where its surface is."""


class MeshJob(Struct):
    """Work on one mesh. `mesh` has its attributes with the hash of its file, and `content` is the file."""

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
        """Return the facts about a result; `shapes` are the names of the new geoms."""
        return GeneratedShapes(
            geom,
            name_of(self.node) or "",
            self.method,
            wanted=self.wanted,
            shapes=shapes,
            faces=faces,
            error=result["error"],
            made_with=result["made_with"],
            key=self.key,
            span=self.span,
        )


class MeshResult(Struct, frozen=False):
    """The new geoms, the geom or mesh that they are for, and the facts about them."""

    of: Node
    mesh: Node
    made: tuple[Node, ...]
    about: GeneratedShapes


class MeshWorkshop(Struct, frozen=False):
    """Finds or computes the results. Without `makes` it computes none, and `stopped` says that tools are missing."""

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
        content = None
        suffix = ""
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
            with engine.Session(engine.RequestLimits(seconds=in_force().mesh_time)) as session:
                for key in missing:
                    if (result := self._make(editing, by_key[key], session)) is not None:
                        self.store.keep(key, result)
                        results[key] = result
                    elif self.stopped:
                        break
        self._doubt(editing, jobs, results)
        if editing.sink.error_count > errors:
            raise UnusableValue
        return results

    def _make(self, editing: Editing, job: MeshJob, session: engine.Session) -> dict[str, Any] | None:
        from mjcompose.mujoco.fit import make  # imports numpy

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
        """Warn about meshes that are probably wrong. A flat mesh is an earlier error, because it gives no shape."""
        from mjcompose.mujoco.shapes import SHAPE, MeshMeasurements, doubts  # imports numpy

        # The greatest distance of a body from its parent, in meters.
        places = [numbers.read(body.get("pos") or "0 0 0") for body in editing.root.iter("body")]
        lengths = [math.dist((0, 0, 0), place) for place in places if len(place) == 3]
        reach = max((length for length in lengths if math.isfinite(length)), default=0.0)
        for each in {job.node: job for job in jobs if job.key in results}.values():
            mesh = results[each.key]["mesh"]
            facts = MeshMeasurements(float(mesh["size"]), is_closed=mesh["closed"])
            inside = "`decompose` fills its inside as well as it can" if each.method == "decompose" else None
            for doubt in doubts(facts, reach, inside=inside):
                help = f"look at the pieces, or close the mesh; then write `allow: [{SHAPE}]`"
                if doubt.kind != "open":
                    scale = numbers.read(each.mesh.get("scale", "1 1 1"))
                    name = word(name_of(each.node) or "")
                    # Doubled braces are single braces in the text.
                    entry = f"{{{{select: {{{{mesh: {name}}}}}, set: {{{{scale: [{{}}]}}}}}}}}"
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
    if (content := read(unit, use, editing.sink, shown=context.shown)) is None:
        raise UnusableValue
    return content
