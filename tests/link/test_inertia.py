from __future__ import annotations

import mujoco
import pytest
from link.workshop import BASE, Piece, Workshop, hinge, placed

MESH = '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 2 0 0 0 3 1 1 1"/></asset>'
PRIMITIVES = ("sphere", "capsule", "cylinder", "box", "ellipsoid")


def fitted(worldbody: str, fitaabb: str = "true") -> str:
    return f"""
    <mujoco><compiler fitaabb="{fitaabb}"/>
      <default><default class="box"><geom type="box" mesh="m"/></default>
        <default class="wide"><geom mesh="m" fitscale="2" type="capsule"/></default></default>{MESH}
      <worldbody>{worldbody}</worldbody></mujoco>"""


@pytest.mark.parametrize("kind", PRIMITIVES)
@pytest.mark.parametrize("pose", ["", 'pos="1 2 3" euler="10 20 30"', 'axisangle="0 1 1 20"'])
def test_a_primitive_fitted_to_a_box_stays_as_large(workshop: Workshop, kind: str, pose: str) -> None:
    part = fitted(f'<body name="b"><freejoint/><geom type="{kind}" mesh="m" {pose}/></body>')
    workshop.link(BASE, Piece(part, place=placed(pos=(1.0, 0.0, 0.0)))).check()


def test_geoms_are_counted_as_mujoco_counts_them(workshop: Workshop) -> None:
    part = fitted("""
      <geom name="0" class="box" euler="10 20 30"/>
      <body name="b" pos="1 1 1">
        <body name="c"><geom type="capsule" mesh="m" pos="1 0 0"/><geom type="mesh" mesh="m"/><geom size=".1"/></body>
        <frame><geom type="sphere" mesh="m"/></frame>
        <geom type="ellipsoid" mesh="m" mass="3"/>
        <geom class="wide" fitscale="3"/>
      </body>
      <geom name="1" type="cylinder" mesh="m"/>""")
    workshop.link(BASE, part).check()


def test_a_frame_above_is_allowed_for(workshop: Workshop) -> None:
    part = fitted("""
      <body name="b"><frame pos="1 2 3" euler="4 5 6"><geom class="box" axisangle="1 0 0 20"/>
        <frame quat="1 1 0 0"><geom class="wide"/><geom size=".1"/></frame></frame></body>""")
    workshop.link(BASE, part).check(tolerance=1e-12)


def test_the_base_is_fitted_too(workshop: Workshop) -> None:
    base = fitted('<geom name="g" class="box"/>')
    linked = workshop.link(base, fitted('<body name="b"><geom class="box"/></body>', "false"))
    linked.check()
    assert "fitaabb" not in linked.xml


def test_a_model_without_fitted_primitives_is_not_measured(workshop: Workshop) -> None:
    workshop.link(BASE, fitted('<body><geom type="mesh" mesh="m"/></body>'), measure=None).check()


def test_copies_are_fitted_where_they_are_alike(workshop: Workshop) -> None:
    body = '<replicate count="2" offset="1 0 0"><body name="b"><joint/><geom class="box" euler="1 2 3"/></body></replicate>'
    workshop.link(BASE, fitted(body)).check()


def test_copies_of_a_geom_on_one_body_cannot_be_measured(workshop: Workshop) -> None:
    part = fitted('<replicate count="2" offset="1 0 0"><geom class="box"/></replicate>')
    fault = workshop.link(BASE, part).fault
    assert fault.code == "compiler-setting"
    assert "copies" in fault.message


