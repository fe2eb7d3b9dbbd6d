from __future__ import annotations

import pytest

from composer.tree.glob import is_glob, matcher


@pytest.mark.parametrize(
    ("glob", "separator", "name", "fits"),
    [
        ("*", "/", "pad", True),
        ("*", "/", "gripper/pad", False),
        ("**", "/", "gripper/pad", True),
        ("**/pad", "/", "pad", True),
        ("**/pad", "/", "left/gripper/pad", True),
        ("**/pad", "/", "left_pad", False),
        ("*/pad?", "/", "gripper/pad1", True),
        ("{left,right}/*", "/", "right/base", True),
        ("{left,right}/*", "/", "middle/base", False),
        ("left:*", ":", "left:a", True),
        ("left:*", ":", "left:a:b", False),
        ("left_*", "_", "left_arm_base", True),
        ("a.b*", "/", "axb", False),
        ("{a", "/", "{a", True),
    ],
)
def test_what_fits(glob: str, separator: str, name: str, fits: bool) -> None:
    assert matcher(glob, separator)(name) is fits


def test_what_is_a_glob() -> None:
    assert is_glob("a*") and is_glob("a?") and is_glob("{a,b}") and not is_glob("gripper/pad#[1]")
