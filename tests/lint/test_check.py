"""The check `lint`, and its rule about inertia: what cannot be is found, what may be is not."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from language.validating import validate
from mjcompose.base.sink import Sink
from mjcompose.language.checks.lint import InertiaImplausible
from mjcompose.lint.check import inertia_implausible
from mjcompose.lint.rule import rules
from mjcompose.mujoco.solids import volume
from mjcompose.text.load import load
from mjcompose.verify.checks.check import Scope

BOX = """<mujoco><worldbody>
  <body name="link"><freejoint name="f"/><inertial pos="{pos}" mass="{mass}" diaginertia="{inertia}"/>
    <geom type="box" size=".1 .1 .1" group="3"/>{more}</body>
  <body name="bare"><joint name="j"/><inertial pos="9 9 9" mass="1" diaginertia="50 50 50"/></body>
</worldbody></mujoco>"""


def _lint(settings: str) -> str:
    return f"lint: {{select: {{inertia-implausible: {{{settings}}}}}}}"


def box(pos: str = "0 0 0", mass: float = 8, inertia: str = ".05 .05 .05", more: str = "") -> str:
    return BOX.format(pos=pos, mass=mass, inertia=inertia, more=more)


@pytest.mark.parametrize(
    ("model", "asked"),
    [
        (box(), ""),
        (box(), "density: [999, 1001]"),
        (box(pos="0.1 0.1 0"), ""),  # at its edge
        (box(pos="0.5 0 0"), "outside: 2"),
        (box(inertia=".9 .9 .9"), "gyration: 2"),
        # What is seen is not twice the body.
        (box(more='<geom type="box" size=".1 .1 .1" group="2"/>'), "density: [999, 1001]"),
        (box(pos="0.15 0 0", more='<body pos=".2 0 0"><geom size=".1" mass="0"/></body>'), ""),
    ],
)
def test_holds(ask, model: str, asked: str) -> None:
    assert ask(model, _lint(asked)) == []


@pytest.mark.parametrize(
    ("model", "asked", "told"),
    [
        (box(pos="0.2 0 0"), "", "its center of mass is 0.1 m outside the box around its geoms"),
        (box(inertia=".9 .9 .9"), "", "its radius of gyration is 0.3354 m, and no point of its geoms is farther"),
        (box(mass=800), "density: [100, 9000]", "1e+05 kg/m³ of the volume of its geoms, above 9000"),
        (box(mass=0.08, inertia="1e-4 1e-4 1e-4"), "density: [100, 9000]", "10 kg/m³ of the volume"),
    ],
)
def test_does_not_hold(ask, model: str, asked: str, told: str) -> None:
    (finding,) = ask(model, _lint(asked))
    assert finding.code == "check-failed" and finding.message.startswith("body `link`: ")
    assert told in finding.message


def test_moments_that_no_body_has() -> None:
    """MuJoCo refuses them where it reads them, but not where a program writes them into a compiled model."""
    model = mujoco.MjModel.from_xml_string(box())
    model.body_inertia[1] = [0.01, 0.01, 0.05]
    (finding,) = inertia_implausible(Scope(mujoco, model), InertiaImplausible(), ignored=())
    assert "add up to less than the largest" in finding.message


def test_a_body_that_is_not_there(ask) -> None:
    (finding,) = ask(box(), "lint: {select: [inertia-implausible], except: {inertia-implausible: [lnk]}}")
    assert (finding.code, finding.help) == ("unknown-name", "did you mean `link`?")


def test_elements_and_rules_that_are_excepted(ask) -> None:
    wrong = box(pos="0.5 0 0")
    assert [each.message.rpartition(" ")[2] for each in ask(wrong, "lint: {}")] == [
        "(inertia-implausible)",
        "(joint-unactuated)",
    ]
    assert ask(wrong, "lint: {except: [inertia-implausible, joint-unactuated]}") == []
    assert ask(wrong, "lint: {select: {inertia-implausible: {body: bare}}}") == []
    assert ask(wrong, 'lint: {except: {inertia-implausible: link, joint-unactuated: "**"}}') == []
    (finding,) = ask(wrong, "lint: {select: [key-out-of-range, joint-unactuated]}")
    assert finding.at == ("select", "joint-unactuated")


CORNERS = "0 0 0 1 0 0 0 1 0 0 0 1"
FACES = "0 2 1 0 1 3 0 3 2 1 2 3"


@pytest.mark.parametrize(
    ("geom", "least", "most"),
    [
        ('size=".1"', 4 / 3 * np.pi * 1e-3, None),
        ('type="capsule" size=".1 .2"', np.pi * (0.01 * 0.4 + 4 / 3 * 1e-3), None),
        ('type="cylinder" size=".1 .2"', np.pi * 0.01 * 0.4, None),
        ('type="ellipsoid" size=".1 .2 .3"', 4 / 3 * np.pi * 6e-3, None),
        ('type="box" size=".1 .2 .3"', 8 * 6e-3, None),
        ('type="mesh" mesh="closed"', 1 / 6, None),
    ],
)
def test_volumes(geom: str, least: float, most: float | None) -> None:
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="closed" vertex="{CORNERS}" face="{FACES}"/></asset>'
        f"<worldbody><geom {geom}/></worldbody></mujoco>"
    )
    found = volume(mujoco, model, 0)
    assert found.least == pytest.approx(least) and found.most == pytest.approx(most or least)


def test_of_a_mesh_with_a_hole_only_the_box_is_known() -> None:
    faces = FACES.removesuffix(" 1 2 3")
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="open" inertia="shell" vertex="{CORNERS}" face="{faces}"/></asset>'
        '<worldbody><geom type="mesh" mesh="open"/></worldbody></mujoco>'
    )
    found = volume(mujoco, model, 0)
    assert found.least == 0 and found.most > 1 / 6


TWO = """<mujoco><asset><material name="m"/></asset><worldbody>
  <body name="link"><joint name="{}"/><geom size=".1"/></body></worldbody></mujoco>"""


def test_rules_of_the_linter(ask) -> None:
    (finding,) = ask(TWO.format("a b"), "lint: {select: [names, unused-material], except: [awkward-name]}")
    assert finding.message == "no element uses the material `m` (unused-material)"
    (finding,) = ask(TWO.format("a b"), "lint: {select: [awkward-name]}")
    assert "`a b` of this joint" in finding.message and finding.at == ("select", "awkward-name")
    assert not ask(TWO.format("a"), "lint: {select: [awkward-name]}")
    assert {"(unused-material)", "(joint-unactuated)"} <= {
        each.message.split()[-1] for each in ask(TWO.format("a"), "lint: {}")
    }


def test_a_nested_recipe_answers_for_its_own_elements(ask) -> None:
    model = TWO.format("left/a b").replace('name="link"', 'name="left/link"').replace('name="m"', 'name="m"')
    assert ask(model, "lint: {select: [awkward-name]}", prefix="left/")
    assert not ask(model, "lint: {select: [awkward-name]}", prefix="right/")
    assert not ask(model, "lint: {select: [unused-material]}", prefix="left/")


def test_allow_takes_no_rule_of_the_linter() -> None:
    """It is about warnings of builds, also in a process that knows the rules."""
    assert "unused-mesh" in rules()
    sink = Sink()
    node = load("recipe: 1\nallow: [unused-mesh]\n", "recipe.yaml", sink)
    assert node is not None
    assert validate(node, sink) is None
    assert [each.code for each in sink.diagnostics] == ["wrong-keyword"]
