"""`explain --why-not`: why an element or attribute is not in a model."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.sources.context import Context
from mjcompose.trace.absence import Absences, explain_absence
from mjcompose.trace.explanation import Absence
from mjcompose.trace.query import ExplainQuery, read
from mjcompose.trace.traced import Traced, trace

ARM = """<mujoco model="arm">
  <compiler discardvisual="true"/>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  <worldbody>
    <body name="a" euler="0 0 90">
      <joint name="j"/>
      <geom name="g" size=".1"/>
      <geom name="v" type="mesh" mesh="m" contype="0" conaffinity="0" group="1"/>
      <body name="b"><joint name="k"/><geom size=".1"/></body>
    </body>
  </worldbody>
  <actuator><motor name="j" joint="j"/><motor name="k" joint="k"/></actuator>
  <keyframe><key name="home" qpos="0.3 1.6" ctrl="7 8"/></keyframe>
</mujoco>
"""
RECIPE = """recipe: 1
attach:
  left: {model: ./arm.xml, drop: [key]}
  right: {model: ./arm.xml, pos: [1, 0, 0], subtree: b}
edit:
  - {select: {motor: left/j}, remove: true}
  - {select: {body: left/a}, set: {quat: [1, 0, 0, 0]}}
  - {select: {joint: left/k}, rename: hip}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("absence")
    (made / "arm.xml").write_text(ARM, encoding="utf-8")
    (made / "recipe.yaml").write_text(RECIPE, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def traced(folder: Path) -> Traced:
    found = trace(Path("recipe.yaml"), Context(environment={}, folder=folder))
    assert found is not None
    return found


def _query(text: str, context: Context) -> ExplainQuery:
    query = read(text, None, context.sink)
    assert query is not None
    return query


def _absences(traced: Traced, folder: Path, text: str) -> tuple[Absence, ...]:
    context = Context(environment={}, folder=folder)
    answer = Absences(traced, context).answer(_query(text, context))
    assert answer is not None, [each.message for each in context.sink.diagnostics]
    return answer.found


@pytest.mark.parametrize(
    ("text", "words", "line", "now"),
    [
        ("motor left/j", "edit {motor: left/j}: remove", 6, None),
        ("geom left/v", "as MuJoCo has it in `arm.xml` alone, by its `discardvisual`", 2, None),
        ("key left/home", "the recipe drops the keys of `left/`", 3, None),
        ("joint left/k", "edit {joint: left/k}: rename to hip", 8, "joint hip"),
        ("body right/a", "not needed by `b`, the subtree that the recipe takes", 4, None),
        ("body left/a euler", "edit {body: left/a}: set quat = [1, 0, 0, 0]", 7, None),
        ("joint left/j range", "no file and no entry of the recipe writes it", None, None),
        ("arm.xml:8", "as MuJoCo has it in `arm.xml` alone, by its `discardvisual`", 2, None),
    ],
)
def test_why_not(traced: Traced, folder: Path, text: str, words: str, line: int | None, now: str | None) -> None:
    absence = _absences(traced, folder, text)[0]
    assert (absence.reason.words, absence.now) == (words, now)
    assert (absence.reason.span and absence.reason.span.line) == line


def test_without_the_attribute_another_value_counts(traced: Traced, folder: Path) -> None:
    (absence,) = _absences(traced, folder, "body left/a euler")
    assert (absence.text, absence.instead) == ('euler="0 0 90"', "MuJoCo's default counts")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("joint left/j", "not-missing"),
        ("geom left/g size", "not-missing"),
        ("joint none", "unknown-name"),
        ("size", "unknown-name"),
        ("joint left/j nonsense", "unknown-attribute"),
        ("geom#0", "unknown-name"),
    ],
)
def test_no_answer_is_reported(traced: Traced, folder: Path, text: str, code: str) -> None:
    context = Context(environment={}, folder=folder)
    assert Absences(traced, context).answer(_query(text, context)) is None
    assert [each.code for each in context.sink.diagnostics] == [code]


def test_mujoco_itself_leaves_an_element_out(folder: Path) -> None:
    context = Context(environment={}, folder=folder)
    answer = explain_absence(Path("arm.xml"), _query("geom v", context), context)
    assert answer is not None
    (absence,) = answer.found
    assert "MuJoCo leaves it out of the compiled model, by its `discardvisual`" in absence.reason.words
    assert absence.reason.span is not None and absence.reason.span.line == 2
