"""Rules about missing and unwanted collisions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.lint.rule import ElementEdit, Finding, Found, Subject, rule
from mjcompose.tree.classes import class_in_force

_DEEP = 2e-3
_RESTING = 5e-3
_FINE = 1000
_ICE = 0.02


@rule(
    "overlap",
    "Bodies that start inside each other",
    in_mujoco=True,
    profiles={
        "robot-asset": (
            "NVIDIA SimReady, BA.002: “collision meshes on non-adjacent links must not overlap or intersect”"
        ),
    },
)
def overlap(subject: Subject) -> Found:
    model = subject.model
    is_scene = bool((model.geom_bodyid == 0).any())
    for name, data, node, is_key in _starts(subject):
        found = []
        for one, other, distance in _touching(subject, data):
            bodies = [int(model.geom_bodyid[each]) for each in (one, other)]
            is_robot = model.body_rootid[bodies[0]] == model.body_rootid[bodies[1]]
            above = {int(model.body_weldid[model.body_parentid[model.body_weldid[each]]]) for each in bodies}
            is_base = 0 in above and not all(int(model.body_weldid[each]) for each in bodies)
            if -distance > (_DEEP if is_robot else _RESTING) and (is_key or is_robot) and (is_scene or not is_base):
                found.append((distance, one, other))
        if found:
            distance, one, other = min(found)
            more = f", and {len(found) - 1} more pairs overlap" if len(found) > 1 else ""
            inside = f"is {-distance * 1000:.3g} mm inside {subject.name('geom', other)}{more}"
            message = f"{name}, {subject.name('geom', one)} {inside}"
            yield Finding(subject.node("geom", other) if node is None else node, message)


def _starts(subject: Subject) -> Iterator[tuple[str, Any, Node | None, bool]]:
    model = subject.model
    data = subject.data
    has_key = False
    for row, name, at_key in subject.at_keys():
        node = subject.node("key", row)
        if node is not None or subject.roster.names["key"][row]:  # `nkey` makes empty ones, too
            has_key = True
            yield f"in {name}", at_key, node, True
    single = model.jnt_limited.astype(bool) & (model.jnt_type >= int(subject.mujoco.mjtJoint.mjJNT_SLIDE))
    at = data.qpos[model.jnt_qposadr[single]]
    low, high = model.jnt_range[single].T
    if not has_key and ((low <= at) & (at <= high)).all():
        yield "in the reference configuration", data, None, False


def _touching(subject: Subject, data: Any) -> Iterator[tuple[int, int, float]]:
    weld = subject.model.body_weldid
    bodies = subject.model.geom_bodyid
    for contact in data.contact:
        one, other = map(int, contact.geom)
        if one >= 0 and other >= 0 and not contact.exclude and (weld[bodies[one]] or weld[bodies[other]]):
            yield one, other, float(contact.dist)


@rule("plane-hidden", "A plane below another plane", in_mujoco=True)
def plane_hidden(subject: Subject) -> Found:
    import numpy as np

    model = subject.model
    data = subject.data
    is_plane = model.geom_type == int(subject.mujoco.mjtGeom.mjGEOM_PLANE)
    collides = (model.geom_contype | model.geom_conaffinity) != 0
    planes = np.flatnonzero(is_plane & collides & (model.body_weldid[model.geom_bodyid] == 0)).tolist()
    for lower in planes:
        for upper in planes:
            normal = data.geom_xmat[upper].reshape(3, 3)[:, 2]
            above = float(normal @ (data.geom_xpos[upper] - data.geom_xpos[lower]))
            is_parallel = float(normal @ data.geom_xmat[lower].reshape(3, 3)[:, 2]) > 1 - 1e-6
            bits = all(
                getattr(model, name)[lower] == getattr(model, name)[upper]
                for name in ("geom_contype", "geom_conaffinity")
            )
            if is_parallel and bits and lower != upper and (above > 1e-6 or (abs(above) <= 1e-6 and lower > upper)):
                at = "at the same height as" if abs(above) <= 1e-6 else f"{above:.4g} m below"
                message = f"{subject.name('geom', lower)} is {at} {subject.name('geom', upper)}, an infinite plane"
                yield Finding(subject.node("geom", lower), message, help="remove one of them, or use a box")
                break


def _name(geom: Node) -> str:
    return f"{class_in_force(geom).name or ''} {geom.get('name') or ''}".lower()


@rule("visual-collides", "A visual geom that collides")
def visual_collides(subject: Subject) -> Found:
    if not any("collision" in _name(geom) for geom in subject.each("geom")):
        return
    for geom in subject.each("geom"):
        collides = any((subject.numbers(geom, bits) or [1.0])[0] for bits in ("contype", "conaffinity"))
        if "visual" in _name(geom) and "collision" not in _name(geom) and collides:
            message = f"the class or name of {subject.called(geom)} says that it is visual, but it collides"
            yield Finding(geom, message, help='write `contype="0" conaffinity="0"`')


@rule("collides-with-nothing", "A geom whose bits fit no other geom", in_mujoco=True)
def collides_with_nothing(subject: Subject) -> Found:
    model = subject.model
    bits = list(zip(model.geom_contype.tolist(), model.geom_conaffinity.tolist(), strict=True))
    pairs = {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
    partners = {*bits, (1, 1)}
    for geom, (contype, conaffinity) in enumerate(bits):
        if not contype | conaffinity or geom in pairs:
            continue
        if not any(contype & other or one & conaffinity for one, other in partners):
            name = subject.name("geom", geom)
            message = f"`contype` {contype} and `conaffinity` {conaffinity} of {name} fit no other geom"
            yield Finding(subject.node("geom", geom), message, help="correct `contype` and `conaffinity`")


@rule("hull-too-fine", "A colliding mesh whose convex hull has thousands of vertices", in_mujoco=True)
def hull_too_fine(subject: Subject) -> Found:
    model = subject.model
    is_mesh = model.geom_type == int(subject.mujoco.mjtGeom.mjGEOM_MESH)
    collides = (model.geom_contype | model.geom_conaffinity) != 0
    for mesh in sorted(set(model.geom_dataid[is_mesh & collides].tolist())):
        at = int(model.mesh_graphadr[mesh])
        count = int(model.mesh_graph[at]) if at >= 0 else 0
        if count > _FINE:
            message = f"the convex hull of {subject.name('mesh', mesh)}, which collides, has {count:,} vertices"
            yield Finding(subject.node("mesh", mesh), message, help='write `maxhullvert="64"`')


@rule("geom-twice", "Two colliding geoms of the same shape at the same place", in_mujoco=True)
def geom_twice(subject: Subject) -> Found:
    import numpy as np

    model = subject.model
    seen: dict[bytes, int] = {}
    arrays = ("geom_type", "geom_bodyid", "geom_dataid", "geom_size", "geom_pos", "geom_quat")
    for geom in range(model.ngeom):
        if not model.geom_contype[geom] and not model.geom_conaffinity[geom]:
            continue
        values = np.concatenate([np.round(np.ravel(getattr(model, name)[geom]), 7) for name in arrays]) + 0.0
        first = seen.setdefault(values.tobytes(), geom)
        if first != geom:
            message = f"{subject.name('geom', geom)} is the same as {subject.name('geom', first)}, and both collide"
            yield Finding(subject.node("geom", geom), message, help="remove it, or switch its contacts off")


@rule("exclude-needless", "An `<exclude>` for bodies that never collide", in_mujoco=True)
def exclude_needless(subject: Subject) -> Found:
    if not subject.is_part:
        return
    model = subject.model
    filters = not model.opt.disableflags & int(subject.mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    welded = model.body_weldid.tolist()
    parents = model.body_parentid.tolist()
    seen = set()
    for row, signature in enumerate(model.exclude_signature.tolist()):
        one, other = (welded[each] for each in (signature >> 16, signature & 0xFFFF))
        above = welded[parents[one]], welded[parents[other]]
        node = subject.node("exclude", row)
        why = None
        if one == other:
            why = "they are fixed to each other"
        elif one and other and filters and (above[0] == other or above[1] == one):
            why = "one is the parent of the other"
        elif signature in seen:
            why = "they are excluded twice"
        seen.add(signature)
        if why is not None and node is not None:
            message = f"this `<exclude>` of `{node.get('body1')}` and `{node.get('body2')}` has no effect: {why}"
            yield Finding(node, message, help="remove it", edit=ElementEdit(removes=True))


@rule("frictionless-foot", "A foot that slides on the floor without friction", in_mujoco=True)
def frictionless_foot(subject: Subject) -> Found:
    model = subject.model
    plane = int(subject.mujoco.mjtGeom.mjGEOM_PLANE)
    floors = ((model.geom_type == plane) & (model.geom_bodyid == 0)).nonzero()[0].tolist()
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        words = f"{subject.roster.names['geom'][geom]} {subject.roster.names['body'][body]}".lower()
        if not body or not ("foot" in words or "toe" in words):
            continue
        for floor in floors:
            types = model.geom_contype
            affinities = model.geom_conaffinity
            if not (types[geom] & affinities[floor] or types[floor] & affinities[geom]):
                continue
            first, last = sorted((geom, floor), key=lambda each: int(model.geom_priority[each]))
            pair = (last,) if model.geom_priority[last] > model.geom_priority[first] else (first, last)
            condim = max(int(model.geom_condim[each]) for each in pair)
            friction = max(float(model.geom_friction[each][0]) for each in pair)
            if condim == 1 or friction < _ICE:
                why = "`condim` is 1" if condim == 1 else f"the sliding friction is {friction:.3g}"
                message = f"{subject.name('geom', geom)} slides on {subject.name('geom', floor)}: {why}"
                yield Finding(subject.node("geom", geom), message, help='write `condim="3"`, and `friction`')
