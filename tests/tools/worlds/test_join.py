"""`build --worlds`: cells and samples of any kind as one bundle and a table, each world what its cell is built as."""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from pathlib import Path
from random import Random

import mjcompose
import numpy as np
import pytest
from click.testing import CliRunner, Result
from mjcompose import worlds
from mjcompose.cli.main import main
from tools.worlds.studies import differing

MODEL = """\
<mujoco>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" damping="0.5"/>
      <geom name="link" type="capsule" size="0.05 0.2" mass="1"/>
      <body name="load" pos="0 0 0.3"><geom name="load" size="0.05" mass="0.2"/></body>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0.1"/></keyframe>
</mujoco>
"""
HEAD = """\
recipe: 1
name: m
base: ./model.xml
params: {payload: 0.2, step: 0.002, reach: 0.3}
option: {timestep: "${step}"}
edit:
  - {select: {body: load}, set: {mass: "${payload}", pos: [0, 0, "${reach}"]}}
"""
MATRIX = f"{HEAD}matrix: {{axes: {{payload: [0.1, 0.2, 2], step: [0.002, 0.004]}}}}\n"
DRAWN = """\
randomize:
  seed: 7
  samples: {samples}
  fields:
    {field}
    friction: {{select: {{geom: "**"}}, attr: "friction[0]", scale: {{uniform: [0.5, 2]}}}}
"""
PARAM = "reach: {param: reach, uniform: [0.1, 0.5]}"
DAMPING = "damping: {select: {joint: hinge}, attr: damping, scale: {uniform: [0.5, 2]}}"
LAMP = "matrix: {axes: {lamp: [none, one]}}\nvariants: {lamp: {none: {}, one: {add: [{to: world, light: {name: lamp}}]}}}\n"


def run(folder: Path, text: str, *arguments: str, model: str = MODEL) -> Result:
    (folder / "model.xml").write_text(model)
    (folder / "r.yaml").write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return CliRunner().invoke(main, ["build", "r.yaml", *arguments])


def study(folder: Path, text: str, table: str = "study.npz", *arguments: str) -> worlds.Worlds:
    result = run(folder, text, "--worlds", table, "-o", "out/", *arguments)
    assert result.exit_code == 0, result.output
    return worlds.load(folder / "out", folder / table)


def all_built(folder: Path, text: str) -> list[mjcompose.Loaded]:
    result = run(folder, text, "--all", "-o", "each/{name}/")
    assert result.exit_code == 0, result.output
    return [each.load() for each in mjcompose.load_many(folder / "each")]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_numbers_of_a_matrix(tmp_path: Path, jobs: str) -> None:
    found = study(tmp_path, MATRIX, "study.npz", "--jobs", jobs)
    built = all_built(tmp_path, MATRIX)
    assert len(found) == len(built) == 6
    for world, each in enumerate(built):
        model = found.model(world)
        assert {name for name in differing(model, each.model) if not name.startswith("name")} == set()
        assert model.opt.timestep == each.model.opt.timestep
        assert found.table.cells[found.table.cell[world]] == {
            "name": each.manifest.cell,
            "payload": each.manifest.params["payload"],
            "step": each.manifest.params["step"],
        }
    assert {"opt.timestep", "body_mass", "body_subtreemass", "dof_invweight0"} <= found.arrays.keys()


@pytest.mark.slow
@pytest.mark.parametrize(("output", "field", "of_sample"), [("models", PARAM, 0), ("worlds", DAMPING, 1)])
def test_32_random_worlds_are_what_their_samples_are(tmp_path: Path, output: str, field: str, of_sample: int) -> None:
    text = MATRIX + DRAWN.format(samples=12, field=field)
    found = study(tmp_path, text, "study.npz", "--as", output)
    built = all_built(tmp_path, text)
    axes = ("payload", "step")
    by_identity = {(*map(each.manifest.params.get, axes), each.manifest.sample): each.model for each in built}
    assert len(found) == len(built) - (6 if output == "worlds" else 0) and found.table.seed == 7
    for world in Random(5).sample(range(len(found)), 32):
        cell = found.table.cells[found.table.cell[world]]
        wanted = by_identity[*map(cell.get, axes), int(found.table.sample[world])]
        different = differing(found.model(world), wanted)
        assert {name for name in different if not name.startswith("name")} == set(), world
    assert min(found.table.sample) == of_sample


def test_the_table_says_whose_each_number_is(tmp_path: Path) -> None:
    found = study(tmp_path, MATRIX)
    with np.load(tmp_path / "study.npz", allow_pickle=False) as table:
        assert table["body_mass/kind"] == "body" and table["body_mass/element"].tolist() == ["load"]
        assert table["body_inertia/attribute"].tolist() == [f"diaginertia[{n}]" for n in range(3)]
        assert table["dof_M0/element"].tolist() == ["hinge"] and table["cell"].tolist() == list(range(6))
    assert found.whose("opt.timestep") == [("option", "", "timestep")]


