"""The number of digits that MuJoCo saves."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any


def save_all_digits(mujoco: Any) -> None:
    """Make MuJoCo save numbers that read back to the same bits.

    It saves six digits by default. Raises ValueError for a version that cannot save more.
    """
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco*.dll"):
        for library in folder.glob(pattern):
            ctypes.CDLL(str(library))._mjPRIVATE__set_xml_precision(17)
            return
    raise ValueError("this version of MuJoCo saves rounded numbers only")
