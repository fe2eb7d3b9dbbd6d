"""Where parts hang and what stands between, each compared with the model that a person would write.

The records of the parts say where MuJoCo has them, and which of them cannot be compared with their sources.

Copies of a part are where MuJoCo's own `<replicate>` puts them.
"""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.write import write
from mjcompose.link import bodies
from mjcompose.link.linking import Part
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.plan import IN_PLACE, PartRecord
from mjcompose.sources.context import Context
from sampling import without_meshes

PART = """
<mujoco model="part"><compiler angle="radian"/><worldbody>
  <frame name="grasp" pos=".1 .2 0" quat="1 0 .5 0"><site name="in" pos="0 0 .3"/></frame>
  <body name="b" pos=".3 .2 .1" quat="1 .3 0 0"><geom size=".1"/>
    <frame name="tip" pos="0 0 .5" quat="1 0 0 .4"/></body>
  <geom name="g" size=".05"/>
</worldbody></mujoco>
"""
BASE = """
<mujoco model="base"><compiler angle="radian"/><worldbody>
  <body name="arm" pos="0 0 1" quat="1 .1 .2 .3"><joint name="j"/><geom size=".1"/>
    <site name="flange" pos=".1 0 .2" quat="1 0 0 1"/><frame name="mount" pos="0 .4 0" quat="1 1 0 0"/>
    <body name="tool" pos="0 0 .3"><geom size=".1"/></body></body>
</worldbody></mujoco>
"""
INSIDE = PART.split("<worldbody>")[1].split("</worldbody>")[0]


def composed(folder: Path, recipe: str, **files: str) -> mujoco.MjModel:
    for name, text in {"part.xml": PART, "base.xml": BASE, "recipe.yaml": "recipe: 1\n" + recipe, **files}.items():
        (folder / name.replace("__", ".")).write_text(text)
    context = Context(environment={}, folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def by_hand(place: str, inside: str) -> mujoco.MjModel:
    """The base with the part's world in a frame or a body at a place."""
    prefixed = inside.replace('name="', 'name="p/')
    return mujoco.MjModel.from_xml_string(BASE.replace(place, f"{place}{prefixed}"))


def places(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """Where every named body, geom and site is, the joints somewhere."""
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))  # no number is `in` enumerations
    for at in range(model.njnt):
        if model.jnt_type[at] in kinds:
            data.qpos[model.jnt_qposadr[at]] = 0.3
    mujoco.mj_forward(model, data)
    found = {}
    for kind in ("body", "geom", "site"):
        for at in range(getattr(model, f"n{kind}")):
            name = getattr(model, kind)(at).name
            if name:
                view = getattr(data, kind)(at)
                found[f"{kind} {name}"] = np.concatenate([view.xpos, view.xmat])
    return found


def assert_same(ours: mujoco.MjModel, theirs: mujoco.MjModel) -> None:
    one = places(ours)
    other = places(theirs)
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_allclose(one[name], other[name], atol=1e-12, err_msg=name)


SITE = '<site name="flange" pos=".1 0 .2" quat="1 0 0 1"/>'
ON_SITE = '<frame pos=".1 0 .2" quat="1 0 0 1">'
ON_MOUNT = '<frame pos="0 .4 0" quat="1 1 0 0">'
OFFSET = 'pos="1 2 3" quat="1 0 0 .5"'
WRITTEN = "pos: [1, 2, 3], quat: [1, 0, 0, 0.5]"


