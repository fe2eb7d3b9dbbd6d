from __future__ import annotations

from pathlib import Path

import pytest
from link.workshop import Workshop
from mjcompose.base.sink import Sink
from mjcompose.link.linking import Linking
from mjcompose.link.measure import BODIES, NAMED, KeptSettings, Survey, measure_with
from mjcompose.mujoco.engine import RequestLimits
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_text
from mjcompose.tree.unit import Unit

TEXT = """\
<mujoco>
  <worldbody>
    <body name="b">
      <joint/>
      <geom name="g"
            {size}/>
    </body>
  </worldbody>
</mujoco>
"""


def measured(tmp_path: Path, size: str, limits: RequestLimits | None = None) -> tuple[dict[str, list[float]], Context]:
    context = Context(environment={}, folder=tmp_path)
    unit = parse_text(TEXT.format(size=size), context.sink, file="a.xml", directory=tmp_path, label="a")
    assert unit is not None
    return dict(measure_with(context, limits)(unit, ("body_mass", "nq"))), context


def test_arrays_and_sizes(tmp_path: Path) -> None:
    found, context = measured(tmp_path, 'type="box" size="0.5 0.5 0.5" density="2"')
    assert found["nq"] == [1] and found["nv"] == [1] and found["body_mass"] == [0, 2]
    assert context.sink.diagnostics == []


def test_a_refusal_is_told_at_its_element(tmp_path: Path) -> None:
    found, context = measured(tmp_path, 'type="box"')
    assert found == {}
    (fault,) = context.sink.diagnostics
    assert (
        fault.code == "mujoco-rejects"
        and fault.message == "MuJoCo rejects the geom `g`: size 0 must be positive in geom"
    )
    assert str(fault.span) == "a.xml:5:7"


def test_no_verdict_is_told_as_such(tmp_path: Path) -> None:
    # MuJoCo has far more to do than it is given time for, however busy the machine is.
    many = 'size="1"/><replicate count="19000" offset="1 0 0"><geom size="1"/></replicate><geom size="1"'
    found, context = measured(tmp_path, many, RequestLimits(seconds=0.05))
    assert found == {}
    assert [each.code for each in context.sink.diagnostics] == ["mujoco-timeout"]


MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
OF_MESH = """<mujoco><compiler meshdir="{folder}"/><asset><mesh file="a.obj"/></asset>
<worldbody><body name="b"><joint type="ball"/><geom type="mesh" mesh="a"/></body></worldbody></mujoco>"""


def weighed(text: str, folder: Path, contents: dict[str, bytes | Path]) -> tuple[list[float], Context]:
    """The masses of bodies, of a unit some of whose files are not beside it."""
    context = Context(environment={}, folder=folder)
    unit = parse_text(text, context.sink, file="a.xml", directory=folder / "model", label="a", contents=contents)
    assert unit is not None
    return list(measure_with(context)(unit, ("body_mass",)).get("body_mass", [])), context


@pytest.mark.parametrize("folder", ["", "assets/arm/", "../m/", "../../m/"])
@pytest.mark.parametrize("kept", ["in memory", "elsewhere"])
def test_files_that_are_not_beside_the_unit_are_found(tmp_path: Path, folder: str, kept: str) -> None:
    elsewhere = tmp_path / "somewhere else.txt"
    elsewhere.write_text(MESH)
    content = MESH.encode() if kept == "in memory" else elsewhere
    masses, context = weighed(OF_MESH.format(folder=folder), tmp_path, {f"{folder}a.obj": content})
    assert masses == pytest.approx([0, 1000 / 6])
    assert context.sink.diagnostics == []
    assert sorted(tmp_path.iterdir()) == [elsewhere]


def test_files_may_be_in_memory_and_beside_the_unit(tmp_path: Path) -> None:
    text = OF_MESH.format(folder="").replace("</asset>", '<mesh file="d/b.obj"/></asset>')
    (tmp_path / "model" / "d").mkdir(parents=True)
    (tmp_path / "model" / "d" / "b.obj").write_text(MESH)
    masses, context = weighed(text, tmp_path, {"a.obj": MESH.encode()})
    assert masses == pytest.approx([0, 1000 / 6])
    assert context.sink.diagnostics == []


def test_a_file_that_is_nowhere_is_told(tmp_path: Path) -> None:
    masses, context = weighed(OF_MESH.format(folder=""), tmp_path, {"a.obj": tmp_path / "gone.obj"})
    assert masses == []
    assert [each.code for each in context.sink.diagnostics] == ["mujoco-rejects"]


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
    return KeptSettings(linking, unit, ("fusestatic",)).survey((*BODIES, *NAMED), pinned=bodies), sink


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
    found = KeptSettings(Linking(unit, [], sink, measure=measure), unit, ("fitaabb",)).survey(("geom_pos", "geom_size"))
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
    assert [dict(each.attrib) for each in unit.root.iter()] == [dict(each.attrib) for each in before.root.iter()]


def test_what_mujoco_makes_elements_of_is_told(workshop: Workshop) -> None:
    unit = workshop.unit('<mujoco>\n<compiler fusestatic="true"/><worldbody><composite/></worldbody></mujoco>')
    found, sink = surveyed(unit)
    assert found is None
    (fault,) = sink.errors
    assert "`<composite>`" in fault.message and fault.span is not None and fault.span.line == 2
