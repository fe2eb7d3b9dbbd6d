"""Random models: whole `<mujoco>` trees that MuJoCo compiles, with little in them and much that can go wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

import mujoco
from hypothesis import strategies as st
from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.grammar import GRAMMAR, ElementType
from properties.elements import Maker, element
from properties.mending import mended
from properties.scattering import scatter

_MOST = 4
"""Optional attributes of one element."""

_CLASSED = ("joint", "geom", "site", "camera", "light")
_SHAPES = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
_NO_SHAPE = ("hfield", "sdf", "plane")


@dataclass(frozen=True)
class Model:
    """The text of a model that compiles, and what may be hung on it."""

    text: str
    sites: tuple[str, ...]
    bodies: tuple[str, ...]
    frames: tuple[str, ...]


def models(*, floating: bool = True) -> st.SearchStrategy[Model]:
    """Models; `floating` ones may have free joints and mocap bodies at their roots.

    Hypothesis draws the seed alone: drawn piece by piece, most models would be the simplest of all.
    """
    return st.randoms(use_true_random=True).map(lambda random: _Builder(random, floating).model())


class _Builder:
    def __init__(self, random: Random, floating: bool) -> None:
        self.make = Maker(random, mujoco.mj_versionString())
        self.floating = floating
        self.root = etree.Element("mujoco", {"model": "random"})
        self.replicates = self.make.chance(30)
        self.classes: list[str] = []
        self.free: list[str] = []

    def model(self) -> Model:
        make = self.make
        self._compiler()
        if make.chance(75):
            self._class(element(self.root, "default"), "", 0)
        self._assets()
        world = element(self.root, "worldbody")
        for _ in range(make.pick((1, 2, 3))):
            self._body(world, 0)
        self._inside(world, make.pick((0, 1, 2)), joints=False)
        for section in ("contact", "tendon", "equality", "actuator", "sensor", "custom"):
            self._section(section, make.pick((0, 1, 2, 3)))
        if make.chance(25):
            scatter(self.root, make)
        text, compiled = mended(self.root, make)
        self._keys(compiled)
        text, compiled = mended(self.root, make)
        return Model(text, *(self._names(tag, compiled) for tag in ("site", "body", "frame")))

    def _names(self, tag: str, compiled: mujoco.MjModel) -> tuple[str, ...]:
        """The places that a recipe can name: not what a replicate makes, and not in a body that MuJoCo fuses."""
        bodies = {compiled.body(index).name for index in range(compiled.nbody)}
        found = (each for each in self.root.iter(tag) if next(each.iterancestors("replicate"), None) is None)
        return tuple(
            str(each.get("name"))
            for each in found
            if each.get("name") and all(body.get("name", "world") in bodies for body in _bodies(each))
        )

    def _compiler(self) -> None:
        make = self.make
        node = element(self.root, "compiler")
        if make.chance(50):
            make.degrees = make.chance(50)
            node.set("angle", "degree" if make.degrees else "radian")
        if make.chance(40):
            letters = make.some("xyz", 3, 3)
            node.set("eulerseq", "".join(x.upper() if make.chance(30) else x for x in letters))
        # What only MuJoCo can compute is measured element by element, which a replicate hides.
        if not self.replicates:
            for name, values in (
                ("autolimits", ("true", "false")),
                ("inertiafromgeom", ("true", "false", "auto")),
                ("inertiagrouprange", ("0 1", "0 5", "1 3")),
                ("boundmass", ("0.5",)),
                ("boundinertia", ("0.1",)),
                ("balanceinertia", ("true",)),
                ("settotalmass", ("3",)),
                ("fusestatic", ("true",)),
                ("alignfree", ("true",)),
            ):
                if make.chance(8):
                    node.set(name, make.pick(values))
                    make.optional.setdefault(node, []).append(name)

    def _class(self, node: Node, name: str, depth: int) -> None:
        make = self.make
        if name:
            node.set("class", name)
            self.classes.append(name)
        tags = [tag for tag in GRAMMAR.element("default").children if tag != "default"]
        for tag in make.some(tags, 4):
            kind = GRAMMAR.element(f"default/{tag}")
            if kind.exists_in(make.version):
                made = element(node, tag)
                make.fill(made, kind, 3, leave=("mesh", "hfield", "material", "texture", "target"))
                if tag == "joint" and made.get("type") == "free":  # it would float what is to hang on a body
                    del made.attrib["type"]
        if depth < 2:
            for _ in range(make.pick((0, 1, 2))):
                self._class(element(node, "default"), make.declare("default", "c"), depth + 1)

    def _assets(self) -> None:
        make = self.make
        section = element(self.root, "asset")
        if make.chance(40):
            texture = element(
                section,
                "texture",
                name=make.declare("texture", "t"),
                type="2d",
                builtin="gradient",
                width="4",
                height="4",
            )
            make.fill(texture, GRAMMAR.element("texture"), 2, leave=("gridsize", "gridlayout", "nchannel"))
            self._classed(texture)
        if make.chance(40):
            material = element(section, "material", name=make.declare("material", "m"))
            make.fill(material, GRAMMAR.element("material"), _MOST)
            self._classed(material)
        if make.chance(30):
            mesh = element(section, "mesh", name=make.declare("mesh", "w"), vertex="0 0 0 1 0 0 0 1 0 0 0 1")
            make.fill(
                mesh, GRAMMAR.element("mesh"), 2, leave=("normal", "texcoord", "face", "builtin", "params", "vertex")
            )
            self._classed(mesh)

    def _classed(self, node: Node) -> None:
        if self.classes and self.make.chance(30):
            node.set("class", "main" if self.make.chance(10) else self.make.pick(self.classes))
            self.make.optional.setdefault(node, []).append("class")

    def _childclassed(self, node: Node) -> None:
        if self.classes and self.make.chance(40):
            node.set("childclass", "main" if self.make.chance(10) else self.make.pick(self.classes))

    def _body(self, parent: Node, depth: int) -> None:
        make = self.make
        body = element(parent, "body", name=make.declare("body", "b"))
        self._pose(body)
        self._childclassed(body)
        make.fill(body, GRAMMAR.element("body"), 1, leave=_POSES)
        at_root = all(each.tag != "body" for each in parent.iterancestors()) and parent.tag != "body"
        if at_root and self.floating and make.chance(25):
            if make.chance(60):
                joint = element(body, "freejoint", name=make.declare("joint", "j"))
                self.free.append(str(joint.get("name")))
                # What is aligned can carry nothing, and is only nearly the same once its inertia is measured.
                make.fill(joint, GRAMMAR.element("freejoint"), 1, leave=("align",))
            else:
                body.set("mocap", "true")
        else:
            joints = make.pick((0, 1, 1, 2))
            for _ in range(joints):
                self._joint(body, armature=joints > 1)
        geom = element(body, "geom", name=make.declare("geom", "g"), type=make.pick(_SHAPES), size="0.1 0.2 0.3")
        make.fill(geom, GRAMMAR.element("geom"), 2, leave=("type", "size", "fromto", "mesh", "hfield"))
        if make.chance(15):
            inertial = element(body, "inertial", pos=make.numbers(3, -0.2, 0.2), mass="1.5", diaginertia="0.1 0.2 0.25")
            make.fill(inertial, GRAMMAR.element("inertial"), 1, leave=("fullinertia", "diaginertia"))
        self._inside(body, make.pick((0, 1, 2)), joints=True)
        if depth < 2:
            for _ in range(make.pick((0, 0, 1, 2) if depth else (0, 1, 1, 2))):
                holder = body
                if make.chance(25):
                    holder = self._frame(body)
                self._body(holder, depth + 1)

    def _joint(self, body: Node, *, armature: bool) -> None:
        """With an armature where joints may turn about one axis: else their inertia is singular."""
        make = self.make
        joint = element(body, "joint", name=make.declare("joint", "j"), **({"armature": "0.2"} if armature else {}))
        if make.chance(60):
            joint.set("type", make.pick(("hinge", "slide", "ball")))
        make.fill(joint, GRAMMAR.element("joint"), _MOST, leave=("type",))
        self._classed(joint)

    def _frame(self, parent: Node) -> Node:
        frame = element(parent, "frame", name=self.make.declare("frame", "f"))
        self._pose(frame)
        self._childclassed(frame)
        return frame

    def _inside(self, holder: Node, count: int, *, joints: bool) -> None:
        make = self.make
        for _ in range(count):
            tag = make.pick(("site", "geom", "site", "camera", "light", "frame", "replicate"))
            if tag == "frame":
                frame = self._frame(holder)
                self._inside(frame, 1, joints=joints)
                continue
            if tag == "replicate":
                if self.replicates:
                    holder = element(holder, "replicate", count="2", offset=make.numbers(3, 0.5, 1))
                    if make.chance(50):  # about one axis: another sequence cannot say it of several
                        holder.set("euler", make.pick(("0.3 0 0", "0 0.4 0", "0 0 -0.5")))
                tag = "site"
            node = element(holder, tag, name=make.declare(tag, tag[0]))
            leave: tuple[str, ...] = ("hfield", "mesh", "fromto", *_POSES)
            if tag == "geom":
                node.set("size", "0.1 0.2 0.3")
                if make.known("mesh") and make.chance(25):
                    node.set("mesh", make.pick(make.known("mesh")))
                    node.set("type", make.pick(("mesh", "box", "capsule")))
                elif make.chance(30):
                    node.set("fromto", make.numbers(6, -1, 1))
                    node.set("type", "capsule")
                else:
                    node.set("type", make.pick(_SHAPES))
                leave = (*leave, "type", "size")
            if node.get("fromto") is None and tag != "light":
                self._pose(node)
            make.fill(node, GRAMMAR.element(tag), _MOST, leave=leave)
            self._classed(node)

    def _pose(self, node: Node) -> None:
        make = self.make
        # In a place of its own: what a tendon is between two sites in one place is anybody's guess.
        node.set("pos", make.numbers(3, -1, 1))
        if make.chance(60):
            name = make.pick(_POSES[1:])
            attribute = GRAMMAR.element("body").attributes[name]
            node.set(name, str(make.value(attribute, node)))

    def _section(self, tag: str, count: int) -> None:
        make = self.make
        section = element(self.root, tag)
        kinds = [
            kind
            for kind in GRAMMAR.section(tag).children.values()
            if kind.exists_in(make.version) and kind.tag != "plugin"
        ]
        for _ in range(count):
            kind = make.pick(kinds)
            node = element(section, kind.tag)
            if not getattr(self, f"_{tag}")(node, kind):
                section.remove(node)
                continue
            if "name" in kind.attributes:
                node.set(
                    "name",
                    make.declare(
                        "exclude" if kind.tag == "exclude" else tag if tag != "custom" else kind.tag, kind.tag[0]
                    ),
                )
            if kind.takes_class:
                self._classed(node)

    def _contact(self, node: Node, kind: ElementType) -> bool:
        return self.make.fill(node, kind, _MOST)

    _equality = _contact
    _sensor = _contact

    def _tendon(self, node: Node, kind: ElementType) -> bool:
        make = self.make
        make.fill(node, kind, _MOST)
        joints = make.known("joint")
        sites = make.known("site")
        geoms = make.known("geom")
        if kind.tag == "fixed":
            for joint in make.some(joints, 2, 1):
                element(node, "joint", joint=joint, coef=make.numbers(1, -1, 1))
            return bool(joints)
        if len(sites) < 2:
            return False
        first, last = make.some(sites, 2, 2)
        element(node, "site", site=first)
        if geoms and make.chance(40):
            wrap = element(node, "geom", geom=make.pick(geoms))
            if make.chance(50):
                wrap.set("sidesite", make.pick(sites))
        elif make.chance(30):
            element(node, "site", site=make.pick(sites))
            element(node, "pulley", divisor="2")
            element(node, "site", site=first)
        element(node, "site", site=last)
        return True

    def _actuator(self, node: Node, kind: ElementType) -> bool:
        make = self.make
        targets = [
            name
            for name in ("joint", "jointinparent", "tendon", "site", "body")
            if name in kind.attributes and make.known(str(kind.attributes[name].refers))
        ]
        if not targets:
            return False
        target = make.pick(targets)
        name = make.pick(make.known(str(kind.attributes[target].refers)))
        if name in self.free and "joint" in target:
            return False  # the axes of a free joint are the world's: turned, it is another actuator
        node.set(target, name)
        if "lengthrange" in kind.attributes:  # what MuJoCo simulates for a muscle takes seconds
            node.set("lengthrange", "0 1")
        return make.fill(
            node, kind, _MOST, leave=("joint", "jointinparent", "tendon", "site", "body", "slidersite", "cranksite")
        )

    def _custom(self, node: Node, kind: ElementType) -> bool:
        make = self.make
        if kind.tag == "numeric":
            node.set("data", make.numbers(3, -1, 1))
        elif kind.tag == "text":
            node.set("data", "some text")
        else:
            for _ in range(2):
                each = element(node, "element")
                if not make.fill(each, GRAMMAR.element("tuple/element"), 1):
                    node.remove(each)
            return len(node) > 0
        return True

    def _keys(self, compiled: mujoco.MjModel) -> None:
        make = self.make
        section = element(self.root, "keyframe")
        sizes = {
            "qpos": compiled.nq,
            "qvel": compiled.nv,
            "ctrl": compiled.nu,
            "act": compiled.na,
            "mpos": 3 * compiled.nmocap,
            "mquat": 4 * compiled.nmocap,
        }
        for name in make.some(("home", "rest", "own"), 2):
            key = element(section, "key", name=name)
            for vector, size in sizes.items():
                if size and make.chance(50):
                    key.set(vector, make.numbers(size, 0.01, 1))
                    make.optional.setdefault(key, []).append(vector)


_POSES = ("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler")


def _bodies(node: Node) -> Iterator[Node]:
    """The bodies around a node, and the node itself if it is one."""
    yield from ([node] if node.tag == "body" else [])
    yield from node.iterancestors("body")
