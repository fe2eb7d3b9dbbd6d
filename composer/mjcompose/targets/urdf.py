"""A model as a ROS package with URDF, `ros2_control` and SRDF."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.targets.plain import simple_actuators, text
from mjcompose.targets.restrictions import greatest_force
from mjcompose.targets.same import Pose, about, joined, pose, shifted
from mjcompose.targets.target import Draft, FeatureOutcome

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def origin(of: Pose) -> Node:
    return etree.Element("origin", xyz=text(_clean(of[0])), rpy=text(_clean(angles(of[1]))))


def angles(turned: Any) -> Any:
    """Return roll, pitch and yaw (rad) of a rotation matrix, shape (3,).

    >>> [round(float(each), 6) for each in angles([[0, -1, 0], [1, 0, 0], [0, 0, 1]])]
    [0.0, 0.0, 1.570796]
    """
    level = math.hypot(turned[0][0], turned[1][0])
    pitch = math.atan2(-turned[2][0], level)
    if level < 1e-9:  # looks straight up or down: yaw and roll are about one axis
        return np.array([math.atan2(-turned[1][2], turned[1][1]), pitch, 0.0])
    return np.array([math.atan2(turned[2][1], turned[2][2]), pitch, math.atan2(turned[1][0], turned[0][0])])


def _clean(values: Any) -> Any:
    return np.where(np.abs(values) < 1e-16, 0.0, values)


_SHOWN_GROUPS = 3
"""MuJoCo shows the groups 0, 1 and 2; shapes that only collide are in others by convention."""


def link(draft: Draft, body: int, name: str, package: str) -> Node:
    found = etree.Element("link", name=name)
    if body:
        found.append(_inertial(draft.model, body))
    for number, geom in draft.of_body("geom", body):
        _shapes(draft, number, geom, into=found, package=package)
    return found


# The mass (kg) and moment (kg·m²) of a link that moves and weighs nothing: MuJoCo needs more than 1e-14.
_MASS = "1e-9"
_MOMENT = "1e-12"


def massless(name: str, *, moves: bool = False) -> Node:
    """Return a link that only connects joints.

    Its inertia is written as zero: some programs give a link without inertia a mass of their own. If the link `moves`,
    its inertia is negligible, but not zero, which MuJoCo refuses.
    """
    found = etree.Element("link", name=name)
    inertial = etree.SubElement(found, "inertial")
    etree.SubElement(inertial, "mass", value=_MASS if moves else "0")
    moments = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")
    if moves:
        moments |= dict.fromkeys(("ixx", "iyy", "izz"), _MOMENT)
    etree.SubElement(inertial, "inertia", moments)
    return found


def _inertial(model: MjModel, body: int) -> Node:
    found = etree.Element("inertial")
    found.append(origin(shifted(model.body_ipos[body])))
    etree.SubElement(found, "mass", value=text(model.body_mass[body]))
    axes = pose((0, 0, 0), model.body_iquat[body])[1]
    matrix = axes @ np.diag(model.body_inertia[body]) @ axes.T
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    etree.SubElement(found, "inertia", {name: text(matrix[at]) for name, at in places.items()})
    return found


def _shapes(draft: Draft, number: int, geom: Node, into: Node, package: str) -> None:
    model = draft.model
    kinds = ["visual"] if int(model.geom_group[number]) < _SHOWN_GROUPS else []
    kinds += ["collision"] if model.geom_contype[number] or model.geom_conaffinity[number] else []
    where = pose(model.geom_pos[number], model.geom_quat[number])
    shapes = list(_geometry(draft, number, geom, package=package))
    if not shapes:
        draft.lose("shapes", geom, what=f"the {'height field' if geom.get('type') == 'hfield' else geom.get('type')}")
    for kind in kinds:
        for at, shape in shapes:
            holder = etree.SubElement(into, kind)
            holder.append(origin(joined(where, at)))
            etree.SubElement(holder, "geometry").append(etree.fromstring(etree.tostring(shape)))
            if kind == "visual":
                color = model.geom_rgba[number]
                at_material = int(model.geom_matid[number])
                if at_material >= 0 and np.allclose(color, (0.5, 0.5, 0.5, 1)):  # MuJoCo's default
                    color = model.mat_rgba[at_material]
                material = etree.SubElement(holder, "material", name=f"{into.get('name')}_{number}")
                etree.SubElement(material, "color", rgba=text(color))


def _geometry(draft: Draft, number: int, geom: Node, package: str) -> Iterator[tuple[Pose, Node]]:
    size = draft.model.geom_size[number]
    kind = geom.get("type")
    here = shifted((0, 0, 0))
    if kind == "box":
        yield here, etree.Element("box", size=text(2 * size))
    elif kind == "sphere":
        yield here, etree.Element("sphere", radius=text(size[0]))
    elif kind in ("cylinder", "capsule"):
        yield here, etree.Element("cylinder", radius=text(size[0]), length=text(2 * size[1]))
        if kind == "capsule":  # URDF has no capsules
            for end in (size[1], -size[1]):
                yield shifted((0, 0, end)), etree.Element("sphere", radius=text(size[0]))
    elif kind == "mesh":
        meshes = draft.root.iterfind("asset/mesh")
        file = next(each.get("file") for each in meshes if each.get("name") == geom.get("mesh"))
        yield here, etree.Element("mesh", filename=f"package://{package}/{file}")


NO_LIMIT = "1000000"
"""URDF needs a number even if MuJoCo has no limit."""
_FREE = 0
_SLIDE = 2  # mjJNT_FREE, mjJNT_SLIDE


def hung(draft: Draft, body: int, name: str, parent: str) -> Iterator[Node]:
    """Yield the joints between a body and its parent, and the links between them."""
    model = draft.model
    joints = list(draft.of_body("joint", body))
    stands = pose(model.body_pos[body], model.body_quat[body])
    if not joints:
        yield fixed(f"{name}_fixed", parent, name, frame=stands)
        return
    last = np.zeros(3)
    for at, (number, node) in enumerate(joints):
        called = str(node.get("name") or f"{name}_joint{at or ''}")
        if int(model.jnt_type[number]) == _FREE:
            yield _joint(called, "floating", parent, child=name, frame=stands)
            return
        anchor = np.asarray(model.jnt_pos[number], dtype=float)
        ends = at == len(joints) - 1 and not anchor.any()
        child = name if ends else f"{name}__{called}"
        # URDF has the frame at the zero of a joint, not at its reference.
        back = -float(model.qpos0[model.jnt_qposadr[number]])
        axis = model.jnt_axis[number]
        slides = int(model.jnt_type[number]) == _SLIDE
        frame = joined(stands, shifted(anchor - last), shifted(back * axis) if slides else about(axis, back))
        kind = "prismatic" if slides else "revolute" if model.jnt_limited[number] else "continuous"
        found = _joint(called, kind, parent, child=child, frame=frame)
        _motion(draft, number, node, joint=found)
        yield found
        if not ends:
            yield massless(child, moves=True)
        parent = child
        last = anchor
        stands = shifted((0, 0, 0))
    if last.any():
        yield fixed(f"{name}_fixed", parent, name, frame=shifted(-last))


def fixed(name: str, parent: str, child: str, frame: Pose) -> Node:
    return _joint(name, "fixed", parent, child=child, frame=frame)


def _joint(name: str, kind: str, parent: str, child: str, frame: Pose) -> Node:
    found = etree.Element("joint", name=name, type=kind)
    found.append(origin(frame))
    etree.SubElement(found, "parent", link=parent)
    etree.SubElement(found, "child", link=child)
    return found


def _motion(draft: Draft, number: int, node: Node, joint: Node) -> None:
    model = draft.model
    dof = int(model.jnt_dofadr[number])
    etree.SubElement(joint, "axis", xyz=text(model.jnt_axis[number]))
    most = greatest_force(model, number)
    limit = etree.SubElement(joint, "limit", effort=NO_LIMIT if most is None else text(most), velocity=NO_LIMIT)
    if model.jnt_limited[number]:
        low, high = model.jnt_range[number]
        limit.set("lower", text(low))
        limit.set("upper", text(high))
    elif joint.get("type") == "prismatic":
        limit.set("lower", f"-{NO_LIMIT}")
        limit.set("upper", NO_LIMIT)
    damping = text(model.dof_damping[dof])
    friction = text(model.dof_frictionloss[dof])
    etree.SubElement(joint, "dynamics", damping=damping, friction=friction)
    if model.dof_armature[dof]:
        draft.lose("armature", node, what="armature")


def mimics(draft: Draft, joints: dict[str, Node]) -> None:
    """Write proportional constraints as `<mimic>`. Other equality constraints are recorded as losses."""
    model = draft.model
    for number, node in list(draft.of("equality")):
        leader = str(node.get("joint2") or "")
        follower = str(node.get("joint1") or "")
        polynomial = model.eq_data[number][:5]
        if node.tag != "joint" or leader not in joints or follower not in joints:
            draft.lose("equality", node, "what they couple moves freely")
        elif polynomial[2:].any():
            draft.lose("equality", node, "a joint follows another in proportion only")
        elif not model.eq_active0[number]:
            draft.lose("equality", node, "they are not active at the start, and nothing can switch them on")
        elif joints[follower].find("mimic") is not None:
            draft.lose("equality", node, "a joint follows one other")
        else:
            ids = model.eq_obj1id[number], model.eq_obj2id[number]
            zeros = [float(model.qpos0[model.jnt_qposadr[each]]) for each in ids]
            factor = polynomial[1]
            offset = zeros[0] + polynomial[0] - polynomial[1] * zeros[1]
            etree.SubElement(joints[follower], "mimic", joint=leader, multiplier=text(factor), offset=text(offset))


_INTERFACE = {"motor": "effort", "position": "position", "velocity": "velocity"}
_GAINS = {"position": {"kp": "kp", "kv": "kd"}, "velocity": {"kv": "kv"}}
"""By the tag of a servo: the names of its gains in MJCF, and in a `<param>` of the joint."""
_PLUGIN = "mock_components/GenericSystem"
"""The system that `ros2_control` has for tests; a robot puts its own there."""


def control(draft: Draft, joints: dict[str, Node]) -> Node | None:
    """Return the element, or None if no joint has an actuator.

    The limits of the target have written controls and gains at the joints, and left one actuator for each.
    """
    found = etree.Element("ros2_control", name=str(draft.root.get("model") or "model"), type="system")
    etree.SubElement(etree.SubElement(found, "hardware"), "plugin").text = _PLUGIN
    for number, node in list(draft.of("actuator")):
        name = str(node.get("joint"))
        tag = str(node.tag)
        if name not in joints:
            draft.lose("actuators", node, "their joints are not in this URDF")
            continue
        if node.get("name") != name:
            draft.lose(
                "actuators", node, "their controls have the names of their joints", outcome=FeatureOutcome.WRITTEN
            )
        joint = etree.SubElement(found, "joint", name=name)
        command = etree.SubElement(joint, "command_interface", name=_INTERFACE[tag])
        if draft.model.actuator_ctrllimited[number]:
            for side, end in zip(("min", "max"), str(node.get("ctrlrange")).split(), strict=True):
                etree.SubElement(command, "param", name=side).text = end
        for attribute, param in _GAINS.get(tag, {}).items():
            if node.get(attribute):
                etree.SubElement(joint, "param", name=param).text = str(node.get(attribute))
    for joint in found.iterchildren("joint"):
        for each in ("position", "velocity", "effort"):
            etree.SubElement(joint, "state_interface", name=each)
    return found if found.find("joint") is not None else None


GROUP = "all"
_MOVABLE = ("revolute", "continuous", "prismatic")


def semantics(draft: Draft, name: str, names: list[str], joints: dict[str, Node]) -> bytes:
    """Return the SRDF file of the robot `name`. `names` has the name of the link of each body."""
    model = draft.model
    root = etree.Element("robot", name=name)
    # A mapping, as an ordered set of names.
    movable = dict.fromkeys(name for name, joint in joints.items() if joint.get("type") in _MOVABLE)
    if movable:
        group = etree.SubElement(root, "group", name=GROUP)
        for each in movable:
            etree.SubElement(group, "joint", name=each)
    for number, key in draft.of("key"):
        _lose_of_key(draft, number, key)
        state = etree.SubElement(root, "group_state", name=str(key.get("name") or f"key{number}"), group=GROUP)
        for joint, node in draft.of("joint"):
            if node.get("name") in movable:
                value = model.key_qpos[number][model.jnt_qposadr[joint]]
                etree.SubElement(state, "joint", name=str(node.get("name")), value=text(value))
    apart = [(int(model.body_parentid[body]), body, "Adjacent") for body in range(1, model.nbody)]
    apart += [(each >> 16, each & 0xFFFF, "Excluded in MuJoCo") for each in model.exclude_signature.tolist()]
    for first, second, reason in apart:
        if first and second:
            etree.SubElement(root, "disable_collisions", link1=names[first], link2=names[second], reason=reason)
    return write_xml(root)


_OF_KEYS = {"qvel": "velocities", "act": "activations", "ctrl": "controls"}


def _lose_of_key(draft: Draft, number: int, key: Node) -> None:
    """Record the numbers of a key that a `group_state`, which has the positions of joints, does not have."""
    model = draft.model
    lost = [words for array, words in _OF_KEYS.items() if getattr(model, f"key_{array}")[number].any()]
    lost += ["poses of free bodies"] if (model.jnt_type == _FREE).any() else []
    if lost:
        draft.lose("keys", key, "a `group_state` has the positions of joints", what=" and ".join(lost))


WORLD = "world"
_NOT_IN_PACKAGES = re.compile(r"[^a-z0-9_]+")
_PACKAGE = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>{title}, written by mjcompose</description>
  <maintainer email="nobody@example.org">nobody</maintainer>
  <license>see LICENSES</license>
{depends}  <export><build_type>ament_cmake</build_type></export>
</package>
"""
_CMAKE = """cmake_minimum_required(VERSION 3.8)
project({name})
find_package(ament_cmake REQUIRED)
install(FILES {files} DESTINATION share/${{PROJECT_NAME}})
install(DIRECTORY assets DESTINATION share/${{PROJECT_NAME}} OPTIONAL)
{folders}ament_package()
"""


