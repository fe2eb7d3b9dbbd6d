from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import Bundle
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tree.mesh_cost import check_meshes, mesh_points
from mjcompose.tree.parse import all_admitted, parse_file, parse_text
from mjcompose.verify.compile import OutsideFilesError, verify
from tree.test_points import OBJ, OPEN

INLINE = '<mesh name="v" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>'


def told(
    folder: Path, meshes: str, most: int, world: str = "<contact><pair/></contact>"
) -> list[tuple[str, str, str | None]]:
    """The message of each error of a model, its place, and its help; by default every mesh may collide."""
    sink = Sink()
    with allow(mesh_points=most):
        unit = parse_text(
            f"<mujoco><asset>\n{meshes}\n</asset>{world}</mujoco>", sink, file="m.xml", directory=folder, label="m"
        )
        if unit is not None:
            check_meshes(unit, 0, sink)
    assert {each.code for each in sink.errors} <= {"limit-exceeded"}
    return [
        (each.message, f"{each.span.line}:{each.span.column}" if each.span else "", each.help) for each in sink.errors
    ]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "m.obj").write_text(OBJ)
    (tmp_path / "m.stl").write_bytes(OPEN)
    (tmp_path / "obj.bin").write_text(OBJ)
    return tmp_path


@pytest.mark.parametrize(
    ("meshes", "points"),
    [
        ('<mesh file="m.obj"/>', 4),
        ('<mesh file="m.obj"/><mesh name="n" file="m.obj"/>', 4),
        ('<mesh file="m.obj"/><mesh name="n" file="m.obj" scale="1 1 2"/>', 8),
        ('<mesh file="obj.bin" content_type="model/obj"/>', 4),
        ('<mesh file="m.stl"/>', 150),
        (INLINE, 4),
        ('<mesh name="f" vertex="0 0 0" face="0 0 0 0 0 0 0 0 0 0 0 0"/>', 2),
        ('<mesh name="b" builtin="supersphere" params="30 1 1"/>', 900),
        ('<mesh name="b" builtin="supertorus" params="30 .5 1 1"/>', 900),
        ('<mesh name="b" builtin="wedge" params="30 20 30 30 .1"/>', 1200),
        ('<mesh name="b" builtin="cone" params="30 1"/>', 60),
        ('<mesh name="b" builtin="box" params="5 6 7 .1 .1 .1"/>', 210),
        ('<mesh name="b" builtin="sphere" params="2"/>', 0),
        ('<mesh name="b" builtin="supersphere" params="many"/>', 0),
        ('<mesh file="missing.obj"/>', 0),
    ],
)
def test_what_each_mesh_counts(folder: Path, meshes: str, points: int) -> None:
    if points:
        assert told(folder, meshes, points) == []
        assert told(folder, meshes, points - 1 or 1)[0][0].startswith(f"the meshes of the model have {points} points;")
    else:
        assert told(folder, meshes, 1) == []


def test_the_largest_is_shown_and_the_limit_is_named(folder: Path) -> None:
    meshes = f'{INLINE}\n<mesh file="m.stl"/>'
    ((message, place, help),) = told(folder, meshes, 100)
    assert message == "the meshes of the model have 154 points; 100 are allowed"
    assert (place, help) == ("3:13", "to allow it, raise the limit: `--limit mesh-points=154`")


