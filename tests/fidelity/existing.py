"""Sets of the table about elements that MuJoCo drops, multiplies or turns without an error, and the oracle's cases."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
from fidelity.made import Made, named_like

LAMPS = """<mujoco model="lamps"><worldbody>
  <body name="rail" pos="0 0 2"><joint name="slide" type="slide"/><geom size=".1"/><site name="hook"/></body>{rows}
</worldbody></mujoco>"""
LAMP = '<body name="lamp"><joint name="turn"/><geom size=".05"/><site name="ring"/></body>'
ROWS_OF_ROWS = (
    '<replicate count="2" offset="3 0 0"><frame pos="0 0 1"><replicate count="2" offset="0 .5 0" sep="-">'
    "{}</replicate></frame></replicate>"
)
ROWS = {
    "a row": ('<replicate count="3" offset="0 .5 0">{}</replicate>', ("0", "1", "2")),
    "a row of twelve": (
        '<replicate count="12" offset="0 .5 0" sep="_">{}</replicate>',
        tuple(f"_{at:02}" for at in range(12)),
    ),
    "rows of rows": (ROWS_OF_ROWS, ("-00", "-10", "-01", "-11")),
}
LINKS = {
    "weld": ("equality", "{type: weld, body1: lamp, body2: rail}"),
    "weld backwards": ("equality", "{type: weld, body1: rail, body2: lamp}"),
    "weld with the world": ("equality", "{type: weld, body1: lamp, body2: world}"),
    "connect": ("equality", "{type: connect, body1: lamp, body2: rail, anchor: [0, 0, 0.3]}"),
    "connect of sites": ("equality", "{type: connect, site1: hook, site2: ring}"),
    "joint": ("equality", "{type: joint, joint1: turn, joint2: slide}"),
    "refsite": ("actuator", "{type: motor, site: ring, refsite: hook}"),
    "slidersite": ("actuator", "{type: motor, cranksite: hook, slidersite: ring, cranklength: 1}"),
    "sensor": ("sensor", "{type: framepos, objtype: site, objname: ring, reftype: site, refname: hook}"),
}


def links() -> Iterator[Made]:
    """A recipe links the inside of replicates with the outside, directly and in a nested recipe."""
    for (row, (text, ends)), (link, (section, element)) in itertools.product(ROWS.items(), LINKS.items()):
        own = f"base: ./lamps.xml\n{section}: {{link: {element}}}\n"
        files = {"lamps.xml": LAMPS.format(rows=text.format(LAMP)), "inner.yaml": f"recipe: 1\n{own}"}
        yield Made(f"{link}, {row}", own, named_like, files, about=(section, *(f"link{end}" for end in ends)))
        nested = "attach: {p: {model: ./inner.yaml}}\n"
        about = (section, *(f"p/link{end}" for end in ends))
        yield Made(f"{link}, {row}, nested", nested, named_like, files, about=about)


SNAKE = """<mujoco model="snake"><worldbody><body name="b1"><joint name="j1"/><geom name="g1" size=".1"/><site name="s1"/>
  <body name="b10" pos="0 0 .3"><joint name="j10" axis="1 0 0"/><geom name="g10" size=".1"/><site name="s10"/></body>
</body></worldbody>{section}</mujoco>"""
COUNTED = {
    "motor": ("actuator", '<motor name="own" joint="j1"/>'),
    "site motor": ("actuator", '<motor name="own" site="s1"/>'),
    "sensor": ("sensor", '<jointpos name="own" joint="j1"/>'),
    "frame sensor": ("sensor", '<framepos name="own" objtype="body" objname="b1"/>'),
    "clock": ("sensor", '<clock name="own"/>'),
    "weld": ("equality", '<weld name="own" body1="b1"/>'),
    "tendon": ("tendon", '<fixed name="own"><joint joint="j1" coef="1"/></fixed>'),
    "pair": ("pair", '<pair name="own" geom1="g1" geom2="g10"/>'),
    "exclude": ("exclude", '<exclude name="own" body1="b1" body2="b10"/>'),
}
ADDED = "add: [{to: world, replicate: {count: 2, offset: [0, 1, 0], site: {name: mark}}}]\n"


def added_replicates() -> Iterator[Made]:
    """A recipe adds a `<replicate>` next to a model whose names end in numbers."""
    for called, (kind, element) in COUNTED.items():
        section = "contact" if kind in ("pair", "exclude") else kind
        files = {"snake.xml": SNAKE.format(section=f"<{section}>{element}</{section}>")}
        yield Made(f"{called} of the base", f"base: ./snake.xml\n{ADDED}", named_like, files, about=(kind, "own"))
        part = "attach: {p: {model: ./snake.xml}}\n"
        yield Made(f"{called} of a part", f"{part}{ADDED}", named_like, files, about=(kind, "p/own"))


TOOL = """<mujoco model="tool"><worldbody><geom size=".02"/><body name="t" pos="0 0 .1"><joint name="s" axis="0 1 0"/>
  <geom name="g" size=".03" pos=".1 0 0"/><site name="e" pos="0 .1 0"/></body></worldbody>
<sensor><{kind} name="world" objtype="{type}" objname="{name}" reftype="body" refname="world"/>
  <{kind} name="none" objtype="{type}" objname="{name}"/></sensor></mujoco>"""
ARM = """<mujoco model="arm"><worldbody><body name="link" pos="0 0 .5"><joint name="j" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 .3 0 .1" size=".02"/><site name="tip" pos=".3 0 0" euler="0 90 0"/></body></worldbody></mujoco>"""


def world_sensors() -> Iterator[Made]:
    """A sensor whose reference is the world reads the same as one without a reference, wherever its part is."""
    kinds = ("framepos", "framequat", "framexaxis", "framelinvel", "frameangvel")
    objects = (("body", "t"), ("xbody", "t"), ("geom", "g"), ("site", "e"))
    places = ("site: tip", "body: link, pos: [1, 0, 0]", "pos: [1, 2, 3], euler: [10deg, 20deg, 30deg]")
    for kind, (type_, name), place in itertools.product(kinds, objects, places):
        files = {"arm.xml": ARM, "tool.xml": TOOL.format(kind=kind, type=type_, name=name)}
        recipe = f"base: ./arm.xml\nattach: {{p: {{model: ./tool.xml, {place}}}}}\n"
        yield Made(f"{kind} of a {type_}, {place}", recipe, _reads_alike, files)


def _reads_alike(model: mujoco.MjModel, made: Made, folder: Path) -> list[str]:
    data = mujoco.MjData(model)
    data.qpos[:] = np.linspace(0.3, 0.8, model.nq)
    data.qvel[:] = np.linspace(-1, 2, model.nv)
    mujoco.mj_forward(model, data)
    values = [data.sensor(f"p/{name}").data for name in ("world", "none")]
    return [] if np.allclose(*values, atol=1e-12) else [f"it reads {values[0]}, and without a reference {values[1]}"]
