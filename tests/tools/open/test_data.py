"""Recipes that a program has as data or as text: the same models as from files, and errors that name program and keys."""

from __future__ import annotations

import io
import os
import shutil
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import mujoco_plugin
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.node import to_python
from mjcompose.tools.open import recipe as opening

ROOT = Path(__file__).resolve().parents[3]
SCENE = """\
<mujoco>
  <worldbody>
    <body name="table"><geom name="top" size=".1" mass="1"/><site name="flange" pos="0 0 1"/></body>
  </worldbody>
</mujoco>
"""
ARM = """\
<mujoco>
  <worldbody><body name="link"><joint name="j" axis="0 0 1"/><geom name="g" size=".1" mass="1"/></body></worldbody>
</mujoco>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with the models of the recipes, which no call changes any more."""
    for name, text in {
        "scene.xml": SCENE,
        "arm.xml": ARM,
        "cells/arm.xml": ARM.replace('mass="1"', 'mass="5"'),
    }.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        os.utime(path, (1, 1))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(opening, "_opened", {})
    return tmp_path


def cell(**more: Any) -> dict[str, Any]:
    attach = {"arm": {"model": "./arm.xml", "site": "flange", "pos": np.array([0, 0, 0.5])}}
    sensor = {"at": {"type": "framepos", "objtype": "body", "objname": "arm/link"}}
    return {"recipe": 1, "base": Path("scene.xml"), "attach": attach, "sensor": sensor, **more}