@pytest.mark.parametrize(
    ("asked", "opened"),
    [
        ("site: flange", f"{ON_SITE}<frame>{{}}</frame></frame>"),
        (f"site: flange, {WRITTEN}", f"{ON_SITE}<frame {OFFSET}>{{}}</frame></frame>"),
        ("body: arm", "<frame>{}</frame>"),
        (f"body: arm, {WRITTEN}", f"<frame {OFFSET}>{{}}</frame>"),
        ("frame: mount", f"{ON_MOUNT}{{}}</frame>"),
        (f"frame: mount, {WRITTEN}", f"{ON_MOUNT}<frame {OFFSET}>{{}}</frame></frame>"),
        (
            "frame: mount, joint: {type: hinge, axis: [0, 1, 0]}",
            f'{ON_MOUNT}<body name=""><joint name="" axis="0 1 0"/>{{}}</body></frame>',
        ),
        (
            f"site: flange, {WRITTEN}, joint: {{type: slide, axis: [1, 0, 0]}}",
            f'{ON_SITE}<body name="" {OFFSET}><joint name="" type="slide" axis="1 0 0"/>{{}}</body></frame>',
        ),
        (f"body: arm, {WRITTEN}, joint: ball", f'<body name="" {OFFSET}><joint name="" type="ball"/>{{}}</body>'),
        (
            "site: flange, joint: [{name: x, type: slide, axis: [1, 0, 0]}, {name: turn, axis: [0, 0, 1]}]",
            (
                f'{ON_SITE}<body name=""><joint name="x" type="slide" axis="1 0 0"/>'
                '<joint name="turn" axis="0 0 1"/>{}</body></frame>'
            ),
        ),
    ],
)
def test_places_and_joints(tmp_path: Path, asked: str, opened: str) -> None:
    ours = composed(tmp_path, f"base: ./base.xml\nattach: {{p: {{model: ./part.xml, {asked}}}}}\n")
    theirs = by_hand(SITE, opened.format(INSIDE))
    assert_same(ours, theirs)
    assert [ours.joint(at).name for at in range(ours.njnt)] == [theirs.joint(at).name for at in range(theirs.njnt)]


@pytest.mark.parametrize("joint", ["free", "mocap"])
@pytest.mark.parametrize("place", ["site: flange", "frame: mount", "body: tool"])
def test_what_floats_is_at_the_place_in_the_reference(tmp_path: Path, joint: str, place: str) -> None:
    recipe = f"base: ./base.xml\nattach: {{p: {{model: ./part.xml, {place}, {WRITTEN}, joint: JOINT}}}}\n"
    ours = composed(tmp_path, recipe.replace("JOINT", joint))
    body = ours.body("p/")
    assert body.parentid[0] == 0
    assert bool(body.mocapid[0] >= 0) == (joint == "mocap")
    welded = composed(tmp_path, recipe.replace("JOINT", "{type: slide, axis: [1, 0, 0]}"))
    found = []
    for model in (ours, welded):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        found.append(np.concatenate([data.body("p/b").xpos, data.body("p/b").xmat]))
    np.testing.assert_allclose(found[0], found[1], atol=1e-12)


@pytest.mark.parametrize(("mate", "kind"), [("in", "site"), ("b", "body"), ("grasp", "frame"), ("tip", "frame")])
def test_mate_lies_on_the_place(tmp_path: Path, mate: str, kind: str) -> None:
    """What is called so, marked with a site of its own, comes to lie on the place with its offset."""
    marked = PART
    if kind == "body":
        marked = PART.replace('<geom size=".1"/>', '<geom size=".1"/><site name="mark"/>')
    elif mate == "grasp":
        marked = PART.replace('<site name="in"', '<site name="mark"/><site name="in"')
    elif mate == "tip":
        marked = PART.replace('quat="1 0 0 .4"/>', 'quat="1 0 0 .4"><site name="mark"/></frame>')
    ours = composed(
        tmp_path,
        f"base: ./base.xml\nattach: {{p: {{model: ./part.xml, site: flange, mate: {mate}, {WRITTEN}}}}}\n",
        part__xml=marked,
    )
    theirs = by_hand(SITE, f'<frame pos=".1 0 .2" quat="1 0 0 1"><site name="mark" {OFFSET}/></frame>')
    mark = "site p/in" if kind == "site" else "site p/mark"
    np.testing.assert_allclose(places(ours)[mark], places(theirs)["site p/mark"], atol=1e-12)


