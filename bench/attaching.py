"""Two files parsed, attached, linked and written: against lxml alone, `MjSpec` and dm_control."""

from __future__ import annotations

from pathlib import Path

from bench import ours, peers
from bench.models import SITE, models
from bench.row import Row
from bench.timing import Candidate, best_times


def rows() -> list[Row]:
    used = models()
    arm, hand = str(used.arm), str(used.hand)
    mujoco, mjcf = peers.mjspec(), peers.dm_control()
    candidates: dict[str, Candidate] = {
        "lxml": lambda: peers.lxml_rewritten(arm, hand),
        "ours": lambda: ours.attached(used.arm, used.hand, SITE),
    }
    if mujoco is not None:
        candidates["saved"] = lambda: Path("ours.xml").write_bytes(ours.attached(used.arm, used.hand, SITE))
        candidates["mjspec"] = lambda: peers.mjspec_attached(mujoco, arm, hand, SITE, "mjspec.xml")
    with peers.quiet():
        best = best_times(candidates, rounds=600, seconds=6)
        if mjcf is not None:
            candidates = {
                "ours": candidates["ours"],
                "dm": lambda: peers.dm_control_attached(mjcf, arm, hand, SITE),
            }
            slowest = best_times(candidates, rounds=20, seconds=6)
    what = f"attach ({used.name})"
    found = [Row(f"{what} / lxml parse + tostring", best["ours"] / best["lxml"], used.to_lxml)]
    if mujoco is not None:
        found.append(Row(f"{what} / MjSpec, saved as written", best["saved"] / best["mjspec"], 1.0))
    else:
        found.append(Row(f"{what} / MjSpec", None, 1.0, "this MuJoCo cannot save as written (3.16 can)"))
    if mjcf is not None:
        found.append(Row(f"{what} / dm_control", slowest["ours"] / slowest["dm"], 1.0))
    else:
        found.append(Row(f"{what} / dm_control", None, 1.0, "dm_control is not installed"))
    return found
