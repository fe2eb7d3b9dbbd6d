from __future__ import annotations

import os
import random
from pathlib import Path

import mujoco
import pytest
from link.test_files import skin
from link.workshop import Workshop, obj
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.link.measure import measure_with
from mjcompose.link.subtree import Subtree, take_subtree
from mjcompose.mujoco.match import Mount
from mjcompose.mujoco.unchanged import compare
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write
from sampling import rest_slow

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")


class Taken:
    """A subtree taken of a model, and both compiled."""

    def __init__(self, path: Path, body: str, **options: object) -> None:
        self.path = path
        self.body = body
        self.sink = Sink()
        unit = parse_file(path, self.sink)
        assert unit is not None
        self.unit: Unit = unit
        outer = next(iter(unit.root.xpath(f"//body[@name='{body}']/ancestor::body[1]")), None)
        self.parent = None if outer is None else str(outer.get("name"))
        given = {"measure": measure_with(Context(sink=self.sink, environment={})), **options}
        self.found: Subtree | None = take_subtree(unit, body, self.sink, **given)  # type: ignore[arg-type]

    @property
    def xml(self) -> str:
        return write(self.unit.root).decode()

    @property
    def left(self) -> set[str]:
        assert self.found is not None
        return {f"{each.what} {each.name}" for each in self.found.dropped if each.lacks is None}

    @property
    def cut(self) -> dict[str, str | None]:
        assert self.found is not None
        return {f"{each.what} {each.name}": each.lacks for each in self.found.cut}

    def names(self, path: str) -> list[str]:
        return [str(each.get("name")) for each in self.unit.root.iterfind(path)]

    def check(self, *ignore: str) -> mujoco.MjModel:
        """What is there must be, in the whole model, what it is alone at the place of its parent."""
        assert self.found is not None, [each.message for each in self.sink.errors]
        spec = mujoco.MjSpec.from_string(self.xml)
        spec.modelfiledir = str(self.path.parent)
        alone = spec.compile()
        whole = mujoco.MjModel.from_xml_path(str(self.path))
        found = compare(alone, whole, hung_on=Mount(self.parent), ignore=ignore, cut=True)
        assert not found, "\n".join([*map(str, found), self.xml])
        return alone


@pytest.fixture
def take(workshop: Workshop):  # type: ignore[no-untyped-def]
    def take(text: str, body: str, files: dict[str, bytes] | None = None, **options: object) -> Taken:
        return Taken(workshop.write(text, files), body, **options)

    return take


def model(body: str, sections: str = "", head: str = "") -> str:
    return f"""<mujoco>{head}<worldbody><geom name="floor" type="plane" size="1 1 1"/>
      <body name="base"><geom name="base" size=".1"/><joint name="base"/><site name="base"/>
      {body}</body></worldbody>{sections}</mujoco>"""


ARM = """<body name="arm" pos="0 0 1"><geom name="arm" size=".1"/><joint name="arm"/><site name="arm"/>
  <camera name="arm"/><body name="tip" pos="0 0 1"><geom name="tip" size=".1"/><joint name="tip"/><site name="tip"/>
  </body></body>"""


def test_a_body_keeps_its_pose_and_that_of_the_frames_around_it(take) -> None:  # type: ignore[no-untyped-def]
    text = model(
        f"""<frame name="outer" pos="1 2 3" euler="10 20 30"><geom name="gone" size="1"/>
          <frame name="inner" euler="0 90 0">{ARM}</frame></frame>""",
        head='<compiler eulerseq="zyx"/>',
    )
    taken = take(text, "arm")
    taken.check()
    assert [each.tag for each in taken.unit.root.find("worldbody").iter("frame", "body", "geom")] == [
        "frame",
        "frame",
        "body",
        "geom",
        "body",
        "geom",
    ]
    assert {"geom gone", "geom floor", "body base", "joint base"} <= taken.left


