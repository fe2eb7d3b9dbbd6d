"""Restrictions that write a model otherwise: it moves as before."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree
from targets.models import SELDOM
from targets.writing import compiled, written

from composer.targets.judging import questions
from composer.targets.limit import Limit
from composer.targets.plain.plain import plain
from composer.targets.restrictions.tree import NAME, NO_REFERENCES, one_root


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
    parents = {
        model.body(n).name: model.body(int(model.body_parentid[n])).name for n in range(1, model.nbody)
    }
    assert parents["stand"] == NAME and parents["cube"] == "world"
