"""One server for the tests that only ask, and a folder of small recipes."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from lsp.client import Editor

pytest.importorskip("pygls", reason="the extra `lsp` is not installed")
REPOSITORY = Path(__file__).resolve().parents[2]
RECIPES = REPOSITORY / "recipes"
CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
ROBOTS = Path(CORPUS, "models") if CORPUS else None
needs_robots = pytest.mark.skipif(
    ROBOTS is None or not ROBOTS.is_dir(), reason="MJCOMPOSE_CORPUS does not name the models of MuJoCo Menagerie"
)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped recipes and their models, to be written to."""
    made = tmp_path_factory.mktemp("recipes")
    shutil.copytree(RECIPES, made, dirs_exist_ok=True)
    (made / "pyproject.toml").touch()
    return made


@pytest.fixture(scope="session")
def editor(folder: Path) -> Iterator[Editor]:
    """An editor for all tests; its log has what went wrong in the server."""
    environment = {**os.environ, **({"MENAGERIE_ROOT": str(ROBOTS)} if ROBOTS is not None else {})}
    with Editor(folder, environment=environment) as found:
        yield found
        assert not found.log, "\n".join(found.log)
