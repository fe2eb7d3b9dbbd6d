"""A `<mimic>` that leads to nothing is reported at its place, and the model is the same in every version of MuJoCo."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from mjcompose.urdf.read import UrdfReader
from urdf.parts import ARM, joint, link, robot

Reader = Callable[..., UrdfReader]


def coupled(reader: UrdfReader) -> list[tuple[str | None, str | None]]:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    return [(each.get("joint1"), each.get("joint2")) for each in unit.root.iterfind("equality/joint")]


def warnings(reader: UrdfReader) -> list[tuple[str, int]]:
    found = [each for each in reader.sink.sorted() if each.code == "mujoco-warning"]
    return [(each.message, 0 if each.span is None else each.span.line) for each in found]


@pytest.mark.parametrize(
    ("leader", "message"),
    [
        ("elbow", "the joint `elbow` mimics itself: `elbow` moves by itself"),
        ("weld", "the joint `weld`, which `elbow` mimics, is fixed: `elbow` moves by itself"),
        ("wrist", "the joint `wrist`, which `elbow` mimics, does not exist: `elbow` moves by itself"),
    ],
)
def test_a_joint_that_cannot_lead(reader: Reader, leader: str, message: str) -> None:
    follower = joint("elbow", "upper", "fore", f'<mimic joint="{leader}"/>')
    weld = joint("weld", "fore", "tip", kind="fixed")
    read = reader("r.urdf", robot(*ARM[:4], follower, link("tip"), weld))
    assert coupled(read) == []
    assert warnings(read) == [(message, 6)]


def test_joints_that_mimic_one_another_lose_one(reader: Reader) -> None:
    ring = {"shoulder": "wrist", "elbow": "shoulder", "wrist": "elbow"}
    links = ("base", "upper", "fore", "tip")
    joints = [
        joint(name, parent, child, f'<mimic joint="{leader}" multiplier="2"/>')
        for (name, leader), parent, child in zip(ring.items(), links, links[1:], strict=False)
    ]
    read = reader("r.urdf", robot(*map(link, links), *joints))
    assert coupled(read) == [("shoulder", "wrist"), ("wrist", "elbow")]
    ((message, line),) = warnings(read)
    assert line == 7 and message.endswith(": `elbow` moves by itself")
    assert "`elbow`, which mimics `shoulder`, which mimics `wrist`, which mimics `elbow`" in message


def test_a_chain_stays(reader: Reader) -> None:
    links = ("base", "upper", "fore", "tip")
    joints = [
        joint("shoulder", "base", "upper"),
        joint("elbow", "upper", "fore", '<mimic joint="shoulder"/>'),
        joint("wrist", "fore", "tip", '<mimic joint="elbow" multiplier="-1"/>'),
    ]
    read = reader("r.urdf", robot(*map(link, links), *joints))
    assert coupled(read) == [("elbow", "shoulder"), ("wrist", "elbow")]
    assert warnings(read) == []
