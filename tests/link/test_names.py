from __future__ import annotations

from xml.sax.saxutils import quoteattr

import mujoco
import pytest
from hypothesis import given, settings, strategies as st
from link.workshop import BASE, Piece, Workshop, obj, placed
from mjcompose.link.names import rename
from mjcompose.tree.classes import MAIN
from mjcompose.tree.names import may_be_generated

# Every attribute that refers to a name, and every kind of thing it may refer to.
REFERRING = """
<mujoco model="referring">
  <extension><plugin plugin="mujoco.pid"><instance name="servo"><config key="kp" value="2"/></instance></plugin></extension>
  <default>
    <default class="look"><geom material="skin"/><site material="skin"/><tendon material="skin"/></default>
    <default class="shape"><geom type="mesh" mesh="wedge"/></default>
    <default class="coat"><material texture="checks"/></default>
  </default>
  <asset>
    <mesh name="wedge" vertex="0 0 0  .1 0 0  0 .1 0  0 0 .1" class="shape"/>
    <hfield name="hills" nrow="2" ncol="2" size="1 1 1 1"/>
    <texture name="checks" type="2d" builtin="checker" width="8" height="8"/>
    <texture name="beam" type="2d" builtin="flat" width="8" height="8"/>
    <texture type="skybox" builtin="gradient" width="4" height="4"/>
    <material name="skin" texture="checks"/>
    <material name="coated" class="coat"/>
    <material name="layered"><layer texture="checks" role="rgb"/></material>
  </asset>
  <worldbody>
    <geom name="ground" type="hfield" hfield="hills"/>
    <geom name="hull" class="shape"/>
    <geom class="look" size=".1"/>
    <light name="lamp" mode="targetbody" target="base"/>
    <light name="far" mode="targetbody" target="world"/>
    <camera name="eye" mode="targetbody" target="tip"/>
    <site name="ref" class="look"/>
    <frame name="here" childclass="look">
      <body name="base" childclass="shape">
        <joint name="turn"/>
        <geom/>
        <geom name="ball" type="sphere" size=".1" material="layered" mesh=""/>
        <site name="base" type="sphere"/>
        <body name="tip" pos=".3 0 0">
          <joint name="bend" axis="0 1 0"/>
          <geom name="end" type="sphere" size=".05" mesh=""/>
          <site name="tip"/>
          <site name="side" pos="0 .2 0"/>
        </body>
      </body>
    </frame>
    <body name="loose" pos="0 0 1"><freejoint name="loose"/><geom size=".1"/></body>
    <body name="v0" pos="1 0 0"><geom size=".01"/><joint name="v0" type="slide"/></body>
    <body name="v1" pos="2 0 0"><geom size=".01"/><joint name="v1" type="slide"/></body>
  </worldbody>
  <deformable>
    <flex name="band" dim="1" body="v0 world" vertex="0 0 0 0 0 3" element="0 1" material="skin"/>
    <skin name="hide" material="skin" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2">
      <bone body="tip" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/>
      <bone body="world" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0" vertweight="1"/>
    </skin>
  </deformable>
  <contact>
    <pair name="touch" geom1="ball" geom2="ground"/>
    <exclude name="apart" body1="base" body2="tip"/>
    <exclude body1="world" body2="tip"/>
  </contact>
  <tendon>
    <spatial name="cord" class="look"><site site="ref"/><geom geom="ball" sidesite="side"/><site site="tip"/></spatial>
    <fixed name="sum"><joint joint="turn" coef="1"/><joint joint="bend" coef="-1"/></fixed>
  </tendon>
  <equality>
    <connect name="pin" body1="base" body2="world" anchor="0 0 0"/>
    <connect site1="ref" site2="tip"/>
    <weld body1="base" body2="loose"/>
    <joint joint1="turn" joint2="bend"/>
    <tendon tendon1="cord" tendon2="sum"/>
    <flex flex="band"/>
  </equality>
  <actuator>
    <motor name="turn" joint="turn"/>
    <motor name="jip" jointinparent="bend"/>
    <motor name="pull" tendon="cord"/>
    <general name="crank" cranksite="tip" slidersite="base" cranklength="1"/>
    <position name="reach" site="tip" refsite="ref"/>
    <plugin name="servo" joint="bend" instance="servo"/>
    <adhesion name="stick" body="tip" ctrlrange="0 1"/>
  </actuator>
  <sensor>
    <touch site="tip"/>
    <jointpos name="turn" joint="turn"/>
    <tendonpos tendon="cord"/>
    <actuatorfrc actuator="turn"/>
    <framepos objtype="site" objname="tip" reftype="camera" refname="eye"/>
    <framequat objtype="body" objname="tip" reftype="body" refname="world"/>
    <framexaxis objtype="xbody" objname="world"/>
    <framezaxis objtype="geom" objname="end" reftype="geom" refname="ball"/>
    <subtreecom body="base"/>
    <distance geom1="ball" geom2="end" cutoff="1"/>
    <distance body1="base" body2="tip" cutoff="1"/>
    <rangefinder site="tip"/>
    <camprojection site="tip" camera="eye"/>
    <user objtype="tendon" objname="cord" dim="1"/>
    <jointactuatorfrc joint="bend"/>
    <clock name="time"/>
  </sensor>
  <custom>
    <numeric name="gains" data="1 2"/>
    <text name="note" data="tip"/>
    <tuple name="inner"><element objtype="body" objname="tip"/></tuple>
    <tuple name="all">
      <element objtype="geom" objname="ball"/><element objtype="joint" objname="turn"/>
      <element objtype="tuple" objname="inner"/><element objtype="numeric" objname="gains"/>
      <element objtype="actuator" objname="pull"/><element objtype="sensor" objname="time"/>
      <element objtype="material" objname="skin"/><element objtype="mesh" objname="wedge"/>
      <element objtype="equality" objname="pin"/><element objtype="pair" objname="touch"/>
      <element objtype="exclude" objname="apart"/><element objtype="skin" objname="hide"/>
      <element objtype="flex" objname="band"/><element objtype="light" objname="lamp"/>
    </tuple>
  </custom>
</mujoco>
"""


