from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.compose import load as module
from mjcompose.compose.compose import Composer
from mjcompose.link.link import link
from mjcompose.link.linking import Linking
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source

Compose = Callable[..., Any]


def test_a_source_is_read_once(compose: Compose, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []
    read_source = module.read_source

    def counted(source: Source, *rest: Any, **more: Any) -> Any:
        read.append(source.path)
        return read_source(source, *rest, **more)

    monkeypatch.setattr(module, "read_source", counted)
    inner = "recipe: 1\nbase: ./robot.xml\nattach: {copy: {model: ./robot.xml, site: flange}}\n"
    model = compose(
        "recipe: 1\nbase: ./robot.xml\nattach:\n  a: {model: ./robot.xml}\n  b: {model: ./inner.yaml}\n  c: {model: ./inner.yaml}\n",
        inner__yaml=inner,
    )
    assert [path.name for path in read] == ["robot.xml"]
    assert [each.get("name") for each in model.iter("joint")] == [
        "hinge",
        "a/hinge",
        "b/hinge",
        "b/copy/hinge",
        "c/hinge",
        "c/copy/hinge",
    ]


def test_parts_share_nothing(compose: Compose) -> None:
    """What is added to one copy is not in another."""
    model = compose(
        "recipe: 1\nattach: {a: {model: ./robot.xml}, b: {model: ./robot.xml}}\nadd: [{to: a/base, site: {name: s}}]\n"
    )
    assert [len(each.findall(".//site")) for each in model.find("worldbody")] == [2, 1]


def test_faults_of_every_stage_after_the_sources_are_told_at_once(compose: Compose) -> None:
    assert compose(
        "recipe: 1\nbase: ./robot.xml\n"
        "attach:\n  a: {model: ./robot.xml, site: flnge}\n  b: {model: ./robot.xml, mate: flang}\n"
        "sensor: {s: {type: touch, site: a/flange}, t: {type: touch, site: x}}\n"
    ) == ["4:33 attach-place", "5:33 attach-place", "6:67 unknown-name"]


def test_a_fault_of_a_nested_recipe_is_told_once(compose: Compose) -> None:
    inner = "recipe: 1\nbase: ./robot.xml\nsensor: {s: {type: touch, site: x}}\n"
    text = "recipe: 1\nattach: {a: {model: ./inner.yaml}, b: {model: ./inner.yaml}, c: {model: ./inner.yaml}}\n"
    assert compose(text, inner__yaml=inner) == ["inner3:33 unknown-name"]


def test_a_plan_that_fails_gives_nothing(tmp_path: Path) -> None:
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nsensor: {s: {type: touch, site: x}}\n")
    context = Context(environment={}, folder=tmp_path)
    plan = make_plan(tmp_path / "recipe.yaml", context)
    assert plan is not None
    assert Composer(context, None).compose(plan) is None


MALFORMED = '<mujoco><worldbody><body><joint range="low 1"/><geom size="1"/></body></worldbody></mujoco>'
LINKED_WITH_IT = "recipe: 1\nbase: ./robot.xml\nattach: {a: {model: ./odd.xml}}\n"


def test_a_malformed_value_of_a_source_is_reported(tmp_path: Path, compose: Compose) -> None:
    (tmp_path / "odd.xml").write_text(MALFORMED)
    assert compose(LINKED_WITH_IT) == ["odd.xml1:40 wrong-type"]


def test_a_malformed_value_does_not_hide_a_bug(
    tmp_path: Path, compose: Compose, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise KeyError("bug")

    (tmp_path / "odd.xml").write_text(MALFORMED)
    monkeypatch.setattr("mjcompose.compose.compose.link", broken)
    with pytest.raises(KeyError, match="bug"):
        compose(LINKED_WITH_IT)


@pytest.mark.parametrize("error", [KeyError, IndexError, ValueError, OverflowError, ZeroDivisionError])
def test_a_bug_is_not_explained_by_a_malformed_value(
    error: type[Exception], tmp_path: Path, compose: Compose, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even a bug that the corrected sources do not show."""
    calls: list[object] = []

    def broken(linking: Linking) -> bool:
        calls.append(linking)
        if len(calls) == 1:
            raise error("bug")
        return link(linking)

    (tmp_path / "odd.xml").write_text(MALFORMED)
    monkeypatch.setattr("mjcompose.compose.compose.link", broken)
    with pytest.raises(error, match="bug"):
        compose(LINKED_WITH_IT)
    assert len(calls) == 1


@pytest.mark.parametrize(
    "attributes",
    [
        'euler="1 2"',
        'pos="1 2"',
        'quat="1 0 0"',
        'axisangle="0 0 1"',
        'xyaxes="1 0 0"',
        'zaxis="1 0"',
        'pos="1 2 up"',
    ],
)
def test_a_malformed_pose_of_a_place_is_reported(tmp_path: Path, compose: Compose, attributes: str) -> None:
    (tmp_path / "odd.xml").write_text(f'<mujoco><worldbody><site name="s" {attributes}/></worldbody></mujoco>')
    (fault,) = compose("recipe: 1\nbase: ./odd.xml\nattach: {a: {model: ./robot.xml, site: s, joint: free}}\n")
    assert str(fault).startswith("odd.xml1:")
    assert str(fault).endswith("wrong-type")


def test_a_blank_orientation_is_none(compose: Compose) -> None:
    place = '<mujoco><worldbody><site name="s" euler=" " pos="1 2 3"/></worldbody></mujoco>'
    ball = '<mujoco><worldbody><geom size="1"/></worldbody></mujoco>'
    recipe = "recipe: 1\nbase: ./odd.xml\nattach: {a: {model: ./ball.xml, site: s, joint: free}}\n"
    model = compose(recipe, odd__xml=place, ball__xml=ball)
    assert not isinstance(model, list), model
    (body,) = model.iterfind("worldbody/body")
    assert body.get("pos") == "1 2 3"
