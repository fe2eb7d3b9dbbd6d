"""Two files parsed, attached, linked and written: against lxml alone, `MjSpec` and dm_control."""

from __future__ import annotations

from pathlib import Path

from bench import ours, peers
from bench.models import SITE, Models, models
from bench.row import Row
from bench.timing import best_times


def rows() -> list[Row]:
    used = models()
    with peers.quiet():
        return [_to_lxml(used), _to_mjspec(used), _to_dm_control(used)]


def _name(used: Models, peer: str) -> str:
    return f"attach ({used.name}) / {peer}"


def _to_lxml(used: Models) -> Row:
    arm, hand = str(used.arm), str(used.hand)
    best = best_times(
        {
            "lxml": lambda: peers.lxml_rewritten(arm, hand),
            "ours": lambda: ours.attached(used.arm, used.hand, SITE),
        },
        rounds=1000,
        seconds=6,
    )
    return Row(_name(used, "lxml parse + tostring"), best["ours"] / best["lxml"], used.to_lxml)


def _to_mjspec(used: Models) -> Row:
    name = _name(used, "MjSpec, saved as written")
    mujoco = peers.mjspec()
    if mujoco is None:
        return Row(name, None, 1.0, "this MuJoCo cannot save as written (3.16 can)")
    arm, hand = str(used.arm), str(used.hand)
    best = best_times(
        {
            "mjspec": lambda: peers.mjspec_attached(mujoco, arm, hand, SITE, "mjspec.xml"),
            "ours": lambda: Path("ours.xml").write_bytes(ours.attached(used.arm, used.hand, SITE)),
        },
        rounds=500,
        seconds=4,
    )
    return Row(name, best["ours"] / best["mjspec"], 1.0)


def _to_dm_control(used: Models) -> Row:
    name = _name(used, "dm_control")
    mjcf = peers.dm_control()
    if mjcf is None:
        return Row(name, None, 1.0, "dm_control is not installed")
    arm, hand = str(used.arm), str(used.hand)
    try:
        peers.dm_control_attached(mjcf, arm, hand, SITE)
    except ValueError as error:
        return Row(name, None, 1.0, f"dm_control refuses it: {error}")
    best = best_times(
        {
            "dm_control": lambda: peers.dm_control_attached(mjcf, arm, hand, SITE),
            "ours": lambda: ours.attached(used.arm, used.hand, SITE),
        },
        rounds=20,
        seconds=6,
    )
    return Row(name, best["ours"] / best["dm_control"], 1.0)