@pytest.mark.parametrize("frame", ["", ' childclass="inner"'])
@pytest.mark.parametrize("own", ["", ' childclass="own"'])
def test_the_class_of_what_is_around_it_stays_in_force(take, frame: str, own: str) -> None:  # type: ignore[no-untyped-def]
    classes = """<default><geom density="300"/><default class="outer"><joint armature="1"/>
      <default class="inner"><joint damping="2"/></default></default>
      <default class="own"><joint stiffness="3"/></default>
      <default class="none"><joint stiffness="4"/></default></default>"""
    text = model(f'<body name="mid" childclass="outer"><frame{frame}>{ARM}</frame></body>', head=classes)
    taken = take(text.replace('<body name="arm"', f'<body name="arm"{own}'), "arm")
    taken.check()
    assert "default class none" in taken.left


def test_the_flexes_of_a_body_keep_the_class_of_its_joints(take) -> None:  # type: ignore[no-untyped-def]
    """MuJoCo asks the body for it, not the frame; and leaves armatures out of the weight of what is all by itself."""
    classes = '<default><default class="soft"><joint armature="0.5"/></default></default>'
    flex = '<flexcomp name="f" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1"/>'
    text = model(f'<frame childclass="soft"><body name="arm">{flex}</body></frame>', head=classes)
    compiled = take(text.replace('<joint name="base"/>', ""), "arm").check("invweight0")
    assert compiled.dof_armature.tolist() == [0.5] * 27


SECTIONS = """
<contact><pair name="in" geom1="arm" geom2="tip"/><pair name="both" geom1="arm" geom2="base"/>
  <pair name="out" geom1="base" geom2="floor"/><exclude name="in" body1="arm" body2="tip"/>
  <exclude name="both" body1="arm" body2="base"/></contact>
<tendon><fixed name="in"><joint joint="arm" coef="1"/><joint joint="tip" coef="1"/></fixed>
  <spatial name="both"><site site="arm"/><geom geom="base" sidesite="tip"/><site site="tip"/></spatial>
  <fixed name="out"><joint joint="base" coef="1"/></fixed></tendon>
<equality><joint name="in" joint1="arm"/><joint name="both" joint1="arm" joint2="base"/><weld name="world" body1="arm"/>
  <tendon name="cut tendon" tendon1="in" tendon2="both"/><connect name="out" body1="base" anchor="0 0 0"/></equality>
<actuator><motor name="in" tendon="in"/><motor name="both" tendon="both"/><motor name="out" joint="base"/></actuator>
<sensor><tendonpos name="in" tendon="in"/><actuatorfrc name="both" actuator="both"/><clock name="none"/>
  <framepos name="world" objtype="site" objname="arm" reftype="body" refname="world"/>
  <framepos name="ref" objtype="site" objname="arm" reftype="geom" refname="base"/>
  <jointpos name="out" joint="base"/></sensor>
<custom><numeric name="none" data="1"/><text name="none" data="x"/>
  <tuple name="in"><element objtype="actuator" objname="in"/></tuple>
  <tuple name="both"><element objtype="body" objname="arm"/><element objtype="body" objname="base"/></tuple></custom>"""


def test_what_concerns_the_body_alone_comes_with_it(take) -> None:  # type: ignore[no-untyped-def]
    taken = take(model(ARM, SECTIONS), "arm")
    taken.check()
    kept = {
        section: taken.names(f"{section}/*")
        for section in ("contact", "tendon", "equality", "actuator", "sensor", "custom")
    }
    assert kept == {
        "contact": ["in", "in"],
        "tendon": ["in"],
        "equality": ["in"],
        "actuator": ["in"],
        "sensor": ["in", "world"],
        "custom": ["in"],
    }
    assert taken.cut == {
        "pair both": "the geom `base`",
        "exclude both": "the body `base`",
        "tendon both": "the geom `base`",
        "equality both": "the joint `base`",
        "equality cut tendon": "the tendon `both`",
        "equality world": "the world",
        "actuator both": "the tendon `both`",
        "sensor both": "the actuator `both`",
        "sensor ref": "the geom `base`",
        "tuple both": "the body `base`",
    }
    assert taken.left >= {
        "pair out",
        "tendon out",
        "equality out",
        "actuator out",
        "sensor out",
        "sensor none",
        "numeric none",
        "text none",
    }


