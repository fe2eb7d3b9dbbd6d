"""`mjcompose upgrade` as it is typed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from cli.shell import run
from mjcompose.base.diagnostic import Span
from mjcompose.mujoco.environments import Moved
from mjcompose.tools.migrate import upgrade as module
from mjcompose.tools.migrate.editing import Meaning, MigrationStep
from mjcompose.tools.migrate.migrate import installed
from mjcompose.tools.migrate.upgrade import Caused, Upgrade
from pytest import MonkeyPatch

MODEL = '<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody></mujoco>'


def test_the_same_version(folder: Path) -> None:
    (folder / "m.xml").write_text(MODEL)
    result = run("upgrade", "m.xml", "--from", installed(), "--seconds", "0.1")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.startswith(
        f"m.xml moves the same from MuJoCo {installed()} to {installed()}, within 0.001 m or rad"
    )


def test_a_number_is_finite(folder: Path) -> None:
    (folder / "m.xml").write_text(MODEL)
    for option in ("--seconds", "--tol"):
        for value in ("nan", "inf"):
            assert run("upgrade", "m.xml", "--from", installed(), option, value).exit_code == 2


def test_differences_with_their_causes(folder: Path, monkeypatch: MonkeyPatch) -> None:
    moved = [
        Moved("joint", name, amount, unit="rad", trial="hold home", time=0.1)
        for name, amount in (("a", 1), ("b", 0.5), ("c", 0.1))
    ]
    caused = (
        Caused(moved[0], (MigrationStep("gap", Span("m.xml", 3, 7), "wrote `gap`"),)),
        Caused(moved[1], (), (Meaning("margins", "they add", Span("m.xml", 4, 5), None),)),
        Caused(moved[2]),
    )
    found = Upgrade("3.8.1", "4.0.0", ("hold home",), moved=caused, diverged=("drop",))
    monkeypatch.setattr(module, "upgrade", lambda *_: found)
    result = run("upgrade", "m.xml", "--from", "3.8")
    assert result.exit_code == 1
    assert result.stdout.splitlines() == [
        "m.xml from MuJoCo 3.8.1 to 4.0.0: 3 differences in hold home",
        "  joint a: 1 rad apart in `hold home`, from 0.1 s on",
        "    cause: m.xml:3:7: gap, which `migrate` undoes: wrote `gap`",
        "  joint b: 0.5 rad apart in `hold home`, from 0.1 s on",
        "    perhaps: m.xml:4:5: margins: they add",
        "  joint c: 0.1 rad apart in `hold home`, from 0.1 s on",
        "    cause: no line of the model; MuJoCo solves or collides differently",
        "  the simulation diverges in `drop`",
    ]
    compiled = replace(found, inertias=("link", "hand"))
    monkeypatch.setattr(module, "upgrade", lambda *_: compiled)
    lines = run("upgrade", "m.xml", "--from", "3.8").stdout.splitlines()
    assert "    cause: no line of the model; MuJoCo compiles another mass or inertia of `link`, `hand`" in lines
    data = json.loads(run("upgrade", "m.xml", "--from", "3.8", "--output-format", "json").stdout)
    assert data["moved"][0]["causes"] == [{"change": "gap", "at": "m.xml:3:7", "edit": "wrote `gap`"}]
    assert [each["name"] for each in data["moved"]] == ["a", "b", "c"]


def test_wrong_usage(folder: Path) -> None:
    result = run("upgrade", "r.yaml", "--from", "3.8")
    assert result.exit_code == 2 and "moves_alike: mujoco==3.8" in result.stderr
    assert run("upgrade", "m.xml").exit_code == 2
    result = run("upgrade", "nothing.xml", "--from", "3.8")
    assert result.exit_code == 2 and "nothing.xml" in result.stderr
