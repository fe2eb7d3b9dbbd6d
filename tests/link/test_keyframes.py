from __future__ import annotations

import mujoco
import numpy as np
import pytest
from link.workshop import BASE, OLDER, Linked, Piece, Workshop, hinge, placed
from mjcompose.base.rotation import quat_from_axisangle
from mjcompose.link.keyframes import part_keys
from mjcompose.link.linking import Joint
from mjcompose.mujoco.compare import KeyMode
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.unit import texts

ARM = """
<mujoco model="arm"><worldbody>
  <body name="upper"><joint name="shoulder"/><geom size=".1"/>
    <body name="lower" pos="0 0 1"><joint name="elbow" axis="1 0 0"/><geom size=".1"/><site name="flange" pos="0 0 1"/>
      <body name="tail"><joint name="wag" axis="0 1 0"/><geom size=".05"/></body></body>
  </body>
  <body name="after" pos="3 0 0"><joint name="after" type="slide"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="shoulder" joint="shoulder"/><general name="elbow" joint="elbow" dyntype="filter"/></actuator>
  <keyframe><key name="home" time="2" qpos=".1 .2 .3 .4" qvel="1 2 3 4" ctrl="5 6" act="7"/>
    <key name="up" qpos="1 2 3 4"/></keyframe></mujoco>
"""
HAND = """
<mujoco model="hand"><worldbody>
  <geom name="root" size=".05" pos="0 0 -.1"/><body name="palm"><joint name="twist" ref="30"/><geom size=".1"/>
    <body name="finger"><joint name="ball" type="ball"/><geom size=".1" pos="0 0 .1"/></body></body></worldbody>
  <actuator><general joint="twist" dyntype="user" actdim="3"/><motor joint="twist"/></actuator>
  <keyframe><key name="home" qpos=".5 .6 .8 0 0" act="1 2 3" ctrl="8 9"/><key name="grip" time="3" qvel="1 2 3 4"/></keyframe>
</mujoco>
"""
PLAIN = '<mujoco><worldbody><body name="b" pos="0 0 1"><joint name="j" ref="10"/><geom size=".1"/></body></worldbody></mujoco>'


def key(model: mujoco.MjModel, name: str, vector: str) -> list[float]:
    values: list[float] = getattr(model, f"key_{vector}")[model.key(name).id].tolist()
    return values


def names(model: mujoco.MjModel) -> list[str]:
    return [model.key(at).name for at in range(model.nkey)]


def on_arm(workshop: Workshop, policy: KeyPolicy, **options: object) -> Linked:
    hand = Piece(HAND, "hand/", placed("site", "flange"), options={"keyframes": policy})
    return workshop.link(ARM, hand, **options)


def test_keys_of_one_name_become_one(workshop: Workshop) -> None:
    model = on_arm(workshop, "merge").check()
    assert names(model) == ["home", "up", "grip"]
    # The hand hangs in the middle of the arm: after its elbow's other child, before the arm's next body.
    assert key(model, "home", "qpos") == [0.1, 0.2, 0.3, 0.5, 0.6, 0.8, 0, 0, 0.4]
    assert key(model, "home", "ctrl") == [5, 6, 8, 9]
    assert key(model, "home", "act") == [7, 1, 2, 3]
    assert key(model, "home", "qvel") == [1, 2, 3, 0, 0, 0, 0, 4]
    assert model.key("home").time == 2
    assert model.key("grip").time == 3


def test_a_key_knows_all_keys_that_it_is_made_of(workshop: Workshop) -> None:
    linked = on_arm(workshop, "merge")
    made_of = {
        key.get("name"): [str(each.get("qpos")) for each in record.keys]
        for key, record in linked.linking.base.origins.keys.items()
    }
    assert made_of["home"] == [".1 .2 .3 .4", ".5 .6 .8 0 0"]
    assert made_of["up"] == ["1 2 3 4"]