def ros_package(
    draft: Draft, files: Sequence[str], *, folders: Sequence[str] = (), depends: Iterable[tuple[str, str]] = ()
) -> dict[str, bytes]:
    """Return the files that make a ROS package of `files`, `folders` and the meshes, by path.

    `depends` has the tags and the names of packages that it needs.
    """
    name = package_name(title(draft))
    needed = "".join(f"  <{tag}>{package}</{tag}>\n" for tag, package in depends)
    more = f"install(DIRECTORY {' '.join(folders)} DESTINATION share/${{PROJECT_NAME}})\n" if folders else ""
    return {
        "package.xml": _PACKAGE.format(name=name, title=escape(title(draft)), depends=needed).encode(),
        "CMakeLists.txt": _CMAKE.format(name=name, files=" ".join(files), folders=more).encode(),
    }


class RobotDescription(Struct):
    """A model as URDF: the robot, its joints by name, and the name of the link of each body."""

    robot: Node
    joints: dict[str, Node]
    links: list[str]


def description(draft: Draft, package: str) -> RobotDescription:
    """Return the links and joints of a model, with meshes under `package://`, and without `ros2_control`."""
    model = draft.model
    bodies = draft.elements["body"]
    names = [WORLD, *(str(body.get("name") or f"body{number}") for number, body in enumerate(bodies) if number)]
    robot = etree.Element("robot", name=title(draft))
    joints: dict[str, Node] = {}
    links = [link(draft, number, name, package=package) for number, name in enumerate(names)]
    root = 1 if _is_floating(model) else 0
    if root:
        _lose_world(draft)
    for number in range(root, len(names)):
        robot.append(links[number])
        if number == root:
            continue
        for element in hung(draft, number, names[number], parent=names[int(model.body_parentid[number])]):
            robot.append(element)
            if element.tag == "joint":
                joints[str(element.get("name"))] = element
    robot.extend(_sites(draft, names, root))
    mimics(draft, joints)
    return RobotDescription(robot, joints, names)


