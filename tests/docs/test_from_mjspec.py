"""docs/how-to/from_mjspec.md: each program makes the model of its recipe, and has as many lines as the page says.

The recipe of robosuite's `Lift` is built with small files in the places of robosuite's; `make foreign` builds it with
robosuite's own, and compares it with robosuite's model.
"""

from __future__ import annotations

import io
import os
import re
import runpy
import shutil
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml
from foreign.by_name import driven_apart
from foreign.merging import CLOSE
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.importing.recover import recover

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "how-to" / "from_mjspec.md").read_text(encoding="utf-8")
ROW = re.compile(r"\| \[\w+\]\(\.\./\.\./(.+?)\) \| (\d+) \| \[.+?\]\(\.\./(.+?)\) \| (\d+) \|")
JOBS = {
    Path(program).stem: (recipe, int(lines), program, int(more)) for recipe, lines, program, more in ROW.findall(PAGE)
}
CORPUS = Path(os.environ["MJCOMPOSE_CORPUS"], "models") if os.environ.get("MJCOMPOSE_CORPUS") else None
# The cell of a matrix that the program makes last.
CELLS = {"tools": "tools-hand-3kg-0.4m"}
# Bricks that touch exactly: the last bit of a pose decides how many contacts there are. They are compared without contacts.
TOUCHING = {"bimanual"}
# What MjSpec brings along of a scene of which one body is attached, and where files lie.
OTHERWISE = re.compile(r"_sizes|(mesh|mat|tex|numeric|bvh|oct)_\w+|names|names_map|name_\w+|paths|text_\w+")
needs_corpus = pytest.mark.skipif(CORPUS is None, reason="MJCOMPOSE_CORPUS names no corpus")


@pytest.fixture(autouse=True)
def robots(monkeypatch: pytest.MonkeyPatch) -> None:
    """The robots of the corpus, for the programs as for the recipes."""
    if CORPUS is not None:
        monkeypatch.setenv("MENAGERIE_ROOT", str(CORPUS))


def lines_of_recipe(text: str) -> int:
    return sum(bool(line.strip()) and not line.lstrip().startswith("#") for line in text.splitlines())


def lines_of_program(text: str) -> int:
    """Lines with code on them; a string that is a statement is a docstring."""
    nothing = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    lines: set[int] = set()
    fresh = True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in nothing and not (token.type == tokenize.STRING and fresh):
            lines.update(range(token.start[0], token.end[0] + 1))
        fresh = token.type in nothing
    return len(lines)


def test_there_are_six_and_each_recipe_is_shorter() -> None:
    assert len(JOBS) == 6
    for recipe, lines, program, more in JOBS.values():
        assert lines_of_recipe((ROOT / recipe).read_text()) == lines
        assert lines_of_program((ROOT / "docs" / program).read_text()) == more
        assert lines < more


def differing(a: mujoco.MjModel, b: mujoco.MjModel) -> Iterator[str]:
    """The arrays, options and names in which two models differ, but for their keys."""
    for name in dir(a):
        one = getattr(a, name)
        if not isinstance(one, np.ndarray) or OTHERWISE.fullmatch(name) or name.startswith("key_"):
            continue
        other = getattr(b, name)
        if one.shape != other.shape or not np.allclose(one, other, rtol=1e-6, atol=1e-8, equal_nan=True):
            yield name
    for name in dir(a.opt):
        if not name.startswith("_") and not np.array_equal(getattr(a.opt, name), getattr(b.opt, name)):
            yield f"option {name}"
    kinds = {
        "body": "nbody",
        "joint": "njnt",
        "geom": "ngeom",
        "site": "nsite",
        "camera": "ncam",
        "actuator": "nu",
        "sensor": "nsensor",
        "equality": "neq",
        "tendon": "ntendon",
    }
    for kind, count in kinds.items():
        names = [[getattr(model, kind)(i).name for i in range(getattr(model, count))] for model in (a, b)]
        if names[0] != names[1]:
            yield kind


def keys(model: mujoco.MjModel) -> dict[str, list[float]]:
    found = [model.key(i) for i in range(model.nkey)]
    return {key.name: [*np.round(key.qpos, 5), *np.round(key.ctrl, 5)] for key in found}


