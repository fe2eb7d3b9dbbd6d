from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from compose.arm import DEGREES, RADIANS, Case
from lxml import etree
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

Compose = Callable[..., etree._Element | list[str]]

ROBOT = """\
<mujoco model="robot">
  <compiler angle="{angle}"/>
  <worldbody>
    <body name="base">
      <joint name="hinge"/>
      <geom name="geom" size="0.1"/>
      <site name="flange"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def compose(tmp_path: Path) -> Compose:
    """The model of a recipe, or where it is wrong `LINE:COLUMN CODE` of every fault, as the text stands in the file.

    `robot.xml` is there, in the given unit of angles; other files are given with `__` for the dot.
    """

    def compose(recipe: str, angle: str = "radian", **files: str) -> etree._Element | list[str]:
        (tmp_path / "robot.xml").write_text(ROBOT.format(angle=angle))
        for name, text in files.items():
            (tmp_path / name.replace("__", ".")).write_text(text)
        (tmp_path / "recipe.yaml").write_text(recipe)
        context = Context(environment={}, folder=tmp_path)
        built = build(ModelRequest(tmp_path / "recipe.yaml", verified=False), context)
        if built is None:
            return [
                f"{each.span.file.removesuffix('.yaml').replace('recipe', '')}{each.span.line}:{each.span.column} {each.code}"
                for each in context.sink.sorted()
                if each.span is not None
            ]
        return etree.fromstring(built.bundle.files["model.xml"])

    return compose


@pytest.fixture(params=["radian", "degree"])
def arm(request: pytest.FixtureRequest, tmp_path: Path) -> Case:
    return Case(tmp_path, RADIANS if request.param == "radian" else DEGREES)


@pytest.fixture
def radian(tmp_path: Path) -> Case:
    return Case(tmp_path, RADIANS)


@pytest.fixture(params=[False, True], ids=["whole", "own"])
def own(request: pytest.FixtureRequest) -> bool:
    own: bool = request.param
    return own
