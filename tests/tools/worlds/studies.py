"""Worlds of an arm, in a bundle that stands here: simulators that pin a MuJoCo which builds no models load it too."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import worlds
from mjcompose.base.diagnostic import Diagnostic
from targets.refused import model as model_text

ARM = Path(__file__).with_name("arm")


def arm() -> worlds.Worlds:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # built with another MuJoCo
        return worlds.load(ARM / "bundle")


def made(model: mujoco.MjModel, **arrays: Any) -> worlds.Worlds:
    """Worlds of a model in which these numbers differ: by array, the flat index and the value in each world.

    `opt_` stands for `opt.`.
    """
    study = arm()
    found = {}
    count = 0
    for name, (index, values) in arrays.items():
        count = len(values)
        numbers = np.array(values)[:, None]
        found[name.replace("opt_", "opt.")] = worlds.Varying(np.array([index]), numbers)
    table = replace(study.table, arrays=found, count=count, cell=np.zeros(count, int), sample=np.arange(count))
    return replace(study, nominal=copy.copy(model), table=table)


def refused(convert: Callable[[worlds.Worlds], Any], given: dict[str, str], **arrays: Any) -> Diagnostic:
    """What is reported of worlds of a model with this, which a simulator does not take."""
    study = made(mujoco.MjModel.from_xml_string(model_text(**given)), **arrays or {"geom_rgba": (0, [0.5, 1.0])})
    with pytest.raises(mjcompose.LoadError) as caught:
        convert(study)
    (found,) = caught.value.diagnostics
    assert found.code == "target-cannot" and found.help is not None
    return found


def stepped(study: worlds.Worlds, steps: int = 100) -> np.ndarray:
    """Where MuJoCo itself takes each world, `(worlds, nq)`."""
    found = []
    for model in study.models():
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data, steps)
        found.append(data.qpos.copy())
    return np.array(found)


def differing(a: mujoco.MjModel, b: mujoco.MjModel) -> set[str]:
    """The arrays that differ, but for the last digits of what was computed in two ways."""
    names = [name for name in dir(a) if not name.startswith("_") and isinstance(getattr(a, name), np.ndarray)]
    pairs = {name: (getattr(a, name), getattr(b, name)) for name in names}
    pairs |= {f"stat.{name}": (getattr(a.stat, name), getattr(b.stat, name)) for name in ("meaninertia", "meanmass")}
    return {
        name
        for name, (x, y) in pairs.items()
        if np.shape(x) != np.shape(y)
        or not np.allclose(x, y, rtol=1e-5 if np.asarray(x).dtype == np.float32 else 1e-9, atol=1e-12, equal_nan=True)
    }


HEIGHTS = [0.1, 0.4, 0.25]


def tables() -> worlds.Worlds:
    """Worlds with tables of other heights and other geoms on them; a ball rests on each."""
    text = """<mujoco><option timestep="0.005"/><worldbody>
      <body name="table" pos="0 0 .2"><geom name="top" type="box" size=".5 .5 .02" pos="0 0 .1"/>
      <geom type="box" size=".02 .02 .05" pos=".4 .4 -.1"/></body><body name="goal" mocap="true"><geom size=".1" contype="0" conaffinity="0"/></body>
      <body pos="0 0 .9"><freejoint/><geom size=".05" mass="1"/></body></worldbody></mujoco>"""
    return made(mujoco.MjModel.from_xml_string(text), body_pos=(5, HEIGHTS), geom_pos=(2, [0, 0.05, -0.01]))


RESTING = [height + top + 0.07 for height, top in zip(HEIGHTS, [0, 0.05, -0.01], strict=True)]
"""Where the balls rest."""


TENDON = """\
<mujoco>
  <worldbody>
    <site name="a" pos="0 0 1"/>
    <body><joint name="slide" type="slide"/><geom name="ball" size="0.1" mass="1"/><site name="b" pos="0 0 0.3"/></body>
  </worldbody>
  <tendon><spatial name="rope" springlength="0.1"><site site="a"/><site site="b"/></spatial></tendon>
</mujoco>
"""
