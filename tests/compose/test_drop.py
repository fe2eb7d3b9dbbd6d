"""`drop` of a base or a part."""

from __future__ import annotations

from pathlib import Path

import pytest
from compose.arm import Case, changed

from composer.compose.foresee import foresee
from composer.context import Context
from composer.plan.planner import make_plan
from composer.stages import Request, build


def test_drop(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nbase: {model: ./arm.xml, drop: [light, contact, {geom: 'visual_*'}, {body: prop}]}\n"
    )
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    found = changed(before, model)
    assert {each for each in found if each[0] == "-"} == {
        "-sun",
        "-no",
        "-visual_upper",
        "-prop",
        "-free",
        "-ball",
    }
    assert {each for each in found if each[0] != "-"} <= {
        f"{key} {row}" for key in ("home", "other") for row in ("qpos", "qvel")
    }
    assert model.key("home").qpos == pytest.approx([0.1, 0.2])


def test_what_is_dropped_is_listed(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text("recipe: 1\nbase: {model: ./arm.xml, drop: [{body: link2}]}\n")
    context = Context(environment={}, folder=radian.folder)
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    (found,) = foresee(plan, context).subtrees.values()
    listed = {(each.what, each.name) for each in found.left}
    assert {("body", "link2"), ("joint", "elbow"), ("site", "tip"), ("actuator", "a2")} <= listed
    assert not {"frame", "inertial"} & {what for what, _ in listed}, "they are no more than poses and numbers"


def test_drop_of_what_is_not_there(radian: Case) -> None:
    (radian.folder / "recipe.yaml").write_text(
        "recipe: 1\nbase: {model: ./arm.xml, drop: [equality, camera]}\n"
    )
    context = Context(environment={}, folder=radian.folder)
    assert build(Request(radian.folder / "recipe.yaml", verified=False), context) is None
    assert [(each.code, each.span.column) for each in context.sink.errors if each.span] == [
        ("selector", 33),
        ("selector", 43),
    ]
