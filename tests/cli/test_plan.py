from __future__ import annotations

import json
from pathlib import Path

from cli.shell import RECIPE, run, snapshot


def test_in_words(folder: Path) -> None:
    before = snapshot(folder)
    result = run("plan", "cell.yaml")
    assert result.exit_code == 0 and result.stderr == ""
    assert result.stdout == (
        "cell: the model of cell.yaml\n"
        "  start from ./models/arm.xml\n"
        "  attach tool/: ./models/tool.xml, on the site flange\n"
        "  add jointpos angle to sensor\n"
    )
    assert snapshot(folder) == before


def test_nested(folder: Path) -> None:
    (folder / "pair.yaml").write_text("recipe: 1\nattach:\n  left: {model: ./cell.yaml, joint: free}\n")
    assert run("plan", "pair.yaml").stdout == (
        "pair: the model of pair.yaml\n"
        "  start from an empty model\n"
        "  attach left/: the recipe cell.yaml, in the world, with a free joint\n"
        "    cell: the model of cell.yaml\n"
        "      start from ./models/arm.xml\n"
        "      attach tool/: ./models/tool.xml, on the site flange\n"
        "      add jointpos angle to sensor\n"
    )


def test_every_step_in_words(folder: Path) -> None:
    (folder / "all.yaml").write_text(
        RECIPE
        + "option: {timestep: 0.001, flag: {gravity: disable}}\n"
        + "default: {soft: {geom: {solref: [0.01, 1]}}}\n"
        + "add:\n"
        + "  - {to: link, geom: {size: [0.1]}}\n"
        + "  - {to: world, light: {name: lamp}}\n"
        + "contact: {exclude: [{body1: link, body2: tool/hand}]}\n"
    )
    assert run("plan", "all.yaml").stdout.splitlines()[3:] == [
        "  add a geom to the body link",
        "  add light lamp to the world",
        "  set option: timestep = 0.001, flag.gravity = disable",
        "  set the default class soft: geom",
        "  add an exclude to contact",
        "  add jointpos angle to sensor",
    ]


def test_checks_in_words(folder: Path) -> None:
    (folder / "all.yaml").write_text(
        RECIPE
        + "params: {n: 1}\n"
        + 'check: {sizes: {expect: {attr: nq, equals: "${n}"}}, sites: {expect: {select: {site: "*"}, count: 2}}, gone: {expect: {attr: nq, equals: 2}, when: false}}\n'
    )
    told = ["check sizes: expect {attr: nq, equals: 1}", "check sites: expect {select: {site: *}, count: 2}"]
    assert [line.strip() for line in run("plan", "all.yaml").stdout.splitlines()[-2:]] == told
    assert json.loads(run("plan", "all.yaml", "--output-format", "json").stdout)["checks"] == told


def test_as_json(folder: Path) -> None:
    result = run("plan", "cell.yaml", "--output-format", "json")
    told = json.loads(result.stdout)
    assert told["name"] == "cell" and told["recipe"] == "cell.yaml"
    assert told["base"]["reference"] == "./models/arm.xml" and told["base"]["licenses"] == ["LICENSE"]
    assert [part["prefix"] for part in told["parts"]] == ["tool/"]
    assert told["steps"] == ["add jointpos angle to sensor"]


def test_what_cannot_be_planned(folder: Path) -> None:
    (folder / "cell.yaml").write_text(RECIPE.replace("tool.xml", "tols.xml"))
    result = run("plan", "cell.yaml")
    assert result.exit_code == 1 and result.stdout == ""
    assert "error[source-not-found]" in result.stderr and "write `./models/tool.xml`" in result.stderr


def test_a_subtree_and_what_it_leaves(folder: Path) -> None:
    (folder / "pair.yaml").write_text(
        "recipe: 1\nbase: {model: ./models/arm.xml, subtree: link}\n"
        "attach:\n  cell: {model: ./cell.yaml, subtree: tool/palm}\n"
    )
    result = run("plan", "pair.yaml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == (
        "pair: the model of pair.yaml\n"
        "  start from ./models/arm.xml, only its body link\n"
        "    drops 1 body: base\n"
        "    drops 1 geom\n"
        "    drops 1 mesh: cover\n"
        "  attach cell/: the recipe cell.yaml, only its body tool/palm, in the world\n"
        "    drops 2 bodies: base, link\n"
        "    drops 2 geoms: rod\n"
        "    drops 1 joint: shoulder\n"
        "    drops 1 site: flange\n"
        "    drops 1 sensor: angle\n"
        "    drops 1 mesh: cover\n"
        "    cell: the model of cell.yaml\n"
        "      start from ./models/arm.xml\n"
        "      attach tool/: ./models/tool.xml, on the site flange\n"
        "      add jointpos angle to sensor\n"
    )
    told = json.loads(run("plan", "pair.yaml", "--output-format", "json").stdout)
    assert told["subtree"]["body"] == "link"
    assert told["parts"][0]["subtree"]["left"][0] == {"kind": "body", "name": "base", "lacks": None}


def test_a_subtree_that_cuts_something(folder: Path) -> None:
    arm = folder / "models" / "arm.xml"
    exclude = '<contact><exclude name="near" body1="base" body2="link"/></contact></mujoco>'
    arm.write_text(arm.read_text().replace("</mujoco>", exclude))
    (folder / "cell.yaml").write_text("recipe: 1\nbase: {model: ./models/arm.xml, subtree: link}\n")
    result = run("plan", "cell.yaml")
    assert result.exit_code == 0 and "warning[subtree-cut]" in result.stderr
    assert result.stdout.splitlines()[-1] == "    drops the exclude `near`, which needs the body `base`"


