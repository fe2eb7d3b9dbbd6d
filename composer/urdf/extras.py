"""What other programs say in a URDF and MJCF has words for: friction, gravity, springs, mimicry before MuJoCo 4."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.tree.unit import Unit
from composer.tree.urdf import locate_as

_FRICTION = ("1", "0.005", "0.0001")
"""MuJoCo's default."""


@dataclass(slots=True)
class Extras:
    """`made` has what MuJoCo made of the elements of the URDF. Methods say what became of an element, if anything."""

    robot: Unit
    unit: Unit
    made: dict[Node, list[Node]]

    def add(self) -> dict[Node, str]:
        """All that there is; the elements that were read, and what they became."""
        links = {str(each.get("name")): each for each in self.robot.root.iterchildren("link")}
        joints = {str(each.get("name")): each for each in self.robot.root.iterchildren("joint")}
        read: dict[Node, str] = {}
        for link in links.values():
            contact = link.find("contact")
            if contact is not None and self._contact(link, contact):
                read[contact] = "friction"
        for gazebo in self.robot.root.iterchildren("gazebo"):
            name = gazebo.get("reference")
            for setting in gazebo.iterchildren("*"):
                of_link, of_joint = _OF_LINKS.get(str(setting.tag)), _OF_JOINTS.get(str(setting.tag))
                became = None
                if name in links and of_link is not None:
                    became = of_link(self, links[name], setting)
                elif name in joints and of_joint is not None:
                    became = of_joint(self, joints[name], setting)
                if became is not None:
                    read[setting] = became
        self._mimics(joints)
        return read

    def _geoms(self, link: Node) -> Iterator[Node]:
        for shape in link.iterchildren("collision"):
            yield from (each for each in self.made.get(shape, ()) if each.tag == "geom")

    def _contact(self, link: Node, contact: Node) -> bool:
        """PyBullet's `<contact>`, whose frictions are those of MuJoCo."""
        given = [
            next((each.get("value") for each in contact.iterchildren(f"{kind}_friction")), None)
            for kind in ("lateral", "spinning", "rolling")
        ]
        if not any(_number(each) is not None for each in given):
            return False
        values = [
            str(one) if _number(one) is not None else other
            for one, other in zip(given, _FRICTION, strict=True)
        ]
        for geom in self._geoms(link):
            self._set(geom, "friction", " ".join(values), source=contact)
            if len([each for each in given[1:] if _number(each)]):
                self._set(geom, "condim", "6" if _number(given[2]) else "4", source=contact)
        return True

    def _friction(self, link: Node, setting: Node) -> str | None:
        if (value := _number(_said(setting))) is None or value < 0:
            return None
        geoms = list(self._geoms(link))
        for geom in geoms:
            self._set(geom, "friction", _said(setting), source=setting)
        return "friction" if geoms else None

    def _gravity(self, link: Node, setting: Node) -> str | None:
        off = {"turnGravityOff": ("true", "1"), "gravity": ("false", "0")}[str(setting.tag)]
        if _said(setting).lower() not in off:
            return "nothing: gravity acts on every body"
        bodies = [each for each in self.made.get(link, ()) if each.tag == "body"]
        for body in bodies:
            self._set(body, "gravcomp", "1", source=setting)
        return "gravcomp" if bodies else None

    def _spring(self, joint: Node, setting: Node) -> str | None:
        if _number(_said(setting)) is None:
            return None
        made = [each for each in self.made.get(joint, ()) if each.tag == "joint"]
        name = {"springStiffness": "stiffness", "springReference": "springref"}[str(setting.tag)]
        for each in made:
            self._set(each, name, _said(setting), source=setting)
        return name if made else None

    def _mimics(self, joints: dict[str, Node]) -> None:
        """The equalities that MuJoCo before 4.0 does not make."""
        moving = {str(each.get("name")): each for each in self.unit.root.iter("joint")}
        held = {each.get("joint1") for each in self.unit.root.iterfind("equality/joint")}
        for name, joint in joints.items():
            mimic = joint.find("mimic")
            if mimic is None or name not in moving or name in held or mimic.get("joint") not in moving:
                continue
            factor, offset = mimic.get("multiplier") or "1", mimic.get("offset") or "0"
            made = etree.SubElement(
                self.unit.section("equality"), "joint", joint1=name, joint2=str(mimic.get("joint")),
                polycoef=f"{offset} {factor} 0 0 0",
            )  # fmt: skip
            locate_as(self.unit, made, mimic, written=self.robot.origins)

    def _set(self, element: Node, name: str, value: str, source: Node) -> None:
        element.set(name, value)
        span = self.robot.origins.span(source, self.robot.file)
        self.unit.origins.settings.setdefault(element, {})[name] = span


_OF_LINKS: dict[str, Callable[[Extras, Node, Node], str | None]] = {
    "mu1": Extras._friction,
    "mu": Extras._friction,
    "gravity": Extras._gravity,
    "turnGravityOff": Extras._gravity,
}
_OF_JOINTS: dict[str, Callable[[Extras, Node, Node], str | None]] = {
    "springStiffness": Extras._spring,
    "springReference": Extras._spring,
}


def _said(setting: Node) -> str:
    return (setting.text or setting.get("value") or "").strip()


def _number(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None
