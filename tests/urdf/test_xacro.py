"""Which files are templates, which files they name, and what becomes of an expansion that fails."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cli.shell import run
from mjcompose.base.access import ALL, Door
from mjcompose.urdf import xacro
from mjcompose.urdf.read import UrdfReader
from mjcompose.urdf.xacro import files_named, is_template
from urdf.parts import ARM, robot

Reader = Callable[..., UrdfReader]
DECLARED = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
PLAIN = [
    f"{DECLARED}<link name='a'/></robot>",
    f"{DECLARED}<!-- made by xacro from $(find arm)/a.xacro with ${{x}} and <xacro:m/> --><link name='a'/></robot>",
    "<robot name='r'><gazebo><plugin>${HOME} $(arg x)</plugin></gazebo></robot>",
    f"{DECLARED}<link name='cost in $'/></robot>",
]
TEMPLATES = [
    f"{DECLARED}<xacro:m/></robot>",
    f"{DECLARED}<link name='${{x}}'/></robot>",
    f"{DECLARED}<!-- a --><link name='$(arg x)'/></robot>",
    "<robot name='r'><xacro:m/></robot>",
    f"{DECLARED}<!-- a --><xacro:include filename='b'/><!-- c --></robot>",
]


@pytest.mark.parametrize("text", PLAIN)
def test_a_file_that_declares_xacro_alone_is_no_template(text: str) -> None:
    assert not is_template(Path("r.urdf"), text.encode())
    assert is_template(Path("r.urdf.xacro"), text.encode())


@pytest.mark.parametrize("text", TEMPLATES)
def test_a_template_has_something_for_xacro(text: str) -> None:
    assert is_template(Path("r.urdf"), text.encode())


def test_a_plain_file_is_read_without_xacro(reader: Reader, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro, "call_confined", lambda *_, **__: pytest.fail("it is no template"))
    declared = robot(*ARM).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    assert reader("r.urdf", declared).unit() is not None


@pytest.mark.parametrize(
    "answer",
    [
        {"ok": False, "error": "it takes longer than 1 s", "crash": "timeout"},
        {"ok": False, "error": "its process cannot be confined: Landlock", "crash": "unconfined"},
        {"ok": True, "value": {"other": "safe_eval"}},
        {"ok": True, "value": {"missing": True}},
        {
            "ok": True,
            "value": {
                "text": "<robot/>",
                "files": ["/etc/passwd"],
                "places": [[0, 1, 0, "robot"]],
                "warnings": [],
                "unused": [],
                "arguments": [],
            },
        },
    ],
)
def test_what_fails_around_an_expansion_is_an_error(
    reader: Reader, monkeypatch: pytest.MonkeyPatch, answer: dict[str, Any]
) -> None:
    monkeypatch.setattr(xacro, "call_confined", lambda *_, **__: answer)
    read = reader("r.xacro", f"{DECLARED}<link name='a'/></robot>")
    assert read.unit() is None
    (error,) = read.sink.errors
    assert error.span is not None and error.code in ("xacro", "not-installed", "source-outside")


def named(folder: Path, text: str, door: Door, **packages: Path) -> list[str]:
    file = folder / "urdf" / "r.xacro"
    file.parent.mkdir(exist_ok=True)
    return sorted(
        Path(os.path.normpath(each)).relative_to(folder.parent).as_posix()
        for each in files_named(file, text.encode(), door, packages)
    )


def test_files_with_values_in_their_names_are_looked_for_in_the_package(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    for name in (
        "config/a/limits.yaml",
        "config/b/limits.yaml",
        "config/b/other.yaml",
        "urdf/part_x.xml",
        "urdf/[1]x.xml",
    ):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("1")
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    door = Door.of([tmp_path])
    limits = ["arm/config/a/limits.yaml", "arm/config/b/limits.yaml"]
    found = "<a filename='$(find arm)/config/${kind}/limits.yaml'/>"
    assert named(folder, found, door, arm=folder) == limits
    assert named(folder, "<a filename='../config/${kind}/limits.yaml'/>", door) == limits
    assert named(folder, "${load_yaml('../config/${kind}/limits.yaml')}", door) == limits
    assert named(folder, "<a filename='part_${x}.xml'/>", door) == ["arm/urdf/part_x.xml"]
    assert named(folder, "<a filename='[1]${x}.xml'/>", door) == ["arm/urdf/[1]x.xml"]
    assert named(folder, found, Door.of([folder / "urdf"]), arm=folder) == []


def test_nothing_is_searched_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "arm"
    folder.mkdir()
    looked: list[str] = []
    names = os.listdir
    monkeypatch.setattr(os, "listdir", lambda at: looked.append(str(at)) or names(at))
    begin = time.perf_counter()
    for written in (
        "/usr/**/${x}/**/${y}",
        "../../../../../../usr/${x}/lib",
        "file:///usr/${x}/a",
        "$(find usr)/${x}/a",
        "~/${x}",
    ):
        for door in (ALL, Door.of([folder])):
            assert named(folder, f"${{load_yaml('{written}')}}", door, arm=folder) == []
    assert time.perf_counter() - begin < 1
    assert not [each for each in looked if not each.startswith(str(folder))]


def test_a_file_that_may_not_be_read_is_not_named(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    folder.mkdir()
    (folder / "in.xml").write_text("<a filename='../secret.xml'/>")
    (tmp_path / "secret.xml").write_text("<a/>")
    text = "<a filename='../in.xml'/><a filename='../../secret.xml'/><a filename='/etc/passwd'/>"
    assert named(folder, text, Door.of([folder])) == ["arm/in.xml"]
    assert named(folder, text, Door.of([tmp_path])) == ["arm/in.xml", "secret.xml"]


@pytest.mark.parametrize("error", [RecursionError, MemoryError, UnicodeError])
def test_a_search_whose_judgement_fails_finds_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: type[Exception]
) -> None:
    def fails(*_: object) -> object:
        raise error

    monkeypatch.setattr(Door, "sees", fails)
    (tmp_path / "arm").mkdir()
    with pytest.raises(error):
        named(tmp_path / "arm", "<a filename='part_${x}.xml'/>", Door.of([tmp_path]))


LINK = '<link name="b"><collision><geometry><sphere radius="${{{}}}"/></geometry></collision></link></robot>'


def recipe(folder: Path, **parts: str) -> Path:
    """A recipe that attaches templates, and checks that each is unchanged."""
    for name, text in parts.items():
        (folder / f"{name}.urdf.xacro").write_text(text)
    lines = [f"  {name}: {{model: ./{name}.urdf.xacro}}" for name in parts]
    path = folder / "cell.yaml"
    path.write_text(
        "\n".join(["recipe: 1", "attach:", *lines, "check: {whole: {unchanged: {}}}", "allow: [license-missing]", ""])
    )
    return path


def test_the_check_reads_a_template_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the first expansion got wrong, whatever did that, is found: the check has a process of its own."""
    path = recipe(tmp_path, a=DECLARED + LINK.format("2 * 3"))
    given = xacro.call_confined
    count = []

    def once(*arguments: Any, **options: Any) -> dict[str, Any]:
        answer = given(*arguments, **options)
        count.append(answer)
        if len(count) == 1:
            answer["value"]["text"] = answer["value"]["text"].replace('radius="6"', 'radius="7"')
        return answer

    assert run("check", str(path), "--no-cache").exit_code == 0
    monkeypatch.setattr(xacro, "call_confined", once)
    result = run("check", str(path), "--no-cache")
    assert len(count) > 1
    assert result.exit_code == 1 and "unchanged" in result.output


def test_a_template_beside_another_is_what_it_is_alone(tmp_path: Path) -> None:
    changes = '<xacro:property name="pi" value="7" scope="global"/><xacro:property name="m" value="5"/>'
    first = DECLARED + changes + LINK.format("pi")
    second = DECLARED + LINK.format("pi + math.pi")
    path = recipe(tmp_path, a=first, b=second)
    result = run("build", str(path), "--no-cache", "-o", str(tmp_path / "out"))
    assert result.exit_code == 0, result.output
    written = (tmp_path / "out" / "model.xml").read_text()
    assert 'size="7"' in written and 'size="6.28318530717958' in written  # MuJoCo 3 writes more digits