@needs_corpus
@pytest.mark.slow
@pytest.mark.parametrize("job", [job for job in JOBS if job != "merged"])
def test_both_make_the_same_model(job: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recipe, _, program, _ = JOBS[job]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "recipes").symlink_to(ROOT / "recipes")
    (tmp_path / "build").mkdir()
    by_program = runpy.run_path(str(ROOT / "docs" / program))["model"]
    context = Context(environment=dict(os.environ))
    values = {}
    if job in CELLS:
        from mjcompose.pipeline.cache.cells import cells_of, select_cell

        cell = select_cell(cells_of(ROOT / recipe, context), CELLS[job], None, context.sink, recipe)
        assert cell is not None
        values = cell.given
    built = build(ModelRequest(ROOT / recipe, given=values), context)
    assert built is not None, context.sink.diagnostics
    from mjcompose.bundle.write import write

    write(built.bundle, f"{tmp_path}/out/", environment={})
    by_recipe = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))
    assert list(differing(by_program, by_recipe)) == []
    if job in TOUCHING:
        for model in (by_program, by_recipe):
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert driven_apart(by_program, by_recipe, {}) <= CLOSE
    own = keys(by_program)
    shared = own.keys() & keys(by_recipe).keys()
    assert shared or not own
    assert all(own[name] == keys(by_recipe)[name] for name in shared)
    assert {"panda_allegro": "grasp", "tools": "ready"}.get(job, "home") in shared


@needs_corpus
@pytest.mark.slow
def test_the_merged_model_becomes_the_recipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recipe, _, program, _ = JOBS["merged"]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "build").mkdir()
    spec = runpy.run_path(str(ROOT / "docs" / program))["spec"]
    (tmp_path / "merged.xml").write_text(spec.to_xml())
    (tmp_path / "assets").mkdir()
    robots = {"universal_robots_ur5e/ur5e": "ur5e.xml", "robotiq_2f85/2f85": "2f85.xml"}
    for robot in robots:
        for file in (Path(str(CORPUS)) / robot).parent.glob("assets/*"):
            shutil.copy(file, tmp_path / "assets")
    parts = {Path(str(CORPUS)) / f"{robot}.xml": f"menagerie:{robot}" for robot in robots}
    found = recover(
        tmp_path / "merged.xml",
        list(parts),
        tmp_path / "merged.yaml",
        Context(environment=dict(os.environ)),
        references=parts,
    )
    assert found is not None and found.outcome is not None and found.outcome.same
    assert yaml.safe_load(found.text) == yaml.safe_load((ROOT / recipe).read_text())


LIFT = re.search(r'^```yaml title="lift.yaml"\n(.*?)^```', PAGE, re.DOTALL | re.MULTILINE)[1]  # type: ignore[index]
LIMBS = {
    "panda": ("joint2", "joint4", "joint6", "joint7"),
    "sawyer": ("right_j1", "right_j3", "right_j5", "right_j6"),
    "ur5e": (
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    ),
}
"""The joints that the recipe's keyframe names. They stand here in robots of a chain of bodies."""
VISUAL = '<geom type="box" size="0.4 0.4 0.4" contype="0" conaffinity="0" group="1"{}/>'
ARENA = f"""<mujoco><worldbody><camera name="frontview"/><body name="table" pos="0 0 0.4">
  <geom name="table_collision" type="box" size="0.4 0.4 0.4"/>{VISUAL.format(' name="table_visual"')}
  <site name="table_top" pos="0 0 0.4"/>
  {"".join(f'<geom name="table_leg{leg}_visual" type="cylinder" size="0.05 0.1" group="1"/>' for leg in range(1, 5))}
  </body></worldbody></mujoco>"""
MOUNT = """<mujoco><worldbody><body name="base" pos="0 0 -0.922"><geom name="foot" size="0.1" pos="0 0 -0.5"/></body></worldbody>
  </mujoco>"""
GRIPPER = f"""<mujoco><asset><mesh name="robotiq_arg2f_base_link" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
  <mesh name="robotiq_arg2f_base_link" file="meshes/robotiq_85_gripper/robotiq_arg2f_base_link_vis.stl"/></asset>
  <worldbody><body name="palm"><geom size="0.02"/>{VISUAL.format("")}<body name="finger">
  <joint name="finger" range="0 0.7"/><geom size="0.01"/></body></body></worldbody></mujoco>"""