def test_fused_links_of_urdf_can_be_mated(tmp_path: Path) -> None:
    if not hasattr(mujoco.MjSpec, "fuse_static"):
        pytest.skip("an older MuJoCo leaves no frame of a fused link")
    urdf = """<robot name="r"><link name="root"/><link name="body"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="tip"/>
      <joint name="j" type="revolute"><parent link="root"/><child link="body"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
      <joint name="f" type="fixed"><parent link="body"/><child link="tip"/><origin xyz="0 0 .5"/></joint></robot>"""
    ours = composed(
        tmp_path,
        "base: ./base.xml\nattach: {p: {model: ./part.urdf, site: flange, mate: tip}}\n"
        "add: [{to: {frame: p/tip}, site: {name: mark}}]\n",
        part__urdf=urdf,
    )
    data = mujoco.MjData(ours)
    mujoco.mj_forward(ours, data)
    np.testing.assert_allclose(data.site("mark").xpos, data.site("flange").xpos, atol=1e-12)


def test_siblings_stand_in_the_order_of_the_file(tmp_path: Path) -> None:
    """The base's own, then the parts, then `add`; also where a part waits for the one that it hangs on."""
    part = '<mujoco><worldbody><body name="b"><geom size="1"/><site name="s"/></body></worldbody></mujoco>'
    ours = composed(
        tmp_path,
        "base: ./base.xml\nattach:\n"
        "  first: {model: ./part.xml}\n"
        "  third: {model: ./part.xml}\n"
        "  one: {model: ./part.xml, body: late/b, joint: free}\n"
        "  two: {model: ./part.xml, site: late/s}\n"
        "  three: {model: ./part.xml}\n"
        "  late: {model: ./part.xml}\n"
        "  four: {model: ./part.xml, site: late/s}\n"
        "add: [{to: world, body: {name: added, geom: {size: [1]}}}]\n",
        part__xml=part,
    )
    assert [ours.body(at).name for at in range(1, ours.nbody)] == [
        "arm",
        "tool",
        "first/b",
        "third/b",
        "one/",
        "one/b",
        "three/b",
        "late/b",
        "two/b",
        "four/b",
        "added",
    ]


@pytest.mark.parametrize("seed", range(4))
def test_parts_may_be_written_in_any_order(tmp_path: Path, seed: int) -> None:
    """Each waits for a frame, which an entry adds to the part before it, or for the body of a joint."""
    count = 12
    parts = [
        f"  p{n}: {{model: ./p.xml, {f'body: p{n - 1}/' if n % 3 == 0 and n else f'frame: f{n}'}, joint: {{type: hinge}}}}"
        for n in range(count)
    ]
    entries = [
        f"  - {{to: {f'p{n - 1}/b' if n else 'world'}, frame: {{name: f{n}, pos: [{n}, 0, 1]}}}}"
        for n in range(count)
        if n % 3 or not n
    ]
    order = random.Random(seed)
    order.shuffle(parts)
    order.shuffle(entries)
    part = '<mujoco><worldbody><body name="b" pos="0 1 0"><geom size=".1"/></body></worldbody></mujoco>'
    model = composed(tmp_path, "\n".join(["attach:", *parts, "add:", *entries]), **{"p.xml": part})
    assert model.nbody == 1 + 2 * count
    assert [model.body(f"p{n}/b").pos.tolist() for n in range(count)] == [[0, 1, 0]] * count
    for n in range(1, count):
        parent = model.body(f"p{n - 1}/" if n % 3 == 0 else f"p{n - 1}/b").id
        assert model.body(f"p{n}/").parentid[0] == parent


