"""`build --depfile`: what Make and Ninja read of the inputs."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from cli.shell import RECIPE, run
from mjcompose.bundle.bundle import OutputError
from mjcompose.cli.build_records import render_depfile

INPUTS = {"cell.yaml", "models/arm.xml", "models/tool.xml", "models/meshes/cover.obj", "models/LICENSE"}


def needed(text: str, folder: Path) -> tuple[str, set[str]]:
    """The outputs of a depfile, and the inputs relative to a folder."""
    head, *rest = text.partition("\n/")[0].replace("\\\n", "").split("  ")
    return head.rstrip(": "), {Path(each.strip()).relative_to(folder).as_posix() for each in rest}


def test_every_input_is_in_it_whether_built_or_known(folder: Path) -> None:
    for out, target in (("o.zip", "o.zip"), ("o/", "o/model.xml"), ("o.xml", "o.xml")):
        for _ in range(2):
            assert run("build", "cell.yaml", "-o", out, "--depfile", "o.d").exit_code == 0
            assert needed(Path("o.d").read_text(), folder) == (target, INPUTS)
    assert run("lock", "cell.yaml").exit_code == 0
    Path("values.yaml").write_text("{}\n")
    assert run("build", "cell.yaml", "--depfile", "o.d", "--set-file", "values.yaml").exit_code == 0
    assert needed(Path("o.d").read_text(), folder) == ("build/cell.zip", INPUTS | {"cell.lock", "values.yaml"})


def test_recipes_that_it_extends_and_nests(folder: Path) -> None:
    Path("top.yaml").write_text("recipe: 1\nextends: ./cell.yaml\nattach:\n  more: {model: ./inner.yaml, body: link}\n")
    Path("inner.yaml").write_text("recipe: 1\nbase: ./models/tool.xml\n")
    result = run("build", "top.yaml", "-o", "o.zip", "--depfile", "o.d")
    assert result.exit_code == 0, result.stderr
    assert needed(Path("o.d").read_text(), folder)[1] == INPUTS | {"top.yaml", "inner.yaml"}


def test_cells_and_worlds_are_outputs_together(folder: Path) -> None:
    Path("cell.yaml").write_text(RECIPE + "params: {size: 0.1}\nmatrix: {axes: {size: [0.1, 0.2]}}\n")
    for jobs in ("1", "2"):
        shutil.rmtree("o", ignore_errors=True)
        assert run("build", "cell.yaml", "--all", "-j", jobs, "-o", "o/{name}.zip", "--depfile", "o.d").exit_code == 0
        outputs, inputs = needed(Path("o.d").read_text(), folder)
        assert len(outputs.split()) == 2 and inputs == INPUTS
    assert run("build", "cell.yaml", "--worlds", "w.npz", "-o", "w.zip", "--depfile", "w.d").exit_code == 0
    assert needed(Path("w.d").read_text(), folder) == ("w.zip w.npz", INPUTS)


def test_a_failed_build_writes_none(folder: Path) -> None:
    assert run("build", "wrong.yaml", "--depfile", "o.d").exit_code == 1
    assert not Path("o.d").exists()
    result = run("build", "cell.yaml", "--depfile", "models/arm.xml")
    assert result.exit_code == 1 and "error[output-unwritable]" in result.stderr
    assert Path("models/arm.xml").read_text().startswith("<mujoco")
    assert run("build", "cell.yaml", "-o", "-", "--depfile", "o.d").exit_code == 2


def test_no_name_with_a_line_break() -> None:
    with pytest.raises(OutputError, match="line break"):
        render_depfile(["a\nb"], [])


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
def test_make_reads_odd_names(folder: Path) -> None:
    odd = folder / "models" / "a b" / "c#$1\\ d.xml"
    odd.parent.mkdir()
    odd.write_text(Path("models/tool.xml").read_text())
    Path("odd one.yaml").write_text(RECIPE.replace("./models/tool.xml", f"'./models/a b/{odd.name}'"))
    result = run("build", "odd one.yaml", "-o", "my out.zip", "--depfile", "o.d")
    assert result.exit_code == 0, result.stderr
    Path("Makefile").write_text("my\\ out.zip:\n\t@touch '$@'; echo built\n-include o.d\n")

    def make() -> str:
        return subprocess.run(["make"], capture_output=True, text=True, check=True).stdout

    make()
    assert "up to date" in make()
    odd.touch()
    assert "built" in make()
    odd.rename(folder / "gone.xml")
    assert "built" in make()  # an input that is gone is no error of Make
