"""From a recipe and recordings to a file of measurements that the recipe uses: the whole way, by the command."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.identify import identify as module
from mjcompose.tools.identify.identify import FitRequest, identify, plan_fit
from tools.identify import robots

TRUTH = {"damping": 0.9, "armature": 0.08, "friction": 0.25, "kp": 24.0}
FIELDS = """
    friction: {select: {joint: elbow}, attr: frictionloss, range: [0, 2]}
    damping: {select: {joint: elbow}, attr: damping, range: [0, 5]}
    rotor: {select: {joint: elbow}, attr: armature, range: [0, 0.5]}
    gain: {select: {actuator: elbow}, attr: kp, scale: [0.5, 2]}
"""
NAMES = {"friction": "frictionloss", "kp": "kp", "damping": "damping", "armature": "armature"}


def lay(folder: Path, fields: str, **model: float) -> Path:
    (folder / "arm.xml").write_text(robots.MODEL.format(**{**robots.RECIPE, **model}))
    recipe = folder / "arm.yaml"
    recipe.write_text(f"recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nidentify:\n  fields:{fields}")
    return recipe


def fitted(recipe: Path, *recordings: Path, held_out: tuple[Path, ...] = ()) -> tuple[Any, Context]:
    context = Context(folder=recipe.parent)
    request = FitRequest(recipe, recordings, held_out, name="A12")
    return identify(request, context, lambda _: None), context


def told(folder: Path, fields: str) -> list[str]:
    recipe = lay(folder, fields)
    run = robots.write_csv(folder / "run.csv", robots.recorded(robots.model(), 0.6))
    fit, context = fitted(recipe, run)
    assert fit is None
    return [f"{error.span.line if error.span else None} {error.code}: {error.message}" for error in context.sink.errors]


@pytest.mark.slow
def test_a_robot_is_measured_and_its_file_is_used(tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    robot = robots.model(**TRUTH)
    first = robots.write_csv(tmp_path / "run1.csv", robots.recorded(robot, 2.0, seed=1))
    second = robots.write_csv(tmp_path / "run2.csv", robots.recorded(robot, 1.0, seed=2))
    fit, context = fitted(recipe, first, held_out=(second,))
    assert fit is not None, context.sink.diagnostics
    for number in fit.data["numbers"]:
        truth = next(TRUTH[key] for key, name in NAMES.items() if name == number["attribute"])
        assert abs(number["value"] - truth) < 4 * number["std"], number
        assert number["std"] < 0.2 * truth, number
    for error in fit.data["errors"]:
        assert error["held_out"]["fitted"] < 1.3 * 2e-4
    (tmp_path / "A12.yaml").write_text(fit.text)
    assert yaml.safe_load(fit.text)["recordings"][1]["used"] == "held out"
    use = tmp_path / "use.yaml"
    use.write_text("recipe: 1\nextends: ./arm.yaml\nmeasured: A12.yaml\n")
    context = Context(folder=tmp_path)
    built = build(ModelRequest(use), context)
    assert built is not None, context.sink.diagnostics
    assert context.sink.diagnostics == []
    model = mujoco.MjModel.from_xml_string(built.bundle.files[built.bundle.model].decode())
    values = {number["attribute"]: number["value"] for number in fit.data["numbers"]}
    assert model.joint("elbow").damping[0] == pytest.approx(values["damping"], rel=1e-3)
    (tmp_path / "arm.xml").write_text(robots.MODEL.format(**{**robots.RECIPE, "mass": 0.505}))
    stale = Context(folder=tmp_path)
    assert build(ModelRequest(use), stale) is None
    assert [error.code for error in stale.sink.errors] == ["measured-stale"]


KEYS = """
  recording: {command: /commands, command_joints: [shoulder, elbow], episode: 1}
  fields:
    damping: {select: {joint: elbow}, attr: damping, range: [0, 5]}
    gain: {select: {actuator: elbow}, attr: kp, scale: [0.5, 2]}
