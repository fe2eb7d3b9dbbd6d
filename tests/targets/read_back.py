"""Reads models back in other programs. `python tests/targets/read_back.py [NAME …]` writes `read_back.json` anew.

The table in `docs/how-to/simulators.md` is made of that file, and `test_consumers.py` compares it with what the programs read.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import mujoco

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

from mjcompose.base.dataclass import dataclass
from mjcompose.targets.export import export
from mjcompose.targets.judge import FEATURES, asked_of, by_actuator, differences, facts_of, without_lost
from mjcompose.targets.read_back import READERS, ReaderProgram, placed, read_back
from mjcompose.targets.table import READ_BACK, TARGETS, outcomes_of
from mjcompose.targets.target import FeatureOutcome, Loss
from targets.environments import is_ready, python_of
from targets.models import PROBES

POSES = 50
READ_WITH: dict[str, ReaderProgram] = {**READERS, "urdf in pybullet": READERS["pybullet"]}


@dataclass(frozen=True, slots=True)
class Found:
    """What a program has read of a model: the differences, and by feature `same` or `lost`, each from one element on."""

    differences: list[str]
    same: frozenset[str]
    lost: frozenset[str]
    version: str


def read_in(consumer: str, model: Path, folder: Path) -> Found | str:
    """What a program reads of the file of a model; or why the model is not written for it."""
    reader = READ_WITH[consumer]
    out = folder / "out"
    out.mkdir()
    made = export(mujoco, {"name": consumer.partition(" ")[0], "model": str(model), "out": str(out)})
    losses = [Loss(**each) for each in made["losses"]]
    assert not made["error"] and not made["differences"], made
    if any(each.refused for each in losses):
        return next(each.why for each in losses if each.refused)
    truth = mujoco.MjModel.from_xml_path(str(model))
    asked = without_lost(asked_of(mujoco, truth, POSES), losses)
    facts = read_back(reader, str(python_of(reader.program)), placed(out, made["model"]), asked)
    assert not isinstance(facts, str), facts
    mine = facts_of(mujoco, truth, asked)
    if consumer == "urdf in pybullet":  # it takes floating joints for fixed ones
        for read, each in zip(facts["poses"], mine["poses"], strict=True):
            read |= {name: each[name] for name in asked["home"]["free"]}
    found = list(differences(mujoco, truth, facts, asked, losses, single=reader.single))
    lost = frozenset(each.feature for each in losses if not each.otherwise)
    wrong = {each.feature for each in found}
    same = _compared(mine, facts, {(each.feature, each.name) for each in losses if not each.otherwise})
    return Found([each.message for each in found], frozenset(same - wrong), lost, str(facts["version"]))


def _compared(truth: dict[str, Any], facts: dict[str, Any], lost: set[tuple[str, str]]) -> set[str]:
    """The features of which something that is not zero was compared and was not lost."""
    found = {name for name in ("shapes", "motion", "driven") if name in facts} | {"inertia", "poses"}
    found |= {"forces"} if any(facts.get("forces", {}).values()) else set()
    facts = by_actuator(truth, facts)
    for kind in ("joints", "actuators"):
        for name, read in facts[kind].items():
            mine = truth[kind].get(name, {})
            found |= {FEATURES[each] for each in read if mine.get(each) and (FEATURES[each], name) not in lost}
    return found


def row(consumer: str) -> dict[str, Any]:
    """What a program reads of the probes, for `read_back.json`."""
    same: set[str] = set()
    lost: set[str] = set()
    version = ""
    for name, text in PROBES.items():
        with TemporaryDirectory() as folder:
            (Path(folder) / f"{name}.xml").write_text(text)
            found = read_in(consumer, Path(folder) / f"{name}.xml", Path(folder))
        if not isinstance(found, str):
            assert not found.differences, (consumer, name, found.differences)
            same = same | found.same
            lost = lost | found.lost
            version = found.version
    outcomes = outcomes_of(TARGETS[consumer.partition(" ")[0]])
    # What is lost in part and was not compared is not known.
    lost = {each for each in lost if each in same or (outcomes[each] == FeatureOutcome.LEFT_OUT and each != "shapes")}
    words = {(True, False): "same", (True, True): "partly", (False, True): "lost"}
    compared = {each: words.get((each in same, each in lost), "") for each in dict.fromkeys(FEATURES.values())}
    return {"version": version, **{each: word for each, word in compared.items() if word}}


if __name__ == "__main__":
    rows = json.loads(READ_BACK.read_text(encoding="utf-8")) if READ_BACK.is_file() else {}
    for wanted in sys.argv[1:] or READ_WITH:
        if is_ready(READ_WITH[wanted].program):
            rows[wanted] = row(wanted)
            sys.stdout.write(f"{wanted} {rows[wanted]}\n")
    if READ_BACK.is_file():  # another program may have been read meanwhile
        rows = json.loads(READ_BACK.read_text(encoding="utf-8")) | {name: rows[name] for name in sys.argv[1:] or rows}
    ordered = {name: rows[name] for name in READ_WITH if name in rows}
    READ_BACK.write_text(json.dumps(ordered, indent=2) + "\n", encoding="utf-8")