def builds(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The recipes that are built from now on."""
    seen: list[Path] = []
    build = opening.build
    monkeypatch.setattr(
        opening,
        "build",
        lambda request, *rest, **named: (seen.append(request.recipe), build(request, *rest, **named))[1],
    )
    return seen


def content(model: mujoco.MjModel) -> bytes:
    """The whole model as bytes, with its name."""
    size = mujoco.mj_sizeModel(model)
    buffer = np.empty(size, np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()


def line_of_caller() -> int:
    return sys._getframe(1).f_lineno


def test_the_same_model_from_a_mapping_a_text_and_a_file(folder: Path) -> None:
    named = cell(name="cell")
    text = mjcompose.dumps(named)
    (folder / "cell.yaml").write_text(text)
    models = [
        mjcompose.model("cell.yaml"),
        mjcompose.model(named),
        mjcompose.model(text),
        mjcompose.spec(named).compile(),
    ]
    assert models[0].nsensor == 1 and models[0].body("arm/link").pos[2] == 1.5
    assert len({content(model) for model in models}) == 1


@pytest.mark.parametrize("name", ["demo", "gantry", "parts_study"])
def test_the_same_model_as_a_shipped_recipe(name: str) -> None:
    path = ROOT / "recipes" / f"{name}.yaml"
    node = load(path.read_bytes(), path.name, Sink())
    assert node is not None
    recipe = to_python(node)
    assert content(mjcompose.model(recipe, base_dir=path.parent)) == content(mjcompose.model(path))


def test_a_recipe_without_a_name_is_called_model() -> None:
    """The name of a model does not depend on the line of the program."""
    spec = mjcompose.spec(cell())
    assert spec.modelname == mjcompose.spec(mjcompose.dumps(cell())).modelname == "model"


def test_paths_start_at_base_dir(folder: Path) -> None:
    recipe = {"recipe": 1, "base": "./arm.xml"}
    assert mjcompose.model(recipe).body("link").mass == 1
    for base_dir in ("cells", folder / "cells", "./cells/"):
        assert mjcompose.model(recipe, base_dir=base_dir).body("link").mass == 5
        assert mjcompose.model("recipe: 1\nbase: ./arm.xml\n", base_dir=base_dir).body("link").mass == 5
    with pytest.raises(TypeError, match="`base_dir` is for a mapping or a text"):
        mjcompose.model("cell.yaml", base_dir="cells")


@pytest.mark.parametrize(("name", "reason"), [("nowhere", "does not exist"), ("arm.xml", "is not a folder")])
def test_base_dir_is_a_folder(folder: Path, name: str, reason: str) -> None:
    for recipe in ({"recipe": 1}, "recipe: 1\n"):
        with pytest.raises(mjcompose.BuildError, match=f"file-not-found]: `base_dir` `{name}` {reason}"):
            mjcompose.model(recipe, base_dir=name)


def test_the_working_directory_is_a_part_of_the_recipe(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recipe = {"recipe": 1, "base": "./arm.xml"}
    assert mjcompose.model(recipe).body("link").mass == 1
    monkeypatch.chdir(folder / "cells")
    assert mjcompose.model(recipe).body("link").mass == 5


def test_all_of_the_language_works_in_a_mapping(folder: Path) -> None:
    (folder / "lamp.yaml").write_text("recipe: 1\nadd: [{to: world, light: {name: lamp, pos: [0, 0, 3]}}]\n")
    recipe = cell(
        extends="./lamp.yaml",
        params={"mass": {"default": 2, "min": 1}, "gains": {"default": [1, 2]}},
        variants={"hand": {"none": {}, "pin": {"add": [{"to": "arm/link", "site": {"name": "pin"}}]}}},
        edit=[{"select": {"geom": "arm/g"}, "set": {"mass": "${mass}"}}],
        matrix={"axes": {"hand": ["none", "pin"]}, "name": "cell-${hand}"},
        randomize={
            "seed": 7,
            "samples": 3,
            "fields": {"m": {"select": {"geom": "top"}, "attr": "mass", "uniform": (1, 2)}},
        },
    )
    recipe["attach"]["lamp"] = {"model": {"add": [{"to": "world", "body": {"name": "foot"}}]}}
    model = mjcompose.model(recipe, cell="cell-pin", mass=np.float64(4), sample=1)
    assert model.site("pin").id >= 0 and model.body("arm/link").mass == 4 and model.body("lamp/foot").id > 0
    assert model.nlight == 1 and 1 < model.body("table").mass < 2
    other = mjcompose.model(recipe, cell="cell-none", sample=2)
    assert other.nsite == model.nsite - 1 and other.body("table").mass != model.body("table").mass
    assert mjcompose.model(recipe, cell="cell-none", verified=True).nbody == model.nbody


def test_an_equal_mapping_is_not_built_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = builds(monkeypatch)
    mjcompose.model(cell())
    mjcompose.spec(cell())
    mjcompose.model(cell() | {"base": "scene.xml"})
    assert len(seen) == 1, "on another line, with a text for a path"
    mjcompose.model(cell(name="other"))
    mjcompose.model({**cell(), "attach": {}, "sensor": {}})
    assert len(seen) == 3
    (folder / "arm.xml").write_text(ARM.replace('mass="1"', 'mass="3"'))
    assert mjcompose.model(cell()).body("arm/link").mass == 3
    assert len(seen) == 4


def test_a_mapping_that_changes_is_built_again() -> None:
    recipe = cell()
    before = mjcompose.model(recipe).body("arm/link").pos[2]
    recipe["attach"]["arm"]["pos"][2] = 0.75
    assert (before, mjcompose.model(recipe).body("arm/link").pos[2]) == (1.5, 1.75)


def test_an_error_names_the_line_of_the_program_and_the_keys() -> None:
    recipe = cell(sensor={"s0": {"type": "framepos", "objtype": "body", "objnam": "arm/link"}})
    with pytest.raises(mjcompose.BuildError) as caught:
        line = line_of_caller() + 1
        mjcompose.model(recipe)
    (error,) = caught.value.diagnostics
    assert error.span is not None and error.span.file == f"<test_data.py:{line}>"
    assert error.notes[0].message == (
        "at recipe['sensor']['s0']['objnam']: s0: {type: framepos, objtype: body, objnam: arm/link}"
    )
    written = mjcompose.dumps(recipe).splitlines()[error.span.line - 1]
    assert written[error.span.column - 1 :].startswith("objnam: ")
    assert len(caught.traceback) == 2, "the line of the program, and the function that it calls"


@pytest.mark.parametrize(
    ("more", "code", "place"),
    [
        ({"base": "./scene2.xml"}, "source-not-found", "['base']"),
        ({"attach": {"arm": {"model": "./arm.xml", "sight": "flange"}}}, "unknown-key", "['attach']['arm']['sight']"),
        ({"add": [{"to": "world"}, {"to": "nowhere", "site": {}}]}, "unknown-name", "['add'][1]['to']"),
        ({"option": {"timestep": "1e-3"}}, "wrong-type", "['option']['timestep']"),
        ({"option": {"gravity": [0, 0, "x"]}}, "wrong-type", "['option']['gravity'][2]"),
        ({"attach": {"a": {"model": "./arm.xml", "pos": ["${1 +}", 0, 0]}}}, "expression", "['attach']['a']['pos'][0]"),
        ({"attach": {"a b/": {"model": "./arm.xml"}}}, "bad-name", "['attach']['a b/']"),
    ],
)
def test_a_place_is_told_by_its_keys(more: Mapping[str, Any], code: str, place: str) -> None:
    recipe = {**cell(sensor={}), **more}
    with pytest.raises(mjcompose.BuildError) as caught:
        mjcompose.model(recipe)
    diagnostic = next(each for each in caught.value.diagnostics if each.code == code)
    assert diagnostic.notes[0].message.startswith(f"at recipe{place}: ")
    assert "<recipe>" not in str(caught.value)


def test_a_number_as_text_is_refused_with_help() -> None:
    with pytest.raises(mjcompose.BuildError, match="help: write `1e-3` without quotes"):
        mjcompose.model(cell(option={"timestep": "1e-3"}))


def test_the_name_holds_below_another_folder(folder: Path) -> None:
    recipe = {"recipe": 1, "base": "./arm.xml", "edit": [{"select": {"geom": "x"}, "set": {"mass": 1}}]}
    for base_dir in ("cells", folder.parent, folder / "cells"):
        (folder.parent / "arm.xml").write_text(ARM)
        with pytest.raises(mjcompose.BuildError) as caught:
            mjcompose.model(recipe, base_dir=base_dir)
        text = str(caught.value)
        assert text.startswith("<test_data.py:") and "<recipe>" not in text
        assert "at recipe['edit'][0]['select']: - {select: " in text


def test_a_second_place_has_its_keys_too() -> None:
    text = "recipe: 1\nname: a\nattach: {}\nname: b\n"
    with pytest.raises(mjcompose.BuildError, match="it first appears here.*recipe.'name'.") as caught:
        mjcompose.spec(text)
    (error,) = caught.value.diagnostics
    assert error.code == "yaml-duplicate-key" and error.span is not None and error.span.line == 4
    assert error.notes[0].message == "the line is: name: b"


def test_errors_of_models_and_nested_recipes_name_their_own_file(folder: Path) -> None:
    (folder / "part.yaml").write_text("recipe: 1\noption: {timesteps: 1}\n")
    with pytest.raises(mjcompose.BuildError, match=r"^part\.yaml:2:10: error"):
        mjcompose.model({"recipe": 1, "attach": {"part": {"model": "./part.yaml"}}})


def test_secrets_of_a_line_are_hidden() -> None:
    address = "https://me:" + "hush" * 3 + "@example.invalid/a.zip#x.xml"
    with pytest.raises(mjcompose.BuildError) as caught:
        mjcompose.model({"recipe": 1, "attach": {"a": {"model": address, "sight": "x"}}})
    assert "recipe['attach']['a']" in str(caught.value) and "hush" not in str(caught.value)


def test_a_long_line_is_cut() -> None:
    with pytest.raises(mjcompose.BuildError) as caught:
        mjcompose.model({"recipe": 1, "name": "x" * 5000 + "\0"})
    assert max(map(len, str(caught.value).splitlines())) < 400


def test_a_warning_is_at_the_line_of_the_call_and_names_it() -> None:
    recipe = cell(allow=["unstable"])
    for _ in range(2):  # the second time, nothing is built
        with pytest.warns(mjcompose.RecipeWarning, match="unused-allow") as caught:
            line = line_of_caller() + 1
            mjcompose.spec(recipe, verified=True)
        assert (caught[0].filename, caught[0].lineno) == (__file__, line)
        assert str(caught[0].message).startswith(f"<test_data.py:{line}>:")


def test_what_mujoco_refuses_has_a_place() -> None:
    recipe = {"recipe": 1, "add": [{"to": "world", "body": {"name": "b", "joint": {"name": "j"}}}]}
    with pytest.raises(mjcompose.BuildError, match="<test_data.py:"):
        mjcompose.model(recipe)


@pytest.mark.parametrize(
    ("recipe", "kind"),
    [([1], "list"), (None, "NoneType"), (b"recipe: 1\n", "bytes"), (io.StringIO("recipe: 1\n"), "StringIO")],
)
def test_other_things_are_no_recipes(recipe: Any, kind: str) -> None:
    for function in (mjcompose.model, mjcompose.spec, mujoco_plugin.files_of):
        with pytest.raises(TypeError, match=f"a recipe is a path, a mapping, or YAML of several lines, got `{kind}`"):
            function(recipe)


def test_yaml_on_one_line_gets_help() -> None:
    with pytest.raises(mjcompose.BuildError, match="if it is YAML, end it with a line break"):
        mjcompose.model("{recipe: 1, base: ./arm.xml}")
    assert mjcompose.model("{recipe: 1, base: ./arm.xml}\n").nbody == 2


def test_too_many_errors_are_errors() -> None:
    sensor = {f"s{index}": {"type": "framepos", "nothing": index} for index in range(1100)}
    with pytest.raises(mjcompose.BuildError, match="there are more than 1000 errors") as caught:
        mjcompose.model({"recipe": 1, "sensor": sensor})
    assert len(caught.value.diagnostics) > 1000


def test_values_name_their_place() -> None:
    with pytest.raises(TypeError, match=r"^gains\['hip'\]\[1\] is of type `object`"):
        mjcompose.model(cell(), gains={"hip": [1, object()]})
    with pytest.raises(TypeError, match=r"^mass is nan"):
        mjcompose.model(cell(params={"mass": 1}), mass=np.nan)


def repeated() -> dict[str, Any]:
    joint = "${leg}_${j}"
    motor = {"type": "position", "joint": "${leg}_${j}", "kp": "${gains[j].kp}"}
    body = {"name": "${leg}", "joint": {"name": "${leg}_hip"}, "geom": {"size": [0.1]}}
    return {
        "recipe": 1,
        "params": {"gains": {"type": "table"}, "legs": ("L", "R")},
        "add": [{"for": {"leg": "${legs}"}, "to": "world", "body": body}],
        "actuator": {joint: {"for": {"leg": "${legs}", "j": "${gains}"}, **motor}},
    }


def test_tables_lists_and_for_work_in_a_mapping() -> None:
    model = mjcompose.model(repeated(), gains={"hip": {"kp": np.float64(20)}})
    assert [model.actuator(i).name for i in range(model.nu)] == ["L_hip", "R_hip"]
    np.testing.assert_array_equal(model.actuator_gainprm[:, 0], 20)
    assert mjcompose.model(repeated(), gains={"hip": {"kp": 1}}, legs=np.array(["M"])).actuator(0).name == "M_hip"
    text = mjcompose.dumps(repeated())
    assert '  "${leg}_${j}":\n    for: {leg: "${legs}", j: "${gains}"}\n    type: position\n' in text


def test_a_fault_in_all_turns_is_one_error_with_its_keys() -> None:
    with pytest.raises(mjcompose.BuildError) as caught:
        mjcompose.model(repeated(), gains={"knee": {"kp": 1}})
    (error,) = caught.value.diagnostics
    assert error.notes[0].message.startswith("at recipe['actuator']['${leg}_${j}']['joint']: ")
    assert "<recipe>" not in str(caught.value)


def test_a_fault_in_a_value_has_its_keys(folder: Path) -> None:
    (folder / "legs.yaml").write_text(mjcompose.dumps(repeated()))
    for recipe in (repeated(), "legs.yaml"):
        with pytest.raises(mjcompose.BuildError, match=r"note: at gains\['hip'\]\['kp'\]"):
            mjcompose.model(recipe, gains={"hip": {"kp": "2k"}})


def cyclic() -> dict[str, Any]:
    recipe = cell()
    recipe["attach"]["arm"]["model"] = recipe
    return recipe


def test_a_mapping_from_elsewhere_is_data() -> None:
    """No input raises anything except BuildError and TypeError."""
    with pytest.raises(TypeError, match=r"recipe\['attach'\]\['arm'\]\['model'\] contains itself"):
        mjcompose.model(cyclic())
    deep: Any = 1
    for _ in range(5000):
        deep = [deep]
    with pytest.raises(mjcompose.BuildError, match="yaml-too-deep"):
        mjcompose.model({"recipe": 1, "attach": deep})
    with allow(yaml_values=100), pytest.raises(mjcompose.BuildError, match="yaml-too-large"):
        mjcompose.model({"recipe": 1, "attach": range(10**9)})
    with pytest.raises(mjcompose.BuildError):
        mjcompose.model({})
    with pytest.raises(mjcompose.BuildError):
        mjcompose.model({"recipe": 1, "name": "a\0b"})
    for text in ("\n", "- 1\n", "recipe: 1\n---\nrecipe: 1\n", "a: [\n", "\ud800: 1\n", "name: \x00\n"):
        with pytest.raises(mjcompose.BuildError):
            mjcompose.spec(text)


def test_a_path_with_a_line_break_is_a_path_for_mujoco(folder: Path) -> None:
    """Programs such as MuJoCo name files: no name of a file is read as a recipe."""
    name = "recipe: 1\nbase: .yaml"
    shutil.copy(folder / "arm.xml", folder / "base.xml")
    try:
        (folder / name).write_text("recipe: 1\nbase: ./base.xml\n")
    except OSError:
        pytest.skip("this system has no such names")
    assert 'body name="link"' in opening.text_of(name)
    assert mjcompose.model(Path(name)).nbody == 2


def test_the_files_of_a_mapping(folder: Path) -> None:
    recipe = cell()
    assert mujoco_plugin.files_of(recipe) == ()
    mjcompose.model(recipe)
    files = mujoco_plugin.files_of(cell())
    assert {str(folder / "arm.xml"), str(folder / "scene.xml")} <= set(files)
    assert not any("<" in os.path.basename(file) for file in files)
    assert mujoco_plugin.files_of(recipe, base_dir="cells") == ()


@pytest.mark.parametrize(
    "function",
    [
        mjcompose.stamp,
        mjcompose.load,
        mjcompose.worlds.load,
        mjcompose.worlds.gather,
        lambda it: list(mjcompose.load_many(it)),
    ],
    ids=["stamp", "load", "worlds.load", "worlds.gather", "load_many"],
)
def test_what_needs_a_bundle_says_so(function: Any) -> None:
    with pytest.raises(TypeError, match=r"got `dict`; a mapping has no bundle: write `mjcompose\.dumps\(recipe\)`"):
        function(cell())


def test_threads_share_one_build(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = builds(monkeypatch)
    with ThreadPoolExecutor(4) as pool:
        models = list(pool.map(mjcompose.model, [cell() for _ in range(8)]))
    assert len({content(model) for model in models}) == 1 and len(seen) == 1
