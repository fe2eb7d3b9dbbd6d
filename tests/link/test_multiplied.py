"""The order of multiplied actuators is MuJoCo's."""

from __future__ import annotations

import mujoco
import pytest
from lxml import etree

from composer.link.multiplied import Copy, actuators_in_order


def body(name: str, inside: str = "") -> str:
    return (
        f'<body name="{name}"><joint name="{name}j"/><site name="{name}s"/><geom size=".1"/>{inside}</body>'
    )


def replicate(count: int, inside: str, sep: str = "") -> str:
    return f'<replicate count="{count}" offset="1 0 0" sep="{sep}">{inside}</replicate>'


WORLDS = {
    "none": body("a") + body("r") + body("s"),
    "one": body("a") + replicate(2, body("r")) + body("s"),
    "two": body("a") + replicate(3, body("s")) + replicate(2, body("r"), "-"),
    "nested": replicate(2, replicate(3, body("r"), "_") + body("s")) + body("a"),
    "deep": body("a", replicate(2, body("r", replicate(2, body("s"))))),
    "many": body("a") + replicate(12, body("r")) + replicate(1, body("s")),
    "in a frame": f"<frame>{replicate(2, body('r'))}</frame>{body('a', body('s'))}",
}


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS.keys())
@pytest.mark.parametrize("tendons", [False, True], ids=["", "tendons"])
def test_order(world: str, tendons: bool) -> None:
    actuators = "".join(f'<motor name="m{n}" joint="{j}"/>' for n, j in enumerate(("rj", "aj", "sj", "rj")))
    sites = ""
    if tendons:
        sites = '<fixed name="t"><joint joint="rj" coef="1"/></fixed><fixed name="u"><joint joint="sj" coef="1"/></fixed>'
        actuators += '<motor name="mt" tendon="t"/><motor name="mu" tendon="u"/><motor name="ms" site="rs"/>'
    if (
        world == WORLDS["deep"]
    ):  # elsewhere MuJoCo refuses what refers to something replicated and to something else
        actuators += '<general name="x" site="as" refsite="rs" gear="1 0 0 0 0 0"/>'
    text = f"<mujoco><worldbody>{world}</worldbody><tendon>{sites}</tendon><actuator>{actuators}</actuator></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    count = model.nactuator if hasattr(model, "nactuator") else model.nu
    names = [model.actuator(index).name for index in range(count)]
    found = []
    for holder in actuators_in_order(etree.fromstring(text)):
        element = holder.element if isinstance(holder, Copy) else holder
        found.append(
            (
                str(element.get("name")),
                tuple(number for _, number in holder.within) if isinstance(holder, Copy) else (),
            )
        )
    assert len(found) == len(names)
    for (name, numbers), compiled in zip(found, names, strict=True):
        assert compiled.startswith(name)
        digits = "".join(filter(str.isdigit, compiled.removeprefix(name)))
        assert digits.lstrip("0") == "".join(map(str, numbers)).lstrip("0")