BODIES = """
    <body name="a" pos="1 2 3" euler="10 20 30">
      <joint/><geom size=".1"/><inertial pos="0 0 .1" mass="1" diaginertia="1 1 1.5" euler="5 6 7"/>
      <body name="b" pos="1 0 0" axisangle="0 1 1 20"><geom size=".1" mass="0"/><geom size=".2" pos="0 1 0"/></body>
      <body name="empty"/>
    </body>
    <frame pos="5 6 7" euler="3 4 5">
      <body name="c" pos="0 0 1" quat="1 1 0 0">
        <frame pos="1 1 1" euler="0 0 9"><geom type="box" size=".1 .2 .3" density="0"/><joint type="slide"/></frame>
        <inertial pos="0 0 .1" mass="2" fullinertia="1 1.2 1.5 .1 0 .2"/>
        <body name="d"><frame pos="0 1 0"><geom type="box" size=".1 .2 .3" euler="1 2 3"/></frame></body>
      </body>
    </frame>
    <body name="e"><geom class="light" size=".3" pos="1 0 0"/><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    </body>
    <body name="f"><geom class="heavy" size=".3" pos="1 0 0"/><joint/></body>
"""
MODEL = """
<mujoco>
  <compiler {settings}/>
  <default><geom density="500"/><default class="light"><geom mass="0"/></default>
    <default class="heavy"><geom mass="7"/></default></default>
  <worldbody><geom name="still" size=".5"/>{bodies}</worldbody>
</mujoco>
"""
WAYS = ('inertiafromgeom="true"', 'inertiafromgeom="false"', 'inertiafromgeom="auto"')


def model(settings: str, bodies: str = BODIES) -> str:
    return MODEL.format(settings=settings, bodies=bodies)


@pytest.mark.parametrize("settings", WAYS)
@pytest.mark.parametrize("other", WAYS)
def test_each_unit_takes_its_mass_from_where_it_did(workshop: Workshop, settings: str, other: str) -> None:
    # Bodies that nothing gives mass may not have joints.
    bodies = BODIES.replace("<joint/>", "").replace('<joint type="slide"/>', "")
    part = Piece(model(settings, bodies), place=placed(pos=(9.0, 0.0, 0.0)))
    linked = workshop.link(model(other, bodies), part)
    linked.check()
    assert "inertiafromgeom" not in linked.xml


def test_a_body_without_inertia_gets_the_frame_that_mujoco_gives_it(workshop: Workshop) -> None:
    part = '<mujoco><compiler inertiafromgeom="false"/><worldbody><body name="b" pos="1 2 3" euler="10 20 30"/></worldbody></mujoco>'
    composed = workshop.link(BASE, part).check()
    body = composed.body("part/b")
    assert body.mass == 0
    assert body.ipos.tolist() == [1, 2, 3]


GROUPED = """
    <body name="a"><joint/><geom size=".05"/><geom size=".1" group="1"/><geom size=".2" group="3" mass="4"/>
      <geom size=".3" pos="1 0 0" class="zero"/></body>
    <body name="b"><joint/><geom size=".1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="c"><frame><geom size=".1" class="zero"/><geom size=".2" class="zero" group="2"/></frame></body></body>
    <replicate count="2" offset="0 1 0"><body name="r"><joint/><geom size=".1"/><geom group="5" size=".2"/></body>
    </replicate>
"""


@pytest.mark.parametrize("groups", ["0 5", "1 2", "2 2", "0 3"])
@pytest.mark.parametrize("way", WAYS[::2])
def test_only_some_groups_have_mass(workshop: Workshop, groups: str, way: str) -> None:
    text = f"""
    <mujoco><compiler inertiagrouprange="{groups}" {way}/>
      <default><geom group="2"/><default class="zero"><geom group="0" density="50"/></default></default>
      <worldbody>{GROUPED}</worldbody></mujoco>"""
    linked = workshop.link(BASE, text)
    linked.check()
    workshop.link(text, BASE).check()
    assert "inertiagrouprange" not in linked.xml


MEASURED = [
    'balanceinertia="true"',
    'boundmass="2"',
    'boundinertia=".3"',
    'boundmass=".5" boundinertia=".01"',
    'settotalmass="7"',
    'settotalmass="7" inertiafromgeom="true"',
    'boundmass="3" inertiagrouprange="0 4"',
]


