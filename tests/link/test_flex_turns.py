from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed

FLEX = '<flexcomp name="f" type="grid" count="3 2 1" spacing=".1 .1 .1" dim="2" radius=".01" quat="{}"/>'


def model(quat: str, inside: str = "{}") -> str:
    return f"<mujoco><worldbody>{inside.format(FLEX.format(quat))}</worldbody></mujoco>"


def test_a_quat_that_stretches_alone_is_refused_with_one_that_does_not(workshop: Workshop) -> None:
    fault = workshop.link(BASE, model("1 1 0 0")).fault
    assert "a `quat` of length 1.41421" in fault.message
    assert fault.span is not None and fault.help is not None
    mended = fault.help.split('"')[1]
    workshop.link(BASE, model(mended)).check()


def test_one_that_hardly_stretches_is_told(workshop: Workshop) -> None:
    linked = workshop.link(BASE, model("0.7071 0.7071 0 0"))
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
    linked = workshop.link(model("1 1 0 0"), Piece(model("1 1 0 0", inside), "p/", placed(pos=(1, 2, 3))))
    assert linked.codes == []
    linked.check()
