"""Selectors of edits: conditions, parts and patterns."""

from __future__ import annotations

from pathlib import Path

from compose.arm import RADIANS, Case
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def test_a_regular_expression_has_a_bound(tmp_path: Path) -> None:
    arm = Case(tmp_path, RADIANS.replace('"upper"', f'"{"a" * 40}"'))
    assert arm.told("{select: {geom: '/(.|.)*[!?]/'}, rename: x}") == ["14 selector"]
    assert "takes longer than 2 seconds" in arm.said


def test_by_part(radian: Case) -> None:
    (radian.folder / "pair.yaml").write_text(
        "recipe: 1\nbase: ./arm.xml\nattach: {inner: {model: ./arm.xml, pos: [0, 1, 0]}}\n"
    )
    head = "recipe: 1\nbase: ./arm.xml\nattach: {outer: {model: ./pair.yaml, pos: [0, 3, 0]}}\nadd: [{to: world, geom: {name: new, size: [0.1]}}]\nedit: "
    for part, expected in (
        ("outer", {"outer/ball", "outer/inner/ball"}),
        ("outer/inner", {"outer/inner/ball"}),
        ("base", {"ball"}),
        ("'*'", {"outer/ball", "outer/inner/ball"}),
    ):
        model = radian.model(head + f"[{{select: {{geom: '**/ball', part: {part}}}, set: {{condim: 6}}}}]\n")
        found = {model.geom(each).name for each in range(model.ngeom) if model.geom_condim[each] == 6}
        assert found == expected


def test_angles_in_where(arm: Case) -> None:
    range = "-90deg, 90deg" if "degree" in (arm.folder / "arm.xml").read_text() else "-1.5rad, 1.5rad"
    for own in (False, True):
        model = arm.edited(
            f"{{select: {{joint: '**', where: {{range: [{range}]}}}}, expect: 2, set: {{group: 1}}}}", own
        )
        assert model.joint("elbow").group[0] == 1


def test_a_condition_on_what_others_of_the_family_have(radian: Case) -> None:
    model = radian.edited("{select: {joint: '**', where: '${range[1] > 1rad}'}, expect: 2, set: {group: 1}}")
    assert model.joint("elbow").group[0] == 1
    assert radian.told("{select: {geom: '**', where: '${mass > 0}'}, set: {group: 1}}") == ["37 expression"]
    assert "geom `floor` has no `mass`" in radian.said


def test_a_part_is_called_with_the_separator_of_the_recipe(radian: Case) -> None:
    (radian.folder / "pair.yaml").write_text(
        "recipe: 1\nseparator: __\nattach: {inner: {model: ./arm.xml, pos: [0, 1, 0]}}\n"
    )
    head = "recipe: 1\nseparator: __\nattach: {outer: {model: ./pair.yaml, pos: [0, 3, 0]}}\nedit: "
    model = radian.model(head + "[{select: {geom: '**ball', part: outer__inner}, set: {condim: 6}}]\n")
    assert model.geom("outer__inner__ball").condim[0] == 6
    where = "{select: {geom: '**', part: inner}, set: {condim: 6}}]\n"
    (radian.folder / "recipe.yaml").write_text(f"{head}[{where}")
    assert (
        build(ModelRequest(radian.folder / "recipe.yaml"), context := Context(environment={}, folder=radian.folder))
        is None
    )
    assert "parts that exist: base, outer, outer__inner" in str(context.sink.errors)