def test_every_kind_of_reference_follows_its_prefix(workshop: Workshop) -> None:
    linked = workshop.link(REFERRING, Piece(REFERRING, "a/"), Piece(REFERRING, "b-"), Piece(REFERRING, "ü-"))
    model = linked.check()
    assert model.sensor("a/turn").objid == model.joint("a/turn").id


def test_a_part_without_a_prefix_keeps_its_names(workshop: Workshop) -> None:
    linked = workshop.link("<mujoco/>", Piece(REFERRING, ""))
    linked.check()
    assert 'name="cord"' in linked.xml


def test_all_names_are_known_afterwards(workshop: Workshop) -> None:
    linked = workshop.link(BASE, Piece(REFERRING, "a/"))
    names = linked.linking.names
    model = linked.model()
    for kind, counted in (("body", model.nbody - 1), ("joint", model.njnt), ("camera", model.ncam)):
        assert len(names.known(kind)) == counted
    for kind in ("site", "geom", "material", "mesh", "texture", "tendon", "numeric", "tuple", "skin", "flex"):
        assert all(name.startswith("a/") or name == "mark" for name in names.known(kind))
    found = names.find("body", "a/tip")
    assert found is not None
    assert found.get("pos") == ".3 0 0"
    assert names.find("body", "a/nobody") is None


def test_the_world_never_gets_a_prefix(workshop: Workshop) -> None:
    linked = workshop.link(BASE, Piece(REFERRING, "a/"))
    assert "a/world" not in linked.xml


