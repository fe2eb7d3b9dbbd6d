from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import run
from lint.test_dead import CLASSES


@pytest.fixture
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arms").mkdir()
    (tmp_path / "arms" / "arm.xml").write_text(CLASSES, encoding="utf-8")
    (tmp_path / "arms" / "part.xml").write_text("<mujoco><asset/></mujoco>", encoding="utf-8")
    (tmp_path / "scene.xml").write_text('<mujoco><include file="arms/arm.xml"/></mujoco>', encoding="utf-8")
    (tmp_path / "cell.yaml").write_text("recipe: 1\nbase: arms/arm.xml\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_folder_reports_each_place_once(models: Path) -> None:
    result = run("lint", ".", "--select", "unused-class")
    assert result.exit_code == 1
    assert result.stderr.count("no element uses the class `outer`") == 1
    assert "arms/arm.xml:6:21: warning[unused-class]" in result.stderr
    assert "1 finding in 3 models; --fix fixes 1 of them" in result.stdout


def test_globs_and_parts_of_other_files(models: Path) -> None:
    (models / "arms" / "body.xml").write_text('<mujoco><worldbody><geom class="used" size="1"/></worldbody></mujoco>')
    scene = '<mujoco><include file="arms/arm.xml"/><include file="arms/body.xml"/></mujoco>'
    (models / "scene.xml").write_text(scene)
    assert "error" not in run("lint", ".", "--select", "dead").stderr
    assert run("lint", "arms/body.xml", "--select", "dead").exit_code == 1
    assert "1 finding in 2 models" in run("lint", "arms/*[ym].xml", "--select", "dead").stdout


def test_json_and_sarif(models: Path) -> None:
    lines = run("lint", "arms/arm.xml", "--select", "dead", "--output-format", "json").stdout.splitlines()
    assert [json.loads(line)["code"] for line in lines] == ["unused-class"]
    sarif = json.loads(run("lint", "arms/arm.xml", "--select", "dead", "--output-format", "sarif").stdout)
    assert sarif["runs"][0]["results"][0]["ruleId"] == "unused-class"


def test_fix_changes_the_file_and_is_done_once(models: Path) -> None:
    assert run("lint", "arms/arm.xml", "--select", "dead", "--fix").exit_code == 0
    text = (models / "arms" / "arm.xml").read_text(encoding="utf-8")
    assert "outer" not in text and 'class="used"' in text
    assert run("lint", "arms/arm.xml", "--select", "dead").exit_code == 0


def test_a_recipe_is_linted_at_its_sources(models: Path) -> None:
    assert "arms/arm.xml:6:21" in run("lint", "cell.yaml", "--select", "dead").stderr


def test_wrong_words(models: Path) -> None:
    result = run("lint", "arms/arm.xml", "--select", "unused-clas")
    assert result.exit_code == 2 and "unused-class" in result.stderr
    assert run("lint").exit_code == 2
    assert run("lint", "gone.xml").exit_code == 2
    broken = models / "broken.xml"
    broken.write_text("<mujoco><worldbody><geom/></worldbody></mujoco>", encoding="utf-8")
    result = run("lint", "broken.xml")
    assert result.exit_code == 1 and "broken.xml:1:20: error[mujoco-rejects]" in result.stdout + result.stderr


def test_pages_and_lists(models: Path) -> None:
    assert "unused-class" in run("lint", "--rules").stdout
    assert "A default class that no element uses" in run("explain", "unused-class").stdout
    assert "unused-class" in run("explain", "--codes").stdout


def test_what_another_model_uses_is_not_removed(models: Path) -> None:
    colors = '<mujoco><asset><material name="red"/>\n<material name="blue"/>\n</asset></mujoco>'
    (models / "arms" / "colors.xml").write_text(colors, encoding="utf-8")
    ball = '<mujoco><worldbody><geom size="1" material="red"/></worldbody></mujoco>'
    (models / "arms" / "ball.xml").write_text(ball, encoding="utf-8")
    scene = '<mujoco><include file="arms/colors.xml"/><include file="arms/ball.xml"/></mujoco>'
    (models / "scene.xml").write_text(scene, encoding="utf-8")
    for file in ("arms/colors.xml", "."):
        run("lint", file, "--select", "unused-material", "--fix")
        assert (models / "arms" / "colors.xml").read_text(encoding="utf-8") == colors.replace(
            '<material name="blue"/>\n', ""
        )


@pytest.mark.parametrize("verb", ["lint", "lint .", "tree", "diff arm.mjcf", "fmt --check", "view --html page.html"])
def test_a_model_may_be_called_mjcf(models: Path, verb: str) -> None:
    """MuJoCo 4.0 opens no file with this name."""
    for file in models.rglob("*.*"):
        file.unlink()
    text = '<mujoco>\n  <worldbody>\n    <geom name="ball" size="1"/>\n  </worldbody>\n</mujoco>\n'
    (models / "arm.mjcf").write_text(text, encoding="utf-8")
    command, *options = verb.split()
    result = run(command, *options, *([] if "." in options else ["arm.mjcf"]))
    assert result.exit_code == 0, result.stderr
    assert command != "lint" or "0 findings in 1 model" in result.stdout


def test_what_a_recipe_beside_names_is_not_removed(models: Path) -> None:
    edit = "edit:\n  - {select: {geom: '**'}, set: {class: outer}}\n"
    (models / "cell.yaml").write_text(f"recipe: 1\nbase: arms/arm.xml\n{edit}", encoding="utf-8")
    assert run("lint", "arms/arm.xml", "--select", "unused-class").exit_code == 0
    (models / "cell.yaml").write_text(f"recipe: 1\nbase: arms/other.xml\n{edit}", encoding="utf-8")
    assert run("lint", "arms/arm.xml", "--select", "unused-class").exit_code == 1


def test_a_recipe_changes_none_of_its_sources(models: Path) -> None:
    arm = (models / "arms" / "arm.xml").read_text(encoding="utf-8")
    edit = "edit:\n  - {select: {geom: '**'}, remove: true}\n"
    (models / "cell.yaml").write_text(f"recipe: 1\nbase: arms/arm.xml\n{edit}", encoding="utf-8")
    result = run("lint", "cell.yaml", "--select", "dead", "--fix")
    assert "no element uses the class `used`" in result.stderr and "--fix" not in result.stdout
    assert (models / "arms" / "arm.xml").read_text(encoding="utf-8") == arm


def test_a_fix_escapes_a_name_and_breaks_no_model(models: Path) -> None:
    name = "a&amp;b&quot;&lt;&#9;'"
    arm = f'<mujoco><worldbody><body><joint name="{name}"/><geom size="1"/></body></worldbody><actuator><motor'
    (models / "arm.xml").write_text(f'{arm} joint="{name}"/></actuator></mujoco>', encoding="utf-8")
    assert run("lint", "arm.xml", "--select", "unnamed-actuator", "--fix").exit_code == 0
    assert run("lint", "arm.xml", "--select", "unnamed-actuator").exit_code == 0
