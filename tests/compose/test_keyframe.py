"""Keys of a recipe: what MuJoCo puts into each joint, actuator and mocap body when it is reset to them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

Compose = Callable[..., etree._Element | list[str]]
Built = Callable[..., mujoco.MjModel]

ARM = """
<mujoco model="arm"><worldbody>
  <body name="upper"><joint name="shoulder" ref="10"/><geom size=".1"/><site name="flange" pos="0 0 1"/>
    <body name="lower" pos="0 0 1"><joint name="slide" type="slide"/><geom size=".1"/></body></body>
  <body name="hip" pos="3 0 0"><joint name="hip" type="ball"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="shoulder" joint="shoulder"/><general name="slide" joint="slide" dyntype="filter"/></actuator>
  <keyframe><key name="home" time="2" qpos=".1 .2 1 0 0 0" ctrl="5 6" act="7"/><key name="up" qpos="1 2 1 0 0 0"/></keyframe>
</mujoco>
"""
HAND = """
<mujoco model="hand"><worldbody><geom size=".02"/><body name="palm"><joint name="finger"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="open" qpos=".5"/><key name="home" time="2" qpos=".7"/></keyframe></mujoco>
"""
LOOSE = """
<mujoco model="loose"><worldbody><body name="cube" pos="0 0 .2"><freejoint/><geom size=".1"/></body>
  <body name="goal" mocap="true" pos="0 0 .4"/></worldbody></mujoco>