@pytest.mark.parametrize("name", ["world", "main"])
def test_other_things_may_be_called_like_the_world(workshop: Workshop, name: str) -> None:
    part = f"""
    <mujoco><worldbody><body name="b"><joint name="{name}"/><geom name="{name}" size="1"/><site name="{name}"/></body>
    </worldbody><tendon><fixed name="{name}"><joint joint="{name}" coef="1"/></fixed></tendon>
    <actuator><motor name="{name}" joint="{name}"/></actuator>
    <sensor><framepos objtype="site" objname="{name}" reftype="geom" refname="{name}"/></sensor></mujoco>"""
    linked = workshop.link("<mujoco/>", Piece(part, "a/"))
    linked.check()
    assert f'joint="a/{name}"' in linked.xml


ASSETS = """
<mujoco><compiler meshdir="m"/><asset>
  <mesh file="sub/x.y.obj"/><mesh name="" file="plain.obj"/><mesh name="own" file="plain.obj"/>
  <hfield name="" nrow="2" ncol="2" size="1 1 1 1"/>
  <texture type="skybox" builtin="flat" width="4" height="4" name=""/>
</asset><worldbody>
  <body name="b"><geom type="mesh" mesh="x.y"/><geom type="mesh" mesh="plain"/><geom type="mesh" mesh="own"/><freejoint/></body>
</worldbody></mujoco>"""


def test_assets_are_called_after_their_files(workshop: Workshop) -> None:
    part = ASSETS.replace('<hfield name="" nrow="2" ncol="2" size="1 1 1 1"/>', "")
    files = {"m/sub/x.y.obj": obj(0.1), "m/plain.obj": obj(0.2)}
    linked = workshop.link(part, Piece(part, "a/", files=files), Piece(part, "b/", files=files), files=files)
    model = linked.check()
    names = [model.mesh(at).name for at in range(model.nmesh)]
    assert names == ["x.y", "plain", "own", "a/x.y", "a/plain", "a/own", "b/x.y", "b/plain", "b/own"]
    assert 'mesh file="assets' in linked.xml, "the base's names stay unwritten"


def test_a_generated_name_may_be_referred_to(workshop: Workshop) -> None:
    part = """
    <mujoco><worldbody>
      <replicate count="3" offset="1 0 0" sep="_"><body name="b"><joint name="j"/><geom size=".1"/></body></replicate>
      <flexcomp name="cloth" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" mass="1" radius=".01">
        <edge equality="true"/></flexcomp>
    </worldbody>
    <actuator><motor joint="j_1"/><motor joint="j"/></actuator>
    <sensor><framepos objtype="body" objname="cloth_2"/><jointpos joint="j_2"/></sensor>
    <equality><flex flex="cloth"/></equality></mujoco>"""
    model = workshop.link("<mujoco/>", Piece(part, "a/")).check()
    assert model.joint("a/j_2").id == 2


SUB = """<mujoco model="sub"><worldbody><body name="arm"><joint name="pivot"/><geom size=".1"/></body></worldbody></mujoco>"""
ATTACHING = """
<mujoco><asset><model name="sub" file="sub.xml"/></asset>
  <worldbody><body name="holder"><attach model="sub" body="arm" prefix="{prefix}"/></body></worldbody>
  <actuator><motor joint="{prefix}pivot"/></actuator></mujoco>"""


@pytest.mark.parametrize("prefix", ["left_", "left/", ""])
def test_what_a_sub_model_brings_gets_both_prefixes(workshop: Workshop, prefix: str) -> None:
    part = ATTACHING.format(prefix=prefix)
    model = workshop.link(BASE, Piece(part, "a/", files={"sub.xml": SUB})).check()
    assert model.joint(0).name == f"a/{prefix}pivot"


def test_a_reference_to_nothing_is_told_where_it_stands(workshop: Workshop) -> None:
    part = """<mujoco><worldbody><body><joint name="elbow"/></body></worldbody>
    <actuator>
      <motor name="m" joint="elbwo"/>
    </actuator></mujoco>"""
    linked = workshop.link(BASE, part)
    fault = linked.fault
    assert fault.code == "unknown-name"
    assert "`elbwo`" in fault.message
    assert fault.span is not None
    assert (fault.span.file, fault.span.line) == (str(linked.paths[1]), 3)
    assert "elbow" in (fault.help or "")


