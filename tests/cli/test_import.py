from __future__ import annotations

from pathlib import Path

from cli.shell import run

MERGED = """\
<mujoco model="cell">
  <worldbody><body name="tool/palm" pos="0 0 1">
    <geom name="tool/palm" type="box" size="0.03 0.03 {height}"/>
  </body></worldbody>
</mujoco>
"""


def test_a_recipe_that_makes_the_same(folder: Path) -> None:
    (folder / "merged.xml").write_text(MERGED.format(height="0.01"))
    result = run("import", "merged.xml", "models/tool.xml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "it builds, and the model is that of merged.xml" in result.stdout
    assert "  tool: {model: ./models/tool.xml, pos: [0, 0, 1]}\n" in (folder / "merged.yaml").read_text()
    assert run("check", "merged.yaml").exit_code == 0
    assert run("fmt", "--check", "merged.yaml").exit_code == 0


def test_a_part_that_is_not_in_it_is_told(folder: Path) -> None:
    (folder / "other.xml").write_text(MERGED.format(height="0.01").replace('palm" pos', 'hand" pos'))
    result = run("import", "other.xml", "models/tool.xml", "-o", "new.yaml")
    assert result.exit_code == 0 and "wrote new.yaml: 0 parts" in result.stdout
    assert "warning[unknown-name]: `models/tool.xml` is nowhere in `other.xml`" in result.stderr


def test_what_differs_is_shown(folder: Path) -> None:
    (folder / "merged.xml").write_text(MERGED.format(height="0.02"))
    result = run("import", "merged.xml", "models/tool.xml")
    text = (folder / "merged.yaml").read_text()
    assert "{select: {geom: tool/palm}, set: {size: [0.03, 0.03, 0.02]}}" in text
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [
        "wrote merged.yaml: 1 part",
        "changed in merged.xml, and written into the recipe:",
        "  geom `tool/palm`: size 0.03 0.03 0.01 m → 0.03 0.03 0.02 m",
        "it builds, and the model is that of merged.xml, element by element",
    ]


def test_what_has_no_name_gets_none(folder: Path) -> None:
    text = MERGED.format(height="0.01").replace("</mujoco>", "<sensor><clock/></sensor></mujoco>")
    (folder / "merged.xml").write_text(text)
    result = run("import", "merged.xml", "models/tool.xml", "--output", "new.yaml")
    assert result.exit_code == 0, result.stdout
    assert 'clock_1: {name: "", xml: "<clock/>"}' in (folder / "new.yaml").read_text()


def test_what_still_differs_fails(folder: Path) -> None:
    text = MERGED.format(height="0.01").replace(
        "<worldbody>", '<custom><text name="t" data="x"/></custom><worldbody>'
    )
    (folder / "merged.xml").write_text(text)
    result = run("import", "merged.xml", "models/tool.xml")
    assert result.exit_code == 1
    assert result.stdout.splitlines()[-2:] == [
        "it builds, and is not yet the model of merged.xml:",
        "  text `t` is missing",
    ]


def test_nothing_is_overwritten(folder: Path) -> None:
    (folder / "merged.xml").write_text(MERGED.format(height="0.01"))
    before = (folder / "cell.yaml").read_text()
    result = run("import", "merged.xml", "models/tool.xml", "-o", "cell.yaml")
    assert result.exit_code == 2 and "there already" in result.stderr
    assert (folder / "cell.yaml").read_text() == before


def test_a_model_that_is_not_there(folder: Path) -> None:
    result = run("import", "gone.xml", "models/tool.xml")
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr
    assert not (folder / "gone.yaml").exists()
