"""Two files parsed, attached, linked and written: against lxml alone, `MjSpec` and dm_control.

Rows called `link` time the linker, as a build uses it; those called `mjcompose.mjcf` time the Python interface.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

from lxml import etree
from mjcompose import mjcf
from mjcompose.link.linking import Policy

from bench import ours, peers
from bench.models import SITE, Models, models
from bench.row import Row
from bench.timing import best_times


def rows() -> list[Row]:
    used = models()
    with peers.quiet():
        return [_to_lxml(used), _to_mjspec(used), _to_dm_control(used), *_of_mjcf(used)]


def _name(used: Models, peer: str) -> str:
    return f"link ({used.name}) / {peer}"


def _to_lxml(used: Models) -> Row:
    arm = str(used.arm)
    hand = str(used.hand)
    best = best_times(
        {"lxml": lambda: peers.lxml_rewritten(arm, hand), "ours": lambda: ours.attached(used.arm, used.hand, SITE)},
        rounds=1000,
        seconds=6,
    )
    return Row(_name(used, "lxml parse + tostring"), best["ours"] / best["lxml"], used.to_lxml)


def _to_mjspec(used: Models) -> Row:
    name = _name(used, "MjSpec, saved as written")
    mujoco = peers.mjspec()
    if mujoco is None:
        return Row(name, None, 1.0, "this MuJoCo cannot save as written (3.16 can)")
    arm = str(used.arm)
    hand = str(used.hand)
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
    arm = str(used.arm)
    hand = str(used.hand)
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


def _of_mjcf(used: Models) -> Iterator[Row]:
    """Both have a file with the same bodies afterwards; MjSpec without keys, which would make it compile both."""
    name = f"mjcompose.mjcf: read, attach, write ({used.name})"
    second = "mjcompose.mjcf: the second text / lxml"
    arm = str(used.arm)
    hand = str(used.hand)
    policy: Policy = "error" if used.to_lxml else "merge"  # the project's own models do not agree

    def attached() -> mjcf.RootElement:
        root = mjcf.from_path(arm)
        place = root.find("site", SITE)
        assert place is not None
        place.attach(mjcf.from_path(hand))
        return root

    def written() -> None:
        Path("ours.xml").write_text(attached().to_xml_string(conflict=policy))

    root = attached()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mjcf.MjcfWarning)
        tree = etree.fromstring(root.to_xml_string(conflict=policy))
        mujoco = peers.mjspec()
        candidates: dict[str, Callable[[], object]] = {
            "ours": written,
            "text": lambda: root.to_xml_string(conflict=policy),
            "lxml": lambda: etree.tostring(tree),
        }
        if mujoco is not None:
            candidates["mjspec"] = lambda: peers.mjspec_attached(mujoco, arm, hand, SITE, "mjspec.xml")
        best = best_times(candidates, rounds=500, seconds=6, clock=time.process_time)
    if mujoco is not None:
        note = f"{best['ours'] * 1e3:.1f} ms against {best['mjspec'] * 1e3:.1f} ms; ours lays out keys, too"
        yield Row(f"{name} / MjSpec, saved as written", best["ours"] / best["mjspec"], 0.8, note)
    note = f"{best['text'] * 1e3:.2f} ms; the first is linked"
    yield Row(second, best["text"] / best["lxml"], 2.0, note)
