"""The recipes that repeat entries and read tables, beside the programs from which people know these models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node

HERE = Path(__file__).resolve().parent
RECIPES = HERE.parents[1] / "recipes"


def built(recipe: Path, **given: Any) -> Built:
    node = load(json.dumps(given), "given.yaml", context := Context(environment={}).sink) if given else None
    values: dict[str, Node] = (
        {name: value for name, (_, value) in node.entries.items()} if isinstance(node, Mapping) else {}
    )
    assert not given or values, context.diagnostics
    told = Context(environment={}, folder=recipe.parent)
    made = build(ModelRequest(recipe, given=values), told)
    assert made is not None, told.sink.diagnostics
    return made


def model_of(made: Built) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(
        made.bundle.files["model.xml"].decode(),
        {name: content for name, content in made.bundle.files.items() if name != "model.xml"},
    )


def test_the_piano_moves_as_the_one_of_robopianist() -> None:
    own = model_of(built(RECIPES / "piano.yaml"))
    public = mujoco.MjModel.from_xml_path(str(HERE / "robopianist.xml"))
    for kind, count in (("body", 90), ("jnt", 88), ("site", 88), ("u", 88)):
        assert getattr(own, f"n{kind}") == getattr(public, f"n{kind}") == count
    names = [
        (model.joint(key).name, model.actuator(key).name, model.body(key + 2).name, model.geom(key + 1).name)
        for model in (own, public)
        for key in range(88)
    ]
    assert names[:88] == names[88:]
    one = mujoco.MjData(own)
    other = mujoco.MjData(public)
    chance = np.random.default_rng(0)
    for _ in range(500):
        one.ctrl[:] = other.ctrl[:] = chance.uniform(0, 0.1, 88)
        mujoco.mj_step(own, one)
        mujoco.mj_step(public, other)
        assert np.abs(one.geom_xpos - other.geom_xpos).max() <= 1e-12
    assert np.ptp(one.qpos) > 0.01  # the keys have moved


def sensors(made: Built) -> dict[str, str]:
    return {
        str(sensor.get("name")): " ".join(
            [str(sensor.tag), *(f"{name!s}={value!s}" for name, value in sorted(sensor.items()) if name != "name")]
        )
        for sensor in made.composed.model.root.iterfind("sensor/*")
    }


def test_the_players_sense_what_they_sense_in_dm_control() -> None:
    lines = (HERE / "soccer_sensors.txt").read_text(encoding="utf-8").splitlines()[1:]
    assert len(lines) == 100
    found = sensors(built(RECIPES / "match.yaml"))
    assert {line.partition(" ")[0]: line.partition(" ")[2] for line in lines} == found


@pytest.mark.parametrize("players", [1, 3])
def test_teams_of_any_size_have_all_their_sensors(players: int) -> None:
    made = built(RECIPES / "match.yaml", players=players)
    found = sensors(made)
    others = 2 * players - 1
    assert len(found) == 2 * players * (4 + 3 + 6 * others)
    model = model_of(made)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # Each sensor gives the place of the player whose name it has, seen from its own head.
    for k in range(players):
        here = data.body(f"home{k}/head_body")
        assert here.ximat == pytest.approx(here.xmat)
        for other in range(players):
            seen = here.ximat.reshape(3, 3).T @ (data.body(f"away{other}/head_body").xipos - here.xipos)
            assert data.sensor(f"home{k}/opponent_{other}_ego_position").data == pytest.approx(seen)
        mates = [mate for mate in range(players) if mate != k]
        for number, mate in enumerate(mates):
            seen = here.ximat.reshape(3, 3).T @ (data.body(f"home{mate}/head_body").xipos - here.xipos)
            assert data.sensor(f"home{k}/teammate_{number}_ego_position").data == pytest.approx(seen)


def test_a_motor_of_the_quadruped_is_a_row_of_the_table() -> None:
    rows: dict[str, dict[str, Any]] = {
        "hip": {"kp": 70, "kv": 2, "torque": 20, "armature": 0.01, "low": "-40deg", "high": "40deg", "stand": "0deg"},
        "thigh": {
            "kp": 80,
            "kv": 2,
            "torque": 21,
            "armature": 0.02,
            "low": "-60deg",
            "high": "180deg",
            "stand": "45deg",
        },
        "knee": {
            "kp": 90,
            "kv": 3,
            "torque": 22,
            "armature": 0.03,
            "low": "-150deg",
            "high": "-30deg",
            "stand": "-90deg",
        },
    }
    model = model_of(built(RECIPES / "quadruped.yaml", motor=rows))
    assert model.nu == 12
    for leg in ("FL", "FR", "RL", "RR"):
        for joint, row in rows.items():
            own = model.actuator(f"{leg}_{joint}")
            assert own.gainprm[0] == row["kp"] and own.forcerange.tolist() == [-row["torque"], row["torque"]]
            assert model.joint(f"{leg}_{joint}").name == f"{leg}_{joint}"
            low = np.deg2rad(float(str(row["low"]).removesuffix("deg")))
            assert model.joint(f"{leg}_{joint}").range[0] == pytest.approx(low)
            assert own.ctrlrange[0] == pytest.approx(low)


LINKS = "".join(
    f'<body name="fr3_link{n}" pos="0 0 .1"><joint name="fr3_joint{n}" axis="{(n % 2)} {1 - n % 2} 0"/>'
    f'<inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/>'
    for n in range(1, 8)
)
SERVOS = "".join(f'<position name="fr3_joint{n}" joint="fr3_joint{n}" kp="100"/>' for n in range(1, 8))
ARM = (
    f"<mujoco model='arm'><compiler angle='radian'/><worldbody>{LINKS}{'</body>' * 7}</worldbody>"
    f"<actuator>{SERVOS}</actuator></mujoco>"
)
THREE_EDITS = """
params: {calibration: {type: table}}
edit:
  - {select: {joint: "fr3_joint*"}, set: {ref: "${calibration[name].offset}", frictionloss: "${calibration[name].frictionloss}", damping: "${calibration[name].damping}"}}
  - {select: {actuator: "fr3_joint*"}, set: {kp: "${calibration[name].kp}"}}
  - {for: {j: "${calibration}"}, select: {body: "${calibration[j].link}"}, set: {mass: "${calibration[j].mass}"}}
