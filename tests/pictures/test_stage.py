"""A model before a camera. Needs OpenGL, and skips where there is none."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from composer import engine
from composer.engine import Session

BALL = '<mujoco><worldbody><geom size="0.1" rgba="{rgba}"/></worldbody></mujoco>'


def middle_and_corner(mujoco: object, model: object, background: list[int] | None) -> dict[str, object]:
    """Runs in the child."""
    from composer.pictures.stage import Look, NoOpenGL, Stage

    try:
        stage = Stage(mujoco, model, None, Look(64, 48, background and tuple(background)))
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    picture = stage.picture(stage.whole())
    stage.close()
    return {"middle": picture[24, 32].tolist(), "corner": picture[0, 0].tolist()}


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    sys.path.insert(0, os.path.dirname(__file__))
    with Session(rendering=True) as session:
        yield session
    sys.path.remove(os.path.dirname(__file__))


@pytest.mark.parametrize("background", [None, [10, 200, 30, 1], [0, 0, 0, 0]])
@pytest.mark.parametrize("rgba", ["0.9 0.1 0.1 1", "0.02 0.02 0.02 1"])
def test_a_model_without_light_or_sky_can_be_seen(
    session: Session, background: list[int] | None, rgba: str, tmp_path: os.PathLike[str]
) -> None:
    from pathlib import Path

    folder = Path(tmp_path)
    (folder / "model.xml").write_text(BALL.format(rgba=rgba))
    assert engine.compile(folder, keep="ball", session=session).ok
    middle_and_corner.__module__ = "test_stage"
    answer = engine.call(session, middle_and_corner, ["ball"], background)
    assert answer.ok, answer.error
    if "no OpenGL" in answer.value or session.no_opengl:
        pytest.skip("there is no OpenGL")
    middle, corner = answer.value["middle"], answer.value["corner"]
    expected = [235] * 3 if background is None else background[:3] if background[3] else [0, 0, 0, 0]
    assert corner == expected
    assert np.abs(np.array(middle[:3]) - corner[:3]).max() > 20 or len(corner) == 4
    if rgba.startswith("0.9"):
        assert middle[0] > 120 and middle[0] > 2 * middle[1]
