"""`mjcompose render`, run as a user runs it."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mjcompose.cli.main import main

MODEL = """<mujoco>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1"/>
    <body pos="0 0 1"><freejoint/><geom name="ball" size="0.2" rgba="1 0 0 1"/></body>
  </worldbody>
  <keyframe><key name="home" qpos="0 0 1 1 0 0 0"/></keyframe>
</mujoco>
"""
RECIPE = """recipe: 1
base: ./ball.xml
params: {size: {default: 0.2}}
edit: [{select: {geom: ball}, set: {size: ["${size}"]}}]
matrix: {axes: {size: [0.1, 0.2, 0.3]}}
"""
ROBOT = '<robot name="r"><link name="a"><visual><geometry><sphere radius="0.1"/></geometry></visual></link></robot>'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.xml").write_text(MODEL)
    (tmp_path / "ball.yaml").write_text(RECIPE)
    (tmp_path / "robot.urdf").write_text(ROBOT)
    return tmp_path


def _run(*words: str) -> Result:
    result = CliRunner().invoke(main, ["render", *words])
    if "no-rendering" in result.output:
        pytest.skip("there is no OpenGL")
    return result


def _size(path: Path) -> tuple[int, int]:
    header = path.read_bytes()[:24]
    assert header[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", header[16:])
    return width, height


@pytest.mark.parametrize("target", ["ball.xml", "robot.urdf"])
def test_a_model_is_a_picture(folder: Path, target: str) -> None:
    result = _run(target, "-o", "out/a.png", "--size", "64x48")
    assert (result.exit_code, result.stdout) == (0, "wrote out/a.png\n")
    assert _size(folder / "out/a.png") == (64, 48)
    assert [path.name for path in (folder / "out").iterdir()] == ["a.png"]


def test_the_cells_of_a_matrix_are_a_sheet(folder: Path) -> None:
    result = _run("ball.yaml", "--all", "-o", "sheet.png", "--size", "64x48")
    assert (result.exit_code, result.output) == (0, "wrote sheet.png: 3 pictures\n")
    width, height = _size(folder / "sheet.png")
    assert width > 2 * 64 and height > 2 * 48


def test_any_number_of_processes_draws_the_same_sheet(folder: Path) -> None:
    for jobs in ("1", "3"):
        result = _run("ball.yaml", "--all", "-o", f"{jobs}.png", "--size", "64x48", "--jobs", jobs)
        assert result.exit_code == 0
    assert (folder / "1.png").read_bytes() == (folder / "3.png").read_bytes()


def test_a_film_is_a_gif(folder: Path) -> None:
    result = _run("ball.xml", "-o", "a.gif", "--play", "0.2", "--size", "64x48")
    assert (result.exit_code, result.output) == (0, "wrote a.gif\n")
    assert (folder / "a.gif").read_bytes().startswith(b"GIF89a")


def test_a_film_of_what_diverges_is_an_error_and_no_file(folder: Path) -> None:
    joint = '<joint name="spring" type="slide" stiffness="1e6" springref="0.5"/>'
    wrong = MODEL.replace("<freejoint/>", joint).replace('name="ball"', 'name="ball" mass="0.1"')
    wrong = wrong.replace("<worldbody>", '<option timestep="0.02"/><worldbody>')
    (folder / "ball.xml").write_text(wrong.replace(' qpos="0 0 1 1 0 0 0"', ""))
    (folder / "a.gif").write_text("older")
    result = _run("ball.xml", "-o", "a.gif", "--play", "1", "--size", "64x48")
    assert result.exit_code == 1 and "error[unstable]" in result.output
    assert "NaN or a huge acceleration in joint `spring` after 0.0" in result.output
    assert (folder / "a.gif").read_text() == "older"
    assert _run("ball.xml", "-o", "a.png", "--size", "64x48").exit_code == 0


def test_without_an_encoder_there_is_no_mp4_but_a_line(folder: Path) -> None:
    result = _run("ball.xml", "-o", "a.mp4", "--turntable", "--size", "64x48")
    if result.exit_code == 0:
        assert (folder / "a.mp4").read_bytes()[4:8] == b"ftyp"
    else:
        assert "error[no-video]" in result.output and "mjcompose[video]" in result.output
        assert not (folder / "a.mp4").exists()


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["ball.xml", "--key", "hom"], 1, "did you mean `--key home`?"),
        (["ball.xml", "--camera", "frnt"], 1, "did you mean `--camera front`?"),
        (["ball.xml", "-o", "a.jpg"], 1, "error[output-kind]"),
        (["ball.xml", "--size", "big"], 2, "is not WIDTHxHEIGHT"),
        (["ball.xml", "--background", "pinkish"], 2, "is not a color"),
        (["ball.xml", "--set", "a=1"], 1, "is not a recipe and has no parameter `a`"),
        (["ball.xml", "--all"], 1, "has neither cells nor samples"),
        (["ball.yaml", "--all", "--turntable"], 2, "does not move"),
        (["none.xml"], 2, "error[file-not-found]"),
    ],
)
def test_what_is_wrong_is_a_line(folder: Path, words: list[str], code: int, said: str) -> None:
    result = _run(*words)
    assert said in result.output
    assert result.exit_code == code
    assert not (folder / "build").exists() and "Traceback" not in result.output


def test_a_picture_looks_at_an_element_with_names_and_parts_apart(folder: Path) -> None:
    (folder / "two.xml").write_text(
        MODEL.replace("<body pos", '<body name="left/a" pos').replace(
            "</worldbody>", '<body name="right/b" pos="3 0 1"><geom name="far" size="0.2"/></body></worldbody>'
        )
    )
    for number, words in enumerate(([], ["--look", "geom/far"], ["--explode"], ["--labels", "body,geom"])):
        result = _run("two.xml", "-o", f"{number}.png", "--size", "64x48", *words)
        assert (result.exit_code, result.output) == (0, f"wrote {number}.png\n")
    assert len({(folder / f"{number}.png").read_bytes() for number in range(4)}) == 4


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--look", "far"], "is not an element: write body/NAME"),
        (["--look", "geom/fax"], "the geom `fax` does not exist"),
        (["--look", "geom/ball", "--camera", "front"], "both choose the view"),
        (["--labels", "site,links"], "`links` is not a kind with labels"),
        (["--explode", "--play", "1"], "for a model at rest"),
    ],
)
def test_a_wrong_subject_is_an_error(folder: Path, words: list[str], message: str) -> None:
    result = _run("ball.xml", "-o", "a.png", *words)
    assert result.exit_code and not (folder / "a.png").exists()
    assert message in result.output