def test_a_subtree_that_is_not_there(folder: Path) -> None:
    (folder / "cell.yaml").write_text("recipe: 1\nbase: {model: ./models/arm.xml, subtree: lnik}\n")
    result = run("plan", "cell.yaml")
    assert result.exit_code == 1 and "did you mean `subtree: link`?" in result.stderr
    assert "only its body lnik" in result.stdout


REQUIRED = """\
recipe: 1
params: {mass: {type: float}, load: {type: float, default: 1}}
matrix: {axes: {mass: [2, 3]}, name: "m${mass}-l${load}"}
add: [{to: world, body: {name: b, geom: [{size: [0.1], mass: "${mass + load}"}]}}]
"""


def test_an_axis_may_be_a_parameter_without_a_default(folder: Path) -> None:
    (folder / "study.yaml").write_text(REQUIRED)
    told = run("plan", "study.yaml", "--set", "load=5")
    assert told.exit_code == 0
    assert "`mass` as in the cell m2-l5: without a default" in told.stdout and "m3-l5  mass = 3" in told.stdout
    assert json.loads(run("plan", "study.yaml", "--output-format", "json").stdout)["as_cell"] == "m2-l1"
    built = run("build", "study.yaml", "--all", "--set", "load=5", "--no-compile")
    assert built.exit_code == 0 and "wrote build/m2-l5.zip" in built.stdout
    alone = run("build", "study.yaml")
    assert alone.exit_code == 1 and "with `--all` the cells of the matrix, which set it" in alone.stderr
    assert run("lock", "study.yaml").exit_code == 0


def test_what_must_be_given_can_be_given(folder: Path) -> None:
    (folder / "study.yaml").write_text(REQUIRED.replace("load: {type: float, default: 1}", "load: {type: float}"))
    for command in (("plan",), ("lock",), ("lock", "--upgrade"), ("build", "--all", "--no-compile")):
        assert run(*command, "study.yaml").exit_code == 1
        assert run(*command, "study.yaml", "--set", "load=5").exit_code == 0


def test_a_variant_without_such_a_value(folder: Path) -> None:
    (folder / "study.yaml").write_text(
        "recipe: 1\nvariants: {tool: {none: {}, hand: {params: {width: 1}}}}\nmatrix: {axes: {tool: [none, hand]}}\n"
    )
    for command in ("plan", "build", "check"):
        result = run(command, "study.yaml", "--set", "tool=hnd")
        assert result.exit_code == 1 and "variant `tool` has no value `hnd`" in result.stderr
        assert "1 error\n" in result.stderr
    result = run("plan", "study.yaml", "--set", "tol=hand")
    assert result.exit_code == 1 and "1 error\n" in result.stderr


def test_one_cell(folder: Path) -> None:
    (folder / "study.yaml").write_text(REQUIRED.replace("[2, 3]", "[2, 3], load: [1, 5]"))
    told = run("plan", "study.yaml", "--pick", "mass=3,load=5")
    assert told.exit_code == 0 and told.stdout.startswith("m3-l5: the model of study.yaml\n")
    several = run("plan", "study.yaml", "--pick", "mass=3")
    assert several.exit_code == 2 and "`--pick mass=3` chooses" in several.stderr
    assert "cells that exist: m3-l1, m3-l5" in several.stderr
    fixed = run("plan", "study.yaml", "--pick", "m3-l5", "--set", "load=2")
    assert "`load` is an axis of the matrix" in fixed.stderr and "plan without `--pick`" in fixed.stderr


EDITED = """\
recipe: 1
base: ./models/arm.xml
attach:
  tool: {model: ./models/tool.xml, site: flange, edit: [{select: {geom: palm}, set: {condim: 4}}]}
sensor:
  angle: {type: jointpos, joint: shoulder}
  force: {type: force, site: flange}
edit:
  - {select: {geom: "**"}, set: {condim: 6}}
  - {select: {site: nothing}, optional: true, set: {group: 3}}
  - {select: {joint: shoulder}, remove: cascade}
"""


def test_edits_are_counted_and_removals_listed(folder: Path) -> None:
    before = snapshot(folder)
    (folder / "e.yaml").write_text(EDITED)
    result = run("plan", "e.yaml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert [line for line in result.stdout.splitlines() if "edit" in line or "removes" in line] == [
        "    edit {geom: palm}: set condim = 4 (1 geom)",
        "  edit {geom: **}: set condim = 6 (3 geoms)",
        "  edit {site: nothing}: set group = 3 (nothing)",
        "  edit {joint: shoulder}: remove it, with everything that refers to it (1 joint)",
        "    removes 1 joint: shoulder",
        "    removes 1 sensor: angle",
    ]
    told = json.loads(run("plan", "e.yaml", "--output-format", "json").stdout)
    assert told["parts"][0]["edited"] == [
        {"words": "edit {geom: palm}: set condim = 4", "selected": {"geom": 1}, "removed": []}
    ]
    assert told["edited"][2]["removed"] == [{"kind": "joint", "name": "shoulder"}, {"kind": "sensor", "name": "angle"}]
    (folder / "e.yaml").unlink()
    assert snapshot(folder) == before


def test_what_an_edit_cannot_do_is_told(folder: Path) -> None:
    (folder / "e.yaml").write_text(EDITED.replace("cascade", "true"))
    result = run("plan", "e.yaml")
    assert result.exit_code == 1 and "error[still-referred-to]" in result.stderr
    assert "edit {geom: **}: set condim = 6 (3 geoms)\n" in result.stdout
    assert "edit {joint: shoulder}: remove (1 joint)\n" in result.stdout
    assert "removes" not in result.stdout
