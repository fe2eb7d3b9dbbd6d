"""Settings that only MuJoCo can work out on a model alone, where that model refers to what hangs on it."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import pytest

from composer import mjcf
from composer.mjcf import RootElement


@pytest.fixture
def cell() -> RootElement:
    """Its mass is scaled, which is measured; what hangs on it is referred to from every section."""
    cell, ball = RootElement("cell"), RootElement("ball")
    cell.compiler.settotalmass = 3
    table = cell.worldbody.add("body", name="table")
    table.add("joint", name="slide", type="slide")
    table.add("geom", name="top", size=[0.5])
    ball.worldbody.add("geom", name="shell", size=[0.1])
    core = ball.worldbody.add("body", name="core")
    core.add("joint", name="turn")
    core.add("geom", name="hull", size=[0.1])
    core.add("site", name="tip")
    ball.asset.add("material", name="steel")
    frame = cell.attach(ball)
    frame.add("joint", name="lift", type="slide")

    cell.equality.add("weld", body1=frame, body2=table)
    both = cell.tendon.add("fixed", name="both")
    both.add("joint", joint=core.find("joint"), coef=1)
    both.add("joint", joint="slide", coef=1)
    cell.actuator.add("position", name="turn", joint="ball/turn", kp=3)
    cell.actuator.add("motor", name="slide", joint="slide")
    cell.actuator.add("adhesion", name="stick", body="ball/core", ctrlrange=[0, 1])
    cell.actuator.add("position", name="both", tendon=both, kp=1)
    cell.sensor.add("tendonpos", tendon=both)
    cell.sensor.add("touch", site="ball/tip")
    cell.contact.add("exclude", body1=table, body2="ball/core")
    cell.contact.add("pair", geom1="top", geom2="ball/hull")
    cell.custom.add("tuple", name="all").add("element", objtype="body", objname="ball/core")
    table.geom[0].material = "ball/steel"
    return cell


def test_the_model_is_measured_without_what_hangs_on_it(
    cell: RootElement, compiled: Callable[[RootElement], mujoco.MjModel]
) -> None:
    cell.compiler.settotalmass = None
    plain = compiled(cell)
    cell.compiler.settotalmass = 3
    before = str(cell)
    model = compiled(cell)
    assert model.body("table").mass == 3 and model.body("ball/core").mass == plain.body("ball/core").mass
    assert [model.nu, model.ntendon, model.nsensor, model.neq, model.npair, model.nexclude, model.ntuple] == [
        4,
        1,
        2,
        1,
        1,
        1,
        1,
    ]
    assert model.actuator("turn").trnid[0] == model.joint("ball/turn").id
    assert str(cell) == before


def test_a_weld_to_the_frame_of_what_hangs_on_it() -> None:
    cell, ball = RootElement("cell"), RootElement("ball")
    cell.compiler.boundmass = 2
    cell.worldbody.add("body", name="table").add("geom", size=[0.01])
    ball.worldbody.add("geom", size=[0.1])
    frame = cell.attach(ball)
    frame.add("freejoint")
    cell.equality.add("weld", body1=frame)
    model = cell.compile_model().model
    assert model.eq_obj1id[0] == model.body("ball/").id and model.body("table").mass == 2


def test_mass_that_hangs_on_it_is_told_as_missing() -> None:
    """A geom with a mesh of the attached model cannot be weighed without that."""
    cell, tool = RootElement("cell"), RootElement("tool")
    cell.compiler.boundmass = 2
    tool.asset.add("mesh", name="m", vertex=[0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1])
    cell.attach(tool)
    cell.worldbody.add("body").add("geom", type="mesh", mesh="tool/m")
    with pytest.raises(mjcf.MjcfError, match="m"):
        cell.compile_model()
