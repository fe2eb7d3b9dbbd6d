"""The programs that checks are about. `composer/targets` knows what each lacks, and reads models back in them."""

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
NOT_READ_IN = {
    name: f"no check reads models in it; `runs_on: [{name}]` says what it lacks"
    for name in RUN_ON
    if name not in READ_IN
}
"""What helps somebody who names one of the others for that."""
