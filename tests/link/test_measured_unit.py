from __future__ import annotations

from link.workshop import Workshop

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.linking import Linking
from composer.link.measure import measure_with
from composer.link.measured_unit import BODIES, NAMED, Survey, survey
from composer.tree.unit import Unit

MODEL = """
<mujoco><compiler fusestatic="true" discardvisual="true" alignfree="true"/><size nuser_body="0" nuser_geom="0"/>
<asset><material name="red"/><mesh name="ä" vertex="0 0 0 1 0 0 0 2 0 0 0 3"/></asset>
<worldbody>
  <body name="free"><freejoint/><geom size=".1" pos="1 0 0" mass="2"/></body>
  <body><joint/><geom type="mesh" mesh="ä" user="5 6" mass="1"/><geom size=".1" contype="0" conaffinity="0" mass="3"/>
    <body><geom size=".1" mass="4"/></body></body>
  <replicate count="2" offset="1 0 0"><body name="r"><joint/><geom size=".1" mass="5"/></body></replicate>
</worldbody></mujoco>"""


def surveyed(unit: Unit, pinned: tuple[str, ...] = ()) -> tuple[Survey | None, Sink]:
    sink = Sink()
    measure = measure_with(Context(sink=sink, environment={}, folder=unit.directory))
    bodies = [body for body in unit.root.iter("body") if body.get("name", "") in pinned]
    linking = Linking(unit, [], sink, measure=measure)
    return survey(linking, unit, "`fusestatic`", (*BODIES, *NAMED), pinned=bodies), sink


def test_elements_are_found_again(workshop: Workshop) -> None:
    unit = workshop.unit(MODEL)
    found, _ = surveyed(unit)
    assert found is not None
    free, moving, still, copied = unit.root.iter("body")
    assert [found.values(body, "body_mass", 1) for body in (free, moving, copied)] == [[2], [8], [5]]
    assert found.is_gone(still)
    assert [len(found.rows[body]) for body in (free, moving, still, copied)] == [1, 1, 0, 2]
    assert [found.is_gone(geom) for geom in unit.root.iter("geom")] == [False, False, True, False, False]
    assert found.names("mesh") == {"ä"} and found.names("material") == set()


def test_free_bodies_are_not_aligned(workshop: Workshop) -> None:
    unit = workshop.unit(MODEL)
    found, _ = surveyed(unit)
    assert found is not None
    assert found.values(next(unit.root.iter("body")), "body_ipos", 3) == [1, 0, 0]


def test_values_that_copies_do_not_share_are_none(workshop: Workshop) -> None:
    unit = workshop.unit("""<mujoco><worldbody><body><joint/><replicate count="2" offset="1 0 0">
      <geom size=".1"/></replicate></body></worldbody></mujoco>""")
    sink = Sink()
    measure = measure_with(Context(sink=sink, environment={}, folder=unit.directory))
    found = survey(Linking(unit, [], sink, measure=measure), unit, "`fitaabb`", ("geom_pos", "geom_size"))
    geom = next(unit.root.iter("geom"))
    assert found is not None
    assert found.values(geom, "geom_pos", 3) is None
    assert found.values(geom, "geom_size", 3) == [0.1, 0, 0]


def test_a_pinned_body_is_not_fused(workshop: Workshop) -> None:
    unit = workshop.unit(MODEL)
    found, _ = surveyed(unit, pinned=("",))
    assert found is not None
    assert not any(found.is_gone(body) for body in unit.root.iter("body"))


def test_the_unit_is_left_as_it_is(workshop: Workshop) -> None:
    unit = workshop.unit(MODEL)
    before = workshop.unit(MODEL)
    surveyed(unit, pinned=("",))
    assert [dict(each.attrib) for each in unit.root.iter()] == [
        dict(each.attrib) for each in before.root.iter()
    ]


def test_what_mujoco_makes_elements_of_is_told(workshop: Workshop) -> None:
    unit = workshop.unit(
        '<mujoco>\n<compiler fusestatic="true"/><worldbody><composite/></worldbody></mujoco>'
    )
    found, sink = surveyed(unit)
    assert found is None
    (fault,) = sink.errors
    assert "`<composite>`" in fault.message and fault.span is not None and fault.span.line == 2
