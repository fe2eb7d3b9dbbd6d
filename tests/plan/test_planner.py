from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.plan.describe import as_data, describe
from mjcompose.plan.plan import Plan
from mjcompose.plan.planner import make_plan
from mjcompose.plan.steps import AddElement, AngleSettings, AppendElement, SetDefault, SetSingleton
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source

ROBOT = '<mujoco model="robot"><worldbody><body name="base"/></worldbody></mujoco>'


def planned(folder: Path, recipe: str, **files: str) -> Plan:
    plan, context = tried(folder, recipe, **files)
    assert plan is not None, context.sink.diagnostics
    return plan


def tried(folder: Path, recipe: str, **files: str) -> tuple[Plan | None, Context]:
    (folder / "robot.xml").write_text(ROBOT)
    (folder / "recipe.yaml").write_text(recipe)
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text)
    context = Context(environment={}, folder=folder)
    return make_plan(Path("recipe.yaml"), context), context


def test_defaults(tmp_path: Path) -> None:
    plan = planned(tmp_path, "recipe: 1\n")
    assert (plan.name, plan.description, plan.file) == ("recipe", None, "recipe.yaml")
    assert (plan.separator, plan.conflict, plan.angle_context.at(())) == ("/", "error", AngleSettings(None, "xyz"))
    assert plan.base is None and plan.parts == () and plan.steps == () and plan.settled == frozenset()


def test_steps_in_the_order_of_work(tmp_path: Path) -> None:
    """`add`, settings, classes, then the sections: those that may be referred to come first."""
    plan = planned(
        tmp_path,
        "recipe: 1\nsensor: {s: {type: clock}}\nactuator: {a: {type: motor, joint: j}}\nasset: {material: {m: {}}}\n"
        "default: {c: {geom: {size: [1]}}}\noption: {timestep: 0.001}\nadd: [{to: world, geom: {size: [1]}}]\n"
        "visual: {headlight: {active: 0}}\n",
    )
    assert [type(step) for step in plan.steps] == [
        AddElement,
        SetSingleton,
        SetSingleton,
        SetDefault,
        AppendElement,
        AppendElement,
        AppendElement,
    ]
    assert [step.section for step in plan.steps if isinstance(step, AppendElement)] == ["asset", "actuator", "sensor"]
    assert plan.settled == {"option/timestep", "visual/headlight/active"}


def test_prefixes(tmp_path: Path) -> None:
    plan = planned(
        tmp_path,
        "recipe: 1\nseparator: '__'\nattach:\n  a: {model: ./robot.xml}\n"
        "  b: {model: ./robot.xml, prefix: c}\n  d: {model: ./robot.xml, prefix: ''}\n  e: {model: ./robot.xml, prefix: ''}\n",
    )
    assert [part.prefix for part in plan.parts] == ["a__", "c__", "", ""]


def test_recipes_in_recipes(tmp_path: Path) -> None:
    plan = planned(
        tmp_path,
        "recipe: 1\nbase: ./inner.yaml\nattach: {a: {model: ./inner.yaml}}\n",
        inner__yaml="recipe: 1\nbase: ./robot.xml\n",
    )
    assert plan.base is not None and isinstance(plan.base.model, Plan) and isinstance(plan.parts[0].model, Plan)
    assert plan.base.model.name == "inner" and plan.base.model.base is not None


def test_the_same_recipe_twice_is_no_ring(tmp_path: Path) -> None:
    inner = "recipe: 1\nattach: {x: {model: ./core.yaml}, y: {model: ./core.yaml}}\n"
    plan = planned(
        tmp_path,
        "recipe: 1\nattach: {a: {model: ./inner.yaml}, b: {model: ./core.yaml}}\n",
        inner__yaml=inner,
        core__yaml="recipe: 1\n",
    )
    assert len(plan.parts) == 2


def test_a_ring_through_a_link_is_seen(tmp_path: Path) -> None:
    try:
        (tmp_path / "other.yaml").symlink_to("recipe.yaml")
    except OSError:
        pytest.skip("no links here")
    plan, context = tried(tmp_path, "recipe: 1\nbase: ./other.yaml\n")
    assert plan is None
    assert [each.code for each in context.sink.diagnostics] == ["source-cycle"]


