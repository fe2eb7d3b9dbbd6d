"""Verbs `collision` and `simplify`: collision shapes for meshes, and meshes with fewer faces.

New geoms, which have no mass, collide instead of the geom of a mesh, which stays visible and keeps its mass.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from mjcompose.base.access import held
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.naming import portable_path, portable_step
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN, Pose
from mjcompose.compose.editing import Editing
from mjcompose.compose.mesh_jobs import MeshJob, MeshResult, MeshWorkshop
from mjcompose.compose.values import report_unusable
from mjcompose.link import numbers
from mjcompose.link.files import ASSETS
from mjcompose.link.inertia import has_mass
from mjcompose.link.linking import FileUse
from mjcompose.link.numbers import read_pose
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS, childclass_of, own
from mjcompose.tree.edit import assign, changing, referrers
from mjcompose.tree.files import written_path
from mjcompose.tree.select import name_of, section_of

if TYPE_CHECKING:
    from mjcompose.language.verbs.collision import Collision

_NEUTRAL = {"scale": "1 1 1", "refpos": "0 0 0", "refquat": "1 0 0 0"}
_FILE_NAME = re.compile(r"[^\w.+-]")


def to_obj(shape: Mapping[str, Any]) -> bytes:
    r"""Return vertices and faces as an OBJ file.

    >>> to_obj({"vertices": [[0, 0, 0], [1, 0, 0.5], [0, 1, 0]], "faces": [[0, 1, 2]]}).decode()
    'v 0 0 0\nv 1 0 0.5\nv 0 1 0\nf 1 2 3\n'
    """
    lines = [f"v {' '.join(f'{each:.7g}' for each in vertex)}" for vertex in shape["vertices"]]
    lines += [f"f {' '.join(str(corner + 1) for corner in face)}" for face in shape["faces"]]
    return ("\n".join(lines) + "\n").encode()


def write_file(editing: Editing, mesh: Node, name: str, key: str, shape: Mapping[str, Any]) -> None:
    """Give a mesh the shape as its file, and cancel the scale and pose that its class may have."""
    linking = editing.linking
    unit = editing.linking.base
    content = to_obj(shape)
    for attribute in (*_NEUTRAL, "content_type", "vertex", "normal", "texcoord", "face", "builtin", "params"):
        journal.drop(mesh, attribute)
    for attribute, neutral in _NEUTRAL.items():
        if (editing.effective(mesh, attribute) or neutral).split() != neutral.split():
            journal.write(mesh, attribute, neutral)
    linking.files = [use for use in linking.files if use.element is not mesh]
    # The key makes the name differ from every file that the model has.
    if editing.own:
        file = portable_step(f"{_FILE_NAME.sub('_', name)}.{key[:8]}.obj")
        journal.write(mesh, "file", file)
        unit.contents = {**unit.contents, written_path(unit.settings, mesh, file): content}
        return
    *names, last = [_FILE_NAME.sub("_", each) for each in name.split("/")]
    folders = filter(None, (each.strip(".") for each in names))
    path = portable_path("/".join([ASSETS, *folders, f"{last}.{key[:8]}.obj"]))
    journal.write(mesh, "file", path)
    linking.files.append(FileUse(mesh, "file", path, source=held(os.path.join(unit.directory, path)), content=content))


_TAKEN = (
    "condim",
    "priority",
    "friction",
    "solmix",
    "solref",
    "solimp",
    "margin",
    "gap",
    "surfacevel",
    "adhesion",
)
"""The new geoms have these attributes and the class of the old geom."""
_UNSEEN = 3
"""MuJoCo's viewers show the groups 0 to 2 by default."""
_SUFFIXES = {"hull": "hull", "decompose": "part", "spheres": "sphere"}


