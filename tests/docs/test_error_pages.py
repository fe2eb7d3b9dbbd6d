"""The pages of the errors keep their word: the example has that error and no other, what mends it builds.

Recipes of a page name models such as `./arm.xml`; those they find here. A block of a page is a recipe if it
begins with `recipe:` (after a comment, maybe), a model if it begins with `<`, a session if it begins with `$`.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from mjcompose.mujoco.engine import RequestLimits
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ROOT = Path(__file__).resolve().parents[2]
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "docs" / "errors").glob("*.md")}
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)

PROP = '<mujoco><worldbody><body name="{}" {}>{}<geom size="0.05"/></body></worldbody></mujoco>'
ARM = """\
<mujoco>{}
  <worldbody>
    <body name="base">
      <geom size="0.1"/>
      <body name="link" pos="0 0 0.5">
        <joint name="elbow" axis="0 1 0"/>
        <geom size="0.1"/>
        <site name="mount"/>
        <site name="flange" pos="0 0 0.1"/>
      </body>
    </body>
  </worldbody>
  {}
</mujoco>
"""
CUT = """\
<mujoco>
  <worldbody>
    <body name="forearm">
      <geom size="0.1"/>
      <body name="hand">
        <geom size="0.1"/>
      </body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="forearm" body2="hand"/>
  </contact>
</mujoco>
"""
LAMPS = """\
<mujoco>
  <worldbody>
    <body name="rail"><joint/><geom size="0.1"/></body>
    <replicate count="3" offset="1 0 0"><body name="lamp"><joint/><geom size="0.1"/></body></replicate>
  </worldbody>
  <equality><connect name="hang" body1="lamp" body2="rail" anchor="0 0 .3"/></equality>
</mujoco>
"""
CLASSES = "<default><default class='visual'/><default class='collision'/></default>"
HOME = "<keyframe><key name='home' time='{}' qpos='0.1'/></keyframe>"
SCENE = PROP.format("palm", "", "").replace("<worldbody>", '<worldbody><geom name="floor" type="plane" size="1 1 1"/>')

MODELS = {
    "arm.xml": ARM.format("", ""),
    "gripper.xml": PROP.format("gripper", "", ""),
    "gripper/scene.xml": SCENE,
    "gripper/gripper.xml": PROP.format("palm", "", ""),
    "camera.xml": PROP.format("camera", "", ""),
    "table.xml": PROP.format("table", "", ""),
    "mug.xml": PROP.format("mug", "", "<freejoint/>"),
    "target.xml": PROP.format("target", 'mocap="true"', ""),
    "mobile_base.xml": PROP.format("cart", "", ""),
    "gripper.yaml": "recipe: 1\nbase: ./gripper.xml\n",
    "hand.yaml": "recipe: 1\nbase: ./gripper.xml\n",
    "parts/arm.xml": "<mujocoinclude/>",
    "meshes/bracket.stl": "",
    "robot.urdf": '<robot name="robot"><link name="base"/></robot>',
}
"""What the recipes of every page find beside them."""

WEIGHED = """\
<mujoco>
  <asset><mesh name="link" builtin="sphere" params="3" scale="0.1 0.1 0.1"/></asset>
  <worldbody><body><geom type="mesh" mesh="link"/></body></worldbody>
