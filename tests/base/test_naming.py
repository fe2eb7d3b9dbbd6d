"""Names as file names that no system refuses, and characters that no new name has."""

from __future__ import annotations

import ntpath
import sys

import pytest
from mjcompose.base.naming import file_name, is_portable, odd_character, portable_path, portable_step

HOSTILE = [
    "../../home/arm",
    "/etc/passwd",
    "..",
    ".",
    "",
    "a/b",
    "a\\b",
    "C:x",
    "~/x",
    "con",
    "NUL.zip",
    "Aux.tar.gz",
    "LPT9",
    "com¹",
    "conin$",
    "a.",
    "a ",
    "-rf",
    "--output",
    "a\nb",
    "a\x00b",
    "caf\udce9",
    "x\u202egpj.exe",
    ".bashrc",
    "...",
    "CON .x",
    "a:stream",
    'a?*<>|"',
]


@pytest.mark.parametrize("name", HOSTILE)
def test_a_file_name_stays_in_its_folder_on_every_system(name: str) -> None:
    made = file_name(name)
    assert made == file_name(made)
    assert ntpath.basename(made) == made and made not in ("", ".", "..")
    assert made.isprintable() and not set(made) & set('<>:"/\\|?* ') and made[0] not in ".-" and made[-1] != "."
    assert is_portable(f"{made}.zip") and is_portable(f"{made}/model.xml")


@pytest.mark.skipif(sys.version_info < (3, 13), reason="ntpath.isreserved")
@pytest.mark.parametrize("name", HOSTILE)
def test_names_that_python_knows_as_reserved_are_not_portable(name: str) -> None:
    step = name.replace("/", "_")
    assert not (ntpath.isreserved(step) and is_portable(step))
    assert not step or not ntpath.isreserved(portable_step(step))


DEVICES = [
    "con",
    "prn",
    "aux",
    "nul",
    "conin$",
    "conout$",
    *(f"{port}{number}" for port in ("com", "lpt") for number in "0123456789¹²³"),
]


@pytest.mark.parametrize("name", DEVICES)
def test_no_file_is_a_device_of_windows(name: str) -> None:
    for written in (name, name.upper(), f"{name}.obj", f"{name}.tar.gz", f"{name} .obj"):
        assert not is_portable(written) and not is_portable(f"assets/{written}/a.obj")
        assert portable_step(written).partition(".")[0].rstrip() not in (name, name.upper())


@pytest.mark.parametrize(
    "name", ["arm", "cell-1kg", "left arm", "bras_é", "1.5", "a.b", "console", "com10", "nullable.obj", "a-b", "x~1"]
)
def test_usual_names_stay(name: str) -> None:
    assert file_name(name) == name.replace(" ", "_").replace("~", "_")
    assert portable_path(f"assets/{name}/{name}.obj") == f"assets/{name}/{name}.obj"
    assert odd_character(name) is None


@pytest.mark.parametrize(
    "name",
    [
        "a\nb",
        "a\r",
        "\ta",
        "a\x1b[31m",
        "a\x7f",
        "a\x85b",
        "a\u2028b",
        "\u202ea",
        "a\u2066b",
        "a\u200bb",
        "\ufeffa",
        "\udce9",
    ],
)
def test_names_with_characters_that_nobody_sees_are_odd(name: str) -> None:
    assert odd_character(name) is not None
    assert name not in str(odd_character(name))