"""
NESTED = """
recipe: 1
base: ./arm.xml
attach: {gripper: {model: ./hand.xml, site: flange}}
"""
SOURCES = {"arm.xml": ARM, "hand.xml": HAND, "loose.xml": LOOSE, "arm.yaml": NESTED}


class Reset:
    """A model reset to one of its keys; what it then has, by name."""

    def __init__(self, model: mujoco.MjModel, key: str) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, self.data, model.key(key).id)

    def qpos(self, joint: str) -> list[float]:
        return [*map(float, self.data.joint(joint).qpos)]

    def qvel(self, joint: str) -> list[float]:
        return [*map(float, self.data.joint(joint).qvel)]


@pytest.fixture
def built(tmp_path: Path) -> Built:
    def built(recipe: str, **files: str) -> mujoco.MjModel:
        for name, text in {**SOURCES, **files, "recipe.yaml": "recipe: 1\n" + recipe}.items():
            (tmp_path / name.replace("__", ".")).write_text(text)
        context = Context(environment={}, folder=tmp_path)
        done = build(ModelRequest(tmp_path / "recipe.yaml", verified=False), context)
        assert done is not None, [each.message for each in context.sink.diagnostics]
        for name, content in done.bundle.files.items():
            (tmp_path / "out" / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / "out" / name).write_bytes(content)
        return mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))

    return built


def names(model: mujoco.MjModel) -> list[str]:
    return [model.key(at).name for at in range(model.nkey)]


def test_every_vector_by_name(built: Built) -> None:
    model = built(
        "angle: degree\nbase: ./arm.xml\nattach:\n  loose: {model: ./loose.xml, pos: [1, 0, 0]}\n"
        "  cube: {model: ./hand.xml, joint: free}\n"
        "keyframe:\n  mine:\n    time: 3.5\n"
        "    qpos: {shoulder: 90, slide: 0.3, hip: [0, 1, 0, 0], loose/cube: [1, 2, 3, 0, 0, 0, 1], cube/: [4, 5, 6, 1, 0, 0, 0]}\n"
        "    qvel: {shoulder: -45, slide: 2, hip: [1, 2, 3], loose/cube: [1, 2, 3, 4, 5, 6]}\n"
        "    ctrl: {shoulder: 1.5, slide: 4}\n    act: {slide: 0.25}\n"
        "    mpos: {loose/goal: [7, 8, 9]}\n    mquat: {loose/goal: [0, 0, 1, 0]}\n"
    )
    key = Reset(model, "mine")
    assert key.data.time == 3.5
    assert key.qpos("shoulder") == [np.pi / 2]
    assert key.qpos("slide") == [0.3]
    assert key.qpos("hip") == [0, 1, 0, 0]
    assert key.qpos("cube/") == [4, 5, 6, 1, 0, 0, 0]
    cube = model.body("loose/cube").jntadr[0]
    at = model.jnt_qposadr[cube]
    dof = model.jnt_dofadr[cube]
    assert key.data.qpos[at : at + 7].tolist() == [1, 2, 3, 0, 0, 0, 1]
    assert key.data.qvel[dof : dof + 6].tolist() == [1, 2, 3, 4, 5, 6]
    assert key.qvel("shoulder") == [-np.pi / 4]
    assert key.qvel("slide") == [2]
    assert key.qvel("hip") == [1, 2, 3]
    assert key.data.actuator("shoulder").ctrl[0] == 1.5
    assert key.data.actuator("slide").ctrl[0] == 4
    assert key.data.act.tolist() == [0.25]
    assert key.data.mocap_pos.tolist() == [[7, 8, 9]]
    assert key.data.mocap_quat.tolist() == [[0, 0, 1, 0]]


def test_what_a_key_says_nothing_about_is_at_its_reference(built: Built) -> None:
    model = built(
        "base: ./arm.xml\nattach: {loose: {model: ./loose.xml, pos: [1, 0, 0], euler: [0, 0, 90deg]}}\n"
        "keyframe:\n  nothing: {}\n  some: {qpos: {slide: 1}, mpos: {loose/goal: [0, 0, 0]}}\n"
    )
    assert names(model) == ["home", "up", "nothing", "some"]
    nothing = Reset(model, "nothing").data
    some = Reset(model, "some").data
    assert nothing.qpos.tolist() == model.qpos0.tolist()
    expected = model.qpos0.copy()
    expected[model.joint("slide").qposadr[0]] = 1
    assert some.qpos.tolist() == expected.tolist()
    assert some.mocap_quat.tolist() == nothing.mocap_quat.tolist()
    assert nothing.mocap_pos.tolist() == [[1, 0, 0.4]]
    assert not some.ctrl.any() and not some.qvel.any()


def test_keys_of_parts_and_of_their_parts_the_deepest_wins(built: Built) -> None:
    model = built(
        "base: ./arm.xml\nattach:\n  left: {model: ./arm.yaml, pos: [0, 1, 0]}\n  right: {model: ./arm.yaml}\n"
        "keyframe:\n  ready:\n    time: 0\n"
        "    from: {left/gripper: open, left: home, base: up, right/base: up, right/gripper: home}\n"
        "    qpos: {right/slide: 9}\n"
    )
    key = Reset(model, "ready")
    assert key.qpos("left/shoulder") == [0.1]
    assert key.qpos("left/gripper/finger") == [0.5]
    assert key.qpos("shoulder") == [1]
    assert key.qpos("slide") == [2]
    assert key.qpos("right/shoulder") == [1]
    assert key.qpos("right/slide") == [9]
    assert key.qpos("right/gripper/finger") == [0.7]
    assert key.data.act.tolist() == [0, 7, 0]
    assert key.data.actuator("right/slide").ctrl[0] == 0


def test_keys_that_are_left_out_may_be_used(built: Built) -> None:
    model = built(
        "base: {model: ./arm.xml, drop: [key]}\nattach:\n"
        "  hand: {model: ./hand.xml, site: flange, drop: [key]}\n"
        "  other: {model: ./arm.yaml, drop: [key]}\n"
        "keyframe: {mine: {from: {base: up, hand: open, other/gripper: open}}}\n"
    )
    assert names(model) == ["mine"]
    key = Reset(model, "mine")
    assert (key.qpos("slide"), key.qpos("hand/finger")) == ([2], [0.5])
    assert key.qpos("other/gripper/finger") == [0.5]
    assert key.qpos("other/slide") == [0]


def test_keys_that_are_left_out_and_not_asked_for_are_gone(built: Built) -> None:
    model = built("base: {model: ./arm.xml, drop: [key]}\nkeyframe: {mine: {qpos: {slide: 3}}}\n")
    assert names(model) == ["mine"]
    assert Reset(model, "mine").qpos("slide") == [3]


def test_a_written_key_replaces_the_automatic_one_in_its_place(built: Built) -> None:
    model = built(
        "base: ./arm.xml\nattach: {hand: {model: ./hand.xml, site: flange, keys: prefix}}\n"
        "keyframe: {home: {from: {base: up}}, hand/home: {qpos: {hand/finger: 0.25rad}}}\n"
    )
    assert names(model) == ["home", "up", "hand/open", "hand/home"]
    assert Reset(model, "home").qpos("shoulder") == [1]
    assert Reset(model, "hand/home").qpos("hand/finger") == [0.25]
    assert not Reset(model, "home").data.ctrl.any()


def test_a_nested_recipe_hands_on_the_key_that_it_writes(built: Built) -> None:
    inner = NESTED + "keyframe: {home: {from: {gripper: open}, qpos: {slide: 4}}}\n"
    model = built(
        "attach: {left: {model: ./inner.yaml}}\nkeyframe: {also: {from: {left: home}}, old: {from: {left/base: home}}}\n",
        inner__yaml=inner,
    )
    assert Reset(model, "home").qpos("left/slide") == [4]
    assert Reset(model, "also").data.qpos.tolist() == Reset(model, "home").data.qpos.tolist()
    assert Reset(model, "old").qpos("left/slide") == [0.2]


def test_free_joints_and_mocap_bodies_move_through_two_compositions(built: Built) -> None:
    keyed = LOOSE.replace(
        "</mujoco>", '<keyframe><key name="home" qpos="1 0 0 1 0 0 0" mpos="1 0 0"/></keyframe></mujoco>'
    )
    inner = "recipe: 1\nattach: {loose: {model: ./keyed.xml, pos: [0, 0, 1], keys: prefix}}\n"
    model = built(
        "attach: {outer: {model: ./inner.yaml, euler: [0, 0, 90deg]}}\nkeyframe: {mine: {from: {outer/loose: home}}}\n",
        keyed__xml=keyed,
        inner__yaml=inner,
    )
    key = Reset(model, "mine")
    half = np.sqrt(0.5)
    np.testing.assert_allclose(key.data.qpos, [0, 1, 1, half, 0, 0, half], atol=1e-12)
    np.testing.assert_allclose(key.data.mocap_pos, [[0, 1, 1]], atol=1e-12)


def test_keys_of_a_subtree_of_a_nested_recipe(built: Built) -> None:
    model = built(
        "attach: {part: {model: ./arm.yaml, subtree: upper, drop: [key]}}\n"
        "keyframe: {mine: {from: {part: home, part/gripper: open}}}\n"
    )
    key = Reset(model, "mine")
    assert key.qpos("part/slide") == [0.2]
    assert key.qpos("part/gripper/finger") == [0.5]


def test_times(compose: Compose) -> None:
    files = {"arm__xml": ARM, "hand__xml": HAND.replace('time="2"', 'time="3"')}
    parts = "recipe: 1\nattach: {a: {model: ./arm.xml, drop: [key]}, h: {model: ./hand.xml, drop: [key]}}\n"
    assert compose(parts + "keyframe:\n  k:\n    from: {a: home, h: home}\n", **files) == ["5:5 keyframe-conflict"]
    model = compose(parts + "keyframe:\n  k:\n    time: 1\n    from: {a: home, h: home}\n", **files)
    assert not isinstance(model, list)
    assert model.xpath("keyframe/key/@time") == ["1"]


def test_a_written_key_settles_what_two_parts_do_not_agree_about(compose: Compose) -> None:
    files = {"arm__xml": ARM, "hand__xml": HAND.replace('time="2"', 'time="3"')}
    recipe = "recipe: 1\nbase: ./arm.xml\nattach: {hand: {model: ./hand.xml, site: flange}}\n"
    assert compose(recipe, **files) == ["hand.xml3:64 keyframe-conflict"]
    model = compose(recipe + "keyframe: {home: {time: 1, from: {base: home, hand: home}}}\n", **files)
    assert not isinstance(model, list)
    assert model.xpath("keyframe/key/@name") == ["home", "up", "open"]
    assert model.xpath("keyframe/key/@time") == ["1"]


@pytest.mark.parametrize(
    ("key", "fault"),
    [
        ("{qpos: {elbow: 1}}", "4:14 unknown-name"),
        ("{qpos: {b: 1}}", "4:14 unknown-name"),
        ("{qpos: {hip: 1}}", "4:19 wrong-length"),
        ("{qvel: {hip: [1, 2, 3, 4]}}", "4:19 wrong-length"),
        ("{qpos: {slide: [1, 2]}}", "4:21 wrong-length"),
        ("{qpos: {shoulder: 1}}", "4:24 bare-angle"),
        ("{qvel: {shoulder: 1}}", "4:24 bare-angle"),
        ("{ctrl: {hip: 1}}", "4:14 unknown-name"),
        ("{act: {shoulder: 1}}", "4:23 wrong-length"),
        ("{mpos: {upper: [1, 2, 3]}}", "4:14 unknown-name"),
        ("{from: {base: hom}}", "4:20 unknown-name"),
        ("{from: {bas: home}}", "4:14 unknown-name"),
    ],
)
def test_faults(compose: Compose, key: str, fault: str) -> None:
    assert compose(f"recipe: 1\nbase: ./arm.xml\nkeyframe:\n  k: {key}\n", arm__xml=ARM) == [fault]


def test_a_joint_without_a_name_goes_by_its_body_where_that_means_it_alone(built: Built, compose: Compose) -> None:
    arm = """
