"""Restore the names of fused links in the tree that MuJoCo makes from a URDF, and locate its elements in the URDF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from functools import partial

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.tree.origin import Origins
from composer.tree.unit import Unit

_VALUES = {
    "inertial": {"mass": ("mass", "value"), "pos": ("origin", "xyz"), "quat": ("origin", "rpy")},
    "joint": {
        "axis": ("axis", "xyz"),
        "range": ("limit", "upper"),
        "actfrcrange": ("limit", "effort"),
        "damping": ("dynamics", "damping"),
        "frictionloss": ("dynamics", "friction"),
    },
    "geom": {
        "pos": ("origin", "xyz"),
        "quat": ("origin", "rpy"),
        "mesh": ("geometry/mesh", "filename"),
        "rgba": ("material/color", "rgba"),
    },
    "mesh": {"file": (".", "filename"), "scale": (".", "scale")},
}
"""For attributes of MJCF, the element below the URDF's, and the attribute there."""
_PLANAR = ("_TX", "_TY", "_RZ")


def name_fused_links(root: Node) -> None:
    """Remove the empty frames that mark links; a link that is no longer a body passes its name to its replacement."""
    bodies = {body.get("name") for body in root.iter("body")}
    for body in root.iter("body"):
        body.attrib.pop("fuse", "")  # MuJoCo has done it already
    for mark in [frame for frame in root.iter("frame") if frame.get("name")]:
        holder, name = mark.getparent(), mark.get("name")
        assert holder is not None and name is not None
        if name not in bodies and not (holder.tag == "frame" and not holder.get("name")):
            continue
        if name not in bodies:
            holder.set("name", name)
        holder.remove(mark)


def locate_in_urdf(unit: Unit, robot: Node, written: Origins) -> list[tuple[Node, Node]]:
    """Give every element of `unit`, converted from `robot`, its place in the URDF, where `written` finds it.

    The pairs are those elements with the ones that they come from.
    """
    unit.origins.texts.update(written.texts)
    pairs = list(_Sources(robot).of(unit.root))
    for element, source in pairs:
        locate_as(unit, element, source, written=written)
    return pairs


def locate_as(unit: Unit, element: Node, source: Node, written: Origins) -> None:
    """Give an element of `unit` the place of the one in the URDF that it comes from."""
    values = _VALUES.get(str(element.tag), {})
    unit.origins.own(element, partial(_place, written, unit.file, source, values))


def _place(
    written: Origins, file: str, source: Node, values: dict[str, tuple[str, str]], attribute: str | None
) -> Span:
    path, name = values.get(attribute or "", (".", attribute))
    holder = source.find(path)
    return written.span(*((source, file, None) if holder is None else (holder, file, name)))


def mesh_of(robot: Node, file: str) -> Node:
    """Return the `<mesh>` of a URDF that names a file, whose path may have been shortened or resolved."""
    best, alike = robot, 0
    for each in robot.iterfind("link/*/geometry/mesh"):
        same = _steps_in_common(str(each.get("filename")), file)
        if same > alike:
            best, alike = each, same
    return best


def _steps_in_common(one: str, other: str) -> int:
    """Return how many steps at the end of two paths are equal."""
    count = 0
    for mine, theirs in zip(
        *(reversed(each.replace("\\", "/").split("/")) for each in (one, other)), strict=False
    ):
        if mine != theirs:
            break
        count += 1
    return count


@dataclass
class _Sources:
    """Maps elements of MJCF to their elements in the URDF."""

    robot: Node
    links: dict[str, Node] = field(init=False)
    joints: dict[str, Node] = field(init=False)

    def __post_init__(self) -> None:
        self.links = {str(each.get("name")): each for each in self.robot.iterchildren("link")}
        self.joints = {str(each.get("name")): each for each in self.robot.iterchildren("joint")}

    def of(self, root: Node) -> Iterator[tuple[Node, Node]]:
        yield root, self.robot
        own = self.robot.find("mujoco")
        for section in root.iterchildren("*"):
            if section.tag == "worldbody":
                yield from self._held(section, self.robot)
            elif section.tag == "asset":
                yield from (
                    (mesh, mesh_of(self.robot, str(mesh.get("file"))))
                    for mesh in section.iterchildren("mesh")
                )
            elif section.tag == "equality":
                yield from ((each, self._mimic(each)) for each in section.iterchildren("*"))
            elif own is not None and (found := own.find(str(section.tag))) is not None:
                yield section, found

    def _held(self, holder: Node, link: Node) -> Iterator[tuple[Node, Node]]:
        """Yield the contents of a body, a frame or the world that was `link`."""
        geoms = list(holder.iterchildren("geom"))
        yield from zip(geoms, _shapes(link, len(geoms)), strict=True)
        for child in holder.iterchildren("body", "frame", "inertial", "joint"):
            name = str(child.get("name"))
            if child.tag == "inertial":
                found = link.find("inertial")
                yield child, link if found is None else found
            elif child.tag == "joint":
                yield child, self._joint(name, link)
            else:
                inner = self.links.get(name, link)
                yield child, inner
                yield from self._held(child, inner)

    def _joint(self, name: str, link: Node) -> Node:
        stem = name[:-3] if name.endswith(_PLANAR) else name
        return self.joints.get(name, self.joints.get(stem, link))

    def _mimic(self, equality: Node) -> Node:
        joint = self.joints.get(str(equality.get("joint1")))
        found = None if joint is None else joint.find("mimic")
        return self.robot if found is None else found


def _shapes(link: Node, number: int) -> list[Node]:
    """Return the shapes of a link that became that many geoms.

    These are the collision shapes, all shapes, or the visual shapes, whichever have that number; otherwise the link
    itself for each geom.
    """
    for tags in (("collision",), ("visual", "collision"), ("visual",)):
        shapes = list(link.iterchildren(*tags))
        if len(shapes) == number:
            return shapes
    return [link] * number
