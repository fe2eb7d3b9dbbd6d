from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.sources.kinds import PATH
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import Source, SourceError


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / ".git").mkdir()
    for name in ("parts/table.xml", "parts/table.png", "arm.urdf", "cell.yaml", "lab.YML", "Hand.XML"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text("")
    return tmp_path


def fail(text: str, folder: Path) -> SourceError:
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=folder, environment={})
    return caught.value


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("./parts/table.xml", "mjcf"),
        ("parts/../parts/table.xml", "mjcf"),
        ("Hand.XML", "mjcf"),
        ("arm.urdf", "urdf"),
        ("./cell.yaml", "recipe"),
        ("lab.YML", "recipe"),
    ],
)
def test_finds_a_file(project: Path, text: str, kind: str) -> None:
    source = resolve(text, relative_to=project, environment={})
    assert source == Source(project / text, PATH, text)
    assert source.format == kind
    assert source.path.is_file()


def test_an_absolute_path_stands_alone(project: Path) -> None:
    wanted = project / "arm.urdf"
    assert resolve(str(wanted), relative_to=project / "elsewhere", environment={}).path == wanted


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_pipe_is_no_file(project: Path) -> None:
    os.mkfifo(project / "pipe.xml")
    error = fail("./pipe.xml", project)
    assert error.code == "source-kind"
    assert error.message == "the model reference `./pipe.xml` is neither a file nor a folder"


def test_a_missing_file_names_those_beside_it(project: Path) -> None:
    error = fail("./parts/tabel.xml", project)
    assert error.code == "source-not-found"
    assert error.message == "the model `./parts/tabel.xml` does not exist"
    assert error.notes[0] == f"looked for `{project / 'parts' / 'tabel.xml'}`"
    assert "./parts/table.xml" in error.notes[1]
    assert error.help == "write `./parts/table.xml`"


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("./table.xml", "./parts/table.xml"),
        ("./prats/table.xml", "./parts/table.xml"),
        ("cell.yml", "./cell.yaml"),
        ("../cell.yaml", "./cell.yaml"),
    ],
)
def test_finds_what_was_meant(project: Path, text: str, meant: str) -> None:
    assert fail(text, project).help == f"write `{meant}`"


def test_a_folder_that_does_not_exist_is_named_with_those_that_do(project: Path) -> None:
    error = fail("./prats/deep/table.xml", project)
    assert error.message.endswith("does not exist, nor does the folder `./prats`")
    assert error.notes[1].startswith("folders that exist: ./parts")
    assert error.help == "write `./parts/table.xml`"  # the corrected path has no such file, another place has


@pytest.mark.parametrize(
    ("text", "written"),
    [
        (r".\parts\table.xml", "write `./parts/table.xml`"),
        (r"parts\humanoid.xml", "write `parts/humanoid.xml`"),
        (r"C:\Users\me\humanoid.xml", "`./models/arm.xml`"),
    ],
)
def test_backslashes(project: Path, text: str, written: str) -> None:
    help = fail(text, project).help
    assert help is not None and help.startswith("paths are written with `/`") and help.endswith(written)


def test_nothing_near_is_no_guess(project: Path) -> None:
    error = fail("./humanoid.xml", project)
    assert error.help is None
    assert "./arm.urdf" in error.notes[1]


def test_a_folder_without_models(tmp_path: Path) -> None:
    assert fail("./arm.xml", tmp_path).notes[1] == "there are no model files"


def test_a_home_folder_is_not_expanded(project: Path) -> None:
    assert fail("~/humanoid.xml", project).help == "`~` is not expanded: write the whole path"


@pytest.mark.parametrize(
    ("text", "problem", "fix"),
    [
        ("./arm", "has no file suffix", "write `./arm.urdf`"),
        ("parts/table", "has no file suffix", "write `./parts/table.xml`"),
        ("robot", "has no file suffix", "`menagerie:ROBOT`"),
        ("./parts/table.png", "ends in `.png`", "write `./parts/table.xml`"),
        ("./old.mjz", "is a bundle", "refer to the recipe or the XML"),
    ],
)
def test_the_suffix_says_what_a_file_is(project: Path, text: str, problem: str, fix: str) -> None:
    error = fail(text, project)
    assert error.code == "source-kind"
    assert problem in error.message
    assert error.help is not None
    assert fix in error.help


def test_a_folder_is_no_model(project: Path) -> None:
    error = fail("./parts", project)
    assert error.code == "source-kind"
    assert error.help == "write `./parts/table.xml`"
    assert fail("./parts/", project).help == "write `./parts/table.xml`"


@pytest.mark.parametrize("text", ["x" * 300 + ".xml", "./arm.urdf/inner.xml"])
def test_paths_that_cannot_be_are_not_there(project: Path, text: str) -> None:
    assert fail(text, project).code == "source-not-found"


def test_what_is_hidden_is_not_offered(project: Path) -> None:
    (project / ".venv").mkdir()
    (project / ".venv" / "humanoid.xml").write_text("")
    (project / ".humanoid.xml").write_text("")
    told = fail("./humanoid.xml", project).notes[1]
    assert ".venv" not in told and ".humanoid" not in told
