"""Worlds in MuJoCo Warp, on the CPU: every array per world, and the same steps as MuJoCo's, in single precision."""

from __future__ import annotations

import sys
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import worlds
from targets.refused import of
from tools.worlds.studies import RESTING, TENDON, arm, made, refused, stepped, tables


@pytest.fixture(scope="module")
def mujoco_warp() -> Any:
    return pytest.importorskip("mujoco_warp", reason="mujoco-warp is not installed")


def test_worlds_step_as_in_mujoco(mujoco_warp: Any) -> None:
    study = arm()
    model = worlds.warp(study)
    for name in ("body_mass", "body_inertia", "body_subtreemass", "dof_invweight0", "dof_damping", "body_pos"):
        assert np.allclose(getattr(model, name).numpy(), study.values(name), rtol=1e-6), name
    data = worlds.warp_data(study)
    for _ in range(100):
        mujoco_warp.step(model, data)
    assert np.allclose(data.qpos.numpy(), stepped(study), atol=1e-5)
    assert np.ptp(data.qpos.numpy(), axis=0).max() > 0.01


def test_options_per_world(mujoco_warp: Any) -> None:
    study = made(mujoco.MjModel.from_xml_string(TENDON), opt_timestep=(0, [0.001, 0.004]))
    assert np.allclose(worlds.warp(study).opt.timestep.numpy(), [0.001, 0.004])


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"geom_contype": (0, [1, 3])}, r"shares `geom_contype` among all worlds"),
        ({"opt_impratio": (0, [5.0, 10.0])}, r"shares `opt.impratio_invsqrt` among all worlds, computed"),
        ({"tendon_stiffness": (0, [0.0, 10.0])}, r"shares `has_tendon_stiffness` among all worlds, computed"),
    ],
)
def test_what_is_once_for_all_worlds(mujoco_warp: Any, arrays: dict[str, Any], said: str) -> None:
    study = made(mujoco.MjModel.from_xml_string(TENDON), **arrays)
    if "tendon_stiffness" in arrays and not hasattr(mujoco_warp.put_model(study.nominal), "has_tendon_stiffness"):
        pytest.skip("this MuJoCo Warp looks at the springs of each world")
    with pytest.raises(mjcompose.LoadError, match=said) as caught:
        worlds.warp(study)
    assert caught.value.diagnostics[0].code == "not-per-world"


@pytest.mark.parametrize(
    ("package", "call"), [("mujoco_warp", "warp"), ("mujoco_warp", "warp_data"), ("jax", "mjx"), ("mjlab", "mjlab")]
)
def test_what_is_not_installed(monkeypatch: pytest.MonkeyPatch, package: str, call: str) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, "mujoco_warp", None)
    with pytest.raises(mjcompose.LoadError, match=r"cannot be used: (import of|No module named)") as caught:
        getattr(worlds, call)(arm())
    assert caught.value.diagnostics[0].code == "not-installed"


@pytest.mark.parametrize(("given", "told"), of("warp"))
def test_what_it_does_not_take(mujoco_warp: Any, given: dict[str, str], told: str) -> None:
    """MuJoCo Warp refuses what builds for it refuse, and the error names the element as theirs does."""
    found = refused(worlds.warp, given)
    assert told.rpartition(": ")[2] in found.message and "mujoco-warp" in str(found.notes)


def test_balls_rest_on_tables_of_each_world(mujoco_warp: Any) -> None:
    """The poses of what is fixed are in the data, which Warp makes from the nominal model."""
    study = tables()
    model = worlds.warp(study)
    data = worlds.warp_data(study)
    for _ in range(200):
        mujoco_warp.step(model, data)
    found = data.qpos.numpy()
    assert np.allclose(found, stepped(study, 200), atol=1e-4)
    assert np.allclose(found[:, 2], RESTING, atol=1e-3)