"""


def test_a_calibration_of_seven_joints_is_three_edits(tmp_path: Path) -> None:
    """They do the same as 21 edits, one for each joint, body and actuator."""
    (tmp_path / "arm.xml").write_text(ARM)
    rows = {
        f"fr3_joint{n}": {
            "link": f"fr3_link{n}",
            "offset": f"{0.01 * n:.2f}rad",
            "frictionloss": 0.1 * n,
            "damping": 1 + n / 8,
            "mass": 2 + n / 4,
            "kp": 1000 + n,
        }
        for n in range(1, 8)
    }
    head = "recipe: 1\nname: arm\nangle: radian\nbase: ./arm.xml\n"
    (tmp_path / "three.yaml").write_text(head + THREE_EDITS)
    edits = [
        f"  - {{select: {{joint: {joint}}}, set: {{ref: {row['offset']}, frictionloss: {row['frictionloss']}, damping: {row['damping']}}}}}\n"
        f"  - {{select: {{body: {row['link']}}}, set: {{mass: {row['mass']}}}}}\n"
        f"  - {{select: {{actuator: {joint}}}, set: {{kp: {row['kp']}}}}}\n"
        for joint, row in rows.items()
    ]
    (tmp_path / "each.yaml").write_text(f"{head}edit:\n{''.join(edits)}")
    few = built(tmp_path / "three.yaml", calibration=rows).bundle.files["model.xml"]
    assert few == built(tmp_path / "each.yaml").bundle.files["model.xml"]
    assert few.count(b'frictionloss="0') == 7