@pytest.mark.parametrize("place", ["site: b/x", "body: b/x", "frame: b/x"])
def test_a_part_may_hang_on_a_later_one(tmp_path: Path, place: str) -> None:
    attach = f"attach:\n  a: {{model: ./robot.xml, {place}}}\n  b: {{model: ./robot.xml, %s}}\n"
    assert planned(tmp_path, "recipe: 1\n" + attach % "body: world")
    plan, context = tried(tmp_path, "recipe: 1\n" + attach % "site: a/y")
    assert plan is None and [each.code for each in context.sink.diagnostics] == ["attach-cycle"]


def test_a_ring_is_told_once_and_what_hangs_on_it_not(tmp_path: Path) -> None:
    parts = "".join(f"  {a}: {{model: ./robot.xml, site: {b}/x}}\n" for a, b in ("ab", "bc", "ca", "da", "ef", "fe"))
    plan, context = tried(tmp_path, f"recipe: 1\nattach:\n{parts}")
    assert plan is None
    assert [each.message for each in context.sink.diagnostics] == [
        "`a/` is attached to `b/`, which is attached to `c/`, which is attached to `a/`",
        "`e/` is attached to `f/`, which is attached to `e/`",
    ]


def test_faults_of_all_models_are_told_at_once(tmp_path: Path) -> None:
    plan, context = tried(
        tmp_path,
        "recipe: 1\nbase: ./a.xml\nattach: {x: {model: ./b.xml}, y: {model: ./inner.yaml}}\n",
        inner__yaml="recipe: 1\nbase: ./c.xml\n",
    )
    assert plan is None
    assert [str(each.span) for each in context.sink.sorted()] == [
        "inner.yaml:2:7",
        "recipe.yaml:2:7",
        "recipe.yaml:3:21",
    ]


URDF = "recipe: 1\nbase: {model: ./arm.urdf, packages: {arm: ./meshes}}\nattach: {a: {model: ./arm.urdf}}\n"


def test_packages_of_urdf(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    plan = planned(tmp_path, URDF, arm__urdf="<robot/>")
    assert plan.base is not None
    base = plan.base.model
    part = plan.parts[0].model
    assert isinstance(base, Source) and isinstance(part, Source)
    assert base.packages == (("arm", tmp_path / "meshes"),) and part.packages == ()


def test_packages_that_are_not_there(tmp_path: Path) -> None:
    plan, context = tried(tmp_path, URDF, arm__urdf="<robot/>")
    assert plan is None
    assert [(each.code, each.span and each.span.column) for each in context.sink.errors] == [("file-not-found", 43)]


def test_packages_of_a_recipe(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    text = URDF.replace("arm.urdf", "inner.yaml", 1)
    plan, context = tried(tmp_path, text, arm__urdf="<robot/>", inner__yaml="recipe: 1\n")
    assert plan is None
    assert [(each.code, each.span and each.span.column) for each in context.sink.errors] == [("unknown-key", 29)]


def test_urdf_is_said_to_be_converted(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    plan = planned(tmp_path, URDF, arm__urdf="<robot/>")
    assert "start from ./arm.urdf, URDF that MuJoCo converts" in describe(plan)
    assert as_data(plan)["parts"][0]["model"]["format"] == "urdf"


@pytest.mark.parametrize("key", ["base", "extends"])
def test_recipes_that_are_nested_too_deep(tmp_path: Path, key: str) -> None:
    for number in range(200):
        (tmp_path / f"{number}.yaml").write_text(f"recipe: 1\n{key}: ./{number + 1}.yaml\n")
    (tmp_path / "200.yaml").write_text("recipe: 1\n")
    context = Context(environment={}, folder=tmp_path)
    assert make_plan(tmp_path / "0.yaml", context) is None
    (found,) = context.sink.errors
    assert found.code == "limit-exceeded" and found.span is not None and "50" in found.message
    assert make_plan(tmp_path / "165.yaml", Context(environment={}, folder=tmp_path)) is not None
