from __future__ import annotations

from importlib import metadata

import mujoco
import pytest
from mjcompose.mujoco import fit as making
from mjcompose.mujoco.fit import make


def test_a_package_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        if name == "coacd":
            raise metadata.PackageNotFoundError(name)
        return "1"

    monkeypatch.setattr(making.metadata, "version", version)
    argument = {"mesh": {}, "method": "decompose", "wanted": {}, "most_faces": 1}
    assert make(mujoco, argument) == {"missing": "coacd"}