def make_collision_geoms(
    editing: Editing, workshop: MeshWorkshop, found: list[Node], how: Collision, at: Path
) -> list[MeshResult]:
    """Make the geoms and return the results; none if the workshop may not work now."""
    jobs: list[tuple[Node, MeshJob]] = []
    for node in found:
        mesh = _mesh_of(editing, node, at)
        _check_free(editing, node, at)
        jobs.append((node, workshop.job_for(editing, mesh, how.method, wanted=how.wanted, span=editing.span(at))))
    if (results := workshop.results(editing, [job for _, job in jobs])) is None:
        return []
    meshes: dict[tuple[str, int], str] = {}
    records = [
        _collision_result(editing, node, job, result=results[job.key], meshes=meshes, at=at) for node, job in jobs
    ]
    workshop.records += records
    return records


def _mesh_of(editing: Editing, node: Node, at: Path) -> Node:
    type = editing.effective(node, "type") or "sphere"
    name = editing.effective(node, "mesh")
    if type != "mesh" or not name:
        is_shape = type in ("box", "sphere", "capsule", "cylinder", "ellipsoid") and not name
        reason = f"it is a {type} already" if is_shape else f"it is of type `{type}`"
        help = "select only the geoms of meshes: `where: {type: mesh}`"
        message = f"{editing.called(node)} has no mesh to start from: {reason}"
        report_unusable(editing, node, Fault("wrong-type", message, at, help=help))
    ends = numbers.read(editing.effective(node, "fromto") or "")
    if node.get("mesh") is None or (ends and not any(map(math.isnan, ends))):
        inherited = "its mesh" if node.get("mesh") is None else "`fromto`"
        message = f"a class gives {editing.called(node)} {inherited}, and would give it to the new geoms too"
        report_unusable(editing, node, Fault("not-supported", message, at, help="write it on the geoms"))
    return _named_mesh(editing, node, str(name), at=at)


def _named_mesh(editing: Editing, node: Node, name: str, at: Path) -> Node:
    if (mesh := editing.find_node("mesh", name)) is None:
        message = f"the mesh `{name}` of {editing.called(node)} does not exist"
        report_unusable(editing, node, Fault("unknown-name", message, at))
    return mesh


def _check_free(editing: Editing, node: Node, at: Path) -> None:
    """Report contact pairs and contact sensors of a geom that will have no contacts."""
    name = name_of(node)
    nodes = [each.node for each in referrers(editing, "geom", name)] if name else []
    users = [each for each in nodes if each.tag == "pair" or (each.tag == "contact" and section_of(each) == "sensor")]
    if users:
        notes = tuple(Note(f"{editing.called(user)} names it", editing.span_of(user)) for user in users)
        message = f"{editing.called(node)} cannot have other collision shapes: elements refer to its contacts"
        help = "remove these elements, or select other geoms"
        report_unusable(editing, node, Fault("still-referred-to", message, at, notes=notes, help=help))


def _collision_result(
    editing: Editing, node: Node, job: MeshJob, result: dict[str, Any], meshes: dict[tuple[str, int], str], at: Path
) -> MeshResult:
    mesh_name = name_of(job.node) or ""
    shapes = result["shapes"]
    many = len(shapes) > 1 or job.method in ("decompose", "spheres")
    pose = _pose(editing, node)
    geoms = []
    for number, shape in enumerate(shapes):
        suffix = _SUFFIXES.get(job.method, shape["type"])
        end = f"_{suffix}{number:0{len(str(len(shapes) - 1))}d}" if many else f"_{suffix}"
        geom = node.makeelement("geom")
        journal.write(geom, "name", _free(editing, "geom", f"{name_of(node) or mesh_name}{end}"))
        if shape["type"] == "mesh":
            if (known := meshes.get((job.key, number))) is None:
                known = meshes[job.key, number] = _new_mesh(editing, job, f"{mesh_name}{end}", shape=shape, at=at)
            _write(editing, node, geom, given={"type": "mesh", "mesh": known}, pose=pose)
        else:
            own = Pose(tuple(shape["pos"]), tuple(shape["quat"]))
            given = {"type": shape["type"], "size": numbers.text(shape["size"])}
            _write(editing, node, geom, given=given, pose=pose @ own)
        geoms.append(geom)
    parent = node.getparent()
    assert parent is not None
    for index, geom in enumerate(geoms, parent.index(node) + 1):
        journal.place(parent, geom, index)
        _leave_out(editing, geom)
        editing.making.origins.own(geom, editing.span(at))
        editing.note(geom)
    assign(editing, node, {"contype": "0", "conaffinity": "0"})
    editing.write(node, {"contype": at, "conaffinity": at})
    names = tuple(name_of(geom) or "" for geom in geoms)
    about = job.shapes_of(name_of(node) or "", result, shapes=names, faces=result["mesh"]["faces"])
    return MeshResult(node, job.node, tuple(geoms), about=about)


