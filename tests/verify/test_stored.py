"""Bundles that were written before: unharmed, harmed, and away from their sources."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.bundle.write import write
from mjcompose.compose.attach import Changes, ChangesOfParts
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tree.pattern import Selector
from mjcompose.verify.stored import VerifiedBundle, verify_stored

PART = """
<mujoco model="part">
  <asset><mesh file="cube.obj"/></asset>
  <worldbody><body name="b"><joint name="j"/><geom type="mesh" mesh="cube"/></body></worldbody>
  <sensor><jointpos name="s" joint="j"/></sensor>
  <keyframe><key name="home" qpos="0.5"/></keyframe>
</mujoco>
"""
CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
RECIPE = """
recipe: 1
attach:
  one: {model: ./parts/part.xml}
  two: {model: ./parts/part.xml, pos: [3, 0, 0]}
default:
  two/: {geom: {rgba: [1, 0, 0, 1]}}
"""
Check = Callable[..., tuple[VerifiedBundle | None, list[str]]]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with `recipe.yaml` and its bundle in `out/` and `out.zip`."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "part.xml").write_text(PART)
    (tmp_path / "parts" / "cube.obj").write_text(CUBE)
    (tmp_path / "recipe.yaml").write_text(RECIPE)
    context = Context(folder=tmp_path, environment={})
    built = build(ModelRequest(tmp_path / "recipe.yaml"), context)
    assert built is not None, context.sink.diagnostics
    write(built.bundle, f"{tmp_path / 'out'}{os.sep}", environment={})
    write(built.bundle, str(tmp_path / "out.zip"), environment={})
    return tmp_path


@pytest.fixture(scope="module")
def session() -> Any:
    with Session() as session:
        yield session


@pytest.fixture
def check(folder: Path, session: Session) -> Check:
    """Verify a bundle of the folder: what came of it, and `SEVERITY CODE: MESSAGE; also OTHERS` of every one."""

    def check(path: str = "out", here: str = ".", recipe: str | None = None) -> tuple[VerifiedBundle | None, list[str]]:
        context = Context(folder=folder / here, environment={})
        stored = verify_stored(folder / path, context, session, None if recipe is None else folder / recipe)
        return stored, [
            f"{each.severity.value} {each.code}: {each.message}"
            + "".join(f"; also {other.message}" for other in each.others)
            for each in context.sink.diagnostics
        ]

    return check


def _manifest(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    path = folder / "out" / "manifest.json"
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))


@pytest.mark.parametrize("path", ["out", "out.zip"])
def test_what_nobody_touched_is_fine(check: Check, path: str) -> None:
    stored, told = check(path)
    assert told == []
    assert stored is not None
    assert [(part.member.prefix, part.ok) for part in stored.parts] == [("one/", True), ("two/", True)]


def test_away_from_its_sources_a_part_is_not_compared(folder: Path, check: Check) -> None:
    (folder / "elsewhere").mkdir()
    stored, told = check(here="elsewhere")
    assert stored is not None
    assert not any(part.ok for part in stored.parts)
    (only,) = told
    assert only.startswith("warning part-not-compared: `one/` is not compared with its source: ")
    assert only.endswith("its source `./parts/part.xml` is not found; also `two/`")
    assert check(here="elsewhere", recipe="recipe.yaml")[1] == []


def test_a_source_that_changed_since_is_not_compared(folder: Path, check: Check) -> None:
    (folder / "parts" / "part.xml").write_text(PART.replace("0.5", "0.6"))
    _, told = check(recipe="recipe.yaml")
    assert [each.split(":")[0] for each in told] == ["error part-not-compared"]
    assert "is not the file that the bundle was built from" in told[0] and told[0].endswith("; also `two/`")
    assert [each.split()[0] for each in check()[1]] == ["warning"]


@pytest.mark.parametrize("recipe", ["changed since", "in another folder"])
def test_only_the_very_recipe_beside_a_bundle_says_where_sources_are(folder: Path, check: Check, recipe: str) -> None:
    """The file in the new place is the right one, but only a recipe that nobody vouches for says so."""
    (folder / "parts").rename(folder / "moved")
    (folder / "recipe.yaml").write_text(RECIPE.replace("./parts/", "./moved/"))
    written = (folder / "recipe.yaml").read_bytes()
    if recipe == "in another folder":
        aside = {"path": "sub/recipe.yaml", "sha256": hashlib.sha256(written).hexdigest()}
        (folder / "sub").mkdir()
        (folder / "sub" / "recipe.yaml").write_bytes(written)
        (folder / "moved").rename(folder / "sub" / "moved")
        _manifest(folder, lambda manifest: manifest["recipe"].update(aside))
    _, told = check()
    if recipe == "in another folder":
        assert told[0].startswith("error bundle-manifest")
        return
    assert told[0].startswith("warning part-not-compared")
    assert "its source `./parts/part.xml` is not found" in told[0]


def test_a_recipe_that_is_not_there_is_told(check: Check) -> None:
    assert any(each.startswith("error file-not-found") for each in check(recipe="nothing.yaml")[1])


def test_a_harmed_file_is_told(folder: Path, check: Check) -> None:
    model = folder / "out" / "model.xml"
    model.write_text(model.read_text().replace('qpos="0.5', 'qpos="0.4'))
    _, told = check()
    assert told[0] == "error bundle-changed: `model.xml` in `out` is not the file that its manifest lists"
    assert told[1].startswith("error part-changed: `one/` differs from `part.xml` alone: 1 difference (`key_qpos`)")


def test_files_too_few_and_too_many_are_told(folder: Path, check: Check) -> None:
    (folder / "out" / "extra.txt").write_text("more")
    next((folder / "out" / "assets").rglob("*.obj")).unlink()
    _, told = check()
    assert [each.split(":")[0] for each in told] == ["error bundle-changed"] * 2 + ["error mujoco-rejects"]
    assert "cube.obj" in told[0]
    assert "`extra.txt`" in told[1]


def test_an_index_of_another_model_is_told(folder: Path, check: Check) -> None:
    def change(data: dict[str, Any]) -> None:
        data["index"]["keyframes"] = [{"name": "away", "time": 0}]
        data["index"]["joints"].reverse()

    _manifest(folder, change)
    assert check()[1] == [
        "error bundle-manifest: the joints of the compiled `out` are not the joints of its manifest",
        "error bundle-manifest: the keyframes of the compiled `out` are not the keyframes of its manifest",
    ]


def test_without_a_manifest_it_is_compiled_all_the_same(folder: Path, check: Check) -> None:
    (folder / "out" / "manifest.json").unlink()
    stored, told = check()
    assert [each.split(":")[0] for each in told] == ["error bundle-manifest"]
    assert stored is not None
    assert stored.compiled is not None


@pytest.mark.parametrize("text", ["{", "{}", '{"manifest": 2}'])
def test_a_broken_manifest_is_told(folder: Path, check: Check, text: str) -> None:
    (folder / "out" / "manifest.json").write_text(text)
    assert [each.split(":")[0] for each in check()[1]] == ["error bundle-manifest"]


def test_an_older_manifest_says_nothing_of_parts(folder: Path, check: Check) -> None:
    _manifest(folder, lambda data: data.pop("parts"))
    (told,) = check()[1]
    assert told.startswith("warning part-not-compared: the manifest of `out` does not say")


def test_a_union_has_no_parts_of_its_own(folder: Path, check: Check) -> None:
    def change(data: dict[str, Any]) -> None:
        data["parts"] = []
        data["union"] = 4

    _manifest(folder, change)
    (told,) = check()[1]
    assert told.startswith("warning part-not-compared: `out` is the union of 4 models: its parts are not compared")


def test_a_manifest_that_names_no_input_and_no_body_harms_nobody(folder: Path, check: Check) -> None:
    def change(data: dict[str, Any]) -> None:
        data["parts"][0]["input"] = 99
        data["parts"][1]["body"] = "nobody"

    _manifest(folder, change)
    assert [each.split(":")[0] for each in check()[1]] == ["warning part-not-compared"] * 2


def test_nothing_there(folder: Path, check: Check) -> None:
    shutil.rmtree(folder / "out")
    stored, told = check()
    assert stored is None
    assert told[0].startswith("error file-not-found")


def _again(folder: Path, recipe: str) -> None:
    """Another recipe in the place of the bundle."""
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(folder=folder, environment={})
    built = build(ModelRequest(folder / "recipe.yaml"), context)
    assert built is not None, context.sink.diagnostics
    write(built.bundle, f"{folder / 'out'}{os.sep}", environment={})


OWN = "edit: [{select: {joint: j}, set: {damping: 3}}]"
EDITED = {
    "by the recipe": "edit: [{select: {joint: two/j}, set: {damping: 3}}, {select: {geom: '**'}, set: {margin: '${value + 0.1}'}}]",
    "a mass": "edit: [{select: {body: two/b}, scale: {mass: 2}}]",
    "a class": "default: {two/: {joint: {damping: 1}}}\nedit: [{select: {default: two/}, set: {joint: {damping: 2}}}]",
    "a name": "edit: [{select: {body: two/b}, rename: tool}, {select: {joint: two/j}, rename: wrist}]",
    "a key of both parts": "keyframe: {home: {from: {one: home}, qpos: {two/j: 0.1rad}}}",
}


@pytest.mark.parametrize("edits", EDITED)
def test_what_the_recipe_edits_is_no_change(folder: Path, check: Check, edits: str) -> None:
    _again(folder, RECIPE.partition("default:")[0] + EDITED[edits])
    stored, told = check()
    assert told == []
    assert stored is not None
    assert all(part.ok for part in stored.parts)


@pytest.mark.parametrize("keys", ["merge", "prefix"])
def test_a_key_that_a_nested_recipe_writes_is_no_change(folder: Path, check: Check, keys: str) -> None:
    inner = "recipe: 1\nbase: ./parts/part.xml\nkeyframe: {home: {qpos: {j: 0.1rad}}}\n"
    (folder / "inner.yaml").write_text(inner)
    _again(folder, f"recipe: 1\nattach: {{in: {{model: ./inner.yaml, keys: {keys}}}}}\n")
    stored, told = check()
    assert told == []
    assert stored is not None
    assert [part.ok for part in stored.parts] == [True]


def test_a_key_that_the_recipe_does_not_write_is_still_compared(folder: Path, check: Check) -> None:
    _again(folder, RECIPE + "keyframe: {other: {qpos: {one/j: 0.1rad}}}\n")
    model = folder / "out" / "model.xml"
    model.write_text(model.read_text().replace('qpos="0.5', 'qpos="0.4'))
    assert [each.partition(":")[0] for each in check()[1]] == ["error bundle-changed", "error part-changed"]


def test_the_time_of_a_key_that_is_kept_apart_is_compared(folder: Path, check: Check) -> None:
    timed = PART.replace('name="home"', 'name="home" time="1.5"')
    (folder / "parts" / "part.xml").write_text(timed)
    _again(folder, "recipe: 1\nattach: {one: {model: ./parts/part.xml, keys: prefix}}\n")
    assert check()[1] == []
    model = folder / "out" / "model.xml"
    model.write_text(model.read_text().replace('time="1.5"', 'time="2.5"'))
    changed = [each for each in check()[1] if each.startswith("error part-changed")]
    assert len(changed) == 1 and "`key_time`" in changed[0]


def test_what_a_part_edits_is_no_change_in_others(folder: Path, check: Check) -> None:
    _again(
        folder, f"recipe: 1\nattach:\n  one: {{model: ./parts/part.xml}}\n  two: {{model: ./parts/part.xml, {OWN}}}\n"
    )
    stored, told = check()
    assert told == []
    assert stored is not None
    one, two = (part.member for part in stored.parts)
    assert "dof_damping" in two.changed and one.changed == ()


@pytest.mark.parametrize(
    "cut",
    ["drop: [sensor]", "edit: [{select: {sensor: s}, remove: true}]", "edit: [{select: {body: b}, move: {to: world}}]"],
)
def test_a_part_without_some_of_its_elements_is_not_compared(folder: Path, check: Check, cut: str) -> None:
    _again(
        folder, f"recipe: 1\nattach:\n  one: {{model: ./parts/part.xml}}\n  two: {{model: ./parts/part.xml, {cut}}}\n"
    )
    stored, told = check()
    assert [each.partition(": the recipe")[0] for each in told] == [
        "warning part-not-compared: `two/` is not compared with its source"
    ]
    assert stored is not None
    assert stored.parts[0].ok


def test_edits_reach_the_parts_that_their_names_begin_with() -> None:
    def reached(pattern: str) -> set[str]:
        prefixes = {"", "arm/", "arm/hand/", "tool/"}
        changes = ChangesOfParts(prefixes)
        changes.add(Selector("geom", pattern), Changes({"geom_size"}))
        return {prefix for prefix in prefixes if changes.of(prefix).arrays}

    assert reached("arm/hand/pad") == {"arm/hand/"}
    assert reached("arm/*") == {"arm/", "arm/hand/"}
    assert reached("table") == {""}
    assert reached("t*") == {"", "tool/"}
    assert reached("**") == reached("/pad/") == {"", "arm/", "arm/hand/", "tool/"}


SETTINGS = """
  <option timestep="0.01" integrator="implicitfast"/>
  <size memory="1M" nuser_geom="2"/>
  <visual><map znear="0.1"/></visual>
  <statistic extent="3"/>
