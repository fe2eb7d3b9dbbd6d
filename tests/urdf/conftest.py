from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mjcompose.base.access import Door
from mjcompose.base.sink import Sink
from mjcompose.mujoco.engine import Session
from mjcompose.sources.kinds import PATH
from mjcompose.sources.reference import Source
from mjcompose.sources.ros import UrdfChoices
from mjcompose.urdf.read import UrdfReader


@pytest.fixture(scope="session")
def engine() -> Iterator[Session]:
    with Session() as session:
        yield session


@pytest.fixture
def reader(engine: Session, tmp_path: Path) -> Callable[..., UrdfReader]:
    """A reader of a file in the test's folder, which it may read alone."""

    def made(file: str, text: str | None = None, **choices: object) -> UrdfReader:
        path = tmp_path / file
        if text is not None:
            path.write_text(text, encoding="utf-8")
        packages = tuple(choices.pop("packages", ()))  # type: ignore[call-overload]
        given = UrdfChoices(**choices)  # type: ignore[arg-type]
        source = Source(path, PATH, file, packages=packages, door=Door.of([tmp_path]), urdf=given)
        return UrdfReader(source, Sink(), engine, lambda each: each.name)

    return made
