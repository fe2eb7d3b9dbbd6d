from __future__ import annotations

import struct
from pathlib import Path

import mujoco
import pytest
from click.testing import CliRunner
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.cli.main import main
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context

CORNERS = [(0, 0, 0), (100, 0, 0), (0, 80, 0), (0, 0, 60)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the same tetrahedron, in millimeters, in the formats of MuJoCo."""
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    faces = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    (tmp_path / "wedge.obj").write_text(points + faces)
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[a], *CORNERS[b], *CORNERS[c], 0) for a, b, c in FACES)
    (tmp_path / "wedge.STL").write_bytes(b"\x00binary".ljust(80, b"\x00") + struct.pack("<I", 4) + triangles)
    numbers = struct.pack("<4i", 4, 0, 0, 4) + struct.pack("<12f", *(each for corner in CORNERS for each in corner))
    (tmp_path / "wedge.msh").write_bytes(numbers + struct.pack("<12i", *(each for face in FACES for each in face)))
    return tmp_path


def tried(folder: Path, recipe: str) -> tuple[Built | None, Context, list[CheckOutcome]]:
    (folder / "recipe.yaml").write_text(f"recipe: 1\n{recipe}")
    context = Context(environment={}, folder=folder)
    outcomes: list[CheckOutcome] = []
    return build(ModelRequest(folder / "recipe.yaml"), context, outcomes=outcomes), context, outcomes


def model_of(built: Built, out: Path) -> mujoco.MjModel:
    for name, content in built.bundle.files.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(content)
    return mujoco.MjModel.from_xml_path(str(out / "model.xml"))


@pytest.mark.parametrize("file", ["wedge.obj", "wedge.STL", "wedge.msh"])
def test_a_mesh_is_a_body_that_its_edit_scales_and_weighs(folder: Path, file: str) -> None:
    """MuJoCo judges: the same model by hand has the same inertia and geometry."""
    edit = "edit: [{select: {mesh: wedge}, set: {scale: [0.001, 0.001, 0.001]}}, {select: {geom: wedge}, set: {mass: 0.3}}]"
    built, context, outcomes = tried(
        folder,
        f"attach:\n  w: {{model: ./{file}, joint: free, pos: [0, 0, 1], replicate: [{{count: 2, offset: [1, 0, 0]}}], {edit}}}\n"
        "check: {same: {unchanged: {except: [scale, mass, inertia]}}}\n",
    )
    assert built is not None, context.sink.diagnostics
    model = model_of(built, folder / "out")
    alone = mujoco.MjModel.from_xml_string(
        f"""<mujoco><asset><mesh name="m" file="{folder / file}" scale=".001 .001 .001"/></asset>
        <worldbody><body name="b"><freejoint/><geom type="mesh" mesh="m" mass=".3"/></body></worldbody></mujoco>"""
    )
    for copy in ("w0", "w1"):
        own = model.body(f"{copy}/wedge")
        assert own.mass[0] == pytest.approx(0.3)
        assert own.inertia == pytest.approx(alone.body("b").inertia)
        assert own.ipos == pytest.approx(alone.body("b").ipos)
        assert model.geom(f"{copy}/wedge").rbound == pytest.approx(alone.geom(0).rbound)
    assert [outcome.values["parts"] for outcome in outcomes] == [2]


def test_a_mesh_is_the_base(folder: Path) -> None:
    built, context, _ = tried(
        folder, "base: {model: ./wedge.obj, edit: [{select: {mesh: wedge}, set: {scale: [0.1, 0.1, 0.1]}}]}\n"
    )
    assert built is not None, context.sink.diagnostics
    assert model_of(built, folder / "out").body("wedge").parentid == 0


@pytest.mark.parametrize(
    ("part", "warned"),
    [
        ("model: ./wedge.obj", 1),
        ("model: ./wedge.STL, replicate: [{count: 3, offset: [100, 0, 0]}]", 1),
        ("model: {base: ./wedge.obj}", 1),
        ("model: ./wedge.obj, allow: [mesh-size]", 0),
        ("model: ./wedge.obj, edit: [{select: {geom: wedge}, set: {density: 0.001}}]", 0),
        ("model: ./wedge.obj, edit: [{select: {geom: wedge}, set: {mass: 2000}}]", 0),
        ("model: ./wedge.obj, edit: [{select: {mesh: wedge}, set: {scale: [0.02, 0.02, 0.02]}}]", 0),
    ],
)
def test_more_than_a_ton_of_water_is_told(folder: Path, part: str, warned: int) -> None:
    built, context, _ = tried(folder, f"attach: {{w: {{{part}}}}}\n")
    assert built is not None
    assert [each.code for each in context.sink.diagnostics if each.code != "license-missing"] == ["mesh-size"] * warned


def test_a_mesh_part_is_locked_verified_and_explained(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    scale = "[{select: {mesh: wedge}, set: {scale: [0.001, 0.001, 0.001]}}]"
    Path("r.yaml").write_text(f"recipe: 1\nattach: {{w: {{model: ./wedge.STL, joint: free, edit: {scale}}}}}\n")
    Path("LICENSE").write_text("MIT License\n")

    def run(*arguments: str) -> str:
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 0, result.output
        return result.output

    run("lock", "r.yaml")
    run("build", "r.yaml", "--locked", "-o", "r.zip", "-q")
    assert "1 of 1 parts compared" in run("verify", "r.zip")
    explained = run("explain", "r.yaml", "geom w/wedge")
    assert "read from wedge.STL" in explained and "\N{SYMBOL FOR NULL}" not in explained
    assert "./wedge.STL, a mesh as a body" in run("plan", "r.yaml")
    Path("wedge.STL").write_bytes(Path("wedge.STL").read_bytes()[:-1] + b"\x01")
    changed = CliRunner().invoke(main, ["build", "r.yaml", "--locked", "-o", "again.zip", "-q"])
    assert changed.exit_code == 1 and "source-changed" in changed.output
