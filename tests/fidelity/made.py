"""Small models made for the table, and questions to MuJoCo: what was once silently wrong, in many forms."""

from __future__ import annotations

import itertools
import math
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import mujoco
import numpy as np
from fidelity import judging
from fidelity.building import build, session_of_process
from fidelity.corpus import Attachment, Composition
from fidelity.judging import Verdict
from fidelity.oracle import composed, differences_in
from fidelity.random_parts import random_case
from mjcompose.mujoco.attributes import names

POS = (2.0, -1.0, 0.5)
QUAT = (0.8, 0.2, -0.4, 0.4)
PLACES = {
    "in the world": {"pos": (3.0, 0.0, 0.0)},
    "turned": {"pos": POS, "quat": QUAT},
    "tilted on a cart": {"body": "cart", "pos": (0.1, 0.0, 0.3), "quat": QUAT},
    "at a site of a cart": {"site": "deck"},
}

# -- equalities with the world ------------------------------------------------------------------------------------

CART = """<mujoco><worldbody><geom size=".02"/><body name="cart" pos="0 1 0" euler="0 0 40"><joint name="roll" type="slide" axis="1 0 0"/>
  <joint name="tilt" axis="0 1 1"/><geom size=".1" mass="5"/><site name="deck" pos=".1 .2 .3" euler="15 50 0"/>
  </body></worldbody></mujoco>"""
HELD = """<mujoco><option gravity="{gravity}"><flag contact="disable"/></option><worldbody>
  <site name="wall" pos=".3 -.2 .4" euler="0 30 10"/><body name="crate" pos=".2 .3 .8" euler="10 0 25">{joint}
    <geom type="box" size=".1 .07 .03" pos=".02 .05 0"/><site name="eye" pos=".1 0 .03"/>
    <body name="lid" pos="0 0 .1"><joint name="lid" axis="0 1 0" damping=".02"/><geom size=".05" pos=".07 0 .02"/></body>
  </body></worldbody><equality>{equality}</equality></mujoco>"""
_POSE = 'relpose=".4 -.2 .7 .7 .3 .1 -.2"'
EQUALITIES = (
    '<weld body1="crate"/>',
    '<weld body1="lid" body2="world"/>',
    '<weld body1="world" body2="crate" anchor=".1 .2 -.1"/>',
    f'<weld body1="crate" {_POSE}/>',
    f'<weld body1="world" body2="lid" {_POSE} anchor=".03 0 .1" torquescale=".5"/>',
    f'<weld name="w" body1="crate" body2="world" {_POSE} active="false"/>',
    '<weld body1="crate" relpose="1 1 1 0 0 0 0" anchor="0 .1 0"/>',
    '<connect body1="crate" anchor=".1 0 .05"/>',
    '<connect body1="world" body2="lid" anchor=".2 .4 1"/>',
    '<connect site1="wall" site2="eye"/>',
    '<weld site1="eye" site2="wall"/>',
)
JOINTS = ("<freejoint/>", '<joint name="door" axis="0 .6 .8" damping=".02"/>')


def equalities(folder: Path) -> Iterator[Composition]:
    """Parts with every kind of equality with their world, at every place."""
    base = _written(folder / "cart.xml", CART)
    forms = enumerate(itertools.product(EQUALITIES, PLACES.items()))
    for number, (equality, (called, place)) in forms:
        joint = JOINTS[0 if called in ("in the world", "turned") else 1]  # a free joint is only allowed in the world
        text = HELD.format(gravity="0 0 -9.81", joint=joint, equality=equality)
        part = _written(folder / f"held{number}.xml", text)
        yield Composition(f"{equality} {called}", base, (Attachment(part, "p/", **place),))


# -- keys beside blocks and plugins -------------------------------------------------------------------------------

