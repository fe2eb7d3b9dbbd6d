"""An arm whose edits tests compare in MuJoCo's arrays, by name."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from pathlib import Path

import mujoco
import numpy as np
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """\
<mujoco model="arm">
  <compiler angle="{angle}" autolimits="true"/>
  <default>
    <default class="link">
      <geom type="capsule" size="0.03" friction="0.8"/>
      <joint axis="0 1 0" damping="2" range="{range}"/>
      <position kp="100" kv="10" ctrlrange="-1 1" forcerange="-50 50"/>
      <default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>
    </default>
  </default>
  <asset><material name="steel" rgba=".5 .5 .5 1"/></asset>
  <worldbody>
    <light name="sun" pos="0 0 3"/>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="base" pos="0 0 .1" childclass="link">
      <geom name="base_geom" type="cylinder" size=".1 .05" material="steel"/>
      <body name="link1" pos="0 0 .1">
        <joint name="shoulder"/>
        <geom name="upper" fromto="0 0 0 0 0 .3" mass="1"/>
        <geom name="visual_upper" class="visual" fromto="0 0 0 0 0 .3" mass="0"/>
        <body name="link2" pos="0 0 .3">
          <inertial pos="0 0 .1" mass="2" diaginertia=".02 .02 .003"/>
          <joint name="elbow" ref="{ref}"/>
          <geom name="lower" fromto="0 0 0 0 0 .2"/>
          <frame pos="0 0 .2"><site name="tip"/></frame>
          <body name="tray" pos="0 0 .2">
            <geom type="box" size=".1 .1 .01"/>
            <geom type="box" size=".01 .1 .02" pos=".1 0 0"/>
          </body>
        </body>
      </body>
    </body>
    <body name="prop" pos="1 0 .1"><freejoint name="free"/><geom name="ball" size=".05"/></body>
  </worldbody>
  <contact><exclude name="no" body1="base" body2="link1"/></contact>
  <actuator>
    <position name="a1" joint="shoulder" class="link"/>
    <position name="a2" joint="elbow" class="link" kp="50"/>
    <motor name="m1" joint="elbow" ctrlrange="-3 3"/>
    <velocity name="v1" joint="shoulder" kv="4"/>
    <position name="f1" joint="shoulder" kp="7" timeconst="0.2"/>
    <general name="g1" joint="shoulder" gainprm="20" biastype="affine" biasprm="0 -20 -3"/>
  </actuator>
  <sensor><jointpos name="s1" joint="elbow"/><framepos name="s2" objtype="site" objname="tip"/></sensor>
  <keyframe>
    <key name="home" qpos=".1 .2 1 0 .1 1 0 0 0" qvel="1 2 3 4 5 6 7 8" ctrl=".1 .2 .3 .4 .5 .6" act=".7"/>
    <key name="other" qpos=".3 .4 1 0 .1 1 0 0 0"/>
  </keyframe>
