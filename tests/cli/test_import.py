from __future__ import annotations

import json
from pathlib import Path

import pytest
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
    assert "it builds, and the model equals merged.xml" in result.stdout
    assert "  tool: {model: ./models/tool.xml, pos: [0, 0, 1]}\n" in (folder / "merged.yaml").read_text()
    assert run("check", "merged.yaml").exit_code == 0
    assert run("fmt", "--check", "merged.yaml").exit_code == 0


def test_a_part_that_is_not_in_it_is_told(folder: Path) -> None:
    (folder / "other.xml").write_text(MERGED.format(height="0.01").replace('palm" pos', 'hand" pos'))
    result = run("import", "other.xml", "models/tool.xml", "-o", "new.yaml")
    assert result.exit_code == 0 and "wrote new.yaml: 0 parts" in result.stdout
    assert "warning[unknown-name]: `other.xml` has no body with the names of `models/tool.xml`" in result.stderr


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
        "it builds, and the model equals merged.xml, element by element, to seven digits",
    ]


def test_what_has_no_name_gets_none(folder: Path) -> None:
    text = MERGED.format(height="0.01").replace("</mujoco>", "<sensor><clock/></sensor></mujoco>")
    (folder / "merged.xml").write_text(text)
    result = run("import", "merged.xml", "models/tool.xml", "--output", "new.yaml")
    assert result.exit_code == 0, result.stdout
    assert 'clock_1: {name: "", xml: "<clock/>"}' in (folder / "new.yaml").read_text()


def test_what_still_differs_fails(folder: Path) -> None:
    text = MERGED.format(height="0.01").replace("<worldbody>", '<custom><text name="t" data="x"/></custom><worldbody>')
    (folder / "merged.xml").write_text(text)
    result = run("import", "merged.xml", "models/tool.xml")
    assert result.exit_code == 1
    assert result.stdout.splitlines()[-2:] == ["it builds, but does not yet match merged.xml:", "  text `t` is missing"]


def test_nothing_is_overwritten(folder: Path) -> None:
    (folder / "merged.xml").write_text(MERGED.format(height="0.01"))
    before = (folder / "cell.yaml").read_text()
    result = run("import", "merged.xml", "models/tool.xml", "-o", "cell.yaml")
    assert result.exit_code == 2 and "exists already" in result.stderr
    assert (folder / "cell.yaml").read_text() == before


def test_a_model_that_is_not_there(folder: Path) -> None:
    result = run("import", "gone.xml", "models/tool.xml")
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr
    assert not (folder / "gone.yaml").exists()


ARM = '<mujoco><worldbody><body name="base"><geom size="0.1"/><body name="link"><geom size="0.1"/>{}</body></body></worldbody></mujoco>'
HAND = '<body name="{0}palm"><geom size="0.1"/><body name="{0}finger"><geom size="0.1"/></body></body>'


@pytest.mark.parametrize(
    ("file", "name", "help"),
    [
        ("arm.sdf", "SDFormat", "`sdf2mjcf arm.sdf arm.xml`"),
        ("arm.usd", "USD", "use the MJCF or URDF that it was made from"),
        ("arm.USDZ", "USD", "use the MJCF or URDF that it was made from"),
    ],
)
def test_formats_of_others_are_one_error_with_a_way_out(folder: Path, file: str, name: str, help: str) -> None:
    (folder / file).write_bytes(b"PXR-USDC\0")
    result = run("import", file)
    assert (result.exit_code, result.stdout) == (1, "") and not (folder / "arm.yaml").exists()
    assert f"error[source-kind]: `{file}` is {name}, which mjcompose does not read\n" in result.stderr
    assert help in result.stderr and "1 error\n" in result.stderr
    (folder / "merged.xml").write_text(MERGED.format(height="0.01"))
    assert name in run("import", "merged.xml", file).stderr
    assert name in run("view", file, "--html", "x.html").stderr


def test_parts_are_looked_for(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.tools.importing.search._of_packages", lambda: iter(()))
    monkeypatch.setattr("mjcompose.tools.importing.search._of_menagerie", lambda _: iter(()))
    (folder / "whole.xml").write_text(ARM.format(HAND.format("left/")))
    (folder / "parts").mkdir()
    (folder / "parts" / "arm.xml").write_text(ARM.format(""))
    (folder / "parts" / "hand.xml").write_text(f"<mujoco><worldbody>{HAND.format('')}</worldbody></mujoco>")
    result = run("import", "whole.xml", "--among", "parts")
    assert result.exit_code == 0 and result.stdout.startswith(
        "found 2 parts among 2 models: parts/arm.xml, parts/hand.xml\n"
    )
    assert "base: ./parts/arm.xml" in (folder / "whole.yaml").read_text()

    result = run("import", "whole.xml", "-o", "alone.yaml")
    assert (
        result.exit_code == 0
        and "found none of its parts among 0 models; --among FOLDER looks further" in result.stdout
    )
    assert (folder / "alone.yaml").read_text() == "recipe: 1\nname: alone\nbase: ./whole.xml\n"
    assert run("check", "alone.yaml").exit_code == 0
    told = json.loads(run("import", "whole.xml", "-o", "data.yaml", "--output-format", "json").stdout)
    assert (told["output"], told["parts"]) == ("data.yaml", 0)


def test_bad_searches(folder: Path) -> None:
    assert run("import", "merged.xml", "models/tool.xml", "--among", "models").exit_code == 2
    assert run("import", "merged.xml", "--among", "gone").exit_code == 2
    result = run("import", "merged.xml", "menagerie:universal_robots_ur5e")
    assert result.exit_code == 2 and "PARTS are files" in result.stderr
    result = run("import", "gone.xml", "--among", "models")
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr
