"""The table of all targets."""

from __future__ import annotations

from collections.abc import Mapping

from composer.recipe.checks.simulators import RUN_ON
from composer.recipe.rows import check_rows
from composer.targets.consumers import (
    drake,
    genesis,
    isaac,
    mjx,
    newton,
    pinocchio,
    plain,
    pybullet,
    urdf,
    warp,
)
from composer.targets.features import FEATURES
from composer.targets.names import MUJOCO, NAMES
from composer.targets.target import Target

PLAIN = plain.TARGET
_ALL = (
    plain,
    drake,
    pinocchio,
    pybullet,
    newton,
    genesis,
    mjx,
    warp,
    isaac,
    urdf,
)
TARGETS: Mapping[str, Target] = {each.TARGET.name: each.TARGET for each in _ALL}

check_rows("the targets of composer/targets/table.py", [MUJOCO, *TARGETS], NAMES)
check_rows("the simulators of the check `runs_on`", RUN_ON, [name for name in TARGETS if name != PLAIN.name])
check_rows(
    "the features of composer/targets/features.py",
    FEATURES,
    dict.fromkeys(limit.feature for target in TARGETS.values() for limit in target.limits),
)