</mujoco>
"""


RADIANS = ARM.format(angle="radian", range="-1.5 1.5", ref="0.2")


DEGREES = ARM.format(angle="degree", range="-90 90", ref="10")


NAMES = {
    "body": mujoco.mjtObj.mjOBJ_BODY,
    "jnt": mujoco.mjtObj.mjOBJ_JOINT,
    "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "site": mujoco.mjtObj.mjOBJ_SITE,
    "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR,
    "sensor": mujoco.mjtObj.mjOBJ_SENSOR,
    "key": mujoco.mjtObj.mjOBJ_KEY,
    "light": mujoco.mjtObj.mjOBJ_LIGHT,
    "exclude": mujoco.mjtObj.mjOBJ_EXCLUDE,
    "mat": mujoco.mjtObj.mjOBJ_MATERIAL,
}


COUNTS = {"actuator": "nactuator" if hasattr(mujoco.MjModel, "nactuator") else "nu"}


DERIVED = (
    "subtreemass",
    "invweight0",
    "acc0",
    "sameframe",
    "bvh",
    "weldid",
    "rootid",
    "treeid",
    "simple",
    "adr",
    "actuator_length0",
    "parentid",
    "bodyid",
    "id",
    "num",
    "M0",
    "user",
    "aabb",
    "signature",
    "lightid",
    "trntype",
    "plugin",
    "rbound",
    "history",
    "poslocal",
    "poscom0",
    "length0",
    "body_margin",
)


Arrays = dict[tuple[str, str, str], list[float]]


class Case:
    """A folder with `arm.xml` in which recipes are built."""

    def __init__(self, folder: Path, text: str) -> None:
        self.folder = folder
        (folder / "arm.xml").write_text(text)
        self.context = Context(environment={}, folder=folder)

    def text(self, recipe: str) -> str:
        (self.folder / "recipe.yaml").write_text(recipe)
        self.context = Context(environment={}, folder=self.folder)
        built = build(ModelRequest(self.folder / "recipe.yaml", verified=False), self.context)
        assert built is not None, [each.message for each in self.context.sink.diagnostics]
        return built.bundle.files["model.xml"].decode()

    def model(self, recipe: str) -> mujoco.MjModel:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return mujoco.MjModel.from_xml_string(self.text(recipe))

    def edited(self, edits: str, own: bool = False, head: str = "") -> mujoco.MjModel:
        where = f"base: {{model: ./arm.xml, edit: [{edits}]}}" if own else f"base: ./arm.xml\nedit: [{edits}]"
        return self.model(f"recipe: 1\n{head}{where}\n")

    def told(self, edits: str, head: str = "") -> list[str]:
        """Place and code of every fault."""
        (self.folder / "recipe.yaml").write_text(f"recipe: 1\n{head}base: ./arm.xml\nedit:\n  - {edits}\n")
        self.context = Context(environment={}, folder=self.folder)
        assert build(ModelRequest(self.folder / "recipe.yaml", verified=False), self.context) is None
        return [f"{each.span.column} {each.code}" for each in self.context.sink.errors if each.span]

    @property
    def said(self) -> str:
        return "\n".join(
            f"{each.message}\n{chr(10).join(note.message for note in each.notes)}\n{each.help or ''}"
            for each in self.context.sink.diagnostics
        )


def arrays(model: mujoco.MjModel) -> Arrays:
    """Every number that belongs to an element with a name, by kind, name and array."""
    found: Arrays = {}
    for kind, code in NAMES.items():
        for array in [name for name in dir(model) if name.startswith(f"{kind}_")]:
            if any(word in array.removeprefix(kind) or word == array for word in DERIVED):
                continue
            values = getattr(model, array)
            if isinstance(values, np.ndarray):
                for row in range(len(values)):
                    name = mujoco.mj_id2name(model, code, row)
                    if name is not None:
                        found[kind, name, array.removeprefix(f"{kind}_")] = np.ravel(values[row]).tolist()
        for row in range(getattr(model, COUNTS.get(kind, f"n{kind}"))):
            if name := mujoco.mj_id2name(model, code, row):
                found[kind, name, "name"] = []
    for joint in range(model.njnt):
        name = mujoco.mj_id2name(model, NAMES["jnt"], joint)
        found["jnt", name, "ref"] = [float(model.qpos0[model.jnt_qposadr[joint]])]
        for array in ("dof_damping", "dof_armature", "dof_frictionloss"):
            found["jnt", name, array] = np.ravel(getattr(model, array)[model.jnt_dofadr[joint]]).tolist()
    return found


def changed(before: mujoco.MjModel, after: mujoco.MjModel) -> set[str]:
    """`NAME ARRAY` of all that differs, `+NAME` and `-NAME` of what is new or gone."""
    old = arrays(before)
    new = arrays(after)
    names_before = {key[:2] for key in old}
    names_after = {key[:2] for key in new}
    found = {f"+{name}" for _, name in names_after - names_before}
    found |= {f"-{name}" for _, name in names_before - names_after}
    return found | {f"{key[1]} {key[2]}" for key in old.keys() & new.keys() if not np.array_equal(old[key], new[key])}


def force(model: mujoco.MjModel, name: str) -> float:
    data = mujoco.MjData(model)
    data.qpos[:2] = [0.3, 0.25]
    data.qvel[:2] = [0.7, -0.4]
    data.ctrl[:] = 0.4
    mujoco.mj_forward(model, data)
    force: float = data.actuator(name).force[0]
    return force


def names(model: mujoco.MjModel, kind: str) -> Iterable[str]:
    return [mujoco.mj_id2name(model, NAMES[kind], row) for row in range(getattr(model, f"n{kind}"))]
