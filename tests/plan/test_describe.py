"""`allow`, seen from a whole build."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco><worldbody><body name="base"><joint name="elbow"/><geom size="0.1"/></body></worldbody>
  <actuator><position name="elbow" joint="elbow" kp="10"/></actuator></mujoco>"""
ODD = '<mujoco><worldbody><frame odd="1"><body name="b"><geom size="0.1"/></body></frame></worldbody></mujoco>'
CONVERT = "{select: {actuator: elbow}, convert: {to: motor}%s}"


def found(folder: Path, text: str, *, strict: bool = False, **others: str) -> list[str]:
    """The codes of a build, each with its severity and file."""
    (folder / "arm.xml").write_text(ARM)
    (folder / "odd.xml").write_text(ODD)
    for name, content in {"recipe": text, **others}.items():
        (folder / f"{name}.yaml").write_text(f"recipe: 1\n{content}")
    context = Context(folder=folder, strict=strict)
    built = build(ModelRequest(folder / "recipe.yaml"), context)
    assert (built is None) == context.sink.has_errors
    return [
        f"{each.severity.value} {each.code} {each.span.file if each.span else ''}" for each in context.sink.sorted()
    ]


LOSS = "warning convert-loss recipe.yaml"
UNUSED = "warning unused-allow recipe.yaml"
ODD_ONE = "warning unknown-attribute odd.xml"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"base: ./arm.xml\nedit: [{CONVERT % ''}]", [LOSS]),
        (f"base: ./arm.xml\nallow: [convert-loss]\nedit: [{CONVERT % ''}]", []),
        (f"base: ./arm.xml\nedit: [{CONVERT % ', allow: [convert-loss]'}]", []),
        (f"base: {{model: ./arm.xml, edit: [{CONVERT % ', allow: [convert-loss]'}]}}", []),
        (f"base: {{model: ./arm.xml, edit: [{CONVERT % ''}], allow: [convert-loss]}}", []),
        (
            f"base: ./arm.xml\nattach: {{b: {{model: ./odd.xml, allow: [unknown-attribute]}}}}\nedit: [{CONVERT % ''}]",
            [LOSS],
        ),
        (
            f"base: ./arm.xml\nattach: {{b: {{model: ./odd.xml, allow: [convert-loss]}}}}\nedit:\n  - {CONVERT % ''}",
            [ODD_ONE, LOSS, UNUSED],
        ),
        (
            f"base: ./arm.xml\nedit:\n  - {{select: {{joint: elbow}}, set: {{damping: 1}}, allow: [convert-loss]}}\n  - {CONVERT % ''}",
            [LOSS, UNUSED],
        ),
        ("base: ./odd.xml\nallow: [unknown-attribute, license-missing]", []),
        ("base: ./odd.xml\nallow: [usd-loss, mujoco-warning]", [ODD_ONE, UNUSED]),
    ],
)
def test_what_it_covers(tmp_path: Path, text: str, expected: list[str]) -> None:
    assert sorted(found(tmp_path, text)) == sorted(expected)


def test_a_nested_recipe_allows_its_own(tmp_path: Path) -> None:
    nested = "base: ./odd.xml\nallow: [unknown-attribute]"
    text = "attach:\n  a: {model: ./nested.yaml}\n"
    assert found(tmp_path, text, nested=nested) == []
    other = "attach:\n  a: {model: ./nested.yaml}\n  b: {model: ./arm.xml}\nedit: [{select: {actuator: b/elbow}, convert: {to: motor}}]"
    assert found(tmp_path, other, nested=nested) == [LOSS]
    assert found(tmp_path, text, nested="base: ./odd.xml") == [ODD_ONE]


def test_errors_cannot_be_allowed(tmp_path: Path) -> None:
    text = "base: ./arm.xml\nallow: [unknown-name]\nsensor: {s: {type: jointpos, joint: wrist}}"
    assert found(tmp_path, text) == ["error unknown-name recipe.yaml"]


def test_with_strict_what_is_not_allowed_is_an_error(tmp_path: Path) -> None:
    assert found(tmp_path, "base: ./odd.xml", strict=True) == ["error unknown-attribute odd.xml"]
    assert found(tmp_path, "base: ./odd.xml\nallow: [unknown-attribute]", strict=True) == []
    assert found(tmp_path, "base: ./arm.xml\nallow: [convert-loss]", strict=True) == ["error unused-allow recipe.yaml"]


def test_what_may_come_in_another_build_is_not_called_unused(tmp_path: Path) -> None:
    text = "params: {m: 1}\nmatrix: {axes: {m: [1, 2]}}\nbase: ./arm.xml\nallow: [convert-loss]"
    assert found(tmp_path, text) == []
    context = Context(folder=tmp_path)
    build(ModelRequest(tmp_path / "recipe.yaml", verified=False), replace(context))
    build(ModelRequest(tmp_path / "recipe.yaml", name="cell"), context)
    assert context.sink.diagnostics == []
