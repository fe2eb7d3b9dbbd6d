"""Real models: what is read and written again is the same model."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import numpy as np
import pytest

from composer import mjcf

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")
_OF_PATHS = {"signature", "nbuffer", "paths", "npaths"}


def differences(one: mujoco.MjModel, other: mujoco.MjModel) -> list[str]:
    """The arrays and sizes of `mjModel` that are not equal to the bit; where files are may differ."""
    found = []
    for name in dir(one):
        value = None if name.startswith("_") else getattr(one, name)
        if not isinstance(value, np.ndarray | int | float) or name in _OF_PATHS or "path" in name:
            continue
        floats = isinstance(value, np.ndarray) and value.dtype.kind == "f"
        if not np.array_equal(value, getattr(other, name), equal_nan=floats):
            found.append(name)
    return found


def assert_unchanged(path: Path) -> None:
    expected = mujoco.MjModel.from_xml_path(str(path))
    root = mjcf.from_path(path)
    for each in root.find_all("geom") + root.find_all("joint"):
        each.get_attributes()
    found = mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)
    assert differences(expected, found) == []


def test_packaged_models_are_unchanged(packaged_models: dict[str, Path]) -> None:
    for path in packaged_models.values():
        assert_unchanged(path)


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")
def test_models_of_the_corpus_are_unchanged() -> None:
    corpus = Path(FOLDER or "")
    one_of_each = [min(folder.glob("*.xml"), default=None) for folder in (corpus / "models").iterdir()]
    paths = [path for path in one_of_each if path] + sorted((corpus / "feature-cases").glob("*/*.xml"))
    tried = 0
    for path in paths:
        try:
            mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            continue
        assert_unchanged(path)
        tried += 1
    assert tried > 80