def test_some_worlds(tmp_path: Path) -> None:
    found = study(tmp_path, MATRIX)
    few = found.take([4, 1])
    assert (few.values("body_mass") == found.values("body_mass")[[4, 1]]).all() and len(few) == 2
    assert few.table.cell.tolist() == [4, 1]
    with pytest.raises(IndexError, match="world 6 does not exist: there are 6"):
        found.take([0, 6])


@pytest.mark.skipif(find_spec("pyarrow") is None, reason="pyarrow is not installed")
def test_parquet(tmp_path: Path) -> None:
    import pyarrow.parquet

    numbers = study(tmp_path, MATRIX)
    found = study(tmp_path, MATRIX, "study.parquet")
    assert found.arrays.keys() == numbers.arrays.keys() and found.table.cells == numbers.table.cells
    for name in found.arrays:
        assert found.values(name).dtype == numbers.values(name).dtype
        assert (found.values(name) == numbers.values(name)).all()
    table = pyarrow.parquet.read_table(tmp_path / "study.parquet")
    assert table["body_mass load mass"].to_pylist() == [0.1, 0.1, 0.2, 0.2, 2, 2]


@pytest.mark.skipif(find_spec("pyarrow") is not None, reason="pyarrow is installed")
def test_parquet_without_pyarrow(tmp_path: Path) -> None:
    result = run(tmp_path, MATRIX, "--worlds", "study.parquet", "-o", "out/")
    assert result.exit_code == 2 and "needs the package `pyarrow`" in result.output
    assert not (tmp_path / "out").exists()


def test_a_table_of_another_model(tmp_path: Path) -> None:
    study(tmp_path, MATRIX)
    shutil.copy(tmp_path / "study.npz", tmp_path / "old.npz")
    other = run(tmp_path, MATRIX, "--worlds", "study.npz", "-o", "out/", model=MODEL.replace("0.05 0.2", "0.06 0.2"))
    assert other.exit_code == 0
    with pytest.raises(mjcompose.LoadError, match="belong to another model") as caught:
        worlds.load(tmp_path / "out", tmp_path / "old.npz")
    assert caught.value.diagnostics[0].code == "bundle-changed"
    worlds.load(tmp_path / "out", tmp_path / "study.npz")


@pytest.mark.parametrize(
    ("text", "arguments", "code", "said"),
    [
        (HEAD, (), 2, "error[missing-key]: `r.yaml` is one model and has no worlds"),
        (HEAD + LAMP, (), 1, "r.yaml:8:1: error[not-a-world]: `m-one` cannot be a world of `m-none`"),
        (MATRIX, ("-o", "out.xml"), 2, "error[output-kind]: worlds need a bundle, and `out.xml` is not a bundle"),
        (MATRIX, ("--worlds", "study.csv"), 2, "error[output-kind]: no table of worlds is called `*.csv`"),
        (MATRIX, ("--shard", "1/2"), 2, "--shard is not for --worlds"),
        (MATRIX, ("--sample-table", "s.csv"), 2, "--sample-table is not for --worlds"),
        (MATRIX + DRAWN.format(samples=2, field=PARAM), ("--as", "worlds"), 1, "error[draw-at-run-time]"),
        (MATRIX, ("--as", "worlds", "--sample", "1"), 2, "with --as worlds, all samples are in one"),
        (MATRIX.replace("0.1, 0.2", "-1, 0.2"), (), 1, "error["),
    ],
)
def test_what_cannot_be(tmp_path: Path, text: str, arguments: tuple[str, ...], code: int, said: str) -> None:
    result = run(tmp_path, text, "--worlds", "study.npz", "-o", "out/", *arguments)
    assert result.exit_code == code and said in result.output, result.output
    assert not (tmp_path / "out").exists() and not (tmp_path / "study.npz").exists()


def test_a_fault_of_randomize_is_the_only_error(tmp_path: Path) -> None:
    text = MATRIX + DRAWN.format(samples=2, field=PARAM.replace("uniform", "uniformly"))
    output = run(tmp_path, text, "--as", "worlds", "-o", "out/").output
    assert "has no key `uniformly`" in output and "so it has no worlds" not in output


def test_models_of_one_lamp_are_worlds(tmp_path: Path) -> None:
    result = run(tmp_path, HEAD + LAMP, "--worlds", "study.npz", "-o", "out/", "--pick", "lamp=one")
    assert result.exit_code == 0 and len(worlds.load(tmp_path / "out", tmp_path / "study.npz")) == 1
