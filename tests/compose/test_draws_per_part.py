"""Draws for a body or a part, and draws that go together."""

from __future__ import annotations

from pathlib import Path

import mujoco
from hypothesis import HealthCheck, given, settings, strategies as st
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context

BRICK = """<mujoco><worldbody><body name="brick"><freejoint/><geom size=".1"/><geom size=".1" pos="0 0 .1"/>
<body name="knob"><joint name="turn" damping="1" armature="1"/><geom size=".02"/></body></body></worldbody></mujoco>"""
HEAD = """recipe: 1
add: [{to: world, geom: {name: floor, type: plane, size: [1, 1, 1]}}]
attach: {brick: {model: ./brick.xml, replicate: [{count: 3, offset: [1, 0, 0]}]}}
randomize:
  seed: 7
  samples: 3
  fields:
"""


def sample(folder: Path, fields: str, number: int = 1) -> Built:
    (folder / "brick.xml").write_text(BRICK)
    (folder / "r.yaml").write_text(HEAD + fields)
    context = Context(environment={}, folder=folder)
    built = build(ModelRequest(folder / "r.yaml", name=f"s{number}", sample=number), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    return built


def model_of(built: Built) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def test_one_friction_a_part(tmp_path: Path) -> None:
    field = '    f: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.4, 1.2], per: part}\n'
    built = sample(tmp_path, field)
    model = model_of(built)
    by_part: dict[str, set[float]] = {}
    for geom in range(model.ngeom):
        body = model.body(model.geom_bodyid[geom]).name
        by_part.setdefault(body.partition("/")[0], set()).add(float(model.geom_friction[geom, 0]))
    assert [len(values) for values in by_part.values()] == [1, 1, 1, 1]
    assert len(set.union(*by_part.values())) == 4
    assert [each.element for each in built.composed.drawn] == ["brick0", "brick1", "brick2", "base"]


def test_one_friction_a_body(tmp_path: Path) -> None:
    field = '    f: {select: {geom: "**"}, attr: "friction[0]", uniform: [0.4, 1.2], per: body}\n'
    built = sample(tmp_path, field)
    model = model_of(built)
    found = {(int(model.geom_bodyid[geom]), float(model.geom_friction[geom, 0])) for geom in range(model.ngeom)}
    assert len(found) == model.nbody == 7
    assert "brick1/knob" in [each.element for each in built.composed.drawn]


def test_fields_of_a_group_are_drawn_together(tmp_path: Path) -> None:
    fields = (
        '    d: {select: {joint: "**/turn"}, attr: "damping[0]", uniform: [0, 1], group: wear}\n'
        '    a: {select: {joint: "**/turn"}, attr: armature, uniform: [10, 20], group: wear}\n'
        '    s: {select: {joint: "**/turn"}, attr: frictionloss, uniform: [0, 1]}\n'
    )
    model = model_of(sample(tmp_path, fields))
    dofs = [model.joint(f"brick{index}/turn").dofadr[0] for index in range(3)]
    for dof in dofs:
        assert abs(model.dof_armature[dof] - (10 + 10 * model.dof_damping[dof])) < 1e-9
        assert model.dof_frictionloss[dof] != model.dof_damping[dof]
    assert len({float(model.dof_damping[dof]) for dof in dofs}) == 3


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    low=st.floats(0.1, 5),
    width=st.floats(0.1, 5),
    number=st.integers(1, 3),
    per=st.sampled_from(["element", "body", "part", "sample"]),
    index=st.integers(0, 2),
)
def test_a_group_is_at_one_point_of_all_its_distributions(
    tmp_path: Path, low: float, width: float, number: int, per: str, index: int
) -> None:
    """Whichever number of which attribute each field is about, and whatever its distribution."""
    bounds = f"uniform: [{low}, {low + width}]"
    fields = (
        f'    d: {{select: {{joint: "**/turn"}}, attr: armature, {bounds}, group: g, per: {per}}}\n'
        f'    f: {{select: {{joint: "**/turn"}}, attr: "damping[{index}]", scale: {{uniform: [0, 1]}}, group: g, per: {per}}}\n'
    )
    drawn = {(each.field, each.element): each.value for each in sample(tmp_path, fields, number).composed.drawn}
    elements = {element for _, element in drawn}
    assert len({drawn["d", element] for element in elements}) == (1 if per == "sample" else 3)
    for element in elements:
        assert abs(drawn["d", element] - (low + width * drawn["f", element])) < 1e-9


def test_a_sample_may_have_another_model(tmp_path: Path) -> None:
    (tmp_path / "ball.xml").write_text(
        '<mujoco><worldbody><body name="ball"><geom size=".3"/></body></worldbody></mujoco>'
    )
    (tmp_path / "brick.xml").write_text(BRICK)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nparams: {object: {default: brick, choices: [brick, ball]}}\n"
        'attach: {thing: {model: "./${object}.xml"}}\n'
        "randomize: {seed: 7, samples: 8, fields: {which: {param: object, choice: [brick, ball]}}}\n"
    )
    found = set()
    for number in range(1, 7):
        context = Context(environment={}, folder=tmp_path)
        built = build(ModelRequest(tmp_path / "r.yaml", name=f"s{number}", sample=number), context)
        assert built is not None
        found.add(model_of(built).body(1).name)
    assert found == {"thing/brick", "thing/ball"}
