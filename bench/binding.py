"""Fields of bound elements against indexing MuJoCo's arrays; beside it dm_control and MuJoCo's named access."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from mjcompose import mjcf

from bench import peers
from bench.models import models
from bench.row import Row
from bench.timing import Candidate, best_times

_TIMES = 20_000
_LIMIT = 1.0
# Numbers at irregular distances are a copy that writes back what is written to it; numpy's does not, and to make
# an array of a class of its own takes numpy half as long again.
_SCATTERED = 1.75


def rows() -> list[Row]:
    hand = models().hand
    root = mjcf.from_path(hand)
    physics = root.compile_model()
    joints = [joint for joint in root.find_all("joint") if physics.bind(joint).qpos.shape == (1,)]
    bodies = [joint.parent for joint in joints]
    order = [at for at in (0, 3, 1, 2) if at < len(joints)]
    some = [joints[at] for at in order]
    theirs = _dm_control(str(hand), [str(joint.name) for joint in joints], [joints.index(each) for each in some])

    one, all_of_them, mixed = (physics.bind(which) for which in (joints[0], joints, some))
    body = physics.bind(bodies[0])
    few = physics.bind([bodies[at] for at in order])
    named = physics.data.joint(joints[0].name)
    data = physics.data
    q = int(one.qposadr)
    b = int(body.element_id)
    irregular = np.array([int(each) for each in mixed.qposadr])
    body_rows = few.element_id
    sequence = slice(int(all_of_them.qposadr[0]), int(all_of_them.qposadr[-1]) + 1)

    table: list[tuple[str, float | None, Callable[[], object], Callable[[], object]]] = [
        ("qpos of a joint", _LIMIT, lambda: one.qpos, lambda: data.qpos[q : q + 1]),
        ("xpos of a body", _LIMIT, lambda: body.xpos, lambda: data.xpos[b]),
        ("qpos of all joints", _LIMIT, lambda: all_of_them.qpos, lambda: data.qpos[sequence]),
        ("xpos of mixed bodies", _LIMIT, lambda: few.xpos, lambda: data.xpos[body_rows]),
        ("qpos of mixed joints", _SCATTERED, lambda: mixed.qpos, lambda: data.qpos[irregular]),
        (
            "setting qpos of all joints",
            1.25,
            functools.partial(setattr, all_of_them, "qpos", 0.1),
            lambda: data.qpos.__setitem__(sequence, 0.1),
        ),
        ("MuJoCo's named qpos of a joint", None, lambda: named.qpos, lambda: data.qpos[q : q + 1]),
        *((f"dm_control's {what}", None, read, plain) for what, read, plain in theirs(data, q, sequence, irregular)),
    ]
    return [_row(what, limit, read, plain, hand.stem) for what, limit, read, plain in table]


def _row(what: str, limit: float | None, read: Callable[[], object], plain: Callable[[], object], note: str) -> Row:
    best = best_times({"read": _often(read), "plain": _often(plain)}, rounds=15, seconds=3)
    return Row(f"{what} / numpy indexing", best["read"] / best["plain"], limit, note)


def _often(read: Callable[[], object]) -> Candidate:
    def run() -> None:
        for _ in range(_TIMES):
            read()

    return run


def _dm_control(hand: str, names: list[str], some: list[int]) -> Callable[..., Any]:
    """dm_control's bindings of the same, where it is installed and knows the MuJoCo that is."""
    theirs = peers.dm_control()
    try:
        with peers.quiet():
            root = None if theirs is None else theirs.from_path(hand)
            physics = None if theirs is None else theirs.Physics.from_mjcf_model(root)
    except (AttributeError, ValueError):
        physics = None
    if root is None or physics is None:
        return lambda *_: []
    joints = [root.find("joint", name) for name in names]
    one, several, mixed = (physics.bind(each) for each in (joints[0], joints, [joints[at] for at in some]))

    def compared(data: Any, q: int, sequence: slice, irregular: object) -> Any:
        yield "qpos of a joint", lambda: one.qpos, lambda: data.qpos[q : q + 1]
        yield "qpos of all joints", lambda: several.qpos, lambda: data.qpos[sequence]
        yield "qpos of mixed joints", lambda: physics and mixed.qpos, lambda: data.qpos[irregular]

    return compared
