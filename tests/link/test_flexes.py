from __future__ import annotations

from typing import Any

import pytest
from link.workshop import BASE, Piece, Workshop, placed

from composer.diagnostics.span import Span
from composer.link.flexes import taken_back
from composer.link.part import Joint, Sense

FLEX = '<flexcomp name="f" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" radius=".01"/>'
ARM = '<body name="arm"><joint name="j"/><geom size=".1"/></body>'


def model(joint: str, inside: str) -> str:
    return f"<mujoco><default><joint {joint}/></default><worldbody>{inside}</worldbody></mujoco>"


def test_what_a_flex_in_the_world_takes_reaches_nothing_else(workshop: Workshop) -> None:
    base = model('armature=".5"', FLEX + ARM)
    found = workshop.link(base, Piece(model('stiffness="2"', ARM), "p/"), Piece(model("", ARM), "q/")).model()
    armature = found.dof_armature
    assert armature[found.jnt_dofadr[0]] == 0.5
    assert armature[found.joint("j").dofadr[0]] == 0.5
    assert [armature[found.joint(name).dofadr[0]] for name in ("p/j", "q/j")] == [0, 0]
    assert found.joint("p/j").stiffness[0] == 2


def test_without_joint_defaults_nothing_is_written(workshop: Workshop) -> None:
    linked = workshop.link(model("", FLEX), Piece(model("", FLEX), "p/"))
    assert "<joint " not in linked.xml


def test_two_flexes_in_the_world_that_take_different_defaults_are_refused(workshop: Workshop) -> None:
    linked = workshop.link(model('armature=".5"', FLEX), Piece(model('armature=".6"', FLEX), "p/"))
    assert linked.fault.code == "not-supported"
    assert 'armature="0.6"' in linked.fault.message or 'armature=".6"' in linked.fault.message


def test_user_data_has_no_neutral_value(workshop: Workshop) -> None:
    linked = workshop.link(model('user="1 2"', FLEX), Piece(model("", ARM), "p/"))
    assert linked.fault.code == "not-supported"


def test_a_flex_at_the_root_takes_the_defaults_of_its_mount(workshop: Workshop) -> None:
    base = """<mujoco><default><default class="x"><joint armature=".5"/></default></default><worldbody>
      <body name="plain"/><body name="classed" childclass="x"/></worldbody></mujoco>"""
    part = Piece(model("", FLEX), "p/", placed("body", "plain"))
    assert workshop.link(base, part).model().nflex == 1
    part = Piece(model("", FLEX), "p/", placed("body", "classed"))
    assert workshop.link(base, part).fault.code == "not-supported"


def test_a_flex_at_the_root_does_not_take_what_the_recipe_sets(workshop: Workshop) -> None:
    base = '<mujoco><worldbody><body name="plain"/></worldbody></mujoco>'
    on_body = Piece(model("", FLEX), "p/", placed("body", "plain"))
    fault = workshop.link(base, on_body, isolated_tags=frozenset({"joint"})).fault
    assert "the recipe sets for `main`" in fault.message
    workshop.link(base, on_body, isolated_tags=frozenset({"geom"})).check()
    workshop.link(base, Piece(model("", FLEX), "p/"), isolated_tags=frozenset({"joint"})).check()
    inside = Piece(model("", f'<body name="own">{FLEX}</body>'), "p/", placed("body", "plain"))
    workshop.link(base, inside, isolated_tags=frozenset({"joint"})).check()


TURNED = '<flexcomp name="f" type="grid" count="3 2 1" spacing=".1 .1 .1" dim="2" radius=".01" quat="{}"/>'


def turned(quat: str, inside: str = "{}") -> str:
    return f"<mujoco><worldbody>{inside.format(TURNED.format(quat))}</worldbody></mujoco>"


def test_a_quat_that_stretches_alone_is_refused_with_one_that_does_not(workshop: Workshop) -> None:
    fault = workshop.link(BASE, turned("1 1 0 0")).fault
    assert "a `quat` of length 1.41421" in fault.message
    assert fault.span is not None and fault.help is not None
    mended = fault.help.split('"')[1]
    workshop.link(BASE, turned(mended)).check()