<mujoco><worldbody>
  <body name="alone"><joint/><geom size=".1"/></body>
  <body name="taken"><joint/><geom size=".1"/></body>
  <body name="two"><joint/><joint axis="0 1 0"/><geom size=".1"/></body>
  <body name="other"><joint name="taken"/><geom size=".1"/></body></worldbody></mujoco>
"""
    model = built("base: ./two.xml\nangle: radian\nkeyframe: {k: {qpos: {alone: 1, taken: 2}}}\n", two__xml=arm)
    assert [*model.key("k").qpos] == [1, 0, 0, 0, 2]
    recipe = "recipe: 1\nangle: radian\nbase: ./two.xml\nkeyframe: {k: {qpos: {two: 1}}}\n"
    assert compose(recipe, two__xml=arm) == ["4:23 unknown-name"]


@pytest.mark.parametrize("key", ["{qpos: {shoulder: 0}}", "{qpos: {slide: 1}}", "{ctrl: {shoulder: 1}}", "{}"])
def test_no_unit_is_needed(compose: Compose, key: str) -> None:
    model = compose(f"recipe: 1\nbase: ./arm.xml\nkeyframe:\n  k: {key}\n", arm__xml=ARM)
    assert not isinstance(model, list)


def test_joints_of_what_mujoco_expands_cannot_be_set(compose: Compose) -> None:
    base = ARM[: ARM.index("<keyframe>")] + "</mujoco>"
    base = base.replace(
        '<body name="upper">',
        '<replicate count="2"><body name="r"><joint name="r"/><geom size="1"/></body></replicate><body name="upper">',
    )
    assert compose("recipe: 1\nbase: ./arm.xml\nkeyframe: {k: {qpos: {r0: 1}}}\n", arm__xml=base) == [
        "3:23 not-supported"
    ]


def test_a_key_after_faults_of_others_tells_its_own(compose: Compose) -> None:
    """What was lost with another fault is no second one."""
    found = compose(
        "recipe: 1\nbase: ./arm.xml\nadd:\n  - {to: nowhere, body: {name: x, joint: {name: lost}, geom: {size: [1]}}}\n"
        "keyframe:\n  k: {qpos: {lost: 1, wrong: 1}}\n",
        arm__xml=ARM,
    )
    assert found == ["4:10 unknown-name", "6:23 unknown-name"]


def _is_the_reference(model: mujoco.MjModel, key: str, *but: str) -> None:
    """What a key says nothing about is where MuJoCo has it."""
    reset = Reset(model, key)
    reference = mujoco.MjData(model)
    own = {int(model.joint(joint).qposadr[0]) for joint in but}
    others = [at for at in range(model.nq) if at not in own]
    assert np.allclose(reset.data.qpos[others], reference.qpos[others], atol=1e-12)
    assert np.allclose(reset.data.mocap_pos, reference.mocap_pos, atol=1e-12)


@pytest.mark.mujoco4("MuJoCo 3 refuses keys beside joints in a replicate")
def test_the_reference_of_what_the_recipe_adds_and_mujoco_expands(built: Built) -> None:
    model = built(
        """