</mujoco>
"""


@pytest.mark.parametrize("dropped", ["option", "size", "visual", "statistic", "keyframe", "option, visual, keyframe"])
def test_a_part_without_its_settings_or_keys_is_compared(folder: Path, check: Check, dropped: str) -> None:
    """No element is left out: what the part is, it still is."""
    (folder / "parts" / "part.xml").write_text(PART.replace("</mujoco>", SETTINGS))
    part = f"{{model: ./parts/part.xml, drop: [{dropped}]}}"
    (folder / "recipe.yaml").write_text(f"recipe: 1\nconflict: base\nattach:\n  one: {part}\n")
    built = build(ModelRequest(folder / "recipe.yaml"), Context(folder=folder, environment={}))
    assert built is not None
    write(built.bundle, f"{folder / 'out'}{os.sep}", environment={})
    stored, told = check(recipe="recipe.yaml")
    assert told == []
    assert stored is not None and [part.ok for part in stored.parts] == [True]


@pytest.mark.parametrize("model", ["other.xml", "assets/model.xml"])
def test_the_model_of_a_manifest_is_in_the_bundle(folder: Path, check: Check, model: str) -> None:
    _manifest(folder, lambda manifest: manifest.update(model=model))
    assert check()[1] == [f"error bundle-manifest: the manifest of `out` names the model `{model}`, which is not in it"]


def test_the_licenses_of_a_manifest_are_in_the_bundle(folder: Path, check: Check) -> None:
    _manifest(folder, lambda manifest: manifest["inputs"][0].update(licenses=["LICENSES/one/LICENSE"]))
    [error] = [each for each in check()[1] if each.startswith("error")]
    assert error.endswith("names the license `LICENSES/one/LICENSE`, which is not in it")


def test_the_folder_is_searched_once_for_all_parts_that_are_not_found(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    searched: list[str] = []
    scan = os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: searched.append(str(path)) or scan(path))
    with Session() as session:
        found = verify_stored(folder / "out.zip", Context(environment={}, folder=elsewhere), session)
    assert found is not None and len(found.parts) == 2
    assert searched.count(str(elsewhere / "parts")) == 1


@pytest.mark.mujoco4("it refuses keys beside joints in a replicate")
def test_an_element_that_mujoco_multiplies_is_told(folder: Path, check: Check) -> None:
    """A sensor without an object becomes several next to a `<replicate>`, which the bundle was not built with."""
    model = folder / "out" / "model.xml"
    text = model.read_text().replace("<sensor>", '<sensor><clock name="time"/>')
    model.write_text(text.replace("<worldbody>", '<worldbody><replicate count="2"><site/></replicate>'))
    _, said = check("out")
    assert any("MuJoCo multiplies the `<clock>` `time`" in each for each in said), said