def test_what_no_part_says_is_the_reference(workshop: Workshop) -> None:
    model = on_arm(workshop, "merge").check()
    assert key(model, "up", "qpos") == [1, 2, 3, *model.qpos0[3:8], 4]
    assert key(model, "grip", "qpos") == model.qpos0.tolist()
    assert key(model, "up", "ctrl") == [0, 0, 0, 0]


def test_keys_with_a_prefix_stay_apart(workshop: Workshop) -> None:
    model = on_arm(workshop, "prefix").check()
    assert names(model) == ["home", "up", "hand/home", "hand/grip"]
    assert key(model, "hand/home", "qpos") == [0, 0, 0, 0.5, 0.6, 0.8, 0, 0, 0]


def test_keys_may_be_left_out(workshop: Workshop) -> None:
    model = on_arm(workshop, "none").check()
    assert names(model) == ["home", "up"]


def test_keys_of_the_base_are_made_to_fit_a_part_without_any(workshop: Workshop) -> None:
    linked = workshop.link(ARM, Piece(PLAIN, place=placed("body", "upper")))
    model = linked.check()
    assert key(model, "home", "qpos") == pytest.approx([0.1, 0.2, 0.3, np.radians(10), 0.4])


def test_keys_of_a_part_are_made_to_fit_a_base_without_any(workshop: Workshop) -> None:
    linked = workshop.link(PLAIN, Piece(HAND, "h/"), Piece(PLAIN, "p/"))
    linked.check()


def test_a_model_without_parts_keeps_its_keys_as_they_are_written(workshop: Workshop) -> None:
    linked = workshop.link(ARM)
    assert 'qpos=".1 .2 .3 .4"' in linked.xml
    linked.check()


def test_no_keys_no_keyframe_section(workshop: Workshop) -> None:
    assert "keyframe" not in workshop.link(PLAIN, Piece(PLAIN)).xml


def test_unnamed_keys_stay_apart(workshop: Workshop) -> None:
    model = workshop.link(
        PLAIN.replace("</mujoco>", '<keyframe><key qpos="1"/><key name="" qpos="2"/></keyframe></mujoco>'),
        Piece(PLAIN.replace("</mujoco>", '<keyframe><key qpos="3"/><key/></keyframe></mujoco>')),
        Piece(
            PLAIN.replace("</mujoco>", '<keyframe><key qpos="4"/></keyframe></mujoco>'),
            "q/",
            options={"keyframes": "prefix"},
        ),
    ).check()
    assert model.nkey == 5
    ref = np.radians(10)
    assert model.key_qpos == pytest.approx(
        np.array([[1, ref, ref], [2, ref, ref], [ref, 3, ref], [ref, ref, ref], [ref, ref, 4]])
    )


def test_several_sections_of_keys_are_one(workshop: Workshop) -> None:
    base = PLAIN.replace(
        "</mujoco>", '<keyframe><key name="a"/></keyframe><keyframe><key name="b"/></keyframe></mujoco>'
    )
    model = workshop.link(base, Piece(base, options={"keyframes": "prefix"})).check()
    assert names(model) == ["a", "b", "part/a", "part/b"]


def test_padding_by_size_is_kept_with_its_model(workshop: Workshop) -> None:
    base = ARM.replace("<worldbody>", '<size nkey="4"/><worldbody>')
    linked = workshop.link(base, Piece(HAND, options={"keyframes": "prefix"}))
    model = linked.check()
    assert names(model) == ["home", "up", "", "", "part/home", "part/grip"]
    assert "nkey" not in linked.xml
    assert model.key_qpos[2].tolist() == model.qpos0.tolist()


@pytest.mark.parametrize(("policy", "severity"), [("error", "error"), ("base", "warning"), ("mujoco", "warning")])
def test_times_that_differ_are_told(workshop: Workshop, policy: str, severity: str) -> None:
    hand = HAND.replace('name="home"', 'name="home" time="5"')
    linked = workshop.link(ARM, Piece(hand), conflict=policy)
    (fault,) = linked.sink.diagnostics
    assert (fault.code, fault.severity.value) == ("keyframe-conflict", severity)
    assert fault.span is not None
    assert fault.span.file == str(linked.paths[1])
    assert [note.span.file for note in fault.notes if note.span] == [str(linked.paths[0])]


