"""Fields with `from: measured`: one joint draw of the numbers of a file of measurements."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.plan.plan import Plan
from mjcompose.plan.planner import plan_what_remains
from mjcompose.sources.context import Context

ARM = """<mujoco model="arm"><worldbody><body name="a"><joint name="pan" damping="2"/><geom size=".1"/>
  <body name="b" pos="0 0 .3"><joint name="el{bow}" damping="1" range="-60 60"/><geom size=".1"/></body></body></worldbody>
  <actuator><position name="pan" joint="pan" kp="20"/></actuator></mujoco>"""
NUMBERS = {
    "joint pan": [
        "damping: {value: 0.7, std: 0.1, range: [0, 5]}",
        "armature: {value: 0.01, std: 0.01, range: [0, 1]}",
    ],
    '"joint el{bow}"': ["damping: {value: 0.25, std: 0.05}", "frictionloss: {value: 1, std: 0.4, not_identified: why}"],
    "actuator pan": ["kp: {value: 20, std: 2}"],
    "body b": ["mass: {value: 2.5, std: 0.1}"],
}
CORRELATION = [[50], [0, 0], [0, 0, -90], [20, 0, 0, 0], [0, 0, 0, 0, 0]]
RECIPE = """recipe: 1
allow: [license-missing, without-effect]
base: ./arm.xml
measured: {use}
randomize:
  seed: 7
  samples: {samples}
  fields: {{{fields}}}