</mujoco>
"""
SERVO = '<actuator><position name="elbow" joint="elbow" kp="100" kv="10" forcerange="-50 50"/></actuator>'
MODELS_OF = {
    **{code: {"arm.xml": ARM.format("", SERVO)} for code in ("convert-loss", "still-referred-to")},
    "class-clash": {
        "arm.xml": ARM.format(CLASSES, ""),
        "tool.xml": ARM.format(CLASSES, "").replace('name="', 'name="t_'),
    },
    "compiler-unused": {"arm.xml": ARM.format('<compiler angle="degree"/>', "")},
    "keyframe-conflict": {
        "arm.xml": ARM.format("", HOME.format(1)),
        "gripper.xml": ARM.format("", HOME.format(1.5)),
    },
    "mass-rule": {"hand.xml": ARM.format('<compiler boundmass="0.001" boundinertia="0.0001"/>', "")},
    "mirror": {"bent_arm.xml": ARM.format("", "").replace('name="link" pos="0 0 0.5"', 'name="link" pos="0 0.02 0.5"')},
    "mesh-unusable": {"arm.xml": WEIGHED},
    "name-clash": {"arm.xml": PROP.format("table", "", "")},
    "not-as-written": {"lamps.xml": LAMPS},
    "not-held": {"arm.xml": ARM.format("", '<actuator><motor name="shoulder" joint="elbow"/></actuator>')},
    "option-conflict": {
        "arm.xml": ARM.format('<option timestep="0.002"/>', ""),
        "gripper.xml": PROP.format("palm", "", "").replace("<mujoco>", '<mujoco><option timestep="0.001"/>'),
    },
    "subtree-cut": {"arm.xml": CUT},
    "separator-mismatch": {"hand.yaml": "recipe: 1\nattach:\n  finger: {model: ./gripper.xml}\n"},
    "source-cycle": {"finger.yaml": "recipe: 1\nattach:\n  hand: {model: ./page.yaml}\n"},
}

NOT_A_BUILD = {
    **dict.fromkeys(
        ("archive-refused", "source-changed", "source-fetch", "source-offline", "source-outside", "source-revision"),
        "needs a host that answers: tests/sources",
    ),
    **dict.fromkeys(
        ("extension-broken", "extension-clash", "extension-refused"),
        "needs a package: tests/docs/test_extending_packages.py",
    ),
    **dict.fromkeys(("lock-invalid", "lock-stale", "store-unusable"), "needs a lock or a store: tests/cli"),
    "csv-syntax": "needs a file of values: tests/cli/test_tables.py",
    "interface-changed": "needs a lock: tests/tools/test_lock_interface.py",
    **dict.fromkeys(
        ("bundle-changed", "bundle-manifest", "keyframe-wrong", "part-changed", "part-not-compared"), "tests/verify"
    ),
    **dict.fromkeys(
        ("cluster-missing", "cluster-unreachable", "cluster-worker"), "need a cluster: tests/tools/cluster"
    ),
    **dict.fromkeys(
        ("not-a-world", "not-installed", "not-per-world", "worlds-padded"), "is not about a build: tests/tools/worlds"
    ),
    "output-full": "needs a disk that is full: tests/kills",
    **dict.fromkeys(
        ("migrate-cannot", "migrate-changed", "migrate-differs", "migrate-python", "migrate-version"),
        "of `mjcompose migrate`: tests/tools/migrate, tests/cli/test_migrate.py",
    ),
    **dict.fromkeys(("target-cannot", "target-failed", "target-loss"), "needs `--target`: tests/targets"),
    **dict.fromkeys(
        ("mesh-look", "mesh-shape", "mesh-size", "mesh-unreadable", "xacro"), "needs files beside it: tests/urdf"
    ),
    **dict.fromkeys(("measured-format", "measured-stale"), "needs a file of measurements: tests/errors/measured"),
    **dict.fromkeys(
        (
            "errors-not-noise",
            "held-out",
            "not-identifiable",
            "recording-column",
            "recording-kind",
            "recording-sign",
            "recording-time",
            "recording-unit",
            "recording-value",
            "worse-than-recipe",
        ),
        "of `mjcompose identify`: tests/tools/identify",
    ),
    "cells-not-checked": "is a note of `check`: tests/cli/test_check.py",
    "git-revision": "needs a repository: tests/sides",
    "not-missing": "of `explain --why-not`: tests/trace/test_absence.py",
    "no-rendering": "needs a machine without OpenGL: tests/tools/diff",
    "no-server": "needs a port that is taken: tests/tools/view/test_live.py",
    "unstable": "needs OpenGL: tests/cli/test_render.py",
    "no-video": "needs a machine without an encoder: tests/cli/test_render.py",
    "cannot-format": "is not about a build: tests/text",
    "mesh-tools-missing": "needs to be without the extra `mesh`: tests/mujoco/test_fit.py",
    "mujoco-crash": "a model that crashes one MuJoCo is refused by another",
    "mujoco-timeout": "takes long by its nature",
    "mujoco-warning": "not every MuJoCo warns",
    "yaml-not-utf8": "the example shows a byte that no page can hold",
    "yaml-too-large": "the example says that it is cut short",
}
"""Pages whose example is looked at elsewhere."""


def blocks(text: str, kind: str) -> list[str]:
    return [content for language, content in BLOCK.findall(text) if language == kind]


def parts(code: str) -> tuple[str, str]:
    example, mended = PAGES[code].split("## How to fix it")
    return example.split("## Example")[1], mended


def lay_out(code: str, folder: Path) -> None:
    for name, text in {**MODELS, **MODELS_OF.get(code, {})}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


def codes(text: str, code: str, folder: Path, menagerie: Path) -> set[str]:
    recipe = folder / "page.yaml"
    if text.startswith("<"):
        model = "page.urdf" if text.startswith("<robot") else "page.xml"
        (folder / model).write_text(text, encoding="utf-8")
        text = f"recipe: 1\nbase: ./{model}\n"
    recipe.write_text(text, encoding="utf-8")
    context = Context(folder=folder, environment={**os.environ, "MENAGERIE_ROOT": str(menagerie)})
    request = ModelRequest(recipe, worlds=code == "draw-at-run-time")
    build(request, context, limits=RequestLimits(seconds=60))
    return {found.code for found in context.sink.diagnostics}


EXAMPLES = [
    (code, text)
    for code in sorted(set(PAGES) - set(NOT_A_BUILD))
    for text in blocks(parts(code)[0], "yaml") or blocks(parts(code)[0], "xml")
]
MENDED = [
    (code, text)
    for code in sorted(PAGES)
    for text in blocks(parts(code)[1], "yaml") + blocks(parts(code)[1], "xml")
    if re.match(r"(#.*\n)*recipe:|<mujoco>", text)
]
SESSIONS = [(code, text) for code in sorted(set(PAGES) - set(NOT_A_BUILD)) for text in blocks(parts(code)[0], "sh")]


@pytest.mark.parametrize(("code", "text"), EXAMPLES, ids=[code for code, _ in EXAMPLES])
def test_the_example_has_the_error_and_no_other(code: str, text: str, tmp_path: Path, menagerie_root: Path) -> None:
    lay_out(code, tmp_path)
    assert codes(text, code, tmp_path, menagerie_root) == {code}


@pytest.mark.parametrize(("code", "text"), MENDED, ids=[code for code, _ in MENDED])
def test_what_mends_it_builds(code: str, text: str, tmp_path: Path, menagerie_root: Path) -> None:
    lay_out(code, tmp_path)
    assert codes(text, code, tmp_path, menagerie_root) == set()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="the sessions are of a POSIX shell")
@pytest.mark.parametrize(("code", "text"), SESSIONS, ids=[code for code, _ in SESSIONS])
def test_a_session_ends_with_the_error(code: str, text: str, tmp_path: Path) -> None:
    if "chmod" in text and os.geteuid() == 0:
        pytest.skip("who runs this may read everything")
    if code == "usd-loss" or (code == "usd-missing" and find_spec("mujoco_usd_converter") is not None):
        pytest.skip("depends on the converter to USD")
    if code == "worker-died":
        pytest.skip("needs a machine with little memory")
    if code == "mujoco-missing":
        pytest.skip("needs an environment without MuJoCo")
    (tmp_path / "recipes").mkdir()
    (tmp_path / "models").mkdir()
    for name in ("recipe.yaml", "recipes/arm.yaml"):
        (tmp_path / name).write_text("recipe: 1\nbase: ./models/arm.xml\n")
    license = "<!-- SPDX-License-Identifier: CC0-1.0 -->\n"
    text_of_arm = MODELS["arm.xml"] if code == "license-missing" else license + MODELS["arm.xml"]
    (tmp_path / "models" / "arm.xml").write_text(text_of_arm)
    script = f'mjcompose() {{ {shlex.quote(sys.executable)} -m mjcompose "$@"; }}\n'
    script += "".join(line[2:] for line in text.splitlines(keepends=True) if line.startswith("$ "))
    result = subprocess.run(
        ["sh", "-c", script],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert re.findall(r"(?:error|warning)\[([\w-]+)\]", result.stderr) == [code]


def test_few_pages_have_no_example_that_is_tried() -> None:
    tried = {code for code, _ in EXAMPLES} | {code for code, _ in SESSIONS} | set(NOT_A_BUILD)
    assert set(PAGES) - tried == {"yaml-too-deep"}
