"""The patches in `recipes/patches` do what the same change of the XML by hand does, in every array of the model."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.bundle.write import write
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from sampling import rest_slow

RECIPES = Path(__file__).resolve().parents[2] / "recipes"
HANDS: dict[str, tuple[str, Callable[[Node], None]]] = {}
"""By recipe: the file that is changed, in `recipes/models` or Menagerie, and the change."""
ELSEWHERE = {"menagerie_h1_legs", "menagerie_panda_mjx_scene"}
"""Where the recipe puts elements in another order; they are compared by their names."""


def by_hand(file: str) -> Callable[[Callable[[Node], None]], Callable[[Node], None]]:
    def noted(change: Callable[[Node], None]) -> Callable[[Node], None]:
        HANDS[change.__name__] = (file, change)
        return change

    return noted


def one(root: Node, path: str) -> Node:
    (found,) = all_of(root, path)
    return found


def all_of(root: Node, path: str) -> list[Node]:
    found = root.xpath(path)
    assert isinstance(found, list) and found
    return [each for each in found if isinstance(each, etree._Element)]


def put(root: Node, path: str, *texts: str) -> None:
    one(root, path).extend([etree.fromstring(text) for text in texts])


def leave_out(root: Node, *paths: str) -> None:
    for path in paths:
        for node in all_of(root, path):
            parent = node.getparent()
            assert parent is not None
            parent.remove(node)


def write_on(root: Node, path: str, **values: str) -> None:
    for node in all_of(root, path):
        for name, value in values.items():
            node.set(name, value)


@by_hand("arm6/arm6.xml")
def arm6_torque(root: Node) -> None:
    leave_out(root, "actuator/*", "keyframe")
    write_on(root, "option", timestep="0.001", integrator="Euler")
    write_on(root, "//default[@class='arm6']/joint", damping="3")
    del one(root, "//default[@class='arm6']/position").attrib["inheritrange"]
    put(root, "//default[@class='arm6']", '<motor ctrlrange="-180 180"/>')
    put(root, "//default[@class='wrist']", '<motor ctrlrange="-40 40"/>')
    for joint in ("shoulder_pan", "shoulder_lift", "elbow"):
        put(root, "actuator", f'<motor name="{joint}" joint="{joint}" class="arm6"/>')
    for joint in ("forearm_roll", "wrist_pitch", "flange_roll"):
        put(root, "actuator", f'<motor name="{joint}" joint="{joint}" class="wrist"/>')


@by_hand("gripper2/gripper2.xml")
def gripper2_touch(root: Node) -> None:
    put(root, "//body[@name='base']", '<light name="lamp" pos="0 0.04 0.02" dir="0 0 1" cutoff="30"/>')
    for side in ("left", "right"):
        tip = f'<site name="{side}_tip" class="pad" pos="0 0.0035 0.085" size="0.012 0.004 0.004"/>'
        put(root, f"//body[@name='{side}_finger']", tip)
        put(root, "sensor", f'<touch name="{side}_tip" site="{side}_tip"/>')
        write_on(root, f"//body[@name='{side}_finger']", gravcomp="1")
        write_on(root, f"//geom[@name='{side}_pad']", friction="2 0.02 0.001", condim="6")
    names = ("base_g0", "base_g1", "left_finger_g2", "left_finger_g3", "right_finger_g4", "right_finger_g5")
    for name, node in zip(names, all_of(root, "//worldbody//geom[@class='collision']"), strict=True):
        node.set("name", name)


@by_hand("camera_mount/camera_mount.xml")
def camera_mount_base(root: Node) -> None:
    leave_out(root, "keyframe")
    one(root, "//body[@name='base']").insert(0, etree.fromstring('<freejoint name="root"/>'))
    write_on(root, "//exclude", body1="camera_base", body2="camera_tilt")
    for node in all_of(root, "//body"):
        node.set("name", f"camera_{node.get('name')}")
    pan = one(root, "//joint[@name='pan']")
    del pan.attrib["range"]
    pan.set("limited", "false")
    write_on(root, "//camera", fovy="70")


@by_hand("wonik_allegro/right_hand.xml")
def menagerie_allegro_grasp(root: Node) -> None:
    write_on(root, "//default[@class='allegro_right']/position", kp="0.5")
    write_on(root, "//default[@class='thumbtip_collision']/geom", friction="1.0 0.05 0.01", condim="6")
    write_on(
        root,
        "//body[@name='palm']",
        pos="0.140696023 -0.005106107 -0.047790036",
        quat="0 0.81923193 0 0.57346233",
    )
    put(root, "//body[@name='palm']", '<site name="grasp_site" pos="0.03 0.01 -0.03" group="4"/>')
    put(root, "//body[@name='ff_tip']", '<site name="tip"/>')
    put(root, ".", "<sensor/>")
    for number, tip in enumerate(("rf_tip", "ff_tip", "mf_tip", "th_tip"), 1):
        put(root, "sensor", f'<framepos name="trace{number}" objtype="body" objname="{tip}"/>')


@by_hand("franka_emika_panda/panda.xml")
def menagerie_panda_wrench(root: Node) -> None:
    leave_out(root, "actuator/*", "keyframe")
    option = one(root, "option")
    option.attrib.clear()
    option.set("timestep", "0.003")
    write_on(root, "//default[@class='panda']/joint", damping="2")
    put(root, "default", '<default class="wrench"><general ctrlrange="-1 1" gainprm="10"/></default>')
    put(root, "worldbody", '<site name="world"/>')
    put(root, "//body[@name='link7']", '<site name="wrist" rgba="1 0 0 0.5" group="4"/>')
    put(root, "//body[@name='hand']", '<site name="eeff" pos="0 0 0.11" group="3"/>')
    for side in ("left", "right"):
        pad = 'type="box" pos="0 0.002 0.0445" size="0.0085 0.003 0.0085" group="4"'
        put(root, f"//body[@name='{side}_finger']", f'<site name="touch_{side}" {pad}/>')
    for number, name in enumerate(("x", "y", "z", "roll", "pitch", "yaw")):
        gear = " ".join("1" if number == each else "0" for each in range(6))
        gain = 'gainprm="1"' if number > 2 else ""
        put(
            root,
            "actuator",
            f'<general name="{name}" class="wrench" site="eeff" refsite="world" gear="{gear}" {gain}/>',
        )
    grip = 'kp="100" ctrlrange="-0.1 0.1" actrange="0.005 0.04" forcerange="-100 100"'
    put(root, "actuator", f'<intvelocity name="grip" tendon="split" {grip}/>')
    put(root, ".", '<contact><exclude body1="link0" body2="link1"/></contact>')
    write_on(root, "//body", gravcomp="1")
    write_on(root, "//joint[@name='joint1' or @name='joint7']", limited="false")
    write_on(root, "//joint[@name='joint4']", range="-3.0718 -0.698")
    write_on(root, "//joint[@name='joint7']", damping="1")


@by_hand("unitree_go1/go1.xml")
def menagerie_go1_agent(root: Node) -> None:
    leave_out(root, "actuator", "keyframe", "worldbody/light")
    write_on(root, "option", impratio="10")
    write_on(root, "//default[@class='go1']/position", kp="50")
    write_on(root, "//default[@class='hip']/joint", ref="-0.9", range="-1.586 3.601")
    write_on(root, "//default[@class='knee']/joint", ref="1.8", range="-1.018 0.912")
    write_on(root, "//body[@name='trunk']", pos="0 0 0.5")
    put(
        root,
        "//body[@name='trunk']",
        '<light pos="0 0 5" mode="trackcom" diffuse="0.8 0.8 0.8"/>',
        '<site name="torso"/>',
    )
    for old, new in (("RR", "HR"), ("RL", "HL")):
        write_on(root, f"//body[@name='{old}_hip']", name=f"{new}_hip")
        write_on(root, f"//geom[@name='{old}']", name=new)
    write_on(root, "//site[string-length(@name) = 2]", size="0.015", rgba="0.2 0.8 0.2 1")


@by_hand("unitree_h1/h1.xml")
def menagerie_h1_legs(root: Node) -> None:
    put(root, "//body[@name='pelvis']", '<body name="legs"/>')
    for side in ("left", "right"):
        one(root, "//body[@name='legs']").append(one(root, f"//body[@name='{side}_hip_yaw_link']"))
    put(root, "//body[@name='torso_link']", '<site name="upper_torso" pos="0 0 0.4"/>')


@by_hand("aloha/aloha.xml")
def menagerie_aloha_cartesian(root: Node) -> None:
    leave_out(root, "include[@file='keyframe_ctrl.xml']")
    write_on(root, "include", file="filtered_cartesian_actuators.xml")
    grasp = '<default class="grasp"><geom friction="1.5 0.05 0.01" solimp="0.95 0.99 0.001"/></default>'
    put(root, "//default[@class='sphere_collision']", grasp)
    write_on(root, "//geom[contains(@name, '_g2')]", **{"class": "grasp"})


@by_hand("franka_emika_panda/scene.xml")
def menagerie_panda_mjx_scene(root: Node) -> None:
    write_on(root, "include", file="mjx_panda.xml")


NEW_NAMES = {
    "menagerie_aloha_cartesian": {
        "actuation_center": "center",
        "/RX": "/roll",
        "/RY": "/pitch",
        "/RZ": "/yaw",
        "/X": "/x",
        "/Y": "/y",
        "/Z": "/z",
    }
}
"""What the recipe calls otherwise than the file that it stands for."""


PATCHES = sorted(path.stem for path in (RECIPES / "patches").glob("*.yaml"))
QUICK = [name for name in PATCHES if not name.startswith("menagerie_")] + ["menagerie_allegro_grasp"]


@pytest.mark.parametrize("recipe", rest_slow(PATCHES, QUICK))
def test_is_the_change_by_hand(recipe: str, tmp_path: Path) -> None:
    if recipe.startswith("menagerie_") and not os.environ.get("MJCOMPOSE_CORPUS"):
        pytest.skip("MJCOMPOSE_CORPUS names no corpus")
    menagerie = Path(os.environ.get("MJCOMPOSE_CORPUS", ""), "models")
    context = Context(environment={**os.environ, "MENAGERIE_ROOT": str(menagerie)})
    built = build(ModelRequest(RECIPES / "patches" / f"{recipe}.yaml"), context)
    assert built is not None and not context.sink.diagnostics
    write(built.bundle, f"{tmp_path}/out/", environment={})
    ours = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))
    file, change = HANDS[recipe]
    source = (menagerie if recipe.startswith("menagerie_") else RECIPES / "models") / file
    theirs = mujoco.MjModel.from_xml_path(str(_changed(source, change, tmp_path / "by_hand")))
    assert _sizes(ours) == _sizes(theirs)
    names = [_names(ours), _names(theirs)]
    for old, new in NEW_NAMES.get(recipe, {}).items():
        names[1] = {kind: [name.replace(old, new) for name in each] for kind, each in names[1].items()}
    assert {kind: sorted(each) for kind, each in names[0].items()} == {
        kind: sorted(each) for kind, each in names[1].items()
    }
    if recipe in ELSEWHERE:
        _equal_by_name(ours, theirs)
    else:
        assert names[0] == names[1]
        for name, value in _arrays(theirs):
            np.testing.assert_allclose(attrgetter(name)(ours), value, rtol=1e-12, atol=1e-15, err_msg=name)


def _changed(source: Path, change: Callable[[Node], None], folder: Path) -> Path:
    """A copy of the source's folder, by links, in which that one file is changed."""
    folder.mkdir()
    for each in source.parent.iterdir():
        (folder / each.name).symlink_to(each)
    root = etree.parse(str(source)).getroot()
    change(root)
    (folder / "changed.xml").write_bytes(etree.tostring(root))
    return folder / "changed.xml"