def test_one_that_does_not_turn_stretches_nothing(workshop: Workshop) -> None:
    linked = workshop.link(BASE, turned("2 0 0 0"))
    assert linked.codes == []
    linked.check()


def test_one_that_hardly_stretches_is_reported(workshop: Workshop) -> None:
    linked = workshop.link(BASE, turned("0.7071 0.7071 0 0"))
    assert linked.codes == ["not-supported"] and not linked.sink.has_errors


@pytest.mark.parametrize(
    "inside",
    [
        '<body name="b">{}</body>',
        pytest.param(
            "<frame>{}</frame>", marks=pytest.mark.mujoco4("it leaves flexes behind the frame around them")
        ),
        '<body name="b"><frame pos="1 0 0">{}</frame></body>',
    ],
)
def test_in_a_body_or_a_frame_it_is_what_it_is_alone(workshop: Workshop, inside: str) -> None:
    linked = workshop.link(turned("1 1 0 0"), Piece(turned("1 1 0 0", inside), "p/", placed(pos=(1, 2, 3))))
    assert linked.codes == []
    linked.check()


@pytest.mark.parametrize("taken", ['type="slide"', 'axis="1 0 0"', 'pos="1 0 0"'])
def test_what_a_flex_decides_itself_is_no_default_of_it(workshop: Workshop, taken: str) -> None:
    workshop.link(model(taken, FLEX), Piece(model("", FLEX.replace('"f"', '"g"')), "p/")).check()


@pytest.mark.parametrize("damped", ['damping="3"', 'springdamper=".1 1"'])
def test_damping_is_no_default_of_a_flex(workshop: Workshop, damped: str) -> None:
    """MuJoCo refuses it to vertices that move; a rigid flex has none of these."""
    rigid = FLEX.replace("/>", ' rigid="true"/>')
    linked = workshop.link(model(damped, rigid + ARM), Piece(model("", rigid), "p/"))
    linked.check()
    assert "<joint " not in linked.xml.split("<worldbody>")[0].split("<default class")[0]


@pytest.mark.parametrize(
    "options",
    [
        {"joints": (Joint("freejoint", {}),)},
        {"joints": (Joint("joint", {"type": "hinge"}),)},
        {"mocap": True},
        {"sense": Sense("wrist", (("force", "wrist"),), "", Span("r.yaml", 1, 1))},
    ],
)
def test_a_flex_on_a_body_of_an_attachment_is_not_in_the_world(
    workshop: Workshop, options: dict[str, Any]
) -> None:
    """It takes the joint defaults of that body, and `main` has none for it."""
    pinned = FLEX.replace("/>", '><pin id="0"/></flexcomp>')
    linked = workshop.link(BASE, Piece(model('armature=".5"', pinned), "p/", options=options))
    assert "<joint " not in linked.xml.split("<worldbody>")[0].split('class="p/"')[0]


@pytest.mark.parametrize(("length", "severity"), [(1.0005, "warning"), (1.002, "error"), (1.0 + 1e-12, None)])
def test_a_turn_that_stretches_is_an_error_from_a_thousandth_on(
    workshop: Workshop, length: float, severity: str | None
) -> None:
    flex = FLEX.replace("/>", f' quat="0 {length!r} 0 0"/>')
    found = workshop.link(BASE, Piece(model("", flex), "p/")).linking.sink.diagnostics
    told = [str(each.severity.value) for each in found if "turned by a `quat`" in each.message]
    assert told == ([severity] if severity else [])


def test_settings_of_several_numbers_are_taken_back_number_by_number(workshop: Workshop) -> None:
    base = model('solreflimit=".01"', FLEX + ARM)
    found = workshop.link(base, Piece(model("", ARM), "p/")).model()
    alone = workshop.link(model("", ARM), Piece(model("", ARM), "p/")).model()
    assert found.joint("p/j").solref.tolist() == alone.joint("p/j").solref.tolist()
    assert taken_back({"solreflimit": ".01"}) == {"solreflimit": "0.02"}