def test_each_part_is_looked_at_as_often_as_what_it_waits_for_comes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked = 0

    def counted(order: bodies._AttachmentOrder, part: Part) -> None:
        nonlocal looked
        looked += 1
        look(order, part)

    look = bodies._AttachmentOrder._look
    monkeypatch.setattr(bodies._AttachmentOrder, "_look", counted)
    count = 60
    parts = [f"  p{n}: {{model: ./p.xml, frame: f{n}}}" for n in reversed(range(count))]
    entries = [f"  - {{to: {f'p{n - 1}/b' if n % 2 else 'world'}, frame: {{name: f{n}}}}}" for n in range(count)]
    part = '<mujoco><worldbody><body name="b"><geom size=".1"/></body></worldbody></mujoco>'
    model = composed(tmp_path, "\n".join(["attach:", *parts, "add:", *entries]), **{"p.xml": part})
    assert model.nbody == 1 + count
    assert looked < 4 * count


# -- sense ------------------------------------------------------------------------------------------------------


def reads_what_hangs_below(model: mujoco.MjModel, carrier: str, sensors: str, seed: int) -> np.ndarray:
    """At rest in a random pose, the sensors read the weight of all below the body, and its lever. Return the force."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.body_gravcomp[:] = 0
    data = mujoco.MjData(model)
    data.qpos[:] += np.random.default_rng(seed).uniform(-0.3, 0.3, model.nq)
    mujoco.mj_inverse(model, data)  # with no velocity and no acceleration
    body = model.body(carrier).id
    site = model.site(carrier).id
    turned = data.site_xmat[site].reshape(3, 3).T
    weight = -model.body_subtreemass[body] * model.opt.gravity
    lever = data.subtree_com[body] - data.site_xpos[site]
    force, torque = (data.sensor(f"{sensors}{tag}").data for tag in ("force", "torque"))
    assert force == pytest.approx(turned @ weight, abs=1e-6)
    assert torque == pytest.approx(turned @ np.cross(lever, weight), abs=1e-6)
    assert model.body_parentid[body] == 0 or model.body_weldid[body] == model.body_weldid[model.body_parentid[body]]
    return np.array(force)


SENSE = "sense: [force, torque]"


@pytest.mark.parametrize(
    ("hung", "names"),
    [
        (f"p: {{model: ./part.xml, site: flange, {SENSE}}}", ("p/sense", "p/")),
        (f"p: {{model: ./part.xml, site: flange, pos: [1, 2, 3], quat: [1, 2, 3, 4], {SENSE}}}", ("p/sense", "p/")),
        (f"p: {{model: ./part.xml, frame: mount, mate: in, {SENSE}}}", ("p/sense", "p/")),
        (f"p: {{model: ./part.xml, body: tool, joint: {{type: hinge, axis: [0, 1, 1]}}, {SENSE}}}", ("p/sense", "p/")),
        (f"p: {{model: ./part.xml, body: tool, joint: ball, {SENSE}}}", ("p/sense", "p/")),
        (f"p: {{model: ./part.xml, pos: [0, 0, 1], {SENSE}}}", ("p/sense", "p/")),  # a sensor in the foundation
        ("p: {model: ./part.xml, body: arm, sense: {name: w, force: true, torque: true}}", ("p/w", "p/w_")),
        (f"p: {{model: ./part.xml, body: arm, prefix: '', {SENSE}}}", ("sense", "")),
        (
            f"p: {{model: ./part.xml, site: flange, {SENSE}, replicate: [{{count: 2, offset: [1, 0, 0]}}]}}",
            ("p1/sense", "p1/"),
        ),
        (
            f"p: {{model: {{attach: {{q: {{model: ./part.xml, pos: [0, 1, 0], {SENSE}}}}}}}, site: flange}}",
            ("p/q/sense", "p/q/"),
        ),
        (f"o: {{model: ./part.xml, body: p/b}}\n  p: {{model: ./part.xml, site: flange, {SENSE}}}", ("p/sense", "p/")),
    ],
)
def test_sense_measures_what_hangs_below_a_place(tmp_path: Path, hung: str, names: tuple[str, str]) -> None:
    recipe = f"base: ./base.xml\nattach:\n  {hung}\ncheck: {{same: {{unchanged: {{}}}}}}\n"
    reads_what_hangs_below(composed(tmp_path, recipe), *names, seed=1)


def test_sense_has_its_cutoff_its_own_axes_and_a_separator(tmp_path: Path) -> None:
    base = BASE.replace("<worldbody>", '<default><site pos="9 9 9" euler="1 1 1" size=".1"/></default><worldbody>')
    recipe = "separator: '-'\nbase: ./base.xml\nattach:\n  p: {model: ./part.xml, site: flange, sense: {torque: true, cutoff: 3}}\n"
    model = composed(tmp_path, recipe, base__xml=base)
    assert [model.sensor(at).name for at in range(model.nsensor)] == ["p-torque"]
    assert model.sensor("p-torque").cutoff == 3
    assert not model.site("p-sense").pos.any() and model.site("p-sense").quat.tolist() == [1, 0, 0, 0]


@pytest.mark.parametrize(
    ("hung", "code", "words"),
    [
        (f"p: {{model: ./part.xml, site: flange, joint: free, {SENSE}}}", "attach-place", "no body carries it"),
        (f"p: {{model: ./part.xml, joint: mocap, {SENSE}}}", "attach-place", "no body carries it"),
        (
            f"p: {{model: {{add: [{{to: world, body: {{freejoint: {{}}, geom: {{size: [1]}}}}}}]}}, {SENSE}}}",
            "freejoint-on-body",
            "the body that `sense` gives it",
        ),
        (
            f"a: {{model: ./part.xml, body: arm, prefix: '', {SENSE}}}\n  p: {{model: ./base.xml, site: flange, prefix: '', {SENSE}}}",
            "name-clash",
            "",
        ),
    ],
)
def test_sense_of_what_nothing_carries(tmp_path: Path, hung: str, code: str, words: str) -> None:
    (tmp_path / "part.xml").write_text(PART)
    (tmp_path / "base.xml").write_text(BASE)
    (tmp_path / "recipe.yaml").write_text(f"recipe: 1\nbase: ./base.xml\nattach:\n  {hung}\n")
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(tmp_path / "recipe.yaml"), context) is None
    assert any(each.code == code and words in each.message for each in context.sink.errors)


ARMS = {
    "franka_emika_panda/panda_nohand": "site: attachment_site",
    "kuka_iiwa_14/iiwa14": "site: attachment_site",
    "ufactory_xarm7/xarm7_nohand": "site: attachment_site",
    "universal_robots_ur5e/ur5e": "site: attachment_site",
    "kinova_gen3/gen3": "site: pinch_site",
    "trossen_vx300s/vx300s": "site: pinch",
    "aloha/aloha": "site: left/gripper",
    "stanford_tidybot/tidybot": "site: pinch_site",
    "ufactory_xarm7/xarm7": "site: link_tcp",
    "unitree_z1/z1": "body: link06",
}
TOOLS = (
    "robotiq_2f85/2f85",
    "franka_emika_panda/hand",
    "ufactory_xarm7/hand",
    "leap_hand/right_hand",
    "umi_gripper/umi_gripper",
    "shadow_hand/left_hand",
    "shadow_hand/right_hand",
    "wonik_allegro/left_hand",
    "wonik_allegro/right_hand",
    "realsense_d435i/d435i",
)


@pytest.fixture(scope="module")
def plain_robots(corpus: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The arms and tools, each mesh a tetrahedron: what is weighed is where they hang."""
    folder = tmp_path_factory.mktemp("robots")
    for name in {each.partition("/")[0] for each in (*ARMS, *TOOLS)}:
        shutil.copytree(corpus / "models" / name, folder / name, copy_function=without_meshes)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("arm", ARMS)
