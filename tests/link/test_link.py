"""A pass says what it needs and what it leaves; an order that breaks a need is an error that names both passes."""

from __future__ import annotations

from itertools import pairwise

import pytest
from link.workshop import BASE, Piece, Workshop, placed
from mjcompose.base.sink import Sink
from mjcompose.link.link import (
    AT_THE_START,
    FINISHING,
    PASSES,
    Fact,
    Pass,
    PassOrderError,
    check_order,
    finish,
    link,
    row_of,
)
from mjcompose.link.linking import Linking, Part
from mjcompose.link.names import names
from mjcompose.tree.xml_text import write

ALL = (*PASSES, *FINISHING)
# The neighbors whose order changes a model or a fault: measured by swapping them, on all models of the tests.
NOT_TO_BE_SWAPPED = {
    ("note_flexes", "flex_turns"),
    ("replicates", "layouts"),
    ("body_reduction", "choose_classes"),
    ("lengthranges", "angles"),
    ("submodel_options", "agreement"),
    ("files", "submodels"),
    ("submodels", "names"),
    ("names", "defaults"),
    ("defaults", "bodies"),
    ("bodies", "check_replicates"),
}


def swapped(first: Pass, second: Pass) -> list[Pass]:
    return [second if row is first else first if row is second else row for row in ALL]


@pytest.mark.parametrize("pair", sorted(NOT_TO_BE_SWAPPED))
def test_neighbours_whose_order_matters_cannot_be_swapped(pair: tuple[str, str]) -> None:
    first, second = next(each for each in pairwise(PASSES) if (each[0].name, each[1].name) == pair)
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(first, second))
    assert f"`{first.name}`" in str(raised.value) and f"`{second.name}`" in str(raised.value)


def test_the_sentence_of_an_order_that_breaks_a_need() -> None:
    by_name = {row.name: row for row in ALL}
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(by_name["names"], by_name["defaults"]))
    assert str(raised.value) == (
        "the pass `defaults` must come after `names`: it needs that every name is the one that it has in the model"
    )
    with pytest.raises(PassOrderError) as raised:
        check_order(swapped(by_name["lengthranges"], by_name["angles"]))
    assert str(raised.value) == (
        "the pass `lengthranges` must come before `angles`: it needs that MuJoCo can compile each unit alone, "
        "with its own settings, files and angles"
    )


def test_a_need_that_no_pass_meets() -> None:
    with pytest.raises(PassOrderError, match="the pass `names` cannot run: it needs that "):
        check_order([Pass(names, "words", needs=frozenset({Fact.JOINED}))])


def test_a_pass_without_words_is_refused() -> None:
    with pytest.raises(ValueError, match="the pass `names` has no words for `mjcompose explain`"):
        Pass(names, " ")
    with pytest.raises(TypeError):
        Pass(names)  # type: ignore[call-arg]


def test_every_fact_is_needed_and_left_by_somebody() -> None:
    assert frozenset().union(*(row.needs for row in ALL)) == set(Fact)
    assert AT_THE_START.union(*(row.leaves for row in ALL)) == set(Fact)


def test_rows_are_found_by_their_function() -> None:
    assert all(row_of(row.run) is row for row in ALL)
    assert row_of(names) in PASSES
    assert row_of("names") is None


