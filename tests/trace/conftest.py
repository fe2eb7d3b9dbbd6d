"""Models that are put together under observation, each once for all tests; none needs the network."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import mujoco
import pytest
from mjcompose.sources.context import Context
from mjcompose.trace.traced import Traced, trace

REPOSITORY = Path(__file__).resolve().parents[2]
TESTS = str(REPOSITORY / "tests")
if TESTS not in sys.path:  # `tests.trace.proof` and `fidelity.corpus`, however pytest is started
    sys.path.insert(0, TESTS)
GOLDEN = REPOSITORY / "tests" / "golden"
MEASURED = Path(__file__).resolve().parent / "measured" / "recipe.yaml"
NEWER = hasattr(mujoco.MjSpec, "fuse_static")
RECIPES = [
    # What an older MuJoCo makes of a URDF has no frames of fused links.
    *(path for path in sorted(GOLDEN.glob("*/recipe.yaml")) if path.parent.name != "urdf" or NEWER),
    MEASURED,
    *(path for path in sorted((REPOSITORY / "recipes").glob("*.yaml")) if not path.name.startswith("menagerie")),
]


@cache
def _traced(recipe: Path) -> Traced:
    context = Context(environment={}, folder=recipe.parent)
    found = trace(Path(recipe.name), context)
    assert found is not None, [each.message for each in context.sink.diagnostics]
    return found


@pytest.fixture(params=RECIPES, ids=lambda path: path.parent.name if path.name == "recipe.yaml" else path.stem)
def recipe(request: pytest.FixtureRequest) -> Path:
    """Each golden recipe, and each of the examples."""
    path: Path = request.param
    return path


@pytest.fixture
def traced(recipe: Path) -> Traced:
    """Its model, with all that happened to it; to be looked at only."""
    return _traced(recipe)
