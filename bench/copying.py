"""Many copies of one part: the time for each must not grow, and stay far below `MjSpec`'s."""

from __future__ import annotations

from bench import ours, peers
from bench.models import models
from bench.row import Row
from bench.timing import Candidate, best_times

_LINEAR = 1.25
_OF_MJSPEC = 0.1
_MANY = 200


def rows() -> list[Row]:
    used = models()
    hand = used.hand
    candidates: dict[str, Candidate] = {
        "1": lambda: ours.copies(hand, 1),
        "10": lambda: ours.copies(hand, 10),
        "100": lambda: ours.copies(hand, 100),
    }
    best = best_times(candidates, rounds=30, seconds=12)
    each = {count: best[count] / int(count) for count in candidates}
    return [
        Row("a copy of 10 / one alone", each["10"] / each["1"], _LINEAR, used.hand.stem),
        Row("a copy of 100 / a copy of 10", each["100"] / each["10"], _LINEAR, used.hand.stem),
        _against_mjspec(),
    ]


def _against_mjspec() -> Row:
    humanoid = models().humanoid
    mujoco = peers.mjspec()
    name = f"{_MANY} humanoids / MjSpec, saved as written"
    if humanoid is None:
        return Row(name, None, _OF_MJSPEC, "MJCOMPOSE_CORPUS is not set")
    if mujoco is None:
        return Row(name, None, _OF_MJSPEC, "this MuJoCo cannot save as written (3.16 can)")
    candidates: dict[str, Candidate] = {
        "ours": lambda: ours.copies(humanoid, _MANY),
        "mjspec": lambda: peers.mjspec_copies(mujoco, str(humanoid), _MANY, "mjspec.xml"),
    }
    with peers.quiet():
        best = best_times(candidates, rounds=3, seconds=0)
    return Row(name, best["ours"] / best["mjspec"], _OF_MJSPEC)
