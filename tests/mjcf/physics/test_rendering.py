from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError

_SCENE = """
import numpy as np
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError
model = mjcf.from_xml_string('''
<mujoco><visual><global offwidth="64" offheight="64"/></visual><worldbody><light pos="0 0 5"/>
  <camera name="top" pos="0 0 3"/><camera name="away" pos="0 0 3" xyaxes="1 0 0 0 -1 0"/>
  <body name="ball"><joint name="x" type="slide" axis="1 0 0"/><geom size="0.5" rgba="1 0 0 1"/></body></worldbody></mujoco>''')
physics = model.compile_model()
"""


_PROBE = "import mujoco; mujoco.Renderer(mujoco.MjModel.from_xml_string('<mujoco/>'), 8, 8)"


@pytest.fixture(scope="module")
def run(repository: Path) -> Callable[[str], str]:
    """Runs code in a process that renders by EGL, and gives what it prints."""

    def python(code: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "MUJOCO_GL": "egl", "PYTHONPATH": str(repository)}
        return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)

    if python(_PROBE).returncode != 0:
        pytest.skip("MuJoCo cannot render by EGL here")

    def run(code: str) -> str:
        done = python(_SCENE + code)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def test_a_picture_shows_the_state(run: Callable[[str], str]) -> None:
    code = """
seen = physics.render(90, 120, 'top')
assert seen.shape == (90, 120, 3) and seen.dtype == np.uint8
assert (seen == physics.render(90, 120, 0)).all() and (seen == physics.render(90, 120, model.find('camera', 'top'))).all()
assert not physics.render(90, 120, 'away').any()
assert physics.render().shape == (240, 320, 3)
assert physics.model.vis.global_.offwidth == 64
red = lambda picture: np.nonzero(picture[:, :, 0] > 40)[1].mean()
before = red(seen)
physics.bind(model.find('joint', 'x')).qpos = 0.5
physics.forward()
print(red(physics.render(90, 120, 'top')) - before > 5)
"""
    assert run(code).strip() == "True"


def test_a_camera_that_is_not_there(run: Callable[[str], str]) -> None:
    code = """
try:
    physics.render(10, 10, 'topp')
except MjcfError as error:
    print(error)
try:
    physics.render(0, 10)
except MjcfError as error:
    print(error)
"""
    told = run(code)
    assert "the compiled model has no camera `topp`" in told and "did you mean `top`?" in told
    assert "`height` is a number of pixels, got `0`" in told


def test_without_opengl_it_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_display(*size: object) -> None:
        raise RuntimeError("no display")

    monkeypatch.setattr(mujoco, "Renderer", no_display)
    physics = mjcf.RootElement().compile_model()
    with pytest.raises(MjcfError, match="OpenGL is not available for rendering: no display") as caught:
        physics.render(10, 2000)
    assert "MUJOCO_GL=egl" in str(caught.value.diagnostics[0].help)
    assert physics.model.vis.global_.offwidth == 640


def test_a_picture_that_is_too_large_is_told_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_large(*size: object) -> None:
        raise RuntimeError("Offscreen framebuffer is not complete, error 0x8cd6")

    monkeypatch.setattr(mujoco, "Renderer", too_large)
    with pytest.raises(MjcfError, match="OpenGL has no room for a picture of 200000 times 100000 pixels"):
        mjcf.RootElement().compile_model().render(100_000, 200_000)
