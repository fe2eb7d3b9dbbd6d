"""The bytes of every model and its files, of the recipes and the golden cases: nothing that moves code may change one.

Manifests also hold hashes of recipes and words of messages, which may change: one is compared as text, `manifest/manifest.json`.

`UPDATE_EXPECTED=1 pytest tests/golden/test_bundles.py` writes `bundles.txt` and the manifest anew; say in the commit why
they changed.
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Mapping
from pathlib import Path

import mujoco
import pytest
from mjcompose.base import __version__
from mjcompose.base.diagnostic import Span
from mjcompose.bundle.bundle import MANIFEST, MODEL
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.node import Scalar
from sampling import need_robots

HERE = Path(__file__).resolve().parent
RECIPES = HERE.parents[1] / "recipes"
EXPECTED = HERE / "bundles.txt"
WRITTEN_WITH = ("4.0.0", "linux", "x86_64")
CASES = {
    **{f"golden/{file.parent.name}": file for file in sorted(HERE.glob("*/recipe.yaml"))},
    **{f"recipes/{file.stem}": file for file in sorted(RECIPES.glob("*.yaml"))},
}
_DIGITS = 16
written_here = pytest.mark.skipif(
    (mujoco.__version__, sys.platform, platform.machine()) != WRITTEN_WITH, reason=f"written with {WRITTEN_WITH}"
)


def digests(recipe: Path) -> str:
    """Return shortened hashes of the model, and of the paths and contents of all other files except the manifest."""
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    root = {"MENAGERIE_ROOT": str(Path(corpus, "models"))} if corpus else {}
    context = Context(environment=root, folder=recipe.parent)
    worlds = recipe.stem == "held_payload"  # MuJoCo computes them
    given = {"worlds": Scalar(8, Span("", 1, 1), "8", plain=True)} if worlds else {}
    built = build(ModelRequest(recipe, given=given, verified=worlds, worlds=worlds), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    return in_short(built.bundle.files)


def in_short(files: Mapping[str, bytes]) -> str:
    model = hashlib.sha256(files[MODEL]).hexdigest()
    assets = hashlib.sha256()
    for path in sorted(files.keys() - {MODEL, MANIFEST}):
        assets.update(f"{path}\0{hashlib.sha256(files[path]).hexdigest()}\n".encode())
    return f"{model[:_DIGITS]} {assets.hexdigest()[:_DIGITS]}"


def expected() -> dict[str, str]:
    lines = EXPECTED.read_text(encoding="ascii").splitlines() if EXPECTED.exists() else []
    return dict(line.split(" ", 1) for line in lines)


@written_here
@pytest.mark.parametrize(
    "case", [pytest.param(each, marks=pytest.mark.slow if "menagerie" in each else ()) for each in CASES]
)
def test_bytes(case: str) -> None:
    if case.startswith("recipes/menagerie"):
        if not os.environ.get("MJCOMPOSE_CORPUS"):
            pytest.skip("MJCOMPOSE_CORPUS names no corpus")
        need_robots(CASES[case], Path(os.environ["MJCOMPOSE_CORPUS"], "models"))
    if case.endswith(("/xacro", "/xacro_arm")):
        pytest.importorskip("xacro")
    found = digests(CASES[case])
    known = expected()
    if os.environ.get("UPDATE_EXPECTED"):
        known[case] = found
        EXPECTED.write_text("".join(f"{each} {known[each]}\n" for each in CASES if each in known), "ascii")
    assert found == known.get(case), "model.xml, and all other files except the manifest, in this order"


def test_the_words_of_a_manifest_count_nothing_and_its_files_do() -> None:
    files = {MODEL: b"<mujoco/>", MANIFEST: b"{}", "assets/a.stl": b"a"}
    assert in_short({**files, MANIFEST: b'{"description": "another"}'}) == in_short(files)
    assert in_short({**files, MODEL: b"<mujoco></mujoco>"}).split()[1] == in_short(files).split()[1]
    assert in_short({**files, "assets/a.stl": b"b"}).split()[0] == in_short(files).split()[0]
    assert len({in_short(each) for each in ({**files, "assets/a.stl": b"b"}, {**files, "b": b""}, files)}) == 3


@written_here
def test_manifest() -> None:
    folder = HERE / "manifest"
    context = Context(environment={}, folder=folder)
    given = {"tool": Scalar("gripper", Span("", 1, 1), "gripper", plain=True)}
    built = build(ModelRequest(folder / "recipe.yaml", given=given, sample=1), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    text = built.bundle.files[MANIFEST].decode().replace(f'"mjcompose": "{__version__}"', '"mjcompose": "VERSION"')
    file = folder / "manifest.json"
    if os.environ.get("UPDATE_EXPECTED"):
        file.write_text(text, encoding="utf-8")
    assert text == file.read_text(encoding="utf-8")


WITHOUT_A_LINE = ("recipes/menagerie_so101",)
"""Recipes with a robot that the corpus does not have."""


def test_every_bundle_has_a_line() -> None:
    assert list(expected()) == [name for name in CASES if name not in WITHOUT_A_LINE]