def test_what_a_tuple_of_the_body_holds_comes_with_it(take) -> None:  # type: ignore[no-untyped-def]
    custom = """<sensor><clock name="in"/><clock name="out"/></sensor>
      <custom><numeric name="in" data="1 2"/><numeric name="out" data="1"/><text name="in" data="said"/>
      <tuple name="inner"><element objtype="sensor" objname="in"/><element objtype="text" objname="in"/></tuple>
      <tuple name="arm"><element objtype="body" objname="arm"/><element objtype="numeric" objname="in"/>
        <element objtype="tuple" objname="inner"/></tuple></custom>"""
    taken = take(model(ARM, custom), "arm")
    taken.check()
    assert taken.names("custom/*") == ["in", "in", "inner", "arm"]
    assert taken.names("sensor/*") == ["in"]
    assert taken.left >= {"numeric out", "sensor out"}


def test_a_camera_that_looks_at_something_else_is_cut(take) -> None:  # type: ignore[no-untyped-def]
    sensor = '<sensor><camprojection name="seen" site="arm" camera="back"/></sensor>'
    look = '<camera name="{}" mode="targetbody" target="{}"/><light name="{}" mode="targetbody" target="{}"/>'
    arm = ARM.replace(
        "<joint", look.format("back", "base", "lit", "base") + look.format("on", "tip", "on", "arm") + "<joint", 1
    )
    taken = take(model(arm, sensor), "arm")
    model_ = taken.check()
    assert taken.cut == {
        "camera back": "the body `base`",
        "light lit": "the body `base`",
        "sensor seen": "the camera `back`",
    }
    assert (model_.ncam, model_.nlight) == (2, 1)


ASSETS = """<default><default class="a"><geom material="by class"/></default><default class="b"><geom mesh="gone"/></default>
  <default class="m"><mesh scale="2 2 2"/></default></default>
<asset><texture name="t" type="2d" builtin="flat" width="2" height="2"/><texture name="gone" type="2d" builtin="flat"
  width="2" height="2"/><texture type="skybox" builtin="flat" width="2" height="2"/><texture name="l" type="2d"
  builtin="flat" width="2" height="2"/><material name="by class" texture="t"/><material name="by layer"><layer role="rgb"
  texture="l"/></material><material name="gone" texture="gone"/><mesh file="unnamed.obj" class="m"/>
  <mesh name="gone" file="gone.obj"/><hfield name="gone" nrow="2" ncol="2" size="1 1 1 1"/></asset>"""


def test_assets_and_classes_come_as_far_as_they_are_needed(take) -> None:  # type: ignore[no-untyped-def]
    arm = '<body name="arm"><geom type="mesh" mesh="unnamed" class="a"/><site material="by layer"/></body>'
    text = model(f'{arm}<geom type="mesh" class="b"/><geom size="1" material="gone"/>', head=ASSETS)
    taken = take(text, "arm", {"unnamed.obj": obj(), "gone.obj": obj(0.2)})
    compiled = taken.check()
    assert (compiled.nmesh, compiled.nmat, compiled.ntex, compiled.nhfield) == (1, 2, 2, 0)
    assert taken.left >= {"mesh gone", "material gone", "texture gone", "hfield gone", "texture ", "default class b"}
    assert [each.get("class") for each in taken.unit.root.iterfind("default/default")] == ["a", "m"]


def test_plugins_come_if_they_are_used(take) -> None:  # type: ignore[no-untyped-def]
    head = """<extension><plugin plugin="mujoco.pid"><instance name="used"><config key="kp" value="4"/></instance>
      <instance name="free"/></plugin><plugin plugin="mujoco.sensor.touch_grid"/></extension>"""
    actuator = """<actuator><plugin name="in" joint="arm" instance="used"/>
      <plugin name="out" joint="base" instance="free"/></actuator>"""
    taken = take(model(ARM, actuator, head), "arm")
    taken.check()
    assert {"plugin mujoco.sensor.touch_grid", "plugin instance free"} <= taken.left


