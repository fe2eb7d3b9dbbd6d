"""The names of the targets, for the command line and the check `targets`. `table.py` has the targets themselves."""

from __future__ import annotations

MUJOCO = "mujoco"
"""The target that a bundle is for as it is composed."""
NAMES = (
    MUJOCO,
    "plain",
    "drake",
    "pinocchio",
    "pybullet",
    "newton",
    "genesis",
    "mjx",
    "warp",
    "isaac",
    "urdf",
    "ros2",
)
READ_IN = ("drake", "pinocchio", "pybullet", "newton", "genesis", "mjx", "warp", "urdf")
"""The targets in which a model can be read back."""
CONSUMERS = "MJCOMPOSE_CONSUMERS"
"""The variable that names the folder with environments in which models are read back, one for each program."""