def title(draft: Draft) -> str:
    return str(draft.root.get("model") or "model")


def write_xml(root: Node) -> bytes:
    etree.indent(root)
    return etree.tostring(root, xml_declaration=True, encoding="utf-8") + b"\n"


def meshes(draft: Draft) -> dict[str, bytes]:
    return {path: content for path, content in draft.files.items() if path.endswith(".obj")}


def write_urdf(draft: Draft) -> dict[str, bytes]:
    """Return `model.urdf`, `model.srdf`, the meshes and the files of a ROS package, by path."""
    draft.output = "model.urdf"
    simple_actuators(draft.root, any_input=True)
    package = package_name(title(draft))
    described = description(draft, package)
    system = control(draft, described.joints)
    if system is not None:
        described.robot.append(system)
    return {
        draft.output: write_xml(described.robot),
        "model.srdf": semantics(draft, title(draft), described.links, joints=described.joints),
        **ros_package(draft, ["model.urdf", "model.srdf"]),
        **meshes(draft),
    }


def _is_floating(model: MjModel) -> bool:
    """Return whether the only body in the world moves freely: it is the root of the URDF, and there is no world."""
    if model.nbody < 2 or (model.body_parentid[2:] == 0).any() or model.body_jntnum[1] != 1:
        return False
    return bool(model.jnt_type[model.body_jntadr[1]] == _FREE)


