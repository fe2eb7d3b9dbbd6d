"""What a model takes from its parts is said by `build`, `plan`, `explain` and the manifest."""

from __future__ import annotations

import json
from pathlib import Path
from zipfile import ZipFile

from cli.shell import run

_PART = '<mujoco><option {}/><worldbody><body name="b"><geom size="0.1"/></body></worldbody></mujoco>'


def _recipe(folder: Path) -> None:
    (folder / "one.xml").write_text(_PART.format('cone="elliptic" integrator="Euler"'))
    (folder / "two.xml").write_text(_PART.format('cone="elliptic" impratio="10"'))
    (folder / "inner.yaml").write_text("recipe: 1\nattach:\n  two: {model: ./two.xml}\n")
    (folder / "r.yaml").write_text(
        "recipe: 1\nattach:\n  one: {model: ./one.xml}\n  in: {model: ./inner.yaml, pos: [1, 0, 0]}\n"
    )


SAID = ["option.cone elliptic, from one/, in/two/", "option.impratio 10, from in/two/"]


def test_build_says_it_when_it_builds_and_when_it_does_not(folder: Path) -> None:
    _recipe(folder)
    for begins in ("wrote", "r.zip is up to date"):
        lines = run("build", "r.yaml", "-o", "r.zip").stdout.splitlines()
        assert lines[0].startswith(begins)
        assert [line for line in lines if "adopted" in line] == [f"  adopted {words}" for words in SAID]
    told = json.loads(run("build", "r.yaml", "-o", "r.zip", "--output-format", "json").stdout.splitlines()[-1])
    assert told["adopted"][0] == {"setting": "option.cone", "value": "elliptic", "parts": ["one/", "in/two/"]}
    with ZipFile(folder / "r.zip") as archive:
        manifest = json.loads(archive.read("manifest.json"))
    assert [each["setting"] for each in manifest["adopted"]] == ["option.cone", "option.impratio"]
    assert manifest["adopted"][1]["origin"] == "two.xml:1"


def test_plan_says_it_without_building(folder: Path) -> None:
    _recipe(folder)
    lines = run("plan", "r.yaml").stdout.splitlines()
    assert [line for line in lines if "adopt" in line] == [f"  adopt {words}" for words in SAID]
    assert [
        each["value"] for each in json.loads(run("plan", "r.yaml", "--output-format", "json").stdout)["adopted"]
    ] == [
        "elliptic",
        "10",
    ]


def test_plan_knows_what_recipes_set_and_leave_out(folder: Path) -> None:
    _recipe(folder)
    (folder / "inner.yaml").write_text("recipe: 1\nattach:\n  two: {model: ./two.xml}\noption: {impratio: 3}\n")
    (folder / "r.yaml").write_text(
        "recipe: 1\nattach:\n  one: {model: ./one.xml, drop: [option]}\n  in: {model: ./inner.yaml}\n"
    )
    lines = run("plan", "r.yaml").stdout.splitlines()
    assert [line for line in lines if "adopt" in line] == [
        "  adopt option.cone elliptic, from in/two/",
        "  adopt option.impratio 3, from in/",
    ]


def test_explain_names_the_part_and_its_line(folder: Path) -> None:
    _recipe(folder)
    text = run("explain", "r.yaml", "option", "impratio").stdout
    assert "adopted from in/two/: neither base nor recipe writes it, two.xml:1" in text


def test_build_says_how_many_pairs_do_not_collide(folder: Path) -> None:
    link = '<body name="{}" pos="0 0 {}"><joint axis="0 1 0" range="-10 10"/><geom size="0.05"/>'
    (folder / "chain.xml").write_text(
        f"<mujoco><worldbody>{link.format('a', 1)}{link.format('b', 0.3)}{link.format('c', 0.3)}"
        "</body></body></body></worldbody></mujoco>"
    )
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./chain.xml\ncontact: {exclude: auto}\n")
    for begins in ("wrote", "r.zip is up to date"):
        lines = run("build", "r.yaml", "-o", "r.zip").stdout.splitlines()
        assert lines[0].startswith(begins)
        assert "  excluded 1 pair of bodies from colliding: `mjcompose plan` names them" in lines
    assert (
        json.loads(run("build", "r.yaml", "-o", "r.zip", "--output-format", "json").stdout.splitlines()[-1])["excluded"]
        == 1
    )
