"""The bytes of every bundle of the recipes and the golden cases: nothing that moves code may change one.

`UPDATE_EXPECTED=1 pytest tests/golden/test_bundles.py` writes `bundles.txt` anew; say in the commit why it changed.
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Span
from mjcompose.bundle.bundle import MANIFEST, MODEL
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.node import Scalar

HERE = Path(__file__).resolve().parent
RECIPES = HERE.parents[1] / "recipes"
EXPECTED = HERE / "bundles.txt"
WRITTEN_WITH = ("4.0.0", "linux", "x86_64")
CASES = {
    **{f"golden/{file.parent.name}": file for file in sorted(HERE.glob("*/recipe.yaml"))},
    **{f"recipes/{file.stem}": file for file in sorted(RECIPES.glob("*.yaml"))},
}
_DIGITS = 16


def digests(recipe: Path) -> str:
    """Shortened hashes of the model, of the manifest, and of all paths and contents."""
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    root = {"MENAGERIE_ROOT": str(Path(corpus, "models"))} if corpus else {}
    context = Context(environment=root, folder=recipe.parent)
    worlds = recipe.stem == "held_payload"  # MuJoCo computes them
    given = {"worlds": Scalar(8, Span("", 1, 1), "8", plain=True)} if worlds else {}
    built = build(ModelRequest(recipe, given=given, verified=worlds, worlds=worlds), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    files = built.bundle.files
    model, manifest = (hashlib.sha256(files[name]).hexdigest() for name in (MODEL, MANIFEST))
    return " ".join(each[:_DIGITS] for each in (model, manifest, built.bundle.sha256))


def expected() -> dict[str, str]:
    lines = EXPECTED.read_text(encoding="ascii").splitlines() if EXPECTED.exists() else []
    return dict(line.split(" ", 1) for line in lines)


@pytest.mark.skipif(
    (mujoco.__version__, sys.platform, platform.machine()) != WRITTEN_WITH, reason=f"written with {WRITTEN_WITH}"
)
@pytest.mark.parametrize(
    "case", [pytest.param(each, marks=pytest.mark.slow if "menagerie" in each else ()) for each in CASES]
)
def test_bytes(case: str) -> None:
    if case.startswith("recipes/menagerie") and not os.environ.get("MJCOMPOSE_CORPUS"):
        pytest.skip("MJCOMPOSE_CORPUS names no corpus")
    if case.endswith(("/xacro", "/xacro_arm")):
        pytest.importorskip("xacro")
    found = digests(CASES[case])
    known = expected()
    if os.environ.get("UPDATE_EXPECTED"):
        known[case] = found
        EXPECTED.write_text("".join(f"{each} {known[each]}\n" for each in CASES if each in known), "ascii")
    assert found == known.get(case), "model.xml, manifest.json and the whole bundle, in this order"


def test_every_bundle_has_a_line() -> None:
    assert list(expected()) == list(CASES)