def _sizes(model: mujoco.MjModel) -> dict[str, int]:
    texts = ("nnames", "nnames_map", "npaths", "nbuffer")
    return {
        name: value
        for name in dir(model)
        if name.startswith("n") and isinstance(value := getattr(model, name), int) and name not in texts
    }


def _arrays(model: mujoco.MjModel) -> Iterator[tuple[str, Any]]:
    """Every array, but for texts and where they begin; every option and statistic."""
    for name in dir(model):
        if isinstance(value := getattr(model, name), np.ndarray) and not (name[0] == "_" or _is_text(name)):
            yield name, value
    for of in ("opt", "stat"):
        names = [name for name in dir(getattr(model, of)) if not name.startswith("_")]
        yield from ((f"{of}.{name}", getattr(getattr(model, of), name)) for name in names)


def _is_text(name: str) -> bool:
    return name in ("names", "names_map", "paths") or name.startswith("name_") or name.endswith("pathadr")


def _names(model: mujoco.MjModel) -> dict[str, list[str]]:
    kinds = "body jnt geom site cam light mesh mat tex pair exclude eq tendon actuator sensor key".split()
    text = model.names
    return {kind: [text[at : text.index(0, at)].decode() for at in getattr(model, f"name_{kind}adr")] for kind in kinds}


