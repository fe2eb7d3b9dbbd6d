from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed

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
