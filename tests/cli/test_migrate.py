"""`mjcompose migrate` as it is typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose.tools.migrate.migrate import installed

OLD = """\
<mujoco model="old">
  <!-- as it was -->
  <option mpr_iterations="20"/>
  <worldbody>
    <body name="link"><joint name="j"/>
      <geom size=".1"   margin='.1' gap=".1"/></body>
  </worldbody>
</mujoco>
"""
IN_TWO = '<mujoco>\n  <include file="rest.xml"/>\n  <worldbody><geom size=".1"/></worldbody>\n</mujoco>\n'
REST = '<mujocoinclude>\n  <option mpr_iterations="20"/>\n</mujocoinclude>\n'


def test_the_changes_are_shown_and_nothing_is_written(folder: Path) -> None:
    (folder / "old.xml").write_text(OLD)
    before = sorted(folder.iterdir())
    result = run("migrate", "old.xml", "--from", "3.2.2")
    assert result.exit_code == 1, result.output
    assert '+  <option ccd_iterations="20">\n' in result.stdout
    assert "can migrate old.xml from MuJoCo 3.2.2 to" in result.stdout
    assert "not proved: `--prove` compares both versions after `mjcompose install mujoco==3.2.2`" in result.stdout
    assert sorted(folder.iterdir()) == before and (folder / "old.xml").read_text() == OLD


def test_a_new_file_keeps_comments_and_layout(folder: Path) -> None:
    (folder / "old.xml").write_text(OLD)
    result = run("migrate", "old.xml", "--from", "3.2.2", "-o", "new.xml")
    assert (result.exit_code, result.stderr) == (0, "")
    text = (folder / "new.xml").read_text()
    assert "  <!-- as it was -->\n" in text
    assert '      <geom size=".1"   margin="0" gap=".1"/></body>\n' in text
    assert (folder / "old.xml").read_text() == OLD
    again = run("migrate", "old.xml", "--from", "3.2.2", "-o", "new.xml")
    assert again.exit_code == 2 and "new.xml exists already" in again.stderr


def test_a_folder_has_what_the_model_reads(folder: Path) -> None:
    result = run("migrate", "models/arm.xml", "--from", "3.2.2", "-o", "new")
    assert result.exit_code == 0, result.output
    assert (folder / "new/meshes/cover.obj").read_bytes() == (folder / "models/meshes/cover.obj").read_bytes()
    assert 'nativeccd="disable"' in (folder / "new/arm.xml").read_text()


def test_one_file_elsewhere_would_not_find_the_rest(folder: Path) -> None:
    result = run("migrate", "models/arm.xml", "--from", "3.2.2", "-o", "arm.xml")
    assert result.exit_code == 1
    assert "error[output-kind]: `arm.xml` would not find its files" in result.stderr
    assert not (folder / "arm.xml").exists()


@pytest.mark.slow
def test_what_is_included_changes_where_it_stands(folder: Path) -> None:
    (folder / "two.xml").write_text(IN_TWO)
    (folder / "rest.xml").write_text(REST)
    alone = run("migrate", "two.xml", "--from", "3.2.2", "-o", "new.xml")
    assert alone.exit_code == 1 and "`rest.xml`, which it includes or attaches, changes too" in alone.stderr
    result = run("migrate", "two.xml", "--from", "3.2.2", "--in-place")
    assert result.exit_code == 0, result.output
    assert "mpr" not in (folder / "rest.xml").read_text()
    assert 'ccd_iterations="20"' in (folder / "rest.xml").read_text()
    assert '<include file="rest.xml"/>' in (folder / "two.xml").read_text()


ATTACHING = """\
<mujoco>
  <asset><model name="hand" file="parts/hand.xml"/>{more}</asset>
  <worldbody><geom size=".1" {geom}/><frame pos="0 0 1"><attach model="hand" body="palm" prefix="p_"/></frame></worldbody>
</mujoco>
"""
HAND = """\
<mujoco model="hand">
  <asset><model name="tip" file="tip.xml"/></asset>
  <worldbody><body name="palm"><joint/><geom size=".1" margin=".2"/>
    <frame><attach model="tip" body="tip" prefix="t_"/></frame></body></worldbody>
</mujoco>
"""
TIP = """\
<mujoco model="tip">
  <option mpr_iterations="20"/>
  <worldbody><body name="tip"><geom size=".1" margin=".2"/></body></worldbody>