"""


def file_of(order: list[int] | None = None) -> str:
    """Return the file with its elements in another order."""
    owners = list(NUMBERS)
    first = np.cumsum([0, *(len(NUMBERS[owner]) for owner in owners)])
    order = order or list(range(len(owners)))
    places = [place for owner in order for place in range(first[owner], first[owner + 1])]
    whole = np.eye(6)
    for row, numbers in enumerate(CORRELATION, 1):
        whole[row, :row] = whole[:row, row] = np.array(numbers)
    moved = whole[np.ix_(places, places)]
    lines = ["measured: 1", "values:"]
    for owner in order:
        lines += [f"  {owners[owner]}:", *(f"    {number}" for number in NUMBERS[owners[owner]])]
    lines += ["correlation:", *(f"- {[int(each) for each in moved[row, :row]]}" for row in range(1, 6))]
    return "\n".join(lines) + "\n"


def written(folder: Path, fields: str = "robot: {from: measured}", *, use: str = "A12.yaml", samples: int = 20) -> Path:
    (folder / "arm.xml").write_text(ARM)
    if not (folder / "A12.yaml").exists():
        (folder / "A12.yaml").write_text(file_of())
    (folder / "recipe.yaml").write_text(RECIPE.format(use=use, fields=fields, samples=samples))
    return folder / "recipe.yaml"


def planned(recipe: Path, sample: int = 0) -> tuple[Plan | None, Context]:
    context = Context(folder=recipe.parent)
    return plan_what_remains(recipe, context, sample=sample), context


def built(recipe: Path, sample: int = 0, *, worlds: bool = False) -> Built:
    context = Context(folder=recipe.parent)
    made = build(ModelRequest(recipe, sample=sample, worlds=worlds), context)
    assert made is not None, context.sink.diagnostics
    assert not context.sink.has_errors, context.sink.diagnostics
    return made


def draws_of(made: Built) -> list[SimpleNamespace]:
    manifest = json.loads(made.bundle.files["manifest.json"])
    return [SimpleNamespace(**draw) for draw in manifest["draws"]]


def compiled(made: Built) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(made.bundle.files[made.bundle.model].decode())


def table(recipe: Path) -> np.ndarray:
    """Return the draws of all samples, `(samples, numbers)`."""
    plan, context = planned(recipe)
    assert plan is not None and plan.measured_draws is not None, context.sink.diagnostics
    samples = range(1, plan.measured_draws.randomize.samples + 1)
    return np.array([[drawn.value for drawn in plan.measured_draws.records(sample)] for sample in samples], float)


def test_many_draws_have_the_means_and_the_covariance_of_the_file(tmp_path: Path) -> None:
    numbers = table(written(tmp_path, samples=2000))
    stds = np.array([0.1, 0.01, 0.05, 0.4, 2, 0.1])
    untruncated = [2, 3, 4, 5]  # an armature of 0.01 ± 0.01 is cut off at 0, which moves the damping of its joint
    off = (numbers.mean(axis=0) - [0.7, 0.01, 0.25, 1, 20, 2.5]) / stds
    assert np.abs(off[untruncated]).max() < 0.1
    assert numbers[:, 1].min() > 0
    assert off[1] > 0.2
    wanted = np.array([[1, -0.9, 0, 0], [-0.9, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    assert 0.05 < off[0] < 0.3
    assert np.corrcoef(numbers[:, untruncated].T) == pytest.approx(wanted, abs=0.06)


def test_the_order_of_the_file_does_not_matter(tmp_path: Path) -> None:
    recipe = written(tmp_path)
    first = compiled(built(recipe, 5))
    (tmp_path / "A12.yaml").write_text(file_of([3, 1, 0, 2]))
    second = compiled(built(recipe, 5))
    for array in ("dof_damping", "dof_armature", "dof_frictionloss", "actuator_gainprm", "body_mass"):
        assert (getattr(first, array) == getattr(second, array)).all()


def test_the_same_robot_has_the_same_draws_under_another_prefix(tmp_path: Path) -> None:
    recipe = written(tmp_path)
    alone = compiled(built(recipe, 3))
    text = recipe.read_text().replace("base: ./arm.xml", "attach: {left: {model: ./arm.xml}}")
    recipe.write_text(text.replace("A12.yaml", '{file: A12.yaml, rename: {"**": "left/**"}}'))
    attached = compiled(built(recipe, 3))
    assert (alone.dof_damping == attached.dof_damping).all()
    assert alone.dof_damping[0] not in (0.7, 2)


def test_a_sample_has_its_draws_in_the_manifest_and_explains_them(tmp_path: Path) -> None:
    made = built(written(tmp_path), 4)
    model = compiled(made)
    draws = {(draw.element, draw.attribute): draw for draw in draws_of(made)}
    assert len(draws) == 6
    assert model.dof_damping[0] == draws["pan", "damping"].value
    assert model.dof_frictionloss[1] == draws["el{bow}", "frictionloss"].value
    assert model.body_mass[2] == pytest.approx(draws["b", "mass"].value)
    step = next(step for step in made.plan.edits if "frictionloss" in step.words)
    assert step.words.endswith("drawn by robot for sample 4, not 1")
    assert (step.span.file, step.span.line) == ("A12.yaml", 8)


def test_the_nominal_model_has_the_numbers_of_the_file(tmp_path: Path) -> None:
    model = compiled(built(written(tmp_path)))
    assert list(model.dof_damping) == [0.7, 0.25]
    assert model.dof_frictionloss[1] == 0  # not identified


def test_worlds_have_the_numbers_of_the_samples(tmp_path: Path) -> None:
    recipe = written(tmp_path, samples=30)
    worlds = built(recipe, worlds=True)
    rows = list(csv.DictReader(io.StringIO(worlds.bundle.files["samples.csv"].decode())))
    assert [draw.value for draw in draws_of(built(recipe, 17))] == [
        float(number) for name, number in rows[17].items() if name != "sample"
    ]
    columns = json.loads(worlds.bundle.files["randomize.json"])["columns"]
    assert [(each["column"], each["low"], each["high"]) for each in columns][1:3] == [
        ("robot[joint pan armature]", 0, 1),
        ("robot[joint el{bow} damping]", 0, None),
    ]


def test_the_last_field_of_a_number_counts(tmp_path: Path) -> None:
    plain = table(written(tmp_path, samples=300))
    fields = "robot: {from: measured}, spread: {from: measured, select: {joint: pan}, widen: 3}"
    wide = table(written(tmp_path, fields, samples=300))
    assert plain.shape == wide.shape
    assert wide[:, 0].std() > 2 * plain[:, 0].std()
    assert (wide[:, 0] >= 0).all()
    assert wide[:, 5].std() == pytest.approx(plain[:, 5].std(), rel=0.2)


def test_other_fields_keep_their_draws_and_come_after(tmp_path: Path) -> None:
    scale = "wear: {select: {joint: pan}, attr: damping, scale: {uniform: [0.5, 2]}}"
    alone = draws_of(built(written(tmp_path, scale), 2))[0].value
    both = built(written(tmp_path, f"{scale}, robot: {{from: measured}}"), 2)
    draws = {draw.field: draw.value for draw in draws_of(both) if draw.attribute == "damping" and draw.element == "pan"}
    assert draws["wear"] == alone
    assert compiled(both).dof_damping[0] == pytest.approx(draws["robot"] * draws["wear"])


def test_only_and_select(tmp_path: Path) -> None:
    draws = draws_of(built(written(tmp_path, use='{file: A12.yaml, only: {joint: "*"}}'), 1))
    assert {draw.element for draw in draws} == {"pan", "el{bow}"}
    draws = draws_of(built(written(tmp_path, "robot: {from: measured, select: {actuator: p*}}"), 1))
    assert [draw.attribute for draw in draws] == ["kp"]


def test_zeros_and_delays_are_drawn(tmp_path: Path) -> None:
    file = "measured: 1\nvalues:\n  joint pan: {zero: {value: 2deg, std: 1deg}}\n  actuator pan: {delay: {value: 0.01, std: 0.002}}\n"
    (tmp_path / "A12.yaml").write_text(file)
    recipe = written(tmp_path)
    model = compiled(built(recipe, 6))
    zero, delay = (draw.value for draw in draws_of(built(recipe, 6)))
    assert model.qpos0[0] == pytest.approx(zero)
    assert zero != pytest.approx(np.radians(2))
    if mujoco.mj_versionString() >= "4":
        assert model.actuator_delay[0] == pytest.approx(delay)
    context = Context(folder=tmp_path)
    build(ModelRequest(recipe, worlds=True), context)
    assert [(each.code, each.span.line) for each in context.sink.errors if each.span] == [("draw-at-run-time", 8)] * 2


@pytest.mark.parametrize(
    ("fields", "use", "file", "code", "text"),
    [
        ("robot: {from: measured}", "null", "", "missing-key", "name the file of measurements"),
        ("robot: {from: file}", "A12.yaml", "", "wrong-keyword", "cannot be `file`"),
        ("robot: {from: measured, per: part}", "A12.yaml", "", "wrong-type", "draws measured numbers"),
        ("robot: {from: measured, uniform: [0, 1]}", "A12.yaml", "", "wrong-type", "only one is allowed"),
        ("robot: {param: x, from: measured}", "A12.yaml", "", "wrong-type", "draws measured numbers"),
        (
            "robot: {select: {joint: pan}, attr: damping, uniform: [0, 1], widen: 2}",
            "A12.yaml",
            "",
            "unknown-key",
            "belongs to `from`",
        ),
        ("robot: {from: measured, widen: 0}", "A12.yaml", "", "out-of-range", "0"),
        ("robot: {from: measured, select: {joint: pam}}", "A12.yaml", "", "selector", "did you mean `pan`?"),
        ("robot: {from: measured, select: {camera: top}}", "A12.yaml", "", "selector", "no numbers of `camera`"),
        (
            "robot: {from: measured, select: {joint: pan, in: {body: a}}}",
            "A12.yaml",
            "",
            "selector",
            "names of their elements alone",
        ),
        ("robot: {from: measured}", "A12.yaml", "joint pan: {damping: {value: 1}}", "missing-key", "without `std`"),
        (
            "robot: {from: measured}",
            "A12.yaml",
            "joint pan: {damping: {value: 5, std: 1.0e-3, range: [4.9999999, 5]}, armature: {value: 0, std: 1, range: [0, 1.0e-6]}}",
            "out-of-range",
            "no draw of sample 1",
        ),
    ],
)
def test_faults_have_a_place(fields: str, use: str, file: str, code: str, text: str, tmp_path: Path) -> None:
    if file:
        (tmp_path / "A12.yaml").write_text(f"measured: 1\nvalues:\n  {file}\n")
    recipe = written(tmp_path, fields, use=use)
    if use == "null":
        recipe.write_text(recipe.read_text().replace("measured: null\n", ""))
    _, context = planned(recipe)
    (error,) = context.sink.errors
    assert error.code == code
    assert text in f"{error.message} {error.help}"
    assert error.span is not None and error.span.line >= 7


@pytest.mark.parametrize(
    ("rows", "code", "line", "text"),
    [
        ("- [90]\n- [90, -90]", "measured-format", 7, "contradict the rows above"),
        ("- [90]\n- [90, 120]", "out-of-range", 7, "this is 120"),
        ("- [100, 90, 0]\n- [90, 100, 0]\n- [0, 0, 100]", "measured-format", 5, "only the numbers below the diagonal"),
        ("- [90]", "measured-format", 5, "for each of 3 numbers"),
        ("- [90]\n- [90, .nan]", "wrong-type", 7, ""),
    ],
)
def test_impossible_correlations_are_refused_where_they_are(
    rows: str, code: str, line: int, text: str, tmp_path: Path
) -> None:
    pair = "joint pan: {damping: {value: 1, std: 1}, armature: {value: 1, std: 1}}"
    file = f"measured: 1\nvalues:\n  {pair}\n  body b: {{mass: {{value: 2, std: 1}}}}\ncorrelation:\n{rows}\n"
    (tmp_path / "A12.yaml").write_text(file)
    _, context = planned(written(tmp_path))
    error = context.sink.errors[0]
    assert (error.code, error.span and error.span.file, error.span and error.span.line) == (code, "A12.yaml", line)
    assert text in f"{error.message} {error.help}"