base: ./loose.xml
add:
  - {to: world, body: {name: swing, joint: {name: swing}, geom: {size: [0.1]}}}
  - to: world
    replicate: {count: 2, offset: [1, 0, 0], body: {name: ball, pos: [0, 0, 1], freejoint: {}, geom: {size: [0.1]}}}
  - to: world
    replicate: {count: 2, offset: [1, 0, 0], body: {name: arm, joint: {name: arm, ref: 30deg}, geom: {size: [0.1]}}}
  - to: world
    replicate: {count: 2, offset: [1, 0, 0], body: {name: mark, mocap: true, pos: [0, 0, 3]}}
  - to: world
    body:
      name: brick
      pos: [0, 0, 2]
      freejoint: {align: true}
      geom: {type: box, size: [0.1, 0.2, 0.3], pos: [1, 2, 3]}
keyframe: {k: {qpos: {swing: 0.3rad}, mquat: {goal: [1, 0, 0, 0]}, mpos: {goal: [0, 0, 0.4]}}}
"""
    )
    assert model.nmocap == 3
    _is_the_reference(model, "k", "swing")


@pytest.mark.mujoco4("MuJoCo 3 refuses keys beside joints in a replicate")
def test_the_reference_of_what_the_recipe_edits_and_mujoco_expands(built: Built) -> None:
    parts = """
<mujoco><worldbody><body name="swing"><joint name="swing"/><geom size=".1"/></body>
  <replicate count="2" offset="1 0 0"><body name="ball" pos="0 0 1"><freejoint/><geom size=".1"/></body></replicate>
  <replicate count="2" offset="1 0 0"><body name="arm"><joint name="arm" ref="10"/><geom size=".1"/></body></replicate>
  <replicate count="2" offset="1 0 0"><body name="mark" mocap="true" pos="0 0 3"/></replicate>
  <body name="brick" pos="0 0 2"><freejoint align="true"/><geom type="box" size=".1 .2 .3" pos="1 2 3"/></body>
</worldbody><keyframe><key name="home" qpos="0.2"/></keyframe></mujoco>
"""
    model = built(
        """
base: ./parts.xml
attach: {two: {model: ./parts.xml, pos: [0, 0, 10]}}
edit:
  - {select: {body: "**/{ball,mark,brick}"}, set: {pos: [0, 0, 5]}}
  - {select: {joint: "**/arm"}, set: {ref: 30deg}}
keyframe: {k: {qpos: {swing: 0.3rad}, mpos: {}}}
""",
        parts__xml=parts,
    )
    _is_the_reference(model, "home", "swing", "two/swing")
    _is_the_reference(model, "k", "swing")


def test_a_flex_that_the_recipe_adds(built: Built) -> None:
    model = built(
        """
