"""Every case here is a wrong recipe, or one with a wrong source, and what a build prints about it.

A case is a text file, as `tests/cases.py` says, in the folder of its topic. Its settings: `errors`, how many there are
(1 where it does not say; with 0 the model is built, and something is told of it); `place: none` where there is no file to
point at; `as: worlds`,
the output of the build; `needs`, an optional package; `mujoco`, the only version that says so.

`UPDATE_EXPECTED=1 pytest tests/errors` writes the texts anew; read what changed.
"""

from __future__ import annotations

import os
import re
from importlib.metadata import version
from pathlib import Path

import pytest
from cases import Case, cases, uncounted
from mjcompose.base.diagnostic import Severity
from mjcompose.base.report import render, summary
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

HERE = Path(__file__).resolve().parent
CASES = cases(HERE)
SETTINGS = {"as", "errors", "place", "needs", "mujoco"}
MUJOCO = "4.0"


def told(context: Context) -> str:
    """What the command prints on standard error."""

    def read(file: str) -> str | None:
        try:
            return (context.folder / file).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return None

    found = context.sink.sorted()
    return "".join(f"{render(each, read)}\n\n" for each in found) + summary(found) + "\n"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_error(case: Case, tmp_path: Path) -> None:
    settings = case.settings
    assert settings.keys() <= SETTINGS
    if needs := settings.get("needs"):
        pytest.importorskip(needs)
    if not version("mujoco").startswith(settings.get("mujoco", "")):
        pytest.skip("another MuJoCo builds this, or says something else of it")
    folder = case.lay(tmp_path / case.path.stem)
    context = Context(environment={}, folder=folder)
    request = ModelRequest(folder / "recipe.yaml", worlds=settings.get("as") == "worlds")
    built = build(request, context)
    text = uncounted(told(context).replace(f"{folder}{os.sep}", "FOLDER/").replace(f"{folder}", "FOLDER"))
    expected = case.check(text)
    errors = int(settings.get("errors", 1))  # one cause is one error
    assert (len(context.sink.errors), built is not None) == (errors, errors == 0)
    if "MuJoCo rejects" in expected and not version("mujoco").startswith(MUJOCO):
        place = re.compile(r"^\S+ error\[\S+\]", re.MULTILINE)
        assert place.findall(text) == place.findall(expected)  # the words are those of MuJoCo
    else:
        assert text == expected
    for each in context.sink.diagnostics:
        assert each.severity is not Severity.ERROR or each.span is not None or settings.get("place") == "none"
        assert not re.match(r"[A-Z](?!PU\b)(?!uJoCo)[a-z]", each.message), "lower case"
        assert not each.message.endswith(".")


def test_every_file_is_of_a_case() -> None:
    ours = {HERE / "test_errors.py", HERE / "test_files.py", *(each.path for each in CASES)}
    beside = {each.path.with_suffix("") for each in CASES}
    files = [path for path in HERE.rglob("*") if path.is_file() and path.suffix != ".pyc"]
    assert [path for path in files if path not in ours and not beside & {*path.parents}] == []
    assert len(CASES) >= 465
