"""The programs that checks ask about. `composer/targets` says what each lacks, and reads models back in them."""

from __future__ import annotations

RUN_ON = (
    "drake",
    "pinocchio",
    "pybullet",
    "newton",
    "genesis",
    "mjx",
    "warp",
    "isaac",
    "urdf",
)
"""Those of which it is known what they lack: the targets of `build --target`, without MuJoCo itself."""
READ_IN = ("drake", "pinocchio", "pybullet", "newton", "genesis", "mjx", "warp", "urdf")
"""Those in which a model can be read back."""
