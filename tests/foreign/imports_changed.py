"""The examples of the page on moving from dm_control, with `dm_control.mjcf` instead of `mjcompose.mjcf`.

The functions of an example that make its model run with both, and both models are compared by name and in motion. Of
dm_control only what makes MJCF is imported: the module that simulates stands empty in its place.
"""

from __future__ import annotations

import sys
import types
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from foreign import merging
from foreign.by_name import LeftOut
from foreign.strings import Verdict

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
BEFORE = "from dm_control import mjcf"
NOW = "from mjcompose import mjcf"
# dm_control puts a body around what it attaches: the page says so. It also names what it attaches `left/`.
LEFT_OUT = LeftOut(elements=r".*/", names=r".*//unnamed_.*", tree=False)


def _two_arms(names: dict[str, Any]) -> Any:
    return names["UpperBody"]().model


def _creatures(names: dict[str, Any]) -> Any:
    random = np.random.default_rng(42)
    creatures = [names["make_creature"](f"creature{number}", legs, random) for number, legs in enumerate(names["LEGS"])]
    return names["make_arena"](creatures)


MADE: dict[str, Callable[[dict[str, Any]], Any]] = {"two_arms.py": _two_arms, "creatures.py": _creatures}


@dataclass(frozen=True, slots=True)
class Example:
    """An example by its file, and the folders of dm_control and of what it imports."""

    file: str
    folders: tuple[Path, ...]

    @property
    def id(self) -> str:
        return f"dm_control/{self.file}"


def judge(example: Example) -> Verdict:
    """The model of the example by dm_control and by mjcompose, compared by name and in motion."""
    models = [_made(example, line) for line in (BEFORE, NOW)]
    return Verdict(example.id, True, merging.said(models[0], models[1], {}, LEFT_OUT))


def failed(example: Example, error: str) -> Verdict:
    return Verdict(example.id, True, f"failed: {error}")


def _made(example: Example, line: str) -> mujoco.MjModel:
    text = (EXAMPLES / example.file).read_text(encoding="utf-8")
    assert NOW in text
    _import_dm_control(example.folders)
    names: dict[str, Any] = {"__name__": "example"}
    exec(compile(text.replace(NOW, line), example.file, "exec"), names)
    root = MADE[example.file](names)
    assets = root.assets if line == NOW else root.get_assets()
    return mujoco.MjModel.from_xml_string(root.to_xml_string(), assets)


def _import_dm_control(folders: tuple[Path, ...]) -> None:
    if "dm_control.mjcf.physics" in sys.modules:
        return
    sys.path[:0] = map(str, folders)
    for name in ("dm_control.mujoco", "dm_control.mujoco.wrapper", "dm_control.mjcf.physics"):
        module = types.ModuleType(name)
        module.__path__ = [str(folder.joinpath(*name.split("."))) for folder in folders]
        sys.modules[name] = module
    sys.modules["dm_control.mjcf.physics"].Physics = None  # type: ignore[attr-defined]
