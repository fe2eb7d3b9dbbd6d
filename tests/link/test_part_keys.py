from __future__ import annotations

from link.workshop import BASE, Piece, Workshop, placed

from composer.link.part_keys import part_keys
from composer.numerics.pose import quat_from_axisangle
from composer.tree.key_number import texts

HINGE = """
<mujoco><worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="home" time="2" qpos="3"/><key qpos="4"/></keyframe></mujoco>
"""
LOOSE = """
<mujoco><worldbody><body name="b"><freejoint name="j"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="home" qpos="1 0 0 1 0 0 0"/></keyframe></mujoco>
"""


def test_by_path_and_by_joint(workshop: Workshop) -> None:
    turned = placed(pos=(0, 0, 5), quat=quat_from_axisangle((0, 0, 1), 3.141592653589793))
    linking = workshop.link(HINGE, Piece(HINGE, "a/"), Piece(LOOSE, "b/", turned)).linking
    found = part_keys(linking)
    assert {path: keys.names for path, keys in found.items()} == {
        "base": ["home"],
        "a": ["home"],
        "b": ["home"],
    }
    key = found["a"].named("home")
    assert key is not None and key.time is not None and key.time.text == "2"
    assert {node.get("name"): texts(row) for node, row in key.values["qpos"].items()} == {"a/j": ["3"]}
    assert key.values["qpos"].popitem()[1][0].source.moved == ()
    assert len(found["a"].keys) == 2
    moved = found["b"].named("home")
    assert moved is not None
    (columns,) = moved.values["qpos"].values()
    assert [round(float(number.text), 12) for number in columns[:3]] == [-1, 0, 5]
    assert [len(number.source.moved) for number in columns] == [1] * 7
    assert found["a"].named("other") is None


def test_they_are_remembered_for_what_the_model_becomes_a_part_of(workshop: Workshop) -> None:
    linking = workshop.link(BASE, Piece(HINGE, "a/")).linking
    assert linking.base.part_keys["a"].depth == 1
    assert (
        "a"
        not in workshop.link(BASE, Piece(HINGE, "a/", options={"keyframes": "none"})).linking.base.part_keys
    )
