"""A folder with recipes, and a store of its own for every test."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

TESTS = str(Path(__file__).resolve().parents[2])
if TESTS not in sys.path:
    sys.path.insert(0, TESTS)

from cli.conftest import folder  # noqa: E402, F401

MATRIX = """\
recipe: 1
name: cell
base: ./models/arm.xml
params: {load: 1.0}
variants:
  tool:
    none: {}
    palm: {attach: {tool: {model: ./models/tool.xml, site: flange}}}
add:
  - {to: link, geom: {type: sphere, size: [0.1], mass: "${load}", pos: [0, 0, 0.2]}}
matrix:
  axes: {tool: [none, palm], load: [1.0, 2.0]}
check: {heavy: {expect: {attr: mass, range: [0.1, 100000]}}}
"""


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: Path) -> Path:  # noqa: F811
    """The folder of the store; `matrix.yaml` is a recipe of four cells."""
    (folder / "matrix.yaml").write_text(MATRIX)
    store = tmp_path / "store"
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(store))
    return store