def test_equal_times_written_differently_are_equal(workshop: Workshop) -> None:
    hand = HAND.replace('name="home"', 'name="home" time="2.0"')
    assert not workshop.link(ARM, Piece(hand)).sink.diagnostics


@pytest.mark.parametrize("times", ["", ' time="2"'])
def test_a_key_has_the_time_of_any_part_that_gives_one(workshop: Workshop, times: str) -> None:
    base = PLAIN.replace("</mujoco>", f'<keyframe><key name="home"{times} qpos="1"/></keyframe></mujoco>')
    second = Piece(base.replace(times, ""), "second/")
    third = Piece(base.replace('name="home"' + times, 'name="home" time="2"'), "third/")
    model = workshop.link(base, second, third).check()
    assert (names(model), model.key_time.tolist()) == (["home"], [2])


@pytest.mark.parametrize("vector", ["qpos", "qvel", "act", "ctrl", "mpos", "mquat"])
def test_a_row_that_is_too_long_is_told(workshop: Workshop, vector: str) -> None:
    base = PLAIN.replace("</mujoco>", f'<keyframe>\n<key {vector}="1 2 3 4 5"/></keyframe></mujoco>')
    fault = workshop.link(base, BASE).fault
    assert (fault.code, fault.span and fault.span.line) == ("keyframe-conflict", 2)
    assert f"`{vector}`" in fault.message


MIXED = """
<mujoco><worldbody>
  <body name="b"><joint type="slide" ref="1"/><joint ref="90"/><geom size=".1"/>
    <body name="c"><joint type="ball"/><geom size=".1"/></body></body>
  <body name="f" pos="1 2 3" euler="10 20 30"><freejoint/><geom size=".1"/></body>
  <body name="m" mocap="true" pos="4 5 6" euler="40 50 60"/><body name="n" mocap="true"/></worldbody>
  <actuator><motor joint="j"/><motor joint="j"/></actuator>
  <keyframe><key name="k" {row}/></keyframe></mujoco>
""".replace('<joint ref="90"/>', '<joint ref="90" name="j"/>')
SHORT = [
    'qpos="7"',
    'qpos="7 8"',
    'qpos="7 8 1 0 0 0"',
    'qvel="7"',
    'qvel="7 8 1 2 3"',
    'ctrl="3"',
    'mpos="1 2 3"',
    'mpos="1 2 3 4"',
    'mpos="1 2"',
    'mquat="1 1 0 0"',
    'mquat="0 2 0 0 1 2"',
    'mquat="0 0 0 0 0 1 0 0"',
    'qpos=""',
    'qpos="" ctrl="1 2"',
    "",
]


@pytest.mark.parametrize("row", SHORT)
@pytest.mark.mujoco4("keys of other lengths are refused, and replicated ones are copied")
def test_short_rows_are_filled_up_as_mujoco_does(workshop: Workshop, row: str) -> None:
    mixed = MIXED.format(row=row)
    workshop.link(mixed, Piece(HAND)).check()
    workshop.link(HAND, Piece(mixed)).check()


@pytest.mark.parametrize("row", ['qpos="7 8 1 0"', 'qpos="7 8 1 0 0 0 1 2 3"', 'qvel="7 8 1"'])
@pytest.mark.mujoco4("keys of other lengths are refused")
def test_a_row_that_ends_inside_a_joint_is_filled_up_as_mujoco_does(workshop: Workshop, row: str) -> None:
    mixed = MIXED.format(row=row)
    workshop.link(BASE, mixed).check()
    workshop.link(mixed, Piece(HAND)).check()
    fault = workshop.link(BASE, mixed, measure=None).fault
    assert fault.code == "keyframe-conflict"