DANGLING = [
    '<sensor><framepos objtype="site" objname="nothing"/></sensor>',
    '<sensor><framepos objtype="body" objname="b" reftype="camera" refname="nothing"/></sensor>',
    '<custom><tuple name="t"><element objtype="geom" objname="nothing"/></tuple></custom>',
    '<deformable><flex name="f" dim="1" body="b nothing" element="0 1"/></deformable>',
    '<contact><exclude body1="b" body2="nothing"/></contact>',
    '<worldbody><geom size="1" material="nothing"/></worldbody>',
    '<worldbody><geom size="1" class="nothing"/></worldbody>',
    '<worldbody><body childclass="nothing"/></worldbody>',
    '<asset><material name="m" texture="nothing"/></asset>',
    '<tendon><spatial><site site="nothing"/></spatial></tendon>',
    '<equality><weld body1="nothing"/></equality>',
]


@pytest.mark.parametrize("section", DANGLING)
@pytest.mark.parametrize("role", ["base", "part"])
def test_every_kind_of_reference_is_looked_up(workshop: Workshop, section: str, role: str) -> None:
    model = f'<mujoco><worldbody><body name="b"/></worldbody>{section}</mujoco>'
    fault = (workshop.link(model, BASE) if role == "base" else workshop.link(BASE, model)).fault
    assert fault.code == "unknown-name"
    assert "`nothing`" in fault.message


def test_names_of_another_part_are_not_seen(workshop: Workshop) -> None:
    refers = '<mujoco><actuator><motor joint="arm/elbow"/></actuator></mujoco>'
    arm = '<mujoco><worldbody><body><geom size="1"/><joint name="elbow"/></body></worldbody></mujoco>'
    assert workshop.link(BASE, Piece(arm, "arm/"), Piece(refers, "hand/")).fault.code == "unknown-name"


CLASHING = {
    "joint": '<worldbody><body><freejoint name="x"/></body></worldbody>',
    "body": '<worldbody><body name="x"/></worldbody>',
    "site": '<worldbody><site name="x"/></worldbody>',
    "frame": '<worldbody><frame name="x"><geom size="1"/></frame></worldbody>',
    "material": '<asset><material name="x"/></asset>',
    "mesh": '<asset><mesh file="x.obj"/></asset>',
    "tendon": '<tendon><fixed name="x"><joint joint="x" coef="1"/></fixed></tendon>',
    "actuator": '<actuator><motor name="x" joint="x"/></actuator>',
    "sensor": '<sensor><clock name="x"/></sensor>',
    "numeric": '<custom><numeric name="x" data="1"/></custom>',
}
NEEDED = '<worldbody><body><geom size="1"/><joint name="{}"/></body></worldbody>'


@pytest.mark.parametrize("kind", CLASHING)
def test_clashing_names_are_told_with_both_places(workshop: Workshop, kind: str) -> None:
    section = CLASHING[kind]
    needed = kind in ("tendon", "actuator")
    first = f"<mujoco>{NEEDED.format('x') if needed else ''}\n{section}</mujoco>"
    second = first.replace('"x"', '"y"') if needed else first
    second = second.replace('name="y"><joint', 'name="x"><joint').replace('motor name="y"', 'motor name="x"')
    linked = workshop.link(first, Piece(second, "", options={"span": None}))
    clashes = [fault for fault in linked.sink.errors if f"the {kind} `x`" in fault.message]
    assert [fault.code for fault in clashes] == ["name-clash"]
    assert clashes[0].span is not None
    assert clashes[0].span.file == str(linked.paths[1])
    assert str(linked.paths[0]) in [note.span.file for note in clashes[0].notes if note.span]


