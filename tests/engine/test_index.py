from __future__ import annotations

from composer.engine.index import Actuator, Index, Joint, Sensor


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
        "actuators": [{"name": "a", "ctrl": [2, 3], "act": [4, 5]}],
        "sensors": [{"name": "s", "type": "gyro", "data": [8, 3]}],
        "keyframes": ["k"],
        "cameras": [],
        "bodies": ["world", "b"],
    }
    assert Index.from_data(data) == Index(
        joints=(Joint("j", "ball", 7, 4, 6, 3, True, (0, 1), "b"),),
        actuators=(Actuator("a", 2, 3, 4, 5),),
        sensors=(Sensor("s", "gyro", 8, 3),),
        keyframes=("k",),
        cameras=(),
        bodies=("world", "b"),
    )
