from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from composer.diagnostics import CODES
from composer.sources import Source, SourceError
from composer.sources.fetching import Fetching
from composer.sources.resolve import resolve


@pytest.mark.parametrize(
    "text", ["", "./no.xml", "package:none/a.xml", "menagerie:none", "http://127.0.0.1:9/a.zip#b.xml"]
)
def test_every_code_is_declared(tmp_path: Path, own_environment: dict[str, str], text: str) -> None:
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=tmp_path, environment=own_environment)
    assert caught.value.code in CODES
    assert str(caught.value) == caught.value.message


def test_the_room_is_light(repository: Path) -> None:
    heavy = ["mujoco", "numpy", "pydantic", "yaml", "lxml", "click", "mujoco_menagerie", "importlib.metadata"]
    # Without site: what the .pth files of an environment import is none of the room's doing.
    code = (
        f"import sys; sys.path.insert(0, {str(repository)!r}); import composer.sources; "
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    command = [sys.executable, "-I", "-S", "-c", code]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_a_path_in_what_was_fetched_belongs_to_it(
    robots: Any, own_environment: dict[str, str], tmp_path: Path
) -> None:
    robots.commit(**{"arm/cell.yaml": "recipe: 1\n"})
    fetching = Fetching()

    def take(reference: str, folder: Path) -> Source:
        return resolve(reference, relative_to=folder, environment=own_environment, fetching=fetching)

    recipe = take(robots.reference("main", "arm/cell.yaml"), tmp_path)
    inside = take("./arm.xml", recipe.path.parent)
    assert inside.origin == recipe.origin and inside.version == recipe.version
    assert [path.name for path in inside.licences] == ["LICENSE"]
    (tmp_path / "arm.xml").write_text("<mujoco/>")
    for outside in (take("./arm.xml", tmp_path), take(str(inside.path), tmp_path)):
        assert outside.origin is None