def test_ten_tools_on_each_of_ten_arms_weigh_what_they_weigh(plain_robots: Path, tmp_path: Path, arm: str) -> None:
    folder = plain_robots
    rng = np.random.default_rng(len(arm))
    parts = ""
    for number, tool in enumerate(TOOLS):
        pose = f"pos: {rng.normal(size=3).tolist()}, quat: {rng.normal(size=4).tolist()}"
        parts += f"  t{number}: {{model: {folder / tool}.xml, {ARMS[arm]}, {pose}, joint: none, {SENSE}}}\n"
    cell = tmp_path / "cell.yaml"
    recipe = tmp_path / "recipe.yaml"
    cell.write_text(f"recipe: 1\nconflict: base\nbase: {folder / arm}.xml\nattach:\n{parts}")
    pose = f"pos: {rng.normal(size=3).tolist()}, quat: {rng.normal(size=4).tolist()}"
    # The root of tidybot slides: nothing that is fixed to a hinge above it has mass, which MuJoCo refuses.
    joint = "" if "tidybot" in arm else "joint: {type: hinge, axis: [0, 1, 1]}, "
    inner = f"  cell: {{model: ./cell.yaml, {pose}, {joint}sense: [force]}}\n"
    recipe.write_text(f"recipe: 1\nconflict: base\nbase: ./cell.yaml\nattach:\n{inner}")
    context = Context(environment={}, folder=tmp_path)
    made = build(ModelRequest(recipe), context)
    assert made is not None, [each.message for each in context.sink.errors]
    write(made.bundle, tmp_path / "out", environment={})
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))
    for number, tool in enumerate(TOOLS):
        alone = mujoco.MjModel.from_xml_path(f"{folder / tool}.xml")
        weight = alone.body_mass.sum() * np.linalg.norm(model.opt.gravity)
        for part in (f"t{number}/", f"cell/t{number}/"):
            force = reads_what_hangs_below(model, f"{part}sense", part, seed=number)
            assert np.linalg.norm(force) == pytest.approx(weight, abs=1e-6), part