def test_a_clash_with_an_attachment_is_told_at_the_recipe(workshop: Workshop) -> None:
    linked = workshop.link(BASE, Piece(BASE, ""))
    fault = linked.fault
    assert fault.span is not None
    assert fault.span.file == "recipe.yaml"
    files = [note.span.file for note in fault.notes if note.span]
    assert files == [str(linked.paths[1]), str(linked.paths[0])]


def test_a_source_that_clashes_with_itself_is_told(workshop: Workshop) -> None:
    part = '<mujoco><worldbody>\n<site name="x"/>\n<site name="x"/></worldbody></mujoco>'
    linked = workshop.link(BASE, part)
    fault = linked.fault
    assert (fault.code, fault.span and fault.span.line) == ("name-clash", 3)
    assert [note.span.line for note in fault.notes if note.span] == [2]


def test_kinds_of_thing_do_not_clash_with_one_another(workshop: Workshop) -> None:
    part = """<mujoco><asset><material name="x"/><texture name="x" type="2d" builtin="flat" width="1" height="1"/></asset>
      <worldbody><frame name="x"><body name="x"><joint name="x"/><geom name="x" size="1"/><site name="x"/></body></frame>
      </worldbody><custom><numeric name="x" data="1"/><text name="x" data="1"/></custom>
      <actuator><motor name="x" joint="x"/></actuator><sensor><jointpos name="x" joint="x"/></sensor></mujoco>"""
    workshop.link(part, Piece(part, "x/")).check()


def test_unnamed_things_never_clash(workshop: Workshop) -> None:
    part = '<mujoco><worldbody><body name=""><geom name="" size="1"/><geom size="1"/></body></worldbody></mujoco>'
    workshop.link(part, Piece(part, "")).check()


def test_a_prefixed_name_that_meets_a_name_of_the_base_is_told(workshop: Workshop) -> None:
    base = '<mujoco><worldbody><site name="part/mark"/></worldbody></mujoco>'
    assert workshop.link(base, BASE).fault.code == "name-clash"


@pytest.mark.parametrize(
    ("xml", "name", "expected"),
    [
        ('<replicate count="2"/>', "p/j12", True),
        ('<replicate count="2"/>', "p/joint", False),
        ('<flexcomp name="p/cloth"/>', "p/cloth_3", True),
        ('<flexcomp name="p/cloth"/>', "p/rope_3", False),
        ('<attach prefix="p/left"/>', "p/left_any", True),
        ("<body/>", "p/j1", False),
    ],
)
def test_what_may_be_generated(workshop: Workshop, xml: str, name: str, expected: bool) -> None:
    unit = workshop.unit(f"<mujoco><worldbody>{xml}</worldbody></mujoco>")
    assert may_be_generated(name, unit.root) is expected


# What XML can hold; MuJoCo takes any of it for a name. It folds no white space, which an XML parser does for line breaks.
CHARACTERS = st.characters(blacklist_categories=("Cc", "Cs"), blacklist_characters="\ufffe\uffff")
NAMES = st.text(CHARACTERS, min_size=1, max_size=12)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(NAMES, min_size=2, max_size=6, unique=True), st.text(CHARACTERS, max_size=5))
def test_any_name_comes_through(tmp_path_factory: pytest.TempPathFactory, names: list[str], prefix: str) -> None:
    bodies = "".join(f"<body><geom size='1'/><joint name={quoteattr(name)}/></body>" for name in names)
    motors = "".join(f"<motor name={quoteattr(name)} joint={quoteattr(name)}/>" for name in names)
    part = f"<mujoco><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>"
    linked = Workshop(tmp_path_factory.mktemp("names")).link("<mujoco/>", Piece(part, prefix))
    model = linked.model()
    assert [model.joint(at).name for at in range(model.njnt)] == [prefix + name for name in names]
    assert [model.actuator(at).name for at in range(model.nu)] == [prefix + name for name in names]
    assert model.actuator_trnid[:, 0].tolist() == list(range(len(names)))


