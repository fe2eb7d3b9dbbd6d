"""Whatever MuJoCo draws, the page draws at the same pixels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

WIDTH = 320
HEIGHT = 240
MODEL = """<mujoco>
  <asset>{assets}</asset>
  <worldbody>
    <light pos="0 0 4"/>
    <camera name="eye" pos="1.4 -1.6 1.1" xyaxes="0.75 0.66 0 -0.3 0.34 0.89" fovy="40"/>
    {bodies}
  </worldbody>
  {more}
</mujoco>
"""
TURNED = 'euler="20 -35 50"'
MOVED = '<body pos="0.1 0.05 -0.1" euler="10 20 30"><joint axis="1 1 0" ref="0.2"/>{}</body>'
GROUND = "".join(f"{(abs(row - 4) + column % 3) / 7:.3f} " for row in range(9) for column in range(12))
TENT = 'vertex="0 0 0.5  0.4 0.1 0  -0.3 0.4 0  -0.2 -0.4 0" face="0 1 2  0 2 3  0 3 1  1 3 2"'
BONE = '<bone body="{}" bindpos="0 0 {}" bindquat="1 0 0 0" vertid="{}" vertweight="{}"/>'
SKIN = (
    '<deformable><skin vertex="-0.3 0 -0.3  0.3 0 -0.3  0.3 0.1 0.3  -0.3 0.1 0.3" face="0 1 2  0 2 3  0 2 1  0 3 2">'
    + BONE.format("low", -0.3, "0 1 2 3", "1 1 0.3 0.3")
    + BONE.format("high", 0.3, "2 3", "0.7 0.7")
    + "</skin></deformable>"
)
BODIES = (
    '<body name="low" pos="0 0 -0.3"><joint/><geom size="0.01"/></body>'
    '<body name="high" pos="0.2 0.1 0.4" euler="0 25 0"><joint/><geom size="0.01"/></body>'
)
SITES = '<site name="{}" pos="{}" size="0.03"/>'
WAY = SITES.format("a", "-0.4 0 0.3") + SITES.format("b", "0.4 0 0.3") + SITES.format("c", "0.4 0 -0.4")
FLEX = '<body name="holder" pos="0 0 0" euler="60 0 20"><flexcomp name="f" type="grid" {} mass="1"><edge equality="true"/></flexcomp></body>'

CASES = {
    "sphere": ("", MOVED.format('<geom size="0.4" pos="0.1 0 0"/>'), ""),
    "capsule": ("", MOVED.format(f'<geom type="capsule" size="0.15 0.3" {TURNED}/>'), ""),
    "ellipsoid": ("", MOVED.format(f'<geom type="ellipsoid" size="0.4 0.2 0.1" {TURNED}/>'), ""),
    "cylinder": ("", MOVED.format(f'<geom type="cylinder" size="0.25 0.3" {TURNED}/>'), ""),
    "box": ("", MOVED.format(f'<geom type="box" size="0.4 0.2 0.1" {TURNED}/>'), ""),
    "plane": ("", f'<geom type="plane" size="0.5 0.3 1" {TURNED}/>', ""),
    "mesh": (f'<mesh name="m" {TENT}/>', MOVED.format(f'<geom type="mesh" mesh="m" {TURNED}/>'), ""),
    "hfield": (
        f'<hfield name="h" nrow="9" ncol="12" size="0.5 0.35 0.3 0.1" elevation="{GROUND}"/>',
        '<geom type="hfield" hfield="h" euler="0 0 25"/>',
        "",
    ),
    "site": ("", MOVED.format(f'<geom size="0.01"/><site type="box" size="0.3 0.2 0.1" {TURNED}/>'), ""),
    "texture": (
        ('<texture name="t" type="2d" builtin="checker" rgb1="1 1 1" rgb2="0 0 1" width="64" height="64"/>'
         '<material name="t" texture="t" texrepeat="3 3"/>'),
        MOVED.format(f'<geom type="box" size="0.4 0.2 0.1" material="t" {TURNED}/>'),
        "",
    ),
    "skin": ("", BODIES, SKIN),
    "cloth": ("", FLEX.format('dim="2" count="6 5 1" spacing="0.13 0.13 0.13" radius="0.02"'), ""),
    "jelly": ("", FLEX.format('dim="3" count="4 3 3" spacing="0.15 0.15 0.15" radius="0.01"'), ""),
    # Across the picture: MuJoCo leaves its ends open, and one can look into them.
    "rope": ("", FLEX.replace("60 0 20", "0 0 41").format('dim="1" count="8 1 1" spacing="0.11 0.1 0.1" radius="0.05"'), ""),
    "tendon": (
        "",
        WAY + '<geom name="ball" size="0.25"/>' + SITES.format("side", "0 0 0.5"),
        ('<tendon><spatial width="0.03"><site site="a"/><geom geom="ball" sidesite="side"/><site site="c"/>'
         '<pulley divisor="2"/><site site="a"/><site site="b"/></spatial></tendon>'),
    ),
}  # fmt: skip

SILHOUETTE = """([width, height]) => {
  const { stage } = mjcompose;
  stage.renderer.setPixelRatio(1);
  stage.renderer.setSize(width, height, false);
  stage.camera.aspect = width / height;
  stage.lookThrough(0);
  stage.now();
  const gl = stage.renderer.getContext(), pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let found = "";
  for (let k = 3; k < pixels.length; k += 4) found += pixels[k] > 127 ? "1" : "0";
  return found;
}"""


def silhouette(mujoco: Any, model: Any, size: list[int]) -> Any:
    """Where MuJoCo's renderer draws something. Runs in the child."""
    from mjcompose.mujoco.pictures import Look, NoOpenGL, Stage

    try:
        stage = Stage(mujoco, model, None, Look(size[0], size[1], (0, 0, 0, 0)))
    except NoOpenGL as error:
        return str(error)
    picture = stage.picture("eye")
    stage.close()
    return (picture[:, :, 3] > 127).astype(int).tolist()


silhouette.__module__ = "tools.view.test_silhouettes"


@pytest.fixture(scope="module")
def session() -> Any:
    with Session(rendering=True) as session:
        yield session


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_it_covers_the_same_pixels(name: str, tmp_path: Path, open_page: Callable[..., Any], session: Session) -> None:
    assets, bodies, more = CASES[name]
    (tmp_path / "model.xml").write_text(MODEL.format(assets=assets, bodies=bodies, more=more))
    page = open_page(page_of("model.xml", tmp_path, session).as_uri())
    answer = engine.call(session, silhouette, ["page"], [WIDTH, HEIGHT])
    assert answer.ok, answer.error
    if isinstance(answer.value, str) or session.no_opengl:
        pytest.skip("there is no OpenGL")
    expected = np.array(answer.value, bool)
    drawn = np.array(list(page.evaluate(SILHOUETTE, [WIDTH, HEIGHT]))) == "1"
    drawn = np.flipud(drawn.reshape(HEIGHT, WIDTH))
    share = (expected & drawn).sum() / max(1, (expected | drawn).sum())
    assert expected.sum() > 500 and share >= 0.97, f"{expected.sum()} pixels, {share:.3f} of them in common"