def _equal_by_name(ours: mujoco.MjModel, theirs: mujoco.MjModel) -> None:
    """Every number of bodies, joints, sites and actuators, and of the geoms of each body in their order."""
    for kind, prefix in (("body", "body"), ("joint", "jnt"), ("site", "site"), ("actuator", "actuator")):
        one, other = (
            {model_name: getattr(model, kind)(model_name) for model_name in _names(model)[prefix] if model_name}
            for model in (ours, theirs)
        )
        for name, view in one.items():
            for field in dir(view):
                value = getattr(view, field)
                if isinstance(value, np.ndarray) and not re.search("id$|adr$|num$", field):
                    np.testing.assert_allclose(
                        value, getattr(other[name], field), rtol=1e-12, err_msg=f"{name} {field}"
                    )
    for name in _names(ours)["body"]:
        rows = [
            slice(int(model.body(name).geomadr[0]), int(model.body(name).geomadr[0] + model.body(name).geomnum[0]))
            for model in (ours, theirs)
        ]
        for field in ("geom_type", "geom_pos", "geom_quat", "geom_size", "geom_dataid", "geom_rgba", "geom_group"):
            np.testing.assert_allclose(getattr(ours, field)[rows[0]], getattr(theirs, field)[rows[1]], rtol=1e-12)


def test_every_patch_has_a_change_by_hand_and_a_line() -> None:
    recipes = {path.stem for path in (RECIPES / "patches").glob("*.yaml")}
    assert recipes == HANDS.keys()
    text = (RECIPES / "patches" / "README.md").read_text(encoding="utf-8")
    assert all(f"[{name}.yaml]({name}.yaml)" in text for name in recipes)
