from __future__ import annotations

from composer.compiled.index import Actuator, Camera, Index, Joint, Keyframe, Sensor


def test_it_is_made_from_what_the_child_sends() -> None:
    data = {
        "joints": [
            {
                "name": "j",
                "type": "ball",
                "qpos": [7, 4],
                "dof": [6, 3],
                "limited": True,
                "range": [0, 1],
                "body": "b",
            }
        ],
        "actuators": [
            {
                "name": "a",
                "ctrl": [2, 3],
                "act": [4, 5],
                "unit": "rad",
                "ctrl_ranges": [None, [0, 1], None],
                "act_range": None,
                "force_range": [-1, 1],
            }
        ],
        "sensors": [{"name": "s", "type": "gyro", "data": [8, 3], "unit": "rad/s", "cutoff": None}],
        "keyframes": [{"name": "k", "time": 0.5}],
        "cameras": [{"name": "c", "body": "b", "fovy": 45, "unit": "deg", "resolution": [4, 3]}],
        "bodies": ["world", "b"],
    }
    assert Index.from_data(data) == Index(
        joints=(Joint("j", "ball", 7, 4, 6, 3, True, (0, 1), "b"),),
        actuators=(Actuator("a", 2, 3, 4, 5, "rad", (None, (0, 1), None), None, (-1, 1)),),
        sensors=(Sensor("s", "gyro", 8, 3, "rad/s"),),
        keyframes=(Keyframe("k", 0.5),),
        cameras=(Camera("c", "b", 45, "deg", (4, 3)),),
        bodies=("world", "b"),
    )
