"""Edits of a large model through Python: as long for each of many as of few; beside them dm_control's and MjSpec's."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mjcompose import mjcf

from bench import peers
from bench.row import Row

_MANY = 10_000
_REFERRERS = 1_000
# A model ten times as large does not fit into the processor's caches.
_LINEAR = 2.0
# Finding is little more than looking into memory: the same as dm_control's.
_LINEAR_FINDING = 4.0
_ROUNDS = 5
# Each removal looks at all geoms: so many are timed and counted as half of all.
_OF_MJSPEC = 50

Times = dict[str, float]
_EDITS = (
    "adding",
    "finding by name",
    "renaming one that is referred to",
    "removing half",
    "setting and reading a position",
)


def rows() -> list[Row]:
    tenth = _best(lambda: _ours(_MANY // 10))
    whole = _best(lambda: _ours(_MANY))
    theirs = {"dm_control": _of_dm_control(), "MjSpec": _of_mjspec()}
    found = []
    for edit in _EDITS:
        size = f"{_REFERRERS:,} times" if "referred" in edit else f"{_MANY:,} geoms"
        limit = _LINEAR_FINDING if edit.startswith("finding") else _LINEAR
        found.append(Row(f"{edit}: {size}, each / each of a tenth", whole[edit] / tenth[edit] / 10, limit))
        for peer, times in theirs.items():
            if times is None:
                ratio = None
                note = "not installed"
            elif edit not in times:
                ratio = None
                note = "references stay as they are"
            else:
                ratio = whole[edit] / times[edit]
                note = f"{whole[edit] * 1000:.1f} ms"
            found.append(Row(f"{edit}: {size} / {peer}", ratio, None, note))
    return found


def _best(run: Callable[[], Iterator[tuple[str, float]]]) -> Times:
    best: Times = {}
    for _ in range(_ROUNDS):
        for edit, seconds in run():
            best[edit] = min(best.get(edit, seconds), seconds)
    return best


def _timed(edit: Callable[[], object]) -> float:
    gc.collect()
    gc.disable()
    try:
        start = time.perf_counter()
        edit()
        return time.perf_counter() - start
    finally:
        gc.enable()


def _ours(count: int) -> Iterator[tuple[str, float]]:
    root = mjcf.RootElement("large")
    world = root.worldbody

    def add() -> None:
        for number in range(count):
            world.add("geom", name=f"g{number}", type="sphere", size=[0.1])

    def find() -> None:
        for number in range(count):
            assert root.find("geom", f"g{number}") is not None

    yield _EDITS[0], _timed(add)
    yield _EDITS[1], _timed(find)
    site = world.add("site", name="referred")
    for _ in range(_REFERRERS * count // _MANY):
        root.sensor.add("touch", site=site)
    yield _EDITS[2], _timed(lambda: setattr(site, "name", "renamed"))
    geoms = root.find_all("geom")

    def remove() -> None:
        for geom in geoms[::2]:
            geom.remove()

    yield _EDITS[3], _timed(remove)
    other = mjcf.RootElement("other").worldbody
    others = [other.add("geom", size=[1]) for _ in range(count)]
    yield _EDITS[4], _timed(lambda: _move(others))


def _move(geoms: Iterable[Any]) -> None:
    for number, geom in enumerate(geoms):
        geom.pos = [0.25 * number, 0.5, 1]
        assert geom.pos[1] == 0.5


def _of_dm_control() -> Times | None:
    theirs: Any = peers.dm_control()
    if theirs is None:
        return None

    def run() -> Iterator[tuple[str, float]]:
        root = theirs.RootElement("large")
        world = root.worldbody

        def add() -> None:
            for number in range(_MANY):
                world.add("geom", name=f"g{number}", type="sphere", size=[0.1])

        yield _EDITS[0], _timed(add)
        yield _EDITS[1], _timed(lambda: [root.find("geom", f"g{number}") for number in range(_MANY)])
        site = world.add("site", name="referred")
        for _ in range(_REFERRERS):
            root.sensor.add("touch", site=site)
        yield _EDITS[2], _timed(lambda: setattr(site, "name", "renamed"))  # written with the new name later
        geoms = root.find_all("geom")
        yield _EDITS[4], _timed(lambda: _move(geoms))
        yield _EDITS[3], _timed(lambda: [geom.remove() for geom in geoms[::2]])

    return _best(run)


def _of_mjspec() -> Times | None:
    mujoco = peers.mjspec()
    if mujoco is None:
        return None

    def run() -> Iterator[tuple[str, float]]:
        spec = mujoco.MjSpec()
        world = spec.worldbody

        def add() -> None:
            for number in range(_MANY):
                world.add_geom(name=f"g{number}", size=[0.1, 0, 0])

        yield _EDITS[0], _timed(add)
        yield _EDITS[1], _timed(lambda: [spec.geom(f"g{number}") for number in range(_MANY)])
        yield _EDITS[4], _timed(lambda: _move(spec.geoms))
        some = list(spec.geoms)[: 2 * _OF_MJSPEC : 2]  # all of them take a minute
        yield _EDITS[3], _timed(lambda: [spec.delete(geom) for geom in some]) * _MANY / 2 / _OF_MJSPEC

    return _best(run)