MEMBERS_PART = """<mujoco><worldbody><site name="origin"/>
  <body name="b" pos=".1 .2 .3" euler="10 20 30"><geom size=".1"/><site name="s" pos="0 0 .5" euler="0 40 0"/></body>
</worldbody><keyframe><key name="home"/></keyframe></mujoco>"""
INNER = """recipe: 1
base: ./p.xml
attach:
  tool: {model: ./p.xml, site: s, pos: [0, 0, 1], euler: [30deg, 0, 0], keys: prefix}
add: [{to: b, frame: {name: mount, pos: [1, 0, 0], euler: [0, 0, 50deg]}}]
"""


def made(folder: Path, recipe: str) -> tuple[dict[str, PartRecord], mujoco.MjModel]:
    (folder / "p.xml").write_text(MEMBERS_PART)
    (folder / "inner.yaml").write_text(INNER)
    (folder / "r.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    built = build(ModelRequest(folder / "r.yaml", verified=False), context)
    assert built is not None, context.sink.errors
    model = mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())
    return {each.part: each for each in built.composed.members}, model


@pytest.mark.parametrize(
    "place",
    [
        "pos: [1, 2, 3], euler: [0, 0, 90deg]",
        "frame: stand/mount",
        "frame: stand/tool/nest, pos: [0, 1, 0]",
        "joint: free",
    ],
)
def test_the_pose_of_a_part_is_where_its_world_is(tmp_path: Path, place: str) -> None:
    nest = "add: [{to: stand/tool/b, frame: {pos: [0, 0, 2], euler: [20deg, 0, 0], frame: {name: stand/tool/nest, euler: [0, 60deg, 0]}}}]\n"
    recipe = f"attach:\n  stand: {{model: ./inner.yaml}}\n  a: {{model: ./inner.yaml, {place}}}\n{nest}"
    found, model = made(tmp_path, recipe)
    mujoco.mj_kinematics(model, data := mujoco.MjData(model))
    assert [*found] == ["stand/base", "stand/tool", "a/base", "a/tool"]
    for record in found.values():
        body = model.body(record.body).id if record.body else 0
        assert record.pose is not None and record.obscure is None
        turn = data.xmat[body].reshape(3, 3)
        where = data.site(f"{record.prefix}origin").xpos
        assert np.allclose(turn @ record.pose.pos + data.xpos[body], where)
        quat = np.zeros(4)
        mujoco.mju_mulQuat(quat, data.xquat[body], np.array(record.pose.quat))
        own = np.zeros(4)
        mujoco.mju_mat2Quat(own, data.site(f"{record.prefix}origin").xmat)
        assert np.isclose(abs(quat @ own), 1)


