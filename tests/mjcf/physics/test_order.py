"""Every element is named in a copy: MuJoCo then says by name where the one without a name must be."""

from __future__ import annotations

import copy
from pathlib import Path

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, RootElement
from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.index import compiled_kind
from sampling import rest_slow

_TAGS = (
    "body joint geom site camera light mesh texture material hfield skin flex pair exclude equality tendon actuator "
    "sensor numeric text tuple key"
).split()


def _judged(model: RootElement) -> int:
    """How many elements are bound, all of them where MuJoCo has them."""
    twin = copy.deepcopy(model)
    elements = [element for tag in _TAGS for element in model.find_all(tag)]
    twins = [element for tag in _TAGS for element in twin.find_all(tag)]
    for number, element in enumerate(twins):
        if element.name is None:
            element.name = f"number-{number}"
    physics = model.compile_model(conflict="base")
    ids = NameTable(twin.compile_model(conflict="base").model).ids
    bound = 0
    for element, named in zip(elements, twins, strict=True):
        kind = compiled_kind(element._node)
        row = ids[str(kind)].get(str(named.full_identifier))
        if row is not None:
            assert physics.bind(element).element_id == row, element
            bound += 1
    return bound


TREE = """
<mujoco><worldbody>
  <geom size="1"/>
  <frame><body><body><geom size="2"/></body><geom size="3"/><frame><site/><geom size="4"/></frame></body></frame>
  <geom size="5"/>
  <body><joint/><geom size="6"/><frame><joint axis="1 0 0"/></frame></body>
  <body><freejoint/><geom size="7"/><light/><camera/></body>
</worldbody></mujoco>
"""
CONTACTS = """
<mujoco><worldbody>
  <body name="a"><geom name="a" size="1"/></body><body name="b"><geom name="b" size="1"/><geom name="b2" size="2"/></body>
  <body name="c"><geom name="c" size="1"/></body>
</worldbody><contact>
  <pair geom1="c" geom2="b"/><pair geom1="a" geom2="c"/><pair geom1="b2" geom2="a"/><pair name="p" geom1="b" geom2="a"/>
  <exclude body1="c" body2="b"/><exclude body1="a" body2="c"/><exclude name="x" body1="b" body2="a"/>
</contact></mujoco>
"""
SECTIONS = """
<mujoco><worldbody><body><joint name="j"/><joint name="k" axis="1 0 0"/><geom size="1"/><site name="s"/><site name="t" pos="1 0 0"/></body></worldbody>
<equality><joint joint1="j"/><joint joint1="k"/></equality>
<tendon><fixed><joint joint="j" coef="1"/></fixed><spatial><site site="s"/><site site="t"/></spatial></tendon>
<sensor><jointpos joint="k"/><framepos objtype="site" objname="s"/><clock/></sensor>
<actuator><motor joint="k"/><position joint="j"/></actuator>
<keyframe><key time="1"/><key name="two"/><key/></keyframe></mujoco>
"""
GENERATED = """
<mujoco><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/><light/>
  <body><geom size="1"/><site/></body>
  <replicate count="3" offset="1 0 0"><body><geom size="1"/></body></replicate>
  <body name="after"><joint/><geom size="2"/></body>
  <flexcomp name="cloth" type="grid" count="3 3 1" spacing="0.1 0.1 0.1" radius="0.01"/>
  <body><geom size="3"/><camera/></body>
</worldbody></mujoco>
"""


@pytest.mark.parametrize(
    ("xml", "bound"), [(TREE, 17), (CONTACTS, 14), (SECTIONS, 18)], ids=["tree", "contacts", "sections"]
)
def test_unnamed_elements_are_found_by_their_place(xml: str, bound: int) -> None:
    assert _judged(mjcf.from_xml_string(xml)) == bound


def test_beside_what_mujoco_generates(tmp_path: Path) -> None:
    model = mjcf.from_xml_string(GENERATED)
    physics = model.compile_model()
    sizes = [
        float(physics.bind(geom).size[0]) for geom in model.find_all("geom") if geom.parent.parent.tag != "replicate"
    ]
    assert sizes == [1, 1, 2, 3]
    assert physics.bind(model.find("flex", "cloth")).vertnum == 9
    inside = model.find("replicate") or model.find_all("replicate")[0]
    with pytest.raises(MjcfError, match=r"`<body>` is in a `<replicate>`: MuJoCo has made several copies of it"):
        physics.bind(inside.find("body"))


@pytest.mark.mujoco4("it copies keys next to a replicate")
def test_a_key_next_to_a_replicate() -> None:
    model = mjcf.from_xml_string(GENERATED.replace("</mujoco>", '<keyframe><key name="k"/></keyframe></mujoco>'))
    physics = model.compile_model()
    assert physics.bind(model.find("key")).element_id == physics.model.key("k").id


def test_what_refers_to_something_in_a_replicate_is_made_several_of() -> None:
    model = mjcf.from_xml_string(
        "<mujoco><worldbody><replicate count='3' euler='0 0 20'><body name='b'><joint name='j'/><geom size='1'/></body>"
        "</replicate></worldbody><actuator><motor name='m' joint='j'/></actuator></mujoco>"
    )
    with pytest.raises(MjcfError, match=r"has made several copies of `<motor>` `m`, which refers to something in"):
        model.compile_model().bind(model.find("motor", "m"))


def test_nothing_is_mistaken_where_mujoco_takes_bodies_out() -> None:
    """With `fusestatic` the geoms of the first body go to the world and come last there."""
    model = mjcf.from_xml_string(
        '<mujoco><compiler fusestatic="true"/><worldbody><body><geom size="2"/></body><geom size="1"/>'
        '<body name="m"><joint/><geom name="n" size="3"/></body></worldbody></mujoco>'
    )
    physics = model.compile_model()
    assert physics.model.nbody == 2 and physics.model.ngeom == 3
    assert physics.bind(model.find("geom", "n")).size[0] == 3
    with pytest.raises(MjcfError, match="has no name, and which geom of the compiled model it is cannot be determined"):
        physics.bind(model.find("geom"))


def test_discarded_visuals() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><compiler discardvisual="true"/><worldbody><geom name="v" size="1" contype="0" conaffinity="0"/>'
        '<geom name="g" size="2"/></worldbody></mujoco>'
    )
    physics = model.compile_model()
    assert physics.bind(model.find("geom", "g")).element_id == 0
    with pytest.raises(MjcfError, match="the compiled model has no geom `v`") as caught:
        physics.bind(model.find("geom", "v"))
    assert "geoms that exist: g" in str(caught.value)


def test_in_a_composition(arm: RootElement, gripper: RootElement) -> None:
    arm.find("body", "upper").attach(gripper).add("joint", type="hinge")
    assert _judged(arm) > 30


@pytest.mark.parametrize(
    "name",
    rest_slow(
        ["franka_emika_panda/panda.xml", "wonik_allegro/left_hand.xml", "mujoco_model/humanoid/humanoid.xml"],
        quick=["mujoco_model/humanoid/humanoid.xml"],
    ),
)
def test_in_robots(name: str, corpus: Path) -> None:
    assert _judged(mjcf.from_path(corpus / "models" / name)) > 50