base: ./arm.xml
add:
  - to: world
    flexcomp: {name: rope, type: grid, count: [3, 1, 1], spacing: [0.1, 0.1, 0.1], dim: 1, radius: 0.01}
"""
    )
    assert Reset(model, "up").qpos("shoulder") == [1.0]
    _is_the_reference(model, "up", "shoulder", "slide")


def test_keys_stay_where_mujoco_is_asked_anew_for_the_state_of_an_edited_actuator(built: Built) -> None:
    servo = """
<mujoco><default><position timeconst="0.1"/></default>
  <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><position name="servo" joint="j"/></actuator>
  <keyframe><key name="home" qpos="0.3" act="0.2" ctrl="0.4"/></keyframe></mujoco>
"""
    model = built("base: ./servo.xml\nedit:\n  - {select: {actuator: servo}, set: {gear: [2]}}", servo__xml=servo)
    assert model.actuator("servo").gear[0] == 2
    home = model.key("home")
    assert [*home.qpos, *home.act, *home.ctrl] == [0.3, 0.2, 0.4]


# -- a free joint of a part inside a part -----------------------------------------------------------------------

SUB = """
<mujoco model="sub"><worldbody><body name="cube" pos="0 0 1"><freejoint name="free"/><geom size=".1"/></body></worldbody>
  {}</mujoco>
"""
SUB_KEY = '<keyframe><key name="home" qpos="0 0 2 1 0 0 0"/></keyframe>'
CARRIER = """
<mujoco model="carrier"><asset><model name="sub" file="sub.xml"/></asset><worldbody><frame pos="0 0 .25">
  <attach model="sub" body="cube" prefix="s/"/></frame></worldbody>{}</mujoco>
"""
HIGHER = "attach: {p: {model: ./carrier.%s, pos: [0, 0, 0.5]}}"


def heights(model: mujoco.MjModel) -> dict[str, float]:
    return {name: float(model.key(name).qpos[2]) for name in names(model)}


def test_a_key_moves_with_every_recipe_that_attaches_it(built: Built) -> None:
    nested = "recipe: 1\nattach: {s: {model: ./sub.xml, pos: [0, 0, 0.25]}}"
    model = built(HIGHER % "yaml", sub__xml=SUB.format(SUB_KEY), carrier__yaml=nested)
    assert heights(model) == {"home": 2.75}


def test_a_key_is_in_the_world_of_the_model_that_writes_it(built: Built, tmp_path: Path) -> None:
    own = SUB_KEY.replace("0 0 2", "0 0 3")
    model = built(HIGHER % "xml", sub__xml=SUB.format(""), carrier__xml=CARRIER.format(own))
    assert heights(model) == {"home": 3.5}
    alone = mujoco.MjModel.from_xml_path(str(tmp_path / "carrier.xml"))
    assert heights(alone) == {"home": 3}  # above the carrier's world, not above the frame


def test_keys_that_mujoco_itself_brings_stay_where_it_leaves_them(built: Built, tmp_path: Path) -> None:
    files = {"sub.xml": SUB.format(SUB_KEY), "carrier.xml": CARRIER.format("")}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert heights(mujoco.MjModel.from_xml_path(str(tmp_path / "carrier.xml"))) == {"s/home": 2}
    (tmp_path / "recipe.yaml").write_text("recipe: 1\n" + HIGHER % "xml")
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(tmp_path / "recipe.yaml", verified=False), context) is None
    (fault,) = context.sink.errors
    assert fault.code == "not-supported" and "`p/` moves it" in fault.message


MOTOR = """
<mujoco model="m"><worldbody><body name="b" pos="0 0 1"><joint name="j" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/></body></worldbody>
  <actuator><motor name="m" joint="j"/></actuator><keyframe><key name="old" qpos=".1" ctrl="7"/></keyframe></mujoco>