def _lose_world(draft: Draft) -> None:
    """Record the losses of a URDF without a world."""
    body = draft.elements["body"][1]
    draft.lose("roots", body, "the root is the body that moves freely, not a world", outcome=FeatureOutcome.WRITTEN)
    for geom in [node for number, node in draft.of("geom") if int(draft.model.geom_bodyid[number]) == 0]:
        draft.lose("shapes", geom, "they are in the world, which is not in this URDF")


def _sites(draft: Draft, names: list[str], root: int) -> Iterator[Node]:
    """Yield a link without mass, and its fixed joint, for each named site of the bodies from `root` on."""
    model = draft.model
    taken = frozenset(names)
    for number, site in draft.of("site"):
        body = int(model.site_bodyid[number])
        if not site.get("name") or body < root:
            continue
        name = f"{site.get('name')}_site" if site.get("name") in taken else str(site.get("name"))
        where = pose(model.site_pos[number], model.site_quat[number])
        yield massless(name)
        yield fixed(f"{name}_fixed", names[body], name, frame=where)


def package_name(title: str) -> str:
    """Return a name that is valid for a ROS package.

    >>> package_name("UR5e + 2F-85")
    'ur5e_2f_85'
    """
    found = _NOT_IN_PACKAGES.sub("_", title.lower()).strip("_")
    return found if found[:1].isalpha() else f"robot_{found}".strip("_")