_SOFT = '<edge equality="true"/><contact selfcollide="none"/>'
ROD = (
    '<flexcomp name="rod" type="grid" dim="1" count="4 1 1" spacing=".1 .1 .1" mass=".1" radius=".01">'
    f'<pin id="0"/>{_SOFT}<elasticity young="1e5" poisson="0"/></flexcomp>'
)
CLOTH = (
    '<flexcomp name="cloth" type="grid" dim="2" count="3 2 1" spacing=".1 .1 .1" mass=".1" radius=".01">'
    f'<pin id="0"/>{_SOFT}</flexcomp>'
)
ROW = '<replicate count="3" offset="0 .5 0"><body name="post" pos="0 0 {z}"><joint name="pj"/><geom size=".05"/>{inside}</body></replicate>'
BLOCKS = {
    "a rod": ROD,
    "a cloth": CLOTH,
    "a replicate": ROW.format(z=0.2, inside=""),
    "a rod and a replicate": ROD
    + ROW.format(z=0.2, inside='<body name="in"><joint name="ij" type="ball"/><geom size=".05"/></body>'),
}
ACTUATORS = {
    "motors": '<motor name="m" joint="first"/><motor name="n" joint="last"/>',
    "filters": '<position name="m" joint="first" timeconst=".1"/><motor name="n" joint="last"/>',
    "a plugin": '<plugin name="m" joint="first" plugin="mujoco.pid" instance="i" actdim="2"/><general name="n" joint="last" dyntype="integrator"/>',
    "a last plugin": '<general name="n" joint="last" dyntype="filter"/><plugin name="m" joint="first" plugin="mujoco.pid" instance="i" actdim="2"/>',
}
PID = """<extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="40"/><config key="ki" value="3"/>
  <config key="imax" value="2"/><config key="slewmax" value="9"/></instance></plugin></extension>"""
MODEL = """<mujoco>{extension}<worldbody><body name="stand" pos="{x} 0 1"><joint name="first" axis="0 1 0"/><geom size=".1"/>
  <site name="top" pos="0 .1 .2" euler="30 0 0"/>{block}<body name="arm" pos="0 0 .3"><joint name="last" type="slide"/><geom size=".1"/>
  </body></body></worldbody><actuator>{actuators}</actuator>{keyframe}</mujoco>"""


def keyed(folder: Path) -> Iterator[Composition]:
    """Models with rods, cloths, replicates and states of plugins, hung beside each other's; all have a key."""
    models = []
    for at, (block, acting) in enumerate(itertools.product(BLOCKS, ACTUATORS)):
        text = with_key(
            MODEL.replace("{block}", BLOCKS[block])
            .replace("{actuators}", ACTUATORS[acting])
            .replace("{extension}", PID if "plugin" in acting else "")
            .replace("{x}", str(at))
        )
        models.append((f"{block}, {acting}", _written(folder / f"keyed{at}.xml", text)))
    places = ({"body": "stand", "pos": POS, "quat": QUAT}, {"site": "top"}, {"pos": POS, "quat": QUAT}, {"body": "arm"})
    for at, (name, base) in enumerate(models):
        for step in (1, 6):
            other, part = models[(at + step) % len(models)]
            place = places[(at + step) % len(places)]
            # MuJoCo 4.0 looks in the world for the bodies in which a rod is twisted; attach takes them along.
            torn = "attach drops the torsion of a rod" if "rod" in other and place.keys() & {"site", "body"} else ""
            yield Composition(f"{other} at {place} of {name}", base, (Attachment(part, "p/", **place),), unlike=torn)


def with_key(text: str) -> str:
    """The model with a key in which all numbers differ; `{keyframe}` is its place."""
    model = mujoco.MjModel.from_xml_string(text.replace("{keyframe}", ""))
    sizes = {"qpos": model.nq, "qvel": model.nv, "act": model.na, "ctrl": model.nu}
    rows = [
        f'{vector}="{" ".join(f"{first + at / 1000:.3f}" for at in range(size))}"'
        for first, (vector, size) in enumerate(sizes.items(), 1)
        if size
    ]
    return text.replace("{keyframe}", f'<keyframe><key name="k" {" ".join(rows)}/></keyframe>')


# -- recipes, and what MuJoCo says of them ------------------------------------------------------------------------


