"""What tests of targets share."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import pytest
from mjcompose.mujoco.attributes import save_digits


@pytest.fixture(autouse=True)
def six_digits() -> Iterator[None]:
    """`plain` runs in this process and has MuJoCo save all digits, which later tests would see."""
    yield
    save_digits(mujoco, 6)
