"""What the commands say about entries that `for` repeats, and values from tables."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli.shell import run

RECIPE = """recipe: 1
params:
  legs: [FL, FR]
  motors:
    default:
      hip: {kp: 20, force: [-1, 1]}
      knee: {kp: 40, force: [-2, 2]}
angle: radian
add:
  - for: {leg: "${legs}"}
    to: world
    body:
      name: "${leg}"
      geom: {size: [0.1]}
      joint: [{name: "${leg}_hip", axis: [1, 0, 0]}, {name: "${leg}_knee", axis: [0, 1, 0]}]
actuator:
  "${leg}_${j}":
    type: position
    joint: "${leg}_${j}"
    kp: "${motors[j].kp}"
    for: {leg: "${legs}", j: "${motors}"}
edit:
  - {for: {j: "${motors}"}, select: {joint: "*_${j}"}, set: {actuatorfrcrange: "${motors[j].force}", damping: "${value * 0 + index if j == 'hip' else 1}"}}
"""


@pytest.fixture(autouse=True)
def recipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.yaml").write_text(RECIPE.replace("value * 0 + index", "index"))


def test_the_expanded_plan_has_a_line_for_each_turn() -> None:
    lines = run("plan", "a.yaml", "--expanded").stdout.splitlines()
    assert [" ".join(line.split()) for line in lines if "kp: " in line] == [
        f"kp: {kp} # a.yaml:20 where `leg` is {leg}, `j` is {joint}, from a.yaml:{row}"
        for leg in ("FL", "FR")
        for joint, kp, row in (("hip", 20, 6), ("knee", 40, 7))
    ]
    assert any(
        line.startswith("  FL_knee:") and line.endswith("# a.yaml:17 where `leg` is FL, `j` is knee") for line in lines
    )


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("body FR", "added by the recipe, a.yaml:12 where `leg` is FR"),
        ("position FR_knee", "written in the recipe, a.yaml:17 where `leg` is FR, `j` is knee"),
        ("position FR_knee kp", "a.yaml:20 where `leg` is FR, `j` is knee, from a.yaml:7"),
        ("joint FL_hip damping", "a.yaml:23 where `j` is hip"),
    ],
)
def test_explain_names_the_turn(query: str, said: str) -> None:
    assert said in run("explain", "a.yaml", query).stdout


def test_fix_writes_no_constant_over_a_template_and_mends_a_key_once() -> None:
    text = RECIPE.replace("value * 0 + index", "index").replace('joint: "${leg}_${j}"', 'joint: "${leg}_${j}x"')
    Path("a.yaml").write_text(text)
    run("fix", "a.yaml", "--write")
    assert Path("a.yaml").read_text() == text
    good = text.replace('joint: "${leg}_${j}x"', 'joint: "${leg}_${j}"')
    Path("a.yaml").write_text(good.replace("    kp: ", "    kpp: "))
    assert run("fix", "a.yaml", "--write").exit_code == 0
    assert Path("a.yaml").read_text() == good


def test_fmt_writes_for_first_and_keeps_the_order_of_its_names_and_of_rows() -> None:
    text = RECIPE.replace("hip: {kp: 20, force: [-1, 1]}", "hip: {kp: 20, force: [-1, 1], anchor: 1, class: x}")
    Path("a.yaml").write_text(text)
    assert run("fmt", "a.yaml").exit_code == 0
    found = Path("a.yaml").read_text()
    assert '"${leg}_${j}":\n    for: {leg: "${legs}", j: "${motors}"}\n    type: position' in found
    assert "hip: {kp: 20, force: [-1, 1], anchor: 1, class: x}" in found


@pytest.mark.parametrize(
    ("old", "new", "cause"),
    [("kp: 40", "kp: 45", "a.yaml:7 → b.yaml:7"), ("[FL, FR]", "[FL, FR, RL]", "a.yaml:3 → b.yaml:3")],
)
def test_diff_names_the_row_or_the_values(old: str, new: str, cause: str) -> None:
    Path("b.yaml").write_text(Path("a.yaml").read_text().replace(old, new))
    result = run("diff", "a.yaml", "b.yaml")
    assert cause in result.stdout and "without a line of its own" not in result.stdout


def test_samples_and_cells_have_their_turns() -> None:
    more = """
variants: {gait: {two: {}, four: {params: {legs: [FL, FR, RL, RR]}}}}
matrix: {axes: {gait: [two, four]}}
randomize: {seed: 1, samples: 2, fields: {kp: {select: {actuator: "*_hip"}, attr: kp, scale: {uniform: [0.5, 2]}}}}
"""
    Path("a.yaml").write_text(Path("a.yaml").read_text() + more)
    result = run("build", "a.yaml", "--all", "-o", "{name}.xml")
    assert result.exit_code == 0, result.stderr
    counts = {path.name: path.read_text().count("<position ") for path in Path().glob("*.xml")}
    assert sorted(counts.values()) == [4, 4, 4, 8, 8, 8]
    texts = [path.read_text() for path in sorted(Path().glob("a-two*.xml"))]
    assert len(set(texts)) == 3
