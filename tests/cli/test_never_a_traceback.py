"""Whatever stands in a recipe or a source: it is built, or told what is wrong. An exception is a bug."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from mjcompose.base.report import render
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

RECIPES = Path(__file__).resolve().parents[2] / "recipes"
Text = Callable[[str], str]

# What is put in the place of a value, or between two characters.
ODD = (
    "",
    " ",
    "0",
    "-1",
    "1e999",
    "nan",
    "null",
    "~",
    "true",
    "''",
    '""',
    "[]",
    "{}",
    "[[]]",
    "- -",
    "?",
    "&a",
    "*a",
    "!x",
    "${x}",
    "world",
    "main",
    "base",
    "/",
    "//",
    "arm/",
    "é",
    "\t",
    "\x00",
    "\u2028",
    "'",
    '"',
    "#",
    ": :",
    "|",
    ">",
    "%",
    "90deg",
    "1rad",
    "[1, 2, 3]",
    "[a, b]",
    "{a: 1}",
    "./demo.yaml",
    "../..",
    "package:os/x.xml",
    "2023-01-01",
    "<<: *a",
    "1" * 400,
    "[" * 60,
)
ODD_XML = (
    "",
    " ",
    "0",
    "-1",
    "1e999",
    "nan",
    "inf",
    "0x10",
    "1 2",
    "1 2 3 4 5 6 7 8 9 10",
    "true",
    "auto",
    "world",
    "main",
    "é",
    "a b",
    "/",
    "\t",
    "x" * 300,
    "<",
    "&amp;",
    "&",
    "'",
    "arm6.xml",
    "../..",
    "-",
    "1,2",
    "free",
    "mocap",
)


@st.composite
def _edits(draw: st.DrawFn, odd: tuple[str, ...], tokens: str) -> Text:
    """A few small changes, as they happen to somebody who writes."""
    steps = []
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(("drop", "repeat", "swap", "indent", "value", "insert", "cut", "word")))
        where = draw(st.floats(0, 1, exclude_max=True))
        steps.append((kind, where, draw(st.sampled_from(odd)), draw(st.floats(0, 1, exclude_max=True))))

    def edit(text: str) -> str:
        for kind, where, replacement, other in steps:
            text = _edited(text, kind, where, replacement, other, tokens)
        return text

    return edit


def _edited(text: str, kind: str, where: float, replacement: str, other: float, tokens: str) -> str:
    lines = text.splitlines(keepends=True)
    if not lines:
        return replacement
    at = int(where * len(lines))
    to = int(other * len(lines))
    if kind == "drop":
        del lines[at]
    elif kind == "repeat":
        lines.insert(to, lines[at])
    elif kind == "swap":
        lines[at], lines[to] = lines[to], lines[at]
    elif kind == "indent":
        lines[at] = "  " + lines[at] if other < 0.5 else lines[at][2:]
    elif kind in ("value", "word"):
        pieces = _pieces(text, tokens)
        chosen = int(where * len(pieces))
        pieces[chosen] = replacement if kind == "value" else pieces[int(other * len(pieces))]
        return "".join(pieces)
    else:
        place = int(where * len(text))
        return text[:place] + replacement + text[place:] if kind == "insert" else text[:place]
    return "".join(lines)


def _pieces(text: str, tokens: str) -> list[str]:
    """The text in words and what stands between them."""
    pieces = [""]
    for character in text:
        if character in tokens:
            pieces += [character, ""]
        else:
            pieces[-1] += character
    return pieces


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the shipped recipes; the recipe and the models that are changed are written beside them."""
    folder = tmp_path_factory.mktemp("fuzz") / "recipes"
    shutil.copytree(RECIPES, folder, ignore=shutil.ignore_patterns("*.png"))
    (folder / "models/table/textures/wood.png").parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(RECIPES / "models/table/textures/wood.png", folder / "models/table/textures/wood.png")
    return folder


def _build(recipe: Path) -> None:
    context = Context(environment={}, folder=recipe.parent)
    built = build(ModelRequest(recipe, verified=False), context)
    assert (built is None) == bool(context.sink.errors)
    for each in context.sink.diagnostics:
        told = render(each, lambda file: (recipe.parent / file).read_text(encoding="utf-8", errors="replace"))
        assert told


# The same examples every time, unless more are asked for.
EXAMPLES = int(os.environ.get("MJCOMPOSE_EXAMPLES", "120"))
QUICK = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="MJCOMPOSE_EXAMPLES" not in os.environ,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@QUICK
@given(edit=_edits(ODD, " \n:,[]{}"), name=st.sampled_from(("demo", "gantry", "two_arms")))
def test_recipe(folder: Path, edit: Text, name: str) -> None:
    text = edit((RECIPES / f"{name}.yaml").read_text(encoding="utf-8"))
    changed = folder / "changed.yaml"
    changed.write_text(text, encoding="utf-8", errors="surrogatepass")
    _build(changed)


@QUICK
@given(
    edit=_edits(ODD_XML, ' \n"=<>/'),
    name=st.sampled_from(("arm6/arm6", "gripper2/gripper2", "table/table", "props/cube", "camera_mount/camera_mount")),
    policy=st.sampled_from(("error", "warning", "merge")),
)
def test_source(folder: Path, edit: Text, name: str, policy: str) -> None:
    source = RECIPES / "models" / f"{name}.xml"
    changed = folder / "models" / Path(name).parent / "changed.xml"
    changed.write_text(edit(source.read_text(encoding="utf-8")), encoding="utf-8")
    recipe = folder / "around.yaml"
    recipe.write_text(
        f"recipe: 1\nconflict: {policy}\nbase: ./models/arm6/arm6.xml\n"
        f"attach:\n  changed: {{model: ./models/{Path(name).parent}/changed.xml, pos: [0, 0, 1]}}\n"
        "  cube: {model: ./models/props/cube.xml, pos: [1, 0, 0]}\n",
        encoding="utf-8",
    )
    _build(recipe)


@pytest.mark.parametrize("name", ["arm6/arm6", "gripper2/gripper2"])
@settings(parent=QUICK, max_examples=EXAMPLES // 2)
@given(edit=_edits(ODD_XML, ' \n"=<>/'))
def test_base(folder: Path, name: str, edit: Text) -> None:
    source = RECIPES / "models" / f"{name}.xml"
    changed = folder / "models" / Path(name).parent / "changed.xml"
    changed.write_text(edit(source.read_text(encoding="utf-8")), encoding="utf-8")
    recipe = folder / "upon.yaml"
    recipe.write_text(
        f"recipe: 1\nconflict: mujoco\nbase: ./models/{Path(name).parent}/changed.xml\n"
        "attach:\n  cube: {model: ./models/props/cube.xml, pos: [1, 0, 0]}\n"
        "add:\n  - {to: world, body: {name: more, joint: [{name: more}], geom: [{size: [0.1]}]}}\n",
        encoding="utf-8",
    )
    _build(recipe)
