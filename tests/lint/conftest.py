from __future__ import annotations

from collections.abc import Iterator

import pytest
from mjcompose.mujoco.engine import Session
from verify.checks.conftest import ask

__all__ = ["ask", "session"]


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as opened:
        yield opened