"""


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("{qpos: {j: 0.3rad}, ctrl: {m: 0.2rad}}", 0.2),
        ("{qpos: {j: 0.3rad}, ctrl: hold}", 0.3),
        ("{qpos: {j: 0.3rad}, ctrl: {m: hold}}", 0.3),
        ("{qpos: {j: 0.3rad}, ctrl: {joint: {j: 0.25rad}}}", 0.25),
        ("{from: {base: old}}", 0),
        ("{from: {base: old}, ctrl: {m: 0.2rad}}", 0.2),
    ],
)
def test_an_edit_empties_only_the_keys_that_are_older(built: Built, key: str, expected: float) -> None:
    convert = "edit: [{select: {actuator: m}, convert: {to: position, kp: 4}}]"
    for name in ("new", "old"):  # of the same name as the key of the source, too
        model = built(f"base: ./m.xml\n{convert}\nkeyframe: {{{name}: {key}}}", **{"m.xml": MOTOR})
        assert model.key(name).ctrl == pytest.approx([expected])
    nested = "attach: {x: {model: ./in.yaml}}\nedit: [{select: {actuator: x/m}, convert: {to: position, kp: 4}}]"
    inner = "recipe: 1\nbase: ./m.xml\nkeyframe: {mine: {ctrl: {m: 3}}}"
    model = built(nested + "\nkeyframe: {new: {ctrl: {x/m: 1rad}}}", **{"m.xml": MOTOR, "in.yaml": inner})
    assert (model.key("mine").ctrl, model.key("old").ctrl, model.key("new").ctrl) == ([0], [0], [1])


POSTS = """
<mujoco model="posts"><worldbody><body name="first" pos="9 0 0"><joint name="fj"/><geom size=".1"/></body>
  <replicate count="2" offset="0 1 0"><body name="post"><joint name="pj"/><geom size=".1"/><site name="hook" pos="0 0 .2"/>
    <replicate count="2" offset="0 0 1" sep="_"><body name="leaf"><joint name="lj" type="slide"/><geom size=".1"/></body>
    </replicate></body></replicate>
  <body name="last" pos="3 0 0"><joint name="last" ref="20"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="pm" joint="pj"/><general name="lm" joint="last" dyntype="filter"/></actuator>
  <keyframe><key name="k" qpos="1 2 3 4 5 6 7 8" qvel="10 20 30 40 50 60 70 80" act="5" ctrl="9 11 12"/></keyframe></mujoco>
"""
POSTED = {"fj": 1, "pj0": 2, "lj_00": 3, "lj_10": 4, "pj1": 5, "lj_01": 6, "lj_11": 7, "last": 8}
ARMLET = """
<mujoco model="armlet"><worldbody><body name="a"><joint name="j"/><geom size=".1"/>
  <replicate count="2" offset="0 0 1"><body name="tip"><joint name="t"/><geom size=".1"/></body></replicate></body></worldbody>
  <actuator><position name="m" joint="t" kp="3"/></actuator>
  <keyframe><key name="k" qpos=".1 .2 .3" ctrl=".4 .5"/></keyframe></mujoco>
"""


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
@pytest.mark.parametrize(
    ("recipe", "changed"),
    [
        ("add: [{to: post, body: {name: flag, joint: {name: new}, geom: {size: 0.02}}}]", {"new0": 0, "new1": 0}),
        ("add: [{to: leaf, body: {name: flag, joint: {name: new}, geom: {size: 0.02}}}]", {"new_01": 0}),
        ("edit: [{select: {body: first}, move: {to: leaf}}]", {"fj": None, "fj_00": 1, "fj_11": 1}),
        (
            "edit: [{select: {joint: lj}, set: {type: ball}}]",
            {each: [1, 0, 0, 0] for each in POSTED if each[:2] == "lj"},
        ),
        ("edit: [{select: {joint: lj}, remove: true}]", {each: None for each in POSTED if each[:2] == "lj"}),
        (
            "edit: [{select: {body: leaf}, remove: true}]\nattach: {t: {model: ./armlet.xml, site: hook}}",
            {each: None for each in POSTED if each[:2] == "lj"} | {"t/j0": 0.1, "t/t01": 0.2, "t/t10": 0.3},
        ),
        (
            "attach: {t: {model: ./armlet.xml, site: hook}, u: {model: ./armlet.xml, pos: [7, 0, 0]}}",
            {"t/j0": 0.1, "t/j1": 0.1, "t/t00": 0.2, "t/t10": 0.3, "t/t01": 0.2, "t/t11": 0.3, "u/t1": 0.3},
        ),
    ],
)
def test_keys_follow_what_is_inside_of_a_replicate(built: Built, recipe: str, changed: dict[str, object]) -> None:
    model = built(f"base: ./posts.xml\n{recipe}", **{"posts.xml": POSTS, "armlet.xml": ARMLET})
    reset = Reset(model, "k")
    names = {model.joint(at).name for at in range(model.njnt)}
    for joint, value in (POSTED | changed).items():
        if value is None:
            assert joint not in names
        else:
            assert reset.qpos(joint) == pytest.approx(np.atleast_1d(value)), joint
            if joint in POSTED and joint not in changed:
                assert reset.qvel(joint) == [10 * POSTED[joint]]
    key = model.key("k")
    assert [float(key.ctrl[model.actuator(each).id]) for each in ("lm", "pm0", "pm1")] == [9, 11, 12]
    if "t/m01" in {model.actuator(at).name for at in range(model.nu)}:
        found = [float(key.ctrl[model.actuator(f"t/m{each}").id]) for each in ("00", "10", "01", "11")]
        assert found == [0.4, 0.5, 0.4, 0.5]


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_copies_that_differ_cannot_leave_their_replicate(built: Built) -> None:
    with pytest.raises(AssertionError, match="different numbers for the copies of `lj`"):
        built("base: ./posts.xml\nedit: [{select: {body: leaf}, move: {to: world}}]", **{"posts.xml": POSTS})


CLOTH = """
<mujoco model="cloth"><worldbody><body name="holder"><geom size=".05"/>
  <flexcomp name="c" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" mass=".1" radius=".01"><pin id="0"/>
    <edge equality="true"/><contact selfcollide="none"/></flexcomp></body>
  <body name="after" pos="0 1 1"><joint name="aj" axis="0 1 0"/><geom size=".05"/></body></worldbody>
  <keyframe><key name="k" qpos="1 2 3 4 5 6 7 8 9 10"/></keyframe></mujoco>
