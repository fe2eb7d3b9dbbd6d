"""docs/how-to/from_dm_control.md names every public name of dm_control.mjcf, and what it says is there is there."""

from __future__ import annotations

import importlib.util
import inspect
import re
import shutil
from functools import cache
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from types import ModuleType
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import mjcf

ROOT = Path(__file__).resolve().parents[2]
LIST = ROOT / "tests" / "mjcf" / "dm_control_names.txt"
PAGE = (ROOT / "docs" / "how-to" / "from_dm_control.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (`.+) \| (.+) \|$", re.MULTILINE)
CODE = re.compile(r"`([^`]+)`")
CHANGES = re.compile(r"## The lines that change\n(.*?)\n## ", re.DOTALL)
SAYS = {name: says for names, says in ROW.findall(CHANGES.sub("", PAGE)) for name in CODE.findall(names)}
NOW = [line for _, now in ROW.findall(CHANGES.findall(PAGE)[0]) for line in CODE.findall(now)]
OTHERS = {"mujoco": mujoco}
SUBMODULES = "attribute constants copier debugging element namescope schema skin".split()


def listed() -> list[str]:
    return [line for line in LIST.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]


@cache
def introspection() -> ModuleType:
    spec = importlib.util.spec_from_file_location("dm_control_api", LIST.with_name("dm_control_api.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def there(name: str) -> bool:
    """Whether a name of the page is one of mjcompose.mjcf, or of MuJoCo; `f(x)` asks for a parameter."""
    path, _, parameter = name.partition("(")
    first, *rest = path.split(".")
    value: Any = OTHERS.get(first) or getattr(mjcf, first, None)
    for each in rest:
        value = getattr(value, each, None)
    if value is None:
        return False
    return not parameter or parameter.rstrip(")") in inspect.signature(value).parameters


def test_the_list_is_that_of_dm_control() -> None:
    try:
        version = introspection().installed()
    except PackageNotFoundError:
        pytest.skip("dm_control is not installed")
    header = LIST.read_text(encoding="utf-8").splitlines()[0]
    if header != f"# dm_control {version}":
        pytest.skip(f"the list is of another version than dm_control {version}")
    assert introspection().names() == listed()


def test_the_page_has_every_name_and_no_other() -> None:
    silent = [name for name in listed() if name not in SAYS and not needs_no_row(name)]
    assert silent == []
    assert SAYS.keys() <= set(listed())


def needs_no_row(name: str) -> bool:
    """A name of an internal module, a parameter of what is not here, or one that is the same."""
    function, _, parameter = name.partition("(")
    if function.partition(".")[0] in SUBMODULES:
        return True
    return bool(parameter) and (not SAYS[function].startswith("the same") or there(name))


@pytest.mark.parametrize(("name", "says"), SAYS.items())
def test_what_a_row_says_holds(name: str, says: str) -> None:
    if says.startswith("the same"):
        assert there(name)
    elif says.startswith("none"):
        assert not there(name)
    else:
        assert says.startswith("`") and there(CODE.findall(says)[0])


def test_the_examples_of_the_page_are_files() -> None:
    assert {path.name for path in (ROOT / "docs" / "examples").glob("*.py")} == set(
        re.findall(r"\(\.\./examples/(\w+\.py)\)", PAGE)
    )


@pytest.mark.parametrize("line", NOW)
def test_the_lines_that_change_run(line: str, tmp_path: Path) -> None:
    root = mjcf.RootElement("arm")
    gripper = mjcf.RootElement("gripper")
    arm = root.worldbody.add("body", name="arm")
    arm.add("geom", size=[0.1])
    names = {
        "mjcf": mjcf,
        "root": root,
        "arm": arm,
        "gripper": gripper,
        "out": tmp_path,
        "joint": arm.add("joint", name="turn"),
        "site": arm.add("site", name="flange", pos=[0, 0, 1]),
        "finger": gripper.worldbody.add("body", name="finger"),
    }
    root.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    names["physics"] = root.compile_model()
    exec(line, names)


def test_the_three_ways_make_one_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program with `mjcompose.mjcf`, a mapping and a file."""
    monkeypatch.chdir(tmp_path)
    for name in ("scenes/floor.xml", "props/cube.xml"):
        shutil.copy(ROOT / "recipes" / "models" / name, tmp_path)
    section = PAGE.split("## Or write a recipe")[1].split("## Functions")[0]
    *programs, recipe = re.findall(r"^```\w+\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
    models = [mjcompose.model(recipe)]
    for program in programs:
        known: dict[str, Any] = {}
        exec(program, known)
        models.append(known["model"])
    assert len(models) == 3
    for model in models:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        assert model.nbody == 3 and [model.sensor(i).name for i in range(model.nsensor)] == ["at0", "at1"]
        np.testing.assert_array_equal(data.sensordata, [0, 0, 0.02, 0.1, 0, 0.02])