</mujoco>
"""


def attaching(folder: Path, **given: str) -> None:
    (folder / "parts").mkdir()
    (folder / "all.xml").write_text(ATTACHING.format(**{"geom": "", "more": "", **given}))
    (folder / "parts/hand.xml").write_text(HAND)
    (folder / "parts/tip.xml").write_text(TIP)


def test_what_is_attached_is_migrated_too(folder: Path) -> None:
    attaching(folder, geom='margin=".2"')
    alone = run("migrate", "all.xml", "--from", "3.2.2", "-o", "one.xml")
    assert alone.exit_code == 1 and "which it includes or attaches, changes too" in alone.stderr
    result = run("migrate", "all.xml", "--from", "3.2.2", "-o", "new")
    assert (result.exit_code, result.stderr) == (0, "")
    tip = (folder / "new/parts/tip.xml").read_text()
    assert 'ccd_iterations="20"' in tip and "mpr" not in tip
    for name in ("all.xml", "parts/hand.xml", "parts/tip.xml"):
        assert 'margin="0.1"' in (folder / "new" / name).read_text(), "contacts have the sum of two now"
    assert (folder / "parts/tip.xml").read_text() == TIP


def test_margins_are_judged_over_all_that_is_attached(folder: Path) -> None:
    """The geoms of the model itself have none, and those of the parts touch each other and the model's."""
    attaching(folder)
    result = run("migrate", "all.xml", "--from", "3.2.2", "--in-place")
    assert result.exit_code == 0, result.output
    assert "parts/hand.xml:3:40: warning[migrate-changed]: 2 geoms have a `margin`" in result.stderr
    assert 'margin=".2"' in (folder / "parts/hand.xml").read_text()
    assert 'ccd_iterations="20"' in (folder / "parts/tip.xml").read_text()


def test_what_an_attached_model_cannot_be(folder: Path) -> None:
    attaching(folder)
    (folder / "parts/tip.xml").write_text(TIP.replace("<geom", '<composite type="cable"/><geom'))
    result = run("migrate", "all.xml", "--from", "3.2.2", "--mujoco", "4.0", "-o", "new")
    assert result.exit_code == 1 and not (folder / "new").exists()
    assert "parts/tip.xml:3:31: error[migrate-cannot]: MuJoCo 4.0 has no `<composite>`" in result.stderr


def test_models_that_attach_one_another_end(folder: Path) -> None:
    attaching(folder)
    (folder / "parts/tip.xml").write_text(HAND.replace("tip.xml", "../all.xml").replace('"palm"', '"tip"'))
    result = run("migrate", "all.xml", "--from", "3.2.2", "-o", "new")
    assert result.exit_code == 1
    assert "parts/tip.xml:2:34: error[source-cycle]: the model `../all.xml` attaches itself" in result.stderr


def test_an_attached_urdf_is_left(folder: Path) -> None:
    attaching(folder, more='<model name="u" file="parts/u.urdf"/>')
    (folder / "parts/u.urdf").write_text('<robot name="u"><link name="l"/></robot>')
    result = run("migrate", "all.xml", "--from", "3.2.2", "-o", "new")
    assert "all.xml:2:" in result.stderr and "`parts/u.urdf` is URDF, and stays unchanged" in result.stderr


def test_a_file_that_would_be_two(folder: Path) -> None:
    """The class around it gives another orientation in one of the two models."""
    attaching(folder)
    shared = (
        '<mujocoinclude><worldbody><body name="{}"><geom size=".1" quat="1 0 0 1"/></body></worldbody></mujocoinclude>'
    )
    (folder / "parts/shared.xml").write_text(shared.format("s"))
    turned = '<default><geom euler="1 0 0"/></default><include file="shared.xml"/>'
    (folder / "parts/hand.xml").write_text(HAND.replace("<asset>", turned + "<asset>"))
    (folder / "parts/tip.xml").write_text(TIP.replace("<option", '<include file="shared.xml"/><option'))
    result = run("migrate", "all.xml", "--from", "3.2.2", "--mujoco", "4.0", "-o", "new")
    assert result.exit_code == 1 and "two of these models include `parts/shared.xml`" in result.stderr


def test_to_an_older_one(folder: Path) -> None:
    (folder / "new.xml").write_text('<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>')
    result = run("migrate", "new.xml", "--mujoco", "3.3.2", "-o", "old.xml")
    assert result.exit_code == 0, result.output
    assert f"from MuJoCo {installed()} to 3.3.2" in result.stdout
    text = (folder / "old.xml").read_text()
    assert 'ccd_iterations="35"' in text and 'island="enable"' in text and 'multiccd="enable"' in text