"""


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize(
    "shape", ["{select: {flexcomp: c}, set: {count: [3, 2, 1]}}", "{select: {pin: '*'}, set: {id: [1]}}"]
)
def test_a_flexcomp_of_another_shape_starts_at_its_reference(tmp_path: Path, own: bool, shape: str) -> None:
    """Of its vertices nothing is known, and what stands behind it keeps its numbers."""
    (tmp_path / "c.xml").write_text(CLOTH)
    entry = f"edit: [{shape}]"
    (tmp_path / "r.yaml").write_text(
        f"recipe: 1\nbase: {{model: ./c.xml, {entry}}}" if own else f"recipe: 1\nbase: ./c.xml\n{entry}"
    )
    context = Context(environment={}, folder=tmp_path)
    done = build(ModelRequest(tmp_path / "r.yaml"), context)
    if done is None:
        assert "pin" in shape  # not every edit reaches what is inside of a `<flexcomp>`
        assert {each.code for each in context.sink.errors} <= {"selector", "wrong-type", "unknown-element"}
        return
    model = mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())
    reset = Reset(model, "k")
    assert reset.qpos("aj") == [10]
    assert not reset.data.qpos[: model.joint("aj").qposadr[0]].any()
    assert "keyframe-conflict" in [each.code for each in context.sink.diagnostics]


ROD = """
<mujoco model="rod"><worldbody><body name="holder" pos="0 0 1"><joint name="hj" axis="0 1 0"/><geom size=".05"/>
  <flexcomp name="rod" type="grid" count="4 1 1" spacing=".1 .1 .1" dim="1" mass=".1" radius=".01" pos=".3 0 0">
    <edge equality="true"/><elasticity young="1e5" poisson="0"/><pin id="0"/><contact selfcollide="none"/></flexcomp>
  <body name="in"><joint name="ij"/><geom size=".05"/></body></body>
  <body name="after" pos="0 1 1"><joint name="aj" axis="0 1 0"/><geom size=".05"/></body></worldbody>
  <keyframe><key name="k" qpos="1 2 3 4 5 6 7 8 9 10 11 12 13 14 15"/></keyframe></mujoco>