PROP = """
<mujoco model="prop"><worldbody>
  <body name="cup" pos="1 2 3" euler="10 20 30"><freejoint/><geom size=".1"/></body>
  <body name="hoop" mocap="true" pos="4 5 6" axisangle="0 1 0 40"/>
  <frame pos="1 1 1" euler="0 0 45"><body name="box" xyaxes="0 1 0 -1 0 0"><joint type="free"/><geom size=".1"/></body>
    <body name="target" mocap="true" zaxis="1 1 0"/></frame>
  <body name="lid"><joint/><geom size=".1"/></body></worldbody>
  {keys}</mujoco>
"""
KEYED = PROP.format(
    keys="""<keyframe>
  <key name="home" qpos=".1 .2 .3 0 1 0 0 4 5 6 .5 .5 .5 .5 7" qvel="1 2 3 4 5 6 7 8 9 10 11 12 13"
    mpos="1 2 3 4 5 6" mquat="0 2 0 0 1 1 0 0"/><key name="rest"/></keyframe>"""
)
PLACES = [
    placed(),
    placed(pos=(1.0, 2.0, 3.0)),
    placed(pos=(1.0, 2.0, 3.0), quat=(0.5, 0.5, -0.5, 0.5)),
    placed(quat=(0.9, 0.1, 0.2, 0.3)),
]


@pytest.mark.parametrize("place", PLACES)
def test_free_joints_and_mocap_bodies_move_with_their_part(workshop: Workshop, place: object) -> None:
    piece = Piece(KEYED, place=place)  # type: ignore[arg-type]
    model = workshop.link(ARM, piece).check()
    # What the part says nothing about is where the bodies are.
    assert key(model, "up", "mpos") if "mpos" in names(model) else True
    rest = model.key("rest").id
    assert model.key_qpos[rest] == pytest.approx(model.qpos0, abs=1e-15)


@pytest.mark.parametrize("place", PLACES)
def test_keys_of_the_base_hold_the_moved_reference_of_a_part(workshop: Workshop, place: object) -> None:
    free = PROP.format(keys="")
    mocap = """<mujoco><worldbody><body name="m" mocap="true" pos="1 0 0"/></worldbody>
      <keyframe><key name="k" mpos="7 8 9" mquat="0 1 0 0"/></keyframe></mujoco>"""
    model = workshop.link(mocap, Piece(free, place=place)).check()  # type: ignore[arg-type]
    assert key(model, "k", "qpos") == pytest.approx(model.qpos0.tolist())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    expected = mujoco.MjData(model)
    assert data.mocap_pos[1:] == pytest.approx(expected.mocap_pos[1:])
    assert data.mocap_quat[1:] == pytest.approx(expected.mocap_quat[1:])


def test_a_part_on_a_part_carries_its_free_bodies_through_both(workshop: Workshop) -> None:
    stand = """<mujoco><worldbody><body name="stand" pos="0 0 1" euler="0 90 0"><geom size=".1"/></body>
      <site name="spot" pos="1 1 1" euler="30 0 0"/></worldbody></mujoco>"""
    workshop.link(
        BASE,
        Piece(KEYED, "prop/", placed(pos=(1.0, 0.0, 0.0), quat=(0.0, 1.0, 0.0, 0.0))),
        Piece(KEYED, "other/", placed(pos=(-1.0, 0.0, 0.0)), options={"keyframes": "prefix"}),
        Piece(stand, "stand/", placed(pos=(0.0, 1.0, 0.0))),
    ).check()


def test_a_floating_part_starts_where_it_is_placed(workshop: Workshop) -> None:
    joint = Joint("freejoint", {"name": "hand/"})
    model = workshop.link(
        ARM, Piece(HAND, "hand/", placed("site", "flange", pos=(0.0, 0.0, 0.5)), options={"joints": (joint,)})
    ).model()
    at = model.jnt_qposadr[model.joint("hand/").id]
    assert key(model, "home", "qpos")[at : at + 7] == [0, 0, 2.5, 1, 0, 0, 0]
    assert key(model, "home", "qpos")[at + 7 :] == [0.5, 0.6, 0.8, 0, 0]