@pytest.mark.parametrize(
    ("policy", "keys"),
    [("keys: merge", ["", "tool/"]), ("keys: prefix", ["a/", "a/tool/"]), ("drop: [key]", [None, None])],
)
def test_keys_begin_as_all_recipes_around_them_say(tmp_path: Path, policy: str, keys: list[str | None]) -> None:
    found, _ = made(tmp_path, f"attach: {{a: {{model: ./inner.yaml, {policy}}}}}\n")
    assert [found[part].keys for part in ("a/base", "a/tool")] == keys


def test_a_part_of_a_recipe_of_which_one_body_is_taken_is_not_compared(tmp_path: Path) -> None:
    found, _ = made(tmp_path, "attach: {a: {model: ./inner.yaml, subtree: b}}\n")
    assert {each.obscure for each in found.values()} == {"only its body `b` was taken"}
    found, _ = made(tmp_path, "base: {model: ./inner.yaml, subtree: b}\n")
    assert {each.obscure for each in found.values()} == {"only its body `b` was taken"}
    found, _ = made(tmp_path, "attach: {a: {model: ./p.xml, subtree: b}}\n")
    assert (found["a"].obscure, found["a"].subtree) == (None, "b")


@pytest.mark.parametrize("inside", ['<frame name="f" pos="0 0 1"/>', '<frame><frame name="f"/></frame>'])
def test_a_part_in_a_replicate_has_no_single_pose(tmp_path: Path, inside: str) -> None:
    base = f'<frame pos="0 0 5"><replicate count="2" offset="1 0 0">{inside}</replicate></frame>'
    (tmp_path / "base.xml").write_text(f"<mujoco><worldbody>{base}</worldbody></mujoco>")
    found, model = made(tmp_path, "base: ./base.xml\nattach: {a: {model: ./p.xml, frame: f}}\n")
    assert model.site("a/origin0").pos[0] != model.site("a/origin1").pos[0]
    assert (found["a"].pose, found["base"].pose) == (None, IN_PLACE)


REPLICATE_PART = """
<mujoco model="part"><worldbody>
  <body name="b" pos=".1 .2 .3" quat="1 .2 0 .1"><site name="s" pos="0 .1 0" quat="1 0 .3 0"/><geom size=".1"/>
    <body name="c" pos="0 0 .2"><joint name="j"/><geom size=".05"/></body></body>
</worldbody></mujoco>
"""


def models(folder: Path, part: str, recipe: str) -> mujoco.MjModel:
    (folder / "part.xml").write_text(part)
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(environment={}, folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def assert_same_places(ours: mujoco.MjModel, theirs: mujoco.MjModel) -> None:
    found = []
    for model in (ours, theirs):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        found.append(data)
    assert ours.nbody == theirs.nbody > 3
    np.testing.assert_allclose(found[0].xpos, found[1].xpos, atol=1e-12)
    np.testing.assert_allclose(found[0].xmat, found[1].xmat, atol=1e-12)


@pytest.mark.parametrize("sequence", ["xyz", "XYZ", "zyx"])
@pytest.mark.parametrize(
    ("axes", "opened"),
    [
        ("[{count: 4, offset: [.3, 0, .1]}]", '<replicate count="4" offset=".3 0 .1">'),
        (
            "[{count: 5, offset: [.3, .1, 0], euler: [10, 20, -35]}]",
            '<replicate count="5" offset=".3 .1 0" euler="10 20 -35">',
        ),
        (
            "[{count: 3, offset: [1, 0, 0], euler: [0, 30, 5]}, {count: 11, offset: [0, .2, .1], euler: [7, 0, 9]}]",
            '<replicate count="3" offset="1 0 0" euler="0 30 5"><replicate count="11" offset="0 .2 .1" euler="7 0 9">',
        ),
        ("[{count: 2, euler: [0, 0, 90]}, {count: 1}]", '<replicate count="2" euler="0 0 90">'),
    ],
)
def test_as_mujoco_has_it(tmp_path: Path, sequence: str, axes: str, opened: str) -> None:
    ours = models(
        tmp_path,
        REPLICATE_PART,
        f"recipe: 1\nangle: degree\neulerseq: {sequence}\nattach:\n"
        f"  p: {{model: ./part.xml, pos: [1, 2, 3], euler: [15, -25, 50], replicate: {axes}}}\n",
    )
    body = REPLICATE_PART.split("<worldbody>")[1].split("</worldbody>")[0]
    theirs = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler eulerseq="{sequence}"/><worldbody><frame pos="1 2 3" euler="15 -25 50">{opened}{body}'
        f"{'</replicate>' * opened.count('<replicate')}</frame></worldbody></mujoco>"
    )
    assert_same_places(ours, theirs)