"""


@pytest.mark.slow
def test_the_fit_is_the_same_in_every_format(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    pytest.importorskip("mcap_ros2", reason="mcap-ros2-support is not installed")
    recipe = lay(tmp_path, "")
    recipe.write_text(f"recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nidentify:{KEYS}")
    columns = {
        name: values if name == "time" else values.astype(np.float32).astype(float)  # as LeRobot stores them
        for name, values in robots.recorded(robots.model(damping=0.9, kp=24), 1.0).items()
    }
    recordings = [
        robots.write_csv(tmp_path / "run.csv", columns),
        robots.write_npz(tmp_path / "run.npz", columns),
        robots.write_parquet(tmp_path / "run.parquet", columns),
        robots.write_mcap(tmp_path / "run.mcap", columns),
        robots.write_lerobot(tmp_path / "set", columns),
    ]
    fits = []
    for recording in recordings:
        fit, context = fitted(recipe, recording)
        assert fit is not None, context.sink.diagnostics
        fits.append(fit.data["numbers"])
    for numbers in fits[1:]:
        for first, other in zip(fits[0], numbers, strict=True):
            assert abs(first["value"] - other["value"]) < 0.01 * first["std"], (first, other)


def test_the_zero_of_a_joint_is_fitted(tmp_path: Path) -> None:
    recipe = lay(tmp_path, "\n    zero: {select: {joint: elbow}, zero: [-3deg, 3deg]}\n")
    columns = robots.recorded(robots.model(), 1.5)
    for name in ("qpos elbow", "ctrl elbow"):
        columns[name] = columns[name] + 0.03
    fit, context = fitted(recipe, robots.write_csv(tmp_path / "run.csv", columns))
    assert fit is not None, context.sink.diagnostics
    (number,) = fit.data["numbers"]
    assert number["value"] == pytest.approx(0.03, abs=0.003)
    assert abs(number["value"] - 0.03) < 4 * number["std"]


def test_a_robot_without_actuators(tmp_path: Path) -> None:
    (tmp_path / "pendulum.xml").write_text(
        """<mujoco model="pendulum"><worldbody><body name="link"><joint name="hinge" axis="0 1 0" range="-90 90"/>
        <geom size=".02" pos="0 0 -.3" mass="1"/></body></worldbody></mujoco>"""
    )
    recipe = tmp_path / "pendulum.yaml"
    field = "{select: {joint: hinge}, attr: damping, range: [0, 1]}"
    recipe.write_text(f"recipe: 1\nbase: ./pendulum.xml\nidentify: {{fields: {{damping: {field}}}}}\n")
    robot = mujoco.MjModel.from_xml_string(
        (tmp_path / "pendulum.xml").read_text().replace('axis="0 1 0"', 'axis="0 1 0" damping="0.1"')
    )
    state = mujoco.MjData(robot)
    state.qpos[0] = 0.5
    rows = ["time,qpos hinge"]
    for _ in range(500):
        mujoco.mj_step(robot, state)
        rows.append(f"{state.time:.4f},{state.qpos[0]:.7f}")
    run = tmp_path / "run.csv"
    run.write_text("\n".join(rows) + "\n")
    fit, context = fitted(recipe, run)
    assert fit is not None, context.sink.diagnostics
    assert fit.data["numbers"][0]["value"] == pytest.approx(0.1, abs=0.01)


def test_a_plan_says_what_a_recording_can_tell(tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    moving = robots.write_csv(tmp_path / "moving.csv", robots.recorded(robots.model(), 1.0))
    still = robots.write_csv(tmp_path / "still.csv", robots.recorded(robots.model(), 1.0, size=0.0))

    def plan(run: Path) -> dict[str, dict[str, Any]]:
        context = Context(folder=tmp_path)
        numbers = plan_fit(FitRequest(recipe, (run,)), context, lambda _: None)
        assert numbers is not None, context.sink.diagnostics
        return {number["attribute"]: number for number in numbers}

    of_moving = plan(moving)
    of_still = plan(still)
    assert not of_moving["damping"]["little"]
    assert of_still["armature"]["std"] > 5 * of_moving["armature"]["std"]


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ("{a: {select: {joint: elbw}, attr: damping, range: [0, 5]}}", "5 selector: `{joint: elbw}` selects nothing"),
        ("{a: {select: {joint: elbow}, attr: damping}}", "5 missing-key: field `a` of `identify` has no `range`"),
        (
            "{a: {select: {joint: elbow}, attr: damping, range: [5, 0]}}",
            "5 out-of-range: `range` of field `a` starts with 5, which is more than 0",
        ),
        (
            "{a: {select: {joint: elbow}, attr: damping, range: [5, 9]}}",
            "5 out-of-range: field `a` of `identify`: damping of joint `elbow` is 0.5 in the recipe, outside of [5, 9]",
        ),
        (
            "{a: {select: {joint: elbow}, attr: frictionloss, scale: [0.5, 2]}}",
            "5 out-of-range: field `a` of `identify`: frictionloss of joint `elbow` cannot be between 0 and 0",
        ),
        (
            '{a: {select: {joint: elbow}, attr: damping, range: [0, 5]}, b: {select: {joint: "*"}, attr: damping, range: [0, 5]}}',
            "5 name-clash: field `b` of `identify`: field `a` has damping of joint `elbow`, too",
        ),
        (
            "{a: {select: {body: base}, inertia: mass, scale: [0.5, 2]}}",
            "5 not-identifiable: field `a` of `identify`: body `base` is fixed to the world, so its inertia moves nothing",
        ),
        (
            "{a: {select: {joint: elbow}, delay: [0, 60ms]}}",
            "5 not-identifiable: joint `elbow` has no `delay` that could be fitted",
        ),
        (
            "{a: {select: {joint: elbow}, delay: [0, 5 parsecs]}}",
            "5 wrong-type: ",
        ),
        (
            "{a: {select: {joint: elbow}, attr: axis, range: [0, 5], delay: [0, 1]}}",
            "5 wrong-type: field `a` of `identify` has both `attr` and `delay`, of which only one is allowed",
        ),
        (
            "{a: {select: {joint: elbow}, zero: [-3deg, 3deg], range: [0, 5]}}",
            "5 unknown-key: `zero` has its range already, so `range` has no meaning",
        ),
    ],
)
def test_a_wrong_field(fields: str, expected: str, tmp_path: Path) -> None:
    found = told(tmp_path, f" {fields}\n")
    assert len(found) == 1, found
    assert found[0].startswith(expected)


def test_a_recipe_without_the_section(tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    recipe.write_text(re.sub(r"identify:.*", "", recipe.read_text(), flags=re.DOTALL))
    run = robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(), 0.6))
    fit, context = fitted(recipe, run)
    assert (fit, [error.code for error in context.sink.errors]) == (None, ["missing-key"])


def test_a_fault_of_a_recording_has_its_line(tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    run = tmp_path / "run.csv"
    run.write_text("time,qpos elbow\n0,0\n0.1,0.1\n0.2,much\n")
    fit, context = fitted(recipe, run)
    (error,) = context.sink.errors
    assert fit is None
    assert (error.code, error.span.file, error.span.line) == ("recording-value", "run.csv", 4)


def test_a_fault_of_an_npz_has_the_place_of_the_keys_that_read_it(tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    columns = robots.recorded(robots.model(), 0.6)
    columns["qpos elbw"] = columns.pop("qpos elbow")
    fit, context = fitted(recipe, robots.write_npz(tmp_path / "run.npz", columns))
    (error,) = context.sink.errors
    assert fit is None
    assert (error.code, error.span.file, error.span.line) == ("recording-column", "arm.yaml", 4)
    assert error.message.startswith("`run.npz`: ")


@pytest.mark.parametrize(
    ("keys", "place", "help"),
    [
        ("start: hom", (5, 3), "did you mean `home`?"),
        ("recording: {sign: {elbw: -1}}", (5, 22), "did you mean `elbow`?"),
    ],
)
def test_a_wrong_key_has_its_place(keys: str, place: tuple[int, int], help: str, tmp_path: Path) -> None:
    recipe = lay(tmp_path, FIELDS)
    key = '<keyframe><key name="home" qpos="0 0"/></keyframe></mujoco>'
    (tmp_path / "arm.xml").write_text((tmp_path / "arm.xml").read_text().replace("</mujoco>", key))
    recipe.write_text(recipe.read_text().replace("identify:\n", f"identify:\n  {keys}\n"))
    run = robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(), 0.6))
    _, context = fitted(recipe, run)
    (error,) = context.sink.errors
    assert (error.span.file, error.span.line, error.span.column) == ("arm.yaml", *place)
    assert error.help == help


@pytest.mark.parametrize(
    ("crash", "code", "help"),
    [
        ("timeout", "mujoco-timeout", "give the fit more time: `--timeout 1200`"),
        ("memory", "mujoco-crash", "cut the recordings into shorter ones"),
        ("signal 11", "mujoco-crash", "narrow the ranges"),
    ],
)
def test_a_fit_that_mujoco_does_not_finish_says_what_helps(
    crash: str, code: str, help: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer = SimpleNamespace(ok=False, crash=crash, error="it ended")
    monkeypatch.setattr(module, "engine", SimpleNamespace(call=lambda *_, **__: answer))
    recipe = lay(tmp_path, FIELDS)
    run = robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(), 0.6))
    fit, context = fitted(recipe, run)
    (error,) = context.sink.errors
    assert fit is None
    assert (error.code, help in str(error.help)) == (code, True)
