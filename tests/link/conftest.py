"""Makes the workshop importable as `link.workshop`, however pytest is started."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

TESTS = str(Path(__file__).resolve().parent.parent)
if TESTS not in sys.path:
    sys.path.insert(0, TESTS)

from link.workshop import Workshop  # noqa: E402


@pytest.fixture
def workshop(tmp_path: Path) -> Workshop:
    """A folder in which models are written, linked and compiled."""
    return Workshop(tmp_path)