@pytest.mark.parametrize("settings", MEASURED)
def test_what_only_mujoco_computes_is_measured(workshop: Workshop, settings: str) -> None:
    bodies = BODIES.replace("1 1 1.5", "1 1 3") if "balance" in settings else BODIES
    linked = workshop.link(model("", BODIES), Piece(model(settings, bodies), place=placed(pos=(1.0, 2.0, 0.0))))
    linked.check()
    for name in ("balanceinertia", "boundmass", "boundinertia", "settotalmass"):
        assert name not in linked.xml


@pytest.mark.parametrize("settings", MEASURED[:1] + MEASURED[3:5])
def test_the_base_is_measured_too(workshop: Workshop, settings: str) -> None:
    bodies = BODIES.replace("1 1 1.5", "1 1 3") if "balance" in settings else BODIES
    workshop.link(model(settings, bodies), model("", BODIES)).check()


def test_thin_plates_survive_being_measured(workshop: Workshop) -> None:
    """Of these two moments of inertia add up to the third but for the last bit."""
    plates = """
      <body name="a"><joint/><geom type="box" size="1 1 1e-9"/></body>
      <body name="b"><joint/><geom type="box" size=".3 .7 1e-5" euler="10 20 30"/></body>"""
    workshop.link(BASE, model('settotalmass="3"', plates)).check()


def test_an_inertial_without_mass_keeps_its_frame(workshop: Workshop) -> None:
    """MuJoCo gives another one to a body that has none."""
    text = """<mujoco><compiler balanceinertia="true"/><worldbody><body name="flange" pos="0 0 1" quat="0.6 0.8 0 0">
      <inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/><site/></body></worldbody></mujoco>"""
    workshop.link(text, text).check()


def test_a_model_alone_keeps_its_rules(workshop: Workshop) -> None:
    linked = workshop.link(model('boundmass="2" inertiafromgeom="true"'))
    assert 'boundmass="2"' in linked.xml
    assert "<inertial" in linked.xml
    linked.check()


FLEXCOMP = '<flexcomp name="c" type="grid" count="2 2 1" spacing="1 1 1" dim="2" mass="1" radius=".01"/>'
COPIES = (
    '<replicate count="2" offset="1 0 0" euler="0 0 9"><body><joint/><geom size=".1" pos="1 0 0"/></body></replicate>'
)


@pytest.mark.parametrize("settings", MEASURED)
def test_copies_are_measured_where_they_are_alike(workshop: Workshop, settings: str) -> None:
    workshop.link(BASE, model(settings, COPIES)).check()


def test_what_mujoco_expands_cannot_be_measured(workshop: Workshop) -> None:
    linked = workshop.link(BASE, model('boundmass="2"', FLEXCOMP))
    fault = linked.fault
    assert fault.code == "compiler-setting"
    assert "`boundmass`" in fault.message
    assert fault.span is not None
    assert (fault.span.file, fault.span.line) == (str(linked.paths[1]), 3)


def test_without_mujoco_at_hand_it_is_told(workshop: Workshop) -> None:
    assert workshop.link(BASE, model('boundmass="2"'), measure=None).fault.code == "compiler-setting"


def test_a_part_that_mujoco_rejects_is_told(workshop: Workshop) -> None:
    part = model('boundmass="0" settotalmass="1"', '<body name="b"><joint/><geom type="mesh" mesh="no"/></body>')
    linked = workshop.link(BASE, part)
    assert linked.fault.code == "mujoco-rejects"


@pytest.mark.parametrize("setting", ['settotalmass="3"', 'boundinertia=".1"', 'balanceinertia="true"'])
@pytest.mark.parametrize("aligned", ['alignfree="true"', ""])
def test_a_free_body_aligned_with_its_inertia_keeps_it(workshop: Workshop, setting: str, aligned: str) -> None:
    """Up to rounding: the inertia is measured in the aligned frame, and written in the body's own."""
    align = "" if aligned else 'align="true"'
    part = f"""<mujoco><compiler {setting} {aligned}/><worldbody><frame pos="0 1 0" euler="0 0 30">
      <body name="cube" pos="1 2 3" euler="10 20 30"><freejoint {align}/>
      <geom type="box" size=".1 .2 .3" pos=".1 .2 .3" euler="40 50 60"/></body></frame></worldbody></mujoco>"""
    linked = workshop.link(part, Piece(BASE, "p/"))
    alone = linked.alone(0)
    composed = linked.model()
    for array in ("body_pos", "body_quat", "body_mass", "body_inertia", "body_ipos", "geom_pos", "geom_quat"):
        assert getattr(composed, array)[-1] == pytest.approx(getattr(alone, array)[-1], abs=1e-12), array