def _write(editing: Editing, old: Node, geom: Node, given: Mapping[str, str], pose: Pose) -> None:
    """Write the attributes of a new geom, except for those that depend on its class."""
    if old.get("class"):
        journal.write(geom, "class", str(old.get("class")))
    journal.write_all(geom, given)
    if pose.pos != ORIGIN:
        journal.write(geom, "pos", numbers.text(pose.pos))
    if pose.quat != IDENTITY_QUAT:
        journal.write(geom, "quat", numbers.text(pose.quat))
    contype, conaffinity = (numbers.integer(editing.effective(old, name) or "1") for name in ("contype", "conaffinity"))
    if not contype and not conaffinity:
        contype = conaffinity = 1  # the old geom was only visible; the new geoms collide as MuJoCo's geoms do
    journal.write(geom, "contype", str(contype))
    journal.write(geom, "conaffinity", str(conaffinity))
    journal.write(geom, "group", str(max(_UNSEEN, numbers.integer(editing.effective(old, "group") or "0"))))
    journal.write(geom, "mass", "0")
    journal.write_all(geom, {name: str(old.get(name)) for name in _TAKEN if old.get(name)})


def _leave_out(editing: Editing, geom: Node) -> None:
    """Cancel attributes of the class that the shape does not have, and remove MuJoCo's own defaults."""
    classes = editing.classes
    childclass = childclass_of(geom)
    if geom.get("pos") is None and numbers.read(classes.effective(geom, childclass, "pos") or "0") != [0.0] * 3:
        journal.write(geom, "pos", "0 0 0")
    if geom.get("quat") is None and _orientation(editing, geom) is not None:
        journal.write(geom, "quat", "1 0 0 0")
    if (editing.effective(geom, "fluidshape") or "none") != "none":
        journal.write(geom, "fluidshape", "none")
    for name in ("contype", "conaffinity"):
        text = str(journal.drop(geom, name))
        if numbers.integer(editing.effective(geom, name) or "1") != int(text):
            journal.write(geom, name, text)


def _pose(editing: Editing, node: Node) -> Pose:
    """Return the pose of a geom in its body, with the attributes of its class."""
    given = {name: str(node.get(name)) for name in ("pos", *ORIENTATIONS) if node.get(name)}
    if "pos" not in given and (pos := editing.effective(node, "pos")):
        given["pos"] = pos
    turned = _orientation(editing, node)
    if turned is not None and given.keys().isdisjoint(ORIENTATIONS):
        given[turned[0]] = turned[1]
    making = editing.making
    return read_pose(given, making.model_angle == "degree", making.model_eulerseq)


def _orientation(editing: Editing, node: Node) -> tuple[str, str] | None:
    name = node.get("class") or childclass_of(node)
    dclass = editing.classes.get(str(name) if name else None)
    return None if dclass is None else dclass.orientation("geom")


