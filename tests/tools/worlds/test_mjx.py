"""Worlds in MJX, on the CPU: what differs has a row for each world, all else none, and they step as in MuJoCo."""

from __future__ import annotations

from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import worlds
from targets.refused import of
from tools.worlds.studies import RESTING, TENDON, arm, made, refused, stepped, tables


@pytest.fixture(scope="module")
def mjx() -> Any:
    return pytest.importorskip("mujoco.mjx", reason="mujoco-mjx is not installed")


def test_worlds_step_as_in_mujoco(mjx: Any) -> None:
    import jax

    study = arm()
    model, axes = worlds.mjx(study)
    assert axes.body_mass == axes.body_inertia == axes.dof_invweight0 == 0 and axes.geom_size is None
    data = jax.vmap(lambda _: mjx.make_data(study.nominal))(np.arange(study.count))
    step = jax.jit(jax.vmap(mjx.step, in_axes=(axes, 0)))
    for _ in range(100):
        data = step(model, data)
    assert np.allclose(data.qpos, stepped(study), atol=1e-5)
    assert np.ptp(np.asarray(data.qpos), axis=0).max() > 0.01


def test_balls_rest_on_tables_of_each_world(mjx: Any) -> None:
    import jax

    study = tables()
    model, axes = worlds.mjx(study)
    data = jax.vmap(lambda _: mjx.make_data(study.nominal))(np.arange(study.count))
    step = jax.jit(jax.vmap(mjx.step, in_axes=(axes, 0)))
    for _ in range(200):
        data = step(model, data)
    assert np.allclose(data.qpos, stepped(study, 200), atol=1e-4)
    assert np.allclose(data.qpos[:, 2], RESTING, atol=1e-3)


def test_a_model_that_is_given(mjx: Any) -> None:
    """So playground and brax call it: `randomization_fn(model)`."""
    study = arm()
    model, _ = worlds.mjx(study, mjx.put_model(study.nominal).tree_replace({"opt.timestep": 0.01}))
    assert model.opt.timestep == 0.01 and model.body_mass.shape == (study.count, study.nominal.nbody)
    with pytest.raises(mjcompose.LoadError, match="differs from the worlds' model"):
        worlds.mjx(study, mjx.put_model(mujoco.MjModel.from_xml_string(TENDON)))


def test_playground_and_brax_take_them(mjx: Any) -> None:
    """Their wrappers map over the model and the axes in this way."""
    import jax

    wrapper = pytest.importorskip("mujoco_playground._src.wrapper", reason="playground is not installed")
    study = arm()

    class Environment:
        mjx_model = mjx.put_model(study.nominal)
        unwrapped = property(lambda self: self)

        def reset(self, key: Any) -> Any:
            return self.mjx_model.body_mass[1] + 0 * jax.random.uniform(key)

    env = Environment()
    env._mjx_model = env.mjx_model
    wrapped = wrapper.BraxDomainRandomizationVmapWrapper(env, lambda model: worlds.mjx(study, model))
    found = jax.vmap(lambda model: model.body_mass[1], in_axes=[wrapped._in_axes])(wrapped._mjx_model_v)
    assert np.allclose(found, study.values("body_mass")[:, 1])


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"geom_contype": (0, [1, 3])}, r"shares `geom_contype` among all worlds"),
        ({"dof_frictionloss": (0, [0.0, 1.0])}, r"shares `_impl.dof_hasfrictionloss` among all worlds, computed"),
    ],
)
def test_what_is_once_for_all_worlds(mjx: Any, arrays: dict[str, Any], said: str) -> None:
    study = made(
        mujoco.MjModel.from_xml_string(
            TENDON.replace("spatial", "fixed").replace(
                '<site site="a"/><site site="b"/>', '<joint joint="slide" coef="1"/>'
            )
        ),
        **arrays,
    )
    with pytest.raises(mjcompose.LoadError, match=said) as caught:
        worlds.mjx(study)
    assert caught.value.diagnostics[0].code == "not-per-world"


@pytest.mark.parametrize(("given", "told"), of("mjx"))
def test_what_it_does_not_take(mjx: Any, given: dict[str, str], told: str) -> None:
    """MJX refuses what builds for it refuse, and the error names the element as theirs does."""
    found = refused(worlds.mjx, given)
    assert told.rpartition(": MJX")[2] in found.message and "mujoco-mjx" in str(found.notes)


def test_a_world_that_it_does_not_take(mjx: Any) -> None:
    """The nominal model has no margin."""
    found = refused(worlds.mjx, {}, geom_margin=(0, [0.0, 0.01]))
    assert found.message == "geom `g`: MJX has no margin for contacts with meshes and height fields"