def test_joints_of_an_attachment_start_at_their_reference(workshop: Workshop) -> None:
    joints = (
        hinge(name="hand/a", ref="90"),
        Joint("joint", {"type": "slide", "name": "hand/b", "ref": "2", "class": "main"}),
    )
    model = workshop.link(ARM, Piece(HAND, "hand/", placed("site", "flange"), options={"joints": joints})).model()
    home = dict(zip([model.joint(at).name for at in range(5)], key(model, "home", "qpos"), strict=False))
    assert home["hand/a"] == pytest.approx(np.pi / 2)
    assert home["hand/b"] == 2


def test_a_welded_part_forgets_its_free_joint(workshop: Workshop) -> None:
    part = PROP.format(keys="").replace('<body name="hoop" mocap="true" pos="4 5 6" axisangle="0 1 0 40"/>', "")
    part = part.replace('<body name="target" mocap="true" zaxis="1 1 0"/>', "").replace(
        "</mujoco>", '<keyframe><key name="home" qpos=".1 .2 .3 0 1 0 0 4 5 6 .5 .5 .5 .5 7"/></keyframe></mujoco>'
    )
    piece = Piece(part, place=placed("body", "lower"), options={"weld": True})
    model = workshop.link(ARM, piece).model()
    assert model.nq == 5
    assert key(model, "home", "qpos") == [0.1, 0.2, 0.3, 7, 0.4]


STATEFUL = [
    '<general joint="j" dyntype="filter"/>',
    '<general joint="j" dyntype="user" actdim="3"/>',
    '<general joint="j" class="state"/>',
    '<muscle joint="j" lengthrange="0 1"/>',
    '<cylinder joint="j"/>',
    '<intvelocity joint="j" actrange="-1 1"/>',
    '<position joint="j" timeconst="1"/>',
    '<position joint="j" class="state"/>',
    '<position joint="j"/>',
    '<velocity joint="j"/>',
    '<damper joint="j" ctrlrange="0 1"/>',
    *(
        f'<{tag} joint="j" class="{name}"/>'
        for tag in ("motor", "velocity", "cylinder", "position")
        for name in ("state", "user", "position", "muscle", "pid")
    ),
]


def acting(actuators: str, count: int, acts: int) -> str:
    row = " ".join(map(str, range(1, acts + 1)))
    ctrl = " ".join(map(str, range(1, count + 1)))
    written = f'act="{row}" ' if acts else ""
    return f"""<mujoco><default><default class="state"><general dyntype="filterexact"/></default>
      <default class="user"><general dyntype="user" actdim="4"/></default><default class="pid"><pid ki="1" slewmax="1"/></default>
      <default class="position"><position timeconst="1"/></default><default class="muscle"><muscle/></default></default>
      <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
      <actuator>{actuators}</actuator><keyframe><key name="k" {written}ctrl="{ctrl}"/></keyframe></mujoco>"""


@pytest.mark.parametrize("actuator", STATEFUL)
@pytest.mark.mujoco4("some of these actuators are refused, or keep their state")
def test_activations_go_with_their_actuators(workshop: Workshop, actuator: str) -> None:
    probe = acting(actuator, 1, 0)
    acts = mujoco.MjModel.from_xml_string(probe).na
    model = acting(actuator + actuator, 2, 2 * acts)
    workshop.link(model, Piece(model), Piece(model, "q/", options={"keyframes": "prefix"})).check()


CLOTH = """<flexcomp name="cloth" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" mass="1" radius=".01">
  <edge equality="true"/></flexcomp>"""
PILE = (
    '<replicate count="3" offset="1 0 0"><body name="cube" pos="0 0 7"><freejoint/><geom size=".1"/></body></replicate>'
)
CHAIN = """<replicate count="2" offset="0 1 0"><body name="link"><joint ref="30"/><geom size=".1"/>
  <body><joint type="ball"/><geom size=".1" pos="1 0 0"/></body></body></replicate>"""
