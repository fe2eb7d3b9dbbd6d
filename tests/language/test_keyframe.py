from __future__ import annotations

from mjcompose.language.recipe import Recipe
from mjcompose.text.expression import Angle


def test_read() -> None:
    recipe = Recipe.model_validate(
        {
            "recipe": 1,
            "keyframe": {
                "a": {
                    "from": {"base": "home", "left/gripper": "open"},
                    "time": 2,
                    "qpos": {"hinge": "90deg", "ball": [1, 0, 0, 0]},
                    "mquat": {"goal": [1, 0, 0, 0]},
                },
                "b": {},
            },
        }
    )
    first, second = recipe.keyframe.values()
    assert ([*recipe.keyframe], first.time) == (["a", "b"], 2.0)
    assert first.sources == {"base": "home", "left/gripper": "open"}
    assert first.values == {
        "qpos": {"hinge": (Angle(90.0, "deg"),), "ball": (1, 0, 0, 0)},
        "mquat": {"goal": (1, 0, 0, 0)},
    }
    assert (second.time, second.sources, second.values) == (None, {}, {})
