"""Write a draft as a ROS package."""

from __future__ import annotations

import re

from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.loss import Outcome
from composer.targets.plain.actuators import simple_actuators
from composer.targets.poses import pose
from composer.targets.urdf.control import control
from composer.targets.urdf.joints import fixed, hung
from composer.targets.urdf.links import link, massless
from composer.targets.urdf.mimics import mimics
from composer.targets.urdf.semantics import semantics

WORLD = "world"
_NOT_IN_PACKAGES = re.compile(r"[^a-z0-9_]+")
_PACKAGE = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>{title}, written by mjcompose</description>
  <maintainer email="nobody@example.org">nobody</maintainer>
  <license>see LICENSES</license>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
_CMAKE = """cmake_minimum_required(VERSION 3.8)
project({name})
find_package(ament_cmake REQUIRED)
install(FILES model.urdf model.srdf DESTINATION share/${{PROJECT_NAME}})
install(DIRECTORY assets DESTINATION share/${{PROJECT_NAME}} OPTIONAL)
ament_package()
"""


def write_urdf(draft: Draft) -> dict[str, bytes]:
    """Return `model.urdf`, `model.srdf`, the meshes and the files of a ROS package, by path."""
    draft.output = "model.urdf"
    simple_actuators(draft.root, any_input=True)
    model, title = draft.model, str(draft.root.get("model") or "model")
    package = package_name(title)
    bodies = draft.elements["body"]
    names = [
        WORLD,
        *(str(body.get("name") or f"body{number}") for number, body in enumerate(bodies) if number),
    ]
    robot = etree.Element("robot", name=title)
    joints: dict[str, Node] = {}
    links = [link(draft, number, name, package=package) for number, name in enumerate(names)]
    floating = model.nbody > 1 and not (model.body_parentid[2:] == 0).any() and _is_free(draft, 1)
    if floating:
        draft.lose(
            "roots", bodies[1], "the root is the body that moves freely, not a world", outcome=Outcome.WRITTEN
        )
        for geom in [node for number, node in draft.of("geom") if int(model.geom_bodyid[number]) == 0]:
            draft.lose("shapes", geom, "they are in the world, which is not in this URDF")
    for number, name in enumerate(names):
        if number == 0 and floating:
            continue
        robot.append(links[number])
        if number > (1 if floating else 0):
            for each in hung(draft, number, name, parent=names[int(model.body_parentid[number])]):
                robot.append(each)
                if each.tag == "joint":
                    joints[str(each.get("name"))] = each
    for number, site in draft.of("site"):
        if site.get("name") and not (floating and int(model.site_bodyid[number]) == 0):
            robot.extend(_frame(draft, number, str(site.get("name")), names=names))
    mimics(draft, joints)
    system = control(draft, joints)
    if system is not None:
        robot.append(system)
    etree.indent(robot)
    meshes = {path: content for path, content in draft.files.items() if path.endswith(".obj")}
    return {
        draft.output: etree.tostring(robot, xml_declaration=True, encoding="utf-8") + b"\n",
        "model.srdf": semantics(draft, title, names, joints=joints),
        "package.xml": _PACKAGE.format(name=package, title=_escaped(title)).encode(),
        "CMakeLists.txt": _CMAKE.format(name=package).encode(),
        **meshes,
    }


def _frame(draft: Draft, site: int, name: str, names: list[str]) -> list[Node]:
    """Return a site as a link that is fixed to the link of its body."""
    model = draft.model
    called = f"{name}_site" if name in names else name
    where = pose(model.site_pos[site], model.site_quat[site])
    return [
        massless(called),
        fixed(f"{called}_fixed", names[int(model.site_bodyid[site])], called, frame=where),
    ]


def package_name(title: str) -> str:
    """Return a name that is valid for a ROS package.

    >>> package_name("UR5e + 2F-85")
    'ur5e_2f_85'
    """
    found = _NOT_IN_PACKAGES.sub("_", title.lower()).strip("_")
    return found if found[:1].isalpha() else f"robot_{found}".strip("_")


def _is_free(draft: Draft, body: int) -> bool:
    model = draft.model
    return bool(model.body_jntnum[body] == 1 and model.jnt_type[model.body_jntadr[body]] == 0)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