BLOCKS = {
    "flexcomp": (CLOTH, 12),
    "flexcomp on a body": (f'<body name="holder" euler="9 8 7">{CLOTH}</body>', 12),
    "free bodies": (PILE, 21),
    "joints with references": (CHAIN, 10),
    "replicates in replicates": (f'<replicate count="2" offset="0 9 0">{PILE}</replicate>', 42),
}


def expanding(block: str, keys: str = "") -> str:
    return f"""<mujoco><worldbody><body name="first"><joint ref="2"/><geom size=".1"/></body>{block}
      <body name="last"><joint type="slide" ref="3"/><geom size=".1"/></body></worldbody>{keys}</mujoco>"""


@pytest.mark.parametrize("place", PLACES[:3], ids=["in place", "moved", "turned"])
@pytest.mark.parametrize(("block", "width"), BLOCKS.values(), ids=BLOCKS.keys())
def test_what_mujoco_expands_keeps_its_numbers(workshop: Workshop, block: str, width: int, place: object) -> None:
    if OLDER and block == CLOTH and place != placed():
        pytest.skip("MuJoCo 3 does not move a cloth with its frame")
    alone = mujoco.MjModel.from_xml_string(expanding(block))
    assert alone.nq == width + 2
    state = np.random.default_rng(1).normal(size=alone.nq)
    data = mujoco.MjData(alone)
    data.qpos[:] = state
    mujoco.mj_normalizeQuat(alone, data.qpos)
    row = " ".join(map(repr, data.qpos.tolist()))
    speed = " ".join(map(str, range(alone.nv)))
    keys = f'<keyframe><key name="home" qpos="{row}" qvel="{speed}"/></keyframe>'
    part = Piece(expanding(block, keys), place=place)  # type: ignore[arg-type]
    linked = workshop.link(ARM, part)
    if block is CLOTH and place is PLACES[2]:
        assert linked.codes == ["not-supported"] * 2
        return
    model = linked.check(ignore=("flex_vert0",))  # these are parts of the flex's box along the world's axes
    up = key(model, "up", "qpos")
    assert up[4:] == pytest.approx(model.qpos0[4:].tolist(), abs=1e-12)


@pytest.mark.parametrize(("block", "width"), BLOCKS.values(), ids=BLOCKS.keys())
@pytest.mark.mujoco4("keys of other lengths are refused, and replicated ones are copied")
def test_keys_of_others_leave_the_reference_of_what_is_expanded(workshop: Workshop, block: str, width: int) -> None:
    model = workshop.link(expanding(block), Piece(ARM, keys_of := "arm/")).check()
    home = key(model, "home", "qpos")
    assert home[: width + 2] == pytest.approx(model.qpos0[: width + 2].tolist())
    assert keys_of == "arm/"


@pytest.mark.parametrize("align", ["true", "false"])
@pytest.mark.parametrize("place", [PLACES[0], PLACES[2]], ids=["in place", "moved"])
def test_a_body_that_mujoco_aligns_rests_where_it_was(workshop: Workshop, align: str, place: object) -> None:
    part = f"""<mujoco><compiler alignfree="{align}"/><worldbody><body name="b" pos="0 0 1" euler="1 2 3"><freejoint/>
      <geom size=".1" pos="1 0 0"/><geom type="box" size=".1 .2 .3" euler="10 20 30"/></body></worldbody></mujoco>"""
    model = workshop.link(ARM, Piece(part, place=place)).check()  # type: ignore[arg-type]
    assert key(model, "home", "qpos")[4:] == pytest.approx(model.qpos0[4:].tolist(), abs=1e-12)


def test_a_free_body_of_a_sub_model_moves_too(workshop: Workshop) -> None:
    sub = """<mujoco model="sub"><worldbody><body name="cube" pos="0 0 2"><freejoint/><geom size=".1"/></body></worldbody>
      </mujoco>"""
    part = """<mujoco><asset><model name="sub" file="sub.xml"/></asset><worldbody>
      <body name="first"><joint name="first"/><geom size=".1"/></body><attach model="sub" body="cube" prefix="s/"/>
      </worldbody><keyframe><key name="home" qpos=".5 1 2 3 0 1 0 0"/><key name="rest" ctrl=""/></keyframe></mujoco>"""
    linked = workshop.link(ARM, Piece(part, place=PLACES[2], files={"sub.xml": sub}))
    model = linked.check()
    assert key(model, "up", "qpos")[4:] == pytest.approx(model.qpos0[4:].tolist(), abs=1e-12)


