"""Numbers of an inertia: the fit and the model that is built from its file have the same."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.language.identify import Identify
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.identify.unknowns import ModelPool, unknowns_of

BODIES = {
    "geoms": '<geom type="box" size=".05 .1 .2" pos=".1 0 .02" euler="0 20 0"/>',
    "inertial": '<inertial pos=".1 .02 0" mass="2" diaginertia=".01 .02 .025" euler="10 20 30"/>',
    "full": '<inertial pos=".1 .02 0" mass="2" fullinertia=".02 .02 .025 .001 .002 -.001"/>',
}
MODEL = """<mujoco><compiler angle="degree"/><worldbody><body name="above"><joint name="j"/><geom size=".1"/>
  <body name="b" pos=".1 0 0"><joint name="k" axis="0 1 0"/>{}</body></body></worldbody></mujoco>"""
NUMBERS = {"mass": 1.7, "com[0]": 0.02, "com[2]": -0.03}
SHAPE = {"shape[0]": 0.2, "shape[1]": -0.1, "shape[3]": 0.25, "shape[4]": -0.2, "shape[5]": 0.1}


def built(numbers: dict[str, float], body: str, folder: Path, more: str = "", sample: int = 0) -> Built:
    (folder / "model.xml").write_text(MODEL.format(BODIES[body]))
    file = {"measured": 1, "values": {"body b": {name: {"value": n, "std": 0.1} for name, n in numbers.items()}}}
    (folder / "A12.yaml").write_text(json.dumps(file))
    recipe = f"recipe: 1\nallow: [license-missing]\nbase: ./model.xml\nmeasured: A12.yaml\n{more}"
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(folder=folder)
    made = build(ModelRequest(folder / "recipe.yaml", sample=sample), context)
    assert made is not None and not context.sink.errors, context.sink.diagnostics
    return made


def compiled(made: Built) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(made.bundle.files[made.bundle.model].decode())


def tensor(model: mujoco.MjModel) -> np.ndarray:
    """Return the inertia of the body in its own frame."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.body("b").iquat)
    rotation = rotation.reshape(3, 3)
    return rotation @ np.diag(model.body("b").inertia) @ rotation.T


def fitted(numbers: dict[str, float], body: str) -> mujoco.MjModel:
    """Return the model with these numbers as the fit simulates it."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(BODIES[body]))
    groups = [[{"name": "b", "tag": "body", "family": "body"}]]
    fields = [
        {"name": "f", "kind": "body", "attribute": name, "groups": groups, "bounds": ["range", -9, 99]}
        for name in numbers
    ]
    unknowns = unknowns_of(mujoco, model, fields)
    pool = ModelPool(mujoco, model, unknowns)
    pool.write(np.zeros(len(numbers)) + 0.1, 0)  # what a copy had before does not count
    return pool.write(np.array([numbers[unknown.attribute] for unknown in unknowns]), 0)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("numbers", [NUMBERS, SHAPE, NUMBERS | SHAPE])
def test_the_built_model_is_that_of_the_fit(numbers: dict[str, float], body: str, tmp_path: Path) -> None:
    one = fitted(numbers, body)
    other = compiled(built(numbers, body, tmp_path))
    assert other.body("b").mass[0] == pytest.approx(one.body("b").mass[0])
    assert other.body("b").ipos == pytest.approx(one.body("b").ipos)
    assert tensor(other) == pytest.approx(tensor(one), abs=1e-9)
    assert other.dof_M0 == pytest.approx(one.dof_M0)
    assert other.body("above").inertia == pytest.approx(one.body("above").inertia)


def test_zeros_change_nothing() -> None:
    plain = mujoco.MjModel.from_xml_string(MODEL.format(BODIES["geoms"]))
    same = fitted(dict.fromkeys(NUMBERS | SHAPE, 0.0) | {"mass": float(plain.body("b").mass[0])}, "geoms")
    assert tensor(same) == pytest.approx(tensor(plain), abs=1e-12)
    assert same.body("b").ipos == pytest.approx(plain.body("b").ipos)


@pytest.mark.parametrize("seed", range(20))
def test_every_shape_is_a_possible_inertia(seed: int) -> None:
    random = np.random.default_rng(seed)
    shape = {f"shape[{index}]": float(random.normal(0, 1)) for index in range(6)}
    moments = np.sort(fitted(shape, "inertial").body("b").inertia)
    assert moments[0] > 0
    assert moments[0] + moments[1] > moments[2] * (1 - 1e-9)


def test_a_sample_draws_the_center_of_mass(tmp_path: Path) -> None:
    more = "randomize: {seed: 7, samples: 3, fields: {robot: {from: measured}}}\n"
    made = built(NUMBERS, "geoms", tmp_path, more, sample=2)
    drawn = {
        f"{draw['attribute']}[{draw['component']}]": draw["value"]
        for draw in json.loads(made.bundle.files["manifest.json"])["draws"]
    }
    plain = mujoco.MjModel.from_xml_string(MODEL.format(BODIES["geoms"]))
    offset = compiled(made).body("b").ipos - plain.body("b").ipos
    assert offset == pytest.approx([drawn["com[0]"], 0, drawn["com[2]"]])
    assert drawn["com[0]"] != NUMBERS["com[0]"]


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ("mass", ["mass"]),
        ("mass+com, within: 5cm", ["mass", *(f"com[{axis}]" for axis in range(3))]),
        ("full, within: 5cm", ["mass", *(f"com[{n}]" for n in range(3)), *(f"shape[{n}]" for n in range(6))]),
    ],
)
def test_the_numbers_of_a_field(inertia: str, words: list[str]) -> None:
    import yaml

    written = yaml.safe_load(f"{{select: {{body: b}}, scale: [0.3, 3], inertia: {inertia}}}")
    field = Identify.model_validate({"fields": {"payload": written}}).fields["payload"]
    assert [word for word, _ in field.numbers] == words