"""


@pytest.mark.skipif(mujoco.mj_versionString().startswith("3."), reason="rods twist since MuJoCo 4.0")
@pytest.mark.parametrize(
    "recipe",
    [
        "base: ./rod.xml\nattach: {t: {model: {add: [{to: world, body: {name: b, joint: {name: tj}, geom: {size: 1}}}]}, body: holder}}",
        "base: ./hand.xml\nattach: {t: {model: ./rod.xml, body: palm}}",
        "attach: {t: {model: ./rod.xml}, u: {model: ./rod.xml, pos: [0, 0, 2], drop: [key]}}",
        "base: ./rod.xml\nadd: [{to: in, body: {name: flag, joint: {name: new}, geom: {size: 0.02}}}]",
    ],
)
def test_the_twists_of_a_rod_keep_their_numbers(built: Built, recipe: str) -> None:
    model = built(recipe, **{"rod.xml": ROD})
    prefix = "" if "base: ./rod.xml" in recipe else "t/"
    reset = Reset(model, "k")
    expected = {"hj": 1, "ij": 11, "rod_twist_0": 12, "rod_twist_1": 13, "rod_twist": 14, "aj": 15}
    assert {each: reset.qpos(prefix + each) for each in expected} == {a: [b] for a, b in expected.items()}
    for at in (1, 2, 3):
        first = model.jnt_qposadr[model.body(f"{prefix}rod_{at}").jntadr[0]]
        assert list(reset.data.qpos[first : first + 3]) == [3 * at - 1, 3 * at, 3 * at + 1]


@pytest.mark.skipif(mujoco.mj_versionString().startswith("3."), reason="rods twist since MuJoCo 4.0")
@pytest.mark.parametrize(
    "edit",
    ["{pin: '**'}, set: {id: [0, 1]}", "{elasticity: '**'}, set: {young: 0}", "{elasticity: '**'}, remove: true"],
)
def test_what_is_in_a_flexcomp_decides_on_its_joints(built: Built, edit: str) -> None:
    model = built(f"base: ./rod.xml\nedit: [{{select: {edit}}}]", **{"rod.xml": ROD})
    reset = Reset(model, "k")
    assert model.nq < 15
    assert [reset.qpos(each) for each in ("hj", "ij", "aj")] == [[1], [11], [15]]


@pytest.mark.parametrize("attribute", ["joint", "jointinparent"])
def test_a_control_by_the_joint_of_its_actuator(built: Built, attribute: str) -> None:
    motor = '<motor name="shoulder" joint="shoulder"/>'
    arm = ARM.replace(motor, f'<motor name="first" {attribute}="shoulder"/>')
    model = built("base: ./arm.xml\nkeyframe: {k: {ctrl: {joint: {shoulder: 3, slide: 4}}}}\n", arm__xml=arm)
    assert model.key("k").ctrl.tolist() == [3, 4]


def test_an_actuator_in_the_frame_of_the_parent_is_one_of_its_joint(tmp_path: Path) -> None:
    arm = """<mujoco><worldbody><body><joint name="turn"/><geom size=".1"/></body></worldbody>
      <actuator><position name="servo" jointinparent="turn" kp="1"/><position jointinparent="turn" kp="1"/></actuator></mujoco>"""

    def told(ctrl: str) -> str:
        (tmp_path / "arm.xml").write_text(arm)
        (tmp_path / "r.yaml").write_text(f"recipe: 1\nbase: ./arm.xml\nkeyframe: {{k: {{ctrl: {ctrl}}}}}\n")
        context = Context(environment={}, folder=tmp_path)
        assert build(ModelRequest(tmp_path / "r.yaml", verified=False), context) is None
        (fault,) = context.sink.errors
        return " ".join([fault.message, *(note.message for note in fault.notes), fault.help or ""])

    assert "joints with an actuator: turn" in told("{joint: {tun: 1}}")
    assert "which moves the hinge `turn`, is" in told("{servo: 1}")
    assert "write it by its joint: `ctrl: {joint: {turn: …}}`" in told("{turn: 1rad}")


LEGS = """<mujoco><compiler angle="radian"/><worldbody>
  <body name="FL"><joint name="FL_hip"/><joint name="FL_knee" axis="0 1 0"/><geom size=".1"/></body>
  <body name="FR"><joint name="FR_hip"/><joint name="FR_knee" axis="0 1 0"/><geom size=".1"/></body>
  <body name="hand" mocap="true"/></worldbody><actuator><position name="left" joint="FL_hip" kp="3"/>
  <position name="right" joint="FR_hip" kp="3"/><position joint="FL_knee" kp="2"/>
  <general name="slow" joint="FR_knee" dyntype="filter" dynprm="1"/></actuator></mujoco>"""


@pytest.mark.parametrize(
    ("key", "vector", "expected"),
    [
        ("qpos: {'*_hip': 0.3, '*_knee': -0.6, FR_knee: -0.7}", "qpos", [0.3, -0.6, 0.3, -0.7]),
        ("qvel: {'/F._(hip|knee)/': 2}", "qvel", [2, 2, 2, 2]),
        ("mpos: {'h*': [1, 2, 3]}", "mpos", [1, 2, 3]),
        ("act: {'sl*': 0.5}", "act", [0.5]),
        ("ctrl: {'*t': 0.2, right: 0.1}", "ctrl", [0.2, 0.1, 0, 0]),
        ("qpos: {'*': 0.4}, ctrl: {'*t': hold, right: 0.1}", "ctrl", [0.4, 0.1, 0, 0]),
        ("qpos: {'*': 0.4}, ctrl: {'*t': 0.1, right: hold}", "ctrl", [0.1, 0.4, 0, 0]),
        ("qpos: {'*': 0.4}, ctrl: {joint: {'FL_*': hold, FL_hip: 0.1}}", "ctrl", [0.1, 0, 0.4, 0]),
        # A name counts more than a glob, also where one is an actuator and the other is a joint.
        ("qpos: {'*': 0.4}, ctrl: {left: 0.1, joint: {'*_hip': 0.2}}", "ctrl", [0.1, 0.2, 0, 0]),
        (
            "qpos: {'*': 0.4}, ctrl: {joint: {'*_hip': 0.2, FL_hip: 0.3}, '*t': 0.5, right: hold}",
            "ctrl",
            [0.3, 0.4, 0, 0],
        ),
    ],
)
def test_globs(built: Built, key: str, vector: str, expected: list[float]) -> None:
    model = built(f"angle: radian\nbase: ./legs.xml\nkeyframe: {{k: {{{key}}}}}\n", legs__xml=LEGS)
    assert getattr(model.key("k"), vector) == pytest.approx(expected)


def test_a_glob_of_activations_counts_more_than_the_hold_of_all(built: Built) -> None:
    recipe = "angle: radian\nbase: ./legs.xml\nkeyframe: {k: {ctrl: {hold: forces}, act: {'s*': 0.5}}}\n"
    assert built(recipe, legs__xml=LEGS).key("k").act.tolist() == [0.5]