def test_two_flexes_are_told_apart(workshop: Workshop) -> None:
    second = CLOTH.replace('name="cloth"', 'name="sheet"')
    base = expanding(CLOTH + second, '<keyframe><key name="k" qpos="1"/></keyframe>')
    model = workshop.link(base, BASE).check()
    reference = model.qpos0.copy()
    reference[0] = 1
    assert key(model, "k", "qpos") == pytest.approx(reference.tolist(), abs=1e-12)


def test_nothing_is_measured_for_keys_that_are_left_out(workshop: Workshop) -> None:
    part = expanding(CLOTH, '<keyframe><key name="k" qpos="1"/></keyframe>')
    linked = workshop.link(BASE, Piece(part, options={"keyframes": "none"}), measure=None)
    assert "keyframe" not in linked.xml
    linked.check()


@pytest.mark.mujoco4("keys of other lengths are refused, and replicated ones are copied")
def test_replicated_mocap_bodies_stand_where_they_are(workshop: Workshop) -> None:
    base = (
        '<mujoco><worldbody><replicate count="2" offset="1 0 0"><body mocap="true"/></replicate></worldbody></mujoco>'
    )
    part = """<mujoco><worldbody><body name="m" mocap="true"/></worldbody>
      <keyframe><key name="k" mpos="1 2 3"/></keyframe></mujoco>"""
    linked = workshop.link(base, part)
    linked.check()
    (key,) = linked.linking.base.root.iter("key")
    assert key.get("mpos") == "0 0 0 1 0 0 1 2 3"
    plain = PLAIN.replace("</mujoco>", '<keyframe><key name="k" qpos="1"/></keyframe></mujoco>')
    workshop.link(base, plain).check()


def test_keys_are_told_from_where_they_were(workshop: Workshop) -> None:
    linked = on_arm(workshop, "merge")
    found = [linked.linking.span(linked.linking.base, element) for element in linked.linking.base.root.iter("key")]
    assert [span.file for span in found] == [str(linked.paths[at]) for at in (0, 0, 1)]
    assert [span.line for span in found] == [9, 10, 6]


@pytest.mark.parametrize(
    ("classes", "actuator"),
    [
        ('<general dyntype="integrator"/>', '<general joint="j"/>'),
        (
            '<general dyntype="muscle"/><default class="c"><general dyntype="none"/></default>',
            '<general class="c" joint="j"/>',
        ),
        ('<general dyntype="user" actdim="3"/>', '<general joint="j"/>'),
        ('<general dyntype="filter"/>', '<general joint="j" actdim="-1"/>'),
        ('<position timeconst="1"/>', '<general joint="j"/>'),
        ('<general dyntype="filter"/>', '<position joint="j"/>'),
        ('<position kp="3"/><muscle ctrlrange="0 1"/>', '<position joint="j"/>'),
        ("", '<general joint="j" gaintype="pid" biastype="affine" dyntype="pid"/>'),
        ("", '<general joint="j" gaintype="pid" biastype="affine" gainprm="0"/>'),
        ('<general gaintype="pid" biastype="affine" gainprm="0"/>', '<general joint="j"/>'),
    ],
)
@pytest.mark.mujoco4("an actuator takes the dynamics of a class of its own kind")
def test_the_state_that_classes_give_to_actuators_is_as_wide_as_in_mujoco(
    workshop: Workshop, classes: str, actuator: str
) -> None:
    text = f"""<mujoco><default>{classes}</default>
      <worldbody><body name="b"><joint name="j"/><geom size="1"/></body></worldbody>
      <actuator>{actuator}<motor joint="j"/></actuator>
      <keyframe><key name="k" ctrl="1" act=""/></keyframe></mujoco>"""
    linked = workshop.link(text, PLAIN)
    linked.check()
    layout = linked.linking.keys.base_layout
    assert layout is not None
    own, _ = layout.actuators.values()
    model = mujoco.MjModel.from_xml_string(text)
    assert own.widths == (model.actuator_ctrlnum[0], model.actuator_actnum[0])


