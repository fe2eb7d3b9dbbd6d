from __future__ import annotations

import mujoco
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.size import count
from mjcompose.language.checks.size import COUNTS
from mjcompose.mujoco.attributes import NameTable

from tests.build.checks.conftest import notes


def test_what_is_there_holds(ask, arm: str) -> None:
    assert (
        ask(arm, "size: {nq: 9, nv: 8, nu: 3, nbody: 5, ngeom: 6, nsensor: 2, nkey: 2, nactuator: 3}") == []
    )


def test_each_size_that_is_another_is_told_at_its_place(ask, arm: str) -> None:
    one, two = ask(arm, "size: {nq: 9, nv: 7, nu: 4}")
    assert (one.at, two.at) == (("nv",), ("nu",))
    assert one.message == "`nv` is 8, not 7"
    assert notes(one) == ("expected: nv 7", "actual: nv 8")
    assert one.code == "check-failed"


def test_in_a_nested_recipe_only_its_own_is_counted(ask, arm: str) -> None:
    own = "size: {nq: 2, nv: 2, nu: 2, nbody: 3, njnt: 2, ngeom: 3, nsite: 1, nsensor: 1, nsensordata: 1, ncam: 0}"
    assert ask(arm, own, prefix="left/") == []
    assert ask(arm, "size: {nbody: 2, nq: 0, ngeom: 1}", prefix="right/") == []


def test_a_nested_base_is_all_but_the_parts(ask, arm: str) -> None:
    own = "size: {nbody: 1, ngeom: 1, ncam: 1, nu: 1, nsensor: 0}"
    assert ask(arm, own, others=["left/", "right/"]) == []


def test_keyframes_that_merged_are_of_no_recipe_alone(ask, arm: str) -> None:
    assert ask(arm, "size: {nkey: 77}", prefix="left/") == []


def test_every_size_is_one_of_the_model(arm: str) -> None:
    model = mujoco.MjModel.from_xml_string(arm)
    whole, part = Scope(mujoco, model), Scope(mujoco, model, prefix="left/", whole=False)
    for size in COUNTS:
        assert count(whole, size) is not None, size
        assert (count(part, size) is None) == (size == "nkey")
    assert NameTable(model).count("body") == count(whole, "nbody")


def test_parts_and_the_rest_are_the_whole(arm: str) -> None:
    model = mujoco.MjModel.from_xml_string(arm)
    for size in set(COUNTS) - {"nkey", "nsensor", "nsensordata"}:  # the clock is about nothing
        whole = count(Scope(mujoco, model), size)
        base = count(Scope(mujoco, model, others=["left/", "right/"], whole=False), size)
        parts = [count(Scope(mujoco, model, prefix=each, whole=False), size) for each in ("left/", "right/")]
        carrier = {"nbody": 1 - 2, "njnt": 1, "nq": 7, "nv": 6, "ngeom": 1}.get(size, 0)  # a world each
        assert base + sum(parts) + carrier == whole, size  # type: ignore[operator, arg-type]