def test_one_massive_geom_is_enough_to_replace_an_inertial(workshop: Workshop) -> None:
    """With `inertiafromgeom="true"` a geom without mass beside one with mass changes nothing."""
    part = """
    <mujoco><compiler inertiafromgeom="true"/><worldbody>
      <body name="b"><joint/><inertial pos="1 0 0" mass="99" diaginertia="9 9 9"/>
        <geom size=".1" mass="0"/><geom size=".2" pos="0 1 0" mass="2"/></body>
      <body name="none"><joint/><inertial pos="1 0 0" mass="99" diaginertia="9 9 9"/><geom size=".1" mass="0"/></body>
    </worldbody></mujoco>"""
    model = workshop.link(BASE, part).check()
    assert model.body("part/b").mass[0] == 2


MUSCLES = """
<mujoco>
  <compiler>{rules}</compiler>
  <worldbody>
    <body name="b"><joint name="j" range="-30 50"/><geom size=".1"/><site name="p" pos=".2 0 0"/></body>
    <site name="q" pos=".5 .5 0"/>
  </worldbody>
  <tendon><spatial name="t"><site site="p"/><site site="q"/></spatial></tendon>
  <actuator>
    <muscle tendon="t"/><motor joint="j"/><muscle joint="j"/><muscle joint="j" lengthrange="0 3"/>
    <position joint="j"/>
  </actuator>
</mujoco>
"""
RULES = ['mode="all"', 'mode="muscle" inttotal="3"', 'mode="muscleuser" useexisting="false"', 'uselimit="true"']


@pytest.mark.parametrize("rule", RULES)
def test_muscles_keep_the_range_that_their_own_rules_give(workshop: Workshop, rule: str) -> None:
    muscles = MUSCLES.format(rules=f"<lengthrange {rule}/>")
    workshop.link(BASE, muscles).check()
    linked = workshop.link(muscles, BASE)
    linked.check()
    assert "<lengthrange" not in linked.xml


def test_the_rules_of_one_part_do_not_reach_another(workshop: Workshop) -> None:
    plain = MUSCLES.format(rules="")
    ruled = MUSCLES.format(rules='<lengthrange mode="all" uselimit="true"/>')
    workshop.link(plain, ruled).check()


def test_a_model_alone_keeps_its_rules_lengthranges(workshop: Workshop) -> None:
    linked = workshop.link(MUSCLES.format(rules='<lengthrange mode="none"/>'))
    assert '<lengthrange mode="none"/>' in linked.xml
    linked.check()


def test_a_muscle_without_any_range_cannot_be_kept(workshop: Workshop) -> None:
    muscles = MUSCLES.format(rules='<lengthrange mode="none"/>')
    fault = workshop.link(BASE, muscles).fault
    assert fault.code == "compiler-setting"
    assert "lengthrange" in fault.message


def test_without_muscles_no_range_is_fine(workshop: Workshop) -> None:
    part = """<mujoco><compiler><lengthrange mode="none"/></compiler><worldbody>
      <body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
      <actuator><motor joint="j"/></actuator></mujoco>"""
    workshop.link(BASE, part).check()


def test_actuators_that_mujoco_copies_cannot_be_measured(workshop: Workshop) -> None:
    part = """<mujoco><compiler><lengthrange mode="all"/></compiler><worldbody><replicate count="2" offset="1 0 0">
      <body name="b"><joint name="j" range="0 10"/><geom size=".1"/></body></replicate></worldbody>
      <actuator><motor joint="j"/></actuator></mujoco>"""
    fault = workshop.link(BASE, part).fault
    assert fault.code == "compiler-setting"
    assert "copies of actuators" in fault.message