@dataclass(frozen=True)
class Made:
    """A recipe beside its models, and what the compiled model is asked: the answers are differences."""

    id: str
    recipe: str
    ask: Callable[[mujoco.MjModel, Made, Path], list[str]]
    files: dict[str, str] = field(default_factory=dict)
    about: tuple[str, ...] = ()
    refused: str = ""


RANDOM = 1000


@dataclass(frozen=True)
class Drawn:
    """A random composition, by its seed."""

    id: str
    seed: int
    refused: str = ""


def judge(made: Made | Composition | Drawn) -> Verdict:
    """Build a recipe with all that a build verifies, and ask; compositions are compared as all others."""
    if isinstance(made, Composition):
        return judging.judge(made)
    if isinstance(made, Drawn):
        return _judge_drawn(made)
    verdict = Verdict(made.id, made.refused)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in made.files.items():
            _written(folder / file, text)
        done = build(_written(folder / "recipe.yaml", f"recipe: 1\n{made.recipe}"), verified=True)
        verdict.diagnostics = done.diagnostics
        verdict.built = done.model is not None
        if verdict.built:
            model = done.load()
            verdict.compiled = True
            verdict.facts = made.ask(model, made, folder)
    return verdict


def _judge_drawn(drawn: Drawn) -> Verdict:
    verdict = Verdict(drawn.id, drawn.refused)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = random_case(drawn.seed)
        text = composed(case, Path(folder), session_of_process())
        verdict.built = isinstance(text, bytes)
        verdict.diagnostics = text if isinstance(text, str) else ""
        if isinstance(text, bytes):
            verdict.compiled = True
            verdict.facts = differences_in(case, text, drawn.seed)
    return verdict


def sets(folder: Path) -> Iterator[tuple[str, list[Composition] | list[Made] | list[Drawn]]]:
    """Each with its title in the table; files that compositions need are written into the folder."""
    yield "parts with an equality with their world, moved, turned and on a cart", list(equalities(folder))
    yield "keys of rods, cloths, replicates and plugins next to each other", list(keyed(folder))
    yield "parts with such an equality move as they do alone, 0.5 s", list(_moving())
    yield "merged keys of tools inside replicates and next to rods", list(_inside())
    yield "motors through gears, converted: the joint feels the gains of the recipe", list(_geared())
    yield "`sense` at a flange reads the weight below it, and its lever", list(_sensing())
    from fidelity import existing  # it makes more of these

    yield "links between the inside of a `<replicate>` and the outside, one for each copy", list(existing.links())
    yield "a `<replicate>` that a recipe adds multiplies nothing else", list(existing.added_replicates())
    yield "sensors with the world as their reference, on a moving body", list(existing.world_sensors())
    yield "random compositions, compared by the second oracle", list(_by_oracle())


def _by_oracle() -> Iterator[Drawn]:
    yield from (Drawn(f"random composition {seed}", seed) for seed in range(RANDOM))