def test_turned_about_the_mate(tmp_path: Path) -> None:
    """With `mate` it is that site that is copied from place to place, and the part turns about it."""
    ours = models(
        tmp_path,
        REPLICATE_PART,
        "recipe: 1\nattach: {p: {model: ./part.xml, mate: s, pos: [1, 0, 0], "
        "replicate: [{count: 3, offset: [0, 1, 0], euler: [0, 0, 30deg]}]}}\n",
    )
    data = mujoco.MjData(ours)
    mujoco.mj_forward(ours, data)
    theirs = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><replicate count="3" offset="0 1 0" euler="0 0 30"><site name="s"/></replicate>'
        "</worldbody></mujoco>"
    )
    np.testing.assert_allclose(data.site_xpos, theirs.site_pos + np.array([1, 0, 0]), atol=1e-12)
    for at, quat in enumerate(theirs.site_quat):
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, quat)
        np.testing.assert_allclose(data.site_xmat[at], matrix, atol=1e-12)


def test_names_are_padded(tmp_path: Path) -> None:
    model = models(
        tmp_path, REPLICATE_PART, "recipe: 1\nattach: {p: {model: ./part.xml, replicate: [{count: 2}, {count: 11}]}}\n"
    )
    names = [model.body(at).name for at in range(1, model.nbody, 2)]
    assert names[:2] + names[10:13] + names[-1:] == [
        "p0_00/b",
        "p0_01/b",
        "p0_10/b",
        "p1_00/b",
        "p1_01/b",
        "p1_10/b",
    ]


def test_a_part_may_hang_on_a_copy_and_keys_go_with_the_copies(tmp_path: Path) -> None:
    cube = REPLICATE_PART.replace('<joint name="j"/>', "").replace("<site", '<freejoint/><site name="top"/><site')
    cube = cube.replace(
        "</mujoco>", '<keyframe><key name="home" qpos="0 0 1 1 0 0 0" qvel="1 0 0 0 0 0"/></keyframe></mujoco>'
    )
    model = models(
        tmp_path,
        cube,
        "recipe: 1\nattach:\n  lid: {model: ./part.xml, joint: none, site: cube1/top}\n"
        "  cube: {model: ./part.xml, replicate: [{count: 3, offset: [1, 0, 0], euler: [0, 0, 90deg]}]}\n",
    )
    assert model.body("lid/b").parentid[0] == model.body("cube1/b").id
    qpos = model.key("home").qpos.reshape(3, 7)
    qvel = model.key("home").qvel.reshape(3, 6)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(
        qpos, [[0, 0, 1, 1, 0, 0, 0], [1, 0, 1, half, 0, 0, half], [1, 1, 1, 0, 0, 0, 1]], atol=1e-12
    )
    np.testing.assert_allclose(qvel[:, :3], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-12)