TREES = st.recursive(st.just([]), lambda inner: st.lists(inner, min_size=1, max_size=3), max_leaves=8)


def _tree(tree: list[object], counter: list[int]) -> str:
    """Bodies in bodies, some below frames, each with a joint that a motor drives."""
    found = ""
    for child in tree:
        number = counter[0] = counter[0] + 1
        assert isinstance(child, list)
        inner = _tree(child, counter)
        body = (
            f'<body name="b{number}" pos="{number} 0 0"><joint name="j{number}"/><geom name="g{number}" size=".1"/>'
            f"{inner}</body>"
        )
        found += f'<frame pos="0 {number} 0" quat="1 {number} 0 0">{body}</frame>' if number % 3 == 0 else body
    return found


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(TREES, st.booleans()), min_size=1, max_size=4))
def test_random_trees_hang_on_random_places(
    tmp_path_factory: pytest.TempPathFactory, trees: list[tuple[list[object], bool]]
) -> None:
    workshop = Workshop(tmp_path_factory.mktemp("trees"))
    texts: list[str] = []
    for tree, _ in trees:
        counter = [0]
        bodies = _tree([tree], counter)
        motors = "".join(f'<motor joint="j{n}"/>' for n in range(1, counter[0] + 1))
        texts.append(f"<mujoco><worldbody>{bodies}</worldbody><actuator>{motors}</actuator></mujoco>")
    pieces = []
    for at, (text, (_, last)) in enumerate(zip(texts, trees, strict=True)):
        host = f"p{at - 1}/" if last and at else ""
        pieces.append(Piece(text, f"p{at}/", placed("body", f"{host}b1", pos=(0.5, at, 0.25))))
    model = workshop.link(texts[0], *reversed(pieces)).check()
    assert model.njnt == sum(text.count("<joint ") for text in [texts[0], *texts])


def test_the_walk_by_itself_renames_in_place(workshop: Workshop) -> None:
    unit = workshop.unit(
        '<mujoco><default><default class="c"><geom material="m"/></default></default>'
        '<asset><material name="m"/></asset><worldbody><body name="b" childclass="main"/></worldbody></mujoco>'
    )
    found = rename(unit, "p/", top_class="p/")
    assert unit.root.find("worldbody/body").attrib == {"name": "p/b", "childclass": "p/"}
    assert unit.root.find("default/default/geom").get("material") == "p/m"
    assert list(found.declared["material"]) == ["p/m"]
    assert MAIN not in found.declared["default"]
    assert [*found.dangling()] == []


def test_mujoco_shares_names_as_the_grammar_says() -> None:
    """One namespace for all actuators, all sensors, all equalities, joints with free joints, and both tendons."""
    for inner in (
        '<body><freejoint name="x"/><geom size="1"/><body><joint name="x"/><geom size="1"/></body></body>',
        '<body name="x"/><body name="x"/>',
    ):
        with pytest.raises(ValueError, match="repeated name"):
            mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{inner}</worldbody></mujoco>")


TUPLE = '<custom><tuple name="t"><element objtype="key" objname="{}"/></tuple></custom>'


@pytest.mark.parametrize(
    ("name", "policy", "message"),
    [
        ("home", "merge", None),
        ("home", "prefix", None),
        ("hme", "merge", "the key `hme`, which `<element>` refers to, does not exist"),
        ("home", "none", "a tuple refers to the key `home`, which `drop: [key]` drops"),
    ],
)
def test_tuples_of_keys(workshop: Workshop, name: str, policy: str, message: str | None) -> None:
    keys = '<worldbody/><keyframe><key name="rest"/><key name="home" time="2"/></keyframe></mujoco>'
    part = f"<mujoco>{TUPLE.format(name)}{keys}"
    linked = workshop.link(BASE, Piece(part, "p/", options={"keyframes": policy}))
    if message is not None:
        assert linked.fault.message == message
        return
    model = linked.model()
    assert model.key(model.tuple_objid[0]).time == 2
