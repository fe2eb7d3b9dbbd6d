"""Random parts and recipes for the oracle: every element has a name, and every number is drawn from one seed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

import mujoco
import numpy as np

SHAPES = ("sphere", "capsule", "box", "cylinder", "ellipsoid")
SETTINGS = (
    'boundmass="0.05"',
    'boundinertia="0.002"',
    'balanceinertia="true"',
    'settotalmass="3"',
    'inertiafromgeom="true"',
    'inertiagrouprange="0 1"',
)


def numbers(*values: float) -> str:
    return " ".join(f"{value:.6g}" for value in values)


@dataclass
class Part:
    """The text of a part, and facts that decide where it may be attached."""

    text: str
    floats: bool = False
    in_world_only: bool = False
    has_fixed_root: bool = False


@dataclass
class PartMaker:
    """Writes one model. `degrees` and `sequence` are its own; a part with a free or mocap root `floats`."""

    random: Random
    floats: bool
    degrees: bool = True
    sequence: str = "xyz"
    bodies: list[str] = field(default_factory=list)
    hinges: list[str] = field(default_factory=list)
    balls: list[str] = field(default_factory=list)
    geoms: list[str] = field(default_factory=list)
    wraps: list[str] = field(default_factory=list)
    sites: list[str] = field(default_factory=list)
    tendons: list[str] = field(default_factory=list)
    actuators: list[str] = field(default_factory=list)
    sections: dict[str, list[str]] = field(default_factory=dict)
    in_world_only: bool = False
    has_fixed_root: bool = False
    has_flex: bool = False

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def some(self, names: Sequence[str], count: int) -> list[str]:
        return self.random.sample(list(names), count) if len(names) >= count else []

    def vector(self, size: float, count: int = 3) -> str:
        return numbers(*(self.random.uniform(-size, size) for _ in range(count)))

    def angle(self, least: float, most: float) -> float:
        value = self.random.uniform(least, most)
        return math.degrees(value) if self.degrees else value

    def add(self, section: str, element: str) -> None:
        self.sections.setdefault(section, []).append(element)

    def orientation(self) -> str:
        kind = self.random.choice(("quat", "euler", "axisangle", ""))
        if kind == "quat":
            return f' quat="{self.vector(1, 4)}"'
        if kind == "euler":
            return f' euler="{numbers(*(self.angle(-3, 3) for _ in range(3)))}"'
        return f' axisangle="{self.vector(1)} {self.angle(-3, 3):.6g}"' if kind else ""

    def made(self) -> Part:
        self.degrees = self.chance(0.5)
        self.sequence = self.random.choice(("xyz", "zyx", "XYZ", "zxz"))
        self.has_flex = self.chance(0.15)
        world = self.body(2, root=True) + (self.body(1, root=False) if not self.floats and self.chance(0.4) else "")
        world += self.static_content()
        if self.has_flex:
            world += self.flex()
        self.constraints()
        self.drives()
        self.measures()
        self.rest()
        return Part(self.text(world), self.floats, self.in_world_only, self.has_fixed_root)

    def text(self, world: str) -> str:
        angle = "degree" if self.degrees else "radian"
        setting = self.random.choice(SETTINGS) if self.chance(0.15) and not self.has_flex else ""
        compiler = f'<compiler angle="{angle}" eulerseq="{self.sequence}" {setting}/>'
        sections = "".join(f"<{tag}>{''.join(rows)}</{tag}>" for tag, rows in self.sections.items())
        return f'<mujoco model="part">{compiler}{self.defaults()}<worldbody>{world}</worldbody>{sections}</mujoco>'

    def defaults(self) -> str:
        joint = "" if self.has_flex else f'<joint damping="{self.random.uniform(0, 1):.3g}" armature="0.01"/>'
        return (
            f'<default><geom density="{self.random.uniform(200, 3000):.4g}"/>{joint}<motor gear="2"/>'
            f'<default class="own"><geom friction="0.7 0.01 0.001" condim="4"/></default></default>'
        )

    def body(self, depth: int, *, root: bool) -> str:
        name = f"b{'abcdefghijklmnop'[len(self.bodies)]}"
        self.bodies.append(name)
        content, mocap = self.joints(name, root=root)
        content += "".join(self.geom() for _ in range(self.random.choice((1, 1, 2))))
        content += self.site() + (self.site() if self.chance(0.3) else "")
        if self.chance(0.25):
            size = self.random.uniform(0.01, 0.02)
            inertia = numbers(size, size * self.random.uniform(1, 1.8), size * 1.5)
            content += f'<inertial pos="{self.vector(0.1)}"{self.orientation()} mass="{self.random.uniform(0.1, 2):.4g}" diaginertia="{inertia}"/>'
        for _ in range(self.random.choice((0, 1, 1, 2)) if depth else 0):
            content += self.body(depth - 1, root=False)
        gravcomp = f' gravcomp="{self.random.random():.3g}"' if self.chance(0.15) else ""
        text = f'<body name="{name}" pos="{self.vector(0.3)}"{self.orientation()}{gravcomp}{mocap}>{content}</body>'
        framed = self.chance(0.2)
        return f'<frame pos="{self.vector(0.2)}"{self.orientation()}>{text}</frame>' if framed else text

    def joints(self, body: str, *, root: bool) -> tuple[str, str]:
        if root and self.floats:
            return ('<freejoint name="free"/>', "") if self.chance(0.7) else ("", ' mocap="true"')
        kinds = self.random.choice((("hinge",), ("slide",), ("hinge", "slide"), ("hinge", "hinge"), ("ball",), ()))
        self.has_fixed_root = self.has_fixed_root or (root and not kinds)
        return "".join(self.joint(kind, f"j{body[1:]}{number}") for number, kind in enumerate(kinds)), ""

    def joint(self, kind: str, name: str) -> str:
        attributes = f'name="{name}" type="{kind}"'
        if kind == "ball":
            self.balls.append(name)
            spring = f' stiffness="{self.random.uniform(0, 3):.3g}"' if self.chance(0.4) else ""
            return f'<joint {attributes} damping="0.3"{spring}/>'
        self.hinges.append(name)
        attributes += f' axis="{self.vector(1)}" pos="{self.vector(0.1)}"'
        number = self.angle if kind == "hinge" else self.random.uniform
        if self.chance(0.5):
            attributes += f' range="{numbers(number(-2, -0.5), number(0.5, 2))}" limited="true"'
        if self.chance(0.3):
            attributes += f' stiffness="{self.random.uniform(0, 5):.3g}" springref="{number(-1, 1):.5g}"'
        if self.chance(0.3):
            attributes += f' ref="{number(-0.4, 0.4):.5g}" frictionloss="0.1"'
        return f"<joint {attributes}/>"

    def geom(self) -> str:
        name = f"g{len(self.geoms)}"
        self.geoms.append(name)
        shape = self.random.choice(SHAPES)
        if shape in ("sphere", "cylinder"):
            self.wraps.append(name)
        size = numbers(*(self.random.uniform(0.02, 0.1) for _ in range(3)))
        mass = f' mass="{self.random.uniform(0.05, 1):.4g}"' if self.chance(0.4) else ""
        bits = (
            f' contype="{self.random.randrange(4)}" conaffinity="{self.random.randrange(4)}"'
            if self.chance(0.5)
            else ""
        )
        owned = ' class="own"' if self.chance(0.3) else ""
        group = f' group="{self.random.randrange(3)}"' if self.chance(0.3) else ""
        if self.chance(0.15):
            shape = "mesh"
            self.wraps = [each for each in self.wraps if each != name]
            self.mesh()
            bits += ' mesh="blob"'
        return (
            f'<geom name="{name}" type="{shape}" size="{size}" pos="{self.vector(0.1)}"{self.orientation()}'
            f"{mass}{bits}{owned}{group}/>"
        )

    def mesh(self) -> None:
        if not any('name="blob"' in each for each in self.sections.get("asset", ())):
            points = numbers(*(self.random.uniform(-0.1, 0.1) for _ in range(24)))
            self.add("asset", f'<mesh name="blob" vertex="{points}" inertia="convex"/>')

    def site(self) -> str:
        name = f"s{len(self.sites)}"
        self.sites.append(name)
        return f'<site name="{name}" pos="{self.vector(0.1)}"{self.orientation()}/>'

    def flex(self) -> str:
        equality = '<edge equality="true"/>' if self.chance(0.6) else ""
        counts = self.random.choice(("2 2 1", "3 2 1"))
        self.in_world_only = True  # MuJoCo refuses a flex below a joint
        return (
            f'<body name="sheet" pos="{self.vector(0.2)}"><flexcomp name="cloth" type="grid" count="{counts}" dim="2" '
            f'spacing=".1 .1 .1" radius=".005" mass="0.2"{self.orientation()}>{equality}</flexcomp></body>'
        )

    def static_content(self) -> str:
        if not self.chance(0.3):
            return ""
        if self.floats and self.chance(0.5):
            self.in_world_only = True
            heights = numbers(*(self.random.random() for _ in range(9)))
            self.add("asset", f'<hfield name="land" nrow="3" ncol="3" size="1 1 .3 .1" elevation="{heights}"/>')
            return '<geom name="ground" type="hfield" hfield="land" pos="0 0 -1"/>'
        return f'<geom name="fixed" type="sphere" size="0.04" pos="{self.vector(0.3)}"/>{self.site()}'

    def constraints(self) -> None:
        if (pair := self.some(self.geoms, 2)) and self.chance(0.3):
            self.add("contact", f'<pair name="touch" geom1="{pair[0]}" geom2="{pair[1]}"/>')
        bodies = self.some(self.bodies, 2)
        if bodies and self.chance(0.4):
            self.add("contact", f'<exclude name="apart" body1="{bodies[0]}" body2="{bodies[1]}"/>')
        if bodies and self.chance(0.4):
            kind = self.random.choice(("connect", "weld"))
            anchor = f' anchor="{self.vector(0.2)}"'
            second = f' body2="{bodies[1]}"' if self.chance(0.7) else self.random.choice(("", ' body2="world"'))
            self.add("equality", f'<{kind} name="hold" body1="{bodies[0]}"{second}{anchor}/>')
        if (joints := self.some(self.hinges, 2)) and self.chance(0.4):
            self.add(
                "equality", f'<joint name="follow" joint1="{joints[0]}" joint2="{joints[1]}" polycoef="0.1 0.5 0 0 0"/>'
            )
        if (joints := self.some(self.hinges, 2)) and self.chance(0.5):
            path = "".join(f'<joint joint="{joint}" coef="{self.random.uniform(-2, 2):.4g}"/>' for joint in joints)
            self.tendons.append("fixed")
            self.add("tendon", f'<fixed name="fixed" stiffness="2" damping="0.1" springlength="0.1">{path}</fixed>')
        if (sites := self.some(self.sites, 3)) and self.chance(0.5):
            path = [f'<site site="{site}"/>' for site in sites]
            if self.wraps and self.chance(0.5):
                path.insert(1, f'<geom geom="{self.random.choice(self.wraps)}"/>')
            self.tendons.append("spatial")
            self.add("tendon", f'<spatial name="spatial" stiffness="3">{"".join(path)}</spatial>')

    def drives(self) -> None:
        targets = [f'joint="{name}"' for name in self.hinges] + [f'tendon="{name}"' for name in self.tendons]
        for number, target in enumerate(self.random.sample(targets, min(len(targets), 3))):
            kind = self.random.choice(
                (
                    '<motor {} ctrlrange="-1 1" ctrllimited="true"/>',
                    '<position {} kp="7" kv="0.4" gear="1.5"/>',
                    '<velocity {} kv="2"/>',
                    '<intvelocity {} kp="3" actrange="-2 2"/>',
                    '<general {} dyntype="filter" dynprm="0.1" gainprm="2" biastype="affine" biasprm="0.1 -2 -0.3"/>',
                    '<muscle {} lengthrange="-1 2" force="20" range="0.75 1.05"/>',
                    '<plugin {} plugin="mujoco.pid" instance="tuned" actdim="0"/>',
                )
            )
            if "plugin" in kind and "extension" in self.sections:
                continue
            if "plugin" in kind:
                config = '<config key="kp" value="9"/><config key="kd" value="0.5"/>'
                self.add(
                    "extension", f'<plugin plugin="mujoco.pid"><instance name="tuned">{config}</instance></plugin>'
                )
            self.actuators.append(f"a{number}")
            self.add("actuator", kind.format(f'name="a{number}" {target}'))
        if (sites := self.some(self.sites, 2)) and self.chance(0.2):
            self.actuators.append("thrust")
            gear = self.vector(2, 6)
            reference = f' refsite="{sites[1]}"' if self.chance(0.5) else ""
            self.add("actuator", f'<motor name="thrust" site="{sites[0]}"{reference} gear="{gear}"/>')

    def measures(self) -> None:
        rows: list[str] = []
        rows += [f'<{kind} {{}} joint="{name}"/>' for name in self.hinges[:2] for kind in ("jointpos", "jointvel")]
        rows += [f'<{kind} {{}} joint="{name}"/>' for name in self.balls[:1] for kind in ("ballquat", "ballangvel")]
        rows += [f'<{kind} {{}} tendon="{name}"/>' for name in self.tendons for kind in ("tendonpos", "tendonvel")]
        rows += [
            f'<{kind} {{}} actuator="{name}"/>'
            for name in self.actuators[:2]
            for kind in ("actuatorpos", "actuatorvel")
        ]
        rows += [f'<{kind} {{}} site="{name}"/>' for name in self.sites[:2] for kind in ("gyro", "velocimeter")]
        frames = [("body", self.bodies), ("xbody", self.bodies), ("site", self.sites), ("geom", self.geoms)]
        for kind in ("framepos", "framequat", "framexaxis", "framelinvel", "frameangvel"):
            (one, names), (other, others) = (self.random.choice(frames) for _ in range(2))
            reference = self.random.choice(
                ("", ' reftype="body" refname="world"', f' reftype="{other}" refname="{self.random.choice(others)}"')
            )
            rows.append(f'<{kind} {{}} objtype="{one}" objname="{self.random.choice(names)}"{reference}/>')
        if pair := self.some(self.geoms, 2):
            rows.append(f'<distance {{}} geom1="{pair[0]}" geom2="{pair[1]}" cutoff="5"/>')
        rows.append(f'<subtreecom {{}} body="{self.random.choice(self.bodies)}"/>')
        for number, row in enumerate(self.random.sample(rows, min(len(rows), 8))):
            self.add("sensor", row.format(f'name="m{number}"'))

    def rest(self) -> None:
        if (bodies := self.some(self.bodies, 2)) and self.chance(0.25):
            bones = "".join(
                f'<bone body="{body}" bindpos="{self.vector(0.2)}" bindquat="{self.vector(1, 4)}" vertid="{ids}" vertweight="1 .5"/>'
                for body, ids in zip(bodies, ("0 1", "2 3"), strict=True)
            )
            face = "0 1 2 0 2 3"
            self.add("deformable", f'<skin name="hide" vertex="{self.vector(0.2, 12)}" face="{face}">{bones}</skin>')
        if self.chance(0.3):
            self.add("custom", f'<numeric name="limits" data="{self.vector(2)}"/>')
            element = f'<element objtype="body" objname="{self.random.choice(self.bodies)}" prm="0.5"/>'
            self.add("custom", f'<tuple name="group">{element}<element objtype="body" objname="world"/></tuple>')


def with_key(part: Part, random: Random) -> Part | None:
    """Return the part with a key for its numbers, or None if MuJoCo does not take the part."""
    try:
        model = mujoco.MjModel.from_xml_string(part.text)
    except ValueError:
        return None
    data = mujoco.MjData(model)
    rows = {
        "qpos": [value + random.uniform(-0.3, 0.3) for value in data.qpos.tolist()],
        "ctrl": [random.uniform(-1, 1) for _ in range(model.nu)],
        "act": [random.uniform(0, 1) for _ in range(model.na)],
        "mpos": [random.uniform(-1, 1) for _ in range(3 * model.nmocap)],
        "mquat": [random.uniform(0.1, 1) for _ in range(4 * model.nmocap)],
    }
    if any(not math.isfinite(value) for values in rows.values() for value in values):
        return None
    written = " ".join(f'{name}="{numbers(*values)}"' for name, values in rows.items() if values)
    key = f'<keyframe><key name="home" {written}/></keyframe>'
    text = part.text.replace("</mujoco>", f"{key}</mujoco>")
    return Part(text, part.floats, part.in_world_only, part.has_fixed_root)


def random_part(random: Random, *, floats: bool) -> Part:
    while True:
        made = with_key(PartMaker(random, floats).made(), random)
        if made is not None:
            return made


@dataclass
class Attached:
    """A part in the composition: its prefix, its source, and its place as the recipe writes it.

    `kind` is `world`, `site`, `body` or `joint`: a body with the name of the prefix between the place and the part.
    """

    prefix: str
    source: str
    kind: str
    name: str
    pos: tuple[float, float, float]
    euler: tuple[float, float, float]
    key: str = "home"
    first: str = ""
    """The prefix of the first copy, which has the meshes, textures and height fields of all copies."""


@dataclass
class Case:
    """A recipe with its files, the parts that it attaches, and the number of the matrix cell that is built."""

    files: dict[str, str]
    attached: list[Attached]
    cell: int | None

    def write(self, folder: Path) -> Path:
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        return folder / "recipe.yaml"


BASE = """<mujoco model="arm"><compiler angle="radian"/><worldbody>
  <geom name="floor" type="plane" size="3 3 .1" pos="0 0 -2"/>
  <body name="column" pos="{}"><geom name="post" size=".1" contype="4" conaffinity="4"/>
    <body name="link" pos="0 0 .4"><joint name="turn" axis="0 1 1"/><joint name="lift" type="slide" axis="0 0 1"/>
      <geom name="rod" type="capsule" fromto="0 0 0 .3 0 0" size=".02" contype="4" conaffinity="4"/>
      <site name="tip" pos=".3 0 0" quat="{}"/></body></body></worldbody>
  <actuator><motor name="turn" joint="turn"/></actuator>
  <keyframe><key name="home" qpos="0.2 0.1" ctrl="0.3"/></keyframe></mujoco>"""


def random_case(seed: int) -> Case:
    """One to three parts on places of an arm, some of them nested, copied, with a joint of their own, or in a cell."""
    random = Random(seed)
    four = [random.uniform(-1, 1) for _ in range(4)]
    files = {"arm.xml": BASE.format(numbers(*(random.uniform(-1, 1) for _ in range(3))), numbers(*four))}
    lines = ["recipe: 1", "allow: [license-missing, world-frame]", "base: ./arm.xml"]
    shifts = [round(random.uniform(-0.5, 0.5), 4) for _ in range(2)]
    has_cells = random.random() < 0.3
    if has_cells:
        lines += [f"params: {{shift: {{default: {shifts[0]}}}}}", f"matrix: {{axes: {{shift: {shifts}}}}}"]
    cell = random.randrange(2)
    lines.append("attach:")
    attached: list[Attached] = []
    for key in "pqr"[: random.choice((1, 1, 2, 3))]:
        part = random_part(random, floats=random.random() < 0.3)
        files[f"{key}.xml"] = part.text
        model = f"./{key}.xml"
        if random.random() < 0.25:
            files[f"{key}.yaml"] = f"recipe: 1\nallow: [license-missing]\nbase: ./{key}.xml\n"
            model = f"./{key}.yaml"
        kind = random.choice(("world", "site", "site", "body", "joint"))
        if part.floats or part.in_world_only:
            kind = "world"
        elif kind == "joint" and not part.has_fixed_root:  # a joint needs mass that is fixed to it
            kind = "site"
        pos = tuple(round(random.uniform(-0.5, 0.5), 4) for _ in range(3))
        euler = tuple(round(random.uniform(-3, 3), 4) for _ in range(3))
        place = {
            "site": "site: tip, ",
            "joint": "site: tip, joint: {axis: [0, 1, 0], damping: 1}, ",
            "body": "body: link, ",
        }
        written = [str(each) for each in pos]
        if has_cells:
            written[0] = '"${shift}"'
            pos = (shifts[cell], pos[1], pos[2])
        keys = random.choice(("merge", "prefix"))
        copies = kind == "world" and random.random() < 0.2
        turn = ", ".join(f"{each}rad" for each in euler)
        lines.append(
            f"  {key}: {{model: {model}, {place.get(kind, '')}pos: [{', '.join(written)}], euler: [{turn}], keys: {keys}"
            + (", replicate: [{count: 2, offset: [0, 0, 2]}]" if copies else "")
            + "}"
        )
        names = {"site": "tip", "body": "link"}
        turns = range(2) if copies else (None,)
        for number in turns:
            prefix = f"{key}/" if number is None else f"{key}{number}/"
            attached.append(
                Attached(
                    prefix,
                    f"{key}.xml",
                    kind,
                    names.get(kind, ""),
                    (pos[0], pos[1], pos[2]),
                    (euler[0], euler[1], euler[2]),
                    key="home" if keys == "merge" else f"{prefix}home",
                    first=f"{key}0/" if copies else prefix,
                )
            )
            if number:
                attached[-1].pos = shifted(attached[-1].pos, attached[-1].euler, (0.0, 0.0, 2.0))
    files["recipe.yaml"] = "\n".join(lines) + "\n"
    return Case(files, attached, cell if has_cells else None)


def shifted(
    pos: tuple[float, float, float], euler: tuple[float, float, float], offset: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return a place with an offset in its own frame."""
    quat = np.zeros(4)
    result = np.zeros(3)
    mujoco.mju_euler2Quat(quat, np.array(euler), "xyz")
    mujoco.mju_rotVecQuat(result, np.array(offset), quat)
    return (pos[0] + result[0], pos[1] + result[1], pos[2] + result[2])