def keyed(keys: str) -> str:
    actuators = '<motor joint="base"/><intvelocity joint="tip" actrange="-1 1" name="i"/><motor joint="arm"/>'
    return model(ARM, f"<actuator>{actuators}</actuator><keyframe>{keys}</keyframe>", '<size nkey="5"/>')


def test_keys_keep_the_columns_of_the_body(take) -> None:  # type: ignore[no-untyped-def]
    taken = take(
        keyed("""<key name="all" time="2" qpos="1 2 3" qvel="4 5 6" act=".5" ctrl="7 8 9"/>
        <key name="short" qpos="1 2"/><key name="other" qpos="1"/><key name="none" time="1"/>"""),
        "arm",
    )
    assert write(taken.unit.root.find("keyframe")).decode().split() == [
        "<keyframe>",
        *'<key name="all" time="2" qpos="2 3" qvel="5 6" act=".5" ctrl="8 9"/>'.split(),
        *'<key name="short" qpos="2"/>'.split(),
        "</keyframe>",
    ]
    assert {"key other", "key none"} <= taken.left
    assert "<size" not in taken.xml
    taken.check()


def test_a_free_body_keeps_where_its_keys_put_it(take) -> None:  # type: ignore[no-untyped-def]
    text = """<mujoco><worldbody><body name="a"><freejoint/><geom size=".1"/></body>
      <frame euler="0 0 90"><body name="b" mocap="true"/><body name="c"><freejoint/><geom size=".1"/></body></frame></worldbody>
      <keyframe><key name="k" qpos="1 2 3 1 0 0 0 4 5 6 0 1 0 0" mpos="7 8 9"/></keyframe></mujoco>"""
    assert take(text, "c").check().key_qpos.tolist() == [[4, 5, 6, 0, 1, 0, 0]]
    assert take(text, "b").check().key_mpos.tolist() == [[7, 8, 9]]


def test_keys_of_which_nothing_is_wanted_are_not_read(take) -> None:  # type: ignore[no-untyped-def]
    taken = take(keyed('<key qpos="1 2 3 4 5"/>'), "arm", keyframes="none")
    assert taken.found is not None
    assert taken.unit.root.find("keyframe") is None
    (fault,) = take(keyed('<key qpos="1 2 3 4 5"/>'), "arm").sink.errors
    assert fault.code == "keyframe-conflict"


def test_the_mass_that_the_whole_model_is_given_stays(take) -> None:  # type: ignore[no-untyped-def]
    for settings in ("", ' inertiafromgeom="true" boundmass="0.5"'):
        taken = take(model(ARM, head=f'<compiler settotalmass="30"{settings}/>'), "arm")
        taken.check()
        assert "settotalmass" not in taken.xml


def test_a_mass_that_is_shared_out_with_fused_bodies_is_told(take) -> None:  # type: ignore[no-untyped-def]
    head = '<compiler settotalmass="3" fusestatic="true"/>'
    taken = take(model(ARM.replace('<joint name="arm"/>', ""), head=head), "tip")
    assert taken.found is None
    (fault,) = taken.sink.errors
    assert fault.message.endswith("cannot be kept in a composition: `fusestatic` joins this body with another")


def test_what_holds_for_the_whole_model_is_left(take) -> None:  # type: ignore[no-untyped-def]
    head = """<statistic extent="3"/><visual><map znear=".05" zfar="9"/><headlight active="0"/></visual>
      <option timestep=".001"/>"""
    taken = take(model(ARM, head=head), "arm")
    taken.check()
    assert {"setting statistic", "setting visual/headlight"} <= taken.left
    assert '<map znear=".05"/>' in taken.xml, "the camera's intrinsics depend on it"
    assert "timestep" in taken.xml
    blind = take(model(ARM.replace('<camera name="arm"/>', ""), head=head), "arm")
    assert "visual" not in blind.xml