def test_muscles_keep_the_range_that_they_have_alone_where_something_hangs_on_them(workshop: Workshop) -> None:
    arm = """<mujoco><worldbody><body name="b"><joint name="j" range="-30 50"/><geom size=".1"/><site name="p" pos=".2 0 0"/>
        <body name="c" pos=".3 0 0"><joint name="k" axis="0 1 0" range="-30 50"/><geom size=".05" pos=".1 0 0"/>
          <site name="r" pos=".1 .02 0"/></body></body>
      <geom size=".1"/><site name="q" pos=".5 .5 0.2"/></worldbody>
      <tendon><spatial name="t"><site site="p"/><site site="q"/></spatial>
        <spatial name="u"><site site="r"/><site site="q"/></spatial></tendon>
      <actuator><muscle name="m" tendon="t"/><muscle name="n" tendon="u"/><motor name="o" joint="j"/></actuator></mujoco>"""
    load = '<mujoco><worldbody><body name="w"><geom size=".3" mass="9"/></body></worldbody></mujoco>'
    workshop.link(arm, Piece(load, place=placed("body", "c"))).check()
    workshop.link(BASE, Piece(arm, options={"joints": (hinge(name="part/"),)})).check()
    assert "lengthrange" not in workshop.link(arm, load).xml


STRONG = """
<mujoco><default><default class="m"><muscle scale="300"/></default></default><worldbody>
  <body name="b"><joint name="j" axis="0 1 0"/><geom size=".1"/><site name="p" pos=".2 0 0"/>
    <body name="c" pos=".3 0 0"><joint name="k" axis="0 1 0"/><geom size=".05" pos=".1 0 0"/><site name="r" pos=".1 .02 0"/></body></body>
  <geom size=".1"/><site name="q" pos=".5 .5 0.2"/></worldbody>
  <tendon><spatial name="t"><site site="r"/><site site="q"/></spatial></tendon>
  <actuator>
    <muscle name="m" joint="j" class="m" lengthrange="-1 1"/><motor name="o" joint="j"/><muscle name="n" tendon="t" scale="40"/>
    <general name="g" joint="k" gaintype="muscle" biastype="muscle" dyntype="muscle" lengthrange="-1 1"
      gainprm="0.8 1.1 -1 70 0.5 1.6 1.5 1.3 1.2" biasprm="0.7 1.2 -1 90 0.5 1.6 1.5 1.3 1.2"/>
    <muscle name="f" joint="k" force="3" lengthrange="-1 1"/>
  </actuator></mujoco>
"""
HEAVY = '<mujoco><worldbody><body name="w"><geom size=".3" mass="9"/></body></worldbody></mujoco>'


@pytest.mark.parametrize("activation", [0.1, 0.4, 1])
@pytest.mark.parametrize("is_below", [False, True])
def test_muscles_are_as_strong_as_alone(workshop: Workshop, is_below: bool, activation: float) -> None:
    """The force of each actuator at the same pose, alone and where another body hangs together with it."""
    arm = Piece(STRONG, options={"joints": (hinge(name="part/"),)})
    linked = workshop.link(BASE, arm) if is_below else workshop.link(STRONG, Piece(HEAVY, place=placed("body", "c")))
    linked.check()
    forces = []
    for model in (mujoco.MjModel.from_xml_string(STRONG), linked.model()):
        data = mujoco.MjData(model)
        data.act[:] = activation
        mujoco.mj_forward(model, data)
        forces.append([float(data.actuator(n).force[0]) for n in range(model.nu)])
    assert forces[1] == pytest.approx(forces[0], rel=1e-9) and any(forces[0])


def test_muscles_that_nothing_hangs_on_are_not_touched(workshop: Workshop) -> None:
    assert 'scale="40"/>' in workshop.link(BASE, STRONG).xml
    assert "force=" not in workshop.link(STRONG).xml.replace('force="3"', "")