def robot_of(joints: tuple[str, ...]) -> str:
    """A chain of one body for each joint; the second joint has settings of its own."""
    own = ' damping="0.001" frictionloss="0.01"'
    inner = '<body name="right_hand" pos="0 0 0.1"/>'
    for index, joint in reversed(list(enumerate(joints))):
        inner = f"""<body name="link{index}" pos="0 0 0.1"><joint name="{joint}" range="-3 3"{own if index == 1 else ""}/>
          <geom size="0.05"/>{inner}</body>"""
    return f'<mujoco><compiler angle="radian"/><worldbody><body name="base">{inner}</body></worldbody></mujoco>'


def write_package(folder: Path) -> None:
    """A package `robosuite` with small files in the places of the large ones."""
    assets = folder / "robosuite" / "models" / "assets"
    files = {"arenas/table_arena.xml": ARENA, "bases/rethink_mount.xml": MOUNT}
    files |= {f"robots/{robot}/robot.xml": robot_of(joints) for robot, joints in LIMBS.items()}
    once = re.sub(r"<mesh name=\S+ file=.*?/>", "", GRIPPER)
    files |= {f"grippers/{name}.xml": once for name in ("panda_gripper", "rethink_gripper")}
    files["grippers/robotiq_gripper_85.xml"] = GRIPPER
    for name, text in files.items():
        path = assets / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (folder / "robosuite" / "__init__.py").touch()


def built(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """`mjcompose build lift.yaml` in a folder with the package; the parts have no license."""
    (folder / "lift.yaml").write_text(f"{LIFT}allow: [license-missing]\n", encoding="utf-8")
    command = [sys.executable, "-m", "mjcompose", "build", "lift.yaml", *words]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.mark.parametrize(
    ("robot", "gripper"), [("panda", "panda_gripper"), ("sawyer", "rethink_gripper"), ("ur5e", "robotiq_gripper_85")]
)
def test_the_recipe_of_lift_does_what_robosuite_does(robot: str, gripper: str, tmp_path: Path) -> None:
    write_package(tmp_path)
    ran = built(tmp_path, "--set", f"robot={robot}", "--set", f"gripper={gripper}", "-o", "out/")
    assert ran.returncode == 0, ran.stderr
    (path,) = tmp_path.rglob("model.xml")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    # A table of 0.8 × 0.8 × 0.05 m whose top is at 0.8 m; what one only sees has no mass.
    assert data.site("table_top").xpos == pytest.approx([0, 0, 0.8])
    assert model.body("table").mass[0] == pytest.approx(1000 * 0.8 * 0.8 * 0.05)
    assert model.body("gripper0_right_palm").mass[0] == pytest.approx(1000 * 4 / 3 * np.pi * 0.02**3)
    # The first body of the mount is 1 cm above the robot's base, which is at 0.912 m.
    assert data.body("robot0_base").xpos == pytest.approx([-0.56, 0, 0.912])
    assert data.body("fixed_mount0_base").xpos == pytest.approx([-0.56, 0, 0.922])
    for index, joint in enumerate(LIMBS[robot]):
        dof = model.joint(f"robot0_{joint}").dofadr[0]
        assert model.dof_armature[dof] == pytest.approx(5 / (index + 1))
        assert model.dof_damping[dof] == pytest.approx(0.001 if index == 1 else 0.1)
        assert model.dof_frictionloss[dof] == pytest.approx(0.01 if index == 1 else 0.1)
    assert model.joint("gripper0_right_finger").range == pytest.approx([0, 0.7])
    assert data.body("cube_main").xpos == pytest.approx([0, 0, 0.821])
    assert (model.opt.impratio, model.opt.density, model.opt.viscosity) == (20, 1.2, 2e-5)


def test_a_file_and_a_mapping_make_one_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "recipes", "recipes")
    blocks = dict(re.findall(r'^```\w+ title="(row\.\w+)"\n(.*?)^```', PAGE, re.MULTILINE | re.DOTALL))
    for name, text in blocks.items():
        Path(name).write_text(text)
    runpy.run_path("row.py")
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 3 and len(set(printed)) == 1 and printed[0] in PAGE