def test_names_that_mujoco_makes_belong_where_they_are_made(take) -> None:  # type: ignore[no-untyped-def]
    legs = '<replicate count="2" euler="0 0 90"><body name="{0}"><geom name="{0}" size=".1"/><joint name="{0}"/></body></replicate>'
    sections = """<sensor><jointpos name="in" joint="leg1"/><jointpos name="out" joint="wheel1"/>
      <framepos name="both" objtype="geom" objname="leg0" reftype="geom" refname="wheel1"/></sensor>"""
    arm = ARM.replace("<joint", legs.format("leg") + "<joint", 1)
    taken = take(model(arm + legs.format("wheel"), sections), "arm")
    taken.check()
    assert (taken.names("sensor/*"), list(taken.cut)) == (["in"], ["sensor both"])


def test_skins_and_flexes_belong_to_their_bodies(take) -> None:  # type: ignore[no-untyped-def]
    files = {"in.skn": skin("arm", "tip"), "both.skn": skin("base", "arm"), "out.skn": skin("base")}
    deformable = """<asset><skin file="in.skn"/><skin file="out.skn"/></asset><deformable><skin file="both.skn"/>
      <flex name="in" dim="1" body="arm tip" vertex="0 0 0 0 0 0" element="0 1"/>
      <flex name="both" dim="1" body="base tip" vertex="0 0 0 0 0 0" element="0 1"/></deformable>"""
    taken = take(model(ARM, deformable), "arm", files)
    compiled = taken.check()
    assert taken.cut == {"skin both": "the body `base`", "flex both": "the body `base`"}
    assert (compiled.nskin, compiled.nflex) == (1, 1)
    assert "skin out" in taken.left
    unreadable = take(model(ARM, '<deformable><skin file="no.skn"/></deformable>'), "arm")
    assert unreadable.unit.root.find("deformable/skin") is not None, "it is told where all files are read"


def test_a_body_that_is_several_cannot_be_taken(take) -> None:  # type: ignore[no-untyped-def]
    (fault,) = take(model(f'<replicate count="3">{ARM}</replicate>'), "tip").sink.errors
    assert fault.code == "not-supported"


@pytest.mark.parametrize(("name", "help"), [("amr", "did you mean `subtree: arm`?"), ("world", None), ("xyzzy", None)])
def test_a_body_that_is_not_there_is_told(take, name: str, help: str | None) -> None:  # type: ignore[no-untyped-def]
    taken = take(model(ARM), name)
    (fault,) = taken.sink.errors
    assert (taken.found, fault.code, fault.help) == (None, "unknown-name", help)
    assert fault.notes[0].message == "bodies that exist: base, arm, tip"


def test_included_bodies_know_where_they_are_written(workshop: Workshop) -> None:
    included = (
        '<mujoco>\n<worldbody>\n<body name="base"><body name="arm"><geom size=".1"/></body></body></worldbody></mujoco>'
    )
    path = workshop.write('<mujoco><include file="sub/arm.xml"/></mujoco>', {"sub/arm.xml": included})
    taken = Taken(path, "arm")
    (geom,) = taken.unit.root.iter("geom")
    span = taken.unit.origins.span(geom, taken.unit.file)
    assert (Path(span.file).name, span.line) == ("arm.xml", 3)


def _bodies(path: Path) -> list[str]:
    """The bodies of a file that have a name, as do those around them, and that are one body each."""
    root = etree.parse(path).getroot()
    found = root.xpath(
        "/mujoco/worldbody//body[@name and not(ancestor::body[not(@name)]) and not(ancestor::replicate)]/@name"
    )
    return sorted(map(str, found))


@pytest.mark.skipif(CORPUS is None, reason="MJCOMPOSE_CORPUS is not set")
@pytest.mark.parametrize(
    "robot",
    rest_slow(
        ["franka_emika_panda/panda.xml", "shadow_hand/right_hand.xml", "unitree_g1/g1.xml", "aloha/aloha.xml"],
        quick=["shadow_hand/right_hand.xml"],
    ),
)
def test_any_body_of_a_robot(robot: str) -> None:
    path = Path(str(CORPUS)) / "models" / robot
    bodies = _bodies(path)
    assert len(bodies) > 8
    for body in random.Random(robot).sample(bodies, 4):
        Taken(path, body).check()
