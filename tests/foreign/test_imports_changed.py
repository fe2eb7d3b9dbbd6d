from __future__ import annotations

import re

import mujoco
import pytest
from foreign.by_name import differences
from foreign.imports_changed import EXAMPLES, LEFT_OUT, MADE, NOW

FRAME = '<mujoco><worldbody><body name="chest">{}</body></worldbody></mujoco>'
ARM = '<body name="left/arm" pos="{}"><joint name="left/turn"/><geom {} size="0.1"/></body>'


def test_the_page_lists_the_examples_in_this_order() -> None:
    page = (EXAMPLES.parent / "how-to" / "from_dm_control.md").read_text(encoding="utf-8")
    assert re.findall(r"\(\.\./examples/(\w+\.py)\)", page)[: len(MADE)] == list(MADE)
    for file in MADE:
        assert NOW in (EXAMPLES / file).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("geom", "said"), [("", []), ('friction="2"', ["friction"]), ('mass="9"', ["mass", "inertia"])]
)
def test_a_body_around_what_is_attached_is_no_difference(geom: str, said: list[str]) -> None:
    around = '<body name="left/" pos="1 0 0">{}</body>'.format(ARM.format("0 0 0", 'name="left//unnamed_geom_0"'))
    models = [mujoco.MjModel.from_xml_string(FRAME.format(text)) for text in (around, ARM.format("1 0 0", geom))]
    lines = list(differences(*models, LEFT_OUT))
    assert bool(lines) == bool(said)
    assert all(any(word in line for line in lines) for word in said)
