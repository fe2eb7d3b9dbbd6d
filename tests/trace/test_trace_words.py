"""What recipes call an attribute, `explain` takes: the mass of a body, and what MuJoCo computes for an actuator."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose.mujoco.attributes import TAGS, attributes
from mjcompose.sources.context import Context
from mjcompose.trace import query
from mjcompose.trace.explanation import AttributeExplained
from mjcompose.trace.trace_words import derived_names
from mjcompose.trace.traced import explain, trace
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.select import query as paths_of

MODEL = """<mujoco>
  <default><geom density="50"/></default>
  <worldbody>
    <body name="inertial"><joint name="j"/><inertial pos="0 0 0" mass="3" diaginertia="1 1 1"/>
      <geom size=".1" mass="9"/></body>
    <body name="masses"><geom name="one" size=".1" mass="2"/>
      <frame><geom name="two" size=".1" mass="0.5"/></frame></body>
    <body name="densities"><geom name="light" size=".1"/></body>
    <body name="nothing"/>
  </worldbody>
  <actuator><position name="p" joint="j" kp="7"/></actuator>
</mujoco>
"""


@pytest.mark.parametrize("tag", TAGS)
def test_what_recipes_take_is_explained(tag: str) -> None:
    kinds = [GRAMMAR.element(path) for path in paths_of(tag, None).paths]
    known = {name for kind in kinds for name in (*kind.attributes, *derived_names(kind))}
    assert set(attributes(tag)) <= known


def _asked(folder: Path, text: str) -> AttributeExplained:
    (folder / "model.xml").write_text(MODEL, encoding="utf-8")
    context = Context(environment={}, folder=folder)
    asked = query.read(text, None, context.sink)
    assert asked is not None
    found = explain(Path("model.xml"), asked, context)
    assert isinstance(found, AttributeExplained), context.sink.diagnostics
    return found


@pytest.mark.parametrize(
    ("body", "mass", "givers"),
    [
        ("inertial", 3.0, ["<inertial> mass"]),
        ("masses", 2.5, ["geom one mass", "geom two mass"]),
        ("densities", None, ["geom light density, class main"]),
        ("nothing", 0.0, []),
    ],
)
def test_the_mass_of_a_body(tmp_path: Path, body: str, mass: float | None, givers: list[str]) -> None:
    found = _asked(tmp_path, f"body {body} mass")
    assert [each.name for each in found.levels] == givers
    assert (None if found.value is None else float(found.value)) == mass
    if mass is not None and mass:
        model = mujoco.MjModel.from_xml_string(MODEL.replace('<body name="nothing"/>', ""))
        assert model.body(body).mass[0] == mass


def test_what_mujoco_computes_for_an_actuator(tmp_path: Path) -> None:
    found = _asked(tmp_path, "actuator p gainprm")
    assert found.value is None and found.notes
    assert ("position p kp", "7") in [(each.name, each.text) for each in found.levels]


def test_a_component_is_asked_for_by_its_attribute(tmp_path: Path) -> None:
    assert _asked(tmp_path, "geom one friction[0]").attribute == "friction"


def test_a_drawn_mass_shows_what_was_drawn(tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(MODEL, encoding="utf-8")
    (tmp_path / "recipe.yaml").write_text(
        "recipe: 1\nbase: model.xml\nrandomize:\n  seed: 1\n  samples: 2\n  fields:\n"
        "    load: {select: {body: inertial}, attr: mass, scale: {uniform: [1, 2]}}\n",
        encoding="utf-8",
    )
    context = Context(environment={}, folder=tmp_path)
    traced = trace(Path("recipe.yaml"), context, sample=2)
    assert traced is not None, context.sink.diagnostics
    body = next(each for each in traced.model.root.iter("body") if each.get("name") == "inertial")
    found = traced.attribute(body, "mass")
    ((change,),) = [each.changes for each in found.levels]
    assert change.reason.span is not None and change.reason.span.line == 7
    factor = change.reason.words.partition("sample 2: ")[2].removesuffix(" is drawn")
    assert float(found.value or 0) == 3 * float(factor)
