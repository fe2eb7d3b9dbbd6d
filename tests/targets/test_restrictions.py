"""Restrictions that write a model otherwise: it moves as before."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree
from mjcompose.targets.judge import questions
from mjcompose.targets.plain import plain
from mjcompose.targets.restrictions import CARRIED_FORCES, NAME, NO_HIDDEN_SHAPES, NO_REFERENCES, no_shapes, one_root
from mjcompose.targets.target import Limit
from targets.models import SELDOM
from targets.writing import compiled, written


@pytest.mark.parametrize("limit", [NO_REFERENCES, one_root(with_free=False)], ids=lambda limit: limit.feature)
def test_it_moves_as_before(limit: Limit, tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(SELDOM)
    draft = plain(mujoco, tmp_path / "model.xml")
    limit.apply(draft)
    assert [each.feature for each in draft.losses] == [limit.feature] * len(draft.losses) != []
    before = mujoco.MjModel.from_xml_string(SELDOM)
    after = mujoco.MjModel.from_xml_string(etree.tostring(draft.root).decode())
    for pose in questions(before, 10)["poses"]:
        placed = []
        for model in (before, after):
            data = mujoco.MjData(model)
            for name, value in pose["joints"].items():
                data.joint(name).qpos[:] = value
            mujoco.mj_kinematics(model, data)
            placed.append([data.body(before.body(n).name).xpos.copy() for n in range(1, before.nbody)])
        assert np.allclose(*placed, atol=1e-12)


def left(limit: Limit, world: str, folder: Path, rest: str = "") -> etree._Element:
    (folder / "model.xml").write_text(f"<mujoco><worldbody>{world}</worldbody>{rest}</mujoco>")
    draft = plain(mujoco, folder / "model.xml")
    limit.apply(draft)
    return draft.root


def test_a_limit_of_actuators_is_none_of_the_compensation_that_goes_through_them(tmp_path: Path) -> None:
    """`actuatorfrcrange` limits the sum of both."""
    joint = '<body name="{0}" gravcomp="1"><joint name="{0}" {1}/><geom size=".1"/></body>'
    root = left(
        CARRIED_FORCES,
        joint.format("a", 'actuatorgravcomp="true"') + joint.format("b", ""),
        tmp_path,
        '<actuator><motor joint="a" forcerange="-4 4"/><motor joint="b" forcerange="-4 4"/></actuator>',
    )
    ranges = {str(each.get("name")): each.get("actuatorfrcrange") for each in root.iter("joint")}
    assert ranges == {"a": None, "b": "-4 4"}


def test_only_what_neither_touches_nor_shows_is_left_out(tmp_path: Path) -> None:
    kinds = {"shown": (0, 0, 2), "by_type": (1, 0, 3), "by_affinity": (0, 1, 3), "hidden": (0, 0, 3)}
    geoms = [
        f'<geom name="{name}" size="1" contype="{one}" conaffinity="{two}" group="{group}"/>'
        for name, (one, two, group) in kinds.items()
    ]
    root = left(NO_HIDDEN_SHAPES, "".join(geoms), tmp_path)
    assert [each.get("name") for each in root.iter("geom")] == ["shown", "by_type", "by_affinity"]


@pytest.mark.parametrize(("kind", "fields"), [("ellipsoid", 1), ("hfield", 0)])
def test_a_height_field_that_is_used_stays(tmp_path: Path, kind: str, fields: int) -> None:
    field = '<asset><hfield name="t" nrow="2" ncol="2" size="1 1 .1 .1" elevation="0 0 0 1"/></asset>'
    geoms = '<geom type="hfield" hfield="t"/><geom type="ellipsoid" size="1 2 3"/><geom size="1"/>'
    root = left(no_shapes(kind), geoms, tmp_path, field)
    assert len(list(root.iter("geom"))) == 2 and len(list(root.iter("hfield"))) == fields


def test_references_are_gone(tmp_path: Path) -> None:
    bundle, _ = written(SELDOM, "newton", tmp_path)
    assert bundle is not None and b" ref=" not in bundle.files["model.xml"]


def test_free_bodies_stay_outside_of_the_one_root(tmp_path: Path) -> None:
    text = (
        SELDOM.replace("</worldbody>", '<body name="cube"><freejoint/><geom size="0.1"/></body></worldbody>')
        .replace('<key name="home" qpos="0.4 0.1 0 0.2 0.2"/>', '<key name="home"/>')
        .replace('<joint name="slide" type="slide" axis="1 0 0" range="-0.1 0.2" ref="0.05"/>', "")
        .replace('<motor name="slide" joint="slide" gear="2" ctrlrange="-5 5"/>', "")
    )
    bundle, _ = written(text, "pybullet", tmp_path)
    assert bundle is not None
    model = compiled(bundle, tmp_path / "out")
    parents = {model.body(n).name: model.body(int(model.body_parentid[n])).name for n in range(1, model.nbody)}
    assert parents["stand"] == NAME and parents["cube"] == "world"