def test_the_version_has_to_be_said(folder: Path) -> None:
    (folder / "old.xml").write_text(OLD)
    result = run("migrate", "old.xml")
    assert result.exit_code == 1
    assert (
        "error[migrate-version]: `old.xml` does not say which MuJoCo it is written for: the versions from 3.0.0 to 3.2.2"
        in (result.stderr)
    )
    assert "`--from 3.2.2`" in result.stderr
    wrong = run("migrate", "old.xml", "--from", "2.3")
    assert wrong.exit_code == 1 and "mjcompose cannot migrate from or to `--from 2.3`" in wrong.stderr


@pytest.mark.slow
def test_what_cannot_be_is_an_error_at_its_place(folder: Path) -> None:
    text = '<mujoco><worldbody>\n  <replicate count="2" offset="1 0 0"><geom size=".1"/></replicate>\n</worldbody></mujoco>'
    (folder / "new.xml").write_text(text)
    result = run("migrate", "new.xml", "--mujoco", "3.1", "-o", "old.xml")
    assert result.exit_code == 0, "3.1.6 has it"
    result = run("migrate", "new.xml", "--mujoco", "3.1.4", "-o", "older.xml")
    assert result.exit_code == 1
    assert "new.xml:2:3: error[migrate-cannot]: MuJoCo 3.1.4 has no `<replicate>`" in result.stderr
    assert not (folder / "older.xml").exists()


@pytest.mark.slow
def test_warnings_with_strict_are_errors(folder: Path) -> None:
    text = (
        '<mujoco><option integrator="RK4"/><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>'
    )
    (folder / "old.xml").write_text(text)
    loose = run("migrate", "old.xml", "--from", "3.17", "--mujoco", "4", "-o", "new.xml")
    assert loose.exit_code == 0 and "old.xml:1:9: warning[migrate-changed]: `RK4`" in loose.stderr
    strict = run("migrate", "old.xml", "--from", "3.17", "--mujoco", "4", "-o", "other.xml", "--strict")
    assert strict.exit_code == 1 and not (folder / "other.xml").exists()


@pytest.mark.slow
def test_what_is_new_may_be_wanted(folder: Path) -> None:
    (folder / "old.xml").write_text(OLD)
    result = run("migrate", "old.xml", "--from", "3.2.2", "--adopt", "native-ccd", "-o", "new.xml")
    assert result.exit_code == 0 and "nativeccd" not in (folder / "new.xml").read_text()
    wrong = run("migrate", "old.xml", "--from", "3.2.2", "--adopt", "nativ-ccd")
    assert wrong.exit_code == 2 and "Did you mean `native-ccd`?" in wrong.stderr


@pytest.mark.slow
def test_json_has_each_step(folder: Path) -> None:
    (folder / "old.xml").write_text(OLD)
    result = run("migrate", "old.xml", "--from", "3.2.2", "--output-format", "json")
    answer = json.loads(result.stdout.splitlines()[0])
    assert (answer["from"], answer["to"], answer["output"], answer["proof"]) == ("3.2.2", installed(), None, None)
    step = next(each for each in answer["steps"] if each["change"] == "ccd-names")
    assert step["words"] == 'replaced `mpr_iterations="20"` with `ccd_iterations="20"` at `<option>`'
    assert "ccd_iterations" in answer["diff"]["old.xml"]


@pytest.mark.parametrize("python", ["gone/bin/python", "models", "/bin/false"])
def test_a_python_without_mujoco(folder: Path, python: str) -> None:
    (folder / "old.xml").write_text(OLD)
    result = run("migrate", "old.xml", "--from", "3.2.2", "--with-python", python)
    assert result.exit_code == 1 and "error[migrate-python]" in result.stderr


def test_what_is_no_model(folder: Path) -> None:
    (folder / "bad.xml").write_text("<mujoco><worldbody>")
    assert "error[xml-syntax]" in run("migrate", "bad.xml", "--from", "3.1").stderr
    assert run("migrate", "gone.xml", "--from", "3.1").exit_code == 2
    assert run("migrate", "cell.yaml", "--from", "3.1").exit_code == 2


def test_a_model_that_this_mujoco_refuses(folder: Path) -> None:
    (folder / "old.xml").write_text('<mujoco><worldbody><geom size="-1"/></worldbody></mujoco>')
    result = run("migrate", "old.xml", "--from", "3.1", "-o", "new.xml")
    assert result.exit_code == 1 and "error[mujoco-rejects]" in result.stderr
    assert not (folder / "new.xml").exists()
