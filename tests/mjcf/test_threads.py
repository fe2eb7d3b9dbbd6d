"""One model is read in many threads, and many models are edited in a thread each."""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from typing import TypeVar

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import RootElement

_Result = TypeVar("_Result")
_THREADS = 8


@pytest.fixture(autouse=True)
def _in_turns() -> Iterator[None]:
    """Threads take turns as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def _at_once(work: Callable[[int], _Result]) -> list[_Result]:
    barrier = Barrier(_THREADS)

    def run(number: int) -> _Result:
        barrier.wait()
        return work(number)

    with ThreadPoolExecutor(_THREADS) as pool:
        return list(pool.map(run, range(_THREADS)))


def _read(model: RootElement) -> tuple[object, ...]:
    """Everything that reading can make: views, names, and sections that are not written."""
    elements = [each for tag in ("body", "joint", "geom", "site", "actuator", "sensor") for each in model.find_all(tag)]
    return (
        *elements,
        model.find("joint", "gripper/left"),
        model.visual.headlight,
        model.option.flag,
        model.custom,
        model.default.geom,
        str([each.get_attributes().keys() for each in elements]),
        model.to_xml_string(),
        tuple(sorted(model.assets)),
    )


def test_a_model_is_read_in_several_threads(arm: RootElement, gripper: RootElement) -> None:
    arm.find("site", "flange").attach(gripper)
    for _ in range(3):
        fresh = copy.deepcopy(arm)
        first, *others = _at_once(lambda number, model=fresh: _read(model))  # type: ignore[misc]
        for other in others:
            assert len(other) == len(first)
            assert all(a is b or (isinstance(a, str | tuple) and a == b) for a, b in zip(first, other, strict=True))
        assert [each.tag for each in fresh.all_children()].count("custom") == 1


def test_models_are_edited_in_a_thread_each(arm: RootElement, gripper: RootElement) -> None:
    arm.find("site", "flange").attach(gripper)

    def edit(number: int) -> str:
        model = copy.deepcopy(arm)
        for step in range(30):
            body = model.worldbody.add("body", name=f"b{step}", pos=[number, step, 0])
            body.add("geom", name=f"g{step}", size=[0.1 * (number + 1)])
            model.sensor.add("framepos", name=f"s{step}", objtype="body", objname=body)
            body.name = f"body{step}"
        for step in range(0, 30, 2):
            model.find("body", f"body{step}").remove(cascade=True)
        model.attached_models[0].model = f"hand{number}"
        mjcf.commit_defaults(model)
        return model.to_xml_string()

    found = _at_once(edit)
    assert found == [edit(number) for number in range(_THREADS)]
    assert len(set(found)) == _THREADS


def test_one_physics_in_each_thread(arm: RootElement) -> None:
    elbow = arm.find("joint", "elbow_joint")

    def simulate(number: int) -> float:
        physics = arm.compile_model()
        physics.bind(elbow).qpos = 0.1 * number
        physics.step(20)
        return float(physics.bind(elbow).qpos[0])

    assert _at_once(simulate) == [simulate(number) for number in range(_THREADS)]