def test_the_judge_agrees_on_the_policies() -> None:
    assert {each.value for each in KeyMode} == {"merge", "prefix", "none"}


HINGE = """
<mujoco><worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="home" time="2" qpos="3"/><key qpos="4"/></keyframe></mujoco>
"""
LOOSE = """
<mujoco><worldbody><body name="b"><freejoint name="j"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="home" qpos="1 0 0 1 0 0 0"/></keyframe></mujoco>
"""


def test_by_path_and_by_joint(workshop: Workshop) -> None:
    turned = placed(pos=(0, 0, 5), quat=quat_from_axisangle((0, 0, 1), 3.141592653589793))
    linking = workshop.link(HINGE, Piece(HINGE, "a/"), Piece(LOOSE, "b/", turned)).linking
    found = part_keys(linking)
    assert {path: keys.names for path, keys in found.items()} == {"base": ["home"], "a": ["home"], "b": ["home"]}
    key = found["a"].named("home")
    assert key is not None and key.time is not None and key.time.text == "2"
    assert {node.get("name"): texts(row) for node, row in key.values["qpos"].items()} == {"a/j": ["3"]}
    assert key.values["qpos"].popitem()[1][0].source.moved == ()
    assert len(found["a"].keys) == 2
    moved = found["b"].named("home")
    assert moved is not None
    (columns,) = moved.values["qpos"].values()
    assert [round(float(number.text), 12) for number in columns[:3]] == [-1, 0, 5]
    assert [len(number.source.moved) for number in columns] == [1] * 7
    assert found["a"].named("other") is None


def test_they_are_remembered_for_what_the_model_becomes_a_part_of(workshop: Workshop) -> None:
    linking = workshop.link(BASE, Piece(HINGE, "a/")).linking
    assert linking.base.part_keys["a"].depth == 1
    assert "a" not in workshop.link(BASE, Piece(HINGE, "a/", options={"keyframes": "none"})).linking.base.part_keys


ATTACHING = """<mujoco><asset><model name="sub" file="sub.xml"/></asset><worldbody><attach model="sub" body="b" prefix="s/"/>
  <geom size=".1"/></worldbody></mujoco>"""
FREE_KEYS = {
    "free": ("<freejoint/>", "", '<key name="k" qpos="1 2 3 1 0 0 0"/>', True),
    "mocap": ("", ' mocap="true"', '<key name="k" mpos="1 2 3" mquat="1 0 0 0"/>', True),
    "hinge": ("<joint/>", "", '<key name="k" qpos="1"/>', False),
}


@pytest.mark.mujoco4("it attaches no keys")
@pytest.mark.parametrize(("joint", "mocap", "key", "refused"), FREE_KEYS.values(), ids=FREE_KEYS.keys())
@pytest.mark.parametrize("moved", [True, False])
def test_keys_with_poses_of_a_model_that_mujoco_attaches_do_not_move(
    workshop: Workshop, joint: str, mocap: str, key: str, refused: bool, moved: bool
) -> None:
    sub = f'<mujoco><worldbody><body name="b"{mocap}>{joint}<geom size=".1"/></body></worldbody><keyframe>{key}</keyframe></mujoco>'
    place = placed(pos=(1, 0, 0)) if moved else placed()
    linked = workshop.link(BASE, Piece(ATTACHING, place=place, files={"sub.xml": sub}))
    faults = [each.message for each in linked.linking.sink.errors]
    expected = ["the model attached here has keys with poses of its free bodies, and `part/` moves it"]
    assert faults == (expected if refused and moved else [])
