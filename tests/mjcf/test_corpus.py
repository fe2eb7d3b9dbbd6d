"""Real models: what is read and written again is the same model."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from sampling import rest_slow

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")

Differences = Callable[[mujoco.MjModel, mujoco.MjModel], list[str]]


def assert_unchanged(path: Path, differences: Differences) -> None:
    expected = mujoco.MjModel.from_xml_path(str(path))
    root = mjcf.from_path(path)
    for each in root.find_all("geom") + root.find_all("joint"):
        each.get_attributes()
    found = mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)
    assert differences(expected, found) == []


@pytest.mark.parametrize(
    "name", rest_slow(["ur5e", "2f85", "fetch", "shadow_hand", "adroit", "kitchen"], ["2f85", "fetch"])
)
def test_packaged_models_are_unchanged(name: str, packaged_models: dict[str, Path], differences: Differences) -> None:
    assert_unchanged(packaged_models[name], differences)


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")
def test_models_of_the_corpus_are_unchanged(differences: Differences) -> None:
    corpus = Path(FOLDER or "")
    one_of_each = [min(folder.glob("*.xml"), default=None) for folder in (corpus / "models").iterdir()]
    paths = [path for path in one_of_each if path] + sorted((corpus / "feature-cases").glob("*/*.xml"))
    tried = 0
    for path in paths:
        try:
            mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            continue
        assert_unchanged(path, differences)
        tried += 1
    assert tried > 80