# Two units whose every rule differs.
ONE = """
<mujoco model="one">
  <compiler angle="radian" eulerseq="ZYX" autolimits="false" inertiafromgeom="true" fitaabb="true"/>
  <size nuser_geom="1"/>
  <default><geom friction=".5" density="300"/><joint armature=".1"/><motor gear="2"/></default>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 2 0 0 0 3 1 1 1"/><material name="skin"/></asset>
  <worldbody>
    <geom name="ground" size=".5" material="skin"/>
    <body name="a" euler=".1 .2 .3" pos="0 0 1">
      <joint name="j" range="-1 2" limited="true"/><geom name="g" type="box" mesh="m" user="4"/><site name="top" euler="1 2 3"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    </body>
  </worldbody>
  <actuator><motor name="m" joint="j"/></actuator>
  <keyframe><key name="home" qpos="1" ctrl="2"/></keyframe>
</mujoco>
"""
TWO = """
<mujoco model="two">
  <compiler angle="degree" inertiagrouprange="0 2" boundmass=".1"><lengthrange mode="muscle" inttotal="3"/></compiler>
  <default><geom friction=".9" group="1"/><joint damping=".2" range="-40 50"/>
    <default class="s"><joint type="slide"/></default></default>
  <worldbody>
    <body name="a" euler="10 20 30">
      <joint name="j" ref="5"/><joint name="k" class="s"/><geom name="g" size=".1" user="1 2 3"/><geom group="4" size=".3"/>
      <site name="top" pos="0 0 .2"/>
    </body>
    <body name="b" euler="0 0 90"><freejoint/><geom name="h" size=".1"/></body>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
  <actuator><muscle name="m" joint="j"/><motor name="n" joint="k"/></actuator>
  <keyframe><key name="home" qpos=".3 .4 1 2 3 0 1 0 0" act=".5"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize("texts", [(ONE, TWO), (TWO, ONE), (TWO, TWO), (ONE, ONE)])
def test_units_that_differ_in_everything_still_mean_what_they_meant(workshop: Workshop, texts: tuple[str, str]) -> None:
    base, part = texts
    workshop.link(base, Piece(part, place=placed(pos=(1.0, 2.0, 3.0)))).check()
    if part is ONE:
        workshop.link(base, Piece(part, place=placed("site", "top"))).check()


def test_many_parts_at_once(workshop: Workshop) -> None:
    pieces = [
        Piece(ONE, "a/", placed("site", "top")),
        Piece(TWO, "b/", placed(pos=(5.0, 0.0, 0.0), quat=(0.5, 0.5, 0.5, 0.5))),
        Piece(ONE, "c/", placed("body", "b/a")),
        Piece(ONE, "d/", placed("site", "c/top", quat=(0.0, 1.0, 0.0, 0.0))),
        Piece(TWO, "e/", options={"keyframes": "prefix"}),
    ]
    model = workshop.link(ONE, *pieces).check()
    assert model.nkey == 2
    assert model.nq == 4 * 1 + 2 * 9


def test_a_composition_is_a_part_like_any_other(workshop: Workshop) -> None:
    inner = workshop.link(ONE, Piece(TWO, "in/"))
    again = workshop.link(TWO, Piece(inner.xml, "out/"))
    again.check()
    base = workshop.link(inner.xml, Piece(ONE, "new/", placed("site", "in/top")))
    base.check()


def test_linking_is_the_same_twice(workshop: Workshop) -> None:
    pieces = [Piece(ONE, "a/", placed("site", "top")), Piece(TWO, "b/")]
    assert workshop.link(ONE, *pieces).xml == workshop.link(ONE, *pieces).xml


def test_a_copy_of_a_unit_links_to_the_same_text(workshop: Workshop) -> None:
    found = []
    base = workshop.unit(BASE)
    part = workshop.unit(ONE.replace(' fitaabb="true"', ""))
    for _ in range(2):
        linking = Linking(base.copied(), [Part(part.copied(), "p/")], Sink())
        assert link(linking)
        finish(linking)
        found.append(write(linking.base.root))
    assert found[0] == found[1]
    assert b"p/" not in write(part.root)


def test_the_xml_is_plain(workshop: Workshop) -> None:
    """One element a line, two spaces a level, nothing that says how it was made."""
    linked = workshop.link(ONE, Piece(TWO, "b/"))
    lines = linked.xml.splitlines()
    assert lines[0] == '<mujoco model="one">'
    assert all(line.count("<") <= 2 for line in lines)
    assert all((len(line) - len(line.lstrip())) % 2 == 0 for line in lines)
    assert linked.linking.base.root[0].tag == "compiler"


def test_faults_of_several_passes_are_told_at_once(workshop: Workshop) -> None:
    free = '<joint type="free" damping="1"/>'
    base = BASE.replace("</worldbody>", f'<body name="f">{free}</body></worldbody>')
    base = base.replace("<worldbody>", '<option timestep="2"/><worldbody>', 1)
    part = f"""<mujoco><compiler alignfree="true"/><option timestep="1"/>
      <worldbody><body name="b">{free}</body><site name="mark"/></worldbody>
      <actuator><motor joint="none"/></actuator></mujoco>"""
    linked = workshop.link(base, Piece(part, "", placed("site", "mark")), Piece(BASE, "c/", placed("site", "no")))
    assert set(linked.codes) >= {"compiler-setting", "option-conflict", "unknown-name"}
    assert {"name-clash", "attach-place"} <= set(linked.codes)


def test_every_pass_says_what_it_does() -> None:
    for each in PASSES:
        assert each.__doc__
        assert each.__module__.startswith("mjcompose.link.")
