"""MuJoCo judges: the values told are those of the compiled model, and the numbers are MuJoCo's."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.sink import Sink
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.trace import query
from mjcompose.trace.traced import Traced, trace
from mjcompose.tree.select import kind_of

_OBJECTS = "body joint geom site camera light tendon equality actuator sensor key".split()
_ARRAYS = [
    ("geom", "friction", "geom_friction"), ("geom", "solref", "geom_solref"), ("geom", "solimp", "geom_solimp"),
    ("geom", "group", "geom_group"), ("geom", "condim", "geom_condim"), ("geom", "margin", "geom_margin"),
    ("joint", "solreflimit", "jnt_solref"), ("joint", "group", "jnt_group"),
    ("site", "group", "site_group"), ("actuator", "gear", "actuator_gear"), ("actuator", "group", "actuator_group"),
    ("equality", "solref", "eq_solref"), ("equality", "solimp", "eq_solimp"),
]  # fmt: skip
_EXPANDED = ("replicate", "composite", "flexcomp", "attach")


@pytest.fixture
def compiled(recipe: Path, tmp_path: Path) -> mujoco.MjModel:
    built = build(ModelRequest(recipe, verified=False), Context(environment={}, folder=recipe.parent))
    assert built is not None
    for path, content in built.bundle.files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes(content)
    return mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))


def _all(traced: Traced, word: str) -> list:  # type: ignore[type-arg]
    asked = query.read(word, None, Sink())
    assert asked is not None
    return query.find(asked, traced.model.root, traced.separator)


def test_numbers_and_values_are_those_of_mujoco(traced: Traced, compiled: mujoco.MjModel) -> None:
    root = traced.model.root
    if next(root.iter(*_EXPANDED), None) is not None:
        pytest.skip("MuJoCo multiplies elements of this model")
    if root.find("worldbody") is not None:
        for word in _OBJECTS:
            kind = getattr(mujoco.mjtObj, f"mjOBJ_{word.upper()}")
            found = _all(traced, word)
            names = [mujoco.mj_id2name(compiled, kind, at) or "" for at in range(len(found))]
            assert [query.name_of(node) or ("world" if node.tag == "worldbody" else "") for node in found] == names
            assert mujoco.mj_id2name(compiled, kind, len(found)) is None
    for word, attribute, array in _ARRAYS:
        for at, node in enumerate(_all(traced, word)):
            if attribute in kind_of(node).attributes:
                told = traced.attribute(node, attribute).value
                numbers = np.array(str(told).split(), float)
                values = np.atleast_1d(getattr(compiled, array)[at])[: len(numbers)]
                assert np.array_equal(values, numbers), (traced.labels[node], attribute)


def test_a_short_list_leaves_the_rest_to_the_class_above_and_actuators_share_theirs(tmp_path: Path) -> None:
    file = tmp_path / "model.xml"
    file.write_text("""<mujoco>
      <default>
        <geom friction="1 0.2 0.3"/>
        <general ctrlrange="-1 1" gear="2 3"/>
        <default class="a"><geom friction="0.5"/><motor gear="5"/></default>
      </default>
      <worldbody><body><joint name="j"/><geom class="a" size="1"/></body></worldbody>
      <actuator><motor class="a" joint="j"/><position kp="1" joint="j"/></actuator>
    </mujoco>""")
    found = trace(file, Context(environment={}, folder=tmp_path))
    assert found is not None
    model = mujoco.MjModel.from_xml_path(str(file))
    for word, attribute, array in [("geom", "friction", "geom_friction"), ("actuator", "gear", "actuator_gear")]:
        for at, node in enumerate(_all(found, word)):
            told = found.attribute(node, attribute).value
            assert np.array_equal(np.array(str(told).split(), float), getattr(model, array)[at])
    (geom,) = _all(found, "geom")
    shares = [(each.name, each.part_of_it) for each in found.attribute(geom, "friction").levels if each.wins]
    assert shares == [("a", None), ("main", "0.2 0.3")]