def named_like(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    """The elements of the kind `about[0]` have the names that follow it, and no others."""
    kind, *expected = made.about
    found = names(model, kind)
    return [] if sorted(found) == sorted(expected) else [f"the names are {sorted(found)}, should be {sorted(expected)}"]


def _moving() -> Iterator[Made]:
    """On a stand without a joint, too: there is no reaction that could differ."""
    stand = '<mujoco><worldbody><body name="stand" pos="0 1 0" euler="0 30 40"><geom size=".1"/></body></worldbody></mujoco>'
    # Gravity is the world's: alone it points where it points for the part.
    for number, (equality, place) in enumerate(itertools.product(EQUALITIES, ("", "body: stand, "))):
        files = {
            "p.xml": HELD.format(gravity="0 0 0", joint=JOINTS[1 if place else number // 2 % 2], equality=equality),
            "stand.xml": stand,
        }
        recipe = (
            f"base: ./stand.xml\nconflict: base\nattach:\n  p: {{model: ./p.xml, {place}pos: {list(POS)}, quat: {list(QUAT)}}}\n"
            "check: {same: {unchanged: {}}}\n"
        )
        yield Made(f"{equality} {place or 'turned'}", recipe, _moves_alike, files)


def _moves_alike(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    alone = mujoco.MjModel.from_xml_path(str(folder / "p.xml"))
    model.opt.disableflags = alone.opt.disableflags
    model.opt.timestep = alone.opt.timestep
    mine = mujoco.MjData(alone)
    theirs = mujoco.MjData(model)
    turned = np.zeros(9)
    there = np.zeros(4)
    mujoco.mju_mulQuat(
        there,
        model.body("stand").quat if "body: stand" in made.recipe else np.array([1.0, 0, 0, 0]),
        np.array(QUAT) / np.linalg.norm(QUAT),
    )
    mujoco.mju_quat2Mat(turned, there)
    model.opt.gravity[:] = [0.5, -3.0, -9.0]
    alone.opt.gravity[:] = turned.reshape(3, 3).T @ model.opt.gravity
    for data in (mine, theirs):
        data.qpos[-1] += 0.3
        data.qvel[-1] = 0.5
    for _ in range(round(0.5 / alone.opt.timestep)):
        mujoco.mj_step(alone, mine)
        mujoco.mj_step(model, theirs)
    found = []
    for one, other in itertools.combinations(("crate", "lid"), 2):
        gaps = [
            data.xmat[m.body(q + one).id].reshape(3, 3).T
            @ (data.xpos[m.body(q + other).id] - data.xpos[m.body(q + one).id])
            for m, data, q in ((alone, mine, ""), (model, theirs, "p/"))
        ]
        found += [f"`{other}` is {gaps[1]}, alone {gaps[0]}"] * (not np.allclose(*gaps, atol=1e-6))
    origin = np.array(POS)
    if "body: stand" in made.recipe:
        stand = model.body("stand")
        to_world = np.zeros(9)
        mujoco.mju_quat2Mat(to_world, stand.quat)
        origin = stand.pos + to_world.reshape(3, 3) @ origin
    for name in ("crate", "lid"):
        expected = origin + turned.reshape(3, 3) @ mine.xpos[alone.body(name).id]
        at = theirs.xpos[model.body(f"p/{name}").id]
        found += [f"`{name}` is at {at}, should be at {expected}"] * (not np.allclose(at, expected, atol=1e-6))
    forces = [float(np.linalg.norm(data.efc_force)) for data in (mine, theirs)]
    found += [f"the forces are {forces[1]}, alone {forces[0]}"] * (
        not math.isclose(*forces, rel_tol=1e-4, abs_tol=1e-5)
    )
    return found


HOST = """<mujoco><worldbody>{row}<body name="stand" pos="2 0 0"><joint name="first" axis="0 1 0"/><geom size=".1"/>{block}
  </body></worldbody><actuator><position name="m" joint="first" timeconst=".1"/><motor name="pm" joint="pj"/></actuator>{{keyframe}}</mujoco>"""
TOOLS = {
    "a tool": '<body name="a"><joint name="j" type="ball"/><geom size=".1"/></body><body name="b"><joint name="i"/><geom size=".1"/></body>',
    "a tool with a rod": f'<body name="a"><joint name="j"/><geom size=".1"/>{ROD}<body name="b"><joint name="i"/><geom size=".1"/></body></body>',
}
TOOL = '<mujoco><worldbody>{}</worldbody><actuator><general name="f" joint="i" dyntype="filter"/></actuator>{{keyframe}}</mujoco>'


def _inside() -> Iterator[Made]:
    """In a post of a replicate, one or two deep, beside a rod or a cloth of the same body; merged into one key."""
    rows = {
        "a row": (ROW.format(z=0, inside=""), ("0", "1", "2")),
        "rows of rows": (
            f'<replicate count="2" offset="3 0 0">{ROW.format(z=0, inside="")}</replicate>',
            tuple(f"{inner}{outer}" for outer in range(2) for inner in range(3)),
        ),
    }
    for (row, (text, ends)), block, tool in itertools.product(
        rows.items(), ("a rod", "a cloth", "a rod and a replicate"), TOOLS
    ):
        if block == "a rod and a replicate":
            inner = (
                ROD
                + '<replicate count="2" offset=".1 0 0"><body name="in"><joint name="ij"/><geom size=".05"/></body></replicate>'
            )
        else:
            inner = BLOCKS[block]
        files = {
            "base.xml": with_key(HOST.format(row=text, block=inner)),
            "tool.xml": with_key(TOOL.format(TOOLS[tool])),
        }
        for place, of in (("post", ends), ("stand", ("",))):
            recipe = f"base: ./base.xml\nattach: {{p: {{model: ./tool.xml, body: {place}, pos: [0, 0, 1], quat: {list(QUAT)}}}}}\n"
            yield Made(f"{tool} at `{place}` beside {block} in {row}", recipe, _keys_by_name, files, of)


def _keys_by_name(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    """Every number of the key is that of the base, or of the tool, for the joint or actuator of that name."""
    meant: dict[tuple[str, str], list[float]] = _named(folder / "base.xml")
    for (vector, name), numbers in _named(folder / "tool.xml").items():
        # MuJoCo 4.0 makes the bodies in which a rod is twisted once, in the world, however many copies of it there are.
        ends = ("",) if "_twist" in name else made.about
        meant |= {(vector, f"p/{name}{end}"): numbers for end in ends}
    found = _named(model)
    return [
        f"`{vector}` of `{name}` is {found.get((vector, name))}, should be {meant.get((vector, name))}"
        for vector, name in sorted(meant.keys() | found.keys())
        if not np.allclose(meant.get((vector, name), [math.nan]), found.get((vector, name), [math.inf]))
    ]


def _named(model: Path | mujoco.MjModel) -> dict[tuple[str, str], list[float]]:
    """The numbers of the first key by what MuJoCo calls their joint or actuator, or the body of a joint without a name."""
    if isinstance(model, Path):
        model = mujoco.MjModel.from_xml_path(str(model))
    found = {}
    for at in range(model.njnt):
        body = model.jnt_bodyid[at]
        name = model.joint(at).name or f"{model.body(body).name}"
        kind = int(model.jnt_type[at])
        for vector, adr, width in (("qpos", model.jnt_qposadr, (7, 4, 1, 1)), ("qvel", model.jnt_dofadr, (6, 3, 1, 1))):
            row = getattr(model, f"key_{vector}")[0][adr[at] : adr[at] + width[kind]].tolist()
            found.setdefault((vector, name), []).extend(row)
    for at in range(model.nu):
        name = model.actuator(at).name
        found["ctrl", name] = [float(model.key_ctrl[0][at])]
        if model.actuator_actadr[at] >= 0:
            found["act", name] = [float(model.key_act[0][model.actuator_actadr[at]])]
    return found


GEARS = (1.0, 80.0, -12.0, 0.02, -0.5)


def _geared() -> Iterator[Made]:
    for gear, joint, limits in itertools.product(GEARS, ("hinge", "slide"), ("", ', forcerange="-4 9"')):
        part = f"""<mujoco><compiler angle="radian"/><default><motor gear="{gear}"/></default><worldbody><body name="b"><joint name="j"
          type="{joint}" axis="0 0 1"/><geom size=".1" pos=".2 0 0"/></body></worldbody><actuator><motor name="m" joint="j" gear="{gear}"/>
          </actuator></mujoco>"""
        spans = ", forcerange: [-30, 60]" if limits else ""
        edit = f"{{select: {{motor: NAME}}, convert: {{to: position, kp: 150, kv: 6{spans}}}}}"
        whole = "site" if limits else "body"
        where = "site: top" if whole == "site" else f"pos: {list(POS)}, quat: {list(QUAT)}"
        base = '<mujoco><worldbody><body name="s"><geom size=".1"/><site name="top" euler="20 0 0"/></body></worldbody></mujoco>'
        for own in (True, False):
            inner = f", edit: [{edit.replace('NAME', 'm')}]" if own else ""
            outer = "" if own else f"edit: [{edit.replace('NAME', 'p/m')}]\n"
            recipe = f"base: ./base.xml\nattach: {{p: {{model: ./part.xml, {where}{inner}}}}}\n{outer}"
            yield Made(
                f"gear {gear:g}, {joint}{limits}, in the {'part' if own else 'whole'}",
                recipe,
                _feels,
                {"part.xml": part, "base.xml": base},
                (str(gear), spans),
            )


def _feels(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    """At random places, speeds and targets the joint feels `kp (target - q) - kv v`, within its limits."""
    gear = float(made.about[0])
    spans = made.about[1]
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    found = []
    for _ in range(20):
        q, v, target = rng.uniform(-1, 1, 3)
        data.qpos[:] = q
        data.qvel[:] = v
        data.ctrl[:] = gear * target
        mujoco.mj_forward(model, data)
        force = 150 * (target - q) - 6 * v
        force = min(max(force, -30.0), 60.0) if spans else force
        if not math.isclose(data.qfrc_actuator[0], force, rel_tol=1e-9, abs_tol=1e-9):
            found.append(f"the joint feels {data.qfrc_actuator[0]:g}, should feel {force:g}")
    return found


ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="upper" pos="0 0 1" quat="1 .1 .2 .3"><joint name="j1" axis="0 1 0"/>
  <geom size=".1"/><body name="lower" pos=".3 0 0"><joint name="j2" axis="0 0 1"/><geom size=".1"/>
    <site name="flange" pos=".1 0 .2" quat="1 0 0 1"/><frame name="mount" pos="0 .4 0" quat="1 1 0 0"/></body></body></worldbody></mujoco>"""
HAND = """<mujoco><compiler angle="radian"/><worldbody><frame name="grasp" pos=".1 .2 0" quat="1 0 .5 0"/><geom size=".04" mass=".3"/>
  <body name="palm" pos=".1 .2 .1" quat="1 .3 0 0"><geom type="box" size=".1 .05 .02" mass=".8"/>
    <body pos="0 .1 0"><joint name="f1"/><geom size=".03" pos="0 0 .1" mass=".2"/></body>
    <body pos="0 -.1 0"><joint name="f2" type="slide"/><geom size=".03" pos="0 0 .1" mass=".25"/></body></body></worldbody></mujoco>"""
FLANGES = {
    "site": "model: ./hand.xml, site: flange",
    "site, offset": "model: ./hand.xml, site: flange, pos: [0.1, 0.2, 0.3], quat: [1, 2, 3, 4]",
    "frame, mate": "model: ./hand.xml, frame: mount, mate: grasp",
    "body": "model: ./hand.xml, body: lower, pos: [0, 0.1, 0]",
    "joint between": "model: ./hand.xml, site: flange, joint: {type: hinge, axis: [0, 1, 1]}",
    "tool changer": "model: {base: ./hand.xml, attach: {q: {model: ./hand.xml, body: palm}}}, site: flange",
    "world": "model: ./hand.xml, pos: [0, 0, 1], euler: [10deg, 20deg, 30deg]",
    "copies": "model: ./hand.xml, site: flange, replicate: [{count: 2, offset: [0, 0, 0.5]}]",
}


def _sensing() -> Iterator[Made]:
    for name, place in FLANGES.items():
        recipe = f"base: ./arm.xml\nattach: {{p: {{{place}, sense: [force, torque]}}}}\n"
        yield Made(name, recipe, _weighs, {"arm.xml": ARM, "hand.xml": HAND})


def _weighs(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    """In ten poses, held at rest: without speed or acceleration."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(5)
    found = []
    bodies = [at for at in range(model.nbody) if model.body(at).name.endswith("/sense")]
    for _ in range(10):
        data.qpos[:] = rng.uniform(-1, 1, model.nq)
        mujoco.mj_inverse(model, data)
        for body in bodies:
            part = model.body(body).name.removesuffix("sense")
            turned = data.site(f"{part}sense").xmat.reshape(3, 3).T
            weight = -model.body_subtreemass[body] * model.opt.gravity
            lever = data.subtree_com[body] - data.site(f"{part}sense").xpos
            for sensor, meant in (("force", turned @ weight), ("torque", turned @ np.cross(lever, weight))):
                read = data.sensor(part + sensor).data
                if not np.allclose(read, meant, atol=1e-6):
                    found.append(f"`{part}{sensor}` reads {read}, should read {meant}")
    return found if bodies else ["there is no body `sense`"]


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path