def _new_mesh(editing: Editing, job: MeshJob, name: str, shape: Mapping[str, Any], at: Path) -> str:
    free = _free(editing, "mesh", name)
    section = job.node.getparent()
    assert section is not None
    mesh = section.makeelement("mesh", {"name": free})
    journal.place(section, mesh)
    write_file(editing, mesh, free, key=job.key, shape=shape)
    # A thin piece has too little volume for MuJoCo's inertia; the geoms have no mass anyway.
    journal.write(mesh, "inertia", "shell")
    editing.making.origins.own(mesh, editing.span(at))
    editing.note(mesh)
    return free


def _free(editing: Editing, namespace: str, name: str) -> str:
    """Return the name, with a number if it is taken."""
    free = name
    number = 1
    while editing.find_node(namespace, free) is not None:
        number += 1
        free = f"{name}_{number}"
    return free


def simplify_meshes(
    editing: Editing, workshop: MeshWorkshop, found: list[Node], faces: int, at: Path
) -> list[MeshResult]:
    """Give the meshes fewer faces. A mesh that has no more than that stays as it is."""
    jobs: list[MeshJob] = []
    for mesh in dict.fromkeys(_mesh(editing, node, at) for node in found):
        for geom in _geoms(editing, name_of(mesh) or ""):
            body = next(geom.iterancestors("body"), None)
            if body is None or not has_mass(geom, editing.classes):
                continue
            if not own(body, "inertial") or editing.linking.flat().settings.inertiafromgeom == "true":
                reason = f"the inertia of {editing.called(body)} depends on it"
                message = f"{editing.called(mesh)} cannot be simplified: {reason}"
                help = "write the `inertial` of the body, or give the geom `mass: 0` if another geom has its mass"
                report_unusable(editing, geom, Fault("mesh-unusable", message, at, help=help))
        jobs.append(workshop.job_for(editing, mesh, "simplify", wanted={"faces": faces}, span=editing.span(at)))
    if (results := workshop.results(editing, jobs)) is None:
        return []
    for job in jobs:
        _check_textures(editing, job.node, results[job.key], at=at)
    records = [_simplify_result(editing, job, results[job.key], at=at) for job in jobs]
    workshop.records += records
    return records


def _mesh(editing: Editing, node: Node, at: Path) -> Node:
    if node.tag == "mesh":
        return node
    if not (name := editing.effective(node, "mesh") if node.tag == "geom" else None):
        report_unusable(editing, node, Fault("wrong-type", f"{editing.called(node)} has no mesh to simplify", at))
    return _named_mesh(editing, node, str(name), at=at)


def _geoms(editing: Editing, mesh: str) -> Iterator[Node]:
    geoms = (geom for section in editing.root.iterchildren("worldbody") for geom in section.iter("geom"))
    yield from (geom for geom in geoms if editing.effective(geom, "mesh") == mesh)


def _check_textures(editing: Editing, mesh: Node, result: Mapping[str, Any], at: Path) -> None:
    """Report a texture that cannot be mapped to fewer faces."""
    if not result["mesh"]["mapped"]:
        return
    for geom in _geoms(editing, name_of(mesh) or ""):
        name = editing.effective(geom, "material") or mesh.get("material")
        material = editing.find_node("material", str(name)) if name else None
        if material is not None and (material.get("texture") or len(material)):
            message = f"{editing.called(mesh)} cannot be simplified: it maps the texture of `{name}`"
            help = "select the meshes of geoms without a texture"
            report_unusable(editing, geom, Fault("mesh-unusable", message, at, help=help))


def _simplify_result(editing: Editing, job: MeshJob, result: Mapping[str, Any], at: Path) -> MeshResult:
    mesh = job.node
    name = name_of(job.node) or ""
    shape = result["shapes"][0]
    about = job.shapes_of("", result, shapes=(), faces=len(shape["faces"]))
    if len(shape["faces"]) < result["mesh"]["faces"]:
        with changing(editing, mesh):
            if not mesh.get("name"):
                journal.write(mesh, "name", name)
            write_file(editing, mesh, name, key=job.key, shape=shape)
        editing.write(mesh, {"file": at})
    return MeshResult(mesh, mesh, (), about=about)