def test_a_file_is_read_only_where_its_size_leaves_it_open(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read(path: object) -> bytes:
        raise AssertionError(path)

    monkeypatch.setattr("mjcompose.tree.mesh_cost.read_regular", read)
    assert told(folder, '<mesh file="m.stl"/>', 150) == []
    with pytest.raises(AssertionError, match="m.stl"):
        told(folder, '<mesh file="m.stl"/>', 149)


GEOM = '<geom type="mesh" mesh="m" {}/>'
APART = 'contype="0" conaffinity="0"'
LOOKS = 'class="looks"'
HIT = ' contype="1"'
NAMED = ' name="g"'
CLASS = f'<default><default class="looks"><geom {APART}/></default></default>'


@pytest.mark.parametrize(
    ("world", "hull"),
    [
        (f"<worldbody>{GEOM.format('')}</worldbody>", True),
        (f"<worldbody>{GEOM.format(APART)}</worldbody>", False),
        (f"<worldbody>{GEOM.format(APART)}{GEOM.format('')}</worldbody>", True),
        (f"{CLASS}<worldbody>{GEOM.format(LOOKS)}</worldbody>", False),
        (f'{CLASS}<worldbody><body childclass="looks">{GEOM.format("")}</body></worldbody>', False),
        (f"{CLASS}<worldbody>{GEOM.format(LOOKS + HIT)}</worldbody>", True),
        ("<worldbody/>", False),
        (f'<default><geom mesh="m"/></default><worldbody><geom type="mesh" {APART}/></worldbody>', True),
        (
            (
                f"<worldbody>{GEOM.format(APART + NAMED)}<geom name='h' size='1'/></worldbody>"
                "<contact><pair geom1='g' geom2='h'/></contact>"
            ),
            True,
        ),
        (
            (
                f"<worldbody>{GEOM.format(APART + NAMED)}<geom name='h' size='1'/></worldbody>"
                "<sensor><distance geom1='g' geom2='h'/></sensor>"
            ),
            True,
        ),
        (f"<default><mesh inertia='convex'/></default><worldbody>{GEOM.format(APART)}</worldbody>", True),
    ],
)
def test_where_mujoco_looks_for_a_hull_the_points_count_in_full(folder: Path, world: str, hull: bool) -> None:
    points = 150 if hull else 15
    assert told(folder, '<mesh file="m.stl"/>', points, world) == []
    assert told(folder, '<mesh file="m.stl"/>', points - 1, world) != []
    text = f'<mujoco><asset><mesh file="m.stl"/></asset>{world}</mujoco>'
    model = mujoco.MjModel.from_xml_string(text, {"m.stl": OPEN})
    assert hull or model.mesh_graphadr[0] < 0


def test_a_file_outside_is_not_looked_at(folder: Path) -> None:
    (folder / "in").mkdir()
    (folder / "in" / "pyproject.toml").touch()
    assert told(folder / "in", '<mesh file="../m.stl"/>', 1) == []


def test_the_meshes_of_attached_models_count(folder: Path) -> None:
    (folder / "s.xml").write_text(
        '<mujoco><asset><mesh file="m.stl"/></asset><worldbody><body name="b"><geom type="mesh" mesh="m"/></body>'
        "</worldbody></mujoco>"
    )
    attach = '<attach model="s" prefix="{}"/>'
    (folder / "m.xml").write_text(
        f'<mujoco><asset><model name="s" file="s.xml"/></asset><worldbody>{attach.format("a")}{attach.format("b")}'
        "</worldbody></mujoco>"
    )
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    context = Context(folder=folder)
    with allow(mesh_points=299):
        assert build(ModelRequest(Path("r.yaml"), verified=False), context) is None
    (error,) = context.sink.errors
    assert error.message == "the meshes of the model have 300 points; 299 are allowed"
    with allow(mesh_points=300):
        assert build(ModelRequest(Path("r.yaml"), verified=False), Context(folder=folder)) is not None


def test_all_meshes_of_a_unit(folder: Path) -> None:
    unit = parse_text(f"<mujoco><asset>{INLINE}</asset></mujoco>", Sink(), file="m.xml", directory=folder, label="m")
    assert unit is not None and mesh_points(unit) == 1, "no geom uses it"


def test_what_is_too_much_already_needs_no_more_reading(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.tree import mesh_cost as counting

    read = []
    counting._memory.cache_clear()
    monkeypatch.setattr(counting, "read_regular", lambda path: read.append(path) or OPEN)
    for name in "abc":
        (folder / f"{name}.stl").write_bytes(OPEN)
    assert told(folder, "".join(f'<mesh file="{name}.stl"/>' for name in "abc"), 100) != []
    assert len(read) == 1


def test_files_are_counted_before_mujoco_opens_them_and_not_when_a_model_is_read(folder: Path) -> None:
    model = folder / "m.xml"
    model.write_text('<mujoco><asset><mesh file="m.stl"/></asset><contact><pair/></contact></mujoco>')
    sink = Sink()
    with allow(mesh_points=100):
        unit = parse_file(model, sink)
        assert unit is not None and not sink.has_errors
        assert not all_admitted(unit, sink)
        assert [each.code for each in sink.errors] == ["limit-exceeded"]


def test_they_are_counted_where_python_compiles_a_model_or_reads_one_for_mujoco(folder: Path) -> None:
    model = folder / "m.xml"
    model.write_text(
        '<mujoco><asset><mesh file="m.stl"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
    )
    with allow(mesh_points=100):
        root = mjcf.from_path(model)
        for compile in (root.compile_model, lambda: mjcf.Physics.from_path(model)):
            with pytest.raises(mjcf.MjcfError, match="the meshes of the model have 150 points; 100 are allowed"):
                compile()


def test_they_are_counted_in_the_bundle_of_a_stranger(folder: Path) -> None:
    text = b'<mujoco><asset><mesh file="m.stl"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
    bundle = Bundle({"model.xml": text, "m.stl": OPEN}, "model.xml")
    with allow(mesh_points=100), pytest.raises(OutsideFilesError) as raised:
        verify(bundle, stranger="x.zip")
    assert [each.code for each in raised.value.found] == ["limit-exceeded"]


def test_points_of_large_files_are_counted_only_where_a_quick_look_leaves_it_open(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from mjcompose.tree import mesh_cost as counting

    counted = []
    monkeypatch.setattr(counting, "points_in", lambda data, kind: counted.append(kind) or 10_000)
    (folder / "large.obj").write_text("v 0 0 0\n" * 10_000)
    mesh = '<mesh file="large.obj"/>'
    assert told(folder, mesh, 20_000) == [] and not counted
    assert told(folder, mesh, 2_000, "<worldbody/>") == [] and not counted, "no geom collides"
    assert told(folder, mesh, 19_999) == [] and counted
